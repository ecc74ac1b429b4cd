"""The panel of directing: what a character is told to do and when, and what is said about each command."""

# The stubs take every layout and every operator button for optional.
# pyright: reportOptionalMemberAccess=false, reportArgumentType=false

from typing import Any

import bpy

from ...core.clips.commands.command import Verb
from ..directing import known
from ..directing.parameters import Kind, MORPHRETARGET_PG_parameter
from ..directing.properties import MORPHRETARGET_PG_command, MORPHRETARGET_PG_directing
from ..morph import cast, query
from ..properties import of_rig
from .lists import Rows, chosen, draw_list, draw_remove
from .locomotion_panel import draw_told
from .tab import InTab, OfCharacter, say, split_layout, told

_ICONS: dict[str, Any] = {Verb.START: "PLAY", Verb.STOP: "PAUSE", Verb.RESET: "LOOP_BACK"}
_FILES = "morph_retarget.import_commands"
"""The first of what opens the file browser."""
_MORE: tuple[tuple[str, Any], ...] = (
    ("morph_retarget.commands_to_markers", "MARKER_HLT"),
    ("morph_retarget.markers_to_commands", "MARKER"),
    (_FILES, "IMPORT"),
    ("morph_retarget.export_commands", "EXPORT"),
)
_FIELDS = {Kind.NUMBER: "number", Kind.TEXT: "text", Kind.SWITCH: "switch", Kind.PLACE: "place", Kind.TARGET: "target"}


def directed(context: bpy.types.Context) -> bpy.types.Object | None:
    """Return the active character if it does what it is told."""
    ob = query.active_character(context)
    there = ob is not None and cast.action_of(ob) is not None and of_rig(ob).directing.enabled
    return ob if there else None


class MORPHRETARGET_UL_commands(Rows, bpy.types.UIList):
    """Commands in order of time."""

    bl_idname = "MORPHRETARGET_UL_commands"

    @staticmethod
    def draw_row(layout: bpy.types.UILayout, item: Any, _context: bpy.types.Context) -> None:
        split = layout.split(factor=0.2, align=True)
        split.active = not item.mute
        split.label(text=f"{item.frame:g}", translate=False)
        row = split.row(align=True)
        row.label(text=f"{item.model}  {item.how}", icon=_ICONS[item.verb], translate=False)
        row.prop(item, "mute", text="", icon="HIDE_ON" if item.mute else "HIDE_OFF", emboss=False)

    def filter_items(self, _: bpy.types.Context, data: Any, name: str) -> tuple[list[int], list[int]]:
        """Put the commands in order of time, and show those whose model is searched for."""
        items = getattr(data, name)
        flags: Any = []
        if self.filter_name:
            found: Any = bpy.types.UI_UL_list.filter_items_by_name
            flags = found(self.filter_name, self.bitflag_filter_item, items, propname="model")
        places = [0] * len(items)
        for row, place in enumerate(data.order):
            places[place] = row
        return flags, places


class MORPHRETARGET_MT_add_command(bpy.types.Menu):
    bl_idname = "MORPHRETARGET_MT_add_command"
    bl_label = "Add Command"

    def draw(self, context: bpy.types.Context) -> None:
        layout, ob = self.layout, query.active_character(context)
        if ob is None:
            return
        titles = {"Motions": told("Motions"), "Behaviors": told("Behaviors")}
        for title, names in known.groups(ob).items():
            layout.label(text=titles[title], translate=False)
            for model in names:
                button = layout.operator("morph_retarget.add_command", text=model, translate=False)
                button.character, button.model = ob.name, model


class MORPHRETARGET_MT_commands(bpy.types.Menu):
    bl_idname = "MORPHRETARGET_MT_commands"
    bl_label = "Commands"

    def draw(self, context: bpy.types.Context) -> None:
        layout, ob = self.layout, query.active_character(context)
        if ob is None:
            return
        for name, icon in _MORE:
            if name == _FILES:
                layout.separator()
                layout.operator_context = "INVOKE_DEFAULT"
            layout.operator(name, icon=icon).character = ob.name


class MORPHRETARGET_MT_add_parameter(bpy.types.Menu):
    bl_idname = "MORPHRETARGET_MT_add_parameter"
    bl_label = "Add Parameter"

    def draw(self, context: bpy.types.Context) -> None:
        layout, ob = self.layout, query.active_character(context)
        command = active_command(of_rig(ob).directing) if ob is not None else None
        if ob is None or command is None:
            return
        for name in known.parameters(ob, command.model):
            if name not in command.parameters:
                button = layout.operator("morph_retarget.add_parameter", text=name, translate=False)
                button.character, button.name, button.model = ob.name, name, command.model
        layout.separator()
        layout.operator("morph_retarget.add_parameter", text="Other").character = ob.name


