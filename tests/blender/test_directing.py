"""Characters that are told what to do: their lists of commands, and what is read from these."""

import itertools

import bpy
import numpy as np
import pytest

from morph_retarget.blender.directing import changes, marking, properties, reading
from morph_retarget.blender.directing.parameters import Kind
from morph_retarget.blender.directing.properties import MORPHRETARGET_PG_directing
from morph_retarget.blender.directing.reading import Briefing
from morph_retarget.blender.locomotion.going import Clock
from morph_retarget.blender.locomotion.properties import Source
from morph_retarget.blender.morph import cast
from morph_retarget.blender.properties import of_rig
from morph_retarget.core.arrays import Array
from morph_retarget.core.clips.commands.command import Verb
from morph_retarget.core.errors import MotionError
from tests.blender import acts, directed, scenes
from tests.blender.directed import own

ops = bpy.ops.morph_retarget
NEAR = 1e-5

pytestmark = pytest.mark.usefixtures("registered")


@pytest.fixture(autouse=True)
def _frames() -> None:
    bpy.context.scene.frame_end = 60


@pytest.fixture
def ob() -> bpy.types.Object:
    """Return a creature that is the active object and does what it is told."""
    return directed.biped()


def _read(ob: bpy.types.Object, from_world: Array | None = None) -> Briefing:
    clock = Clock.of(bpy.context.scene, {})
    graph = bpy.context.evaluated_depsgraph_get()
    return reading.read(ob, clock, graph, np.eye(4) if from_world is None else from_world, 1.7)


def _words(found: Briefing) -> list[str]:
    return [str(command) for command in found.commands]


# --- the list ---


def test_a_command_holds_what_it_was_given(ob: bpy.types.Object) -> None:
    ball = acts.empty_object("Ball", (1.0, -2.0, 0.5))
    hand = ob.pose.bones["Hand.L"]
    item = own(ob).command(12.5, "start", "walk", speed=1.2, side="left", mirror=True, to=(1, 2), at=ball, by=hand)
    kinds = {parameter.name: Kind(parameter.kind) for parameter in item.parameters}
    assert kinds == {
        "speed": Kind.NUMBER, "side": Kind.TEXT, "mirror": Kind.SWITCH, "to": Kind.PLACE, "at": Kind.TARGET,
        "by": Kind.TARGET,
    }  # fmt: skip
    (command,) = own(ob).commands_of(bpy.context.scene)
    assert command.time == pytest.approx(12.5 / scenes.FPS)
    assert (command.verb, command.model, command.origin) == (Verb.START, "walk", "frame 12.5")
    assert command.parameters == {
        "speed": 1.2, "side": "left", "mirror": True, "to": (1.0, 2.0, 0.0), "at": "Ball", "by": "Biped : Hand.L",
    }  # fmt: skip
    assert item.how.startswith("speed 1.2, side left, mirror yes, to (1, 2, 0), at Ball")


def test_commands_come_in_order_of_time_and_those_of_one_frame_as_they_were_given(ob: bpy.types.Object) -> None:
    for frame, model in ((30, "c"), (1, "a"), (30, "d"), (7.5, "b")):
        own(ob).command(frame, "start", model)
    assert [command.model for command in own(ob).commands_of(bpy.context.scene)] == ["a", "b", "c", "d"]
    assert [item.model for item in own(ob).commands] == ["c", "a", "d", "b"], "none moves while it is edited"
    own(ob).commands[1].mute = True
    assert [command.model for command in own(ob).commands_of(bpy.context.scene)] == ["b", "c", "d"]


@pytest.mark.parametrize(
    ("verb", "values", "said"),
    [("go", {}, "choose one of start, stop, reset"), ("start", {"a": None}, "cannot be None"),
     ("start", {"a": (1, 2, 3, 4)}, "give a number"), ("start", {"a": ("x", "y")}, "give a number")],
)  # fmt: skip
def test_a_command_that_makes_no_sense_is_refused_whole(
    ob: bpy.types.Object, verb: str, values: dict[str, object], said: str
) -> None:
    with pytest.raises(MotionError, match=said):
        own(ob).command(1, verb, "walk", **values)
    assert not len(own(ob).commands)


def test_setting_a_parameter_again_changes_it_and_its_kind(ob: bpy.types.Object) -> None:
    item = own(ob).command(1, "start", "gaze", target=acts.empty_object("Ball", (0, 0, 1)))
    item.set("target", (1.0, 2.0, 3.0))
    assert [parameter.value for parameter in item.parameters] == [(1.0, 2.0, 3.0)]
    item.remove("target")
    with pytest.raises(MotionError, match="'start gaze' has no parameter 'target'"):
        item.remove("target")


