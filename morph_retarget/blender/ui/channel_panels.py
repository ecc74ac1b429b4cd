"""The panels of a generalized action's active channel: what it selects, how it moves, and relative to what."""

# The stubs take every layout and every operator button for optional.
# pyright: reportOptionalMemberAccess=false, reportArgumentType=false

from collections.abc import Sequence

import bpy

from ...core.errors import MorphError, listed
from ...core.morph import words
from ...core.morph.channels import Channel
from ..morph import cast, definitions, query
from ..morph.properties import MORPHRETARGET_PG_channel, MORPHRETARGET_PG_context, of_action
from ..morph.values import MORPHRETARGET_PG_values
from ..properties import of_rig
from .tab import InTab, say, split_layout, told

FEW = 2
"""So many bodies are called by their names."""


class OfChannel(InTab):
    """A panel about the active channel of the active character's action."""

    bl_parent_id = "MORPHRETARGET_PT_generalized"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        ob = query.active_character(context)
        return ob is not None and query.active_channel(cast.action_of(ob)) is not None


def shown(context: bpy.types.Context) -> tuple[bpy.types.Object, bpy.types.Action, MORPHRETARGET_PG_channel]:
    """Return the character, its action and the channel that the panels are about."""
    ob = query.active_character(context)
    action = cast.action_of(ob) if ob is not None else None
    item = query.active_channel(action)
    assert ob is not None and action is not None and item is not None, "the panels are only shown for a channel"  # noqa: PT018
    return ob, action, item


def values_shown(ob: bpy.types.Object, item: MORPHRETARGET_PG_channel) -> MORPHRETARGET_PG_values | None:
    """Return a character's values of a channel, None before it has a place for them."""
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


class MORPHRETARGET_PT_context(OfChannel, bpy.types.Panel):
    bl_idname = "MORPHRETARGET_PT_context"
    bl_label = "Context"

    def draw(self, context: bpy.types.Context) -> None:
        layout, (_, action, item) = split_layout(self), shown(context)
        channel = _understood(layout, item, context)
        if channel is not None:
            one = ", one at a time" if item.varies else ""
            say(layout, f"Selects {words.context_in_words(channel.context)}{one}", "RESTRICT_SELECT_OFF", context)
        _draw_context(layout, item.context)
        assert context.scene is not None, "the viewport shows a scene"
        column = layout.column(align=True)
        for other in cast.playing(context.scene, action):
            member = query.member_now(other)
            place = of_action(action).channels.find(item.name)
            if member is None or place >= len(member.part.binding.selected):
                continue
            names = [member.bodies.names[body] for body in member.part.binding.selected[place]]
            row = column.row(align=True)
            row.enabled = len(names) > 0
            button = row.operator(
                "morph_retarget.select_bodies",
                text=f"{other.name}: {_named(names)}",
                icon="RESTRICT_SELECT_OFF" if names else "ERROR",
                translate=False,
            )
            button.character, button.channel, button.use_channel = other.name, item.name, True


def _named(names: Sequence[str]) -> str:
    """Return a few bodies by name, more by number."""
    return listed(names) if 0 < len(names) <= FEW else f"{len(names) or 'no'} bodies"


class MORPHRETARGET_PT_movement(OfChannel, bpy.types.Panel):
    bl_idname = "MORPHRETARGET_PT_movement"
    bl_label = "Movement"

    def draw(self, context: bpy.types.Context) -> None:
        draw_movement(self, context)


def draw_movement(panel: bpy.types.Panel, context: bpy.types.Context) -> None:
    """Draw how the active channel moves."""
    layout, (_, action, item) = split_layout(panel), shown(context)
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
        ("ground_relative", told("Ground")),
        ("sagittal_relative", told("Plane of Symmetry")),
        ("secondary_relative", told("Target")),
    ):
        _draw_mode(column, item, name, idle, text)
    column = layout.column(heading="With Target", align=True)
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


class MORPHRETARGET_PT_target(OfChannel, bpy.types.Panel):
    bl_idname = "MORPHRETARGET_PT_target"
    bl_label = "Target"

    def draw(self, context: bpy.types.Context) -> None:
        layout, (ob, _, item) = split_layout(self), shown(context)
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
        values = values_shown(ob, item)
        if values is None:
            return
        column = layout.column(align=True)
        column.prop(values, "target", text=told("Of {name}", name=ob.name), translate=False)
        if values.target is not None and values.target.type == "ARMATURE":
            column.prop_search(values, "target_bone", values.target.data, "bones", icon="BONE_DATA")


CLASSES = (MORPHRETARGET_PT_context, MORPHRETARGET_PT_movement, MORPHRETARGET_PT_target)
