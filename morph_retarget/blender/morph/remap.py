"""Key remapping: changing a movement mode without changing the motion of the active body (Hecker 2008 §3.3).

Each key becomes ``G_new(b, S_old(b, q))`` for the active body b; so do its handles. The maps are linear at each key
(where a ground-relative one bends, at rest height, keys are added), and `tracks` sees to it that linear maps keep the
shape of curves, so the body moves as before between keys as well, as long as its target stays where it is.

Values without keys are mapped too, except those that nobody has set yet. Keys whose new meaning depends on a target
that has not been chosen yet wait for it: `keyed_in` says what keys mean.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from functools import partial

import bpy
import numpy as np

from ...core import play, quat
from ...core.arrays import Array
from ...core.errors import MorphError
from ...core.morph import movement
from ...core.morph.bind import bind
from ...core.morph.channels import Channel, TargetKind
from ...core.morph.movement import Frames
from ...core.play import Part
from ..actions import CurveMap
from ..properties import of_rig
from ..rig import scene_of
from . import autokey, cast, definitions, keys, own_values, targets, tracks
from .member import Member
from .properties import MORPHRETARGET_PG_channel, of_action
from .tracks import Change

PLACE = 3e-6
"""How far curves may stray where they have to be drawn anew [m]."""
TURN = 1e-6
"""How far components of rotations may."""
FramesAt = Callable[[Array], Frames]
"""From times to the frames of one body at them, or for all times."""


@dataclass(frozen=True, eq=False)
class Space:
    """How one body of one channel moves, whatever the modes."""

    member: Member
    channel: Channel
    body: int
    mirrored: bool
    ob: bpy.types.Object
    known: dict[Channel, tuple[Part, int | None]] = field(default_factory=dict[Channel, tuple[Part, int | None]])
    """What moves the targets that are bodies, and which body is the target."""

    def frames(self, channel: Channel, times: Array) -> Frames:
        """Return the frames of the body in the modes of a channel, at some times or for all times.

        Raises:
            MorphError: See `_target`.
        """
        found = movement.frames(
            self.member.bodies, np.array([self.body]), [channel.movement], np.array([self.mirrored])
        )
        target = self._target(channel, times) if channel.has_target else None
        return found if target is None else found.toward(target[:, None])

    def _target(self, channel: Channel, times: Array) -> Array | None:
        """Return where the target of a channel is [m], character frame, shape (time or 1, 3), None without one."""
        items = of_rig(self.ob).channels
        if channel.target is TargetKind.EXTERNAL:
            item = items[channel.name]
            return targets.over(self.member, item, scene_of(), times) if own_values.has_target(item) else None
        if channel not in self.known:
            definition = self.member.definition
            others = tuple(channel if c.name == channel.name else c for c in definition.channels)
            definition = replace(definition, channels=others)
            binding = bind(
                definition, self.member.bodies, of_rig(self.ob).variant, own_values.missing(self.ob, definition)
            )
            own = self.member
            first = play.prepare(own.character, binding.without_followers(), own.solver, own.limits, own.fixed)
            self.known[channel] = (first, binding.target_of(channel, self.body))
        part, body = self.known[channel]
        return None if body is None else targets.of_body(self.member, part, body, scene_of(), times)


def space_of(ob: bpy.types.Object, action: bpy.types.Action, name: str, body: str = "") -> Space | None:
    """Return how a body of a channel moves on a character, the active one without a name, None when it does not.

    Raises:
        MorphError: The action cannot play on the character.
    """
    member = cast.member(ob, action)
    channels = member.definition.channels
    own = [e for e in member.binding.entries if channels[e.channel].name == name]
    if not own:
        return None
    active = member.rig.skeleton.index.get(body or of_rig(ob).channels[name].active_body)
    entry = next((e for e in own if e.body == active), None if body else own[0])
    if entry is None:
        return None
    return Space(member, channels[entry.channel], entry.body, entry.mirrored, ob)


def changed(item: MORPHRETARGET_PG_channel) -> None:
    """Remap the keys of a channel whose movement mode has just been changed, and remember what they mean now."""
    if not item.name:
        return  # it is just being made
    action = item.id_data
    assert isinstance(action, bpy.types.Action), "channels are defined on actions"
    try:
        old_movement, old_target = definitions.from_text(item.keyed_in)
        new = definitions.channel(item)
    except MorphError:
        return  # a setting that this version does not know; the panel tells of it
    if (old_movement, old_target) == (new.movement, new.target):
        return
    secondary = definitions.context(item.secondary) if old_target is TargetKind.CONTEXT else None
    old = replace(new, movement=old_movement, target=old_target, secondary=secondary)
    if of_action(action).remap:
        cast.forget()
        done = any(remap(ob, action, old, new) for ob in _characters(action))
        if not done and new.target is TargetKind.EXTERNAL and new.has_target and _is_keyed(action, new.name):
            return  # it waits for its target
    item.keyed_in = definitions.to_text(new.movement, new.target)


def catch_up(action: bpy.types.Action) -> None:
    """Remap the keys of channels that have waited for a target."""
    for item in of_action(action).channels:
        changed(item)


def remap(ob: bpy.types.Object, action: bpy.types.Action, old: Channel, new: Channel) -> bool:
    """Change the keys of a channel so that its active body on a character moves in new modes as it did in the old ones.

    Returns:
        Whether there is such a body.
    """
    try:
        space = space_of(ob, action, new.name)
        if space is None:
            return False
        keys.by_name(action, ob)
        found, bag = _all_curves(action), keys.bag_of(action)
        item = of_rig(ob).channels[new.name]
        before, after = steady(partial(space.frames, old)), steady(partial(space.frames, new))
        for part, default in keys.DEFAULTS.items():
            path, now = keys.path(new.name, part), np.array(getattr(item, part), dtype=np.float64)
            at = partial(change, part, before, after)
            track = tracks.read(found, path, now)
            if track is not None:
                moved = track.mapped(at)
                if moved.curves != track.curves:
                    tracks.write(bag, found, path, moved, new.name, moved.still)
                value = np.where([curve is None for curve in moved.curves], moved.still, now)
            elif np.abs(now - default).max() > tracks.NOTHING:
                value = at(np.array([scene_of().frame_current_final])).applied(range(len(now)), now[None])[0]
            else:
                continue
            autokey.share(action, new.name, part, value)
    except MorphError:
        return False
    return True


def steady(found: FramesAt) -> FramesAt:
    """Return the same, but what holds for all times is asked for only once."""
    kept: list[Frames] = []

    def at(times: Array) -> Frames:
        if kept:
            return kept[0]
        out = found(times)
        if len(out) == 1 < len(times):
            kept.append(out)
        return out

    return at


def change(part: str, old: FramesAt, new: FramesAt, times: Array) -> Change:
    """Return what takes positions or rotations in some frames of a body to other frames of it, at some times.

    Raises:
        MorphError: A target cannot be read.
    """
    return _between(part, old(times), new(times), times)


def _between(part: str, old: Frames, new: Frames, times: Array) -> Change:
    """Return what takes positions or rotations in some frames of a body to other frames of it, at some times."""
    rows = max(len(old), len(new))
    if part == "rotation":
        matrix, offset = _linear(4, rows, lambda q: _turned_back(new, _turned(old, q)))
        return Change(times, matrix, offset, None, (np.zeros((1, 4)), np.zeros(1)), np.full(4, TURN))

    def through(up: bool) -> tuple[Array, Array]:
        first, then = _on_one_side(old, up), _on_one_side(new, up)
        return _linear(3, rows, lambda p: _generalized(then, _placed(first, p)))

    matrix, offset = through(up=False)
    placed, start = _linear(3, rows, lambda p: _placed(_on_one_side(old, up=False), p))
    bends = bool((old.lift != 1.0).any() or (new.lift != 1.0).any())
    level = (old if (old.lift != 1.0).any() else new).origin[0, 0, 2]
    length = np.linalg.norm(placed, axis=-2).max(axis=0)
    return Change(
        times,
        matrix,
        offset,
        through(up=True) if bends else None,
        (placed[:, 2], start[:, 2] - level),
        PLACE / np.maximum(length, 1e-9),
    )


def _linear(count: int, rows: int, through: Callable[[Array], Array]) -> tuple[Array, Array]:
    """Return a linear map as its matrices and offsets, shapes (row, count, count) and (row, count)."""
    if rows == 1:  # all at once, as if they were several times
        found = through(np.eye(count + 1, count, -1))
        return (found[1:] - found[:1]).T[None], found[:1]
    offset = through(np.zeros((1, count)))
    columns = [through(unit[None]) - offset for unit in np.eye(count)]
    return np.stack(np.broadcast_arrays(*columns), axis=-1), offset


def _placed(found: Frames, values: Array) -> Array:
    return movement.specialize(found, values[:, None], quat.identity(1, 1))[0][:, 0]


def _generalized(found: Frames, places: Array) -> Array:
    return movement.generalize(found, places[:, None], quat.identity(1, 1))[0][:, 0]


def _turned(found: Frames, values: Array) -> Array:
    return movement.specialize(found, np.zeros((1, 1, 3)), values[:, None])[1][:, 0]


def _turned_back(found: Frames, turns: Array) -> Array:
    return movement.generalize(found, np.zeros((1, 1, 3)), turns[:, None])[1][:, 0]


def _on_one_side(found: Frames, up: bool) -> Frames:
    """Return frames as they are below or above the height where they bend, straight on."""
    scale = found.scale.copy()
    scale[..., 2] *= np.where(up, found.lift, 1.0)
    return replace(found, scale=scale, lift=np.ones_like(found.lift))


def _all_curves(action: bpy.types.Action) -> CurveMap:
    """Return the curves of an action by path and index, muted ones as well."""
    return {(curve.data_path, curve.array_index): curve for curve in keys.bag_of(action).fcurves}


def _is_keyed(action: bpy.types.Action, name: str) -> bool:
    return any(path in {keys.path(name, part) for part in keys.DEFAULTS} for path, _ in _all_curves(action))


def _characters(action: bpy.types.Action) -> Iterator[bpy.types.Object]:
    """Yield the characters whose motion may be kept: the active one, else the first on which the channel plays."""
    playing = cast.playing(scene_of(), action)
    layer = bpy.context.view_layer
    active = layer.objects.active if layer is not None else None
    yield from sorted(playing, key=lambda ob: ob != active)
