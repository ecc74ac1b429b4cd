"""Libraries of motions: built from actions and files, saved, loaded, and used by commands."""

from pathlib import Path

import bpy
import numpy as np
import pytest

from morph_retarget.blender.directing import annotations, clips, libraries
from morph_retarget.blender.locomotion import walks
from morph_retarget.blender.morph import analyses
from morph_retarget.core.clips.motions import library_file
from morph_retarget.core.clips.motions.library import Library
from morph_retarget.core.directing.building import Builder
from morph_retarget.core.directing.performing import model_of
from morph_retarget.core.errors import FileError
from tests.blender import scenes
from tests.blender.directed import own
from tools import gait

ops = bpy.ops.morph_retarget

pytestmark = pytest.mark.usefixtures("registered")


@pytest.fixture
def ob() -> bpy.types.Object:
    """Return a small humanoid that does what it is told."""
    made = scenes.sprout()
    scenes.select(made)
    ops.direct(character=made.name)
    return made


def _library(path: Path) -> Library:
    return library_file.load(path)


def test_a_library_is_built_from_the_actions_of_selected_armatures(ob: bpy.types.Object, tmp_path: Path) -> None:
    walker = scenes.walker(seconds=2.0 * scenes.STEP)
    scenes.select(walker, ob)
    assert ops.build_library(filepath=str(tmp_path / "mine")) == {"FINISHED"}
    library = _library(tmp_path / "mine.npz")
    assert library.model.names == tuple(analyses.of(ob)[1].skeleton.names), "its body is the character's"
    (walk,) = library.motions
    assert (walk.name, walk.kind) == ("Walk", "walk")
    assert walk.annotations.cycle
    rounds = walk.clip.length / (scenes.STEP * 30.0)
    assert rounds == pytest.approx(round(rounds), abs=0.05)
    assert Path(own(ob).library) == tmp_path / "mine.npz"
    assert walker.animation_data.action.name == "Walk"


def test_a_built_library_is_what_commands_use(ob: bpy.types.Object, tmp_path: Path) -> None:
    scenes.select(scenes.walker(seconds=2.0 * scenes.STEP), ob)
    ops.build_library(filepath=str(tmp_path / "mine.npz"))
    own(ob).command(10, "start", "walk")
    bpy.context.scene.frame_set(60)
    assert not walks.problems
    walk = walks.known(ob, bpy.context.scene)
    assert walk is not None
    way = walk.course.at(walk.clock.times(np.array([30.0, 60.0])))[0]
    assert way[1, 1] - way[0, 1] < -0.3


def test_annotations_made_by_hand_count(ob: bpy.types.Object, tmp_path: Path) -> None:
    walker = scenes.walker(seconds=2.0 * scenes.STEP)
    action = walker.animation_data.action
    told = annotations.of_action(action)
    told.kind, told.style, told.cycle, told.turn_rate, told.phase = "march", "proud", True, 0.5, "loop"
    action.pose_markers.new("strike right").frame = 11
    action.use_frame_range, action.frame_start, action.frame_end = True, 1, 35
    scenes.select(walker, ob)
    ops.build_library(filepath=str(tmp_path / "mine.npz"))
    (march,) = _library(tmp_path / "mine.npz").motions
    known = march.annotations
    assert (known.kind, known.style, known.cycle, known.turn_rate) == ("march", "proud", True, pytest.approx(0.5))
    assert [(strike.foot, strike.frame) for strike in known.strikes] == [(1, pytest.approx(10.0 * 30.0 / scenes.FPS))]
    assert march.clip.length == pytest.approx(34.0 * 30.0 / scenes.FPS, abs=1.0)


