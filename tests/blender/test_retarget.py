"""Retargeting in Blender: where targets and sources stand, and how bones take keys, as Blender evaluates them."""

from collections.abc import Callable

import bpy
import numpy as np
import pytest

from morph_retarget.blender import actions
from morph_retarget.blender.retarget import Options, Reference, Source
from morph_retarget.core import quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.errors import RigError
from morph_retarget.core.mocap.plan import Matching, RetargetSettings
from morph_retarget.core.mocap.root_motion import RootMotion
from tests.blender import scenes
from tests.blender.scenes import matrix
from tools.figure import Build, blender

PLACES = {
    "as it was made": matrix(),
    "in centimetres": matrix(scale=0.01),
    "in hectometres": matrix(scale=100.0),
    "lying": matrix(turn=(90, 0, 0)),
    "lying in centimetres": matrix(turn=(90, 0, 0), scale=0.01),
    "turned": matrix(turn=(0, 0, 120)),
    "askew and moved": matrix(turn=(20, -50, 70), scale=0.3, place=(2, -1, 0)),
    "mirrored": matrix(scale=(-1, 1, 1)),
    "mirrored, lying, in centimetres": matrix(turn=(90, 0, 0), scale=(0.01, 0.01, -0.01)),
}


def _with_root(kind: RootMotion) -> Options:
    return Options(RetargetSettings(root_motion=kind))


# --- where armatures stand ---


@pytest.mark.parametrize("kind", [RootMotion.HIPS, RootMotion.ROOT_BONE, RootMotion.OBJECT])
@pytest.mark.parametrize("place", PLACES.values(), ids=PLACES)
def test_a_target_moves_alike_wherever_its_object_stands(walk: Source, place: Array, kind: RootMotion) -> None:
    ob = scenes.sprout(place=place)
    scenes.give(walk, ob, _with_root(kind))
    assert scenes.apart(scenes.played(ob), scenes.played_plainly(walk)) < 2e-4


@pytest.mark.parametrize("kind", [RootMotion.HIPS, RootMotion.ROOT_BONE, RootMotion.OBJECT])
@pytest.mark.parametrize("place", PLACES.values(), ids=PLACES)
def test_a_target_moves_alike_on_a_turned_parent(walk: Source, place: Array, kind: RootMotion) -> None:
    ob = scenes.sprout(place=place)
    parent = scenes.empty_object()
    scenes.stand(parent, matrix(turn=(30, 40, 50), scale=1.7, place=(3, 2, 1)))
    scenes.stand(ob, place, parent)
    scenes.give(walk, ob, _with_root(kind))
    assert scenes.apart(scenes.played(ob), scenes.played_plainly(walk)) < 2e-4


@pytest.mark.parametrize("kind", [RootMotion.HIPS, RootMotion.ROOT_BONE, RootMotion.OBJECT])
def test_a_target_that_was_turned_and_moved_walks_from_there(walk: Source, kind: RootMotion) -> None:
    place = matrix(turn=(0, 0, 70), scale=1.5, place=(3, -2, 1))
    ob = scenes.sprout()
    scenes.stand(ob, place)
    scenes.give(walk, ob, _with_root(kind))
    expected = scenes.played_plainly(walk) @ place[:3, :3].T + place[:3, 3]
    assert scenes.apart(scenes.played(ob), expected) < 2e-4


@pytest.mark.parametrize("place", PLACES.values(), ids=PLACES)
def test_a_source_is_read_alike_wherever_its_object_stands(walk: Source, place: Array) -> None:
    ob = scenes.sprout()
    scenes.give(scenes.source_of(scenes.walker(place=place, seed=2)), ob)
    assert scenes.apart(scenes.played(ob), scenes.played_plainly(walk)) < 2e-4


