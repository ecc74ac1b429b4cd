"""Editing a channel through the ordinary curves of a stand-in for its active body (Hecker 2008 §3.3)."""

import bpy
import numpy as np
import pytest

from morph_retarget.blender import actions
from morph_retarget.blender.morph import cast, keys, specialized
from morph_retarget.blender.properties import of_rig
from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.errors import MotionError
from morph_retarget.core.morph.channels import Channel, MirrorRule, TargetKind
from morph_retarget.core.morph.context import Context
from morph_retarget.core.morph.movement import Movement, PositionMode, RotationMode, ScaleMode
from tests.blender import acts, scenes
from tests.blender.acts import Act

ops = bpy.ops.morph_retarget
SAME = 1e-5
"""How far a motion may be from what it shall be [m or rad]."""
BOTH = ("biped", "lopside")
MODES = {
    "limb": Movement(scale=ScaleMode.LIMB_LENGTH),
    "size and ground": Movement(scale=ScaleMode.CREATURE_SIZE, ground_relative=True),
    "sagittal": Movement(sagittal_relative=True, rotation=RotationMode.ABSOLUTE),
    "target": Movement(secondary_relative=True, look_at=True),
    "place": Movement(position=PositionMode.ABSOLUTE, rotation=RotationMode.ABSOLUTE),
}

pytestmark = pytest.mark.usefixtures("registered")


def _act(modes: str = "limb", body: str = "Hand.L", *names: str) -> Act:
    """Return creatures that move their hands, in curves with unequal keys; a biped alone without names."""
    channel = Channel("Hands", Context(Capability.GRASPER), MODES[modes], TargetKind.EXTERNAL, mirror=MirrorRule.LEFT)
    act = acts.act([acts.creature(name) for name in names or ("biped",)], channel)
    for i in range(len(act.obs)):
        act.values(i).target = acts.empty_object("Fruit", (0.3, -0.6, 0.9))
        act.values(i).active_body = body
    rng = np.random.default_rng(5)
    for frame in (1, 8, 20):
        turn = np.array([1.0, 0.0, 0.0, 0.0]) + 0.2 * rng.normal(size=4)
        act.key(frame, position=rng.normal(size=3) * 0.2, rotation=turn / np.linalg.norm(turn))
    act.curve("position", 0).keyframe_points.insert(13, 0.1)
    act.curve("rotation", 2).keyframe_points.insert(5, 0.1)
    bpy.context.view_layer.update()
    return act


def _start(act: Act, i: int = 0) -> bpy.types.Object:
    ops.edit_specialized(character=act.obs[i].name, channel="Hands")
    return bpy.context.object


def _curve(empty: bpy.types.Object, index: int, path: str = "location") -> bpy.types.FCurve:
    return scenes.curves_of(empty)[path, index]


def _place(ob: bpy.types.Object) -> np.ndarray:
    return np.array(ob.evaluated_get(bpy.context.evaluated_depsgraph_get()).matrix_world)


def _goal(act: Act, i: int, body: str) -> np.ndarray:
    """Return where a body shall be now, world space."""
    goals = act.shown(i)
    names = [cast.member(act.obs[i]).bodies.names[b] for b in goals.bodies]
    return acts.in_world(act.obs[i], goals.positions[0, names.index(body)])


# --- what is shown ---


@pytest.mark.parametrize(("modes", "body"), [*((modes, "Hand.L") for modes in MODES), ("target", "Hand.R")])
def test_the_stand_in_is_where_the_body_shall_be_at_every_frame(modes: str, body: str) -> None:
    act = _act(modes, body, *BOTH)
    scenes.stand(act.obs[1], scenes.matrix((10, 20, 70), 0.5, (1, 2, 0.3)))
    bpy.context.view_layer.objects.active = act.obs[1]
    empty = _start(act, 1)
    for frame in (1, 4, 8, 11, 13, 17, 20, 25):
        bpy.context.scene.frame_set(frame)
        assert np.abs(_place(empty)[:3, 3] - _goal(act, 1, body)).max() < SAME


def test_the_stand_in_turns_as_the_body() -> None:
    act = _act()
    empty = _start(act)
    member = cast.member(act.obs[0])
    body = member.rig.skeleton.index["Hand.L"]
    for frame in (1, 6, 14):
        bpy.context.scene.frame_set(frame)
        goals = act.shown()
        place = list(goals.bodies).index(body)
        turn = acts.quat.multiply(goals.turns[0, place], member.bodies.axes[body])
        shown = acts.quat.normalize(
            np.array(empty.evaluated_get(bpy.context.evaluated_depsgraph_get()).rotation_quaternion)
        )
        assert acts.quat.angle_between(shown, turn) < 1e-4


