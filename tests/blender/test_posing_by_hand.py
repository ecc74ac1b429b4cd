"""Posing with Blender's own tools: one bone is moved, and all bodies on all characters follow (Hecker 2008 §3.2)."""

import bpy
import numpy as np
import pytest
from mathutils import Matrix

from morph_retarget.blender import actions
from morph_retarget.blender.morph import autokey, cast, keys
from morph_retarget.blender.morph.properties import of_action
from morph_retarget.blender.properties import of_rig
from morph_retarget.core import quat
from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.morph.channels import Channel, MirrorRule
from morph_retarget.core.morph.context import Context
from morph_retarget.core.morph.movement import Movement, RotationMode, ScaleMode
from tests.blender import acts, scenes
from tests.blender.acts import Act

ops = bpy.ops.morph_retarget
HANDS = Channel("Hands", Context(Capability.GRASPER), Movement(scale=ScaleMode.LIMB_LENGTH), mirror=MirrorRule.LEFT)
HEAD = Channel("Head", Context(Capability.HEAD), Movement(rotation=RotationMode.ABSOLUTE), poses_position=False)

pytestmark = pytest.mark.usefixtures("registered")


@pytest.fixture
def act() -> Act:
    """Return two creatures that move their hands and heads, the first of them in Pose mode."""
    made = acts.act([acts.creature(name) for name in ("biped", "lopside")], HANDS, HEAD)
    _pose(made)
    return made


def _pose(act: Act) -> None:
    act.obs[0].select_set(True)
    bpy.ops.object.mode_set(mode="POSE")


def _hold(act: Act, bone: str) -> bpy.types.PoseBone:
    """Return a bone of the first character, which becomes the active one."""
    ob = act.obs[0]
    ob.data.bones.active = ob.data.bones[bone]
    return ob.pose.bones[bone]


def _move(act: Act, bone: str, by: tuple[float, float, float]) -> None:
    """Move a bone by a way in the character frame, as Blender's own Move does."""
    held = _hold(act, bone)
    held.matrix = Matrix.Translation(by) @ held.matrix
    bpy.context.view_layer.update()


def _turn(act: Act, bone: str, turn: tuple[float, float, float, float]) -> None:
    _hold(act, bone).rotation_quaternion = quat.normalize(np.array(turn)).tolist()
    bpy.context.view_layer.update()


def _goals(act: Act, i: int) -> dict[str, np.ndarray]:
    goals = act.shown(i)
    names = [cast.member(act.obs[i]).bodies.names[body] for body in goals.bodies]
    return {name: goals.positions[0, k] - _rest(act, i, name) for k, name in enumerate(names)}


def _rest(act: Act, i: int, bone: str) -> np.ndarray:
    bodies = cast.member(act.obs[i]).bodies
    return bodies.positions[bodies.names.index(bone)]


def _limb(act: Act, i: int, bone: str) -> float:
    bodies = cast.member(act.obs[i]).bodies
    return float(bodies.limb_lengths[bodies.names.index(bone)])


# --- from one bone to all bodies ---


def test_a_moved_hand_moves_all_hands_on_all_characters_at_once(act: Act) -> None:
    way = (0.05, -0.2, 0.1)
    _move(act, "Hand.L", way)
    unit = np.array(way) / _limb(act, 0, "Hand.L")
    assert act.values().position[:] == pytest.approx(unit, abs=1e-5)
    for i in range(2):
        for bone, moved in _goals(act, i).items():
            if "Hand" in bone:
                mirror = np.array([-1.0 if bone.endswith(".R") else 1.0, 1.0, 1.0])
                assert moved == pytest.approx(unit * mirror * _limb(act, i, bone), abs=1e-5), (i, bone)


def test_the_bone_that_is_held_stays_in_the_hand_and_the_others_of_its_character_follow(act: Act) -> None:
    ob = act.obs[0]
    start = acts.heads(ob, ["Hand.L", "Hand.R"])
    way = np.array([-0.1, -0.15, 0.05])
    _move(act, "Hand.L", tuple(way))
    bpy.context.view_layer.update()
    there = acts.heads(ob, ["Hand.L", "Hand.R"])
    assert there[0] - start[0] == pytest.approx(way, abs=1e-5)
    assert there[1] - start[1] == pytest.approx(way * [-1, 1, 1], abs=2e-3)


