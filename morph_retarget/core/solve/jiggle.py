"""Jiggles: passive, highly damped secondary motion of what hangs on a body (Hecker 2008 §4.4).

The tip of each bone follows the place where the bone is carried through two exact dampers, like a mass on a damped
spring that feels accelerations alone: what moves evenly drags nothing behind it. The rate of the dampers is constant,
so the lag of any frame is a sum over the carrier's steps before it, and all frames are found at once: in closed form
for a carrier that moves evenly between frames, stable at any step. Nothing is fed back to what carries.

This is the only step with history. A frame depends on the frames from the first up to it and on nothing else.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from .. import quat
from ..arrays import Array, Flags, Indices
from ..skeleton import Pose
from ..tree import Tree
from .jiggle_chains import NONE, Chains

QUICKEST = 1e-3
"""Half-lives are at least this [s]: below, nothing would be left of the lag within a frame."""
FADED = 2.0**-60
"""A share that a sum in double precision does not notice."""
JUMP_SIZE = 0.5
"""What carries a sub-tree jumps if its step changes by more than this share of the character's size …"""
JUMP_SPEED = 15.0
"""… and by more than what this speed makes of it [sizes/s], or if it turns …"""
JUMP_TURN = 2.0
"""… by more than this from one frame to the next, and more than twice as far as before [rad]."""

_Columns = Indices | slice
"""Some of the bones, or all."""


@dataclass(frozen=True, eq=False)
class Surroundings:
    """What a character is in, in the space of its motion."""

    size: float
    """Of the character [armature units]."""
    up: Array
    """Unit vector, shape (3,)."""
    floor: float | None = None
    """Height along ``up`` that tips do not sink below, None where there is none."""


def simulate(
    chains: Chains, gravity: float, carried: Pose, step: float, around: Surroundings, period: int | None = None
) -> Array:
    """Return how far each bone turns from where it is carried, same space, shape (frame, n, 4).

    Args:
        chains: What jiggles.
        gravity: Share of their length by which parts hang lower when they are tilted off their rest.
        carried: The jiggling bones as they move with the body without jiggling, in a space that does not move with the
            character, armature units.
        step: Time between frames [s].
        around: What is around the character.
        period: Frames after which the clip repeats itself, None where it does not.
    """
    ways = quat.rotate(carried.rotations, chains.tips)
    sag = _sag(chains, gravity, carried, around.up)
    places = carried.positions + ways if sag is None else carried.positions + ways + sag
    shift = np.empty_like(places)
    for columns, (start, end) in _runs(chains, carried, step, around.size):
        whole = period if (start, end) == (0, len(places)) else None
        shift[start:end, columns] = _lag(chains, places[start:end, columns], columns, step, whole)
    shift *= -chains.share[:, None]
    if sag is not None:
        shift += sag
    below = np.flatnonzero(chains.above != NONE)
    bent = ways + shift
    bent[:, below] -= shift[:, chains.above[below]]
    turns = _swing(ways, bent, chains.amount, chains.limit)
    return turns if around.floor is None else _above_ground(chains, carried, ways, turns, around.up, around.floor)


# --- the dampers ---


def damped(moves: Array, keep: Array, gain: Array, start: Array) -> Array:
    """Return what follows from ``y[i + 1] = keep * y[i] + gain * moves[i]``, shape (frame + 1, ...).

    Sums over longer and longer spans, each twice the last, take the place of a loop over frames; what comes later
    does not change what came before by a bit.
    """
    out = np.concatenate([start[None], gain * moves])
    span = 1
    # What has faded below the last bit is not added.
    while span < len(out) and (keep**span).max(initial=0.0) > FADED:
        out[span:] += keep**span * out[:-span]
        span *= 2
    return out


def _lag(chains: Chains, places: Array, columns: _Columns, step: float, period: int | None) -> Array:
    """Return how far tips are behind the places where they are carried, shape (frame, column, 3).

    A more than critically damped spring is the difference of two dampers: with rates a and b,
    x'' + (a + b) x' + a b x = p'' has the solution x = (y_b - y_a) / (b - a), where y' + rate y = rate p'.
    """
    # Bones near the body come back sooner, so that the movement runs outward along a tail.
    half_life = np.maximum(chains.half_life[columns] * (0.4 + 0.6 * chains.share[columns]), QUICKEST)
    slow = np.repeat(np.log(2.0) / half_life, 3)
    quick = slow * np.repeat(np.maximum(chains.stiffness[columns], 1.05), 3)
    moves = np.diff(places.reshape(len(places), -1), axis=0)  # rows as long as they get: twice as fast
    behind = _follow(moves, quick, step, period)
    behind -= _follow(moves, slow, step, period)
    behind /= quick - slow
    return behind.reshape(places.shape)


def _follow(moves: Array, rate: Array, step: float, period: int | None) -> Array:
    """Return one damper's speed, which follows that of what it hangs on, shape (frame, value)."""
    keep, lost = np.exp(-rate * step), -np.expm1(-rate * step)
    if period is None or not 0 < period <= len(moves):
        # It has moved like this for long: a clip that begins in mid-stride begins without a jerk.
        return damped(moves, keep, lost / step, moves[0] / step if len(moves) else np.zeros(len(rate)))
    once = damped(moves[:period], keep, lost / step, np.zeros(len(rate)))[-1]
    return damped(moves, keep, lost / step, once / -np.expm1(-rate * step * period))


