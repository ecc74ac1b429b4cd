"""Files of earlier versions: kept as they were written then, they open, say the same and play.

A file is added here when a version changes what is kept: with what is expected of it, and a step in `migrations`.
"""

from pathlib import Path

import bpy
import numpy as np
import pytest

from morph_retarget.blender import migrations
from morph_retarget.blender.morph import cast, definitions
from morph_retarget.blender.morph.properties import of_action
from morph_retarget.blender.properties import of_rig, of_scene
from morph_retarget.blender.scene_properties import MORPHRETARGET_PG_scene
from tests.blender import acts, scenes

FOLDER = Path(__file__).resolve().parent / "old_files"
ACTIONS = {
    "Bow": 12, "Bow on All Fours": 10, "Clap": 9, "Dance": 13, "Eat Fruit": 9, "Hand to Mouth": 8, "Jump": 12,
    "Look and Nod": 6, "Paw to Mouth": 8, "Pick Up by Hand": 9, "Pick Up by Mouth": 9, "Punch": 7, "Shake Hands": 6,
    "Sit": 10, "Sit on Haunches": 10, "Wave by Hand": 9, "Wave by Paw": 10, "Wave by Wing": 10,
}  # fmt: skip
"""Generalized actions of the file, and how many channels each has."""

pytestmark = pytest.mark.usefixtures("registered")


def _open(name: str) -> None:
    bpy.ops.wm.open_mainfile(filepath=str(FOLDER / f"{name}.blend"), load_ui=False)


def _pose(ob: bpy.types.Object, frame: int) -> np.ndarray:
    bpy.context.scene.frame_set(frame)
    assert not cast.problems
    return acts.pose(ob)


@pytest.mark.parametrize("name", sorted(path.stem for path in FOLDER.glob("*.blend")))
def test_an_old_file_is_of_the_present_version_once_it_is_open_and_saved(name: str, tmp_path: Path) -> None:
    _open(name)
    for _ in range(2):
        assert [of_scene(scene).version for scene in bpy.data.scenes] == [migrations.VERSION] * len(bpy.data.scenes)
        bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "again.blend"))
        bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "again.blend"), load_ui=False)


def test_old_actions_have_all_their_channels_and_play() -> None:
    _open("actions")
    found = {action.name: action for action in bpy.data.actions if definitions.is_generalized(action)}
    assert {name: len(definitions.read(action).channels) for name, action in found.items()} == ACTIONS
    ob = acts.creature("biped")
    cast.add(ob, found["Wave by Hand"])
    frames = [int(frame) for frame in found["Wave by Hand"].frame_range]
    first, last, middle = (_pose(ob, frame) for frame in (*frames, sum(frames) // 2))
    assert np.abs(first - last).max() < 0.1 < np.abs(first - middle).max()
    assert of_action(found["Wave by Hand"]).channels[0].name == "Feet"


def test_an_old_walk_goes_along_its_path() -> None:
    _open("walk")
    ob = bpy.data.objects["Biped"]
    gait = of_rig(ob).gait
    assert (gait.enabled, gait.source, gait.path.name, len(gait.layers)) == (True, "PATH", "Path", 0)
    assert gait.speed == pytest.approx(1.3)
    ways = [_pose(ob, frame)[:, :3, 3].mean(axis=0) for frame in (1, 60)]
    assert 2.0 < np.linalg.norm(ways[1] - ways[0]) < 4.0


def test_an_old_list_of_commands_is_carried_out() -> None:
    _open("direct")
    ob = bpy.data.objects["Biped"]
    own = of_rig(ob).directing
    told = [(command.frame, command.words) for command in own.commands]
    assert told == [
        (15.0, "start walk"),
        (75.0, "start wave"),
        (150.0, "start walk"),
        (160.0, "start gaze"),
        (215.0, "stop walk"),
        (255.0, "stop gaze"),
        (275.0, "start pick_up"),
    ]
    assert np.abs(_pose(ob, 100) - _pose(ob, 1)).max() > 0.5


# --- steps from one version to the next ---


@pytest.mark.parametrize(("version", "steps"), [(1, [1, 2]), (2, [2]), (3, []), (9, [])])
def test_steps_bring_a_file_up_to_date_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, version: int, steps: list[int]
) -> None:
    done: list[int] = []

    def step(number: int) -> object:
        def bring(settings: MORPHRETARGET_PG_scene) -> None:
            assert settings.version == version
            done.append(number)

        return bring

    scenes.empty()
    monkeypatch.setattr(migrations, "VERSION", version)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "old.blend"))
    monkeypatch.setattr(migrations, "VERSION", 3)
    monkeypatch.setattr(migrations, "STEPS", {1: step(1), 2: step(2)})
    for _ in range(2):
        bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "old.blend"), load_ui=False)
        assert of_scene(bpy.context.scene).version == max(version, 3)
        bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "old.blend"))
        assert done == steps


def test_a_file_without_data_of_ours_is_left_alone(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    scenes.empty()
    handlers = bpy.app.handlers.save_pre[:]
    bpy.app.handlers.save_pre.clear()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "theirs.blend"))
    bpy.app.handlers.save_pre.extend(handlers)
    monkeypatch.setattr(migrations, "STEPS", {})
    monkeypatch.setattr(migrations, "VERSION", 5)
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "theirs.blend"), load_ui=False)
    assert of_scene(bpy.context.scene).version == 0
