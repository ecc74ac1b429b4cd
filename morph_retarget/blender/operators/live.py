"""Letting a target follow its source while frames change."""

from collections.abc import Generator

import bpy
from bpy.props import BoolProperty, StringProperty

from .. import collect, live
from ..properties import of_scene
from .manners import Status, pair_poll, reporting, scene_in
from .stepping import Stepping


class MORPHRETARGET_OT_live_start(Stepping, bpy.types.Operator):
    bl_idname = "morph_retarget.live_start"
    bl_label = "Live"
    bl_description = "Let the target follow the source while scrubbing and playing; nothing is keyed"
    bl_options = {"REGISTER", "UNDO"}
    doing = "Reading the motion"

    source: StringProperty(name="Source", description="Armature object; the panel's source when empty")
    target: StringProperty(name="Target", description="Armature object; the panel's target when empty")

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return pair_poll(cls, context)

    def start(self, context: bpy.types.Context) -> Generator[float, None, None]:
        settings = of_scene(scene_in(context))
        source = collect.chosen(self.source, settings.source, "source")
        target = collect.chosen(self.target, settings.target, "target")
        self.source, self.target = source.name, target.name
        return live.starting(scene_in(context), source, target)

    def finish(self, *_: object) -> Status:
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
        target = collect.chosen(self.target, of_scene(scene_in(context)).target, "target")
        self.target = target.name
        live.stop(target, self.clear)
        return {"FINISHED"}


CLASSES = (MORPHRETARGET_OT_live_start, MORPHRETARGET_OT_live_stop)