@pytest.mark.parametrize("mode", ["XYZ", "ZYX", "AXIS_ANGLE", "QUATERNION"])
def test_an_objects_own_rotation_mode_is_kept(walk: Source, mode: str) -> None:
    place = matrix(turn=(20, -50, 70), scale=0.3)
    ob = scenes.sprout(place=place)
    ob.rotation_mode = mode
    scenes.stand(ob, place)
    scenes.give(walk, ob, _with_root(RootMotion.OBJECT))
    assert ob.rotation_mode == mode
    assert scenes.apart(scenes.played(ob), scenes.played_plainly(walk)) < 2e-4


# --- how bones take keys ---


@pytest.mark.parametrize(
    ("mode", "prop"),
    [
        ("QUATERNION", "rotation_quaternion"),
        ("AXIS_ANGLE", "rotation_axis_angle"),
        ("XYZ", "rotation_euler"),
        ("ZYX", "rotation_euler"),
        ("YXZ", "rotation_euler"),
    ],
)
def test_bones_move_alike_in_every_rotation_mode(walk: Source, mode: str, prop: str) -> None:
    ob = scenes.sprout()
    for bone in ob.pose.bones:
        bone.rotation_mode = mode
    scenes.give(walk, ob, _with_root(RootMotion.ROOT_BONE))
    assert {bone.rotation_mode for bone in ob.pose.bones} == {mode}
    keyed = {path.rpartition(".")[2] for path, _ in scenes.curves_of(ob)}
    assert keyed == {prop, "location"}
    assert scenes.apart(scenes.played(ob), scenes.played_plainly(walk)) < 2e-4


def test_between_keys_bones_turn_the_short_way(walk: Source) -> None:
    for mode in ("QUATERNION", "AXIS_ANGLE", "XYZ", "ZYX"):
        ob = scenes.sprout()
        for bone in ob.pose.bones:
            bone.rotation_mode = mode
        scenes.give(walk, ob)
        before, middle, after = (
            scenes.heads(ob, ob.pose.bones.keys(), [f + part for f in scenes.FRAMES[:-1]]) for part in (0.0, 0.5, 1.0)
        )
        assert scenes.apart(middle, 0.5 * (before + after)) < 0.04, mode


def _edit(ob: bpy.types.Object, change: Callable[[bpy.types.ArmatureEditBones], None]) -> None:
    bpy.context.view_layer.objects.active = ob
    bpy.ops.object.mode_set(mode="EDIT")
    change(ob.data.edit_bones)
    bpy.ops.object.mode_set(mode="OBJECT")


def _connect_hips(bones: bpy.types.ArmatureEditBones) -> None:
    bones["Root"].tail = bones["Hips"].head
    bones["Hips"].use_connect = True


def test_connected_hips_are_moved_by_what_they_are_connected_to(walk: Source) -> None:
    ob = scenes.sprout()
    _edit(ob, _connect_hips)
    scenes.give(walk, ob)
    assert scenes.apart(scenes.played(ob), scenes.played_plainly(walk)) < 2e-4


def test_travel_on_the_root_moves_connected_hips_too(walk: Source) -> None:
    ob = scenes.sprout()
    _edit(ob, _connect_hips)
    scenes.give(walk, ob, _with_root(RootMotion.ROOT_BONE))
    assert scenes.apart(scenes.played(ob), scenes.played_plainly(walk)) < 2e-4


@pytest.mark.parametrize("kind", [RootMotion.HIPS, RootMotion.ROOT_BONE])
def test_bones_without_local_location_are_moved_alike(walk: Source, kind: RootMotion) -> None:
    ob = scenes.sprout()
    for bone in ob.data.bones:
        bone.use_local_location = False
    scenes.give(walk, ob, _with_root(kind))
    assert scenes.apart(scenes.played(ob), scenes.played_plainly(walk)) < 2e-4


