"""Reading sources: what is sampled is what Blender shows, whatever moves them."""

from collections.abc import Callable

import bpy
import numpy as np
import pytest
from mathutils import Matrix

from morph_retarget.blender import channels, retarget, rig, sampling
from morph_retarget.blender.retarget import Outcome
from morph_retarget.blender.sampling import Clip
from morph_retarget.core import quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.skeleton import Pose
from tests.blender import scenes
from tests.blender.scenes import matrix


def _read(ob: bpy.types.Object) -> Clip:
    return scenes.source_of(ob).clip


def _seen(ob: bpy.types.Object, clip: Clip, place: Array) -> tuple[Array, Array]:
    """Return where a clip says that bones are in the world, and where Blender puts them."""
    own = rig.read(ob)
    said = clip.pose.positions @ place[:3, :3].T + place[:3, 3]
    return said, scenes.heads(ob, own.skeleton.names, clip.frames)


def _turn_modes(ob: bpy.types.Object) -> None:
    for i, bone in enumerate(ob.pose.bones):
        bone.rotation_mode = ("XYZ", "ZYX", "AXIS_ANGLE", "YZX")[i % 4]
    _key_again(ob)


def _key_again(ob: bpy.types.Object) -> None:
    """Key the walk anew, in the rotation modes that bones have now."""
    plain = scenes.walker("Plain")
    matrices = {bone.name: [] for bone in ob.pose.bones}
    for frame in scenes.FRAMES:
        bpy.context.scene.frame_set(frame)
        for bone in plain.pose.bones:
            matrices[bone.name].append(np.array(bone.matrix_basis))
    values: dict[str, Array] = {}
    for name, basis in matrices.items():
        bone = ob.pose.bones[name]
        channel = channels.rotation(bone, name, rig.rotations_of(np.array(basis)[:, :3, :3]))
        values[bone.path_from_id(channel.prop)] = channel.values
    hips = ob.pose.bones["hips"]
    values[hips.path_from_id("location")] = np.array(matrices["hips"])[:, :3, 3]
    bpy.data.objects.remove(plain)
    scenes.key(ob, "Again", values)


def _fancy_keys(ob: bpy.types.Object) -> None:
    for curve in scenes.curves_of(ob).values():
        for i in range(scenes.COUNT - 2, 0, -1):
            if i % 3:
                curve.keyframe_points.remove(curve.keyframe_points[i], fast=True)
        for i, key in enumerate(curve.keyframe_points):
            key.interpolation = ("BEZIER", "LINEAR", "CONSTANT", "BOUNCE")[i % 4]
        curve.update()


def _noisy(ob: bpy.types.Object) -> None:
    for curve in scenes.curves_of(ob).values():
        curve.modifiers.new("NOISE").strength = 0.05


def _muted(ob: bpy.types.Object) -> None:
    for (path, _), curve in scenes.curves_of(ob).items():
        curve.mute = "Arm" in path


def _muted_group(ob: bpy.types.Object) -> None:
    for (path, _), curve in scenes.curves_of(ob).items():
        if "leftUpperArm" in path:
            curve.group.mute = True


def _few_components(ob: bpy.types.Object) -> None:
    bone = ob.pose.bones["head"]
    bone.rotation_mode = "XYZ"
    bone.rotation_euler = 0.2, 0.1, -0.3
    scenes.key(
        ob,
        "Nod",
        {ob.pose.bones["neck"].path_from_id("location"): np.linspace([0, 0, 0], [0.1, 0.2, 0.3], 20)},
    )
    bag = ob.animation_data.action.layers[0].strips[0].channelbag(ob.animation_data.action_slot)
    curve = bag.fcurves.new(bone.path_from_id("rotation_euler"), index=1)
    for frame in range(1, 21):
        curve.keyframe_points.insert(frame, 0.05 * frame)


def _no_local_location(ob: bpy.types.Object) -> None:
    for bone in ob.data.bones:
        bone.use_local_location = False


