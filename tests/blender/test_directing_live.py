"""Directed characters while something is edited: commands, markers, targets, obstacles and libraries."""

from collections.abc import Callable
from pathlib import Path

import bpy
import numpy as np
import pytest

from morph_retarget.blender.locomotion import walks
from morph_retarget.blender.morph import cast
from morph_retarget.blender.properties import of_rig
from morph_retarget.core.arrays import Array
from tests.blender import acting, acts, directed, scenes
from tests.blender.directed import own

ops = bpy.ops.morph_retarget
NEAR = 1e-6
FRAME = 60

pytestmark = pytest.mark.usefixtures("registered")


@pytest.fixture(autouse=True)
def _frames() -> None:
    bpy.context.scene.frame_end = 90


def _directed() -> bpy.types.Object:
    """Return a creature that walks from frame 10 on, at a frame at which it does."""
    ob = directed.biped()
    own(ob).command(10, "start", "walk")
    bpy.context.scene.frame_set(FRAME)
    return ob


def _pose(ob: bpy.types.Object) -> Array:
    """Return what Blender shows of a character after an edit, with nothing wrong about it."""
    bpy.context.view_layer.update()
    assert not cast.problems
    assert not walks.problems
    return acts.pose(ob)


def _set_speed(ob: bpy.types.Object) -> None:
    own(ob).commands[0].set("speed", 0.6)


def _mute(ob: bpy.types.Object) -> None:
    own(ob).commands[0].mute = True


def _move(ob: bpy.types.Object) -> None:
    own(ob).commands[0].frame = 20


def _add_marker(ob: bpy.types.Object) -> None:
    cast.action_of(ob).pose_markers.new("reset walk").frame = 30


def _tell_more(ob: bpy.types.Object) -> None:
    ops.add_command(character=ob.name, verb="reset", model="walk")
    ops.move_command(character=ob.name)
    own(ob).commands[1].frame = 30


@pytest.mark.parametrize("edit", [_set_speed, _mute, _move, _add_marker, _tell_more])
def test_an_edit_of_what_it_is_told_is_followed_at_once_and_taken_back(
    edit: Callable[[bpy.types.Object], None],
) -> None:
    name = _directed().name

    def pose() -> Array:
        return _pose(bpy.data.objects[name])

    bpy.ops.ed.undo_push(message="start")
    before = pose()
    edit(bpy.data.objects[name])
    after = pose()
    assert scenes.difference(after, before) > 0.05
    bpy.ops.ed.undo_push(message="edit")
    bpy.ops.ed.undo()
    assert scenes.difference(pose(), before) < NEAR
    bpy.ops.ed.redo()
    assert scenes.difference(pose(), after) < NEAR


@pytest.mark.parametrize("enters", ["commands", "speed"])
def test_what_makes_a_character_go_can_be_changed_at_any_time(enters: str, capsys: pytest.CaptureFixture[str]) -> None:
    """Commands lead all of its bones, and a gait only some: what it was found to have goals for is found anew."""
    ob = _directed()
    gait = of_rig(ob).gait
    if enters == "commands":
        gait.source = "SPEED"
        _pose(ob)
    before = _pose(ob)
    gait.source = "COMMANDS" if enters == "commands" else "SPEED"
    assert np.abs(_pose(ob) - before).max() > NEAR
    gait.source = "SPEED" if enters == "commands" else "COMMANDS"
    np.testing.assert_allclose(_pose(ob), before, atol=NEAR)
    assert "Traceback" not in capsys.readouterr().err


def test_a_character_that_is_scaled_to_nothing_stays_and_why_is_told() -> None:
    ob = _directed()
    ob.scale = (0.0, 0.0, 0.0)
    bpy.context.view_layer.update()
    assert "scale of 0" in (walks.problems | cast.problems)[ob.session_uid]
    ob.scale = (1.0, 1.0, 1.0)
    assert np.isfinite(_pose(ob)).all()


def test_a_marker_that_is_dragged_moves_its_command() -> None:
    ob = _directed()
    own(ob).clear()
    marker = cast.action_of(ob).pose_markers.new("start walk")
    marker.frame = 10
    early = _pose(ob)
    marker.frame = 40
    late = _pose(ob)
    assert scenes.difference(early, late) > 0.3
    marker.frame = 10
    assert scenes.difference(_pose(ob), early) < NEAR


