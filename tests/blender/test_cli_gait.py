"""`play` with locomotion: characters that go over the ground, with an action and without."""

from collections.abc import Iterator
from pathlib import Path

import bpy
import numpy as np
import pytest

from morph_retarget.blender.cli import data as extension
from morph_retarget.blender.io.load import Request, load
from morph_retarget.blender.morph import cast
from morph_retarget.blender.properties import of_rig
from tests.blender import acting, results, scenes
from tests.blender.command import Command, Refused, contents


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with an action, three creatures, and a hound in a scene with a path and a hill."""
    made = tmp_path_factory.mktemp("gaits")
    with extension.known():
        scenes.empty(25)
        acting.dip(scenes.figure("Ann"))
        scenes.save(made / "dip.blend")
        for kind in ("biped", "hound", "snake"):
            scenes.empty(25)
            acting.creature(kind)
            bpy.context.scene.frame_end = 60
            scenes.save(made / f"{kind}.blend")
        scenes.empty(25)
        acting.creature("hound")
        curve = bpy.data.curves.new("Way", "CURVE")
        curve.splines.new("POLY").points.add(1)
        curve.splines[0].points[1].co = (5.0, 0.0, 0.0, 1.0)
        mesh = bpy.data.meshes.new("Hill")
        mesh.from_pydata([(-9, -9, 9), (9, -9, 9), (9, 9, -9), (-9, 9, -9)], [], [(0, 1, 2, 3)])
        for name, own in (("Way", curve), ("Hill", mesh)):
            bpy.context.scene.collection.objects.link(bpy.data.objects.new(name, own))
        bpy.context.scene.frame_end = 60
        scenes.save(made / "set.blend")
        cast.forget(rig=True)
    return made


@pytest.fixture
def known() -> Iterator[None]:
    with extension.known():
        yield
        cast.forget(rig=True)


def _way(path: Path, bone: str = "Hips") -> np.ndarray:
    """Return how far a bone has gone over the action of the only armature of a file [m], shape (3,)."""
    ob = results.reload(path)
    first, last = ob.animation_data.action.frame_range
    return np.diff(scenes.heads(ob, [bone], [first, last])[:, 0], axis=0)[0]


def test_a_character_walks_without_any_action(cli: Command, folder: Path, out: Path) -> None:
    said = cli("play", "-", folder / "hound.blend", "-o", out / "x.blend", "--gait", "trot", "--speed", "1.5")
    assert (said.status, said.out, said.errors) == (0, "", [])
    assert _way(out / "x.blend") == pytest.approx([0.0, -1.5 * 59 / 25, 0.0], abs=0.15)


@pytest.mark.parametrize("kind", ["glb", "fbx", "bvh"])
def test_files_of_every_kind_get_the_walk(cli: Command, folder: Path, out: Path, kind: str) -> None:
    made = out / f"walk.{kind}"
    said = cli("play", "-", folder / "biped.blend", "-o", made, "--frames", "1:26", "--speed", "1")
    assert (said.status, said.errors) == (0, [])
    assert list(contents(out)) == [made.name]
    assert np.linalg.norm(_way(made)) == pytest.approx(1.0, abs=0.1)


def test_what_has_no_feet_goes_too(cli: Command, folder: Path, out: Path) -> None:
    ob = load(Request(folder / "snake.blend"))[0]
    bone = ob.data.bones[1].name
    said = cli("play", "-", folder / "snake.blend", "-o", out / "x.blend", "--frames", "1:51", "--speed", "0.5")
    assert said.status == 0
    assert np.linalg.norm(_way(out / "x.blend", bone)) == pytest.approx(1.0, rel=0.2)


def test_an_action_plays_over_the_gait_for_as_long_as_it_lasts(cli: Command, folder: Path, out: Path) -> None:
    said = cli("play", folder / "dip.blend", folder / "biped.blend", "-o", out / "x.blend", "--gait", "walk")
    assert (said.status, said.errors) == (0, [])
    ob = results.reload(out / "x.blend")
    assert tuple(ob.animation_data.action.frame_range) == (1.0, 21.0)
    hips, hands = scenes.heads(ob, ["Hips", "Hand.L"], [1, 11, 21]).swapaxes(0, 1)
    assert -np.diff(hips[[0, 2], 1]) == pytest.approx([1.2 * 20 / 25], abs=0.1)
    assert hands[1, 2] < hands[0, 2] - 0.1


def test_a_path_and_a_ground_of_the_character_s_file_are_followed(cli: Command, folder: Path, out: Path) -> None:
    arguments = ["play", "-", folder / "set.blend", "-o", out / "x.blend", "--path", "Way", "--speed", "2"]
    assert cli(*arguments).status == 0
    assert _way(out / "x.blend") == pytest.approx([2.0 * 59 / 25, 0.0, 0.0], abs=0.15)
    assert cli("play", "-", folder / "set.blend", "-o", out / "y.blend", "--ground", "Hill", "--speed", "1").status == 0
    assert _way(out / "y.blend")[2] > 1.0


def test_it_turns_by_degrees(cli: Command, folder: Path, out: Path) -> None:
    said = cli(
        "play", "-", folder / "biped.blend", "-o", out / "x.blend", "--speed", "1", "--turn-rate", "90",
        "--frames", "1:26",
    )  # fmt: skip
    assert said.status == 0
    assert _way(out / "x.blend") == pytest.approx(np.array([2.0, -2.0, 0.0]) / np.pi, abs=0.15)


@pytest.mark.usefixtures("known")
def test_live_keeps_the_settings(cli: Command, folder: Path, out: Path) -> None:
    said = cli(
        "play", "-", folder / "hound.blend", "-o", out / "x.blend", "--live",
        "--gait", "walk:2", "--gait", "limp:1", "--speed", "0.8",
    )  # fmt: skip
    assert (said.status, said.errors) == (0, [])
    load(Request(out / "x.blend"))
    (ob,) = cast.performers(bpy.context.scene)
    own = of_rig(ob).gait
    assert (own.enabled, own.style, round(own.speed, 3)) == (True, "walk", 0.8)
    assert [(layer.style, round(layer.weight, 3)) for layer in own.layers] == [("limp", 0.5)]


@pytest.mark.usefixtures("known")
def test_what_the_file_of_the_character_says_is_played(cli: Command, folder: Path, out: Path) -> None:
    load(Request(folder / "biped.blend"))
    of_rig(bpy.data.objects["Biped"]).gait.speed = 2.0
    of_rig(bpy.data.objects["Biped"]).gait.enabled = True
    scenes.save(out / "fast.blend")
    assert cli("play", folder / "dip.blend", out / "fast.blend", "-o", out / "x.blend").status == 0
    assert -_way(out / "x.blend")[1] == pytest.approx(2.0 * 20 / 25, abs=0.15)


def test_several_get_a_file_each(cli: Command, folder: Path, out: Path) -> None:
    said = cli("play", "-", folder / "hound.blend", folder / "snake.blend", "-o", out / "{target}_{action}.glb")
    assert said.status == 0
    assert set(contents(out)) == {"hound_Locomotion.glb", "snake_Locomotion.glb"}


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--path", "Road"], "--path 'Road': there is no such object: choose one of Way"),
        (["--path", "Hill"], "--path 'Hill': it is no curve: choose one of Way"),
        (["--ground", "Way"], "--ground 'Way': it is no mesh: choose one of Hill"),
    ],
)
def test_objects_that_are_not_there_or_of_the_wrong_kind_are_refused(
    refused: Refused, folder: Path, out: Path, options: list[str], said: str
) -> None:
    refused("play", "-", folder / "set.blend", "-o", out / "x.blend", *options, names=said)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--gait", "moonwalk"], "there is no gait 'moonwalk': choose one of auto, walk"),
        (["--gait", "walk:no"], "'no' is no number"),
        (["--gait", "walk:0"], "'0' is too small or too large"),
        (["--speed", "1e9"], "'1e9' is too small or too large: use a number from -100 to 100"),
        (["--speed", "nan"], "'nan' is too small or too large"),
    ],
)
def test_absurd_requests_are_usage_errors(cli: Command, folder: Path, out: Path, options: list[str], said: str) -> None:
    answer = cli("play", "-", folder / "set.blend", "-o", out / "x.blend", *options)
    assert answer.status == 2
    assert said in answer.errors[-1]
    assert not contents(out)