def test_the_graph_editor_gets_the_stand_in_and_asking_twice_gives_the_same_one() -> None:
    act = _act()
    bpy.ops.object.mode_set(mode="POSE")
    empty = _start(act)
    assert bpy.context.mode == "OBJECT"
    assert [ob.name for ob in bpy.context.selected_objects] == [empty.name] == ["Biped: Hands"]
    assert {path for path, _ in scenes.curves_of(empty)} == {"location", "rotation_quaternion"}
    ops.edit_specialized(character="Biped")
    assert bpy.context.object == empty
    assert len(specialized.stand_ins(act.action)) == 1


def test_a_channel_without_keys_shows_where_its_values_bring_the_body() -> None:
    act = acts.act([acts.creature("biped")], Channel("Hands", Context(Capability.GRASPER)))
    act.values().position = (0.1, -0.2, 0.1)
    bpy.context.view_layer.update()
    empty = _start(act)
    bpy.context.view_layer.update()
    assert np.abs(_place(empty)[:3, 3] - _goal(act, 0, "Hand.L")).max() < SAME
    ops.finish_specialized()
    assert not keys.curves(act.action)


def test_the_active_body_can_be_another_one_meanwhile() -> None:
    act = _act()
    empty, keyed = _start(act), scenes.keys_of(act.action)
    act.values().active_body = "Hand.R"
    bpy.context.view_layer.update()
    assert of_rig(empty).stands_for_body == "Hand.L"
    _curve(empty, 1).keyframe_points[0].co[1] += 0.1
    _curve(empty, 1).keyframe_points[0].co[1] -= 0.1
    ops.finish_specialized()
    _near(scenes.keys_of(act.action), keyed)


# --- nothing is changed by looking ---


@pytest.mark.parametrize("modes", MODES)
def test_finishing_without_edits_leaves_all_keys_as_they_were(modes: str) -> None:
    act = _act(modes)
    keyed = scenes.keys_of(act.action)
    _start(act)
    bpy.context.scene.frame_set(7)
    ops.finish_specialized()
    assert scenes.keys_of(act.action) == keyed


