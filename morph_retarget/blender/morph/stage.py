"""Reading what characters are told at a moment: values of channels and places of targets."""

from collections.abc import Mapping, Sequence

import bpy
import numpy as np

from ...core import play, quat
from ...core.arrays import Array
from ...core.errors import MorphError
from ...core.morph.channels import TargetKind, Values
from .. import actions
from ..actions import CurveMap
from ..properties import of_rig
from ..rig import pose_of
from . import cast, keys
from .cast import Member


def values_of(member: Member, ob: bpy.types.Object) -> Values:
    """Return the values of all channels as they are on an object, original or evaluated; a batch of one frame."""
    items = of_rig(ob).channels
    if any(channel.name not in items for channel in member.definition.channels):
        items = of_rig(member.rig.object).channels  # an evaluated copy may be older than a channel
    count = len(items)
    place = {item.name: i for i, item in enumerate(items)}
    rows = [place[c.name] for c in member.definition.channels]
    positions, rotations = np.empty(count * 3, dtype=np.float32), np.empty(count * 4, dtype=np.float32)
    weights = np.empty(count, dtype=np.float32)
    items.foreach_get("position", positions)
    items.foreach_get("rotation", rotations)
    items.foreach_get("weight", weights)
    deforms = {
        (i, deform.name): np.array([deform.value], dtype=np.float64)
        for i, row in enumerate(rows)
        for deform in items[row].deforms
    }
    return Values(
        positions.astype(np.float64).reshape(1, count, 3)[:, rows],
        quat.normalize(rotations.astype(np.float64).reshape(1, count, 4)[:, rows]),
        weights.astype(np.float64).reshape(1, count)[:, rows],
        deforms,
    )


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


def targets_of(member: Member, ob: bpy.types.Object, graph: bpy.types.Depsgraph) -> Mapping[int, Array]:
    """Return where the external targets of a character are, by channel [m], character frame, shapes (1, 3)."""
    out: dict[int, Array] = {}
    places: dict[tuple[bpy.types.Object, str], Array] = {}
    items, seen = of_rig(ob).channels, ob.evaluated_get(graph)
    for i, channel in enumerate(member.definition.channels):
        if channel.has_target and channel.target is TargetKind.EXTERNAL:
            item = items[channel.name]
            if cast.has_target(item):
                key = (item.target, item.target_bone)
                if key not in places:
                    places[key] = to_character(member, seen, place_of(*key, graph))[None]
                out[i] = places[key]
    return out


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
            pass  # it is told where that character is drawn; here its pose counts as it is
        else:
            played = play.evaluate(other.free, values_of(other, seen), {})
            body = other.rig.skeleton.index[bone]
            local = other.character.local_to_character.inverse().points(played.pose.positions[0, body])
            return _through(_matrix_of(target, graph), local)
    head = np.array(pose_of(seen).bones[bone].head, dtype=np.float64)
    return _through(_matrix_of(target, graph), head)


def to_world(ob: bpy.types.Object, local: Array) -> Array:
    """Return a point of an object's own space in the world, shape (3,)."""
    return _through(np.array(ob.matrix_world, dtype=np.float64), local)


def _through(matrix: Array, local: Array) -> Array:
    return matrix[:3, :3] @ local + matrix[:3, 3]


def to_character(member: Member, ob: bpy.types.Object, world: Array) -> Array:
    """Return a point of the world in the frame of a character, which goes where its object goes, shape (3,)."""
    matrix = np.linalg.inv(np.array(ob.matrix_world, dtype=np.float64))
    return member.character.local_to_character.points(matrix[:3, :3] @ world + matrix[:3, 3])


def _matrix_of(ob: bpy.types.Object, graph: bpy.types.Depsgraph) -> Array:
    """Return where an object is in the world, shape (4, 4).

    One that Blender does not evaluate, being hidden or in no collection of the view layer, is where it was put.
    """
    layer = graph.view_layer_eval
    seen = layer.objects.get(ob.name) if layer is not None else None
    if seen is not None and seen.original == ob:
        return np.array(seen.matrix_world, dtype=np.float64)
    own = np.array(ob.matrix_basis, dtype=np.float64)
    if ob.parent is None:
        return own
    return _matrix_of(ob.parent, graph) @ np.array(ob.matrix_parent_inverse, dtype=np.float64) @ own