def _moved_bones(ob: bpy.types.Object) -> None:
    """Key locations of bones below others, which count along their parents' axes."""
    names = ("spine", "leftShoulder", "rightLowerLeg")
    ways = np.linspace([0, 0, 0], [0.1, 0.2, 0.3], 20)
    turns = quat.from_rotation_vector(np.linspace([0, 0, 0], [0.3, 0.5, -0.4], 20))
    values = {ob.pose.bones[name].path_from_id("location"): ways for name in names}
    values[ob.pose.bones["hips"].path_from_id("rotation_quaternion")] = turns
    scenes.key(ob, "Slide", values)


def _moved_bones_without_local_location(ob: bpy.types.Object) -> None:
    _no_local_location(ob)
    _moved_bones(ob)


def _no_inherited_rotation(ob: bpy.types.Object) -> None:
    ob.data.bones["head"].use_inherit_rotation = False
    ob.data.bones["leftLowerArm"].use_inherit_rotation = False


def _scaled_bones(ob: bpy.types.Object) -> None:
    ob.pose.bones["spine"].scale = 1.5, 1.2, 0.8


def _keyed_scale(ob: bpy.types.Object) -> None:
    spine = ob.pose.bones["spine"]
    scenes.key(ob, "Grow", {spine.path_from_id("scale"): np.linspace([1, 1, 1], [1.5, 1.5, 1.5], 20)})


def _moved_object(mode: str) -> Callable[[bpy.types.Object], None]:
    def change(ob: bpy.types.Object) -> None:
        _on_object(ob, mode)

    return change


def _on_object(ob: bpy.types.Object, mode: str) -> None:
    """Key the object itself on top of the walk."""
    ob.rotation_mode = mode
    bpy.context.view_layer.update()
    turns = quat.from_rotation_vector(np.linspace([0, 0, 0], [0.3, 0.5, 2.0], scenes.COUNT))
    channel = channels.rotation(ob, None, turns)
    values = {channel.prop: channel.values, "location": np.linspace([0, 0, 0], [1, 2, 0.3], scenes.COUNT)}
    found = scenes.curves_of(ob)
    for path in {path for path, _ in found}:
        width = 4 if path.endswith("quaternion") else 3
        values[path] = np.column_stack([[key.co[1] for key in found[path, i].keyframe_points] for i in range(width)])
    scenes.key(ob, "Both", values)


def _scaled_object(ob: bpy.types.Object) -> None:
    _on_object(ob, "XYZ")
    ob.scale = 2.0, 2.0, 2.0
    bpy.context.view_layer.update()


def _growing_object(ob: bpy.types.Object) -> None:
    scenes.key(ob, "Grow", {"scale": np.linspace([1, 1, 1], [2, 2, 2], 20), "location": np.zeros((20, 3))})


def _offset_object(ob: bpy.types.Object) -> None:
    _on_object(ob, "XYZ")
    ob.delta_location = 1.0, 2.0, 3.0
    ob.delta_rotation_euler = 0.1, 0.2, 0.3
    bpy.context.view_layer.update()


def _parented(ob: bpy.types.Object) -> None:
    _on_object(ob, "XYZ")
    parent = scenes.empty_object()
    scenes.stand(parent, matrix(turn=(30, 40, 50), scale=1.7, place=(3, 2, 1)))
    ob.parent = parent
    ob.matrix_parent_inverse = Matrix.Translation((1, 2, 3)) @ Matrix.Rotation(0.5, 4, "X")
    bpy.context.view_layer.update()


def _moving_parent(ob: bpy.types.Object) -> None:
    parent = scenes.empty_object()
    scenes.key(parent, "Ride", {"location": np.linspace([0, 0, 0], [1, 2, 3], scenes.COUNT)})
    ob.parent = parent
    bpy.context.view_layer.update()


def _moving_grandparent(ob: bpy.types.Object) -> None:
    above, parent = scenes.empty_object("Above"), scenes.empty_object()
    scenes.key(above, "Ride", {"location": np.linspace([0, 0, 0], [1, 2, 3], scenes.COUNT)})
    parent.parent = above
    ob.parent = parent
    bpy.context.view_layer.update()


