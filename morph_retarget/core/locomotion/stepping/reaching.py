"""How far legs reach: what strides they allow, and how low the hips go for a stride."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from ...arrays import Array
from .sizes import Sizes

LONGEST = 0.985
"""A leg is never stretched further than this share of its length, lest the knee snaps."""
EASY = 0.98
"""Hips are lowered for a stride until no leg is stretched further than this share of its length."""
FEWEST = 0.08
"""A stance reaches at least this far to the front and back, however the leg is made [leg lengths]."""
CROUCHES = 0.12
"""Hips may be lowered this far for a long stride [leg lengths]."""
EASES = 0.8
"""How much shorter the way of the ankle is than the body's while a foot stands, as it rolls, to one side [soles]."""
ROLLS = 0.4
"""By what share of its sole a foot stands for longer than its ankle's way, as it rolls over heel and ball."""
NEAREST = 0.5
"""Feet land no nearer to each other than this share of how far they are apart at rest …"""
FARTHEST = 0.3
"""… and never need more room than this [leg lengths]."""
PASSES = 0.5
"""Way of the body between the steps of a left and a right foot [strides]."""


@dataclass(frozen=True, eq=False)
class Reach:
    """The legs of a group, standing."""

    lengths: Array
    """Of the stretched legs [m], shape (leg,)."""
    away: Array
    """From the hips to where the feet are put for long strides, shape (leg, 3)."""
    soles: Array
    """Of the feet [m], shape (leg,)."""

    @classmethod
    def of(cls, sizes: Sizes, legs: list[int]) -> Self:
        """Return that of some legs; a long foot is a part of its leg."""
        ends = np.where(sizes.long[:, None], sizes.tips, 0.0)
        away = sizes.homes + ends - sizes.hips
        away[:, 1] += sizes.centring
        lengths = sizes.lengths - ends[:, 2]
        return cls(lengths[legs], away[legs], sizes.soles[legs])

    def farthest(self, crouch: float) -> float:
        """Return how far all feet may be from where they are put, to the front and back, while they stand [m].

        Args:
            crouch: How much the hips are lowered already [leg lengths].
        """
        low = np.maximum(-self.away[:, 2] - (CROUCHES + crouch) * self.lengths, 0.0)
        flat = np.maximum((EASY * self.lengths) ** 2 - low**2 - self.away[:, 0] ** 2, 0.0)
        far = np.sqrt(flat) - np.abs(self.away[:, 1]) + ROLLS * self.soles
        return float(np.maximum(far, FEWEST * self.lengths).min())

    def farthest_aside(self, crouch: float) -> float:
        """Return the same to both sides [m]."""
        low = np.maximum(-self.away[:, 2] - (CROUCHES + crouch) * self.lengths, 0.0)
        flat = np.maximum((EASY * self.lengths) ** 2 - low**2 - self.away[:, 1] ** 2, 0.0)
        return float(np.maximum(np.sqrt(flat) - np.abs(self.away[:, 0]), FEWEST * self.lengths).min())

    def lowering(self, ahead: Array, aside: Array) -> Array:
        """Return how far the hips go down for strides [m].

        Args:
            ahead: Half of the way that the body goes forward while a foot stands [m], shape (n,).
            aside: Half of that to the side, and how much wider the feet are put for it [m], shape (n,).
        """
        far = np.maximum(ahead[:, None] - EASES * self.soles, 0.0) + np.abs(self.away[:, 1])
        wide = aside[:, None] + np.abs(self.away[:, 0])
        deep = np.sqrt(np.maximum((EASY * self.lengths) ** 2 - far**2 - wide**2, 0.0))
        most = CROUCHES * self.lengths
        return np.clip(-self.away[:, 2] - deep, 0.0, most).max(axis=1)


def room(apart: Array, lengths: Array) -> Array:
    """Return how near feet may come to each other [m], which are so far apart at rest [m], on legs of lengths [m]."""
    return np.minimum(NEAREST * apart, FARTHEST * lengths)


def spread(strides: Array, apart: Array, lengths: Array) -> Array:
    """Return how much further apart left and right feet are put for strides to the side [m].

    While one foot stands the other one passes half a stride, and then lands beside it.

    Args:
        strides: To the side [m].
        apart: How far the feet are apart at rest [m].
        lengths: Of the legs [m].
    """
    return np.maximum(PASSES * strides + room(apart, lengths) - apart, 0.0)
