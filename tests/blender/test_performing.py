"""What characters show: a function of the frame alone, on armatures of every kind, placed anywhere."""

from pathlib import Path

import bpy
import numpy as np
import pytest
from mathutils import Matrix

from morph_retarget.blender import handlers
from morph_retarget.blender.morph import cast, perform, stage
from morph_retarget.blender.morph.member import Member
from morph_retarget.blender.properties import of_rig
from morph_retarget.core.arrays import Array
from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.errors import MotionError
from morph_retarget.core.morph.channels import Channel, MirrorRule, TargetKind
from morph_retarget.core.morph.context import Context, Side
from morph_retarget.core.morph.movement import Movement, ScaleMode
from tests.blender import acting, acts, scenes, window
from tests.blender.acts import Act
from tools import armatures, creatures

LIMB = Movement(scale=ScaleMode.LIMB_LENGTH)
HANDS = Channel("Hands", Context(Capability.GRASPER), LIMB, mirror=MirrorRule.LEFT)
FEET = Channel("Feet", Context(Capability.FOOT, side=Side.LEFT), LIMB)
HEAD = Channel("Head", Context(Capability.HEAD), poses_position=False)
ROOT = Channel("Root", Context(Capability.ROOT), LIMB)
REACH = Channel(
    "Reach", Context(Capability.GRASPER, side=Side.LEFT), Movement(secondary_relative=True), TargetKind.EXTERNAL
)
FRAMES = [1, 5, 12.5, 20]

pytestmark = pytest.mark.usefixtures("registered")


def _dance(obs: list[bpy.types.Object], name: str = "Dance") -> Act:
    """Return characters that move their hands, a foot, head and root from frame 1 to 20."""
    act = acts.act(obs, HANDS, FEET, HEAD, ROOT, name=name)
    for frame, share in ((1, 0.0), (10, 1.0), (20, -0.5)):
        act.key(frame, "Hands", position=(0.1 * share, -0.3 * share, 0.1), rotation=(0.9, 0.3 * share, 0.0, 0.2))
        act.key(frame, "Feet", position=(0.0, -0.1, 0.1 * share))
        act.key(frame, "Head", rotation=(0.9, 0.1, 0.0, 0.4 * share))
        act.key(frame, "Root", position=(0.05 * share, 0.0, -0.05), rotation=(0.99, 0.0, 0.0, 0.1 * share))
    return act


def _shown(ob: bpy.types.Object, frames: list[float]) -> Array:
    """Return all bones of a character in the world, shape (frame, bone, 4, 4)."""
    return scenes.evaluated(ob, ob.pose.bones.keys(), frames)


# --- frames ---


def test_what_is_shown_depends_on_the_frame_alone() -> None:
    act = _dance([acts.creature("biped"), acts.creature("hound")])
    steps = np.arange(1.0, 21.0, 1.5).tolist()
    stepped = [_shown(ob, steps) for ob in act.obs]
    order = np.random.default_rng(2).permutation(len(steps))
    for ob, there in zip(act.obs, stepped, strict=True):
        jumped = _shown(ob, [steps[i] for i in order])
        assert np.abs(jumped - there[order]).max() < 1e-6
        assert np.abs(there[0] - there[-1]).max() > 0.05


def test_drops_of_run_time_state_change_nothing() -> None:
    act = _dance([acts.creature("biped")])
    there = _shown(act.obs[0], FRAMES)
    perform.forget()
    cast.forget(rig=True)
    assert np.abs(_shown(act.obs[0], FRAMES) - there).max() < 1e-6


def test_a_bone_that_is_moved_by_hand_in_object_mode_comes_back_with_the_next_frame() -> None:
    act = _dance([acts.creature("biped")])
    ob = act.obs[0]
    there = _shown(ob, [9])
    for name in ("Hand.L", "UpperArm.L", "Hips"):
        ob.pose.bones[name].matrix_basis = Matrix.Rotation(0.5, 4, "X") @ Matrix.Translation((0.1, 0.0, 0.0))
    bpy.context.scene.frame_set(4)
    assert np.abs(_shown(ob, [9]) - there).max() < 1e-6