def test_each_change_is_told_once(ob: bpy.types.Object) -> None:
    told: list[bpy.types.ID] = []
    changes.command_listeners.append(told.append)
    try:
        item = own(ob).command(1, "start", "walk", speed=1.2, turn=0.4)
        assert told == [ob]
        item.parameters["turn"].number = 0.5
        item.frame = 3
        item.mute = True
        assert told == [ob] * 4
        own(ob).clear()
        assert told == [ob] * 5
    finally:
        changes.command_listeners.remove(told.append)


def test_commands_cannot_be_keyed_and_say_what_they_do() -> None:
    for group in properties.CLASSES:
        for name, prop in group.bl_rna.properties.items():
            if name not in {"rna_type", "name"}:
                assert len(prop.description) > 10
                assert not prop.is_animatable or prop.type in {"POINTER", "COLLECTION", "INT"}


# --- what is read ---


def test_markers_that_read_as_commands_are_commands(ob: bpy.types.Object) -> None:
    action = cast.action_of(ob)
    for name, frame in (("start walk speed=1.5", 10), ("Stop walk", 40), ("Footstep", 12), ("start", 20)):
        action.pose_markers.new(name).frame = frame
    own(ob).command(20, "start", "wave")
    found = _read(ob)
    assert _words(found) == ["start walk speed 1.5", "start wave", "stop walk"]
    assert found.commands[0].time == pytest.approx(10 / scenes.FPS)
    assert found.commands[0].origin == "marker at frame 10 of 'Directing'"
    assert [warning.partition(": ")[0] for warning in found.warnings] == ["marker at frame 20 of 'Directing'"]


def test_commands_go_to_markers_and_come_back(ob: bpy.types.Object) -> None:
    ball = acts.empty_object("My Ball", (1.0, -2.0, 0.5))
    own(ob).command(20, "stop", "walk")
    own(ob).command(5, "start", "walk", speed=1.2, style="a b", at=(1, 2, 3))
    own(ob).command(9, "start", "gaze", target=ball)
    own(ob).command(50, "start", "jump").mute = True
    before = _words(_read(ob))
    action = cast.action_of(ob)
    assert ops.commands_to_markers(character=ob.name) == {"FINISHED"}
    assert [item.model for item in own(ob).commands] == ["jump"]
    assert len(action.pose_markers) == 3
    assert _words(_read(ob)) == before
    assert list(_read(ob).targets) == ["My Ball"]
    assert ops.markers_to_commands(character=ob.name) == {"FINISHED"}
    assert not len(action.pose_markers)
    assert _words(_read(ob)) == before
    assert own(ob).commands[2].parameters["target"].target == ball


def test_a_command_too_long_for_a_marker_keeps_all_in_the_list(ob: bpy.types.Object) -> None:
    own(ob).command(1, "start", "walk")
    own(ob).command(5, "start", "walk", style="x" * 60)
    with pytest.raises(MotionError, match="too long for the name of a marker"):
        marking.to_markers(own(ob), cast.action_of(ob))
    assert len(own(ob).commands) == 2
    assert not len(cast.action_of(ob).pose_markers)


def test_targets_that_keys_move_are_known_at_every_frame(ob: bpy.types.Object) -> None:
    cart, ball = acts.empty_object("Cart", (0, 0, 0)), acts.empty_object("Ball", (0, 0, 1))
    ball.parent = cart
    for frame, x in ((1, 0.0), (60, 5.9)):
        cart.location.x = x
        cart.keyframe_insert("location", frame=frame)
    own(ob).command(1, "start", "gaze", target=ball)
    frames = [1, 20, 45]
    wanted = []
    for frame in frames:
        bpy.context.scene.frame_set(frame)
        wanted.append(np.array(ball.evaluated_get(bpy.context.evaluated_depsgraph_get()).matrix_world)[:3, 3])
    found = _read(ob)
    assert found.targets["Ball"].at(np.array(frames) / scenes.FPS) == pytest.approx(np.array(wanted), abs=NEAR)
    assert not reading.reasons_to_step(ob)


def test_a_target_that_stands_still_is_read_once(ob: bpy.types.Object) -> None:
    own(ob).command(1, "start", "gaze", target=acts.empty_object("Ball", (1, 2, 3)))
    assert _read(ob).targets["Ball"].places == pytest.approx(np.array([[1.0, 2.0, 3.0]]))