def _constrained_parent(ob: bpy.types.Object) -> None:
    leader, parent = scenes.empty_object("Leader"), scenes.empty_object()
    scenes.key(leader, "Ride", {"location": np.linspace([0, 0, 0], [1, 2, 3], scenes.COUNT)})
    parent.constraints.new("COPY_LOCATION").target = leader
    ob.parent = parent
    bpy.context.view_layer.update()


def _on_a_bone(ob: bpy.types.Object) -> None:
    carrier = scenes.walker("Carrier")
    ob.parent, ob.parent_type, ob.parent_bone = carrier, "BONE", "hips"
    bpy.context.view_layer.update()


def _constrained(ob: bpy.types.Object) -> None:
    aim = scenes.empty_object("Aim")
    aim.location = 1.0, -4.0, 1.0
    track = ob.pose.bones["head"].constraints.new("DAMPED_TRACK")
    track.target = aim
    track.influence = 0.7


def _reaching(ob: bpy.types.Object) -> None:
    aim = scenes.empty_object("Aim")
    aim.location = 0.3, -1.0, 1.2
    ik = ob.pose.bones["leftLowerArm"].constraints.new("IK")
    ik.target, ik.chain_count = aim, 2


def _constrained_object(ob: bpy.types.Object) -> None:
    leader = scenes.empty_object("Leader")
    scenes.key(leader, "Ride", {"location": np.linspace([0, 0, 0], [1, 2, 3], scenes.COUNT)})
    ob.constraints.new("COPY_LOCATION").target = leader


def _driven(ob: bpy.types.Object) -> None:
    bone = ob.pose.bones["head"]
    bone.rotation_mode = "XYZ"
    bone.driver_add("rotation_euler", 2).driver.expression = "0.05 * frame"
    ob.driver_add("location", 0).driver.expression = "0.1 * frame"


def _layered(ob: bpy.types.Object) -> None:
    walk = ob.animation_data.action
    wave = scenes.key(
        ob,
        "Wave",
        {
            ob.pose.bones["rightUpperArm"].path_from_id("rotation_quaternion"): quat.from_rotation_vector(
                np.linspace([0, 0, 0], [0.5, 0.9, 0.1], scenes.COUNT)
            )
        },
    )
    strip = ob.animation_data.nla_tracks.new().strips.new("Walk", 1, walk)
    strip.action_slot = walk.slots[0]
    assert ob.animation_data.action == wave


def _keys_off_the_frames(ob: bpy.types.Object) -> None:
    for curve in scenes.curves_of(ob).values():
        for key in curve.keyframe_points:
            key.co[0] = 1.3 + 0.8 * key.co[0]
        curve.update()


def _baked_curves(ob: bpy.types.Object) -> None:
    for curve in scenes.curves_of(ob).values():
        curve.convert_to_samples(1, scenes.COUNT)


def _plain_walk(_: bpy.types.Object) -> None:
    """Leave the walk as it is."""


ODDITIES: dict[str, Callable[[bpy.types.Object], None]] = {
    "nothing odd": _plain_walk,
    "Euler and axis-angle bones": _turn_modes,
    "all sorts of interpolation": _fancy_keys,
    "modifiers on curves": _noisy,
    "muted curves": _muted,
    "a muted group": _muted_group,
    "single components keyed": _few_components,
    "keys between frames": _keys_off_the_frames,
    "curves baked to samples": _baked_curves,
    "bones without local location": _no_local_location,
    "bones that slide": _moved_bones,
    "bones that slide without local location": _moved_bones_without_local_location,
    "bones that inherit no rotation": _no_inherited_rotation,
    "bones that are scaled": _scaled_bones,
    "bones that grow": _keyed_scale,
    "an object moved in Euler angles": _moved_object("XYZ"),
    "an object moved in quaternions": _moved_object("QUATERNION"),
    "an object moved in axis-angle": _moved_object("AXIS_ANGLE"),
    "an object moved and scaled": _scaled_object,
    "an object that grows": _growing_object,
    "an object with delta transforms": _offset_object,
    "an object with a parent": _parented,
    "a moving parent": _moving_parent,
    "a moving grandparent": _moving_grandparent,
    "a constrained parent": _constrained_parent,
    "an object on a walking bone": _on_a_bone,
    "a constraint": _constrained,
    "inverse kinematics": _reaching,
    "an object that is constrained": _constrained_object,
    "drivers": _driven,
    "NLA strips": _layered,
}