def test_a_marker_is_looked_at_with_each_frame_since_blender_tells_nobody_of_drags(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    ob = _directed()
    marker = cast.action_of(ob).pose_markers.new("reset walk")
    marker.frame = 30
    early = _pose(ob)
    monkeypatch.setattr(walks, "edited", lambda _: None)
    marker.frame = 55
    bpy.context.scene.frame_set(FRAME + 1)
    bpy.context.scene.frame_set(FRAME)
    assert scenes.difference(_pose(ob), early) > 0.1


def test_a_target_that_is_moved_or_keyed_is_looked_at() -> None:
    ob = _directed()
    ball = acts.empty_object("Ball", (2.0, -3.0, 1.5))
    own(ob).command(1, "start", "gaze", target=ball)
    before = _pose(ob)
    ball.location.x = -2.0
    moved = _pose(ob)
    assert scenes.difference(moved, before) > 0.1
    ball.location.x = 2.0
    assert scenes.difference(_pose(ob), before) < NEAR
    for frame, x in ((1, 2.0), (40, -2.0)):
        ball.location.x = x
        ball.keyframe_insert("location", frame=frame)
    assert scenes.difference(_pose(ob), before) > 0.1


def test_an_obstacle_that_is_put_in_the_way_is_walked_around() -> None:
    ob = _directed()
    own(ob).clear()
    own(ob).command(1, "start", "go", target=acts.empty_object("There", (0.0, -6.0, 0.0)))
    bpy.context.scene.frame_end = 200
    bpy.context.view_layer.update()
    _pose(ob)
    assert np.abs(_course(ob)[:, 0]).max() < 0.3
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=(0.05, -3.0, 0.5))
    block = bpy.context.object
    own(ob).obstacles = around = bpy.data.collections.new("Around")
    around.objects.link(block)
    _pose(ob)
    course = _course(ob)
    beside = course[np.abs(course[:, 1] + 3.0) < 0.4]
    assert np.abs(beside[:, 0]).min() > 0.5
    block.location.x = 5.0
    _pose(ob)
    assert np.abs(_course(ob)[:, 0]).max() < 0.3


def _course(ob: bpy.types.Object) -> Array:
    """Return where the body goes over all frames of the scene [m], shape (frame, 2)."""
    walk = walks.known(ob, bpy.context.scene)
    assert walk is not None
    places, _ = walk.course.at(walk.clock.times(walk.clock.frames))
    return places[:, :2]


def test_another_library_is_used_at_once(tmp_path: Path) -> None:
    ob = _directed()
    before = _pose(ob)
    ops.save_library(character=ob.name, filepath=str(tmp_path / "mine.npz"))
    own(ob).library = str(tmp_path / "mine.npz")
    assert scenes.difference(_pose(ob), before) < 0.1, "the same motions, transferred as those of any body"
    own(ob).library = str(tmp_path / "none.npz")
    bpy.context.view_layer.update()
    assert "none.npz" in walks.problems[ob.session_uid]
    own(ob).library = ""
    assert scenes.difference(_pose(ob), before) < NEAR


def test_what_a_character_is_told_is_baked_as_it_was_shown() -> None:
    ob = _directed()
    ball = acts.empty_object("Ball", (2.0, -3.0, 1.5))
    own(ob).command(20, "start", "gaze", target=ball)
    own(ob).command(60, "stop", "walk")
    frames = [1, 15, 40, 61, 90]
    live = acting.shown(ob, frames)
    acting.baked(ob)
    assert scenes.difference(acting.shown(ob, frames), live) < 1e-5


def test_a_target_that_drivers_move_is_followed_when_it_is_baked() -> None:
    ob = _directed()
    ball = acts.empty_object("Ball", (0.0, -3.0, 1.5))
    ball.driver_add("location", 0).driver.expression = "2.0 - 0.05 * frame"
    own(ob).command(1, "start", "gaze", target=ball)
    bpy.context.view_layer.update()
    assert "followed when 'Biped' is baked" in walks.problems[ob.session_uid]
    acting.baked(ob)
    driven = acting.shown(ob, [20, 80])
    assert scenes.difference(driven[0], driven[1]) > 0.1


def test_a_generalized_action_plays_on_top_of_commands() -> None:
    ob = acts.creature("biped")
    acting.dip(ob)
    bpy.context.view_layer.objects.active = ob
    still = acting.shown(ob, [11])
    ops.direct(character=ob.name)
    assert cast.action_of(ob).name == "Dip"
    own(ob).command(-40, "start", "walk")
    going = acting.shown(ob, [11])
    names = [bone.name for bone in ob.pose.bones]
    hand, hips = names.index("Hand.L"), names.index("Hips")
    assert (going[0, hand] - going[0, hips])[2] == pytest.approx((still[0, hand] - still[0, hips])[2], abs=0.15)
    assert going[0, hips, 1] < still[0, hips, 1] - 0.05


def test_a_loaded_file_shows_what_was_shown(tmp_path: Path) -> None:
    name = _directed().name
    own(bpy.data.objects[name]).command(20, "start", "gaze", target=acts.empty_object("Ball", (2.0, -3.0, 1.5)))
    before = _pose(bpy.data.objects[name])
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    bpy.ops.wm.read_homefile(use_empty=True)
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "scene.blend"))
    bpy.context.scene.frame_set(FRAME)
    assert scenes.difference(_pose(bpy.data.objects[name]), before) < NEAR


def test_a_render_shows_the_character_where_commands_have_led_it(tmp_path: Path) -> None:
    ob = acts.character("biped")
    bpy.context.view_layer.objects.active = ob
    ops.direct(character=ob.name)
    own(ob).command(10, "start", "walk")
    scenes.close_up(scenes.heads(ob, ["Hips"], [80])[0, 0], 0.05)
    bpy.context.scene.frame_set(1)
    assert [scenes.covered(frame, tmp_path, str(frame)).max() for frame in (80, 1)] == [1.0, 0.0]
