"""Figures as armature objects in Blender, and poses as their actions."""

from collections.abc import Sequence

import bpy
import numpy as np

from morph_retarget.blender import actions
from morph_retarget.blender.actions import Writer
from morph_retarget.core import quat
from morph_retarget.core.skeleton import Pose, Skeleton

from .figure import Bone


def build(name: str, bones: Sequence[Bone], rng: np.random.Generator | None = None) -> bpy.types.Object:
    """Return a new armature object in the open scene; with ``rng`` its bones get rolls that mean nothing."""
    data = bpy.data.armatures.new(name)
    ob = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(ob)
    bpy.context.view_layer.objects.active = ob
    bpy.ops.object.mode_set(mode="EDIT")
    for bone in bones:
        edit = data.edit_bones.new(bone.name)
        edit.head, edit.tail = bone.head, bone.tail
        edit.roll = 0.0 if rng is None else float(rng.uniform(-np.pi, np.pi))
        if bone.parent is not None:
            edit.parent = data.edit_bones[bone.parent]
    bpy.ops.object.mode_set(mode="OBJECT")
    return ob


def key(ob: bpy.types.Object, skeleton: Skeleton, pose: Pose, name: str) -> bpy.types.Action:
    """Return a pose over time as a new action of an armature, from frame 1 on, which the armature then plays.

    Args:
        ob: The armature.
        skeleton: Its bones, in the order of ``pose``.
        pose: Armature space.
        name: Of the action.
    """
    writer = Writer(name, ob)
    frames = np.arange(1.0, len(pose) + 1.0)
    for i, bone in enumerate(skeleton.names):
        parent = int(skeleton.parents[i])
        above = pose.rotations[:, parent] if parent >= 0 else quat.identity(len(pose))
        local = quat.multiply(quat.conjugate(above), pose.rotations[:, i])
        basis = quat.multiply(quat.conjugate(skeleton.local_rotations[i]), local)
        owner = ob.pose.bones[bone]
        writer.write(owner.path_from_id("rotation_quaternion"), quat.continuous(basis), frames, bone)
        if parent < 0:
            shift = pose.positions[:, i] - skeleton.rest_positions[i]
            place = quat.rotate(quat.conjugate(skeleton.rest_rotations[i]), shift)
            writer.write(owner.path_from_id("location"), place, frames, bone)
    actions.assign(ob, writer.action, writer.slot)
    return writer.action
