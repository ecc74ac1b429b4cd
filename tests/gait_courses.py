"""Ways to walk and grounds to walk on, for characters of any size: lengths in hip heights, speeds dimensionless."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from morph_retarget.core.arrays import Array
from morph_retarget.core.ground import Ground
from morph_retarget.core.locomotion import course
from morph_retarget.core.locomotion.course import Course
from morph_retarget.core.locomotion.stepping.legs import Legs
from morph_retarget.core.locomotion.stepping.pace import GRAVITY

FAR = 14.0
"""Way of a course [hip heights]: a walk's eight cycles or more."""
RADIUS = 4.0
"""Of the ways that turn, beyond half of the body [hip heights]."""
CORNERS = 240
"""Of the figure of eight."""
RISE, TREAD, STAIRS, BEFORE = 0.2, 0.45, 5, 4.0
"""Of the stairs [hip heights], how many go up and down again, and how far before them a body starts."""
WAVES, ROUGH = 24, 0.05
"""Of the noisy hill: how many waves it is made of, and the height of each as a share of its length."""
LONG = 1.5, 8.0
"""Lengths of the waves [hip heights]."""


@dataclass(frozen=True)
class Size:
    """What of a body courses are made for."""

    height: float
    """Of the hips of its longest legs [m]."""
    reach: float
    """Farthest foot from the middle of the body [m]."""

    @classmethod
    def of(cls, legs: Legs) -> "Size":
        """Return that of a body with some legs."""
        return cls(legs.groups[0].height, max(float(np.hypot(leg.home[0], leg.home[1])) for leg in legs.legs))

    def speed(self, u: float) -> float:
        """Return a dimensionless speed in m/s."""
        return u * float(np.sqrt(GRAVITY * self.height))


@dataclass(frozen=True, eq=False)
class Trial:
    """A course over a ground."""

    course: Course
    steady: bool
    """Whether speed and turn rate are the same all along."""
    ground: Ground | None = None


def all_of(size: Size, u: float) -> Mapping[str, Trial]:
    """Return all courses for a body that goes at a dimensionless speed."""
    return {
        "straight": Trial(straight(size, u), steady=True),
        "circle": Trial(circle(size, u), steady=True),
        "figure-eight": Trial(figure_eight(size, u), steady=False),
        "stop-and-go": Trial(stop_and_go(size, u), steady=False),
        "sideways": Trial(straight(size, u, 0.5 * np.pi), steady=True),
        "stairs": Trial(straight(size, u), steady=False, ground=stairs(size)),
        "hill": Trial(straight(size, u), steady=False, ground=hill(size)),
    }


def straight(size: Size, u: float, direction: float = 0.0, far: float = FAR) -> Course:
    """Return a straight way; ``direction`` is the angle of travel to the left of where the body looks [rad]."""
    speed = size.speed(u)
    return course.from_speed(np.array([0.0, far * size.height / speed]), np.array(speed), np.zeros(()), direction)


def circle(size: Size, u: float) -> Course:
    """Return a way round to the left."""
    speed, radius = size.speed(u), RADIUS * size.height + size.reach
    times = np.array([0.0, FAR * size.height / speed])
    return course.from_speed(times, np.array(speed), np.array(speed / radius))


def figure_eight(size: Size, u: float) -> Course:
    """Return a way round to the left and then round to the right."""
    radius = RADIUS * size.height + size.reach
    angle = np.linspace(0.0, 2.0 * np.pi, CORNERS, endpoint=False)
    line = 1.5 * radius * np.stack([np.sin(angle) * np.cos(angle), -np.sin(angle)], axis=-1)
    speed = size.speed(u)
    times = np.array([0.0, 2.0 * FAR * size.height / speed])
    return course.along(line, times, np.array(speed), closed=True, smoothing=size.height)


def stop_and_go(size: Size, u: float) -> Course:
    """Return a way that sets out from a stand, stops suddenly, sets out suddenly and stops at last."""
    speed = size.speed(u)
    whole = FAR * size.height / speed
    shares = np.array([0.0, 0.1, 0.2, 0.45, 0.45001, 0.6, 0.60001, 0.8, 0.85, 1.0])
    speeds = np.array([0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0])
    return course.from_speed(shares * whole, speed * speeds, np.zeros(()))


def standing(seconds: float) -> Course:
    """Return no way at all."""
    return course.from_speed(np.array([0.0, seconds]), np.zeros(()), np.zeros(()))


# --- grounds ---


def stairs(size: Size) -> Ground:
    """Return stairs that go up and down again across the straight way."""
    ends = (BEFORE + TREAD * np.arange(2 * STAIRS)) * size.height
    steps = np.repeat([RISE * size.height, -RISE * size.height], STAIRS)

    def height(points: Array) -> Array:
        return ((-points[:, 1:2] > ends) * steps).sum(axis=1)

    return height


def hill(size: Size, seed: int = 5) -> Ground:
    """Return a noisy hill that begins level under the body."""
    rng = np.random.default_rng(seed)
    lengths = np.geomspace(*LONG, WAVES) * size.height
    turns, phases = rng.uniform(0.0, 2.0 * np.pi, (2, WAVES))
    waves = np.stack([np.cos(turns), np.sin(turns)]) * 2.0 * np.pi / lengths
    high = ROUGH * lengths / np.sqrt(WAVES)

    def height(points: Array) -> Array:
        return ((np.sin(points[:, :2] @ waves + phases) - np.sin(phases)) * high).sum(axis=1)

    return height
