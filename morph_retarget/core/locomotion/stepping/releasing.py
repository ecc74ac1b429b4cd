"""Feet that the body leaves behind: they leave the ground earlier, before it has gone beyond their reach.

So it is where a body sets out or stops at once, and where it climbs: in the time of a whole stance it gets further from
a foot than in a steady walk on level ground, for which strides are made.
"""

from dataclasses import dataclass, replace

import numpy as np

from ... import quat
from ...arrays import Array, Flags, Indices
from ..course import Course
from ..moving import UP
from .feet import Steps, trailing
from .reaching import LONGEST
from .trunk import Trunk, under_hips

LOWERS, TURNING_LOWERS = 0.12, 0.2
"""Hips are lowered by so much for a foot that trails, and on the outside of a turn, before it leaves [leg lengths]."""
LONGER = 1.02
"""Stances that last no longer than this factor of the usual time are no longer than usual."""
EARLIEST = 0.5
"""Share of its stance for which a foot stands at least."""
SHARES: Array = np.linspace(EARLIEST, 1.0, 9)
"""Shares of a stance at which it is looked at how far the body has gone."""


def released(course: Course, steps: Steps, trunk: Trunk, tilt: float, level: bool) -> Steps:
    """Return steps of which no stance lasts longer than the leg reaches, but for the last foot on the ground.

    Args:
        course: The body's way.
        steps: Of its feet.
        trunk: Of the body.
        tilt: How much it tilts with the ground, 0 … 1.
        level: Whether the ground is level; strides are made for stances as long as usual there.
    """
    contacts, body = steps.contacts, _Body(course, steps, trunk, tilt)
    legs, cycles = _leaving(course, steps)
    lowers = np.full(len(legs), LOWERS)
    if level:
        long, outside = _unusual(course, steps, legs, cycles)
        lowers = np.where(long, LOWERS, TURNING_LOWERS)
        some = long | outside
        legs, cycles, lowers = legs[some], cycles[some], lowers[some]
    ends = body.is_beyond(np.ones(len(legs)), legs, cycles, lowers)
    legs, cycles, lowers = legs[ends], cycles[ends], lowers[ends]
    if not len(legs):
        return steps
    shape, count = (len(legs), len(SHARES)), len(SHARES)
    rows: Indices = np.repeat(np.arange(len(legs)), count)
    far = body.is_beyond(np.tile(SHARES, len(legs)), legs[rows], cycles[rows], lowers[rows]).reshape(shape)
    touch, lift = contacts.touch[legs, cycles], contacts.lift[legs, cycles]
    times = touch[:, None] + SHARES * (lift - touch)[:, None]
    others = contacts.standing(times.ravel()).sum(axis=1).reshape(shape) > 1
    # From the time on from which it is too far for good and another foot stands, or from just before.
    late = np.logical_and.accumulate((far & others)[:, ::-1], axis=1)[:, ::-1]
    row, first = np.arange(len(legs)), np.argmax(late, axis=1)
    first -= (first > 0) & others[row, first - 1]
    leaves = contacts.lift.copy()
    leaves[legs, cycles] = np.where(late.any(axis=1), times[row, first], lift)
    return replace(steps, contacts=replace(contacts, lift=leaves))


@dataclass(frozen=True, eq=False)
class _Body:
    """A body on its way over its feet, about as high as it will be carried."""

    course: Course
    steps: Steps
    trunk: Trunk
    tilt: float

    def is_beyond(self, shares: Array, legs: Indices, cycles: Indices, lowers: Array) -> Flags:
        """Return whether feet are out of reach at shares of their stances, shapes (n,).

        Args:
            shares: Of the stances, `EARLIEST` … 1.
            legs: Whose.
            cycles: Which of theirs.
            lowers: How much the hips are lowered for them [leg lengths].
        """
        sizes, contacts = self.steps.sizes, self.steps.contacts
        touch, lift = contacts.touch[legs, cycles], contacts.lift[legs, cycles]
        times = touch + shares * (lift - touch)
        places, headings = self.course.at(times)
        hips = quat.rotate(quat.from_axis_angle(UP, headings), sizes.hips[legs]) + places
        under = under_hips(self.trunk, _floors(self.steps, times), sizes, self.tilt)[np.arange(len(times)), legs]
        hips[:, 2] = under + sizes.hips[legs, 2] - lowers * sizes.lengths[legs]
        away = quat.length(trailing(self.steps, shares, legs, cycles) - hips)
        return away > np.maximum(LONGEST * sizes.lengths, sizes.rests)[legs]


def _leaving(course: Course, steps: Steps) -> tuple[Indices, Indices]:
    """Return the legs and the cycles of the stances from which feet go on during a course, each (n,)."""
    lift = steps.contacts.lift
    # Who stands until the body jumps elsewhere is not left behind.
    seen = (lift > course.times[0]) & (lift <= course.times[-1]) & ~np.isin(lift, course.times[list(course.cuts)])
    # Legs that do not stand at rest tell nothing of how high their hips are carried.
    legs, cycles = np.nonzero(seen & ~steps.sizes.lying[:, None])
    return legs, cycles


def _unusual(course: Course, steps: Steps, legs: Indices, cycles: Indices) -> tuple[Flags, Flags]:
    """Return which stances are longer than strides are made for, and which those of feet on the outside of turns."""
    touch, lift = steps.contacts.touch[legs, cycles], steps.contacts.lift[legs, cycles]
    ways = quat.length(_homes(course, steps, lift) - _homes(course, steps, touch))
    outside = ways[np.arange(len(legs)), legs] > LONGER * ways.mean(axis=1)
    return lift - touch > LONGER * steps.usual[legs, cycles], outside


def _homes(course: Course, steps: Steps, times: Array) -> Array:
    """Return where the homes of all feet are at times [m], shape (n,) to (n, leg, 3)."""
    places, headings = course.at(times)
    turned = quat.from_axis_angle(UP, headings)[:, None]
    return places[:, None] + quat.rotate(turned, steps.sizes.homes[None])


def _floors(steps: Steps, times: Array) -> Array:
    """Return the heights that feet stand on or fly toward [m], shape (n,) to (n, leg)."""
    contacts, plants = steps.contacts, steps.plants
    cycles, legs = contacts.cycles(times), np.arange(len(contacts.counts))
    following = np.minimum(cycles + 1, contacts.counts - 1)
    lift, touch = contacts.lift[legs, cycles], contacts.touch[legs, following]
    flies = (times[:, None] > lift) & (touch > lift)
    share = np.where(flies, times[:, None] - lift, 0.0) / np.where(flies, touch - lift, 1.0)
    here, there = plants.floors[legs, cycles], plants.floors[legs, following]
    return here + np.clip(share, 0.0, 1.0) * (there - here)