def test_six_characters_share_one_slot_and_one_set_of_curves() -> None:
    names = ["biped", "asura", "lopside", "hound", "beetle", "bird"]
    act = _dance([acts.creature(name) for name in names])
    assert len(act.action.slots) == 1
    assert {ob.animation_data.action_slot.identifier for ob in act.obs} == {act.action.slots[0].identifier}
    assert len(list(act.action.layers[0].strips[0].channelbags)) == 1
    for ob in act.obs:
        found = _shown(ob, [1, 10])
        assert np.abs(found[0] - found[1]).max() > 0.02
    curve = act.curve("position", 2, "Root")
    before = [_shown(ob, [10]) for ob in act.obs]
    curve.keyframe_points[1].co_ui[1] += 0.2
    bpy.context.view_layer.update()
    for ob, was in zip(act.obs, before, strict=True):
        now = np.array([np.array(ob.matrix_world) @ matrix for matrix in acts.pose(ob)])
        assert np.abs(now - was[0]).max() > 0.01


def test_a_skinned_mesh_is_rendered_where_the_bones_are(tmp_path: Path) -> None:
    act = acts.act([acts.character("biped")], HANDS)
    for frame, y in ((1, 0.0), (20, -0.6)):
        act.key(frame, position=(0.0, y, 0.3))
    scenes.close_up(scenes.heads(act.obs[0], ["Hand.L"], [20])[0, 0], 0.05)
    bpy.context.scene.frame_set(1)
    assert [scenes.covered(frame, tmp_path, str(frame)).max() for frame in (20, 1)] == [1.0, 0.0]


def test_motion_blur_is_that_of_the_baked_action(tmp_path: Path) -> None:
    act = acts.act([acts.character("biped")], HANDS)
    [ob] = act.obs
    for frame, y in ((1, 0.3), (6, -0.6)):
        act.key(frame, position=(0.0, y, 0.3))
    scenes.close_up(scenes.heads(ob, ["Hand.L"], [4])[0, 0], 0.5, 24, 16)
    sharp = scenes.covered(4, tmp_path, "sharp")
    bpy.context.scene.render.use_motion_blur = True
    live = scenes.covered(4, tmp_path, "live")
    acting.baked(ob)
    baked = scenes.covered(4, tmp_path, "baked")
    assert np.abs(live - sharp).mean() > 0.02, "the hand moves while the shutter is open"
    # Baked keys go straight from frame to frame, and 16 samples leave some noise.
    assert np.abs(live - baked).mean() < 0.3 * np.abs(live - sharp).mean()


def test_motion_blur_asks_for_frames_between_and_leaves_no_trace() -> None:
    act = _dance([acts.creature("biped")])
    there = _shown(act.obs[0], [5])
    for frame in (4.75, 5.25, 4.9):
        bpy.context.scene.frame_set(int(frame), subframe=frame % 1.0)
    assert np.abs(_shown(act.obs[0], [5]) - there).max() < 1e-6


# --- what may go wrong ---


def test_one_character_that_cannot_play_does_not_stop_the_others(monkeypatch: pytest.MonkeyPatch) -> None:
    act = _dance([acts.creature(name) for name in ("biped", "asura", "lopside")])
    real = stage.told_targets

    def told_targets(member: Member, ob: bpy.types.Object, graph: bpy.types.Depsgraph) -> object:
        if ob == act.obs[1]:
            raise MotionError("'Asura' is on strike: pay it")
        return real(member, ob, graph)

    monkeypatch.setattr(stage, "told_targets", told_targets)
    bpy.context.scene.frame_set(15)
    assert [act.tell(i) for i in range(3)] == ["", "'Asura' is on strike: pay it", ""]
    for i in (0, 2):
        assert np.abs(_shown(act.obs[i], [1]) - _shown(act.obs[i], [10])).max() > 0.05
    monkeypatch.undo()
    bpy.context.scene.frame_set(15)
    assert act.tell(1) == ""


