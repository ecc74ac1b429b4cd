"""The panel of a generalized action: which one, who plays it, and its channels."""

# The stubs take every layout and every operator button for optional.
# pyright: reportOptionalMemberAccess=false, reportArgumentType=false

from typing import Any

import bpy

from ...core.character.morphology import Capability
from .. import presets
from ..morph import cast, channel_presets, query, telling
from ..morph.properties import MORPHRETARGET_PG_channel, of_action
from ..operators.generalized import generalized_actions
from ..properties import of_rig, of_scene
from .lists import Rows, draw_list, draw_remove
from .tab import InTab, say, told

_TYPES: dict[str, Any] = {
    Capability.ROOT: "EMPTY_AXIS",
    Capability.SPINE: "CON_SPLINEIK",
    Capability.NECK: "CON_SPLINEIK",
    Capability.HEAD: "USER",
    Capability.MOUTH: "USER",
    Capability.EYE: "HIDE_OFF",
    Capability.EAR: "SPEAKER",
    Capability.GRASPER: "VIEW_PAN",
    Capability.FOOT: "CON_FLOOR",
    Capability.LIMB: "CON_KINEMATIC",
    Capability.TAIL: "FORCE_CURVE",
    Capability.WING: "FORCE_WIND",
    Capability.FIN: "MOD_OCEAN",
    Capability.FINGER: "BONE_DATA",
}
_SCALES: dict[str, Any] = {"creature_size": "CON_SIZELIKE", "limb_length": "DRIVER_DISTANCE"}
_TARGETS: dict[str, Any] = {"context": "GROUP_BONE", "external": "OBJECT_DATA"}


def mode_icons(channel: MORPHRETARGET_PG_channel) -> list[Any]:
    """Return the icons that tell how a channel moves."""
    aimed, placed = channel.target in _TARGETS, channel.poses_position
    wanted = {
        "WORLD": "absolute" in (channel.position, channel.rotation),
        _SCALES.get(channel.scale, ""): placed and channel.scale in _SCALES,
        "CON_FLOOR": placed and channel.ground_relative,
        "MOD_MIRROR": placed and channel.sagittal_relative,
        "CON_TRACKTO": aimed and (channel.secondary_relative or channel.look_at),
        _TARGETS.get(channel.target, ""): aimed,
        "MOD_ARRAY": channel.varies,
    }
    return [name for name, shown in wanted.items() if shown]


class MORPHRETARGET_UL_channels(Rows, bpy.types.UIList):
    """Channels with what they select on the active character."""

    bl_idname = "MORPHRETARGET_UL_channels"

    @staticmethod
    def draw_row(layout: bpy.types.UILayout, item: Any, context: bpy.types.Context) -> None:
        split = layout.split(factor=0.45)
        split.prop(item, "name", text="", emboss=False, icon=_TYPES.get(item.context.capability, "BONE_DATA"))
        row = split.row(align=True)
        row.alignment = "RIGHT"
        for name in mode_icons(item):
            row.label(text="", icon=name)
        ob = query.active_character(context)
        member = query.member_now(ob) if ob is not None else None
        place = of_action(item.id_data).channels.find(item.name)
        if member is not None and member.action == item.id_data and place < len(member.part.binding.selected):
            count = len(member.part.binding.selected[place])
            row.label(text=str(count) if count else "", icon="NONE" if count else "ERROR")


class MORPHRETARGET_MT_actions(bpy.types.Menu):
    bl_idname = "MORPHRETARGET_MT_actions"
    bl_label = "Generalized Actions"

    def draw(self, context: bpy.types.Context) -> None:
        layout, ob = self.layout, query.active_character(context)
        name = ob.name if ob is not None else ""
        found = generalized_actions()
        for action in found:
            button = layout.operator("morph_retarget.add_character", text=action.name, icon="ACTION", translate=False)
            button.action, button.character = action.name, name
        if not found:
            layout.label(text="No generalized actions yet")
        movements = sorted({of_action(action).movement for action in found} - {""})
        if movements:
            layout.separator()
            layout.label(text="The Branch That Fits")
        for movement in movements:
            button = layout.operator("morph_retarget.play_movement", text=movement, icon="NLA", translate=False)
            button.movement, button.character = movement, name
        if ob is not None and cast.action_of(ob) is not None:
            layout.separator()
            layout.operator("morph_retarget.remove_character", text="None", icon="X").character = name


class MORPHRETARGET_MT_channel_presets(bpy.types.Menu):
    bl_idname = "MORPHRETARGET_MT_channel_presets"
    bl_label = "Channel Presets"

    def draw(self, _: bpy.types.Context) -> None:
        layout = self.layout
        for name in channel_presets.names():
            layout.operator("morph_retarget.load_channels", text=name, icon="PRESET", translate=False).name = name
        layout.separator()
        layout.operator_context = "INVOKE_DEFAULT"
        layout.operator("morph_retarget.save_channels", icon="ADD")
        for name in presets.names(channel_presets.KIND):
            button = layout.operator(
                "morph_retarget.delete_channels",
                text=told("Delete {name}", name=name),
                icon="REMOVE",
                translate=False,
            )
            button.name = name