def test_a_turned_forearm_moves_the_hand_that_is_posed(act: Act) -> None:
    """The forearm itself is posed by no channel, but the hand that it carries is, when that is the active bone."""
    ob = act.obs[0]
    _hold(act, "Hand.L")
    ob.pose.bones["LowerArm.L"].rotation_quaternion = (0.9, 0.3, 0.2, 0.1)
    bpy.context.view_layer.update()
    place = acts.heads(ob, ["Hand.L"])[0]
    assert np.abs(np.array(act.values().position)).max() > 0.05
    assert _goals(act, 0)["Hand.L"] + _rest(act, 0, "Hand.L") == pytest.approx(place, abs=1e-5)
    moved = _goals(act, 1)["Hand.L"]
    assert moved / _limb(act, 1, "Hand.L") == pytest.approx(np.array(act.values().position), abs=1e-5)


def test_a_turned_forearm_that_is_active_itself_poses_the_hand_too(act: Act) -> None:
    _turn(act, "LowerArm.L", (0.9, 0.3, 0.2, 0.1))
    place = acts.heads(act.obs[0], ["Hand.L"])[0]
    assert _goals(act, 0)["Hand.L"] + _rest(act, 0, "Hand.L") == pytest.approx(place, abs=1e-5)


def test_a_turned_head_turns_all_heads_to_the_same_orientation(act: Act) -> None:
    _turn(act, "Head", (0.9, 0.1, 0.3, 0.0))
    found = []
    for i in range(2):
        goals, bodies = act.shown(i), cast.member(act.obs[i]).bodies
        place = [bodies.names[b] for b in goals.bodies].index("Head")
        found.append(quat.multiply(goals.turns[0, place], bodies.axes[bodies.names.index("Head")]))
    assert max(float(quat.angle_between(turn, found[0])) for turn in found) < 1e-5
    assert float(quat.angle_between(found[0], quat.IDENTITY)) > 0.3
    assert act.values(0, "Hands").position[:] == (0.0, 0.0, 0.0)


def test_the_active_channel_wins_where_several_pose_a_bone() -> None:
    channels = [Channel(name, Context(Capability.GRASPER), blend_group="hands") for name in ("Low", "High")]
    act = acts.act([acts.creature("biped")], *channels)
    _pose(act)
    for active, name in ((1, "High"), (0, "Low")):
        of_action(act.action).active_channel = active
        before = [tuple(act.values(0, c.name).position) for c in channels]
        _move(act, "Hand.L", (0.0, -0.1, 0.0))
        autokey.settle(bpy.context.scene)
        after = [tuple(act.values(0, c.name).position) for c in channels]
        changed = [c.name for c, a, b in zip(channels, before, after, strict=True) if a != b]
        assert changed == [name]


def test_the_active_body_is_the_one_that_was_moved_last(act: Act) -> None:
    for bone in ("Hand.R", "Hand.L"):
        _move(act, bone, (0.0, -0.1, 0.0))
        assert act.values().active_body == bone
        autokey.settle(bpy.context.scene)


def test_a_bone_that_no_channel_poses_changes_no_values(act: Act) -> None:
    _turn(act, "UpperLeg.L", (0.9, 0.3, 0.0, 0.0))
    assert [tuple(item.position) for item in of_rig(act.obs[0]).channels] == [(0.0, 0.0, 0.0)] * 2
    assert acts.heads(act.obs[0], ["Foot.L"])[0] != pytest.approx(_rest(act, 0, "Foot.L"), abs=1e-2)


def test_nothing_is_taken_for_a_pose_in_object_mode(act: Act) -> None:
    bpy.ops.object.mode_set(mode="OBJECT")
    _turn(act, "Head", (0.9, 0.1, 0.3, 0.0))
    assert tuple(act.values(0, "Head").rotation) == (1.0, 0.0, 0.0, 0.0)