def test_unregistering_leaves_no_handlers_and_registering_again_plays_on() -> None:
    act = _dance([acts.creature("biped")])
    there = _shown(act.obs[0], [9])
    window.registration.unregister()
    try:
        for found, handler in handlers._pairs():
            assert handler not in found
            assert not [f for f in found if getattr(f, "__module__", "").startswith("morph_retarget")]
        bpy.context.scene.frame_set(15)
        assert np.abs(_shown(act.obs[0], [9]) - there).max() < 1e-6
    finally:
        window.registration.register("morph_retarget")
    bpy.context.scene.frame_set(15)
    assert np.abs(_shown(act.obs[0], [9]) - there).max() < 1e-6
    assert np.abs(_shown(act.obs[0], [1]) - there).max() > 0.05


def test_a_character_that_is_removed_while_it_plays_is_forgotten() -> None:
    act = _dance([acts.creature("biped"), acts.creature("asura")])
    bpy.data.objects.remove(act.obs[0])
    bpy.context.scene.frame_set(7)
    assert np.abs(_shown(act.obs[1], [1]) - _shown(act.obs[1], [10])).max() > 0.05


# --- places ---


PLACES = {
    "turned": scenes.matrix((30, -50, 70), 1.0, (1, -2, 0.5)),
    "centimetres": scenes.matrix((90, 0, 0), 0.01, (0.3, 0, 0)),
    "large": scenes.matrix((0, 0, 180), 25.0),
    "mirrored": scenes.matrix((0, 20, 0), (-1.0, 1.0, 1.0), (0, 1, 0)),
}


@pytest.mark.parametrize("place", PLACES)
def test_an_armature_may_be_placed_turned_scaled_and_mirrored(place: str) -> None:
    """What matters is the figure that one sees in the world: its bones are where those of a plain armature are."""
    matrix = PLACES[place]
    plain, odd = scenes.figure("Plain"), scenes.figure("Odd", seed=3, place=matrix)
    channels = [HANDS, FEET, HEAD, ROOT]
    act = acts.act([plain, odd], *channels, REACH)
    fruit = acts.empty_object("Fruit", (0.3, -0.5, 1.2))
    for i in range(2):
        act.values(i, "Reach").target = fruit
    for frame, share in ((1, 0.0), (20, 1.0)):
        act.key(frame, "Hands", position=(0.1 * share, -0.3 * share, 0.1))
        act.key(frame, "Root", position=(0.05 * share, 0.0, -0.05 * share), rotation=(0.99, 0.0, 0.0, 0.1 * share))
        act.key(frame, "Head", rotation=(0.9, 0.1, 0.0, 0.4 * share))
    bones = [bone.name for bone in plain.pose.bones if bone.name != "root"]
    there, found = (scenes.heads(ob, bones, FRAMES) for ob in act.obs)
    assert np.abs(found - there).max() < 1e-3
    assert np.abs(there[0] - there[-1]).max() > 0.1


@pytest.mark.parametrize("place", PLACES)
def test_a_hand_meets_a_target_in_the_world_wherever_its_character_stands(place: str) -> None:
    act = acts.act([scenes.figure("Odd", seed=3, place=PLACES[place])], REACH)
    ob = act.obs[0]
    act.key(1, position=(1.0, 0.0, 0.0))
    fruit = act.values().target = acts.empty_object("Fruit", (0.4, -0.3, 1.1))
    for where in ((0.4, -0.3, 1.1), (0.3, -0.4, 1.3)):
        fruit.location = where
        bpy.context.view_layer.update()
        bpy.context.view_layer.update()
        assert np.abs(acts.heads(ob, ["leftHand"])[0] - where).max() < 5e-3
    carrier = acts.empty_object("Carrier", (0.0, 0.0, 0.0))
    ob.parent, ob.matrix_parent_inverse = carrier, carrier.matrix_world.inverted()
    carrier.location, carrier.rotation_euler = (0.05, -0.05, 0.0), (0.0, 0.0, 0.2)
    bpy.context.view_layer.update()
    bpy.context.view_layer.update()
    assert np.abs(acts.heads(ob, ["leftHand"])[0] - fruit.location).max() < 5e-3


