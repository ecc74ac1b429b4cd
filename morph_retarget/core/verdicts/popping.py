"""Whether bones pop: turn in one frame as neither the frames beside it do, nor what they were asked for does.

A fast movement is no pop: it goes on for some frames, each about as fast as its neighbours, and may change its way. It
does not turn back at once, as a flicker does. And a movement that an animator starts suddenly is none: there the goals
move as suddenly, and go on. What keeps its direction while its parent pops, as eyes do that look at something, does not
pop itself.
"""

import numpy as np

from .. import quat
from ..arrays import Array
from .performance import Performance
from .verdict import Found

GOES_ON = 2.0
"""A turn by up to this many times that of a neighbouring frame goes on with it."""
FOLLOWS = 2.0
"""Most that a bone of a limb turns to follow the goal by its limb's length [rad]: that of two equal bones which are
half bent. Where limbs are all but stretched they turn faster, which is what snaps in knees are made of."""


def popped(performance: Performance) -> Found:
    """Return the largest turn of a bone in one frame, beyond those of the frames beside it and its goals' [deg]."""
    own = [int(body) for body in performance.body]
    if len(performance) < 4:
        return Found(0.0)
    on_parents, whole = spikes(_on_parents(performance)[:, own]), spikes(performance.turns[:, own])
    beyond = np.minimum(on_parents, whole) - np.degrees(_asked(performance)[:, own])
    return Found.worst(np.maximum(beyond, 0.0), [performance.names[body] for body in own])


def spikes(turns: Array) -> Array:
    """Return by how much turns from frame to frame stand out among their neighbours [deg], shape (frame, bone).

    Args:
        turns: Of each bone, shape (frame, bone, 4).
    """
    steps = quat.to_rotation_vector(quat.multiply(turns[1:], quat.conjugate(turns[:-1])))
    angles = quat.length(steps)
    # A neighbour counts in full up to a change of way by a right angle, and not at all if it turns back.
    ways = quat.unit(steps)
    onward = np.clip(1.0 + quat.dot(ways[1:], ways[:-1]), 0.0, 1.0)
    beside = np.zeros_like(angles)
    beside[1:] = onward * angles[:-1]
    beside[:-1] = np.maximum(beside[:-1], onward * angles[1:])
    out = np.zeros(turns.shape[:2])
    out[1:] = np.degrees(np.maximum(angles - GOES_ON * beside, 0.0))
    # Nothing is known of the frames beyond the ends.
    out[[1, -1]] = 0.0
    return out


def _on_parents(performance: Performance) -> Array:
    """Return how bones are turned on what carries them, shape (frame, bone, 4)."""
    parents = performance.hierarchy.tree.parents
    out = performance.turns.copy()
    carried = np.flatnonzero(parents >= 0)
    out[:, carried] = quat.multiply(quat.conjugate(performance.turns[:, parents[carried]]), out[:, carried])
    out[:, performance.root] = performance.turns[:, performance.root]
    return out


def _asked(performance: Performance) -> Array:
    """Return by how much bones have to turn from each frame to the next to follow their goals [rad], (frame, bone)."""
    out = np.zeros(performance.turns.shape[:2])
    for aim in performance.aims:
        if not aim.joints:
            continue
        start, (length, _) = aim.joints[0], performance.hierarchy.lengths(aim.joints, aim.body)
        rest = performance.rest[aim.body] - performance.rest[start]
        way = rest + aim.influence[:, None] * (aim.places - performance.places[:, start] - rest)
        turn = _going_on(FOLLOWS * quat.length(np.diff(way, axis=0)) / max(length, 1e-12))
        for body in (*aim.joints, aim.body):
            out[1:, body] = np.maximum(out[1:, body], turn)
    for goal in performance.turned:
        turns = quat.slerp(quat.identity(1), goal.turns, goal.influence)
        turn = _going_on(quat.angle_between(turns[1:], turns[:-1]))
        out[1:, goal.body] = np.maximum(out[1:, goal.body], turn)
    return out


def _going_on(steps: Array) -> Array:
    """Return steps of a goal as far as they go on in the next frame or come from the one before, shape (frame - 1,)."""
    beside = np.zeros_like(steps)
    beside[1:] = steps[:-1]
    beside[:-1] = np.maximum(beside[:-1], steps[1:])
    return np.minimum(steps, GOES_ON * beside)
