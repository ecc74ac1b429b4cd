"""Channels in the Graph Editor's sidebar: which one is edited, its values and keys, and how it moves."""

# The stubs take every layout for optional.
# pyright: reportOptionalMemberAccess=false

import bpy

from ..morph.properties import of_action
from .channel_panels import OfChannel, draw_movement, shown
from .channel_values import draw_values


class _InGraph(OfChannel):
    """A panel about the active channel, beside its curves."""

    bl_space_type = "GRAPH_EDITOR"
    bl_region_type = "UI"
    bl_parent_id = ""


class MORPHRETARGET_PT_graph_channels(_InGraph, bpy.types.Panel):
    bl_idname = "MORPHRETARGET_PT_graph_channels"
    bl_label = "Channels"

    def draw(self, context: bpy.types.Context) -> None:
        _, action, _ = shown(context)
        own = of_action(action)
        self.layout.template_list("MORPHRETARGET_UL_channels", "", own, "channels", own, "active_channel", rows=4)


class MORPHRETARGET_PT_graph_values(_InGraph, bpy.types.Panel):
    bl_idname = "MORPHRETARGET_PT_graph_values"
    bl_label = "Values and Keys"

    def draw(self, context: bpy.types.Context) -> None:
        draw_values(self, context)


class MORPHRETARGET_PT_graph_movement(_InGraph, bpy.types.Panel):
    bl_idname = "MORPHRETARGET_PT_graph_movement"
    bl_label = "Movement"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        draw_movement(self, context)


CLASSES = (MORPHRETARGET_PT_graph_channels, MORPHRETARGET_PT_graph_values, MORPHRETARGET_PT_graph_movement)