def test_a_target_that_rides_on_something_is_followed() -> None:
    act = acts.act([acts.creature("biped")], REACH)
    act.key(1, position=(1.0, 0.0, 0.0))
    fruit = act.values().target = acts.empty_object("Fruit", (0.1, 0.0, 0.0))
    cart = acts.empty_object("Cart", (0.2, -0.25, 1.1))
    fruit.parent, cart.scale = cart, (1.0, 1.0, 2.0)
    for frame, z in ((1, 1.1), (20, 1.4)):
        cart.location.z = z
        cart.keyframe_insert("location", frame=frame)
    for frame in (20, 1, 10):
        bpy.context.scene.frame_set(frame)
        assert np.abs(acts.heads(act.obs[0], ["Hand.L"])[0] - np.array(fruit.matrix_world.translation)).max() < 5e-3


# --- armatures ---


@pytest.mark.parametrize("mode", ["XYZ", "ZXY", "AXIS_ANGLE"])
def test_bones_of_every_rotation_mode_play_the_same(mode: str) -> None:
    plain, odd = acts.creature("biped"), acts.creature("biped")
    for i, bone in enumerate(odd.pose.bones):
        bone.rotation_mode = mode if i % 3 else "QUATERNION"
    act = _dance([plain, odd])
    there, found = (_shown(ob, FRAMES) for ob in act.obs)
    assert np.abs(found - there).max() < 1e-5


@pytest.mark.parametrize("setting", ["use_inherit_rotation", "use_local_location", "use_connect"])
def test_bones_that_inherit_otherwise_play_the_same(setting: str) -> None:
    plain, odd = acts.creature("biped"), acts.creature("biped")
    if setting == "use_connect":
        bpy.ops.object.mode_set(mode="EDIT")
        for bone in odd.data.edit_bones:
            bone.use_connect = bone.parent is not None and (bone.head - bone.parent.tail).length < 1e-4
        assert any(bone.use_connect for bone in odd.data.edit_bones)
        bpy.ops.object.mode_set(mode="OBJECT")
    else:
        for name in ("Hips", "Head", "UpperArm.L", "Hand.L", "Foot.L"):
            setattr(odd.data.bones[name], setting, False)
    act = _dance([plain, odd])
    bones = ["Hips", "Chest", "Head", "Jaw", "UpperArm.L", "Hand.L", "Hand.R", "Foot.L", "Toes.L"]
    there, found = (scenes.heads(ob, bones, FRAMES) for ob in act.obs)
    assert np.abs(found - there).max() < 1e-4


def test_a_root_that_is_connected_to_what_carries_it_moves_by_that() -> None:
    bones = creatures.biped()
    odd = armatures.build("Odd", bones, np.random.default_rng(7))
    bpy.ops.object.mode_set(mode="EDIT")
    root, hips = odd.data.edit_bones["Root"], odd.data.edit_bones["Hips"]
    root.tail = hips.head
    hips.use_connect = True
    bpy.ops.object.mode_set(mode="OBJECT")
    act = _dance([acts.creature("biped"), odd])
    there, found = (scenes.heads(ob, ["Hips", "Head", "Foot.L"], FRAMES) for ob in act.obs)
    assert np.abs(found - there).max() < 1e-4
    assert np.abs(there[0] - there[-1]).max() > 0.01


def test_armatures_that_share_their_data_are_posed_each_for_itself() -> None:
    first = acts.creature("biped")
    second = bpy.data.objects.new("Twin", first.data)
    bpy.context.scene.collection.objects.link(second)
    second.location.x = 2.0
    bpy.context.view_layer.update()
    act = _dance([first, second])
    there, found = (_shown(ob, FRAMES) for ob in act.obs)
    found[..., 0, 3] -= 2.0
    assert np.abs(found - there).max() < 1e-5


# --- two together ---


