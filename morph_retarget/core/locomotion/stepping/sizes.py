"""Sizes of all feet of a character, side by side."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ... import quat
from ...arrays import Array, Flags
from ..moving import UP
from .legs import Leg

PAW, SOLE = 0.1, 0.2
"""Lengths of soles that hang like paws, and of those that are held level [leg lengths]."""
CENTRED = 0.8
"""Share of the way to under its hip by which the foot of an upright leg is put for long strides."""
STRETCHED, LYING = 0.9999, 0.5
"""A leg whose foot rests this far from its hip, and less than this below it, is stretched to a side [leg lengths]."""
LONG = 0.25
"""A foot that stands on its end, its joint higher over the ground than this share of its leg, is long."""


@dataclass(frozen=True, eq=False)
class Sizes:
    """Of all feet."""

    lengths: Array
    """Of the legs [m], shape (leg,)."""
    homes: Array
    """Where the feet's joints are at rest [m], shape (leg, 3)."""
    heels: Array
    """From the joint to the heel, of feet turned to walk, shape (leg, 3)."""
    tips: Array
    """From the joint to where the foot rolls off, likewise, shape (leg, 3)."""
    hips: Array
    """Where the legs begin at rest [m], shape (leg, 3)."""
    long: Flags
    """Whether the foot is a large part of its leg, shape (leg,)."""
    centring: Array
    """How far back the feet of long strides are put, to swing about their hips as far to both sides [m], (leg,)."""
    hanging: Array
    """How much the foot hangs from its joint in flight: 1 for paws and hooves, 0 for long soles, shape (leg,)."""
    soles: Array
    """Length of the soles [m], 0 for feet that stand on a point, shape (leg,)."""

    @property
    def rests(self) -> Array:
        """How far the feet are from their hips at rest [m], shape (leg,)."""
        return quat.length(self.homes - self.hips)

    @property
    def lying(self) -> Flags:
        """Whether each leg points up at rest or lies stretched to a side, as in files without a pose, shape (leg,)."""
        below = (self.hips - self.homes)[:, 2]
        return (below < 0.0) | ((self.rests > STRETCHED * self.lengths) & (below < LYING * self.lengths))

    @classmethod
    def of(cls, legs: Sequence[Leg], width: float) -> "Sizes":
        """Return those of legs that are put ``width`` times as far to the side as they rest."""
        homes = np.array([leg.home for leg in legs]) * np.array([width, 1.0, 1.0])
        turns = quat.from_axis_angle(UP, np.array([leg.turn for leg in legs]))
        heels = quat.rotate(turns, np.array([leg.heel for leg in legs]))
        tips = quat.rotate(turns, np.array([leg.tip for leg in legs]))
        lengths, hips = np.array([leg.length for leg in legs]), np.array([leg.hip for leg in legs])
        soles = quat.length((tips - heels)[:, :2])
        long = (-tips[:, 2] > LONG * (lengths - tips[:, 2])) & (soles < PAW * lengths)
        hanging = np.clip((SOLE - soles / lengths) / (SOLE - PAW), 0.0, 1.0)
        away = hips - homes
        upright = np.clip(1.0 - np.abs(away[:, 0]) / np.maximum(away[:, 2], 1e-9), 0.0, 1.0)
        return cls(lengths, homes, heels, tips, hips, long, CENTRED * upright * away[:, 1], hanging, soles)
