"""Jiggles: baking them on ordinary actions, and settings for single parts."""

from collections.abc import Generator

import bpy
from bpy.props import EnumProperty, StringProperty

from ...core.errors import MotionError, RigError, listed
from .. import collect, jiggle_bake
from ..morph import cast
from ..morph.jiggle_properties import BONE, KINDS
from ..properties import of_rig
from ..rig import pose_of
from .manners import PLACE, OfArmature, Status, active_bone, armature_meant, place_meant, reporting, scene_in
from .stepping import Stepping


class MORPHRETARGET_OT_bake_jiggles(Stepping, OfArmature, bpy.types.Operator):
    bl_idname = "morph_retarget.bake_jiggles"
    bl_label = "Bake Jiggles"
    bl_description = (
        "Let tails, ears, hair and the like follow the armature's action, as far as it leaves them alone, "
        "and key them in a copy of it"
    )
    doing = "Baking"

    action: StringProperty(name="Action", description="Action of the armature; the one that it plays when empty")

    def start(self, context: bpy.types.Context) -> Generator[float, None, jiggle_bake.Outcome]:
        ob = armature_meant(context, self.character)
        if not self.action and cast.action_of(ob) is not None:
            raise MotionError(
                f"{ob.name!r} plays a generalized action: switch its jiggles on, and bake the action to have keys"
            )
        if not len(pose_of(ob).bones):
            raise RigError(f"armature {ob.name!r} has no bones: choose one that has")
        action, slot = collect.actions_of(ob, self.action)[0]
        self.character, self.action = ob.name, action.name
        return jiggle_bake.bake(ob, action, slot, scene_in(context))

    def finish(self, _: bpy.types.Context, outcome: jiggle_bake.Outcome) -> Status:
        self.report({"INFO"}, f"Made {outcome.action.name!r}, in which {listed(outcome.bones, 4)} jiggle")
        return {"FINISHED"}


class MORPHRETARGET_OT_add_jiggle_settings(OfArmature, bpy.types.Operator):
    bl_idname = "morph_retarget.add_jiggle_settings"
    bl_label = "Add Jiggle Settings"
    bl_description = "Give one kind of parts, or one bone, settings of its own"

    kind: EnumProperty(name="For", description="What gets settings of its own", items=KINDS)
    bone: StringProperty(name="Bone", description="Name of the bone; the active one when empty")

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        ob = armature_meant(context, self.character)
        name = self.bone
        if self.kind == BONE and not name:
            name = active_bone(ob)
        if self.kind == BONE and name not in pose_of(ob).bones:
            raise RigError(f"armature {ob.name!r} has no bone {name!r}: choose one that it has")
        of_rig(ob).jiggles.add(self.kind, name)
        return {"FINISHED"}


class MORPHRETARGET_OT_remove_jiggle_settings(OfArmature, bpy.types.Operator):
    bl_idname = "morph_retarget.remove_jiggle_settings"
    bl_label = "Remove Jiggle Settings"
    bl_description = "Let the chosen part jiggle like the others again"

    place: PLACE

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        ob = armature_meant(context, self.character)
        own = of_rig(ob).jiggles
        missing = f"{ob.name!r} has no such settings: choose some in the list"
        own.remove(place_meant(self, len(own.overrides), own.active_override, missing))
        self.character = ob.name
        return {"FINISHED"}


CLASSES = (
    MORPHRETARGET_OT_bake_jiggles,
    MORPHRETARGET_OT_add_jiggle_settings,
    MORPHRETARGET_OT_remove_jiggle_settings,
)
