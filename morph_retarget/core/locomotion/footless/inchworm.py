"""Short bodies that crawl: some bodies of the spine are pseudo-feet, and an inch-worm's gait is made for them.

The rear pseudo-foot steps up while the body arches, then the front one goes on and the body stretches out again (Hecker
2008 §4.2). Each stands still while the other goes. What is before the front one and behind the rear one is carried.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ... import quat
from ...arrays import Array, Flags
from ...ground import Ground
from ...solve.goals import Goals
from ..course import Course
from ..moving import LEFT, UP, eased, goals_of, heading_of, rise_of, wanted_of
from ..settings import GaitSettings
from .line import Line
from .track import Track, told
from .track import find as find_track

STRIDE = 0.45
"""Way of one cycle, as a share of what lies between the pseudo-feet."""
MOST_ARCHED = 1.9
"""How far the arch slants up at its ends at most [rad]: more than upright, it is an Ω."""
LIFT = 0.06
"""How high pseudo-feet are lifted, as a share of what lies between them."""
REST = 0.06
"""Share of a cycle for which both pseudo-feet stand, twice."""
SLOPES = 2049
"""Arches that are tried out beforehand."""
SMOOTH = 0.5
"""Corners of the course are spread over this share of the body."""
LEAD = 0.25
"""The track is ahead of the character frame by this share of the body, and bends no sharper than with this radius."""
LOOK = 0.7
"""How far the head turns toward where the course looks, beyond what carries it, 0 … 1."""


@dataclass(frozen=True, eq=False)
class Arch:
    """The pieces between the pseudo-feet, that arch in a plane."""

    lengths: Array
    """From the front to the rear [m], shape (piece,)."""
    rises: Array
    """By what angle they go up to the front at rest [rad], shape (piece,)."""

    @cached_property
    def shape(self) -> Array:
        """How much each piece slants in an arch that slants by 1, shape (piece,)."""
        ends = np.cumsum(self.lengths)
        from_rear = 1.0 - (ends - 0.5 * self.lengths) / ends[-1]
        return np.sin(2.0 * np.pi * from_rear)

    def _span(self, slants: Array) -> tuple[Array, Array]:
        """Return how far arches reach [m] and by what angle their ends go up to the front [rad], shape (n,)."""
        angles = self.rises + slants[:, None] * self.shape
        over, up = (self.lengths * np.cos(angles)).sum(axis=1), (self.lengths * np.sin(angles)).sum(axis=1)
        return np.hypot(over, up), np.arctan2(up, over)

    @cached_property
    def _tried(self) -> tuple[Array, Array]:
        """Slants, and how far arches reach that slant so, never farther than flatter ones."""
        slants = np.linspace(0.0, MOST_ARCHED, SLOPES)
        return slants, np.minimum.accumulate(self._span(slants)[0])

    @property
    def longest(self) -> float:
        """How far the body reaches at rest [m]."""
        return float(self._tried[1][0])

    @property
    def shortest(self) -> float:
        """How far it reaches when it arches most [m]."""
        return float(self._tried[1][-1])

    def over(self, spans: Array, climbs: Array) -> Array:
        """Return by what angle pieces go up to the front in arches between ends.

        Args:
            spans: Distance of the ends [m], shape (frame,).
            climbs: By what angle the front end is higher [rad], shape (frame,).
        """
        slants, reach = self._tried
        slant = np.interp(-spans, -reach, slants)
        _, own = self._span(slant)
        return self.rises + slant[:, None] * self.shape + (climbs - own)[:, None]


@dataclass(frozen=True, eq=False)
class PseudoFoot:
    """A point of the line that stands on the ground, and the pieces beside it that lie flat as it does."""

    point: int
    """Between the arch and the foot."""
    sole: int | None
    """The piece that is the foot; None where only the point stands."""
    start: float
    """Where it stands at the start, along the ground [m]."""
    phase: float
    """When in the cycle its step begins, 0 … 1."""


@dataclass(frozen=True, eq=False)
class Inchworm:
    """A short crawling body on its course, ready to be evaluated."""

    line: Line
    track: Track
    arch: Arch
    front: PseudoFoot
    rear: PseudoFoot
    along: Array
    """How far the ground is from the start, up and down, at the ways of the track [m], rising, shape (point,)."""
    slopes: Array
    """By what angle the ground goes up there [rad], shape (point,)."""
    stride: float
    """Way of one cycle [m]."""
    lift: float
    """How high pseudo-feet are lifted [m]."""
    warnings: tuple[str, ...]

    @property
    def wanted(self) -> tuple[tuple[int, bool, bool], ...]:
        """For each goal its body, and whether it has a place and a turn."""
        return wanted_of(self.line.posed)

    def standing(self, times: Array) -> Flags:
        """Return whether the front and the rear pseudo-foot stand, shape (frame, 2)."""
        steps = np.stack([self._step(times, foot)[1] for foot in (self.front, self.rear)], axis=-1)
        return (steps <= 0.0) | (steps >= 1.0)

    def evaluate(self, times: Array, carried: Array | None = None) -> Goals:
        """Return goals for a batch of frames; see `Moving`."""
        line = self.line
        front, front_heading, front_slope = self._placed(times, self.front)
        rear, rear_heading, rear_slope = self._placed(times, self.rear)
        away = front - rear
        heading, first, last = heading_of(away), self.front.point, self.rear.point
        rises = self.arch.over(quat.length(away), rise_of(away))
        turns = np.empty((len(times), len(line), 4))
        between = np.arange(first, last)
        turns[:, between] = line.turned(between, np.repeat(heading[:, None], len(between), axis=1), rises)
        turns[:, last:] = _flat(rear_heading if self.rear.sole is not None else heading, rear_slope)[:, None]
        held = front_heading if self.front.sole is not None else heading
        turns[:, :first] = _flat(held, front_slope)[:, None]
        turns[:, : line.lying[0]] = self._looking(times, held, front_slope)
        points = line.along(turns, last, rear)
        root, posed = line.goals(turns, points)
        return goals_of(line.posed, root, posed, carried)

    def floors(self, times: Array) -> Array:
        """Return how high the ground is that carries the body [m], shape (frame,); see `Moving`."""
        front, rear = (self.track.at(self._way(times, foot)[0])[:, 2] for foot in (self.front, self.rear))
        share = self.rear.start / (self.rear.start - self.front.start)
        return rear + share * (front - rear)

    def _way(self, times: Array, foot: PseudoFoot) -> tuple[Array, Array]:
        """Return where on the track a pseudo-foot is [m], and the share of its present step, each (frame,)."""
        whole, share = self._step(times, foot)
        along = foot.start + self.stride * (whole + eased(share))
        return np.interp(along, self.along, self.track.ways), share

    def _step(self, times: Array, foot: PseudoFoot) -> tuple[Array, Array]:
        """Return how many steps a pseudo-foot has made, and the share of the present one, each (frame,)."""
        cycles = self.track.along(self.along, self.track.way(times)) / self.stride - foot.phase
        whole = np.floor(cycles)
        share = (cycles - whole - 0.5 * REST) / (0.5 - REST)
        return whole, np.clip(share, 0.0, 1.0)

    def _placed(self, times: Array, foot: PseudoFoot) -> tuple[Array, Array, Array]:
        """Return where a pseudo-foot is [m], (frame, 3), its heading and by how much it goes up [rad], (frame,)."""
        ways, share = self._way(times, foot)
        places, headings = self.track.at(ways), self.track.heading(ways)
        slopes = self.track.along(self.slopes, ways)
        places[:, 2] += self.line.points[foot.point, 2] + self.lift * 16.0 * (share * (1.0 - share)) ** 2
        return places, headings, slopes

    def _looking(self, times: Array, held: Array, slope: Array) -> Array:
        """Return the turns of what is raised in front, from the front pseudo-foot's to where the course looks."""
        count = self.line.lying[0]
        _, headings = self.track.course.at(times)
        away = np.mod(headings - held + np.pi, 2.0 * np.pi) - np.pi
        share = LOOK * (count - np.arange(count)) / max(count, 1)
        return _flat(held[:, None] + share * away[:, None], np.repeat(slope[:, None], count, axis=1))