def active_command(own: MORPHRETARGET_PG_directing) -> MORPHRETARGET_PG_command | None:
    """Return the command that is chosen in the list, None for none."""
    return chosen(own.commands, own.active_command)


class MORPHRETARGET_PT_directing(OfCharacter, bpy.types.Panel):
    bl_idname = "MORPHRETARGET_PT_directing"
    bl_label = "Directing"

    def draw(self, context: bpy.types.Context) -> None:
        layout, ob = split_layout(self), query.active_character(context)
        if ob is None:
            return
        if directed(context) is None:
            layout.operator("morph_retarget.direct", icon="ADD").character = ob.name
            return
        own = of_rig(ob).directing
        buttons = draw_list(layout, "MORPHRETARGET_UL_commands", own, "commands", "active_command", rows=5)
        buttons.menu("MORPHRETARGET_MT_add_command", text="", icon="ADD")
        draw_remove(buttons, "morph_retarget.remove_command", len(own.commands) > 0).character = ob.name
        buttons.separator()
        buttons.menu("MORPHRETARGET_MT_commands", text="", icon="DOWNARROW_HLT")
        command = active_command(own)
        if command is not None:
            _draw_command(layout.column(), ob, command)
        draw_told(layout, ob, context)
        layout.prop(own, "obstacles")


class MORPHRETARGET_PT_library(InTab, bpy.types.Panel):
    bl_idname = "MORPHRETARGET_PT_library"
    bl_parent_id = "MORPHRETARGET_PT_directing"
    bl_label = "Library"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return directed(context) is not None

    def draw(self, context: bpy.types.Context) -> None:
        layout, ob = split_layout(self), directed(context)
        if ob is None:
            return
        own = of_rig(ob).directing
        layout.prop(own, "library", placeholder="Starter Library")
        layout.prop(own, "clips")
        row = layout.row(align=True)
        row.operator_context = "INVOKE_DEFAULT"
        row.operator("morph_retarget.build_library", text="Build", icon="ASSET_MANAGER").character = ob.name
        if own.library:
            button = row.operator("morph_retarget.build_library", text="Add", icon="ADD")
            button.character, button.add = ob.name, True
        row.operator("morph_retarget.load_library", text="", icon="IMPORT").character = ob.name
        row.operator("morph_retarget.save_library", text="", icon="EXPORT").character = ob.name
        kinds = known.groups(ob)["Motions"]
        if kinds:
            say(layout, ", ".join(kinds), "ACTION", context)


def _draw_command(column: bpy.types.UILayout, ob: bpy.types.Object, command: MORPHRETARGET_PG_command) -> None:
    """Draw one command and all that is said about it."""
    row = column.row(align=True)
    row.prop(command, "frame")
    row.operator("morph_retarget.move_command", text="", icon="NEXT_KEYFRAME").character = ob.name
    column.prop(command, "verb")
    column.prop(command, "model")
    parameters = known.parameters(ob, command.model)
    for item in command.parameters:
        _draw_parameter(column.row(align=True), ob, item, item.name in parameters)
    column.menu("MORPHRETARGET_MT_add_parameter", icon="ADD")


def _draw_parameter(
    row: bpy.types.UILayout, ob: bpy.types.Object, item: MORPHRETARGET_PG_parameter, is_known: bool
) -> None:
    """Draw one parameter: its name, its value, and what takes it away."""
    split = row.split(factor=0.4, align=True)
    split.use_property_split = False
    name = split.row(align=True)
    name.prop(item, "name", text="")
    if not is_known:
        name.prop(item, "kind", text="", icon_only=True)
    value = split.column(align=True)
    value.prop(item, _FIELDS[Kind(item.kind)], text="")
    if item.kind == Kind.TARGET and item.target is not None and item.target.type == "ARMATURE":
        value.prop_search(item, "target_bone", item.target.data, "bones", text="")
    button = row.operator("morph_retarget.remove_parameter", text="", icon="X")
    button.character, button.name = ob.name, item.name


CLASSES = (
    MORPHRETARGET_UL_commands,
    MORPHRETARGET_MT_add_command,
    MORPHRETARGET_MT_commands,
    MORPHRETARGET_MT_add_parameter,
    MORPHRETARGET_PT_directing,
    MORPHRETARGET_PT_library,
)
