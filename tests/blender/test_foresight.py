"""Frames that are foreseen: written before Blender evaluates them, and shown anew where anything has changed."""

from collections.abc import Callable

import bpy
import numpy as np
import pytest

from morph_retarget.blender import actions, handlers
from morph_retarget.blender.morph import autokey, cast, keys, perform, pose, replay
from morph_retarget.blender.morph.properties import of_action
from morph_retarget.blender.properties import of_rig
from morph_retarget.core.arrays import Array
from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.morph.channels import Channel, TargetKind
from morph_retarget.core.morph.context import Context, Side
from morph_retarget.core.morph.movement import Movement, ScaleMode
from tests.blender import acts, scenes
from tests.blender.acts import Act

HANDS = Channel("Hands", Context(Capability.GRASPER), Movement(scale=ScaleMode.LIMB_LENGTH))
HEAD = Channel("Head", Context(Capability.HEAD), poses_position=False)
REACH = Channel(
    "Reach", Context(Capability.GRASPER, side=Side.LEFT), Movement(secondary_relative=True), TargetKind.EXTERNAL
)
FRAMES = [1, 5, 12.5, 20]

pytestmark = pytest.mark.usefixtures("registered")


@pytest.fixture
def act() -> Act:
    """Return a creature that moves its hands and head, and reaches for a target, from frame 1 to 20."""
    made = acts.act([acts.creature("biped")], REACH, HANDS, HEAD)
    made.values(0, "Reach").target = acts.empty_object("Target", (0.3, -0.5, 1.2))
    for frame, share in ((1, 0.0), (10, 1.0), (20, -0.5)):
        made.key(frame, "Hands", position=(0.1 * share, -0.3 * share, 0.1))
        made.key(frame, "Head", rotation=(0.9, 0.1, 0.0, 0.4 * share))
        made.key(frame, "Reach", position=(0.5 + 0.3 * share, 0.0, 0.0))
    return made


@pytest.fixture
def written(monkeypatch: pytest.MonkeyPatch) -> list[bpy.types.Object]:
    """Collect the characters whose poses are written."""
    found: list[bpy.types.Object] = []
    real = pose.show

    def show(ob: bpy.types.Object, setting: pose.Setting) -> object:
        found.append(ob)
        return real(ob, setting)

    monkeypatch.setattr(pose, "show", show)
    return found


def _shown(ob: bpy.types.Object, frames: list[float] | None = None) -> Array:
    return scenes.evaluated(ob, ob.pose.bones.keys(), FRAMES if frames is None else frames)


def _anew(ob: bpy.types.Object, frames: list[float] | None = None) -> Array:
    """Return what a character shows when nothing of before is known."""
    perform.forget()
    cast.forget()
    return _shown(ob, frames)


# --- what comes as it was ---


def test_a_foreseen_frame_is_the_frame_shown_anew_bit_for_bit(act: Act) -> None:
    [ob] = act.obs
    first = _anew(ob)
    assert np.array_equal(_shown(ob), first)
    assert np.array_equal(_shown(ob, FRAMES[::-1])[::-1], first)
    assert np.array_equal(_anew(ob), first)


def test_a_foreseen_frame_is_written_once_and_before_blender_evaluates_it(
    act: Act, written: list[bpy.types.Object]
) -> None:
    [ob] = act.obs
    first = _anew(ob)
    bpy.app.handlers.frame_change_post.remove(handlers._on_frame)  # what is seen now, Blender saw in its one evaluation
    assert np.array_equal(_shown(ob), first)
    bpy.app.handlers.frame_change_post.append(handlers._on_frame)
    written.clear()
    assert np.array_equal(_shown(ob), first)
    assert len(written) == len(FRAMES)


