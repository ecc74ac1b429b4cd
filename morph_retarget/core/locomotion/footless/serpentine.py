"""Snakes: the body winds over the ground in waves that stand still on it, and every part follows the one before it.

The winding curve is fixed on the ground, so nothing slips sideways (Gray 1946, "lateral undulation"; Hirose 1993, whose
serpenoid curve it is near to). What is raised, a cobra's neck or a rattle, keeps its shape; the head looks ahead.
"""

from dataclasses import dataclass

import numpy as np

from ... import quat
from ...arrays import Array
from ...ground import Ground
from ...solve.goals import Goals
from ..course import Course
from ..moving import UP, goals_of, heading_of, rise_of, wanted_of
from ..settings import GaitSettings
from .line import Line
from .track import Track, on_ground, told
from .track import find as find_track

WAVES = 1.7
"""Waves along the body …"""
JOINTS = 5.0
"""… of which none is shorter than so many of its longest pieces."""
SLANT = np.radians(38.0)
"""How far the body slants off its course where it crosses it."""
TIGHT = 2.5
"""Where the course turns with a radius of less than so many amplitudes, the waves get flatter."""
ROUNDS = 5
"""Of fitting pieces to the curve; then they miss it by 1e-4 of their lengths or less, but in the tightest turns."""
STEEP = 0.2
"""No piece reaches over less of the ground than this share of its length."""
LEAD = 0.3
"""How far the track is ahead of the character frame [waves]; it bends no sharper than with this radius …"""
SMOOTH = 0.75
"""… and corners are spread over this length of it [waves]."""
LOOK = 1.2
"""The head looks where its frame does, but no further from where the body goes than about this [rad]."""


@dataclass(frozen=True, eq=False)
class Serpentine:
    """A snake on its course, ready to be evaluated."""

    line: Line
    track: Track
    curve: Array
    """The winding line on the ground at the ways of the track [m], shape (point, 3)."""
    wave: float
    """Length of a wave on the course [m]."""
    forth: float
    """How far the course goes while the winding line goes 1 m."""
    warnings: tuple[str, ...]

    @property
    def wanted(self) -> tuple[tuple[int, bool, bool], ...]:
        """For each goal its body, and whether it has a place and a turn."""
        return wanted_of(self.line.posed)

    def evaluate(self, times: Array, carried: Array | None = None) -> Goals:
        """Return goals for a batch of frames; see `Moving`."""
        line, (first, last) = self.line, self.line.lying
        start = self.track.way(times) + self.forth * (line.origin - line.ways[first])
        points = self._laid(start)
        steps = points[:, :-1] - points[:, 1:]
        headings, rises = heading_of(steps), rise_of(steps)
        turns = np.empty((len(times), len(line), 4))
        turns[:, first:last] = line.turned(np.arange(first, last), headings, rises)
        turns[:, :first] = self._raised(times, start, headings[:, 0])
        turns[:, last:] = turns[:, last - 1 : last]
        root, posed = line.goals(turns, line.along(turns, first, points[:, 0]))
        return goals_of(line.posed, root, posed, carried)

    def floors(self, times: Array) -> Array:
        """Return how high the ground is that carries the body [m], shape (frame,); see `Moving`."""
        line, (first, last) = self.line, self.line.lying
        behind = self.forth * (line.ways[first : last + 1] - line.origin)
        under = self.track.along(self.curve[:, 2], self.track.way(times)[:, None] - behind)
        # A straight line through what lies on the ground, where the character frame is.
        fit = np.linalg.pinv(np.stack([np.ones_like(behind), behind], axis=-1))[0]
        return (under * fit).sum(axis=-1)

    def _laid(self, start: Array) -> Array:
        """Return where the points that lie on the ground are when the first is at ways ``start``, (frame, n, 3)."""
        line, (first, last) = self.line, self.line.lying
        lengths, high = line.lengths[first:last], line.points[first : last + 1, 2]
        gaps = np.broadcast_to(self.forth * lengths, (len(start), len(lengths)))
        points = self._at_gaps(start, gaps, high)
        for _ in range(ROUNDS):
            steps = np.diff(points, axis=1)
            over = np.hypot(steps[..., 0], steps[..., 1])
            wanted = np.sqrt(np.maximum(lengths**2 - steps[..., 2] ** 2, (STEEP * lengths) ** 2))
            gaps = gaps * np.clip(wanted / np.maximum(over, 1e-9), 0.5, 2.0)
            points = self._at_gaps(start, gaps, high)
        return points

    def _at_gaps(self, start: Array, gaps: Array, high: Array) -> Array:
        """Return points over the winding line that lie ``gaps`` behind each other [m]."""
        ways = np.concatenate([start[:, None], start[:, None] - np.cumsum(gaps, axis=1)], axis=1)
        points = self.track.along(self.curve, ways)
        points[..., 2] += high
        return points

    def _raised(self, times: Array, start: Array, heading: Array) -> Array:
        """Return the turns of what is raised in front: from where the body points to where the head looks."""
        count = self.line.lying[0]
        goes = self.track.heading(start)
        _, own = self.track.course.at(times)
        # For small angles it is these themselves; for a frame that looks backward it is none again.
        looks = goes + LOOK * np.sin(own - goes) + 0.5 * (1.0 - LOOK) * np.sin(2.0 * (own - goes))
        share = (count - np.arange(count)) / max(count, 1)
        # Both ends may be counted by whole turns more or less.
        away = np.mod(looks - heading + np.pi, 2.0 * np.pi) - np.pi
        return quat.from_axis_angle(UP, heading[:, None] + share * away[:, None])


def prepare(line: Line, course: Course, settings: GaitSettings, ground: Ground | None) -> Serpentine:
    """Return how a snake follows a course; arguments as for `crawling.prepare`."""
    first, last = line.lying
    lying = float(line.lengths[first:last].sum())
    slant = settings.width * np.tan(SLANT)
    phase = np.linspace(0.0, 2.0 * np.pi, 256, endpoint=False)
    forth = float(1.0 / np.hypot(1.0, slant * np.cos(phase)).mean())
    wave = settings.stride * forth * max(lying / WAVES, JOINTS * float(line.lengths[first:last].max()))
    reach = line.length + wave
    track = find_track(course, reach, SMOOTH * wave, LEAD * wave, ground)
    curve = _wound(track, wave, slant * wave / (2.0 * np.pi), ground)
    return Serpentine(line, track, curve, wave, forth, tuple(told(track, line.length)))


def _wound(track: Track, wave: float, amplitude: float, ground: Ground | None) -> Array:
    """Return the winding line that goes along a track, shape (point, 3)."""
    bent = np.gradient(track.headings, track.spacing)
    flatter = 1.0 + (TIGHT * amplitude * bent) ** 2
    aside = amplitude / flatter * np.sin(2.0 * np.pi * (track.ways - track.start) / wave)
    left = np.stack([np.cos(track.headings), np.sin(track.headings), np.zeros(len(aside))], axis=-1)
    return on_ground(track.points + aside[:, None] * left, ground)