def test_a_target_that_more_than_keys_moves_needs_stepping(ob: bpy.types.Object) -> None:
    ball = acts.empty_object("Ball", (1, 2, 3))
    ball.driver_add("location", 0).driver.expression = "0.1 * frame"
    own(ob).command(1, "start", "gaze", target=ball)
    clock = Clock.of(bpy.context.scene, {})
    assert reading.reasons_to_step(ob) == ("target 'Ball'",)
    with pytest.raises(MotionError, match="'Ball': more than keys moves it, so it is followed when 'Biped' is baked"):
        _read(ob)
    bpy.context.scene.frame_set(30)
    graph = bpy.context.evaluated_depsgraph_get()
    assert reading.places_now(ob, graph)["Ball"] == pytest.approx([3.0, 2.0, 3.0])
    stepped = {"Ball": np.tile([4.0, 5.0, 6.0], (60, 1))}
    found = reading.read(ob, clock, graph, np.eye(4), 1.7, stepped)
    assert found.targets["Ball"].at(np.array([0.5])) == pytest.approx(np.array([[4.0, 5.0, 6.0]]))


def test_targets_and_places_are_seen_from_the_ground_frame(ob: bpy.types.Object) -> None:
    own(ob).command(1, "start", "go", target=acts.empty_object("Ball", (1, 2, 3)), at=(1.0, 2.0, 3.0))
    from_world = np.eye(4)
    from_world[:3, :3], from_world[:3, 3] = [[0, -1, 0], [1, 0, 0], [0, 0, 1]], [10, 0, -1]
    found = _read(ob, from_world)
    assert found.targets["Ball"].places[0] == pytest.approx([8.0, 1.0, 2.0])
    assert found.commands[0].parameters["at"] == pytest.approx((8.0, 1.0, 2.0))


def test_targets_that_are_not_there_are_told(ob: bpy.types.Object) -> None:
    own(ob).command(3, "start", "gaze", target="Ghost")
    own(ob).command(4, "start", "touch", target=ob.pose.bones["Head"])
    found = _read(ob)
    assert not found.targets
    assert any("there is no object 'Ghost'" in warning for warning in found.warnings)
    assert any("cannot have itself for a target" in warning for warning in found.warnings)
    acts.empty_object("Ghost", (0, 0, 1))
    assert list(_read(ob).targets) == ["Ghost"]


def test_a_target_that_is_renamed_is_still_meant(ob: bpy.types.Object) -> None:
    ball = acts.empty_object("Ball", (1, 2, 3))
    own(ob).command(1, "start", "gaze", target=ball)
    ball.name = "Apple"
    found = _read(ob)
    assert list(found.targets) == ["Apple"]
    assert found.commands[0].parameters["target"] == "Apple"


def test_obstacles_are_what_boxes_cover_of_the_ground(ob: bpy.types.Object) -> None:
    around = bpy.data.collections.new("Around")
    for place, turn in (((3, 0, 0.5), np.pi / 4), ((0, 3, 9.0), 0.0)):
        bpy.ops.mesh.primitive_cube_add(size=2.0, location=place, rotation=(0, 0, turn))
        around.objects.link(bpy.context.object)
    around.objects.link(acts.empty_object("Nothing", (5, 5, 0)))
    own(ob).obstacles = around
    (outline,) = _read(ob).obstacles
    corner = np.sqrt(2.0)
    assert sorted(map(tuple, outline.round(4).tolist())) == [
        (round(3 - corner, 4), 0.0), (3.0, round(-corner, 4)), (3.0, round(corner, 4)), (round(3 + corner, 4), 0.0)
    ]  # fmt: skip
    sides = np.roll(outline, -1, axis=0) - outline
    following = np.roll(sides, -1, axis=0)
    assert (sides[:, 0] * following[:, 1] - sides[:, 1] * following[:, 0] > 0.0).all(), "counter-clockwise"


def test_what_was_read_tells_whether_anything_has_changed(ob: bpy.types.Object) -> None:
    ball = acts.empty_object("Ball", (1, 2, 3))
    item = own(ob).command(1, "start", "gaze", target=ball)
    keys = [_read(ob).key, _read(ob).key]
    assert keys[0] == keys[1]
    item.frame = 2
    keys.append(_read(ob).key)
    ball.location.x = 9.0
    bpy.context.view_layer.update()
    keys.append(_read(ob).key)
    own(ob).library = "//mine.npz"
    keys.append(_read(ob).key)
    cast.action_of(ob).pose_markers.new("start jump").frame = 7
    keys.append(_read(ob).key)
    assert all(one != other for one, other in itertools.pairwise(keys[1:]))


