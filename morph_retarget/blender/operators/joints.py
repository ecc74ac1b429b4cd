"""Correcting the joint list."""

import bpy
import numpy as np
from bpy.props import StringProperty

from ...core.character.joints import mirrored
from ...core.errors import MappingError, RigError
from .. import collect
from ..properties import of_rig
from ..rig import armature_of
from .manners import Status, refuse, reporting, rig_meant, scene_in
from .rigs import analyze

NEAR = 0.08
"""A bone this near to a mirrored place counts as the mirror image [heights]."""


class _OnJoint(bpy.types.Operator):
    """What acts on one joint of a rig."""

    bl_options = {"REGISTER", "UNDO"}

    rig: StringProperty(name="Rig", description="Armature object; the shown one when empty")
    joint: StringProperty(name="Joint", description="VRM 1.0 name of the joint; the active one when empty")

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        objects = context.scene.objects if context.scene is not None else ()
        known = any(len(of_rig(ob).joints) for ob in objects if ob.type == "ARMATURE")
        return known or refuse(cls, "Analyze a rig first")

    def _meant(self, context: bpy.types.Context) -> tuple[bpy.types.Object, str]:
        ob = rig_meant(context, self.rig)
        settings = of_rig(ob)
        if not settings.joints:
            raise RigError(f"{ob.name!r} has no joint list yet: analyze it first")
        self.rig, self.joint = ob.name, self.joint or settings.joints[settings.active_joint].name
        return ob, self.joint


class MORPHRETARGET_OT_pick_bone(_OnJoint):
    bl_idname = "morph_retarget.pick_bone"
    bl_label = "Pick From Selected Bone"
    bl_description = "Give the joint the bone that is selected in the viewport"

    bone: StringProperty(name="Bone", description="Name of the bone; the selected one when empty")

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        ob, joint = self._meant(context)
        bone = self.bone = self.bone or _selected_bone(context, ob)
        if bone not in armature_of(ob).bones:
            raise MappingError(f"armature {ob.name!r} has no bone {bone!r}: choose one of its bones")
        of_rig(ob).assign(joint, bone)
        return {"FINISHED"}


def _selected_bone(context: bpy.types.Context, ob: bpy.types.Object) -> str:
    bones = armature_of(ob).bones
    posed = [bone for bone in context.selected_pose_bones or [] if bone.id_data == ob]
    active = context.active_pose_bone
    if active is not None and active in posed:
        return active.name
    if posed:
        return posed[0].name
    if context.object == ob and bones.active is not None:
        return bones.active.name
    raise MappingError(f"no bone of {ob.name!r} is selected: select one in Pose mode")


class MORPHRETARGET_OT_mirror_joint(_OnJoint):
    bl_idname = "morph_retarget.mirror_joint"
    bl_label = "Mirror to Other Side"
    bl_description = "Give the same joint of the other side the mirrored bone"

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        ob, joint = self._meant(context)
        if mirrored(joint) == joint:
            raise MappingError(f"{joint} has no other side: choose a joint of an arm or leg")
        bone = of_rig(ob).joints[joint].bone
        of_rig(ob).assign(mirrored(joint), mirrored_bone(ob, bone) if bone else "")
        return {"FINISHED"}


def mirrored_bone(ob: bpy.types.Object, bone: str) -> str:
    """Return the bone of the other side: by its name, else by its place.

    Raises:
        MappingError: There is none.
    """
    flipped = bpy.utils.flip_name(bone)
    if flipped != bone and flipped in armature_of(ob).bones:
        return flipped
    own, character = collect.target_of(ob)
    skeleton = own.skeleton
    if bone not in skeleton.index:
        raise MappingError(f"armature {ob.name!r} has no bone {bone!r}: choose one of its bones")
    heads = character.local_to_character.points(skeleton.rest_positions)
    tails = character.local_to_character.points(skeleton.rest_tails)
    index, across = skeleton.index[bone], np.array([-1.0, 1.0, 1.0])
    away = np.linalg.norm(heads - heads[index] * across, axis=-1)
    away += np.linalg.norm(tails - tails[index] * across, axis=-1)
    nearest = int(np.argmin(away))
    if nearest == index or away[nearest] > 2.0 * NEAR * character.frame.height:
        raise MappingError(f"bone {bone!r} has no mirror image on {ob.name!r}: choose the other bone by hand")
    return skeleton.names[nearest]


class MORPHRETARGET_OT_clear_joint(_OnJoint):
    bl_idname = "morph_retarget.clear_joint"
    bl_label = "Clear Joint"
    bl_description = "Say that the rig has no such joint"

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        ob, joint = self._meant(context)
        of_rig(ob).assign(joint, "")
        return {"FINISHED"}


class MORPHRETARGET_OT_reset_joints(_OnJoint):
    bl_idname = "morph_retarget.reset_joints"
    bl_label = "Reset Joints"
    bl_description = "Take back all corrections and analyze the rig anew"

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        ob = rig_meant(context, self.rig)
        self.rig = ob.name
        of_rig(ob).joints.clear()
        analyze(scene_in(context), ob)
        return {"FINISHED"}


class MORPHRETARGET_OT_select_joint(_OnJoint):
    bl_idname = "morph_retarget.select_joint"
    bl_label = "Show Bone"
    bl_description = "Make the joint's bone the active one in the viewport"

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        ob, joint = self._meant(context)
        bone = armature_of(ob).bones.get(of_rig(ob).joints[joint].bone)
        if bone is None:
            raise MappingError(f"{joint} has no bone on {ob.name!r}: pick one first")
        armature_of(ob).bones.active = bone
        return {"FINISHED"}


CLASSES = (
    MORPHRETARGET_OT_pick_bone,
    MORPHRETARGET_OT_mirror_joint,
    MORPHRETARGET_OT_clear_joint,
    MORPHRETARGET_OT_reset_joints,
    MORPHRETARGET_OT_select_joint,
)
