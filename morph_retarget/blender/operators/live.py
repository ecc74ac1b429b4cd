"""Letting a target follow its source while frames change."""

import bpy
from bpy.props import BoolProperty, StringProperty

from ...core.errors import RigError
from .. import collect, live
from ..properties import of_scene
from .manners import Status, refuse, reporting, scene_in


class MORPHRETARGET_OT_live_start(bpy.types.Operator):
    bl_idname = "morph_retarget.live_start"
    bl_label = "Live"
    bl_description = "Let the target follow the source while scrubbing and playing; nothing is keyed"
    bl_options = {"REGISTER", "UNDO"}

    source: StringProperty(name="Source", description="Armature object; the panel's source when empty")
    target: StringProperty(name="Target", description="Armature object; the panel's target when empty")

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        settings = of_scene(scene_in(context))
        return bool(settings.source and settings.target) or refuse(cls, "Choose a source and a target first")

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        settings = of_scene(scene_in(context))
        source = collect.armature(self.source, "source") if self.source else settings.source
        target = collect.armature(self.target, "target") if self.target else settings.target
        live.start(scene_in(context), source, target)
        return {"FINISHED"}


class MORPHRETARGET_OT_live_stop(bpy.types.Operator):
    bl_idname = "morph_retarget.live_stop"
    bl_label = "Clear Live Pose"
    bl_description = "Let the target follow no more, and put the bones that followed back to rest"
    bl_options = {"REGISTER", "UNDO"}

    target: StringProperty(name="Target", description="Armature object; the panel's target when empty")
    clear: BoolProperty(name="Clear Pose", description="Put the bones that followed back to rest", default=True)

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        chosen = of_scene(scene_in(context)).target
        target = collect.armature(self.target, "target") if self.target else chosen
        if target is None:
            raise RigError("no target is chosen: set Target in the panel, or name a rig")
        live.stop(target, self.clear)
        return {"FINISHED"}


CLASSES = (MORPHRETARGET_OT_live_start, MORPHRETARGET_OT_live_stop)