def test_the_pose_stays_when_the_drag_is_over_and_is_the_same_after_another_frame(act: Act) -> None:
    _move(act, "Hand.L", (0.1, -0.2, 0.1))
    autokey.settle(bpy.context.scene)
    there = acts.heads(act.obs[0], ["Hand.L", "Hand.R"])
    bpy.context.scene.frame_set(9)
    assert np.abs(acts.heads(act.obs[0], ["Hand.L", "Hand.R"]) - there).max() < 1e-5


# --- keys ---


def _auto(on: bool = True) -> None:
    bpy.context.scene.tool_settings.use_keyframe_insert_auto = on


def _blender_keys(act: Act) -> None:
    """Key bones as Blender's auto-keying does at the end of a drag."""
    for bone in ("Hand.L", "LowerArm.L"):
        act.obs[0].pose.bones[bone].keyframe_insert("location")
        act.obs[0].pose.bones[bone].keyframe_insert("rotation_quaternion")


@pytest.mark.parametrize("on", [True, False])
def test_a_finished_drag_is_keyed_where_auto_keying_is_on_and_bones_are_not(act: Act, on: bool) -> None:
    _auto(on)
    bpy.context.scene.frame_set(4)
    _move(act, "Hand.L", (0.1, -0.2, 0.1))
    _blender_keys(act)
    value = tuple(act.values().position)
    autokey.settle(bpy.context.scene)
    found = keys.curves(act.action)
    assert {path for path, _ in found} == ({keys.path("Hands", p) for p in ("position", "rotation")} if on else set())
    assert tuple(act.values().position) == value
    if on:
        assert [act.curve("position", i).keyframe_points[0].co[:] for i in range(3)] == [(4.0, v) for v in value]
        bpy.context.scene.frame_set(5)
        assert tuple(act.values(1).position) == pytest.approx(value)


def test_only_what_the_channel_poses_is_keyed(act: Act) -> None:
    _auto()
    _turn(act, "Head", (0.9, 0.1, 0.3, 0.0))
    autokey.settle(bpy.context.scene)
    assert {path for path, _ in keys.curves(act.action)} == {keys.path("Head", "rotation")}


def test_bone_keys_of_other_bones_are_kept(act: Act) -> None:
    _auto()
    act.obs[0].pose.bones["Toes.L"].keyframe_insert("rotation_quaternion")
    _move(act, "Hand.L", (0.1, -0.2, 0.1))
    _blender_keys(act)
    autokey.settle(bpy.context.scene)
    bones = {path for path, _ in keys.curves(act.action) if path.startswith("pose.")}
    assert bones == {'pose.bones["Toes.L"].rotation_quaternion'}


def test_keyed_poses_play(act: Act) -> None:
    _auto()
    scene, wanted = bpy.context.scene, {}
    for frame, way in ((1, (0.1, -0.2, 0.1)), (11, (-0.05, -0.1, -0.1)), (21, (0.0, 0.1, 0.2))):
        scene.frame_set(frame)
        _move(act, "Hand.L", way)
        autokey.settle(scene)
        wanted[frame] = [acts.heads(ob, ["Hand.L", "Hand.R"]) for ob in act.obs]
    for frame, heads in wanted.items():
        scene.frame_set(frame)
        for ob, there in zip(act.obs, heads, strict=True):
            assert np.abs(acts.heads(ob, ["Hand.L", "Hand.R"]) - there).max() < 1e-4


# --- values in the panel ---


def test_values_set_in_the_panel_are_those_of_all_characters(act: Act) -> None:
    act.values(1).position = (0.1, 0.2, 0.3)
    act.values(1, "Head").weight = 0.5
    assert [tuple(act.values(i).position) for i in range(2)] == [pytest.approx((0.1, 0.2, 0.3))] * 2
    assert [act.values(i, "Head").weight for i in range(2)] == [0.5] * 2
    bpy.context.view_layer.update()
    assert _goals(act, 1)["Hand.L"] / _limb(act, 1, "Hand.L") == pytest.approx((0.1, 0.2, 0.3), abs=1e-6)
    assert not keys.curves(act.action)


