"""F-curves of channels: where they are, keying, renaming and removing them.

Blender's own keying names a collection's item by its number. Characters may have their items in different orders, so
curves are kept by the channel's name; `by_name` puts right what came by number.
"""

import re
from collections.abc import Sequence

import bpy

from ...core.errors import MotionError
from .. import actions
from ..actions import CurveMap
from ..properties import of_rig
from .properties import MORPHRETARGET_PG_channel, of_action

PARTS = ("position", "rotation", "weight")
DEFAULTS = {"position": (0.0, 0.0, 0.0), "rotation": (1.0, 0.0, 0.0, 0.0)}
_ROOT = "morph_retarget.channels["
_NUMBERED = re.compile(r"^morph_retarget\.channels\[(\d+)\](?:\.deforms\[(\d+)\])?")


def prefix(channel: str) -> str:
    """Return how the data paths of a channel's values begin."""
    return f'{_ROOT}"{bpy.utils.escape_identifier(channel)}"]'


def path(channel: str, part: str) -> str:
    """Return the data path of one of a channel's values, from the armature object."""
    return f"{prefix(channel)}.{part}"


def deform_path(channel: str, deform: str) -> str:
    """Return the data path of a deform's value."""
    return f'{prefix(channel)}.deforms["{bpy.utils.escape_identifier(deform)}"].value'


def deforms_of(action: bpy.types.Action, channel: str) -> list[str]:
    """Return the deforms of a channel that an action keys."""
    start, end = f'{prefix(channel)}.deforms["', '"].value'
    paths = dict.fromkeys(path for path, _ in curves(action) if path.startswith(start) and path.endswith(end))
    return [bpy.utils.unescape_identifier(path.removeprefix(start).removesuffix(end)) for path in paths]


def slot_of(action: bpy.types.Action) -> bpy.types.ActionSlot | None:
    """Return the slot that all characters share, None while nothing plays the action."""
    return next((slot for slot in action.slots if slot.target_id_type in {"OBJECT", "UNSPECIFIED"}), None)


def curves(action: bpy.types.Action) -> CurveMap:
    """Return the curves of a generalized action by path and index, muted ones not among them."""
    slot = slot_of(action)
    return actions.curves(action, slot) if slot is not None else {}


def bag_of(action: bpy.types.Action) -> bpy.types.ActionChannelbag:
    """Return where the curves of a generalized action are kept, made if there is none."""
    slot = slot_of(action) or action.slots.new(id_type="OBJECT", name="Characters")
    layer = action.layers[0] if len(action.layers) else action.layers.new("Layer")
    strip = layer.strips[0] if len(layer.strips) else layer.strips.new(type="KEYFRAME")
    assert isinstance(strip, bpy.types.ActionKeyframeStrip), "Blender has no other kind of strip yet"
    bag = strip.channelbag(slot, ensure=True)
    assert bag is not None, "it was to be made"
    return bag


def insert(ob: bpy.types.Object, channel: str, parts: Sequence[str], frame: float) -> None:
    """Key values of a channel as they are on a character.

    Raises:
        MotionError: The character has no such channel.
    """
    item = of_rig(ob).channels.get(channel)
    if item is None:
        names = ", ".join(i.name for i in of_rig(ob).channels) or "none"
        raise MotionError(f"{ob.name!r} has no channel {channel!r}: choose one of {names}")
    for part in parts:
        if part == "deforms":
            for deform in item.deforms:
                ob.keyframe_insert(deform_path(channel, deform.name), frame=frame, group=channel)
        else:
            ob.keyframe_insert(path(channel, part), frame=frame, group=channel)
    action, _ = actions.assigned(ob)
    if action is not None:
        by_name(action, ob)


def remove(action: bpy.types.Action, channel: str) -> None:
    """Remove the curves of a channel."""
    bag, start = bag_of(action), prefix(channel)
    for curve in [curve for curve in bag.fcurves if curve.data_path.startswith(start)]:
        bag.fcurves.remove(curve)
    group = bag.groups.get(channel)
    if group is not None and not len(group.channels):
        bag.groups.remove(group)


def rename(item: MORPHRETARGET_PG_channel, old: str) -> None:
    """Let curves and the characters' values follow a channel's new name."""
    action = item.id_data
    assert isinstance(action, bpy.types.Action), "channels are defined on actions"
    start = prefix(old)
    for bag in (bag for layer in action.layers for strip in layer.strips for bag in strip.channelbags):  # type: ignore[attr-defined]
        for curve in bag.fcurves:
            if curve.data_path.startswith(start):
                curve.data_path = prefix(item.name) + curve.data_path.removeprefix(start)
        group = bag.groups.get(old)
        if group is not None:
            group.name = item.name
    for ob in bpy.data.objects:
        own = of_rig(ob)
        if _plays(ob, action) and old in own.channels:
            left = own.channels.find(item.name)
            if left >= 0:
                own.channels.remove(left)  # of a channel that was there before
            own.channels[old].name = item.name
        if own.stands_for_channel == old and own.stands_for is not None and _plays(own.stands_for, action):
            own.stands_for_channel = item.name


def _plays(ob: bpy.types.Object, action: bpy.types.Action) -> bool:
    """Return whether an armature plays an action, in strips or by itself."""
    data = ob.animation_data
    if ob.type != "ARMATURE" or data is None:
        return False
    return data.action == action or any(strip.action == action for track in data.nla_tracks for strip in track.strips)


def by_name(action: bpy.types.Action, ob: bpy.types.Object) -> bool:
    """Give curves that name channels and deforms by their numbers on a character their names instead.

    Returns:
        Whether there are numbers left, which mean nothing on this character.
    """
    bag, left = bag_of(action), False
    numbered = [curve for curve in bag.fcurves if _NUMBERED.match(curve.data_path)]
    if not numbered:
        return False
    named = {(curve.data_path, curve.array_index): curve for curve in bag.fcurves}
    for curve in numbered:
        found = _named(curve.data_path, ob)
        if found is None:
            left = True
            continue
        name, wanted = found
        there = named.get((wanted, curve.array_index))
        if there is None:
            curve.data_path = wanted
            actions.put_in_group(bag, curve, name)
            named[wanted, curve.array_index] = curve
            continue
        for point in curve.keyframe_points:
            there.keyframe_points.insert(*point.co)
        bag.fcurves.remove(curve)
    return left


def _named(numbered: str, ob: bpy.types.Object) -> tuple[str, str] | None:
    """Return the channel that a path means and the path by names, None for numbers that are not there."""
    match = _NUMBERED.match(numbered)
    assert match is not None, "only paths with numbers are asked for"
    items = of_rig(ob).channels
    if int(match[1]) >= len(items):
        return None
    item = items[int(match[1])]
    if match[2] is None:
        return item.name, prefix(item.name) + numbered[match.end() :]
    if int(match[2]) >= len(item.deforms):
        return None
    return item.name, deform_path(item.name, item.deforms[int(match[2])].name)


def channel_named(action: bpy.types.Action, name: str) -> MORPHRETARGET_PG_channel:
    """Return a channel's definition; the active one for an empty name.

    Raises:
        MotionError: There is none.
    """
    own = of_action(action)
    if not name and 0 <= own.active_channel < len(own.channels):
        return own.channels[own.active_channel]
    found = own.channels.get(name)
    if found is None:
        names = ", ".join(item.name for item in own.channels) or "none"
        raise MotionError(f"action {action.name!r} has no channel {name!r}: choose one of {names}")
    return found
