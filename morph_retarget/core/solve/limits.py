"""Joint limits: how far bones may turn from rest, with the meaning that Blender's inverse kinematics give them.

A rotation from rest, in the bone's own rest axes and against its parent, is a twist about the bone (Y) and after it a
*swing*, whose axis lies in the plane of X and Z. The swing is told by its axis times the sine of half its angle. Limits
of X and Z are the half axes of an oval in that plane, made of four quarters of ellipses; with one of the two limited it
is a strip. Rest is always within.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .. import quat
from ..arrays import Array, Flags, Indices

X, TWIST, Z = range(3)
STEPS = 12
"""Of Newton's method for the nearest point of an oval; a few are enough for all but ovals as thin as a line."""
EXACT = 1e-9
"""Share of a limit by which it may be exceeded: what has been brought back stays as it is."""
_TINY = 1e-12


@dataclass(frozen=True, eq=False)
class JointLimits:
    """How far some bones turn about their own rest axes, at least and at most; the axes are X, Y and Z."""

    least: Array
    """[rad], -pi to 0, -inf where nothing limits; shape (..., 3)."""
    most: Array
    """[rad], 0 to pi, inf where nothing limits, and 0 like the least of an axis that is locked; shape (..., 3)."""

    @classmethod
    def of(cls, limited: Flags, locked: Flags, least: Array, most: Array) -> "JointLimits":
        """Return limits from what an animator sets, shapes (..., 3).

        Args:
            limited: Whether the range of an axis counts.
            locked: Whether a bone does not turn about an axis at all.
            least: [rad]; above 0 counts as 0.
            most: [rad]; below 0 counts as 0.
        """
        low = np.where(limited, np.clip(least, -np.pi, 0.0), -np.inf)
        high = np.where(limited, np.clip(most, 0.0, np.pi), np.inf)
        return cls(np.where(locked, 0.0, low), np.where(locked, 0.0, high))

    @classmethod
    def free(cls, *shape: int) -> "JointLimits":
        """Return limits of bones that turn as they like."""
        return cls(np.full((*shape, 3), -np.inf), np.full((*shape, 3), np.inf))

    def __getitem__(self, chosen: Indices | int) -> "JointLimits":
        return JointLimits(self.least[chosen], self.most[chosen])

    @cached_property
    def limited(self) -> Flags:
        """Whether anything limits each bone, shape (...)."""
        either: Flags = np.isfinite(self.least) | np.isfinite(self.most)
        return either[..., X] | either[..., TWIST] | either[..., Z]

    @cached_property
    def low(self) -> Array:
        """The least as swings and twists are told, shape (..., 3)."""
        return _told(self.least)

    @cached_property
    def high(self) -> Array:
        """The same of the most."""
        return _told(self.most)

    @cached_property
    def _oval(self) -> Flags:
        """Whether both axes of the swing are limited, shape (...)."""
        both: Flags = np.isfinite(self.low) & np.isfinite(self.high)
        return both[..., X] & both[..., Z]

    def nearest(self, told: Array) -> Array:
        """Return the swings and twists within the limits that are nearest to some, shape (..., 3).

        Blender scales swings toward rest instead. The nearest ones of an oval are never farther from each other than
        what they were found for, even where it is as thin as that of a hinge.
        """
        out = np.minimum(np.maximum(told, self.low), self.high)
        swing = told[..., (X, Z)]
        if not self._oval.any() or not swing.size:
            return out
        ways = np.where(swing > 0.0, self.high[..., (X, Z)], -self.low[..., (X, Z)])
        axes = np.maximum(np.where(self._oval[..., None], ways, 1.0), EXACT)
        beyond = self._oval & (((swing / axes) ** 2).sum(axis=-1) > 1.0 + EXACT)
        # A hinge's limits are exact already.
        beyond &= (ways > 0.0).all(axis=-1)
        if beyond.any():
            on_oval = _nearest_of_ellipse(swing, axes)
            out[..., (X, Z)] = np.where(beyond[..., None], on_oval, out[..., (X, Z)])
        return out

    def beyond(self, told: Array) -> Flags:
        """Return whether swings and twists are beyond the limits, shape (...)."""
        return self.brought_back(told)[1]

    def brought_back(self, told: Array) -> tuple[Array, Flags]:
        """Return the nearest swings and twists within the limits, and whether these are others."""
        near = self.nearest(told)
        over: Flags = np.abs(near - told) > EXACT
        return near, over[..., X] | over[..., TWIST] | over[..., Z]

    def clamped(self, turns: Array) -> Array:
        """Return the rotations within the limits that are nearest; what is within them stays as it is to the bit.

        Args:
            turns: From rest, in the bones' own rest axes and against their parents, shape (..., 4).
        """
        near, beyond = self.brought_back(swing_and_twist(turns))
        return np.where(beyond[..., None], turned(near), turns)


def swing_and_twist(turns: Array) -> Array:
    """Return rotations as the swing's X, the twist [rad] and the swing's Z, shape (..., 4) to (..., 3)."""
    turns = np.where(turns[..., :1] < 0.0, -turns, turns)
    w, x, y, z = (turns[..., i] for i in range(4))
    size = np.hypot(w, y)
    # What swings by half a turn has no twist of its own.
    plain = size < _TINY
    safe = np.where(plain, 1.0, size)
    cosine, sine = np.where(plain, 1.0, w / safe), np.where(plain, 0.0, y / safe)
    return np.stack([x * cosine + z * sine, 2.0 * np.arctan2(sine, cosine), z * cosine - x * sine], axis=-1)


def turned(told: Array) -> Array:
    """Return the rotations of swings and twists, shape (..., 3) to (..., 4)."""
    x, twist, z = (told[..., i] for i in range(3))
    w = np.sqrt(np.maximum(1.0 - x * x - z * z, 0.0))
    cosine, sine = np.cos(0.5 * twist), np.sin(0.5 * twist)
    return quat.normalize(np.stack([w * cosine, x * cosine - z * sine, w * sine, z * cosine + x * sine], axis=-1))


def _told(angles: Array) -> Array:
    """Return limits as swings and twists are told."""
    out = angles.copy()
    swing = np.isfinite(angles) & np.array([True, False, True])
    out[swing] = np.sin(0.5 * angles[swing])
    return out


def _nearest_of_ellipse(points: Array, axes: Array) -> Array:
    """Return the points of ellipses that are nearest to points outside, both shapes (..., 2).

    The way to the nearest point is square to the ellipse, which leaves one unknown, how long it is. Newton's method
    comes to it from below: the function is convex and falls.
    """
    scaled, squares = axes * np.abs(points), axes * axes
    way = np.maximum((scaled - squares).max(axis=-1, keepdims=True), 0.0)
    for _ in range(STEPS):
        shares = scaled / (way + squares)
        excess = (shares * shares).sum(axis=-1, keepdims=True) - 1.0
        slope = 2.0 * (shares * shares / (way + squares)).sum(axis=-1, keepdims=True)
        way = way + np.maximum(excess, 0.0) / np.maximum(slope, _TINY)
    found = squares * points / (way + squares)
    return found / np.maximum(quat.length(found / axes), 1.0)[..., None]
