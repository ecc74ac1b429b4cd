"""How fast the legs go: from the way of a body to the phase of its gait, on a fine grid over time.

The phase is the integral of the frequency over the way, so it depends on the course alone. When the body comes to a
stand, the cycle goes on slowly for about one more time, in which each foot is put where the body stands, and waits
where a foot is about to leave the ground.
"""

from dataclasses import dataclass

import numpy as np

from ... import smoothing
from ...arrays import Array, Flags
from ..course import Course
from ..patterns.pattern import Pattern
from ..settings import GaitSettings
from .legs import LegGroup
from .reaching import PASSES, Reach, room, spread

GRAVITY = 9.81
"""[m/s²]."""
STEP = 0.08
"""Of the grid [sqrt(hip height / gravity)]: a pendulum as long as the legs turns by about as many radians in it."""
MARGIN = 8.0
"""How much of the course counts before and after a clip, in the same unit: two cycles of a slow walk."""
MOST_SAMPLES = 20_000
SMOOTH = 0.8
"""Speeds are smoothed over this time to either side, in the same unit, before a gait is chosen by them."""
STANDING = 0.03
"""Slower than this, as a dimensionless speed, a body stands."""
READY = 0.03
"""A body waits so much of a cycle before its first foot leaves the ground, so it can start at once."""
ACROSS = 3.0
"""Longest stride to the side, as a share of how far the feet are apart."""
TURNING = 0.02
"""A body that turns by more than this in the time of `Drive.unit` does not stand [rad]."""
MOST_TURN = 1.2
"""Most that it turns in one cycle [rad]."""
IDLE = 0.25
"""Dimensionless speed whose frequency the last steps before standing have."""


