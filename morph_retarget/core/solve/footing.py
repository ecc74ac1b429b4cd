"""Hips that come down to feet that stand: who sways over legs that are straight, or wide apart, lowers the body.

Where hips move to a side, a leg that rests straight no longer reaches the place of its foot, which would slide. What a
way up or down asks of legs is the animator's own business: hips come down by no more than the way aside costs a leg.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from .. import quat
from ..arrays import Array, Indices
from .goals import Goals
from .hierarchy import Hierarchy
from .settings import SolverSettings

SOFT = 0.005
"""Hips begin to come down softly, over so much [leg lengths]."""
STANDS = 0.02
"""A foot stands that is kept no further above or below where it rests [leg lengths]."""
NEAREST = 0.2
"""Legs are never folded for it to less than this [leg lengths]."""


@dataclass(frozen=True, eq=False)
class Footing:
    """A body with places for its root and its feet."""

    root: int
    """The place of the root among the goals."""
    feet: Indices
    """Those of the feet, shape (leg,)."""
    hips: Array
    """From the root to where each leg starts, at rest [m], shape (leg, 3)."""
    homes: Array
    """From there to its foot, at rest [m], shape (leg, 3)."""
    heights: Array
    """Of the feet at rest [m], shape (leg,)."""
    lengths: Array
    """Of the stretched legs [m], shape (leg,)."""
    reach: Array
    """How far feet get from where their legs start [m], shape (leg,)."""
    share: float
    """Of the way by which hips come down."""

    @classmethod
    def of(
        cls, hierarchy: Hierarchy, wanted: Sequence[tuple[int, bool, bool]], settings: SolverSettings
    ) -> "Footing | None":
        """Return the footing of a character, None where root or feet have no places, or the root is to stay.

        Args:
            hierarchy: The character.
            wanted: For each goal its body, and whether it has a place and a turn.
            settings: Of the solver.
        """
        placed = {body: i for i, (body, place, _) in enumerate(wanted) if place}
        legs = [leg.bones for leg in hierarchy.character.legs if leg.end in placed and len(leg.bones) > 1]
        legs = [bones for bones in legs if hierarchy.root in hierarchy.ancestors[bones[0]]]
        if settings.footing <= 0.0 or hierarchy.root not in placed or not legs:
            return None
        rest = hierarchy.rest
        starts, ends = rest[[bones[0] for bones in legs]], rest[[bones[-1] for bones in legs]]
        lengths = np.array([hierarchy.lengths(bones[:-1], bones[-1])[0] for bones in legs])
        full = np.array([settings.of_limb(hierarchy.names[bones[-1]]).full_reach for bones in legs])
        return cls(
            placed[hierarchy.root],
            np.array([placed[bones[-1]] for bones in legs], dtype=np.intp),
            starts - rest[hierarchy.root],
            ends - starts,
            ends[:, 2],
            lengths,
            np.maximum(full * lengths, quat.length(ends - starts)),
            settings.footing,
        )

    def kept(self, goals: Goals) -> Goals:
        """Return goals of which that of the root is as low as feet that stand need it."""
        # A pelvis is so small that there is no need to turn it part of the way.
        carried = quat.rotate(goals.turns[:, self.root, None], self.hips) - self.hips
        starts = self.hips + goals.rotation_influence[:, self.root, None, None] * carried
        places = goals.positions.take(self.feet, axis=1)
        away = goals.positions[:, None, self.root] + starts - places
        deep = self._deep(away)
        missing = np.maximum(away[..., 2] - deep, 0.0)
        lower = np.minimum(missing**2 / (missing + SOFT * self.lengths), np.maximum(self.depths - deep, 0.0))
        if not lower.any():
            return goals
        off = np.abs(places[..., 2] - self.heights) / (STANDS * self.lengths)
        counts = goals.position_influence.take(self.feet, axis=1) * np.clip(2.0 - off, 0.0, 1.0)
        down = self.share * (lower * counts).max(axis=1)
        if not down.any():
            return goals
        positions = goals.positions.copy()
        positions[:, self.root, 2] -= down
        return replace(goals, positions=positions)

    @cached_property
    def depths(self) -> Array:
        """How far below its start each leg reaches the place of its foot at rest [m], shape (leg,)."""
        return self._deep(self.homes)

    def _deep(self, ways: Array) -> Array:
        """Return how far below its start each leg still reaches a foot that is so far aside [m], shape (..., leg)."""
        left = self.reach**2 - ways[..., 0] ** 2 - ways[..., 1] ** 2
        return np.sqrt(np.maximum(left, (NEAREST * self.reach) ** 2))