def test_values_set_in_the_panel_are_keyed_where_there_is_a_curve(act: Act) -> None:
    _auto()
    act.values().position = (0.1, 0.2, 0.3)
    assert not keys.curves(act.action)
    keys.insert(act.obs[0], "Hands", ["position"], 1)
    bpy.context.scene.frame_set(11)
    act.values(1).position = (0.4, 0.5, 0.6)
    act.values(1).weight = 0.5
    assert {path for path, _ in keys.curves(act.action)} == {keys.path("Hands", "position")}
    assert [act.curve("position", i).evaluate(11) for i in range(3)] == pytest.approx([0.4, 0.5, 0.6])
    _auto(False)
    act.values(1).position = (0.0, 0.0, 0.0)
    assert [act.curve("position", i).evaluate(11) for i in range(3)] == pytest.approx([0.4, 0.5, 0.6])


# --- Blender's own keying ---


def test_keys_by_number_get_names(act: Act) -> None:
    item = act.values(0, "Head")
    item.rotation = (0.8, 0.6, 0.0, 0.0)
    act.obs[0].keyframe_insert(item.path_from_id("rotation"), frame=3)
    bpy.context.view_layer.update()
    assert {path for path, _ in keys.curves(act.action)} == {keys.path("Head", "rotation")}
    assert act.curve("rotation", 1, "Head").group.name == "Head"
    assert act.curve("rotation", 1, "Head").evaluate(3) == pytest.approx(0.6)


def test_keys_by_number_join_the_curves_that_are_there(act: Act) -> None:
    act.key(1, position=(0.1, 0.2, 0.3))
    item = act.values()
    for frame, x in ((11, 0.5), (1, 0.4)):
        item.position = (x, 0.0, 0.0)
        act.obs[0].keyframe_insert(item.path_from_id("position"), frame=frame)
        bpy.context.view_layer.update()
    assert {path for path, _ in keys.curves(act.action)} == {keys.path("Hands", "position")}
    assert [point.co[:] for point in act.curve().keyframe_points] == [(1.0, pytest.approx(0.4)), (11.0, 0.5)]


def test_characters_with_items_in_another_order_get_their_own_values(act: Act) -> None:
    bpy.ops.object.mode_set(mode="OBJECT")
    other = of_rig(act.obs[1]).channels
    other.move(0, 1)
    assert [item.name for item in other] == ["Head", "Hands"]
    act.values(0, "Head").rotation, act.values().position = (0.8, 0.6, 0.0, 0.0), (0.1, 0.2, 0.3)
    for i, name, part in ((0, "Head", "rotation"), (1, "Hands", "position"), (0, "Head", "weight")):
        bpy.context.view_layer.objects.active = act.obs[i]
        act.obs[i].keyframe_insert(act.values(i, name).path_from_id(part), frame=5)
        bpy.context.view_layer.update()
    assert {path for path, _ in keys.curves(act.action)} == {
        keys.path("Hands", "position"),
        keys.path("Head", "rotation"),
        keys.path("Head", "weight"),
    }
    for item in (act.values(0), act.values(1)):
        item.position = (9.0, 9.0, 9.0)
    bpy.context.scene.frame_set(5)
    for i in range(2):
        assert act.values(i).position[:] == pytest.approx((0.1, 0.2, 0.3))
        assert act.values(i, "Head").rotation[:] == pytest.approx((0.8, 0.6, 0.0, 0.0))


def test_deforms_are_keyed_by_name(act: Act) -> None:
    ops.add_deform(action="Act", channel="Hands", name='open "wide"')
    deform = act.values().deforms[0]
    deform.value = 0.7
    act.obs[0].keyframe_insert(deform.path_from_id("value"), frame=2)
    bpy.context.view_layer.update()
    assert [path for path, _ in keys.curves(act.action)] == [keys.deform_path("Hands", 'open "wide"')]
    bpy.context.scene.frame_set(2)
    assert act.values(1).deforms[0].value == pytest.approx(0.7)


