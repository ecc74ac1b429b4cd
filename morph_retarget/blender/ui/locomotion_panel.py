"""The panel of locomotion: how fast and where a character goes, in what style, and when its feet stand."""

# The stubs take every layout and every operator button for optional.
# pyright: reportOptionalMemberAccess=false, reportArgumentType=false

from typing import Any

import bpy
import numpy as np

from ...core.locomotion.patterns.styles import STYLES
from ...core.locomotion.stepping.gait import Gait
from ..locomotion import walks
from ..locomotion.properties import Source
from ..morph import cast, query
from ..properties import of_rig
from . import gait_diagram
from .lists import Rows, chosen, draw_list, draw_remove
from .tab import InTab, OfCharacter, say, split_layout, told

FIRST = ("stride", "step_height", "crouch")
"""Settings that are shown first."""
DETAILS = ("width", "body", "arms", "foot_roll", "tilt")
CELL = 23
"""Of the panel's width, for each column of the diagram [pixels]."""
LEAST_COLUMNS, MOST_COLUMNS = 8, 32
"""Of the diagram."""


def _walker(context: bpy.types.Context) -> bpy.types.Object | None:
    """Return the active character if it has locomotion."""
    ob = query.active_character(context)
    return ob if ob is not None and cast.action_of(ob) is not None and of_rig(ob).gait.enabled else None


class MORPHRETARGET_UL_gait_styles(Rows, bpy.types.UIList):
    """Styles that are mixed in."""

    bl_idname = "MORPHRETARGET_UL_gait_styles"

    @staticmethod
    def draw_row(layout: bpy.types.UILayout, item: Any, _context: bpy.types.Context) -> None:
        row = layout.row()
        row.active = item.weight > 0.0
        row.label(text=STYLES[item.style].title, icon="MOD_WAVE")
        row.label(text=told("Legs {group}", group=item.group) if item.group else "", translate=False)
        row.prop(item, "weight", text="", emboss=False)


class MORPHRETARGET_PT_locomotion(OfCharacter, bpy.types.Panel):
    bl_idname = "MORPHRETARGET_PT_locomotion"
    bl_label = "Locomotion"

    def draw(self, context: bpy.types.Context) -> None:
        layout, ob = split_layout(self), query.active_character(context)
        if ob is None:
            return
        if _walker(context) is None:
            layout.operator("morph_retarget.add_locomotion", icon="ADD").character = ob.name
            return
        own = of_rig(ob).gait
        row = layout.row(align=True)
        row.prop(own, "style")
        row.operator("morph_retarget.remove_locomotion", text="", icon="X").character = ob.name
        layout.prop(own, "source")  # as buttons in a row their names would be cut off
        _draw_way(layout, ob)
        column = layout.column()
        for name in FIRST:
            column.prop(own, name)
        draw_told(layout, ob, context, f"{ob.name}: ")
        _draw_diagram(layout, ob, context)


def _draw_way(layout: bpy.types.UILayout, ob: bpy.types.Object) -> None:
    """Draw where a character goes, with dots that key what can be keyed."""
    own = of_rig(ob).gait
    column = layout.column()
    column.use_property_decorate = True
    if own.source == Source.PATH:
        row = column.row()
        row.use_property_decorate = False
        row.alert = own.path is None
        row.prop(own, "path")
    if own.source != Source.OWN:
        row = column.row(align=True)
        row.prop(own, "speed")
        row.operator("morph_retarget.key_locomotion", text="", icon="KEY_HLT").character = ob.name
    if own.source == Source.SPEED:
        column.prop(own, "turn_rate")
        column.prop(own, "direction")
    column.prop(own, "weight")
    layout.prop(own, "ground")


def draw_told(layout: bpy.types.UILayout, ob: bpy.types.Object, context: bpy.types.Context, who: str = "") -> None:
    """Say what keeps a character from going as it shall; of what comes out otherwise, ``who`` is said first."""
    problem = cast.problems.get(ob.session_uid) or walks.problems.get(ob.session_uid)
    if problem:
        say(layout, problem, "ERROR", context)
        return
    walk = walks.known(ob, context.scene)
    for warning in walk.gait.warnings if walk is not None else ():
        say(layout, who + warning, "INFO", context)


def _draw_diagram(layout: bpy.types.UILayout, ob: bpy.types.Object, context: bpy.types.Context) -> None:
    """Draw when the feet stand over one cycle, as the gait is at the present frame."""
    walk = walks.known(ob, context.scene)
    if walk is None or not isinstance(walk.gait, Gait):
        return
    width = context.region.width if context.region is not None else 300
    cell = CELL * (context.preferences.system.ui_scale or 1.0)  # there is none without a window
    columns = min(max(int(width / cell), LEAST_COLUMNS), MOST_COLUMNS)
    time = float(walk.clock.times(np.array([context.scene.frame_current_final]))[0])
    legs, names = walk.gait.legs.legs, walk.gait.character.skeleton.names
    box = layout.box().column(align=True)
    box.scale_y = 0.7
    for row in gait_diagram.rows(walk.gait, time, columns):
        split = box.split(factor=0.32)
        split.label(text=names[legs[row.leg].foot], translate=False)
        split.label(text=row.text, translate=False)


class _OfWalker(InTab):
    """What panels within that of locomotion share."""

    bl_parent_id = "MORPHRETARGET_PT_locomotion"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Return whether the active character has locomotion."""
        return _walker(context) is not None


class MORPHRETARGET_PT_gait_styles(_OfWalker, bpy.types.Panel):
    bl_idname = "MORPHRETARGET_PT_gait_styles"
    bl_label = "Styles"

    def draw(self, context: bpy.types.Context) -> None:
        layout, ob = split_layout(self), _walker(context)
        if ob is None:
            return
        own = of_rig(ob).gait
        buttons = draw_list(layout, "MORPHRETARGET_UL_gait_styles", own, "layers", "active_layer")
        buttons.operator_menu_enum("morph_retarget.add_gait_style", "style", text="", icon="ADD").character = ob.name
        draw_remove(buttons, "morph_retarget.remove_gait_style", len(own.layers) > 0).character = ob.name
        item = chosen(own.layers, own.active_layer)
        for name in ("style", "weight", "group") if item is not None else ():
            layout.prop(item, name)


class MORPHRETARGET_PT_gait_details(_OfWalker, bpy.types.Panel):
    bl_idname = "MORPHRETARGET_PT_gait_details"
    bl_label = "Steps and Body"

    def draw(self, context: bpy.types.Context) -> None:
        layout, ob = split_layout(self), _walker(context)
        if ob is None:
            return
        column = layout.column()
        for name in DETAILS:
            column.prop(of_rig(ob).gait, name)
        column.prop(of_rig(ob).gait, "movement")
        _draw_foot_path(column.row(align=True), ob)


def _draw_foot_path(row: bpy.types.UILayout, ob: bpy.types.Object) -> None:
    """Draw the flight of the feet, with a button that makes its curves, or one that removes them."""
    own = of_rig(ob).gait
    row.prop(own, "foot_path")
    if own.foot_path is None:
        row.operator("morph_retarget.new_foot_path", text="", icon="ADD").character = ob.name
    else:
        row.operator("morph_retarget.remove_foot_path", text="", icon="X").character = ob.name


CLASSES = (
    MORPHRETARGET_UL_gait_styles,
    MORPHRETARGET_PT_locomotion,
    MORPHRETARGET_PT_gait_styles,
    MORPHRETARGET_PT_gait_details,
)
