"""Key remapping: changing a movement mode without changing the motion of the active body (Hecker 2008 §3.3).

Each key becomes ``G_new(b, S_old(b, q))`` for the active body b; so do its handles. The maps are linear at each key,
and `tracks` sees to it that linear maps keep the shape of curves, so the body moves as before between keys as well,
as long as its target stays where it is.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial

import bpy
import numpy as np

from ...core import quat
from ...core.arrays import Array, Indices
from ...core.morph import movement
from ...core.morph.channels import Channel, TargetKind
from ...core.morph.movement import Frames
from ..properties import of_rig
from ..rig import scene_of
from . import cast, definitions, keys, targets, tracks
from .cast import Member
from .properties import MORPHRETARGET_PG_channel, of_action
from .tracks import Track


@dataclass(frozen=True, eq=False)
class Space:
    """How one body of one channel moves at some times, whatever the modes."""

    member: Member
    channel: Channel
    body: int
    mirrored: bool
    ob: bpy.types.Object
    times: Array

    def frames(self, channel: Channel) -> Frames:
        """Return the frames of the body in the modes of a channel, one row for each time.

        Raises:
            MorphError: See `_target`.
        """
        found = movement.frames(
            self.member.bodies, np.array([self.body]), [channel.movement], np.array([self.mirrored])
        )
        target = self._target(channel) if channel.has_target else None
        return found if target is None else found.toward(target[:, None])

    def _target(self, channel: Channel) -> Array | None:
        """Return where the target of a channel is at each time [m], character frame, None where there is none."""
        if channel.target is TargetKind.EXTERNAL:
            item = of_rig(self.ob).channels[channel.name]
            return targets.over(self.member, item, scene_of(), self.times) if cast.has_target(item) else None
        body = self.member.part.binding.target_of(channel, self.body)
        return None if body is None else targets.of_body(self.member, body, self.times)


def space_of(ob: bpy.types.Object, action: bpy.types.Action, name: str, times: Array) -> Space | None:
    """Return how the active body of a channel moves on a character, None when the channel selects none there.

    Raises:
        MorphError: The action cannot play on the character.
    """
    member = cast.member(ob, action)
    channels = member.definition.channels
    own = [e for e in member.part.binding.entries if channels[e.channel].name == name]
    if not own:
        return None
    active = member.rig.skeleton.index.get(of_rig(ob).channels[name].active_body)
    entry = next((e for e in own if e.body == active), own[0])
    return Space(member, channels[entry.channel], entry.body, entry.mirrored, ob, times)


def changed(item: MORPHRETARGET_PG_channel) -> None:
    """Remap the keys of a channel whose movement mode has just been changed, and remember what they mean now."""
    action = item.id_data
    assert isinstance(action, bpy.types.Action), "channels are defined on actions"
    old_movement, old_target = definitions.from_text(item.keyed_in)
    new = definitions.channel(item)
    item.keyed_in = definitions.to_text(new.movement, new.target)
    if (old_movement, old_target) == (new.movement, new.target) or not of_action(action).remap:
        return
    secondary = definitions.context(item.secondary) if old_target is TargetKind.CONTEXT else None
    old = replace(new, movement=old_movement, target=old_target, secondary=secondary)
    ob = _active_character(action)
    if ob is not None:
        cast.forget()
        remap(ob, action, old, new)


def remap(ob: bpy.types.Object, action: bpy.types.Action, old: Channel, new: Channel) -> None:
    """Change the keys of a channel so that its active body on a character moves in new modes as it did in the old ones.

    Raises:
        MorphError: The action cannot play on the character.
    """
    found, bag = keys.curves(action), keys.bag_of(action)
    parts = {part: tracks.read(found, keys.path(new.name, part), default) for part, default in keys.DEFAULTS.items()}
    times = tracks.union([track.times for track in parts.values() if track is not None])
    space = space_of(ob, action, new.name, times) if len(times) else None
    if space is None:
        return
    for part, track in mapped(parts, times, space.frames(old), space.frames(new)).items():
        tracks.write(bag, found, keys.path(new.name, part), track, new.name, keys.DEFAULTS[part])


def mapped(parts: Mapping[str, Track | None], times: Array, old: Frames, new: Frames) -> dict[str, Track]:
    """Return tracks of one space in another: specialized by ``old``, generalized by ``new``.

    Args:
        parts: Tracks of the position and the rotation, None for what has no keys.
        times: All times of their keys.
        old: Frames of the body at these times.
        new: The same in the other space.
    """
    out: dict[str, Track] = {}
    for part, track in parts.items():
        if track is not None:
            rows = np.argmin(np.abs(times - track.times[:, None]), axis=-1)
            out[part] = track.mapped(partial(_through, part, _rows(old, rows), _rows(new, rows)))
    return out


def _through(part: str, old: Frames, new: Frames, values: Array) -> Array:
    """Return positions or rotations of one space in another, shape (key, component)."""
    own = values[:, None]
    if part == "position":
        return movement.generalize(new, *movement.specialize(old, own, quat.identity(1, 1)))[0][:, 0]
    return movement.generalize(new, *movement.specialize(old, np.zeros((1, 1, 3)), own))[1][:, 0]


def _rows(found: Frames, rows: Indices) -> Frames:
    """Return the frames of some times."""
    if len(found.axes) == 1:
        return found
    gaze = None if found.gaze is None else replace(found.gaze, turns=found.gaze.turns[rows])
    return replace(found, axes=found.axes[rows], scale=found.scale[rows], gaze=gaze)


def _active_character(action: bpy.types.Action) -> bpy.types.Object | None:
    """Return the character whose motion is kept: the active one, else the first that plays the action."""
    playing = cast.playing(scene_of(), action)
    layer = bpy.context.view_layer
    active = layer.objects.active if layer is not None else None
    return active if active in playing else next(iter(playing), None)
