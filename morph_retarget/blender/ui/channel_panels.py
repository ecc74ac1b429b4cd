"""The panels of a generalized action's active channel: what it selects, how it moves, its values."""

# The stubs take every layout and every operator button for optional.
# pyright: reportOptionalMemberAccess=false, reportArgumentType=false

import bpy

from ...core.errors import MorphError
from ...core.morph import words
from ...core.morph.channels import Channel
from ..morph import cast, definitions, query
from ..morph.properties import MORPHRETARGET_PG_channel, MORPHRETARGET_PG_context, MORPHRETARGET_PG_values, of_action
from ..properties import of_rig
from .panels import _InTab as InTab
from .panels import _layout as split_layout
from .panels import _say as say

_ANSWERS = ("upright_spine", "has_graspers", "has_feet", "has_mouth", "has_tail", "has_wings")


class _OfChannel(InTab):
    """A panel about the active channel of the active character's action."""

    bl_parent_id = "MORPHRETARGET_PT_generalized"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        ob = query.active_character(context)
        return ob is not None and query.active_channel(cast.action_of(ob)) is not None


def _shown(context: bpy.types.Context) -> tuple[bpy.types.Object, bpy.types.Action, MORPHRETARGET_PG_channel]:
    """Return the character, its action and the channel that the panels are about."""
    ob = query.active_character(context)
    action = cast.action_of(ob) if ob is not None else None
    item = query.active_channel(action)
    assert ob is not None and action is not None and item is not None, "the panels are only shown for a channel"  # noqa: PT018
    return ob, action, item


def _values(ob: bpy.types.Object, item: MORPHRETARGET_PG_channel) -> MORPHRETARGET_PG_values | None:
    return of_rig(ob).channels.get(item.name)


def _understood(
    layout: bpy.types.UILayout, item: MORPHRETARGET_PG_channel, context: bpy.types.Context
) -> Channel | None:
    """Return what a channel means; what cannot be understood is told."""
    try:
        return definitions.channel(item)
    except MorphError as error:
        say(layout, str(error), "ERROR", context)
        return None


def _draw_context(layout: bpy.types.UILayout, item: MORPHRETARGET_PG_context) -> None:
    column = layout.column(align=True)
    column.prop(item, "capability")
    for zone in ("depth", "side", "height"):
        row = column.row(align=True)
        row.prop(item, zone)
        if getattr(item, zone) != "any":
            row.prop(item, f"{zone}_space", text="")
    column.prop(item, "extent")
    column.prop(item, "modifier")


class MORPHRETARGET_PT_context(_OfChannel, bpy.types.Panel):
    bl_idname = "MORPHRETARGET_PT_context"
    bl_label = "Context"

    def draw(self, context: bpy.types.Context) -> None:
        layout, (_, action, item) = split_layout(self), _shown(context)
        channel = _understood(layout, item, context)
        if channel is not None:
            say(layout, f"Selects {words.context_in_words(channel.context)}", "RESTRICT_SELECT_OFF", context)
        _draw_context(layout, item.context)
        assert context.scene is not None, "the viewport shows a scene"
        column = layout.column(align=True)
        for other in cast.playing(context.scene, action):
            member = query.member_now(other)
            place = of_action(action).channels.find(item.name)
            if member is None or place >= len(member.part.binding.selected):
                continue
            count = len(member.part.binding.selected[place])
            row = column.row(align=True)
            row.enabled = count > 0
            button = row.operator(
                "morph_retarget.select_bodies",
                text=f"{other.name}: {count} {'body' if count == 1 else 'bodies'}",
                icon="RESTRICT_SELECT_OFF" if count else "ERROR",
                translate=False,
            )
            button.character, button.channel, button.use_channel = other.name, item.name, True


class MORPHRETARGET_PT_movement(_OfChannel, bpy.types.Panel):
    bl_idname = "MORPHRETARGET_PT_movement"
    bl_label = "Movement"

    def draw(self, context: bpy.types.Context) -> None:
        layout, (_, action, item) = split_layout(self), _shown(context)
        channel = _understood(layout, item, context)
        if channel is None:
            return
        say(layout, words.movement_in_words(channel), "ANIM", context)
        for text in words.caveats(channel):
            say(layout, text, "INFO", context)
        idle = words.without_effect(channel)
        heading = layout.column(heading="Poses", align=True)
        heading.prop(item, "poses_position")
        heading.prop(item, "poses_rotation")
        column = layout.column(align=True)
        for name in ("position", "rotation", "scale"):
            _draw_mode(column, item, name, idle)
        column = layout.column(heading="Relative To", align=True)
        for name, text in (
            ("ground_relative", "Ground"),
            ("sagittal_relative", "Plane of Symmetry"),
            ("secondary_relative", "Target"),
        ):
            _draw_mode(column, item, name, idle, text)
        column = layout.column(heading="Target", align=True)
        _draw_mode(column, item, "directional_only", idle)
        _draw_mode(column, item, "look_at", idle)
        layout.prop(of_action(action), "remap")