def test_bones_that_nothing_poses_stay_as_the_animator_has_left_them(act: Act, written: list[bpy.types.Object]) -> None:
    [ob] = act.obs
    _shown(ob)
    ob.pose.bones["Foot.L"].rotation_quaternion = (0.9, 0.4, 0.0, 0.0)
    turned = _shown(ob)
    assert ob.pose.bones["Foot.L"].rotation_quaternion[1] == pytest.approx(0.4)
    written.clear()
    assert np.array_equal(_shown(ob), turned)
    assert len(written) == len(FRAMES)


def test_keys_of_bones_that_nothing_poses_play_along(act: Act, written: list[bpy.types.Object]) -> None:
    [ob] = act.obs
    _key_bone(act, "Foot.L")
    first = _anew(ob)
    foot = ob.pose.bones.find("Foot.L")
    assert np.abs(first[0, foot] - first[-1, foot]).max() > 0.05
    written.clear()
    assert np.array_equal(_shown(ob), first)
    assert len(written) == len(FRAMES)


# --- what has changed in between ---


def _value(act: Act) -> None:
    act.values(0, "Hands").weight = 0.3


def _curve(act: Act) -> None:
    act.curve("position", 1, "Hands").keyframe_points[1].co_ui[1] += 0.2


def _new_key(act: Act) -> None:
    act.key(12, "Head", rotation=(0.8, 0.0, 0.4, 0.0))


def _target(act: Act) -> None:
    act.values(0, "Reach").target.location.z = 0.7


def _no_target(act: Act) -> None:
    act.values(0, "Reach").target = None


def _character(act: Act) -> None:
    act.obs[0].location.x = 0.5


def _mode(act: Act) -> None:
    for name, mode in (("UpperArm.L", "XYZ"), ("Head", "AXIS_ANGLE")):
        act.obs[0].pose.bones[name].rotation_mode = mode


def _renamed(act: Act) -> None:
    act.channel("Hands").name = "Paws"
    act.values(0, "Paws").weight = 0.5


def _moved(_: Act) -> None:
    bpy.ops.morph_retarget.move_channel(channel="Reach", direction="DOWN")


def _removed(_: Act) -> None:
    bpy.ops.morph_retarget.remove_channel(channel="Head")


def _items_moved(act: Act) -> None:
    of_rig(act.obs[0]).channels.move(0, 2)
    act.values(0, "Reach").weight = 0.2


def _solver(act: Act) -> None:
    of_rig(act.obs[0]).bends_spine = True


def _other_action(act: Act) -> None:
    other = acts.act(act.obs, HANDS, name="Other")
    other.key(1, "Hands", position=(0.0, 0.0, 0.4))


def _like_action(act: Act) -> None:
    """Play an action with the same curves in another movement mode."""
    other = act.action.copy()
    of_action(other).remap = False
    of_action(other).channels["Hands"].scale = ScaleMode.NONE.value
    actions.assign(act.obs[0], other, other.slots[0])


def _pulled(act: Act) -> None:
    bone = act.obs[0].pose.bones["Hand.L"]
    bone.location, bone.rotation_quaternion = (0.3, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0)


def _scaled(act: Act) -> None:
    act.obs[0].pose.bones["LowerArm.L"].scale = (1.0, 1.3, 1.0)


@pytest.mark.parametrize(
    "edit",
    [
        _value, _curve, _new_key, _target, _no_target, _character, _mode, _renamed, _moved, _removed, _items_moved,
        _solver, _other_action, _like_action, _pulled, _scaled,
    ],
)  # fmt: skip
def test_what_has_changed_is_never_shown_as_it_was(act: Act, edit: Callable[[Act], None]) -> None:
    [ob] = act.obs
    for _ in range(2):
        first = _shown(ob)
    edit(act)
    shown = _shown(ob)
    assert np.array_equal(_shown(ob), shown)
    assert np.abs(_anew(ob) - shown).max() < 1e-6
    if edit not in (_mode, _moved, _pulled):
        assert np.abs(shown - first).max() > 1e-3


