"""The limit phase: limbs whose joints have been turned beyond their limits come back, and meet their goals if they can.

It starts from what the limb phase has found for the very frame, so a pose depends on the goals of its frame alone.
Joints beyond their limits are brought back; then damped Gauss-Newton steps take the end to where it was. Unknown are
the swings and twists themselves, so that keeping a joint within its limits is to take the nearest point of a range. A
step that would leave the range goes up to its edge, and the other joints make up for what is missing.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import cast

import numpy as np

from .. import quat, rotation
from ..arrays import Array, Flags, Indices
from . import limits as limiting
from .limits import TWIST, JointLimits, X, Z

STEPS = 24
"""Most steps; a few are enough for what can be reached."""
DAMPING = 1.0
"""Of the steps, as a share of a limb's length, while an error is as large; it falls with the error."""
MET = 1e-6
"""Share of a limb's length by which its end may be missed."""
STRIDE = 0.5
"""Most that a joint turns in a step [rad]."""
WIDEST = 0.995
"""Largest swing that a step leads to, as the sine of half its angle: at 1 the twist would mean nothing."""


@dataclass(frozen=True, eq=False)
class Limited:
    """The limits of single bodies, for those that are turned by themselves."""

    limits: Mapping[int, JointLimits]
    """Of each body that has any, shapes (3,)."""
    axes: Mapping[int, Array]
    """Their rest axes in the character frame (mirrored if the armature is), shapes (3, 3)."""

    @classmethod
    def of(cls, limits: JointLimits, axes: Array, bodies: Sequence[int]) -> "Limited | None":
        """Return the limits of some bodies, None when they have none.

        Args:
            limits: Of all bodies, shapes (body, 3).
            axes: Rest axes of all bodies, shape (body, 3, 3).
            bodies: Those that are asked for.
        """
        own = [body for body in bodies if limits.limited[body]]
        return cls({b: limits[b] for b in own}, {b: axes[b] for b in own}) if own else None

    def held(self, body: int, above: Array, turned: Array) -> Array:
        """Return how a body is turned within its limits.

        Args:
            body: Which one.
            above: How what carries it is turned, shape (frame or 1, 3, 3).
            turned: How it is turned, the same shape.
        """
        if body not in self.limits:
            return turned
        frame, limits = rotation.transposed(above) @ turned, self.limits[body]
        axes = self.axes[body]
        own = quat.from_matrix(axes.T @ frame @ axes)
        near, beyond = limits.brought_back(limiting.swing_and_twist(own))
        if not beyond.any():
            return turned
        back = above @ axes @ quat.to_matrix(limiting.turned(near)) @ axes.T
        return np.where(beyond[:, None, None], back, turned)


@dataclass(frozen=True, eq=False)
class LimitedLimbs:
    """The limits of limbs that are solved together, as `Limbs` has their joints: shorter ones start with none."""

    limits: JointLimits
    """Shapes (limb, joint, 3)."""
    axes: Array
    """Rest axes of the joints' bones in the character frame, shape (limb, joint, 3, 3)."""
    segments: Array
    """From each joint to the next, the last one to the end, at rest [m], shape (limb, joint, 3)."""
    there: Flags
    """Whether there is a joint, shape (limb, joint)."""

    @classmethod
    def of(
        cls, limits: JointLimits, axes: Array, joints: Sequence[Sequence[int]], segments: Array
    ) -> "LimitedLimbs | None":
        """Return the limits of limbs, None when they have none; arguments as in `Limited`, and the limbs' joints."""
        if not any(limits.limited[list(own)].any() for own in joints):
            return None
        shape = segments.shape[:2]
        least, most = np.full((*shape, 3), -np.inf), np.full((*shape, 3), np.inf)
        own_axes, there = np.tile(np.eye(3), (*shape, 1, 1)), np.zeros(shape, dtype=bool)
        for i, own in enumerate(joints):
            place, bones = (i, slice(shape[1] - len(own), None)), list(own)
            least[place], most[place] = limits.least[bones], limits.most[bones]
            own_axes[place], there[place] = axes[bones], True
        return cls(JointLimits(least, most), own_axes, segments, there)

    @cached_property
    def full(self) -> Array:
        """Length of the stretched limbs [m], shape (limb,)."""
        return np.maximum(quat.length(self.segments).sum(axis=-1), 1e-12)

    @cached_property
    def hands(self) -> Array:
        """-1 where axes are left-handed, else 1, shape (limb, joint)."""
        return np.sign(np.linalg.det(self.axes))

    def take(self, limbs: Indices) -> "LimitedLimbs":
        """Return some of the limbs, some of them more than once."""
        return LimitedLimbs(self.limits[limbs], self.axes[limbs], self.segments[limbs], self.there[limbs])