@pytest.mark.parametrize("name", ["Head", "UpperArm.L", "Spine", "LowerLeg.R"])
def test_a_bone_that_does_not_inherit_rotation_still_turns_as_meant(walk: Source, name: str) -> None:
    ob = scenes.sprout()
    ob.data.bones[name].use_inherit_rotation = False
    scenes.give(walk, ob)
    assert scenes.apart(scenes.played(ob), scenes.played_plainly(walk)) < 2e-4


@pytest.mark.parametrize("keyed", [False, True], ids=["posed", "keyed"])
def test_how_a_target_was_posed_before_does_not_show(walk: Source, keyed: bool) -> None:
    ob = scenes.sprout()
    rng = np.random.default_rng(5)
    values: dict[str, Array] = {}
    for bone in ob.pose.bones:
        bone.rotation_quaternion = quat.normalize(rng.normal(size=4))
        bone.location = rng.normal(size=3)
        bone.scale = rng.uniform(0.5, 2.0, 3)
        for prop in ("rotation_quaternion", "location", "scale"):
            values[bone.path_from_id(prop)] = np.tile(getattr(bone, prop), (2, 1))
    if keyed:
        scenes.key(ob, "Before", values)
    scenes.give(walk, ob)
    body = [b.name for b in ob.pose.bones if not any(digit in b.name for digit in ("Thumb", "Index"))]
    plain = scenes.sprout("Plain")
    scenes.give(walk, plain)
    assert scenes.apart(scenes.played(ob, body), scenes.played(plain, body)) < 2e-4


@pytest.mark.parametrize("kind", list(RootMotion))
def test_what_is_keyed_is_what_was_meant(walk: Source, kind: RootMotion) -> None:
    """In place, what was meant goes on and what is keyed stays; in all else they are one."""
    ob = scenes.sprout()
    outcome = scenes.give(walk, ob, _with_root(kind))
    plan, result = outcome.plan, outcome.result
    names = [plan.target.skeleton.names[bone] for bone in plan.links.target]
    found = plan.target.world_to_character.points(scenes.heads(ob, names, scenes.FRAMES))
    meant = result.motion.points
    if kind is RootMotion.IN_PLACE:
        meant = meant - result.travel.points[:, None]
    assert scenes.apart(found, meant) < 1e-4 * plan.target.frame.height


def test_arms_point_where_the_sources_point(walk: Source) -> None:
    ob = scenes.sprout()
    scenes.give(walk, ob)
    ours = scenes.directions(ob, scenes.FRAMES, blender, scenes.ARMS)
    theirs = scenes.directions(scenes.walker(), scenes.FRAMES, segments=scenes.ARMS)
    assert scenes.angle(ours, theirs) < 0.01


# --- builds of body ---

BUILDS = {
    "twist bones": Build(twists=2),
    "another spine": Build(spine=5, neck=2),
    "hardly any spine": Build(spine=1, neck=0, clavicles=False, toes=False),
    "all fingers": Build(fingers=5),
}


@pytest.mark.parametrize("build", BUILDS.values(), ids=BUILDS)
def test_bodies_of_every_build_do_what_was_meant(walk: Source, build: Build) -> None:
    ob = scenes.sprout(build=build)
    outcome = scenes.give(walk, ob)
    plan = outcome.plan
    names = [plan.target.skeleton.names[bone] for bone in plan.links.target]
    found = plan.target.world_to_character.points(scenes.heads(ob, names, scenes.FRAMES))
    assert scenes.apart(found, outcome.result.motion.points) < 1e-4 * plan.target.frame.height
    ours = scenes.directions(ob, scenes.FRAMES, blender, scenes.ARMS)
    theirs = scenes.directions(scenes.walker(), scenes.FRAMES, segments=scenes.ARMS)
    assert scenes.angle(ours, theirs) < 0.01


# --- what targets were set to ---


def test_a_rig_is_not_given_its_own_motion() -> None:
    ob = scenes.walker()
    with pytest.raises(RigError, match="source and target are both 'Walker'"):
        scenes.give(scenes.source_of(ob), ob)


