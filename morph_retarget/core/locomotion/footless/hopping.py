"""Bodies without feet and without a spine to crawl with: they hop from place to place on their course."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ... import quat
from ...arrays import Array, Flags
from ...ground import Ground
from ...solve.goals import Goals
from ..course import Course
from ..moving import LEFT, UP, eased, goals_of, wanted_of
from ..settings import GaitSettings
from .track import on_ground

STRIDE = 0.7
"""Way of one hop [sizes]."""
SWIVEL = 0.5
"""Turning counts as going round a circle of this radius [sizes], so that it hops as it turns on the spot."""
HEIGHT = 0.22
"""Of one hop [sizes]."""
STANDS = 0.45
"""Share of a hop for which the body stands."""
LEAN = np.radians(14.0)
"""It leans back as it leaves the ground and forward as it lands, by this."""


@dataclass(frozen=True, eq=False)
class Hopping:
    """A hopping body on its course, ready to be evaluated."""

    root: int
    rest: Array
    """Place of the root's joint at rest [m], ground frame, shape (3,)."""
    course: Course
    hops: Array
    """How often it has hopped at each sample of the course, shape (sample,); whole hops lie between jumps."""
    rates: Array
    """Hops after each sample [1/s], shape (sample,)."""
    height: float
    """Of a hop [m]."""
    lean: float
    """[rad]"""
    ground: Ground | None
    warnings: tuple[str, ...]

    @property
    def wanted(self) -> tuple[tuple[int, bool, bool], ...]:
        """For each goal its body, and whether it has a place and a turn."""
        return wanted_of((self.root,))

    def standing(self, times: Array) -> Flags:
        """Return whether it stands on the ground, shape (frame,)."""
        flight = self._hop(times)[1]
        return (flight <= 0.0) | (flight >= 1.0)

    def evaluate(self, times: Array, carried: Array | None = None) -> Goals:
        """Return goals for a batch of frames; see `Moving`."""
        whole, flight = self._hop(times)
        start, heading = self._stood(whole)
        end, next_heading = self._stood(whole + 1.0)
        places = start + flight[:, None] * (end - start)
        places[:, 2] += 4.0 * self.height * flight * (1.0 - flight)
        # Of a body that stands nothing moves, to the bit.
        places = np.where((flight >= 1.0)[:, None], end, places)
        headings = np.where(flight >= 1.0, next_heading, heading + eased(flight) * (next_heading - heading))
        tilt = self.lean * np.sin(2.0 * np.pi * eased(flight))
        turns = quat.multiply(quat.from_axis_angle(UP, headings), quat.from_axis_angle(LEFT, -tilt))
        root = places + quat.rotate(turns, np.broadcast_to(self.rest, places.shape))
        return goals_of((self.root,), root, turns[:, None], carried)

    def floors(self, times: Array) -> Array:
        """Return how high the ground is that carries the body [m], shape (frame,); see `Moving`."""
        whole, flight = self._hop(times)
        start, end = self._stood(whole)[0][:, 2], self._stood(whole + 1.0)[0][:, 2]
        return start + flight * (end - start)

    def _hop(self, times: Array) -> tuple[Array, Array]:
        """Return how many hops were made, and the share of the present one's flight, each (frame,)."""
        sample = np.clip(np.searchsorted(self.course.times, times, side="right") - 1, 0, len(self.course) - 1)
        hops = self.hops[sample] + self.rates[sample] * (times - self.course.times[sample])
        # Half of the standing is before a flight and half after it, so that it starts on the ground.
        whole = np.floor(hops)
        return whole, np.clip((hops - whole - 0.5 * STANDS) / (1.0 - STANDS), 0.0, 1.0)

    def _stood(self, hops: Array) -> tuple[Array, Array]:
        """Return where it stands after whole hops [m], shape (n, 3), and its headings [rad], shape (n,)."""
        times = self.course.times
        sample = np.clip(np.searchsorted(self.hops, hops, side="right") - 1, 0, len(times) - 1)
        rates = np.maximum(self.rates[sample], 1e-9)
        # Where the course stands, a hop that it did not finish ends where it stands.
        longest = np.append(np.diff(times), np.inf)[sample]
        since = np.where(self.rates[sample] > 0.0, np.minimum((hops - self.hops[sample]) / rates, longest), 0.0)
        places, headings = self.course.at(np.minimum(times[sample] + since, self._ends[sample]))
        return on_ground(places, self.ground), headings

    @cached_property
    def _ends(self) -> Array:
        """Until when the way after each sample goes on [s], shape (sample,)."""
        out = np.append(self.course.times[1:], np.inf)
        cuts = np.array(self.course.cuts, dtype=np.intp)
        out[cuts - 1] = np.nextafter(out[cuts - 1], -np.inf)
        return out


def prepare(
    root: int, points: Array, rest: Array, course: Course, settings: GaitSettings, ground: Ground | None
) -> Hopping:
    """Return how a body hops along a course.

    Args:
        root: The body that carries all others.
        points: All joints at rest [m], ground frame, shape (n, 3).
        rest: The root's joint [m], shape (3,).
        course: Where it goes.
        settings: Factors.
        ground: What it hops on, None for a ground as high as the course.
    """
    size = max(float(np.ptp(points, axis=0).max()), 1e-3)
    velocity, rate = course.velocity(course.times)
    speed = np.hypot(velocity[:, 0], velocity[:, 1]) + SWIVEL * size * np.abs(rate)
    rates = speed / (settings.stride * STRIDE * size)
    steps = rates[:-1] * np.diff(course.times)
    hops = np.concatenate([[0.0], np.cumsum(steps)])
    for cut in course.cuts:
        # It lands before a jump and is ready for the next hop after it.
        hops[cut:] += np.ceil(hops[cut]) + 1.0 - hops[cut]
    warning = "it has neither feet nor a spine of three bodies to crawl with: it hops"
    height, lean = settings.step_height * HEIGHT * size, settings.body * LEAN
    return Hopping(root, rest, course, hops, rates, height, lean, ground, (warning,))
