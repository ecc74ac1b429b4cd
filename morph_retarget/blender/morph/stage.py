"""Reading what characters are told at a moment: values of channels and places of targets."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from operator import attrgetter
from typing import Any

import bpy
import numpy as np

from ...core import play, quat
from ...core.arrays import Array
from ...core.errors import MorphError
from ...core.morph.channels import Values
from .. import actions
from ..actions import CurveMap
from ..locomotion import walks
from ..properties import of_rig
from ..rig import pose_of
from . import cast, keys, own_values
from .member import Member
from .pose import Singles
from .values import MORPHRETARGET_PG_values

Rows = tuple[tuple[float, ...], ...]
"""A matrix, row by row: Blender's own are slow to become arrays."""


@dataclass(frozen=True, eq=False)
class ToldValues:
    """The values of channels as they are read: enough to see whether they have changed."""

    rows: tuple[int, ...]
    """For each channel the place of its values."""
    numbers: Singles
    """The positions of all places, their rotations, their weights, shape (place * 8,)."""
    deforms: tuple[tuple[int, str, float], ...]
    """Channel, name and value."""

    @property
    def key(self) -> tuple[object, ...]:
        """Equal for the same values."""
        return self.rows, self.numbers.tobytes(), self.deforms

    @cached_property
    def values(self) -> Values:
        """Of all channels; a batch of one frame."""
        rows, numbers = self.rows, self.numbers.astype(np.float64)
        count = len(numbers) // 8
        positions, rotations, weights = np.split(numbers, [3 * count, 7 * count])
        return Values(
            positions.reshape(1, count, 3).take(rows, axis=1),
            quat.normalize(rotations.reshape(1, count, 4).take(rows, axis=1)),
            weights.reshape(1, count).take(rows, axis=1),
            {(channel, name): np.array([value]) for channel, name, value in self.deforms},
        )


@dataclass(frozen=True, eq=False)
class ToldTargets:
    """Where external targets are as it is read: enough to see whether they, or the character, have moved."""

    member: Member
    frame: Rows
    """The matrix of the character's object; without rows when it has no targets."""
    world: tuple[tuple[int, tuple[float, ...]], ...]
    """Channels that have external targets, and where these are [m], world space."""

    @property
    def key(self) -> tuple[object, ...]:
        """Equal for the same places."""
        return self.frame, self.world

    @cached_property
    def places(self) -> Mapping[int, Array]:
        """By channel [m], character frame, shapes (1, 3)."""
        found: dict[tuple[float, ...], Array] = {}
        for _, world in self.world:
            if world not in found:
                found[world] = to_character(self.member, np.array(self.frame), np.array(world))[None]
        return {channel: found[world] for channel, world in self.world}


def told_values(member: Member, ob: bpy.types.Object) -> ToldValues:
    """Return the values of all channels as they are on an object, original or evaluated."""
    items, names = of_rig(ob).channels, member.names
    rows = _rows_of(tuple(names), tuple(items.keys()))
    if rows is None:  # an evaluated copy may be older than a channel
        items = of_rig(member.rig.object).channels
        rows = _rows_of(tuple(names), tuple(items.keys()))
        assert rows is not None, "members have values for all channels"
    count = len(items)
    numbers = np.empty(count * 8, dtype=np.float32)
    items.foreach_get("position", numbers[: count * 3])
    items.foreach_get("rotation", numbers[count * 3 : count * 7])
    items.foreach_get("weight", numbers[count * 7 :])
    # Most have none, and of those Blender is asked as little as can be.
    some: list[tuple[int, Any]] = [(i, deforms) for i, deforms in enumerate(map(_deforms_of, items)) if deforms]
    named = [(items[i].name, deform.name, deform.value) for i, deforms in some for deform in deforms]
    return ToldValues(rows, numbers, tuple([(names[c], name, value) for c, name, value in named if c in names]))


_deforms_of = attrgetter("deforms")


@lru_cache(maxsize=64)
def _rows_of(wanted: tuple[str, ...], there: tuple[str, ...]) -> tuple[int, ...] | None:
    """Return the place of each channel that is wanted among those that are there, None if one is missing."""
    place = {name: i for i, name in enumerate(there)}
    return tuple([place[name] for name in wanted]) if place.keys() >= set(wanted) else None


def told_targets(member: Member, ob: bpy.types.Object, graph: bpy.types.Depsgraph) -> ToldTargets:
    """Return where the external targets of a character are."""
    world: list[tuple[int, tuple[float, ...]]] = []
    items = of_rig(ob).channels
    for name, channels in member.aims:
        place = _told_place(items[name], graph)
        if place is not None:
            world += [(i, place) for i in channels]
    if not world:
        return ToldTargets(member, (), ())
    matrix = ob.evaluated_get(graph).matrix_world
    return ToldTargets(member, tuple([matrix[i].to_tuple() for i in range(4)]), tuple(world))


def _told_place(item: MORPHRETARGET_PG_values, graph: bpy.types.Depsgraph) -> tuple[float, ...] | None:
    """Return where the target of a channel is [m], world space, None if it has none."""
    target = item.target
    if target is None:
        return None
    if not item.target_bone and (seen := _evaluated(target, graph)) is not None:
        return seen.matrix_world.translation.to_tuple()
    return tuple(place_of(target, item.target_bone, graph).tolist()) if own_values.has_target(item) else None