def _keying_set() -> None:
    window = bpy.context.window_manager.windows[0]
    area = next(area for area in window.screen.areas if area.type == "VIEW_3D")
    with bpy.context.temp_override(window=window, area=area):
        bpy.ops.anim.keyframe_insert_by_name(type="MORPHRETARGET_KS_channels")
    bpy.context.view_layer.update()


def test_the_keying_set_keys_the_channels_of_the_selected_bones(act: Act) -> None:
    scene = bpy.context.scene
    scene.frame_set(6)
    ops.select_bodies(channel="Head", character="Biped")
    act.values(0, "Head").rotation = (0.8, 0.6, 0.0, 0.0)
    _keying_set()
    assert {path for path, _ in keys.curves(act.action)} == {keys.path("Head", p) for p in ("position", "rotation")}
    assert act.curve("rotation", 1, "Head").evaluate(6) == pytest.approx(0.6)
    ops.select_bodies(channel="Hands", character="Biped")
    _keying_set()
    assert {path for path, _ in keys.curves(act.action)} >= {keys.path("Hands", "position")}


def test_the_keying_set_keys_the_active_channel_in_object_mode(act: Act) -> None:
    bpy.ops.object.mode_set(mode="OBJECT")
    of_action(act.action).active_channel = 0
    _keying_set()
    assert {path for path, _ in keys.curves(act.action)} == {keys.path("Hands", p) for p in ("position", "rotation")}


# --- what else acts on curves ---


def _hand_at(act: Act, i: int, frame: float) -> np.ndarray:
    bpy.context.scene.frame_set(int(frame), subframe=frame % 1.0)
    return acts.heads(act.obs[i], ["Hand.L"])[0]


def _keyed(act: Act) -> None:
    for frame, x in ((1, 0.0), (11, -0.3), (21, 0.0)):
        act.key(frame, position=(x, -0.2, 0.1))


def test_cycles_go_on_for_all_characters(act: Act) -> None:
    _keyed(act)
    for curve in keys.curves(act.action).values():
        curve.modifiers.new("CYCLES")
    for i in range(2):
        assert np.abs(_hand_at(act, i, 47) - _hand_at(act, i, 7)).max() < 1e-5
        assert np.abs(_hand_at(act, i, 51) - _hand_at(act, i, 1)).max() > 0.01


def test_strips_play_the_action_later_and_slower(act: Act) -> None:
    _keyed(act)
    wanted = [_hand_at(act, i, 6) for i in range(2)]
    for ob in act.obs:
        data = ob.animation_data
        strip = data.nla_tracks.new().strips.new("Later", 101, act.action)
        strip.action_slot = data.action_slot
        strip.scale = 2.0
        data.action = None
    for i in range(2):
        assert cast.action_of(act.obs[i]) == act.action
        assert np.abs(_hand_at(act, i, 111) - wanted[i]).max() < 1e-5


def test_a_second_action_lies_over_the_first_in_strips(act: Act) -> None:
    _keyed(act)
    second = act.action.copy()
    second.name = "Second"
    for curve in keys.curves(second).values():
        for point in curve.keyframe_points:
            point.co_ui[1] *= 0.5
        curve.update()
    ob = act.obs[0]
    data = ob.animation_data
    data.action = None
    for name, action in (("First", act.action), ("Second", second)):
        track = data.nla_tracks.new()
        strip = track.strips.new(name, 1, action)
        strip.action_slot = action.slots[0]
    strip.blend_type = "ADD"
    bpy.context.scene.frame_set(11)
    assert of_rig(ob).channels["Hands"].position[0] == pytest.approx(-0.45)
    assert cast.action_of(ob) == second
    assert _goals(act, 0)["Hand.L"][0] / _limb(act, 0, "Hand.L") == pytest.approx(-0.45)