def test_finishing_without_edits_in_a_file_loaded_meanwhile_leaves_all_keys_as_they_were(
    tmp_path: pytest.TempPathFactory,
) -> None:
    act = _act("target")
    keyed = scenes.keys_of(act.action)
    _start(act)
    path = str(tmp_path / "act.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    ops.finish_specialized(stand_in="Biped: Hands")
    assert scenes.keys_of(bpy.data.actions["Act"]) == keyed


def _near(one: dict, other: dict) -> None:
    assert one.keys() == other.keys()
    for name, parts in one.items():
        for a, b in zip(parts[:3], other[name][:3], strict=True):
            np.testing.assert_allclose(np.frombuffer(a, np.float32), np.frombuffer(b, np.float32), atol=SAME)


def test_keys_come_back_after_an_edit_that_is_taken_back() -> None:
    act = _act("target")
    act.curve("position", 0).keyframe_points.insert(5, 0.0)
    for index in (1, 2):
        for frame in (5, 13):
            act.curve("position", index).keyframe_points.insert(frame, 0.1)
    keyed, empty = scenes.keys_of(act.action), _start(act)
    value = _curve(empty, 0).keyframe_points[1].co_ui[1]
    for new in (value + 0.3, value):
        _curve(empty, 0).keyframe_points[1].co_ui[1] = new
        _curve(empty, 0).update()
        bpy.context.view_layer.update()
    ops.finish_specialized()
    position = {key: parts for key, parts in scenes.keys_of(act.action).items() if "position" in key[1]}
    _near(position, {key: parts for key, parts in keyed.items() if key in position})


# --- edits ---


def _follows(act: Act, empty: bpy.types.Object, body: str = "Hand.L") -> None:
    for frame in np.arange(1.0, 21.0, 1.7).tolist():
        bpy.context.scene.frame_set(int(frame), subframe=frame % 1.0)
        assert np.abs(_place(empty)[:3, 3] - _goal(act, 0, body)).max() < SAME


@pytest.mark.parametrize(
    ("modes", "edit"),
    [
        *((modes, "value") for modes in MODES),
        *(("target", edit) for edit in ("time", "handle", "new key", "deleted key", "interpolation")),
    ],
)
def test_the_body_goes_where_the_reshaped_curves_lead(modes: str, edit: str) -> None:
    act = _act(modes, "Hand.L", *BOTH)
    empty = _start(act)
    was = [acts.motion(ob) for ob in act.obs]
    curve = _curve(empty, 1)
    point = curve.keyframe_points[1]
    if edit == "value":
        point.co_ui[1] += 0.15
    elif edit == "time":
        point.co_ui[0] += 2.0
    elif edit == "handle":
        point.handle_right_type = point.handle_left_type = "FREE"
        x, y = point.handle_right
        point.handle_right = (x + 0.5, y + 0.4)
    elif edit == "new key":
        curve.keyframe_points.insert(16.0, 0.3)
    elif edit == "deleted key":
        curve.keyframe_points.remove(point)
    else:
        point.interpolation = "SINE"
    curve.update()
    bpy.context.view_layer.update()
    moved = [acts.apart(acts.motion(ob), motion) for ob, motion in zip(act.obs, was, strict=True)]
    assert min(moved) > 1e-3
    _follows(act, empty)
    there = acts.motion(act.obs[0], body="Hand.L")
    ops.finish_specialized()
    assert acts.apart(acts.motion(act.obs[0], body="Hand.L"), there) < SAME


def test_turns_are_reshaped_too() -> None:
    act = _act("target", "Hand.L", *BOTH)
    empty = _start(act)
    was = [acts.motion(ob) for ob in act.obs]
    for index, value in enumerate((0.8, 0.6, 0.0, 0.0)):
        _curve(empty, index, "rotation_quaternion").keyframe_points[0].co_ui[1] = value
    bpy.context.view_layer.update()
    places = [np.abs(acts.motion(ob)[0] - motion[0]).max() for ob, motion in zip(act.obs, was, strict=True)]
    assert max(places) == 0.0
    turns = acts.quat.angle_between(acts.motion(act.obs[1])[1][0], was[1][1][0])
    assert turns > 0.1


def test_a_key_put_on_the_stand_in_becomes_a_key_of_the_channel() -> None:
    act = acts.act([acts.creature("biped"), acts.creature("lopside")], Channel("Hands", Context(Capability.GRASPER)))
    empty = _start(act)
    empty.location.z += 0.1
    empty.keyframe_insert("location", frame=3)
    bpy.context.view_layer.update()
    assert {path for path, _ in keys.curves(act.action)} == {keys.path("Hands", "position")}
    assert act.curve("position", 2).keyframe_points[0].co[:] == pytest.approx((3.0, 0.1), abs=SAME)
    ops.finish_specialized()
    assert act.curve("position", 2).keyframe_points[0].co[:] == pytest.approx((3.0, 0.1), abs=SAME)


def test_a_target_that_moves_is_met_at_the_keys() -> None:
    act = _act("target")
    fruit = act.values().target
    for frame, x in ((1, 0.3), (20, -0.2)):
        fruit.location.x = x
        fruit.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_set(5)
    empty = _start(act)
    for index in range(3):
        _curve(empty, index).keyframe_points[2].co_ui[1] += 0.1
    bpy.context.view_layer.update()
    assert bpy.context.scene.frame_current == 5
    for frame in (1, 8, 20):
        bpy.context.scene.frame_set(frame)
        assert np.abs(_place(empty)[:3, 3] - _goal(act, 0, "Hand.L")).max() < SAME


def test_cycles_stay_cycles() -> None:
    act = _act()
    for curve in keys.curves(act.action).values():
        curve.keyframe_points.insert(21, curve.keyframe_points[0].co[1])
        curve.modifiers.new("CYCLES")
    bpy.context.view_layer.update()
    empty = _start(act)
    _curve(empty, 0).keyframe_points[1].co_ui[1] += 0.1
    bpy.context.view_layer.update()
    for frame in (1, 9, 30, 52):
        bpy.context.scene.frame_set(frame)
        assert np.abs(_place(empty)[:3, 3] - _goal(act, 0, "Hand.L")).max() < SAME


def test_stand_ins_of_several_characters_and_direct_edits_show_the_same_keys() -> None:
    act = _act("limb", "Hand.L", *BOTH)
    empties = [_start(act, i) for i in range(2)]
    _curve(empties[0], 0).keyframe_points[0].co_ui[1] += 0.2
    for _ in range(2):  # what one update changes the next one tells of
        bpy.context.view_layer.update()
    act.curve("position", 1).keyframe_points[0].co_ui[1] += 0.2
    for _ in range(2):
        bpy.context.view_layer.update()
    bpy.context.scene.frame_set(2)
    bodies = ["Hand.L", "Hand.L"]
    for i, empty in enumerate(empties):
        assert np.abs(_place(empty)[:3, 3] - _goal(act, i, bodies[i])).max() < SAME
    was = acts.motion(act.obs[0])
    for empty in empties:
        ops.finish_specialized(stand_in=empty.name)
    assert acts.apart(acts.motion(act.obs[0]), was) < SAME


# --- coming and going ---


def test_the_stand_in_and_its_action_are_gone_afterwards() -> None:
    act = _act("limb", "Hand.L", *BOTH)
    _start(act)
    _start(act, 1)
    ops.finish_specialized()
    assert {ob.name for ob in bpy.data.objects} == {"Biped", "Lopside", "Fruit", "Fruit.001", "Biped: Hands"}
    ops.finish_specialized(stand_in="Biped: Hands")
    assert [ob.type for ob in bpy.data.objects].count("EMPTY") == 2
    assert list(bpy.data.actions) == [act.action]
    assert bpy.context.object == act.obs[0]
    with pytest.raises(RuntimeError, match="No channel is edited as specialized curves"):
        ops.finish_specialized()


def test_a_channel_that_selects_nothing_is_told_and_leaves_no_stand_in() -> None:
    act = acts.act([acts.creature("snake")], Channel("Hands", Context(Capability.FOOT)))
    with pytest.raises(RuntimeError, match=r"'Hands' selects nothing on 'Snake': change its context"):
        ops.edit_specialized(character="Snake")
    assert [ob.name for ob in bpy.data.objects] == ["Snake"]
    assert list(bpy.data.actions) == [act.action]


def test_a_renamed_channel_is_edited_on() -> None:
    act = _act()
    empty = _start(act)
    act.channel().name = "Paws"
    _curve(empty, 1).keyframe_points[1].co_ui[1] += 0.1
    bpy.context.view_layer.update()
    _follows(act, empty)
    ops.finish_specialized()
    assert {path for path, _ in keys.curves(act.action)} == {keys.path("Paws", part) for part in keys.DEFAULTS}


def test_a_channel_that_was_deleted_is_told_and_the_curves_are_kept() -> None:
    act = _act()
    ops.add_channel(action="Act", capability="foot")
    empty = _start(act)
    ops.remove_channel(action="Act", channel="Hands")
    bpy.context.view_layer.update()
    assert "'Biped: Hands' shows specialized curves of 'Hands', which is gone: delete it" in act.tell()
    with pytest.raises(RuntimeError, match=r"what 'Biped: Hands' stands for, channel 'Hands', is gone: delete it"):
        ops.finish_specialized(stand_in=empty.name)
    assert len(scenes.curves_of(empty)) == 7
    _curve(empty, 0).keyframe_points[0].co_ui[1] += 0.1
    bpy.context.view_layer.update()
    assert {path for path, _ in keys.curves(act.action)} == set()
    bpy.data.objects.remove(empty)
    assert act.tell() == ""


def test_a_character_that_was_deleted_is_told_and_the_others_play_on() -> None:
    act = _act("limb", "Hand.L", *BOTH)
    empty, keyed = _start(act), scenes.keys_of(act.action)
    bpy.data.objects.remove(act.obs[0])
    bpy.context.view_layer.update()
    with pytest.raises(MotionError, match="'Biped: Hands' stands for, channel 'Hands', is gone: delete it"):
        specialized.finish(empty)
    assert scenes.keys_of(act.action) == keyed
    assert empty.name in bpy.data.objects
    bpy.context.scene.frame_set(9)
    assert len(act.shown(1).bodies) == 3


def test_a_character_that_plays_something_else_now_is_told() -> None:
    act = _act()
    empty = _start(act)
    actions.assign(act.obs[0], None, None)
    with pytest.raises(RuntimeError, match="is gone: delete it"):
        ops.finish_specialized(stand_in=empty.name)
    assert empty.name in bpy.data.objects


def test_a_body_that_is_selected_no_more_is_told() -> None:
    act = _act()
    empty, keyed = _start(act), scenes.keys_of(act.action)
    act.channel().context.side = "right"
    _curve(empty, 0).keyframe_points[0].co_ui[1] += 0.1
    with pytest.raises(RuntimeError, match=r"'Hands' does not select 'Hand.L' on 'Biped': change its context"):
        ops.finish_specialized(stand_in=empty.name)
    assert scenes.keys_of(act.action) == keyed
    act.channel().context.side = "any"
    ops.finish_specialized(stand_in=empty.name)
    assert scenes.keys_of(act.action) != keyed
