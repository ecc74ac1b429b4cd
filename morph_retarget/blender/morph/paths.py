"""The motion path of a channel: where it brings the active body of a character, and its target (Hecker 2008, figure 2).

What is found is kept until curves, definitions, targets or the active body change. Run-time state.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import bpy
import numpy as np

from ...core import play, quat
from ...core.arrays import Array
from ...core.layering import Layer
from ...core.morph import movement
from ...core.morph.bind import NONE
from ...core.morph.specialize import frames_of
from ..locomotion import walks
from ..properties import of_rig
from . import keys, perform, query, stage
from .member import Member
from .properties import of_action

MOST = 600
"""Longer ranges are drawn in so many steps."""


@dataclass(frozen=True, eq=False)
class MotionPath:
    """What is to be seen of a channel, in the armature object's own space."""

    line: Array
    """Where the body is over the scene's frames, shape (frame, 3)."""
    keyed: Array
    """Where it is at the times of the keys, shape (key, 3)."""
    target: Array | None
    """Where its target is at the present frame, shape (3,), None without one."""
    size: float
    """Diagonal of the character's bounds."""


_known: dict[int, tuple[tuple[object, ...], Array]] = {}


def entry_shown(member: Member, ob: bpy.types.Object) -> int | None:
    """Return which entry of a binding is drawn: the active channel's on the active body, None without one."""
    channel = of_action(member.action).active_channel
    own = [i for i, e in enumerate(member.part.binding.entries) if e.channel == channel and e.position]
    if not own:
        return None
    bone = ob.data.bones.active if isinstance(ob.data, bpy.types.Armature) else None
    wanted = [bone.name] if bone is not None and ob.mode == "POSE" else []
    wanted.append(of_rig(ob).channels[member.definition.channels[channel].name].active_body)
    bodies = {member.bodies.names[member.part.binding.entries[i].body]: i for i in reversed(own)}
    return next((bodies[name] for name in wanted if name in bodies), own[0])


def path_points(
    member: Member, ob: bpy.types.Object, entry: int, frames: Array, external: Mapping[int, Array]
) -> Array:
    """Return where an entry of a character's binding brings its body [m], world space, shape (frame, 3).

    Args:
        member: How the armature plays its action.
        ob: The armature, where it is now.
        entry: Of the binding.
        frames: Frames, shape (frame,).
        external: Targets of the channels that have external ones, from `stage.targets_of`.
    """
    return stage.to_world(ob, _points(member, ob, entry, frames, external))


def _points(
    member: Member,
    ob: bpy.types.Object,
    entry: int,
    frames: Array,
    external: Mapping[int, Array],
    lower: Layer | None = None,
) -> Array:
    """Return the same in the armature object's own space, for a character that goes as ``lower`` says."""
    external = external if lower is None else lower.seen(external)
    values = stage.values_over(member, ob, frames)
    whole = member.part.binding
    binding, posed = replace(whole, entries=(whole.entries[entry],)), _posed(member, ob, frames, external)
    found = frames_of(binding, external, posed)
    channel = binding.plan.channel
    places, _ = movement.specialize(found, values.positions[:, channel], values.rotations[:, channel])
    way = places[:, 0] if lower is None else quat.rotate(lower.turns, places[:, 0]) + lower.places
    return member.character.local_to_character.inverse().points(way)


def _posed(member: Member, ob: bpy.types.Object, frames: Array, external: Mapping[int, Array]) -> Array | None:
    """Return where bodies that others follow are, shape (frame, body, 3), None where none are followed."""
    first = member.part.first
    if first is None:
        return None
    return play.evaluate(first, stage.values_over(member, ob, frames), external).pose.positions