def values_of(member: Member, ob: bpy.types.Object) -> Values:
    """Return the values of all channels as they are on an object, original or evaluated; a batch of one frame."""
    return told_values(member, ob).values


def targets_of(member: Member, ob: bpy.types.Object, graph: bpy.types.Depsgraph) -> Mapping[int, Array]:
    """Return where the external targets of a character are, by channel [m], character frame, shapes (1, 3)."""
    return told_targets(member, ob, graph).places


def values_over(member: Member, ob: bpy.types.Object, frames: Array) -> Values:
    """Return the values of all channels at ``frames``, from the action's curves; what is not keyed stays as it is."""
    found, items = keys.curves(member.action), of_rig(ob).channels
    count, channels = len(frames), member.definition.channels
    positions, rotations = np.empty((count, len(channels), 3)), np.empty((count, len(channels), 4))
    weights = np.empty((count, len(channels)))
    deforms: dict[tuple[int, str], Array] = {}
    for i, channel in enumerate(channels):
        item, name = items[channel.name], channel.name
        positions[:, i] = _sampled(found, keys.path(name, "position"), frames, item.position)
        rotations[:, i] = quat.normalize(_sampled(found, keys.path(name, "rotation"), frames, item.rotation))
        weight = _sampled(found, keys.path(name, "weight"), frames, [item.weight])[:, 0]
        weights[:, i] = np.clip(weight, 0.0, 1.0)  # as Blender keeps a property within its limits
        for deform in item.deforms:
            path = keys.deform_path(name, deform.name)
            deforms[i, deform.name] = _sampled(found, path, frames, [deform.value])[:, 0]
    return Values(positions, rotations, weights, deforms)


def _sampled(found: CurveMap, path: str, frames: Array, now: Sequence[float]) -> Array:
    """Return a property at ``frames``, shape (frame, n), as it is now where nothing animates it."""
    values = np.array(now, dtype=np.float64)
    sampled = actions.sample_vector(found, path, frames, values)
    return np.broadcast_to(values, (len(frames), len(values))) if sampled is None else sampled


def place_of(target: bpy.types.Object, bone: str, graph: bpy.types.Depsgraph) -> Array:
    """Return where an object or one of its bones is [m], world space, shape (3,).

    A bone of a character that plays a generalized action is where that character's own movements bring it, those
    with targets left aside: two that reach for each other would otherwise chase each other.
    """
    seen = target.evaluated_get(graph)
    if not bone:
        return _matrix_of(target, graph)[:3, 3]
    if cast.action_of(target) is not None and not of_rig(target).muted:
        try:
            other = cast.member(target)
        except MorphError:
            other = None  # it is told where that character is drawn; here its pose counts as it is
        if other is not None and bone in other.rig.skeleton.index:  # so it is no control
            body = other.rig.skeleton.index[bone]
            played = play.evaluate(other.free, values_of(other, seen), {}, walks.layer_now(other, seen, graph))
            local = other.character.local_to_character.inverse().points(played.pose.positions[0, body])
            return _through(_matrix_of(target, graph), local)
    head = np.array(pose_of(seen).bones[bone].head, dtype=np.float64)
    return _through(_matrix_of(target, graph), head)


def to_world(ob: bpy.types.Object, local: Array) -> Array:
    """Return points of an object's own space in the world, shape (..., 3)."""
    return _through(np.array(ob.matrix_world, dtype=np.float64), local)


def _through(matrix: Array, local: Array) -> Array:
    return local @ matrix[:3, :3].T + matrix[:3, 3]


def to_character(member: Member, frame: Array, world: Array) -> Array:
    """Return a point of the world in the frame of a character, shape (3,).

    Args:
        member: The character.
        frame: The matrix of its object, which it goes with, shape (4, 4).
        world: The point [m], shape (3,).
    """
    inverse = _inverse(frame.astype(np.float64).tobytes())
    return member.character.local_to_character.points(inverse[:3, :3] @ world + inverse[:3, 3])


@lru_cache(maxsize=64)
def _inverse(matrix: bytes) -> Array:
    """Return the inverse of a matrix; those of objects that stand still are asked for again and again."""
    return np.linalg.inv(np.frombuffer(matrix, dtype=np.float64).reshape(4, 4)).astype(np.float64)


def _matrix_of(ob: bpy.types.Object, graph: bpy.types.Depsgraph) -> Array:
    """Return where an object is in the world, shape (4, 4).

    One that Blender does not evaluate, being hidden or in no collection of the view layer, is where it was put.
    """
    seen = _evaluated(ob, graph)
    if seen is not None:
        return np.array(seen.matrix_world, dtype=np.float64)
    own = np.array(ob.matrix_basis, dtype=np.float64)
    if ob.parent is None:
        return own
    return _matrix_of(ob.parent, graph) @ np.array(ob.matrix_parent_inverse, dtype=np.float64) @ own


def _evaluated(ob: bpy.types.Object, graph: bpy.types.Depsgraph) -> bpy.types.Object | None:
    """Return an object as Blender has evaluated it, None if it has not."""
    layer = graph.view_layer_eval
    seen = layer.objects.get(ob.name) if layer is not None else None
    return seen if seen is not None and seen.original == ob else None