def test_a_muted_character_keeps_its_pose(act: Act) -> None:
    [ob] = act.obs
    first = _shown(ob)
    of_rig(ob).muted = True
    muted = _shown(ob)
    assert np.array_equal(muted, np.broadcast_to(first[-1], muted.shape))
    of_rig(ob).muted = False
    assert np.array_equal(_shown(ob), first)


def test_jiggles_that_are_switched_on_are_there_at_once() -> None:
    act = acts.act([acts.creature("hound")], Channel("Root", Context(Capability.ROOT)))
    [ob] = act.obs
    of_rig(ob).jiggles.enabled = False
    for frame in (1, 6, 12):
        act.key(frame, "Root", position=(0.0, 0.5 * (frame == 6), 0.0))
    stiff = _shown(ob, [1, 6, 12])
    of_rig(ob).jiggles.enabled = True
    loose = _shown(ob, [1, 6, 12])
    assert np.abs(loose - stiff).max() > 1e-3
    assert np.array_equal(_shown(ob, [1, 6, 12]), loose)
    of_rig(ob).jiggles.enabled = False
    assert np.array_equal(_shown(ob, [1, 6, 12]), stiff)


def test_jiggles_that_a_curve_switches_on_are_there_at_once() -> None:
    act = acts.act([acts.creature("hound")], Channel("Root", Context(Capability.ROOT)))
    [ob] = act.obs
    for frame in (1, 6, 12):
        act.key(frame, "Root", position=(0.0, 0.5 * (frame == 6), 0.0))
    of_rig(ob).jiggles.enabled = False
    ob.keyframe_insert("morph_retarget.jiggles.enabled", frame=1)
    for _ in range(2):
        stiff = _shown(ob, [1, 6, 12])
    keys.curves(act.action)["morph_retarget.jiggles.enabled", 0].keyframe_points[0].co_ui[1] = 1.0
    loose = _shown(ob, [1, 6, 12])
    assert np.abs(loose - stiff).max() > 1e-3
    assert np.abs(_anew(ob, [1, 6, 12]) - loose).max() < 1e-6


def test_one_wrong_guess_is_a_warning(act: Act, written: list[bpy.types.Object]) -> None:
    [ob] = act.obs
    _shown(ob)
    bpy.data.objects["Target"].location.z = 0.7
    written.clear()
    _shown(ob)
    assert len(written) == len(FRAMES) + 1
    _shown(ob)
    assert len(written) == 2 * len(FRAMES) + 1


def test_two_scenes_do_not_take_each_others_frames(act: Act) -> None:
    [ob] = act.obs
    scene = bpy.context.scene
    other = bpy.data.scenes.new("Other")
    other.collection.objects.link(ob)
    first = _shown(ob)
    other.frame_set(5)
    there, here = (replay.last(ob.session_uid, (own.session_uid, 5.0)) for own in (other, scene))
    assert there is not here
    bpy.data.scenes.remove(other)
    assert np.array_equal(_shown(ob), first)