def test_drivers_drive_values_of_one_character(act: Act) -> None:
    knob = acts.empty_object("Knob", (0.0, 0.0, 0.0))
    curve = act.obs[1].driver_add(keys.path("Hands", "position"), 2)
    variable = curve.driver.variables.new()
    variable.targets[0].id, variable.targets[0].data_path = knob, "location.z"
    variable.type, curve.driver.type = "SINGLE_PROP", "SUM"
    before = [acts.heads(ob, ["Hand.L"])[0] for ob in act.obs]
    knob.location.z = 0.3
    bpy.context.view_layer.update()
    bpy.context.view_layer.update()
    moved = [np.abs(acts.heads(ob, ["Hand.L"])[0] - old).max() for ob, old in zip(act.obs, before, strict=True)]
    assert moved[1] > 0.05
    assert moved[0] < 1e-5


def test_a_curve_edited_in_the_graph_editor_moves_all_characters_at_once(act: Act) -> None:
    _keyed(act)
    bpy.context.scene.frame_set(11)
    before = [acts.heads(ob, ["Hand.L"])[0] for ob in act.obs]
    act.curve("position", 2).keyframe_points[1].co_ui[1] += 0.2
    bpy.context.view_layer.update()
    for ob, old in zip(act.obs, before, strict=True):
        assert acts.heads(ob, ["Hand.L"])[0][2] - old[2] > 0.02


def test_a_renamed_channel_keeps_its_curves_and_values_everywhere(act: Act) -> None:
    _keyed(act)
    ops.add_deform(action="Act", channel="Hands", name="open")
    keys.insert(act.obs[0], "Hands", ["deforms"], 1)
    target = acts.empty_object("Fruit", (0, 0, 0))
    act.values(1).target = target
    strip = act.obs[1].animation_data.nla_tracks.new().strips.new("Act", 1, act.action)
    strip.action_slot = act.obs[1].animation_data.action_slot
    act.obs[1].animation_data.action = None
    wanted = [_hand_at(act, i, 6) for i in range(2)]
    act.channel("Hands").name = 'Paws "1"'
    bpy.context.view_layer.update()
    assert len(keys.curves(act.action)) == 4
    assert {path.startswith(keys.prefix('Paws "1"')) for path, _ in keys.curves(act.action)} == {True}
    assert {curve.group.name for curve in keys.curves(act.action).values()} == {'Paws "1"'}
    for i in range(2):
        assert [item.name for item in of_rig(act.obs[i]).channels] == ['Paws "1"', "Head"]
        assert np.abs(_hand_at(act, i, 6) - wanted[i]).max() < 1e-6
    assert act.values(1, 'Paws "1"').target == target


def test_a_channel_can_take_the_name_of_one_that_was_there_before(act: Act) -> None:
    _keyed(act)
    ops.remove_channel(action="Act", channel="Head")
    wanted = [_hand_at(act, i, 6) for i in range(2)]
    act.values(0, "Head").position = (5.0, 5.0, 5.0)
    act.channel("Hands").name = "Head"
    for i in range(2):
        assert np.abs(_hand_at(act, i, 6) - wanted[i]).max() < 1e-6
    assert [item.name for item in of_rig(act.obs[0]).channels] == ["Head"]


def test_names_stay_unlike_each_other(act: Act) -> None:
    act.channel("Hands").name = "Head"
    assert [item.name for item in of_action(act.action).channels] == ["Head.001", "Head"]
    assert {item.name for item in of_rig(act.obs[1]).channels} == {"Head.001", "Head"}
    act.channel("Head.001").name = ""
    assert act.channel().name == "Channel"


def test_a_bone_curve_that_plays_beside_the_channels_is_no_pose_of_the_animator(act: Act) -> None:
    writer_path = act.obs[0].pose.bones["Toes.L"].path_from_id("rotation_quaternion")
    for frame, angle in ((1, 0.0), (11, 0.5)):
        act.obs[0].pose.bones["Toes.L"].rotation_quaternion = (1.0, angle, 0.0, 0.0)
        act.obs[0].keyframe_insert(writer_path, frame=frame)
    _hold(act, "Hand.L")
    for frame in (3, 9):
        bpy.context.scene.frame_set(frame)
        bpy.context.view_layer.update()
    assert tuple(act.values().position) == (0.0, 0.0, 0.0)
    assert actions.assigned(act.obs[0])[0] == act.action
    assert scenes.curves_of(act.obs[0])