def test_a_folder_of_clips_is_taken_and_nothing_of_it_stays(
    ob: bpy.types.Object, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "clips"
    folder.mkdir()
    walker = scenes.walker(seconds=2.0 * scenes.STEP)
    scenes.select(walker)
    bpy.ops.export_anim.bvh(filepath=str(folder / "stroll.bvh"), frame_start=1, frame_end=68)
    bpy.data.objects.remove(walker)
    bpy.data.actions.remove(bpy.data.actions["Walk"])
    bpy.context.view_layer.update()
    (folder / "broken.bvh").write_text("HIERARCHY")
    (folder / "notes.txt").write_text("nothing")
    scenes.select(ob)
    before = [set(kind) for kind in (bpy.data.objects, bpy.data.actions, bpy.data.armatures)]
    rate = bpy.context.scene.render.fps
    assert ops.build_library(filepath=str(tmp_path / "mine.npz"), folder=str(folder)) == {"FINISHED"}
    assert [set(kind) for kind in (bpy.data.objects, bpy.data.actions, bpy.data.armatures)] == before
    assert bpy.context.scene.render.fps == rate
    assert bpy.context.object == ob
    assert bpy.context.selected_objects == [ob]
    assert [(m.name, m.kind) for m in _library(tmp_path / "mine.npz").motions] == [("stroll", "walk")]
    told = capfd.readouterr().out
    assert "broken.bvh is left out" in told
    assert "notes" not in told
    assert "has 1 more motions; 1 clips were left out" in told


def test_motions_are_added_to_a_library(ob: bpy.types.Object, tmp_path: Path) -> None:
    walker = scenes.walker(seconds=2.0 * scenes.STEP)
    scenes.select(walker, ob)
    ops.build_library(filepath=str(tmp_path / "mine.npz"))
    bpy.context.scene.frame_set(30)
    assert "Walk 2" not in [motion.name for motion in libraries.read(tmp_path / "mine.npz").motions]
    ops.build_library(add=True)
    assert [motion.name for motion in _library(tmp_path / "mine.npz").motions] == ["Walk", "Walk 2"]
    found = libraries.read(tmp_path / "mine.npz")
    assert "Walk 2" in [motion.name for motion in found.motions], "what has changed on disk is read again"


def test_a_new_library_goes_beside_the_open_file_under_a_free_name(ob: bpy.types.Object, tmp_path: Path) -> None:
    scenes.select(scenes.walker(seconds=2.0 * scenes.STEP), ob)
    with pytest.raises(RuntimeError, match="has no folder yet, beside which the library goes: save it first"):
        ops.build_library()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    ob = bpy.data.objects["Sprout"]
    ops.build_library()
    assert own(ob).library == "//Sprout.npz"
    ops.build_library()
    assert own(ob).library == "//Sprout 2.npz"
    assert sorted(path.name for path in tmp_path.glob("*.npz")) == ["Sprout 2.npz", "Sprout.npz"]


def test_what_cannot_be_built_is_told_and_nothing_is_written(ob: bpy.types.Object, tmp_path: Path) -> None:
    path = tmp_path / "mine.npz"
    with pytest.raises(RuntimeError, match="no action moves Sprout: select armatures"):
        ops.build_library(filepath=str(path))
    with pytest.raises(RuntimeError, match="is no folder"):
        ops.build_library(filepath=str(path), folder=str(tmp_path / "none"))
    scenes.key(ob, "Twitch", {'pose.bones["Root"].location': np.zeros((2, 3))})
    with pytest.raises(RuntimeError, match="no clip could be used: Twitch is left out: it has 2 frames"):
        ops.build_library(filepath=str(path))
    assert not path.exists()
    assert not own(ob).library


def test_stopping_a_build_leaves_everything_as_it_was(ob: bpy.types.Object, tmp_path: Path) -> None:
    folder = tmp_path / "clips"
    folder.mkdir()
    walker = scenes.walker(seconds=2.0 * scenes.STEP)
    scenes.select(walker)
    bpy.ops.export_anim.bvh(filepath=str(folder / "stroll.bvh"), frame_start=1, frame_end=68)
    before = [set(kind) for kind in (bpy.data.objects, bpy.data.actions)]
    builder = Builder(Library(model_of(analyses.of(ob)[1])))
    work = clips.take(builder, [], clips.files_of(folder), bpy.context.scene)
    next(work)
    work.close()
    assert [set(kind) for kind in (bpy.data.objects, bpy.data.actions)] == before


def test_libraries_are_saved_and_loaded(ob: bpy.types.Object, tmp_path: Path) -> None:
    path = tmp_path / "starter.npz"
    assert ops.save_library(filepath=str(path)) == {"FINISHED"}
    assert {"idle", "walk", "run"} <= set(_library(path).kinds)
    assert ops.load_library(filepath=str(path)) == {"FINISHED"}
    assert Path(own(ob).library) == path
    other = tmp_path / "again.npz"
    ops.save_library(filepath=str(other))
    assert _library(other).kinds == _library(path).kinds
    broken = tmp_path / "broken.npz"
    broken.write_bytes(path.read_bytes()[:500])
    with pytest.raises(RuntimeError, match=r"broken\.npz"):
        ops.load_library(filepath=str(broken))
    assert Path(own(ob).library) == path
    with pytest.raises(FileError, match=r"none\.npz"):
        libraries.read(tmp_path / "none.npz")


# --- annotations ---


def test_annotations_are_found_and_told_by_markers() -> None:
    walker = scenes.walker(seconds=3.0 * scenes.STEP)
    scenes.select(walker)
    action = walker.animation_data.action
    annotations.of_action(action).style = "usual"
    assert ops.find_annotations() == {"FINISHED"}
    found = annotations.of_action(action)
    assert (found.kind, found.style) == ("walk", "usual")
    assert found.speed == pytest.approx(gait.SPEED, rel=0.2)
    names = {marker.name for marker in action.pose_markers}
    assert names == {"strike left", "strike right"}
    frames = sorted(marker.frame for marker in action.pose_markers)
    assert np.diff(frames) == pytest.approx(np.full(len(frames) - 1, scenes.STEP * scenes.FPS / 2.0), abs=3.0)
    ops.find_annotations()
    assert sorted(marker.frame for marker in action.pose_markers) == frames, "found anew, not added"
    assert ops.clear_annotations() == {"FINISHED"}
    assert not found.is_annotated
    assert not len(action.pose_markers)


def test_annotations_of_a_named_action_and_armature() -> None:
    walker = scenes.walker(seconds=2.0 * scenes.STEP)
    scenes.key(walker, "Other", {"location": np.zeros((5, 3))})
    scenes.select(scenes.sprout())
    assert ops.find_annotations(armature=walker.name, action="Walk") == {"FINISHED"}
    assert annotations.of_action(bpy.data.actions["Walk"]).kind == "walk"
    with pytest.raises(RuntimeError, match="has no action 'Nothing'"):
        ops.find_annotations(armature=walker.name, action="Nothing")
    ops.clear_annotations(action="Walk")
    assert not annotations.of_action(bpy.data.actions["Walk"]).is_annotated
    with pytest.raises(RuntimeError, match="there is no action 'Nothing'"):
        ops.clear_annotations(action="Nothing")