@dataclass(frozen=True, eq=False)
class Drive:
    """A body's speeds over its course."""

    times: Array
    """The grid [s], shape (sample,)."""
    velocity: Array
    """Of the body as it sees it, +X left and -Y forward [m/s], shape (sample, 2)."""
    turning: Array
    """[rad/s], shape (sample,)."""
    unit: float
    """sqrt(hip height / gravity) of the first group [s]."""

    @classmethod
    def of(cls, course: Course, height: float) -> "Drive":
        """Return how a body with hips at ``height`` [m] goes along a course."""
        unit = float(np.sqrt(height / GRAVITY))
        margin, lasts = MARGIN * unit, float(course.times[-1] - course.times[0])
        # Steps count from the start, so that nothing changes where a course only gets longer.
        step = max(STEP * unit, (lasts + 2.0 * margin) / MOST_SAMPLES)
        times = course.times[0] - margin + step * np.arange(float(np.ceil((lasts + 2.0 * margin) / step)) + 1.0)
        velocity, turning = course.velocity(times)
        _, headings = course.at(times)
        cos, sin = np.cos(headings), np.sin(headings)
        x, y = velocity[:, 0], velocity[:, 1]
        return cls(times, np.stack([cos * x + sin * y, cos * y - sin * x], axis=-1), turning, unit)

    def speeds_at(self, homes: Array) -> Array:
        """Return how fast places of the body move over the ground [m/s], shape (place, 3) to (sample, place)."""
        x = self.velocity[:, :1] - self.turning[:, None] * homes[:, 1]
        y = self.velocity[:, 1:] + self.turning[:, None] * homes[:, 0]
        return np.hypot(x, y)

    def smoothed(self, values: Array) -> Array:
        """Return a curve over the grid without its jumps, shape (sample,)."""
        step = float(self.times[1] - self.times[0])
        return smoothing.moving_average(values, max(1, min(round(SMOOTH * self.unit / step), len(values) // 2)))


@dataclass(frozen=True, eq=False)
class Pace:
    """The gait of one group of legs over a course."""

    times: Array
    """The grid [s], shape (sample,)."""
    pattern: Pattern
    """At the speed of each sample."""
    speeds: Array
    """Dimensionless, smoothed, shape (sample,)."""
    frequency: Array
    """Of the cycle [1/s], shape (sample,)."""
    phase: Array
    """Of the cycle, rising by 1 in each, shape (sample,)."""
    waits: Flags
    """Where the cycle stands still, shape (sample,)."""
    low: Array
    """How far the hips are lowered for the strides [m], shape (sample,)."""
    idle: float
    """Frequency of the last steps before standing [1/s]."""
    hurried: float
    """By what factor strides had to be shortened at most, 1 where the legs are long enough."""


def own_speeds(drive: Drive, group: LegGroup, homes: Array) -> Array:
    """Return the dimensionless speed of a group of legs whose feet are at ``homes``, smoothed, shape (sample,)."""
    speed = drive.speeds_at(homes[list(group.legs)]).mean(axis=1)
    return drive.smoothed(speed) / np.sqrt(GRAVITY * group.height)


def first_pace(
    drive: Drive,
    group: LegGroup,
    speeds: Array,
    pattern: Pattern,
    idle: Pattern,
    settings: GaitSettings,
    reach: Reach,
    width: float,
) -> Pace:
    """Return the gait of the group that leads.

    Args:
        drive: The body's speeds.
        group: The longest legs.
        speeds: Of the group, dimensionless, shape (sample,).
        pattern: Of the group at these speeds.
        idle: Of the group at the speed `IDLE`, one sample.
        settings: Factors of the length of strides and of the body's movement.
        reach: How far the legs reach.
        width: How far left and right feet are apart [m].
    """
    metres = speeds * np.sqrt(GRAVITY * group.height)
    far = 2.0 * reach.farthest(settings.crouch) / pattern.duty.max(axis=1)
    share, duty = _aside(drive) / np.maximum(metres, 1e-9), pattern.duty.max(axis=1)
    most = np.minimum(far, _widest(share, duty, reach.farthest_aside(settings.crouch), width, group.length))
    wanted = metres / (settings.stride * pattern.stride * group.height)
    slowest = float(IDLE * np.sqrt(GRAVITY * group.height) / (idle.stride[0] * group.height))
    turning = drive.smoothed(np.abs(drive.turning))
    moving = (speeds > STANDING) | (turning * drive.unit > TURNING)
    frequency = np.where(moving, np.maximum(np.maximum(wanted, metres / most), turning / MOST_TURN), 0.0)
    phase = np.concatenate([[0.0], np.cumsum(np.diff(drive.times) * 0.5 * (frequency[1:] + frequency[:-1]))])
    ready = idle.triggers[0, 0] + idle.duty[0, 0] - READY
    for start in np.flatnonzero(np.diff(moving.astype(np.intp), prepend=1) < 0).tolist():
        more = 0.5 + (ready - phase[start] - 0.5) % 1.0
        done = np.clip(slowest * (drive.times - drive.times[start]), 0.0, more)
        rests = ~moving & (drive.times >= drive.times[start]) & (done < more)
        phase, frequency = phase + done, np.where(rests & (frequency == 0.0), slowest, frequency)
    hurried = float((metres / far / np.maximum(wanted, 1e-9))[moving].max(initial=1.0))
    stride = metres / np.maximum(frequency, slowest)
    half = 0.5 * stride * pattern.duty.max(axis=1)
    wider = 0.5 * spread(share * stride, np.array(width), np.array(group.length))
    # In the middle of a step the body is as low already as its style has it.
    bobs = settings.body * group.length * np.sqrt((pattern.waves**2).sum(axis=(-1, -2)))
    low = drive.smoothed(
        np.maximum(reach.lowering(half * np.sqrt(np.maximum(1.0 - share**2, 0.0)), half * share + wider) - bobs, 0.0)
    )
    return Pace(drive.times, pattern, speeds, frequency, phase, frequency == 0.0, low, slowest, hurried)


def _widest(share: Array, duty: Array, reach: float, width: float, length: float) -> Array:
    """Return the longest strides [m] that feet reach to the side, and with which they do not get far across each other.

    Args:
        share: How much of the way is to the side, shape (sample,).
        duty: The longest duty factor of the group, shape (sample,).
        reach: How far the legs reach to both sides [m].
        width: How far left and right feet are apart [m].
        length: Of the legs [m].
    """
    spare = 0.5 * (width - float(room(np.array(width), np.array(length))))
    most = np.minimum(2.0 * reach / duty, (reach + spare) / (0.5 * (duty + PASSES)))
    return np.minimum(most, ACROSS * width) / np.maximum(share, 1e-9)


def _aside(drive: Drive) -> Array:
    """Return how fast a body goes to a side [m/s], shape (sample,)."""
    return np.abs(drive.smoothed(drive.velocity[:, 0]))


def other_pace(first: Pace, group: LegGroup, speeds: Array, pattern: Pattern) -> Pace:
    """Return the gait of another group: its cycle is a simple ratio of the first one's (Hecker 2008 §4.2)."""
    ratio = float(group.ratio)
    return Pace(
        first.times,
        pattern,
        speeds,
        ratio * first.frequency,
        ratio * first.phase,
        first.waits,
        first.low,
        ratio * first.idle,
        first.hurried,
    )
