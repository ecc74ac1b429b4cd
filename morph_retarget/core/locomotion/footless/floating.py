"""Bodies that hover: ghosts, bees, fishes, heads with wings.

They keep the height over the ground that they have at rest, rise and sink softly, and lean into where they are pulled,
as what flies by its own thrust has to: forward as it sets out, back as it stops, inward in turns.
"""

from dataclasses import dataclass, replace

import numpy as np

from ... import quat
from ...arrays import Array
from ...ground import Ground
from ...solve.goals import Goals
from ..course import Course
from ..moving import UP, goals_of, wanted_of
from ..settings import GaitSettings

GRAVITY = 9.81
"""[m/s²]."""
BOB = 0.035
"""How far it rises and sinks [sizes]."""
BEAT = 0.55
"""How often, for a body 1 m in size [1/s]; larger ones are slower as pendulums are."""
SMOOTH = 0.3
"""Over how long before and after a frame the pull is felt, for a body 1 m in size [s]."""
DRAG = 0.6
"""Going at a steady speed is leaned into like this much pull [1/s]."""
STEEPEST = np.radians(32.0)
"""It leans no further [rad]."""
GROUND_SMOOTH = 0.5
"""Over how much of its own size the ground is averaged."""
POINTS = 48
"""Where the ground is looked at within that. No two of them lie in one line across, so an edge is many small steps."""


def _disc() -> Array:
    """Return points spread evenly over a disc of radius 1, as seeds are in a sunflower, shape (point, 3)."""
    number = np.arange(POINTS) + 0.5
    far, angle = np.sqrt(number / POINTS), np.pi * (3.0 - np.sqrt(5.0)) * number
    return np.stack([far * np.cos(angle), far * np.sin(angle), np.zeros(POINTS)], axis=-1)


_DISC = _disc()


@dataclass(frozen=True, eq=False)
class Floating:
    """A hovering body on its course, ready to be evaluated."""

    root: int
    rest: Array
    """Place of the root's joint at rest [m], ground frame, shape (3,)."""
    middle: Array
    """Point about which it leans [m], shape (3,)."""
    size: float
    """Greatest extent [m]."""
    course: Course
    steady: Course
    """The same without its jumps."""
    settings: GaitSettings
    ground: Ground | None
    warnings: tuple[str, ...]

    @property
    def wanted(self) -> tuple[tuple[int, bool, bool], ...]:
        """For each goal its body, and whether it has a place and a turn."""
        return wanted_of((self.root,))

    def evaluate(self, times: Array, carried: Array | None = None) -> Goals:
        """Return goals for a batch of frames; see `Moving`."""
        places, headings = self.course.at(times)
        places[:, 2] = self._floor(places)
        turned = quat.from_axis_angle(UP, headings)
        turns = quat.multiply(self._leaning(times), turned)
        swing = np.sin(2.0 * np.pi * BEAT / np.sqrt(self.size) * times)
        middle = places + quat.rotate(turned, np.broadcast_to(self.middle, places.shape))
        middle[:, 2] += self.settings.body * BOB * self.size * swing
        root = middle + quat.rotate(turns, np.broadcast_to(self.rest - self.middle, places.shape))
        return goals_of((self.root,), root, turns[:, None], carried)

    def floors(self, times: Array) -> Array:
        """Return how high the ground is that the body hovers over [m], shape (frame,); see `Moving`."""
        return self._floor(self.course.at(times)[0])

    def _leaning(self, times: Array) -> Array:
        """Return the tilts into the pull, shape (frame, 4)."""
        span = SMOOTH * np.sqrt(self.size)
        before, here, after = (self.steady.at(times + shift)[0] for shift in (-span, 0.0, span))
        pull = (after - 2.0 * here + before) / span**2 + DRAG * (after - before) / (2.0 * span)
        pull[:, 2] = 0.0
        size = quat.length(pull)
        angle = STEEPEST * np.tanh(np.arctan(size / GRAVITY) / STEEPEST) * self.settings.tilt
        axis = quat.cross(np.broadcast_to(UP, pull.shape), pull) / np.maximum(size, 1e-9)[:, None]
        return quat.from_axis_angle(axis, angle)

    def _floor(self, places: Array) -> Array:
        """Return the height of the ground around places, softened, shape (frame,)."""
        if self.ground is None:
            return places[:, 2]
        around = places[:, None] + GROUND_SMOOTH * self.size * _DISC
        found = self.ground(around.reshape(-1, 3)).reshape(around.shape[:2])
        known = np.isfinite(found)
        count = np.where(known, 1.0 - (_DISC**2).sum(axis=-1), 0.0)
        total = (count * np.where(known, found, 0.0)).sum(axis=1)
        return np.where(known.any(axis=1), total / np.maximum(count.sum(axis=1), 1e-9), places[:, 2])


def prepare(
    root: int, points: Array, rest: Array, course: Course, settings: GaitSettings, ground: Ground | None
) -> Floating:
    """Return how a body hovers along a course.

    Args:
        root: The body that carries all others.
        points: All joints at rest [m], ground frame, shape (n, 3).
        rest: The root's joint [m], shape (3,).
        course: Where it goes.
        settings: Factors.
        ground: What it hovers over, None for a ground as high as the course.
    """
    size = max(float(np.ptp(points, axis=0).max()), 1e-3)
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    return Floating(root, rest, middle, size, course, without_jumps(course), settings, ground, ())


def without_jumps(course: Course) -> Course:
    """Return a course whose parts are put one after the other where it jumps."""
    if not course.cuts:
        return course
    shifts, whole = np.zeros_like(course.places), course
    for cut in course.cuts:
        place, _ = whole.at(course.times[cut : cut + 1] - 1e-9)
        shifts[cut:] = place[0] - course.places[cut]
        whole = replace(course, places=course.places + shifts)
    return replace(whole, cuts=())
