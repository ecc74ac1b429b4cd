"""The track of a course: the line over the ground that bodies without feet follow, by the way along it.

What crawls follows its own head, so it needs to know where the course was, and will be, some way off. Before its start
and after its end a track goes on straight; a jump of the course starts another track far from the first.

The track is that of a point a little ahead of the character frame. Where the course turns on the spot, this point goes
round in a circle, so that the track never bends sharper than a body can.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import cast

import numpy as np

from ... import quat
from ...arrays import Array
from ...ground import Ground, heights_on
from ..course import Course
from ..moving import heading_of

FINE = 64
"""Points of a track within the length over which its corners are smoothed."""
BEYOND = 2.0
"""After its end and before its start a course goes on for so long [s]; then what follows it stands."""
MOST_POINTS = 400_000
"""No track has more points than this, however small a body is against its course."""
BACK = 0.3
"""A point goes backward if it does so by more than this share of its speed."""


@dataclass(frozen=True, eq=False)
class Track:
    """Points of a line on the ground at even ways, and when a course is where on it."""

    spacing: float
    """Way from each point to the next [m]; it is 0 at the first."""
    points: Array
    """On the ground [m], shape (point, 3)."""
    headings: Array
    """Where the body looks that follows it [rad], unwrapped, shape (point,)."""
    course: Course
    """Of the character frame."""
    starts: Array
    """Way at each sample of the course [m], shape (sample,)."""
    lead: float
    """How far the track is ahead of the character frame [m]."""
    reach: float
    """How far a body extends on it before and behind where the course is [m]."""
    astray: float
    """How far the course is off it where it goes back otherwise than it came [m]; corners do not count."""

    @cached_property
    def ways(self) -> Array:
        """At all points [m], shape (point,)."""
        return self.spacing * np.arange(len(self.points), dtype=np.float64)

    @property
    def start(self) -> float:
        """Way of the character frame as the course starts [m]."""
        return float(self.starts[0]) - self.lead

    def way(self, times: Array) -> Array:
        """Return where along it the character frame is at times [s], shape (n,)."""
        course = self.course
        sample = np.clip(np.searchsorted(course.times, times, side="right") - 1, 0, len(course) - 1)
        ways = self.starts[sample] + self._speeds[sample] * (times - course.times[sample])
        return np.clip(ways, self.reach, float(self.ways[-1]) - self.reach) - self.lead

    def at(self, ways: Array) -> Array:
        """Return points [m] at ways along it [m], shape (...) to (..., 3)."""
        return self.along(self.points, ways)

    def heading(self, ways: Array) -> Array:
        """Return headings [rad] at ways along it [m], of any shape."""
        return self.along(self.headings, ways)

    def along(self, values: Array, ways: Array) -> Array:
        """Return values of the points, shape (point, ...), between these at ways [m] of any shape."""
        place = np.clip(ways / self.spacing, 0.0, len(self.points) - 1.0)
        left = np.minimum(place.astype(np.intp), len(self.points) - 2)
        share = (place - left).reshape((*ways.shape, *([1] * (values.ndim - 1))))
        before = values[left]
        return before + share * (values[left + 1] - before)

    @cached_property
    def _speeds(self) -> Array:
        """Along the track after each sample [m/s]."""
        return _speeds(_led(self.course, self.lead))


def find(course: Course, reach: float, smoothing: float, lead: float, ground: Ground | None) -> Track:
    """Return the track of a course.

    Args:
        course: Where a body goes.
        reach: How far the body extends to the front and the rear [m].
        smoothing: Length of the track over which corners are spread [m].
        lead: How far the track is ahead of the character frame [m].
        ground: What it lies on, in the ground frame; None for a ground as high as the course.
    """
    led = _led(course, lead)
    speeds = _speeds(led)
    steps = speeds[:-1] * np.diff(course.times)
    ends = [0, *course.cuts, len(course)]
    margin = reach + lead + 2.0 * smoothing + BEYOND * float(np.abs(speeds[[0, -1]]).max())
    spacing = max(smoothing / FINE, (np.abs(steps).sum() + 2.0 * margin * (len(ends) - 1)) / MOST_POINTS)
    runs, starts, astray, count = list[Array](), np.zeros(len(course)), 0.0, 0
    for first, last in pairwise(ends):
        own = np.concatenate([[0.0], np.cumsum(steps[first : last - 1])])
        low = float(own.min()) - margin
        size = int(np.ceil((float(own.max()) + margin - low) / spacing)) + 1
        grid = low + spacing * np.arange(size, dtype=np.float64)
        line = _run(led, slice(first, last), own, grid)
        astray = max(astray, _off(line, grid, own, led.places[first:last]))
        runs.append(_smoothed(line, smoothing / spacing))
        starts[first:last] = own - low + spacing * count
        count += size
    headings = [np.unwrap(heading_of(np.gradient(line, axis=0))) for line in runs]
    points = on_ground(np.concatenate(runs), ground)
    return Track(spacing, points, np.concatenate(headings), course, starts, lead, reach, astray)


def on_ground(points: Array, ground: Ground | None) -> Array:
    """Return points at the height of the ground, where there is any, shape (n, 3)."""
    if ground is None:
        return points
    return np.column_stack([points[:, :2], heights_on(ground, points, points[:, 2])])


def told(track: Track, size: float) -> Sequence[str]:
    """Return what the user should know about a body of some size [m] that follows a track."""
    if track.astray < 0.25 * size:
        return ()
    return (f"it goes back the way it came, though that is up to {track.astray:.2f} m off its course",)


def _led(course: Course, lead: float) -> Course:
    """Return the course of a point ahead of the character frame."""
    ahead = np.stack([np.sin(course.headings), -np.cos(course.headings), np.zeros(len(course))], axis=-1)
    return replace(course, places=course.places + lead * ahead)


def _speeds(course: Course) -> Array:
    """Return speeds over the ground after each sample, below 0 where it goes backward [m/s], shape (sample,)."""
    velocity, _ = course.velocity(course.times)
    ahead = velocity[:, 0] * np.sin(course.headings) - velocity[:, 1] * np.cos(course.headings)
    speed = np.hypot(velocity[:, 0], velocity[:, 1])
    return np.where(ahead < -BACK * speed, -speed, speed)


def _run(course: Course, samples: slice, ways: Array, grid: Array) -> Array:
    """Return the points of the track between two jumps at ways ``grid``, with straight lines before and after it."""
    times = course.times[samples]
    there = np.clip(grid, ways.min(), ways.max())
    line, _ = course.at(_reached(times, ways, there))
    beyond = grid - there
    for side, end in ((beyond < 0.0, int(np.argmin(ways))), (beyond > 0.0, int(np.argmax(ways)))):
        place, heading = course.at(times[end : end + 1])
        line[side] = place[0] + beyond[side, None] * np.array([np.sin(heading[0]), -np.cos(heading[0]), 0.0])
    return line


def _reached(times: Array, ways: Array, there: Array) -> Array:
    """Return when each way is reached for the first time [s], shape (n,); ``ways`` are those at times [m]."""
    out = np.empty(len(there))
    for side in (1.0, -1.0):
        own: Array = side * (there - ways[0])
        gone: Array = side * (ways - ways[0])
        sample = np.clip(np.searchsorted(np.maximum.accumulate(gone), own), 0, len(times) - 1)
        before = np.clip(sample - 1, 0, None)
        left, last = gone[sample] - own, gone[sample] - gone[before]
        share = np.where(last > 0.0, left / np.where(last > 0.0, last, 1.0), 0.0)
        found = times[sample] - share * (times[sample] - times[before])
        out = np.where(own >= 0.0, found, out)
    return out


def _off(line: Array, grid: Array, ways: Array, places: Array) -> float:
    """Return how far places are off a line at their ways [m]."""
    there = np.column_stack([np.interp(ways, grid, line[:, 0]), np.interp(ways, grid, line[:, 1])])
    return float(quat.length(there - places[:, :2]).max())


def _smoothed(line: Array, width: float) -> Array:
    """Return an evenly sampled line with corners spread over ``width`` of its points; its straight ends remain."""
    half = max(round(0.5 * width), 1)
    window = np.hanning(2 * half + 3)[1:-1]
    window /= window.sum()
    before, after = 2.0 * line[0] - line[half:0:-1], 2.0 * line[-1] - line[-2 : -half - 2 : -1]
    padded = np.concatenate([before, line, after])
    return np.column_stack([cast("Array", np.convolve(padded[:, i], window, mode="valid")) for i in range(3)])
