"""How far branch points of a spine give way to the limbs that pull at them, Hecker 2008 §4.3.2.

Where a goal holds the spine farther out, as a head's does, they do all that limbs want. Where limbs alone bend it, it
bends as far as that helps. What presses it together along itself would make bones zigzag that keep their lengths, and
what pulls to several sides leaves little to be gained: the spine would go a long way for a goal that an arm can miss by
a finger's breadth unseen.
"""

from dataclasses import dataclass

import numpy as np

from .. import quat
from ..arrays import Array
from . import constraints
from .constraints import TINY
from .spine import Rest
from .spine_lines import angles
from .spine_pulls import PulledNode
from .spine_wanted import Wanted

UPRIGHT, LEANING = np.radians(10.0), np.radians(45.0)
"""Angles to which a piece has to lean from rest before limbs alone press it on, and from which on they do so in full:
what leans already comes nearer by leaning more."""


@dataclass(frozen=True, eq=False)
class Pulls:
    """Limbs that pull at a branch point."""

    own: PulledNode
    ends: Array
    """Their goals, less where they start from the branch point [m], shape (frame, limb, 3)."""
    weights: Array
    """How much they count, shape (frame, limb)."""

    @classmethod
    def of(cls, rest: Rest, wanted: Wanted, node: int) -> "Pulls":
        """Return those of a branch point."""
        own = rest.spine.pulled[node]
        ends = wanted.goals.take(own.pulls, axis=1) - rest.starts.take(own.pulls, axis=1)
        return cls(own, ends, wanted.weights.take(own.pulls, axis=1))

    def ways(self, particle: Array) -> Array:
        """Return how far they move the branch point [m], shape (frame, limb, 3).

        Args:
            particle: Where it is [m], shape (frame or 1, 3).
        """
        away = self.ends - particle[:, None]
        distance = quat.length(away)
        error = constraints.beyond(distance, self.own.start, self.own.full, self.own.least)
        return (self.weights * error / np.maximum(distance, TINY))[..., None] * away


def way(rest: Rest, wanted: Wanted, particles: Array, node: int, ways: Array) -> Array:
    """Return how far a branch point moves for limbs [m], shape (frame, 3).

    Args:
        rest: The root-relative rest pose.
        wanted: What bends the spine.
        particles: The branch points [m], shape (frame, node, 3).
        node: The branch point.
        ways: How far each of its limbs would move it [m], shape (frame, limb, 3).
    """
    out, piece = constraints.together(ways), node - 1
    if not wanted.is_loose:
        return out
    loose, axis, sizes = wanted.loose[:, piece], rest.axes[:, piece], quat.length(ways)
    # What is left of what all want, if they do not want the same.
    alike = (sizes * sizes).sum(axis=-1) / np.maximum(sizes.sum(axis=-1), TINY)
    agreed = np.minimum(quat.length(out) / np.maximum(alike, TINY), 1.0)
    leaning = constraints.smooth_step(angles(axis, particles[:, node] - particles[:, piece]), UPRIGHT, LEANING)
    pressed = loose * (1.0 - leaning) * np.minimum(quat.dot(out, axis), 0.0)
    return (1.0 - loose * (1.0 - agreed * agreed))[:, None] * (out - pressed[:, None] * axis)