@pytest.mark.parametrize("change", ODDITIES.values(), ids=ODDITIES)
def test_a_source_is_sampled_as_blender_evaluates_it(change: Callable[[bpy.types.Object], None]) -> None:
    ob = scenes.walker(seed=6, place=matrix(turn=(90, 0, 0)))
    change(ob)
    scene = bpy.context.scene
    scene.frame_set(3)
    place = np.array(ob.matrix_world)
    said, seen = _seen(ob, _read(ob), place)
    assert scenes.apart(said, seen) < 2e-4


@pytest.mark.parametrize("change", [_constrained, _driven, _layered, _moving_parent])
def test_a_stepped_source_is_the_same_as_its_bake(change: Callable[[bpy.types.Object], None]) -> None:
    ob = scenes.walker(seed=6)
    change(ob)
    bpy.context.scene.frame_set(1)
    placement = rig.read(ob).placement
    stepped = _read(ob)
    assert stepped.stepped
    matrices = scenes.evaluated(ob, rig.read(ob).skeleton.names, scenes.FRAMES)
    bare = scenes.figure("Bare", seed=6)
    pose = Pose(rig.rotations_of(matrices[..., :3, :3]), matrices[..., :3, 3])
    scenes.armatures.key(bare, rig.read(bare).skeleton, pose, "Baked")
    baked = _read(bare)
    assert not baked.stepped
    assert scenes.apart(placement.points(stepped.pose.positions), baked.pose.positions) < 2e-4
    turns = quat.multiply(placement.turn, stepped.pose.rotations)
    assert quat.angle_between(turns, baked.pose.rotations).max() < 1e-3


def test_a_constraint_that_does_nothing_changes_nothing() -> None:
    ob = scenes.walker(seed=6)
    direct = _read(ob)
    ob.pose.bones["head"].constraints.new("LIMIT_ROTATION")
    stepped = _read(ob)
    assert not direct.stepped
    assert stepped.stepped == ("constraints on 'head'",)
    assert np.array_equal(direct.frames, stepped.frames)
    assert scenes.apart(direct.pose.positions, stepped.pose.positions) < 1e-5
    assert quat.angle_between(direct.pose.rotations, stepped.pose.rotations).max() < 1e-3


def test_stepping_puts_frame_and_action_back() -> None:
    ob = scenes.walker()
    walk = ob.animation_data.action
    other = scenes.key(ob, "Other", {"location": [[0, 0, 0], [1, 1, 1]]})
    slot = ob.animation_data.action_slot
    ob.pose.bones["head"].constraints.new("LIMIT_ROTATION")
    scene = bpy.context.scene
    scene.frame_set(17, subframe=0.25)
    clip = retarget.run(sampling.sample(rig.read(ob), walk, walk.slots[0], scene))
    assert len(clip.frames) == scenes.COUNT
    assert scene.frame_current_final == 17.25
    assert ob.animation_data.action == other
    assert ob.animation_data.action_slot == slot


def test_what_was_asked_of_a_clip_is_what_is_read() -> None:
    ob = scenes.walker()
    whole, part = _read(ob), scenes.source_of(ob, frames=(5, 12)).clip
    assert part.frames.tolist() == list(range(5, 13))
    assert scenes.apart(part.pose.positions, whole.pose.positions[4:12]) < 1e-9
    assert whole.name == "Walk"
    assert whole.seconds_per_frame == pytest.approx(1 / scenes.FPS)


def test_a_retarget_says_how_its_source_was_sampled() -> None:
    ob = scenes.walker()
    ob.pose.bones["head"].constraints.new("LIMIT_ROTATION")
    outcome: Outcome = scenes.give(scenes.source_of(ob), scenes.sprout())
    assert any("frame by frame" in text and "'head'" in text for text in outcome.warnings)