def test_no_more_guesses_are_kept_than_frames(act: Act, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(replay, "MOST", 2)
    [ob] = act.obs
    perform.forget()
    first = _shown(ob)
    scene = bpy.context.scene.session_uid
    assert [replay.last(ob.session_uid, (scene, frame)) is not None for frame in FRAMES] == [False, False, True, True]
    assert np.array_equal(_shown(ob), first)


# --- who else moves what is posed ---


def _key_bone(act: Act, name: str) -> None:
    """Key a bone itself, as an animator may in the same action."""
    bag, path = keys.bag_of(act.action), act.obs[0].pose.bones[name].path_from_id("rotation_quaternion")
    for i, (start, end) in enumerate(((1.0, 0.8), (0.0, 0.6), (0.0, 0.0), (0.0, 0.0))):
        curve = bag.fcurves.new(path, index=i)
        for frame, value in ((1, start), (20, end)):
            curve.keyframe_points.insert(frame, value)


def test_keys_of_a_bone_that_is_posed_do_not_count(act: Act) -> None:
    [ob] = act.obs
    first = _anew(ob)
    _key_bone(act, "UpperArm.L")
    for _ in range(3):
        assert np.array_equal(_shown(ob), first)


def test_a_driver_of_a_bone_that_is_posed_has_its_way_in_each_round(act: Act) -> None:
    [ob] = act.obs
    ob.pose.bones["UpperArm.L"].driver_add("rotation_quaternion", 1).driver.expression = "frame / 40"
    first = _anew(ob)
    for _ in range(2):
        assert np.array_equal(_shown(ob), first)


def test_keys_of_a_shape_key_do_not_count_against_a_deform() -> None:
    act = acts.act([acts.character("biped")], HANDS)
    [ob] = act.obs
    skin = next(child for child in ob.children if child.type == "MESH")
    for name in ("Basis", "open"):
        skin.shape_key_add(name=name)
    deforms = act.values().deforms
    deforms.add().name = "open"
    for frame, value in ((1, 0.2), (20, 0.9)):
        deforms["open"].value = value
        deforms["open"].keyframe_insert("value", frame=frame)

    def strengths() -> list[float]:
        found: list[float] = []
        for frame in (1, 8, 20):
            bpy.context.scene.frame_set(frame)
            seen = skin.evaluated_get(bpy.context.evaluated_depsgraph_get())
            found.append(seen.data.shape_keys.key_blocks["open"].value)
        return found

    first = strengths()
    assert first[::2] == pytest.approx([0.2, 0.9])
    assert strengths() == first
    skin.data.shape_keys.key_blocks["open"].keyframe_insert("value", frame=3)
    for _ in range(2):
        assert strengths() == first


# --- the animator's hand ---


def _in_pose_mode(act: Act, bone: str) -> bpy.types.PoseBone:
    [ob] = act.obs
    ob.select_set(True)
    bpy.ops.object.mode_set(mode="POSE")
    ob.data.bones.active = ob.data.bones[bone]
    return ob.pose.bones[bone]


def test_a_hand_that_is_moved_after_a_foreseen_frame_is_generalized(act: Act) -> None:
    hand = _in_pose_mode(act, "Hand.R")
    for _ in range(2):
        _shown(act.obs[0], [1, 5])
    before = act.values(0, "Hands").position[:]
    hand.rotation_quaternion = (0.9, 0.4, 0.0, 0.0)
    hand.location = (0.1, 0.1, 0.0)
    bpy.context.view_layer.update()
    assert np.abs(np.array(act.values(0, "Hands").position[:]) - before).max() > 0.01
    held = act.values(0, "Hands").position[:]
    bpy.context.scene.frame_set(1)
    bpy.context.scene.frame_set(5)
    assert act.values(0, "Hands").position[:] == pytest.approx(before)
    assert held != pytest.approx(before)


def test_nobodys_hand_is_seen_in_a_foreseen_frame(written: list[bpy.types.Object]) -> None:
    mouth = Channel("Mouth", Context(Capability.MOUTH), poses_rotation=False)
    act = acts.act([acts.creature("biped")], mouth, Channel("Head", Context(Capability.HEAD)))
    act.key(1, "Mouth", position=(0.0, -0.1, 0.0))
    _key_bone(act, "Jaw")  # a body whose channel turns no bone, as the head has a channel of its own
    _in_pose_mode(act, "Jaw")
    scene = bpy.context.scene
    scene.tool_settings.use_keyframe_insert_auto = True
    for _ in range(3):
        written.clear()
        for frame in (1, 5, 15):
            scene.frame_set(frame)
            act.obs[0].update_tag()
            bpy.context.view_layer.update()
    assert len(written) == 3
    autokey.settle(scene)
    assert len(act.curve("position", 0, "Mouth").keyframe_points) == 1