def _sag(chains: Chains, gravity: float, carried: Pose, up: Array) -> Array | None:
    """Return how much lower tips hang than at rest, shape (frame, n, 3), None without gravity.

    The rest pose is what gravity has made of it already; only its turning away from rest counts.
    """
    if gravity == 0.0:
        return None
    # All of a sub-tree is carried as its first bone is.
    starts, place = np.unique(chains.top, return_inverse=True)
    turned = quat.rotate(quat.multiply(carried.rotations[:, starts], quat.conjugate(chains.rest[starts])), up)
    return (gravity * chains.length * chains.share)[:, None] * (turned - up)[:, place]


# --- jumps ---


def _runs(chains: Chains, carried: Pose, step: float, size: float) -> Iterator[tuple[_Columns, tuple[int, int]]]:
    """Yield runs of frames over which what carries some bones does not jump: the bones, first frame and end."""
    starts = np.flatnonzero(chains.above == NONE)
    jumps = _jumps(Pose(carried.rotations[:, starts], carried.positions[:, starts]), step, size)
    together: dict[tuple[int, ...], list[int]] = {}
    for i, top in enumerate(starts.tolist()):
        together.setdefault(tuple(np.flatnonzero(jumps[:, i]).tolist()), []).append(top)
    for at, some in together.items():
        columns = slice(None) if len(together) == 1 else np.flatnonzero(np.isin(chains.top, some))
        ends = [0, *(frame + 1 for frame in at), len(carried)]
        for start, end in pairwise(ends):
            yield columns, (start, end)


def _jumps(carried: Pose, step: float, size: float) -> Flags:
    """Return whether what carries sub-trees jumps between a frame and the next, shape (frame - 1, sub-tree)."""
    moves = np.diff(carried.positions, axis=0)
    change = quat.length(np.diff(moves, axis=0, prepend=moves[:1]))
    turn = 2.0 * np.arccos(np.clip(np.abs(quat.dot(carried.rotations[1:], carried.rotations[:-1])), 0.0, 1.0))
    before = np.concatenate([turn[:1], turn[:-1]])
    far = change > size * max(JUMP_SIZE, JUMP_SPEED * step)
    return far | ((turn > JUMP_TURN) & (turn > 2.0 * before))


# --- directions ---


def _swing(ways: Array, bent: Array, amount: Array, limit: Array) -> Array:
    """Return the smallest turns of directions toward others, softly limited, shape (frame, n, 4)."""
    axis = quat.cross(ways, bent)
    sine = quat.length(axis)
    if (opposite := (sine == 0.0) & (quat.dot(ways, bent) < 0.0)).any():
        axis[opposite] = quat.cross(ways, np.roll(ways, 1, axis=-1) * np.array([1.0, -1.0, 1.0]))[opposite]
        sine = quat.length(axis)
    angle = np.arctan2(sine, quat.dot(ways, bent))
    half = 0.5 * limit * np.tanh(amount * angle / limit)
    out = np.empty((*sine.shape, 4))
    out[..., 0] = np.cos(half)
    out[..., 1:] = axis * (np.sin(half) / np.maximum(sine, np.finfo(np.float64).tiny))[..., None]
    return out


def _above_ground(chains: Chains, carried: Pose, ways: Array, turns: Array, up: Array, floor: float) -> Array:
    """Return turns that keep tips above the ground, or as high as the body carries them where that is lower."""
    out, heads, length = turns.copy(), carried.positions.copy(), quat.length(ways)
    lowest = np.minimum(floor, quat.dot(carried.positions + ways, up))
    for some in Tree(chains.above).levels:
        above = chains.above[some]
        if above[0] != NONE:
            away = carried.positions[:, some] - carried.positions[:, above]
            heads[:, some] = heads[:, above] + quat.rotate(out[:, above], away)
        way = quat.rotate(turns[:, some], ways[:, some])
        rise = quat.dot(way, up)
        wanted = np.minimum(lowest[:, some] - quat.dot(heads[:, some], up), length[:, some])
        low = wanted > rise
        if low.any():
            raised = _at_height(way[low], np.maximum(wanted[low], -length[:, some][low]), length[:, some][low], up)
            frame, column = np.nonzero(low)
            lift = quat.between(way[low], raised)
            out[frame, some[column]] = quat.multiply(lift, turns[frame, some[column]])
    return out


def _at_height(ways: Array, heights: Array, length: Array, up: Array) -> Array:
    """Return ways with the same heading that rise to some heights, shape (n, 3)."""
    flat = quat.unit(ways - quat.dot(ways, up)[:, None] * up)
    return np.sqrt(np.maximum(length**2 - heights**2, 0.0))[:, None] * flat + heights[:, None] * up


def basis_changes(chains: Chains, carried: Pose, turns: Array) -> Array:
    """Return what follows the basis rotation of each jiggling bone, in the bone's own frame, shape (frame, n, 4).

    Args:
        chains: What jiggles.
        carried: The bones as they are carried, see `simulate`.
        turns: How far each turns from there, same space, shape (frame, n, 4).
    """
    out = turns.copy()
    below = np.flatnonzero(chains.above != NONE)
    out[:, below] = quat.multiply(quat.conjugate(turns[:, chains.above[below]]), turns[:, below])
    out[..., 1:] = quat.rotate(quat.conjugate(carried.rotations), out[..., 1:])
    return out