def hold(limbs: LimitedLimbs, carried: Array, turned: Array, factors: Array | None = None) -> Array:
    """Return how the joints of limbs are turned within their limits, their ends where they were if these allow it.

    Limbs within their limits stay as they are to the bit.

    Args:
        limbs: The limbs and their limits.
        carried: How what carries each limb is turned, shape (frame, limb, 3, 3).
        turned: How the joints are turned, shape (frame, limb, joint, 3, 3).
        factors: By what factors bones are longer than at rest, shape (frame, limb, joint), None where none is.
    """
    carrier = carried[:, :, None]
    own = np.where(limbs.there[..., None, None], rotation.transposed(carrier) @ turned, rotation.IDENTITY)
    turns = quat.from_matrix(rotation.transposed(limbs.axes) @ _against_above(own) @ limbs.axes)
    told = limiting.swing_and_twist(turns)
    beyond = np.any(limbs.limits.beyond(told) & limbs.there, axis=-1)
    frames, places = np.nonzero(beyond)
    if not len(frames):
        return turned
    chosen = limbs.take(places)
    if factors is not None:
        chosen = replace(chosen, segments=factors[frames, places][..., None] * chosen.segments)
    ends = rotation.apply(own[frames, places], chosen.segments).sum(axis=-2)
    solved = _solved(chosen, turns[frames, places], ends)
    out = turned.copy()
    out[frames, places] = np.where(
        chosen.there[..., None, None], carrier[frames, places] @ solved, turned[frames, places]
    )
    return out


def _against_above(own: Array) -> Array:
    """Return how joints are turned against those above them, shape (..., joint, 3, 3)."""
    out = own.copy()
    out[..., 1:, :, :] = rotation.transposed(own[..., :-1, :, :]) @ own[..., 1:, :, :]
    return out


def _solved(limbs: LimitedLimbs, turns: Array, goals: Array) -> Array:
    """Return how joints are turned from what carries each limb, shape (limb, joint, 3, 3); each limb has its frame.

    Args:
        limbs: The limbs.
        turns: Of the joints, in their own rest axes, shape (limb, joint, 4).
        goals: Of the ends, from where the limbs start, in the frames of what carries them [m], shape (limb, 3).
    """
    turns = np.where(limbs.there[..., None], limbs.limits.clamped(turns), quat.IDENTITY)
    told = limbs.limits.nearest(limiting.swing_and_twist(turns))
    out = np.empty((*turns.shape[:2], 3, 3))
    left = np.arange(len(turns))
    for step in range(STEPS + 1):
        rests = _rest_frames(limbs, quat.to_matrix(turns))
        out[left] = rests.turned
        error = goals - rotation.apply(rests.turned, limbs.segments).sum(axis=-2)
        open_ = quat.length(error) > MET * limbs.full
        if step == STEPS or not open_.any():
            break
        if not open_.all():
            left, limbs, turns, told = left[open_], limbs.take(np.flatnonzero(open_)), turns[open_], told[open_]
            error, goals, rests = error[open_], goals[open_], rests.take(open_)
        turns, told = _stepped(limbs, rests, turns, told, error)
    return out


@dataclass(frozen=True, eq=False)
class _Frames:
    """Where limbs are in a step."""

    turned: Array
    """How joints are turned from what carries the limb, shape (limb, joint, 3, 3)."""
    above: Array
    """Where the joints' rest axes are carried by the joints above them, shape (limb, joint, 3, 3)."""

    def take(self, chosen: Flags) -> "_Frames":
        return _Frames(self.turned[chosen], self.above[chosen])


def _rest_frames(limbs: LimitedLimbs, turns: Array) -> _Frames:
    own = limbs.axes @ turns @ rotation.transposed(limbs.axes)
    turned, above = np.empty_like(own), np.empty_like(own)
    carried = np.broadcast_to(rotation.IDENTITY, own[:, 0].shape)
    for i in range(own.shape[1]):
        above[:, i] = carried @ limbs.axes[:, i]
        carried = turned[:, i] = carried @ own[:, i]
    return _Frames(turned, above)


