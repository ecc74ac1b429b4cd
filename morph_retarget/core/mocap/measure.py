"""Measuring a transferred motion against its source: directions, twist, slide, penetration, jumps."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .. import quat
from ..arrays import Array, Flags, Indices
from ..ground import Ground
from . import soles
from .links import NONE, LimbLinks, Links
from .motion import Motion, SourceMotion
from .plan import Plan
from .transfer import relative


@dataclass(frozen=True)
class Spread:
    """Mean, 95th percentile and largest of a measured quantity."""

    mean: float
    p95: float
    max: float
    median: float

    @classmethod
    def of(cls, values: Array) -> "Spread":
        """Return the spread of ``values``, all zero when there are none."""
        if not values.size:
            return cls(0.0, 0.0, 0.0, 0.0)
        return cls(
            float(values.mean()), float(np.quantile(values, 0.95)), float(values.max()), float(np.median(values))
        )


def _segments(links: Links) -> Indices:
    """Return the links with a segment of their own on both bodies: not those that share a single source bone."""
    own = np.flatnonzero(links.after != NONE)
    here = np.column_stack([links.source[own], links.weight[own]])
    there = np.column_stack([links.source[links.after[own]], links.weight[links.after[own]]])
    return own[(here != there).any(axis=1)]


def direction_errors(links: Links, source_points: Array, target_points: Array) -> Array:
    """Return the angle between each segment of source and target [deg], shape (frame, segment)."""
    own = _segments(links)
    after = links.after[own]
    a = quat.unit(source_points[:, after] - source_points[:, own])
    b = quat.unit(target_points[:, after] - target_points[:, own])
    return np.degrees(2.0 * np.arcsin(np.clip(quat.length(a - b) / 2.0, 0.0, 1.0)))


def twist_errors(links: Links, source_turns: Array, turns: Array, target_rest: Array, post: Array) -> Array:
    """Return by how much each segment's twist differs from the source's, both relative to the alignment [deg].

    The transfer keeps twist relative to the rests, so this is what constraints and sharing along chains have changed;
    shape (frame, segment).
    """
    own = _segments(links)
    axes = quat.unit(target_rest[links.after[own]] - target_rest[own])
    meant = quat.multiply(source_turns[:, own], post[own])
    change = quat.multiply(quat.conjugate(meant), turns[:, own])
    twist = quat.twist_about(change, axes)
    return np.degrees(quat.angle_between(twist, quat.IDENTITY))


def jumps(turns: Array, carrier: Indices) -> Array:
    """Return how far each joint turns on its carrier from one frame to the next [deg], shape (frame - 1, link)."""
    if len(turns) < 2:
        return np.zeros((0, turns.shape[1]))
    own = relative(turns, carrier, np.arange(len(carrier)))
    return np.degrees(quat.angle_between(own[1:], own[:-1]))


def slides(legs: Sequence[LimbLinks], ankle: Flags, ball: Flags, points: Array) -> Array:
    """Return the way of each standing foot along the ground from frame to frame [m], shape (n,).

    A foot on its heel or flat is measured at the ankle, one on its ball at the ball.

    Args:
        legs: Of the pair.
        ankle: Whether each ankle rests, shape (frame, foot).
        ball: Whether each ball rests, shape (frame, foot).
        points: Places of the links, shape (frame, link, 3).
    """
    out: list[Array] = []
    for f, leg in enumerate(legs):
        on_ankle = ankle[1:, f] & ankle[:-1, f]
        out.append(_ways(points[:, leg.end])[on_ankle])
        if leg.ball != NONE:
            out.append(_ways(points[:, leg.ball])[ball[1:, f] & ball[:-1, f] & ~on_ankle])
    return np.concatenate(out) if out else np.zeros(0)


def _ways(path: Array) -> Array:
    return quat.length(np.diff(path[:, :2], axis=0))


@dataclass(frozen=True)
class Measures:
    """How well a transfer went."""

    direction: Spread
    """Angle between segments of source and target [deg]."""
    twist: Spread
    """Twist of segments that constraints have added [deg]."""
    slide_source: float
    """Mean speed of the source's standing feet along the ground, at the target's size [m/s]."""
    slide_target: float
    """The same of the target [m/s]."""
    slide_step: float
    """Most that a standing foot of the target moves in a frame beyond the source's scaled movement [m]."""
    penetration: float
    """How deep a sole sinks below the floor at most [m]."""
    jump_source: float
    """Largest turn of a joint from one frame to the next [deg]."""
    jump_target: float
    """The same of the target [deg]."""
    unreached: float
    """Largest distance of a foot or hand from its place [m]."""


def measure(plan: Plan, source: SourceMotion, motion: Motion, ground: Ground | None = None) -> Measures:
    """Return how well a motion of the target follows the source's; penetration only over flat ground."""
    links, steps, carrier = plan.links, source.steps, plan.transfer.carrier
    theirs = slides(links.legs, steps.ankle, steps.ball, source.points)
    ours = slides(links.legs, steps.ankle, steps.ball, motion.points)
    excess = ours - plan.scale * theirs
    sunk = 0.0
    if links.legs and ground is None:
        sunk = plan.target.floor - float(soles.heights(soles.of_target(plan), motion.turns, motion.points).min())
    return Measures(
        direction=Spread.of(direction_errors(links, source.points, motion.points)),
        twist=Spread.of(twist_errors(links, source.turns, motion.turns, plan.target_rest, plan.transfer.post)),
        slide_source=plan.scale * float(theirs.mean()) / source.seconds_per_frame if theirs.size else 0.0,
        slide_target=float(ours.mean()) / source.seconds_per_frame if ours.size else 0.0,
        slide_step=max(float(excess.max(initial=0.0)), 0.0),
        penetration=max(sunk, 0.0),
        jump_source=float(jumps(source.turns, carrier).max(initial=0.0)),
        jump_target=float(jumps(motion.turns, carrier).max(initial=0.0)),
        unreached=motion.unreached,
    )