def test_a_target_in_rest_position_is_given_the_motion(walk: Source) -> None:
    ob = scenes.sprout()
    ob.data.pose_position = "REST"
    scenes.give(walk, ob)
    ob.data.pose_position = "POSE"
    assert scenes.apart(scenes.played(ob), scenes.played_plainly(walk)) < 2e-4


def test_constraints_on_the_target_are_warned_of(walk: Source) -> None:
    ob = scenes.sprout()
    ob.pose.bones["Hand.L"].constraints.new("LIMIT_ROTATION")
    assert any("'Hand.L'" in text and "mute" in text for text in scenes.give(walk, ob).warnings)
    ob.pose.bones["Hand.L"].constraints[0].mute = True
    assert scenes.give(walk, ob).warnings == ()


def test_the_current_poses_can_stand_for_the_rests() -> None:
    """What the two show when asked is the same pose, whatever it looks like."""
    source, target = scenes.walker(), scenes.sprout()
    target.pose.bones["LowerArm.L"].rotation_quaternion = quat.from_rotation_vector(np.array([0.0, 0.0, 0.7]))
    bpy.context.scene.frame_set(9)
    bpy.context.view_layer.update()
    posed = scenes.shape(scenes.directions(target, [9], blender))
    settings = RetargetSettings(plant_feet=False, matching=Matching.AS_THEY_STAND)
    scenes.give(scenes.source_of(source), target, Options(settings, Reference.CURRENT))
    found = scenes.shape(scenes.directions(target, [9, 20], blender))
    assert scenes.apart(found[0], posed[0]) < 1e-3
    assert scenes.apart(found[1], posed[0]) > 0.1


def _strip_below(ob: bpy.types.Object) -> None:
    """Leave a strip under the action that moves what the clip moves, and something else."""
    turns = quat.from_rotation_vector(np.linspace([0, 0, 0], [1.0, 0.5, 0.2], scenes.COUNT))
    bones = [ob.pose.bones[name] for name in ("Hips", "Head", "UpperArm.L")]
    values = {bone.path_from_id("rotation_quaternion"): turns for bone in bones}
    old = scenes.key(ob, "Below", values | {ob.pose.bones["Spine"].path_from_id("scale"): np.full((2, 3), 1.5)})
    strip = ob.animation_data.nla_tracks.new().strips.new("Below", 1, old)
    strip.action_slot = old.slots[0]
    actions.assign(ob, None, None)


def _weak_action(ob: bpy.types.Object) -> None:
    """Leave settings with which an action only counts in part."""
    _strip_below(ob)
    ob.animation_data.action_influence = 0.3
    ob.animation_data.action_blend_type = "ADD"


def _locked(ob: bpy.types.Object) -> None:
    for bone in ob.pose.bones:
        bone.lock_location = bone.lock_rotation = bone.lock_scale = True, True, True


def _unscaled(ob: bpy.types.Object) -> None:
    for i, bone in enumerate(ob.data.bones):
        bone.inherit_scale = ("NONE", "AVERAGE", "ALIGNED", "NONE_LEGACY")[i % 4]


def _moved_by_its_old_action(ob: bpy.types.Object) -> None:
    scenes.key(ob, "Old", {ob.pose.bones["Root"].path_from_id("rotation_quaternion"): [[0.6, 0.8, 0, 0], [1, 0, 0, 0]]})
    bpy.context.scene.frame_set(1)


@pytest.mark.parametrize("change", [_strip_below, _weak_action, _locked, _unscaled, _moved_by_its_old_action])
def test_a_target_shows_what_was_meant_whatever_it_was_set_to(
    walk: Source, change: Callable[[bpy.types.Object], None]
) -> None:
    ob = scenes.sprout()
    change(ob)
    scenes.give(walk, ob)
    assert scenes.apart(scenes.played(ob), scenes.played_plainly(walk)) < 2e-4