def _stepped(limbs: LimitedLimbs, now: _Frames, turns: Array, told: Array, error: Array) -> tuple[Array, Array]:
    """Return rotations and what they are told as, a step nearer to the goals."""
    levers = np.cumsum(rotation.apply(now.turned, limbs.segments)[:, ::-1], axis=1)[:, ::-1]
    free = ~limbs.limits.limited
    ways = np.where(free[..., None, None], rotation.IDENTITY, _ways(told))
    spins = limbs.hands[..., None, None] * (now.above @ ways)
    # Where the end goes as each joint turns in each of its ways, shape (limb, joint, way, 3).
    moves = quat.cross(rotation.transposed(spins), np.broadcast_to(levers[:, :, None], spins.shape))
    moves *= limbs.there[..., None, None]
    step = _damped(limbs, moves, error)
    wanted = np.where(free[..., None], 0.0, step) * _SIZES
    edge = limbs.limits.nearest(told + wanted)
    swing, twist = _normals(told + wanted - edge)
    if swing.any() or twist.any():
        # Beyond an edge, a joint goes up to it and no further; along it, and of the other joints, all is free.
        wanted = (edge - told) / _SIZES
        fixed = quat.dot(swing, wanted)[..., None] * swing + quat.dot(twist, wanted)[..., None] * twist
        allowed = rotation.IDENTITY - _outer(swing) - _outer(twist)
        rest = error - np.einsum("njw,njwx->nx", fixed, moves)
        step = fixed + rotation.apply(allowed, _damped(limbs, allowed @ moves, rest))
    step = step * (STRIDE / np.maximum(quat.length(step).max(axis=-1), STRIDE))[:, None, None]
    told = _narrowed(limbs.limits.nearest(told + step * _SIZES), told)
    spun = quat.multiply(quat.from_rotation_vector(step), turns)
    return quat.normalize(np.where(free[..., None], spun, limiting.turned(told))), told


_SIZES: Array = np.array([0.5, 1.0, 0.5])
"""Swings and twists for each radian by which a joint turns."""


def _ways(told: Array) -> Array:
    """Return the axes about which bones turn as swings and twists change, in columns, shape (..., 3, 3)."""
    x, z = told[..., X], told[..., Z]
    w = np.sqrt(np.maximum(1.0 - x * x - z * z, 1.0 - WIDEST * WIDEST))
    out = np.empty((*told.shape, 3))
    out[..., X] = np.stack([x * x / w + w, z, x * z / w], axis=-1)
    out[..., Z] = np.stack([x * z / w, -x, z * z / w + w], axis=-1)
    # The bone's own direction, swung.
    out[..., TWIST] = np.stack([-2.0 * w * z, 1.0 - 2.0 * (x * x + z * z), 2.0 * w * x], axis=-1)
    return out


def _normals(over: Array) -> tuple[Array, Array]:
    """Return unit vectors square to the edges that swings and twists have crossed, 0 where they have not."""
    swing, twist = over.copy(), np.zeros_like(over)
    swing[..., TWIST] = 0.0
    swing = np.where(quat.length(swing)[..., None] > limiting.EXACT, quat.unit(swing), 0.0)
    twist[..., TWIST] = np.abs(over[..., TWIST]) > limiting.EXACT
    return swing, twist


def _outer(normals: Array) -> Array:
    return normals[..., :, None] * normals[..., None, :]


def _damped(limbs: LimitedLimbs, moves: Array, error: Array) -> Array:
    """Return the smallest turns that take the ends by a way, less where they would be large, (limb, joint, way)."""
    square = DAMPING * limbs.full * quat.length(error)
    rows = moves.reshape(len(moves), -1, 3)
    matrix = rotation.transposed(rows) @ rows + square[:, None, None] * rotation.IDENTITY
    pulls = cast("Array", np.linalg.solve(matrix, error[..., None]))[..., 0]
    return rotation.apply(moves, pulls[:, None])


def _narrowed(told: Array, before: Array) -> Array:
    """Return swings that are not wider than any should become."""
    size = np.hypot(told[..., X], told[..., Z])
    most = np.maximum(np.hypot(before[..., X], before[..., Z]), WIDEST)
    scale = np.minimum(1.0, most / np.maximum(size, most))
    out = told.copy()
    out[..., X] *= scale
    out[..., Z] *= scale
    return out