def test_two_whose_targets_are_each_others_hands_reach_for_them_and_do_not_chase_them() -> None:
    act = acts.act([acts.creature("biped"), acts.creature("biped")], REACH, ROOT)
    scenes.stand(act.obs[1], scenes.matrix((0, 0, 180), 1.0, (0.0, -0.9, 0.0)))
    for i in range(2):
        act.values(i, "Reach").target = act.obs[1 - i]
        act.values(i, "Reach").target_bone = "Hand.R"
    for frame, share in ((1, 0.0), (20, 0.5)):
        act.key(frame, "Reach", position=(share, 0.0, 0.0))
        act.key(frame, "Root", position=(0.0, 0.0, -0.1 * share))
    stepped = [_shown(ob, [1, 5, 10, 15, 20]) for ob in act.obs]
    for ob, there in zip(act.obs, stepped, strict=True):
        assert np.abs(_shown(ob, [20, 1, 10])[[0, 1, 2]] - there[[4, 0, 2]]).max() < 1e-5
        for _ in range(3):
            bpy.context.view_layer.update()
        assert np.abs(_shown(ob, [10]) - there[2:3]).max() < 1e-5
    hands = [act.obs[0].pose.bones.keys().index(name) for name in ("Hand.L", "Hand.R")]
    ways = [stepped[i][:, hands[0], :3, 3] - stepped[1 - i][:, hands[1], :3, 3] for i in range(2)]
    for way in ways:
        assert np.linalg.norm(way[-1]) < 0.7 * np.linalg.norm(way[0])


def test_a_target_that_is_a_bone_of_another_character_is_where_its_own_channels_bring_it() -> None:
    wave = _dance([acts.creature("lopside")], "Wave")
    act = acts.act([acts.creature("biped")], REACH, name="Grab")
    act.values().target, act.values().target_bone = wave.obs[0], "Head"
    wave.obs[0].location = (0.5, -0.4, -0.2)
    act.key(1, position=(1.0, 0.0, 0.0))
    for frame in (20, 1, 10, 20):
        bpy.context.scene.frame_set(frame)
        head = acts.heads(wave.obs[0], ["Head"])[0]
        goal = acts.in_world(act.obs[0], act.shown().positions[0, 0])
        assert np.abs(goal - head).max() < 1e-3


def test_a_muted_character_is_a_target_as_it_stands() -> None:
    act = acts.act([acts.creature("biped"), acts.creature("biped")], REACH)
    act.values().target, act.values().target_bone = act.obs[1], "Head"
    act.key(1, position=(1.0, 0.0, 0.0))
    of_rig(act.obs[1]).muted = True
    act.obs[1].pose.bones["Spine"].rotation_quaternion = (0.9, 0.3, 0.0, 0.0)
    bpy.context.scene.frame_set(2)
    goal = acts.in_world(act.obs[0], act.shown().positions[0, 0])
    assert np.abs(goal - acts.heads(act.obs[1], ["Head"])[0]).max() < 1e-5


# --- the solver's settings ---


def test_hands_bend_the_spine_of_the_character_that_lets_them() -> None:
    """A hand that cannot reach its target comes nearer to it; the other character's spine stays where it is."""
    obs = [acts.creature("biped"), acts.creature("biped")]
    act = acts.act(obs, REACH)
    target = acts.empty_object("Fruit", (0.2, -0.9, 1.2))
    for i in range(2):
        act.values(i).target = target
    act.key(1, position=(1.0, 0.0, 0.0))
    of_rig(obs[0]).bends_spine = True
    bpy.context.scene.frame_set(2)
    bones = ["Chest", "Hand.L"]
    leant, upright = (scenes.evaluated(ob, bones, [2])[0] for ob in obs)
    rest = [np.array(ob.matrix_world @ ob.data.bones["Chest"].matrix_local) for ob in obs]
    assert np.abs(upright[0] - rest[1]).max() < 1e-5
    assert np.abs(leant[0] - rest[0]).max() > 0.05
    away = [np.linalg.norm(pose[1][:3, 3] - np.array(target.location)) for pose in (leant, upright)]
    assert away[0] < 0.8 * away[1]
    of_rig(obs[0]).bends_spine = False
    bpy.context.view_layer.update()
    assert np.abs(scenes.evaluated(obs[0], bones, [2])[0] - upright).max() < 1e-5