def _draw_mode(
    layout: bpy.types.UILayout, item: MORPHRETARGET_PG_channel, name: str, idle: frozenset[str], text: str | None = None
) -> None:
    """Draw a movement mode, grey where it changes nothing."""
    row = layout.row()
    row.active = name not in idle
    row.prop(item, name, text=text)


class MORPHRETARGET_PT_target(_OfChannel, bpy.types.Panel):
    bl_idname = "MORPHRETARGET_PT_target"
    bl_label = "Target"

    def draw(self, context: bpy.types.Context) -> None:
        layout, (ob, _, item) = split_layout(self), _shown(context)
        layout.prop(item, "target", text="Kind")
        channel = _understood(layout, item, context)
        if channel is None or item.target == "none":
            return
        say(layout, f"Target: {words.target_in_words(channel)}", "CON_TRACKTO", context)
        if not channel.movement.has_target:
            say(layout, "No movement mode uses it: turn on Relative To Target, or Look At", "INFO", context)
        if item.target == "context":
            _draw_context(layout, item.secondary)
            return
        values = _values(ob, item)
        if values is None:
            return
        column = layout.column(align=True)
        column.prop(values, "target", text=f"Of {ob.name}", translate=False)
        if values.target is not None and values.target.type == "ARMATURE":
            column.prop_search(values, "target_bone", values.target.data, "bones", icon="BONE_DATA")


class MORPHRETARGET_PT_values(_OfChannel, bpy.types.Panel):
    bl_idname = "MORPHRETARGET_PT_values"
    bl_label = "Values and Keys"

    def draw(self, context: bpy.types.Context) -> None:
        layout, (ob, _, item) = split_layout(self), _shown(context)
        values = _values(ob, item)
        if values is None:
            return
        column = layout.column()
        column.use_property_decorate = True
        for name in ("position", "rotation"):
            part = column.column()
            part.active = getattr(item, f"poses_{name}")
            part.prop(values, name)
        column.prop(values, "weight")
        for deform in values.deforms:
            row = column.row(align=True)
            row.prop(deform, "value", text=deform.name, translate=False)
            row.operator("morph_retarget.remove_deform", text="", icon="X", emboss=False).name = deform.name
        row = layout.row(align=True)
        for name, text in (("key_channel", "Key"), ("rest_channel", "Rest")):
            button = row.operator(
                f"morph_retarget.{name}", text=text, icon="KEYINGSET" if name[0] == "k" else "LOOP_BACK"
            )
            button.character, button.channel = ob.name, item.name
        row.operator("morph_retarget.add_deform", text="Deform", icon="ADD").channel = item.name
        layout.prop_search(values, "active_body", ob.data, "bones", icon="BONE_DATA")
        active = context.object
        if active is not None and of_rig(active).stands_for is not None:
            layout.operator("morph_retarget.finish_specialized", icon="CHECKMARK").stand_in = active.name
            return
        button = layout.operator("morph_retarget.edit_specialized", icon="FCURVE")
        button.character, button.channel = ob.name, item.name


class MORPHRETARGET_PT_blending(_OfChannel, bpy.types.Panel):
    bl_idname = "MORPHRETARGET_PT_blending"
    bl_label = "Blending"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        layout, (_, _, item) = split_layout(self), _shown(context)
        layout.prop(item, "blend_group")
        layout.prop(item, "priority")
        column = layout.column(align=True)
        column.prop(item, "position_weight")
        column.prop(item, "rotation_weight")


class MORPHRETARGET_PT_variants(_OfChannel, bpy.types.Panel):
    bl_idname = "MORPHRETARGET_PT_variants"
    bl_label = "Variants and Mirror"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        layout, (_, _, item) = split_layout(self), _shown(context)
        layout.prop(item, "varies")
        column = layout.column(align=True)
        column.active = item.varies
        column.prop(item, "variant_group")
        column.prop(item, "variant_side")
        layout.prop(item, "mirror")


class MORPHRETARGET_PT_branch(_OfChannel, bpy.types.Panel):
    bl_idname = "MORPHRETARGET_PT_branch"
    bl_label = "Characters It Is For"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        layout, (_, action, _) = split_layout(self), _shown(context)
        own = of_action(action)
        column = layout.column(align=True)
        for name in _ANSWERS:
            column.prop(own, name)
        column.prop(own, "leg_count")
        layout.prop(own, "movement")
        if own.movement:
            row = layout.row()
            row.operator("morph_retarget.play_movement", icon="NLA").movement = own.movement


CLASSES = (
    MORPHRETARGET_PT_context,
    MORPHRETARGET_PT_movement,
    MORPHRETARGET_PT_target,
    MORPHRETARGET_PT_values,
    MORPHRETARGET_PT_blending,
    MORPHRETARGET_PT_variants,
    MORPHRETARGET_PT_branch,
)
