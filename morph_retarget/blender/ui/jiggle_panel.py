"""The panel of jiggles: one switch, a few knobs, and settings for single kinds and bones."""

# The stubs take every layout and every operator button for optional.
# pyright: reportOptionalMemberAccess=false, reportArgumentType=false

from typing import Any

import bpy

from ..morph import cast, jiggles, query
from ..morph.jiggle_properties import BONE
from ..properties import of_rig
from .lists import Rows, chosen, draw_list, draw_remove
from .tab import InTab, OfCharacter, say, split_layout


class MORPHRETARGET_UL_jiggle_settings(Rows, bpy.types.UIList):
    """Kinds and bones that have settings of their own."""

    bl_idname = "MORPHRETARGET_UL_jiggle_settings"

    @staticmethod
    def draw_row(layout: bpy.types.UILayout, item: Any, _context: bpy.types.Context) -> None:
        icon = "BONE_DATA" if item.kind == BONE else "GROUP_BONE"
        layout.label(text=item.name, icon=icon, translate=item.kind != BONE)
        layout.label(text="" if item.amount else "Still")


class MORPHRETARGET_PT_jiggles(OfCharacter, bpy.types.Panel):
    bl_idname = "MORPHRETARGET_PT_jiggles"
    bl_label = "Jiggles"

    def draw_header(self, context: bpy.types.Context) -> None:
        ob = query.active_character(context)
        if ob is not None and cast.action_of(ob) is not None:
            self.layout.prop(of_rig(ob).jiggles, "enabled", text="")

    def draw(self, context: bpy.types.Context) -> None:
        layout, ob = split_layout(self), query.active_character(context)
        if ob is None:
            return
        own, generalized = of_rig(ob).jiggles, cast.action_of(ob) is not None
        column = layout.column()
        column.active = own.enabled or not generalized
        for name in ("amount", "half_life", "stiffness", "gravity"):
            column.prop(own, name)
        row = column.row(heading="Also")
        row.prop(own, "ground", toggle=True)
        row.prop(own, "loop", toggle=True)
        problem = jiggles.problems.get(ob.session_uid)
        if generalized and own.enabled and problem:
            say(layout, problem, "INFO", context)
        if not generalized:
            row = layout.row()
            row.operator_context = "INVOKE_DEFAULT"
            row.operator("morph_retarget.bake_jiggles", icon="REC").character = ob.name


class MORPHRETARGET_PT_jiggle_parts(InTab, bpy.types.Panel):
    bl_idname = "MORPHRETARGET_PT_jiggle_parts"
    bl_parent_id = "MORPHRETARGET_PT_jiggles"
    bl_label = "Single Parts"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        layout, ob = split_layout(self), query.active_character(context)
        if ob is None:
            return
        own = of_rig(ob).jiggles
        buttons = draw_list(layout, "MORPHRETARGET_UL_jiggle_settings", own, "overrides", "active_override")
        buttons.operator_menu_enum("morph_retarget.add_jiggle_settings", "kind", text="", icon="ADD")
        draw_remove(buttons, "morph_retarget.remove_jiggle_settings", len(own.overrides) > 0).character = ob.name
        item = chosen(own.overrides, own.active_override)
        for name in ("amount", "half_life", "stiffness") if item is not None else ():
            layout.prop(item, name)


CLASSES = (MORPHRETARGET_UL_jiggle_settings, MORPHRETARGET_PT_jiggles, MORPHRETARGET_PT_jiggle_parts)