class MORPHRETARGET_PT_generalized(InTab, bpy.types.Panel):
    bl_idname = "MORPHRETARGET_PT_generalized"
    bl_label = "Generalized Action"

    def draw(self, context: bpy.types.Context) -> None:
        layout, ob = self.layout, query.active_character(context)
        action = cast.action_of(ob) if ob is not None else None
        row = layout.row(align=True)
        if ob is None or action is None:
            row.menu("MORPHRETARGET_MT_actions", text="Choose", icon="ACTION")
            row.operator("morph_retarget.new_action", text="New", icon="ADD")
            if ob is None:
                say(layout, "Select an armature, then press New", "INFO", context)
            else:
                say(layout, told("{name} plays no generalized action", name=ob.name), "INFO", context)
            if ob is not None and ob.animation_data is not None and ob.animation_data.action is not None:
                layout.operator("morph_retarget.generalize_action", icon="ARMATURE_DATA").character = ob.name
            return
        row.menu("MORPHRETARGET_MT_actions", text="", icon="ACTION")
        row.prop(action, "name", text="")
        row.prop(action, "use_fake_user", text="")
        row.operator("morph_retarget.new_action", text="", icon="ADD")
        self._draw_characters(context, layout, action, ob)
        self._draw_channels(layout, action)
        assert context.scene is not None, "the viewport shows a scene"
        row = layout.row()
        row.prop(of_scene(context.scene), "show_paths")
        row.prop(of_scene(context.scene), "show_solver")
        row = layout.row(align=True)
        row.operator_context = "INVOKE_DEFAULT"
        row.operator("morph_retarget.bake_action", text="Bake", icon="REC").character = ob.name
        row.operator("morph_retarget.bake_action", text="Bake All").all_characters = True

    def _draw_characters(
        self,
        context: bpy.types.Context,
        layout: bpy.types.UILayout,
        action: bpy.types.Action,
        active: bpy.types.Object,
    ) -> None:
        assert context.scene is not None, "the viewport shows a scene"
        row = layout.row()
        row.label(text=told("Characters"), translate=False)
        row.operator("morph_retarget.add_character", text="Add Selected", icon="ADD").action = action.name
        box = layout.box().column(align=True)
        for ob in cast.playing(context.scene, action):
            split = box.split(factor=0.45)
            name = split.row()
            name.alignment = "LEFT"
            icon = "RADIOBUT_ON" if ob == active else "RADIOBUT_OFF"
            button = name.operator(
                "morph_retarget.activate_character", text=ob.name, icon=icon, emboss=False, translate=False
            )
            button.character = ob.name
            row = split.row(align=True)
            row.alignment = "RIGHT"
            _draw_variant(row, ob)
            row.prop(of_rig(ob), "muted", text="", icon="HIDE_ON" if of_rig(ob).muted else "HIDE_OFF", emboss=False)
            row.operator("morph_retarget.remove_character", text="", icon="X", emboss=False).character = ob.name
            wrong = telling.tell(ob) if query.is_ready(ob) else []
            row.label(text="", icon="ERROR" if ob != active and wrong else "BLANK1")
            for text in wrong if ob == active else ():
                say(box, text, "ERROR", context)

    def _draw_channels(self, layout: bpy.types.UILayout, action: bpy.types.Action) -> None:
        own = of_action(action)
        row = layout.row()
        row.label(text="Channels")
        row.menu("MORPHRETARGET_MT_channel_presets", text="", icon="PRESET")
        column = draw_list(layout, "MORPHRETARGET_UL_channels", own, "channels", "active_channel", rows=5)
        column.operator("morph_retarget.add_channel", text="", icon="ADD").action = action.name
        draw_remove(column, "morph_retarget.remove_channel", len(own.channels) > 1).action = action.name
        column.separator()
        column.operator("morph_retarget.duplicate_channel", text="", icon="DUPLICATE").action = action.name
        for direction in ("UP", "DOWN"):
            button = column.operator("morph_retarget.move_channel", text="", icon=f"TRIA_{direction}")
            button.action, button.direction = action.name, direction


def _draw_variant(row: bpy.types.UILayout, ob: bpy.types.Object) -> None:
    """Draw which variant a character plays, where there are several."""
    member = query.member_now(ob)
    if member is None or len(member.part.binding.variants) < 2:
        return
    binding = member.part.binding
    for choice, icon in (("PREVIOUS", "TRIA_LEFT"), ("NEXT", "TRIA_RIGHT"), ("NEAREST", "PIVOT_CURSOR")):
        button = row.operator("morph_retarget.choose_variant", text="", icon=icon, emboss=False)
        button.character, button.choice = ob.name, choice
        if choice == "PREVIOUS":
            row.label(text=f"{binding.variant + 1}/{len(binding.variants)}")


CLASSES = (
    MORPHRETARGET_UL_channels,
    MORPHRETARGET_MT_actions,
    MORPHRETARGET_MT_channel_presets,
    MORPHRETARGET_PT_generalized,
)
