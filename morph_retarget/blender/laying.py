"""Where a new motion goes on its target: in place of the old one, beside it, or over it."""

import contextlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any, Protocol

import bpy
import numpy as np

from ..core import quat
from ..core.arrays import Array
from . import actions, keying
from .actions import Writer
from .channels import Channel
from .rig import Rig
from .writing import Written

_Weight = tuple[float, Any]
"""How far an action counts, and how it is laid over strips: "COMBINE" lets rotations follow each other and adds up
locations."""


class Lay(StrEnum):
    """What becomes of the target's own animation."""

    REPLACE = "replace"
    """The target plays the new action; the old one is kept in the file."""
    STASH = "stash"
    """The target plays on what it plays; the new action waits on a muted track of the NLA."""
    ADD = "add"
    """What the new motion changes from its first frame on is laid over what the target plays."""


class Made(Protocol):
    """What has an action that was made."""

    @property
    def action(self) -> bpy.types.Action:
        """The action."""
        ...


@dataclass(frozen=True, eq=False)
class Laid:
    """A new action where it was put."""

    action: bpy.types.Action
    slot: bpy.types.ActionSlot


@dataclass(frozen=True)
class Place:
    """How a motion is laid on a target."""

    name: str
    """Of the action."""
    lay: Lay = Lay.REPLACE
    keep_others: bool = True
    """Take over what the old action does to other bones."""


def lay(target: Rig, made: Written, place: Place) -> Laid:
    """Key a motion in a new action and put that in its place."""
    ob = target.object
    if place.lay is Lay.ADD:
        return _add(ob, made, place.name)
    own, weight = actions.assigned(ob), _weight(ob)
    action, slot = keying.write(target, made.channels, made.body, made.frames, place.name, place.keep_others)
    if place.lay is Lay.STASH:
        actions.assign(ob, *own)
        _weigh(ob, weight)
        _strip(ob, action, slot).mute = True
    return Laid(action, slot)


# --- over the old one ---


def _add(ob: bpy.types.Object, made: Written, name: str) -> Laid:
    """Lay a motion over what an armature plays, which becomes a strip."""
    writer = Writer(name, ob)
    for channel in made.channels:
        if not channel.prop.startswith("["):
            values = _changes(channel)
            writer.write(channel.path(ob), values, made.frames, channel.bone or keying.OBJECT_GROUP)
    own, its_slot = actions.assigned(ob)
    if own is not None and its_slot is not None:
        _strip(ob, own, its_slot)
    actions.assign(ob, writer.action, writer.slot)
    _weigh(ob, (1.0, "COMBINE"))
    return Laid(writer.action, writer.slot)


def _changes(channel: Channel) -> Array:
    """Return what a channel does beyond its first frame, shape (frame, n)."""
    values = channel.values
    if channel.prop == "rotation_quaternion":
        return quat.continuous(quat.multiply(quat.conjugate(values[:1]), values))
    if channel.prop == "rotation_axis_angle":
        turns = quat.from_axis_angle(quat.unit(values[:, 1:]), values[:, 0])
        vectors = quat.to_rotation_vector(quat.multiply(quat.conjugate(turns[:1]), turns))
        angles = np.linalg.norm(vectors, axis=-1, keepdims=True)
        return np.concatenate([angles, quat.unit(vectors)], axis=-1)
    return values - values[:1]


def _strip(ob: bpy.types.Object, action: bpy.types.Action, slot: bpy.types.ActionSlot) -> bpy.types.NlaTrack:
    """Put an action on a new track of its own, where it plays when it always did."""
    data = ob.animation_data or ob.animation_data_create()
    assert data is not None, "armatures can be animated"
    track = data.nla_tracks.new()
    track.name = action.name
    first, last = action.frame_range
    strip = track.strips.new(action.name, int(np.floor(first)), action)
    strip.action_slot = slot
    strip.action_frame_start, strip.action_frame_end = first, max(last, first + 1.0)
    strip.frame_start = first
    return track


def _weight(ob: bpy.types.Object) -> _Weight:
    data = ob.animation_data
    return (data.action_influence, data.action_blend_type) if data else (1.0, "REPLACE")


def _weigh(ob: bpy.types.Object, weight: _Weight) -> None:
    data = ob.animation_data
    if data is not None:
        data.action_influence, data.action_blend_type = weight


# --- taking it back ---


@contextlib.contextmanager
def undone_if_it_fails(ob: bpy.types.Object, made: Sequence[Made]) -> Iterator[None]:
    """Put back what an armature played, and remove the actions that were made, where the work fails or is stopped."""
    data = ob.animation_data
    before, tracks = actions.assigned(ob), len(data.nla_tracks) if data else 0
    weight = _weight(ob)
    try:
        yield
    except BaseException:
        data = ob.animation_data
        actions.assign(ob, *before)
        if data is not None:
            for track in list(data.nla_tracks)[tracks:]:
                data.nla_tracks.remove(track)
            _weigh(ob, weight)
        bpy.data.batch_remove([one.action for one in made])
        raise