def _flat(headings: Array, slopes: Array) -> Array:
    """Return the turns from rest of what lies on the ground, (..., 4)."""
    return quat.multiply(quat.from_axis_angle(UP, headings), quat.from_axis_angle(LEFT, -slopes))


def prepare(line: Line, course: Course, settings: GaitSettings, ground: Ground | None) -> Inchworm:
    """Return how a short body crawls along a course; arguments as for `crawling.prepare`."""
    first, last = line.lying
    pieces = last - first
    # Four pieces and more have feet that lie flat; fewer arch as a whole, between the points at their ends.
    front = first + 1 if pieces >= 4 else first
    rear = last - 1 if pieces >= 3 else last
    arch = Arch(line.lengths[front:rear], line.rises[front:rear])
    stride = min(settings.stride * STRIDE * arch.longest, 0.98 * (arch.longest - arch.shortest))
    track = find_track(course, 2.0 * line.length, SMOOTH * line.length, LEAD * line.length, ground)
    steps = np.diff(track.points, axis=0)
    gone = np.concatenate([[0.0], np.cumsum(quat.length(steps))])
    slopes = np.append(settings.tilt * rise_of(steps), 0.0)
    along = gone - float(track.along(gone, np.array(track.start)))
    # How far points lie behind the front end when the line is straight but for its ups and downs.
    behind = np.concatenate([[0.0], np.cumsum(line.lengths * np.cos(line.rises))])
    origin = float(np.interp(line.origin, line.ways, behind))
    feet = [
        PseudoFoot(point, sole, origin - float(behind[point]), phase)
        for point, sole, phase in (
            (front, front - 1 if front > first else None, 0.5),
            (rear, rear if rear < last else None, 0.0),
        )
    ]
    lift = settings.step_height * LIFT * arch.longest
    return Inchworm(line, track, arch, feet[0], feet[1], along, slopes, stride, lift, tuple(told(track, line.length)))
