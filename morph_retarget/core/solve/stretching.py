"""Limbs that stretch, Hecker 2008 §4.3: bones that get longer for goals out of reach, and shorter for goals too near.

The paper lets constraints stretch and compress throughout; here they do so where exact lengths do not reach, so that
nothing else changes. A limb keeps the shape that the limb phase finds for it. To reach farther, all of its bones
stretch by one factor. To reach nearer than it folds, bones that lead to its end give way, each by its share of what is
missing, so that a limb which all but folds up hardly changes.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from .. import quat, rotation
from ..arrays import Array, Flags
from . import branching, constraints, limb_phase
from .branching import Stem
from .constraints import TINY
from .limb_phase import Limbs
from .settings import SolverSettings

EXACT = 1e-9
"""Share of a distance by which goals may be out of reach for rounding alone, as that of a limb that is straight."""


@dataclass(frozen=True)
class Link:
    """A bone of a limb that may change its length."""

    joint: int
    """Where it starts."""
    end: int
    """The body whose head it moves."""
    limb: int
    place: int
    """Its place in the limb, as `Limbs` has it."""


@dataclass(frozen=True, eq=False)
class Elastic:
    """Limbs that are solved together, some of which may stretch."""

    limbs: Limbs
    links: tuple[Link, ...]
    """The bones that may, from what carries the limbs outward."""
    most: float
    """Largest factor."""
    least: float
    """Smallest factor."""

    @classmethod
    def of(
        cls,
        limbs: Limbs,
        joints: Sequence[Sequence[int]],
        ends: Sequence[int],
        fixed: Collection[int],
        settings: SolverSettings,
    ) -> "Elastic | None":
        """Return what stretches of limbs, None when nothing may.

        Args:
            limbs: The limbs.
            joints: Of each one, from what carries it outward.
            ends: Bodies at their ends; none for a stem, whose last bone keeps its length.
            fixed: Bodies whose heads stay where their parents hold them: limbs with such a body keep their lengths.
            settings: Of the solver.
        """
        links: list[Link] = []
        for i, own in enumerate(joints):
            line, first = (*own, *ends[i : i + 1]), limbs.segments.shape[1] - len(own)
            if not any(body in fixed for body in line[1:]):
                links += [Link(a, b, i, first + k) for k, (a, b) in enumerate(pairwise(line))]
        return cls(limbs, tuple(links), settings.stretch, settings.shrink) if links else None

    @cached_property
    def may(self) -> Flags:
        """Whether each limb stretches, shape (limb,)."""
        out = np.zeros(len(self.limbs.full), dtype=bool)
        out[[link.limb for link in self.links]] = True
        return out

    @cached_property
    def nearest(self) -> Array:
        """How near ends come to the starts when limbs fold up [m], shape (limb,)."""
        return quat.length((self.limbs.lengths[..., None] * self.limbs.shapes.directions[:, 0]).sum(axis=-2))


def solve(elastic: Elastic, goals: Array, influence: Array | float = 1.0) -> tuple[Array, Array]:
    """Return how joints turn from where they are carried, and by what factors bones are longer.

    Arguments as for `limb_phase.solve`; limbs within reach turn as there, to the bit, and have factors of 1.

    Returns:
        Rotation matrices, shape (frame, limb, joint, 3, 3), and factors, shape (frame, limb, joint).
    """
    limbs, away = elastic.limbs, quat.length(goals)
    reached = limbs.reachable(away)
    far = elastic.may & (away > (1.0 + EXACT) * reached)
    near = elastic.may & (away < (1.0 - EXACT) * elastic.nearest)
    directions = limbs.shapes.at(reached)
    ends = (limbs.lengths[..., None] * directions).sum(axis=-2)
    factors = np.ones(directions.shape[:-1])
    if far.any():
        # The stretched limb slows down as it does at its own length: the same curve, as much larger.
        wanted = elastic.most * limbs.reachable(away / elastic.most)
        share = np.clip(wanted / np.maximum(quat.length(ends), TINY), 1.0, elastic.most)
        factors = np.where(far, share, 1.0)[..., None] * factors
    if near.any():
        shorter, compressed = _compressed(elastic, directions, ends, away)
        directions = np.where(near[..., None, None], shorter, directions)
        factors = np.where(near[..., None], compressed, factors)
    return limb_phase.aimed(limbs, goals, directions, ends, influence), factors


def _compressed(elastic: Elastic, directions: Array, ends: Array, away: Array) -> tuple[Array, Array]:
    """Return directions and factors of bones that bring ends nearer, on the same lines.

    A bone loses the more of the way to the end, the more it leads there, so none gets longer.
    """
    lengths = elastic.limbs.lengths
    distance = np.maximum(quat.length(ends), TINY)
    along = lengths * np.maximum(quat.dot(directions, ends[..., None, :]) / distance[..., None], 0.0)
    shares = along / np.maximum(along.sum(axis=-1, keepdims=True), TINY)
    missing = 1.0 - np.clip(away / distance, elastic.least, 1.0)
    bones = lengths[..., None] * directions - (missing[..., None] * shares)[..., None] * ends[..., None, :]
    sizes = quat.length(bones)
    there = lengths > TINY
    shorter = np.where(there[..., None], bones / np.maximum(sizes, TINY)[..., None], directions)
    return shorter, np.where(there, np.minimum(sizes / np.maximum(lengths, TINY), 1.0), 1.0)


def of_stem(elastic: Elastic, stem: Stem, turned: Array, goals: Array, weights: Array) -> Array:
    """Return by what factors the bones of a stem are longer, shape (frame, 1, joint).

    It stretches toward what its branches still fall short of; these stretch themselves for the rest.

    Args:
        elastic: The stem's chain.
        stem: The stem.
        turned: How its joints turn from where it is carried, shape (frame, 1, joint, 3, 3).
        goals: From where it starts, in the frame of what carries it [m], shape (frame, goal, 3).
        weights: How much they count, shape (frame, goal).
    """
    end, body = branching.last(stem, turned)
    away = goals - end[:, None] - rotation.apply(body[:, None], stem.starts)
    distance = quat.length(away)
    share = weights * np.maximum(distance - stem.reach, 0.0) / np.maximum(distance, TINY)
    way = constraints.together(share[..., None] * away)
    longer = quat.dot(way, end) / np.maximum(quat.dot(end, end), TINY)
    factors = np.ones(turned.shape[:3])
    factors[:, 0] += np.clip(longer, 0.0, elastic.most - 1.0)[:, None]
    return factors
