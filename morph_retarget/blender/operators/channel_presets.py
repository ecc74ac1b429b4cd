"""Keeping sets of channels, and giving them to actions."""

import bpy
from bpy.props import StringProperty

from ...core.errors import listed
from ..morph import channel_presets
from ..morph.properties import of_action
from .generalized import action_meant, add_channel, generalized_actions
from .manners import Asking, Confirming, Status, refuse, reporting

_ACTION = StringProperty(name="Action", description="Generalized action; that of the active character when empty")
_NAME = StringProperty(name="Name", description="Name of the preset", default=channel_presets.BIPED)


def _poll(cls: type[bpy.types.Operator]) -> bool:
    return bool(generalized_actions()) or refuse(cls, "Make a generalized action first")


class MORPHRETARGET_OT_save_channels(Asking, bpy.types.Operator):
    bl_idname = "morph_retarget.save_channels"
    bl_label = "Save Channel Preset"
    bl_description = "Keep the channels of a generalized action for other actions and for Generalize Action"
    bl_options = {"REGISTER"}

    action: _ACTION
    name: StringProperty(name="Name", description="Name of the preset", default="My Channels")

    @classmethod
    def poll(cls, _: bpy.types.Context) -> bool:
        return _poll(cls)

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        channel_presets.save(action_meant(context, self.action), self.name)
        self.report({"INFO"}, f"Saved channel preset {self.name!r}")
        return {"FINISHED"}


class MORPHRETARGET_OT_load_channels(bpy.types.Operator):
    bl_idname = "morph_retarget.load_channels"
    bl_label = "Load Channel Preset"
    bl_description = "Give an action the channels of this preset; those that it has already stay as they are"
    bl_options = {"REGISTER", "UNDO"}

    action: StringProperty(name="Action", description="Any action; that of the active character when empty")
    name: _NAME

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        action = action_meant(context, self.action)
        before = {channel.name for channel in of_action(action).channels}
        found = channel_presets.load(self.name)
        for channel in found:
            if channel.name not in before:
                add_channel(context, action, channel)
        kept = listed([channel.name for channel in found if channel.name in before])
        self.report({"INFO"}, f"Channels of {self.name!r} were added" + (f"; there already: {kept}" if kept else ""))
        return {"FINISHED"}


class MORPHRETARGET_OT_delete_channels(Confirming, bpy.types.Operator):
    bl_idname = "morph_retarget.delete_channels"
    bl_label = "Delete Channel Preset"
    bl_description = "Delete this preset of your own for good; one that comes with the extension cannot be deleted"
    bl_options = {"REGISTER"}

    name: _NAME

    @reporting
    def execute(self, _: bpy.types.Context) -> Status:
        channel_presets.delete(self.name)
        return {"FINISHED"}


CLASSES = (MORPHRETARGET_OT_save_channels, MORPHRETARGET_OT_load_channels, MORPHRETARGET_OT_delete_channels)