def path_of(ob: bpy.types.Object, scene: bpy.types.Scene, graph: bpy.types.Depsgraph) -> MotionPath | None:
    """Return what is to be seen of the active channel on a character, None when nothing is.

    Raises:
        MorphError: The target cannot be read.
    """
    member = query.member_now(ob)
    entry = entry_shown(member, ob) if member is not None else None
    if member is None or entry is None:
        return None
    external = stage.targets_of(member, ob, graph)
    frames, times = frames_of_scene(scene), _key_times(member, entry)
    way = walks.number(member, scene, graph)
    state = (member, entry, frames.tobytes(), way, *_traces(member, ob, entry), *_places(external))
    known = _known.get(ob.session_uid)
    if known is None or known[0] != state:
        both = np.concatenate([frames, times])
        points = _points(member, ob, entry, both, external, walks.over(member, scene, graph, both))
        known = _known[ob.session_uid] = (state, points)
    line, keyed = known[1][: len(frames)], known[1][len(frames) :]
    size = member.bodies.size / member.character.local_to_character.scale
    return MotionPath(line, keyed, _target(member, ob, entry, external), size)


def forget() -> None:
    """Drop all that is known."""
    _known.clear()


def frames_of_scene(scene: bpy.types.Scene) -> Array:
    """Return the frames that a path is drawn for: those that the scene plays, fewer where they are very many."""
    first, last = scene.frame_start, scene.frame_end
    if scene.use_preview_range:
        first, last = scene.frame_preview_start, scene.frame_preview_end
    return np.linspace(first, last, min(last - first + 1, MOST))


def _channels_read(member: Member, entry: int) -> list[str]:
    """Return the channels whose values a path depends on."""
    channels, own = member.definition.channels, member.part.binding.entries[entry]
    return [c.name for i, c in enumerate(channels) if i == own.channel or own.target != NONE]


def _traces(member: Member, ob: bpy.types.Object, entry: int) -> Iterator[bytes]:
    """Yield what curves and unkeyed values look like, to see whether they have changed."""
    found = keys.curves(member.action)
    for name in _channels_read(member, entry):
        for part, default in keys.DEFAULTS.items():
            for i in range(len(default)):
                curve = found.get((keys.path(name, part), i))
                if curve is None:
                    yield np.float64(getattr(of_rig(ob).channels[name], part)[i]).tobytes()
                else:
                    yield _trace(curve)


def _trace(curve: bpy.types.FCurve) -> bytes:
    count = len(curve.keyframe_points)
    parts: list[bytes] = []
    for name in ("co", "handle_left", "handle_right"):
        buffer = np.empty(2 * count, dtype=np.float32)
        curve.keyframe_points.foreach_get(name, buffer)
        parts.append(buffer.tobytes())
    kinds = np.empty(count, dtype=np.uint8)
    curve.keyframe_points.foreach_get("interpolation", kinds)
    if len(curve.modifiers):
        parts.append(np.array([curve.evaluate(7.3 * i) for i in range(24)]).tobytes())
    return b"".join([*parts, kinds.tobytes(), curve.extrapolation.encode()])


def _places(external: Mapping[int, Array]) -> Iterator[bytes]:
    """Yield what targets look like, to see whether they have moved."""
    return (bytes(str(channel), "ascii") + place.tobytes() for channel, place in sorted(external.items()))


def _key_times(member: Member, entry: int) -> Array:
    """Return when positions of a channel are keyed, shape (key,)."""
    name = member.definition.channels[member.part.binding.entries[entry].channel].name
    times: set[float] = set()
    for (path, _), curve in keys.curves(member.action).items():
        if path == keys.path(name, "position"):
            times.update(point.co[0] for point in curve.keyframe_points)
    return np.array(sorted(times))


def _target(member: Member, ob: bpy.types.Object, entry: int, external: Mapping[int, Array]) -> Array | None:
    """Return where the target of an entry is now, in the armature object's own space, shape (3,)."""
    own = member.part.binding.entries[entry]
    if own.target != NONE:
        shown = perform.shown(ob)
        posed = None if shown is None or shown.member is not member else shown.played.followed
        place = member.bodies.positions[own.target] if posed is None else posed[0, own.target]
    elif own.channel in external:
        place = external[own.channel][0]
    else:
        return None
    return member.character.local_to_character.inverse().points(place)
