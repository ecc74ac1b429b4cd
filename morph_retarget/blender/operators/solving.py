"""The solver: settings of single limbs."""

import bpy
from bpy.props import StringProperty

from ...core.errors import RigError
from ..properties import of_rig
from ..rig import pose_of
from .manners import PLACE, OfArmature, Status, active_bone, armature_meant, place_meant, reporting


class MORPHRETARGET_OT_add_limb_settings(OfArmature, bpy.types.Operator):
    bl_idname = "morph_retarget.add_limb_settings"
    bl_label = "Add Limb Settings"
    bl_description = "Give one limb solver settings of its own, by the bone at its end"

    bone: StringProperty(name="Bone", description="Bone at the end of the limb; the active one when empty")

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        ob = armature_meant(context, self.character)
        name = self.bone or active_bone(ob)
        if name not in pose_of(ob).bones:
            raise RigError(f"armature {ob.name!r} has no bone {name!r}: choose one that it has")
        of_rig(ob).solver.add(name)
        return {"FINISHED"}


class MORPHRETARGET_OT_remove_limb_settings(OfArmature, bpy.types.Operator):
    bl_idname = "morph_retarget.remove_limb_settings"
    bl_label = "Remove Limb Settings"
    bl_description = "Let the chosen limb be solved like the others again"

    place: PLACE

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        ob = armature_meant(context, self.character)
        own = of_rig(ob).solver
        missing = f"{ob.name!r} has no such settings: choose some in the list"
        own.remove(place_meant(self, len(own.limbs), own.active_limb, missing))
        self.character = ob.name
        return {"FINISHED"}


CLASSES = (MORPHRETARGET_OT_add_limb_settings, MORPHRETARGET_OT_remove_limb_settings)
