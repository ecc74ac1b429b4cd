"""Branching limbs, Hecker 2008 §4.3.3: a stem that several goals share, such as an arm with goals for two fingers.

The stem is aimed by the weighted average of the goals, as a limb is whose end is the middle of what they move. What is
left is for the limbs beyond, which are solved after it from where it has brought them, branch by branch outward. Their
places on the stem's last body are rigid, which is what the paper's cross-constraints are for: that body twists to where
the goals are, and the stem follows what is still out of reach of them.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .. import quat, rotation
from ..arrays import Array
from . import constraints, limb_phase
from .constraints import TINY
from .limb_phase import Limbs

FOLLOWS = 4
"""How often a stem follows what is out of reach of its branches."""
EAGER = 2.5
"""By how much more than they fall short the stem follows: it turns as it does, and loses part of it."""
ROUNDS = 2
"""How often bodies that count differently are looked at anew."""
FAINT = 1e-3
"""Share of the branches' size below which goals do not tell how the last body twists."""


@dataclass(frozen=True, eq=False)
class Stem:
    """What several goals share of a limb, at rest in the frame of what carries it."""

    chain: Limbs
    """Its joints and, as their end, the middle of the bodies that have the goals: one limb."""
    starts: Array
    """Where the limbs beyond start, from the stem's last joint [m], shape (goal, 3)."""
    tips: Array
    """The bodies that have the goals, from there [m], shape (goal, 3)."""
    full: Array
    """Lengths of the limbs beyond when they are stretched [m], shape (goal,) …"""
    least: Array
    """… and when they are folded up."""
    slow_down: Array
    """Share of their lengths from which on they slow down, shape (goal,)."""

    @classmethod
    def of(
        cls,
        points: Array,
        starts: Array,
        tips: Array,
        lengths: Sequence[tuple[float, float]],
        slow_down: Sequence[float],
        limbs: Limbs,
    ) -> "Stem":
        """Return a stem.

        Args:
            points: Its joints [m], shape (joint, 3).
            starts: Where the limbs beyond start [m], shape (goal, 3).
            tips: The bodies that have the goals [m], shape (goal, 3).
            lengths: Of the limbs beyond, stretched and folded up [m].
            slow_down: Share of these from which on they slow down.
            limbs: The chain through the points to the middle of the tips.
        """
        full, least = np.array(lengths).T
        return cls(limbs, starts - points[-1], tips - points[-1], full, least, np.array(slow_down))

    @cached_property
    def lead(self) -> Array:
        """From where the stem starts to its last joint, shape (3,)."""
        return self.chain.segments[0, :-1].sum(axis=0)

    @cached_property
    def reach(self) -> Array:
        """Up to where the limbs beyond reach their goals without slowing down [m], shape (goal,)."""
        return np.maximum(self.slow_down * self.full, quat.length(self.tips - self.starts))

    @cached_property
    def faint(self) -> Array:
        """What the sums that tell a twist are compared to [m²], shape (goal,)."""
        return FAINT * quat.dot(self.tips, self.tips)


def solve(stem: Stem, goals: Array, weights: Array) -> Array:
    """Return how the joints of a stem turn from where it is carried, shape (frame, 1, joint, 3, 3).

    Args:
        stem: The stem.
        goals: From where it starts, in the frame of what carries it [m], shape (frame, goal, 3).
        weights: How much they count, shape (frame, goal).
    """
    total = np.maximum(weights.sum(axis=-1, keepdims=True), TINY)
    ways = goals - (stem.lead + stem.tips)
    # Of one goal as much as it counts; of several their mean, whatever other ones rest.
    target = stem.chain.segments[0].sum(axis=0) + np.matmul((weights * weights / total)[:, None], ways)[:, 0]
    share = weights / total
    influence = weights.max(axis=-1, keepdims=True)
    turned = _turned(stem, target, goals, share, influence)
    for _ in range(FOLLOWS):
        end, body = last(stem, turned)
        away = goals - end[:, None] - rotation.apply(body[:, None], stem.starts)
        distance = quat.length(away)
        error = np.maximum(distance - stem.reach, 0.0) + np.minimum(distance - stem.least, 0.0)
        if not (np.abs(error) > 0.0).any():
            break
        short = (weights * error / np.maximum(distance, TINY))[..., None] * away
        target = target + EAGER * constraints.together(short)
        turned = _turned(stem, target, goals, share, influence)
    return turned


def settle(stem: Stem, goals: Array, weights: Array) -> Array:
    """Return how the joints of a stem turn which alone brings what has the goals to their places, shape as of `solve`.

    The middle of the bodies goes to that of the goals, weighed by how much they count, and as far as the one that
    counts most. Where they count differently that depends on how the last joint is turned, so it is found in rounds.

    Args:
        stem: The stem, with nothing beyond it.
        goals: From where it starts, in the frame of what carries it [m], shape (frame, goal, 3).
        weights: How much they count, shape (frame, goal).
    """
    share, influence = constraints.shares(weights), weights.max(axis=-1, keepdims=True)
    rest, off = stem.lead + stem.tips, stem.tips - stem.chain.segments[0, -1]
    goals = rest + influence[..., None] * (goals - rest)
    target = (share[..., None] * (goals - off)).sum(axis=1)
    turned = _turned(stem, target, goals, share, influence)
    for _ in range(ROUNDS):
        offsets = rotation.apply(last(stem, turned)[1][:, None], off)
        target = (share[..., None] * (goals - offsets)).sum(axis=1)
        turned = _turned(stem, target, goals, share, influence)
    return turned


def _turned(stem: Stem, target: Array, goals: Array, share: Array, influence: Array) -> Array:
    """Return how the joints turn to bring the middle of the tips to a place, the last one with its twist."""
    turned = limb_phase.solve(stem.chain, target[:, None], influence)
    end, body = last(stem, turned)
    turned[:, 0, -1] = np.matmul(_twisted(stem, body, goals - end[:, None], share), body)
    return turned


def last(stem: Stem, turned: Array) -> tuple[Array, Array]:
    """Return where the last joint of a stem is, shape (frame, 3), and how its body is turned, shape (frame, 3, 3)."""
    turned = turned[:, 0]
    return rotation.apply(turned[:, :-1], stem.chain.segments[0, :-1]).sum(axis=1), turned[:, -1]


def _twisted(stem: Stem, body: Array, goals: Array, share: Array) -> Array:
    """Return how the last body twists about where it points, to where its branches' goals are, shape (frame, 3, 3).

    A twist of a quarter turn is half made, and one of half a turn not at all: that way it never jumps.
    """
    axis = rotation.apply(body, stem.chain.directions[0, -1])[:, None]
    tips = rotation.apply(body[:, None], stem.tips)
    sine = (share * quat.dot(axis, quat.cross(tips, goals))).sum(axis=-1)
    ahead = quat.dot(axis, tips) * quat.dot(axis, goals)
    cosine = (share * (quat.dot(tips, goals) - ahead + stem.faint)).sum(axis=-1)
    angle = np.arctan2(sine, np.where((sine == 0.0) & (cosine == 0.0), 1.0, cosine))
    angle = angle * (0.5 + 0.5 * np.cos(angle))
    return rotation.about(axis[:, 0], angle)
