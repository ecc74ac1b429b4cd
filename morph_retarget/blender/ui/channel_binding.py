"""The panels that say how an action binds: sharing bodies, variants, and which characters it is for."""

# The stubs take every layout and every operator button for optional.
# pyright: reportOptionalMemberAccess=false, reportArgumentType=false

import bpy

from ..morph.properties import of_action
from .channel_panels import OfChannel, shown
from .tab import split_layout

_ANSWERS = ("upright_spine", "has_graspers", "has_feet", "has_mouth", "has_tail", "has_wings")


class MORPHRETARGET_PT_blending(OfChannel, bpy.types.Panel):
    bl_idname = "MORPHRETARGET_PT_blending"
    bl_label = "Blending"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        layout, (_, _, item) = split_layout(self), shown(context)
        layout.prop(item, "blend_group")
        layout.prop(item, "priority")
        column = layout.column(align=True)
        column.prop(item, "position_weight")
        column.prop(item, "rotation_weight")


class MORPHRETARGET_PT_variants(OfChannel, bpy.types.Panel):
    bl_idname = "MORPHRETARGET_PT_variants"
    bl_label = "Variants and Mirror"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        layout, (_, _, item) = split_layout(self), shown(context)
        layout.prop(item, "varies")
        column = layout.column(align=True)
        column.active = item.varies
        column.prop(item, "variant_group")
        column.prop(item, "variant_side")
        layout.prop(item, "mirror")


class MORPHRETARGET_PT_branch(OfChannel, bpy.types.Panel):
    bl_idname = "MORPHRETARGET_PT_branch"
    bl_label = "Characters It Is For"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        layout, (_, action, _) = split_layout(self), shown(context)
        own = of_action(action)
        column = layout.column(align=True)
        for name in _ANSWERS:
            column.prop(own, name)
        column.prop(own, "leg_count")
        layout.prop(own, "movement")
        if own.movement:
            row = layout.row()
            row.operator("morph_retarget.play_movement", icon="NLA").movement = own.movement


CLASSES = (MORPHRETARGET_PT_blending, MORPHRETARGET_PT_variants, MORPHRETARGET_PT_branch)