def test_what_is_watched_is_all_that_can_move_a_target_or_an_obstacle(ob: bpy.types.Object) -> None:
    cart, ball = acts.empty_object("Cart", (0, 0, 0)), acts.empty_object("Ball", (0, 0, 1))
    ball.parent = cart
    cart.keyframe_insert("location", frame=1)
    own(ob).command(1, "start", "gaze", target=ball)
    own(ob).obstacles = around = bpy.data.collections.new("Around")
    around.objects.link(acts.empty_object("Post", (1, 1, 0)))
    names = {block.name for block in reading.watched(ob)}
    assert names == {"Ball", "Cart", cart.animation_data.action.name, "Post", "Around"}


# --- buttons ---


def test_directing_makes_the_character_go_by_commands(ob: bpy.types.Object) -> None:
    assert of_rig(ob).gait.enabled
    assert of_rig(ob).gait.source == Source.COMMANDS
    assert own(ob).enabled
    assert cast.action_of(ob).name == "Directing"
    ops.remove_locomotion(character=ob.name)
    assert not own(ob).enabled


def test_buttons_add_move_and_remove_commands_and_parameters(ob: bpy.types.Object) -> None:
    bpy.context.scene.frame_set(12)
    assert ops.add_command(model="wave") == {"FINISHED"}
    bpy.context.scene.frame_set(24)
    assert ops.add_command(verb="stop", model="wave") == {"FINISHED"}
    assert [(item.frame, item.words) for item in own(ob).commands] == [(12.0, "start wave"), (24.0, "stop wave")]
    bpy.context.scene.frame_set(30)
    assert ops.move_command() == {"FINISHED"}
    assert own(ob).commands[1].frame == 30.0
    assert ops.add_parameter(place=0) == {"FINISHED"}
    assert ops.add_parameter(place=0) == {"FINISHED"}
    assert [item.name for item in own(ob).commands[0].parameters] == ["parameter", "parameter.001"]
    assert ops.remove_parameter(place=0, name="parameter") == {"FINISHED"}
    assert len(own(ob).commands[0].parameters) == 1
    assert ops.remove_command() == {"FINISHED"}
    assert ops.remove_command() == {"FINISHED"}
    with pytest.raises(RuntimeError, match="has no such command"):
        ops.remove_command()
    with pytest.raises(RuntimeError, match="has no such command"):
        ops.move_command()


def test_what_is_said_already_is_not_said_twice(ob: bpy.types.Object) -> None:
    own(ob).command(1, "start", "walk", speed=1.0)
    with pytest.raises(RuntimeError, match="says its speed already"):
        ops.add_parameter(name="speed")


def test_commands_come_and_go_with_undo() -> None:
    def told() -> MORPHRETARGET_PG_directing:
        return own(bpy.data.objects["Biped"])

    acts.creature("biped")
    bpy.context.view_layer.objects.active = bpy.data.objects["Biped"]
    ops.direct(character="Biped")
    bpy.ops.ed.undo_push(message="direct")
    ops.add_command(model="walk")
    bpy.ops.ed.undo_push(message="walk")
    told().commands[0].set("speed", 2.0)
    bpy.ops.ed.undo_push(message="speed")
    bpy.ops.ed.undo()
    assert [item.how for item in told().commands] == [""]
    bpy.ops.ed.undo()
    assert not len(told().commands)
    bpy.ops.ed.redo()
    bpy.ops.ed.redo()
    assert [item.how for item in told().commands] == ["speed 2"]


def test_undo_leaves_a_character_its_library() -> None:
    """Making motions for it takes longer than anything that undo brings back."""
    acts.creature("biped")
    bpy.context.view_layer.objects.active = bpy.data.objects["Biped"]
    ops.direct(character="Biped")
    ops.add_command(model="walk")
    bpy.ops.ed.undo_push(message="walk")
    made = reading.library_now(bpy.data.objects["Biped"])
    assert made is not None
    ops.add_command(model="walk")
    bpy.ops.ed.undo_push(message="again")
    bpy.ops.ed.undo()
    assert reading.library_now(bpy.data.objects["Biped"]) is made
