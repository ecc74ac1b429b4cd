"""The course of a body: a frame on the ground over time, from speeds, along a line, or from what moves it already.

Between samples it goes along the arc of a circle, or straight, with the speed and the turn rate that lead from one to
the next as the body itself sees them. So a few samples of a steady walk in a circle are that circle.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..arrays import Array, Indices
from ..errors import MotionError
from .polyline import last_known, smoothed

STEP = 0.05
"""Courses from speeds and along lines are sampled at least this often [s] …"""
TURN = 0.25
"""… and each time that they turn by this much [rad]."""
SUDDEN = 5.0
"""A step is a jump when it is longer by this factor than all steps near it …"""
NEAR = 3
"""… which are this many to either side …"""
SUDDEN_TURN = np.radians(60.0)
"""… or turns by more than this, likewise [rad]."""


@dataclass(frozen=True, eq=False)
class Course:
    """Where a body goes: a frame on the ground over time, in the ground frame."""

    times: Array
    """[s], rising, shape (sample,)."""
    places: Array
    """Where the origin of the character frame stands [m], shape (sample, 3); z is its own height over the ground."""
    headings: Array
    """Turn about up [rad], unwrapped; 0 looks along -Y; shape (sample,)."""
    cuts: tuple[int, ...] = ()
    """Samples to which it jumps: it does not go there from the sample before."""

    def __post_init__(self) -> None:
        shapes = (self.times.shape, self.places.shape, self.headings.shape)
        count = self.times.size
        if shapes != ((count,), (count, 3), (count,)):
            raise MotionError(f"times, places and headings of the course have shapes {shapes}: give each sample one")
        _check_times(self.times)
        _check_finite("places", self.places)
        _check_finite("headings", self.headings)
        if np.abs(np.diff(self.headings)).max(initial=0.0) > np.pi + 1e-9:
            raise MotionError("the course turns by more than half a turn between two samples: give it more samples")
        if any(not 0 < cut < count for cut in self.cuts):
            raise MotionError(f"the course jumps at samples {self.cuts}: choose from 1 to {count - 1}")

    def __len__(self) -> int:
        return len(self.times)

    def at(self, times: Array) -> tuple[Array, Array]:
        """Return places [m], shape (n, 3), and headings [rad], shape (n,), at times [s], shape (n,).

        Before its first and after its last sample it goes on as it goes there. Up to a jump it goes on as before it.
        """
        sample, since = self._since(times)
        return self._gone(sample, since), self.headings[sample] + self._pieces[1][sample] * since

    def velocity(self, times: Array) -> tuple[Array, Array]:
        """Return velocities [m/s], shape (n, 3), and turn rates [rad/s], shape (n,), at times [s], shape (n,).

        At a sample they are those of what follows it; a jump is no movement.
        """
        sample, since = self._since(times)
        speeds, rates = self._pieces
        level = _turned(speeds[sample, :2], self.headings[sample] + rates[sample] * since)
        return np.column_stack([level, speeds[sample, 2]]), rates[sample]

    def _since(self, times: Array) -> tuple[Indices, Array]:
        """Return the sample from which the course goes to each time, and how long after it that is [s]."""
        sample = np.clip(np.searchsorted(self.times, times, side="right") - 1, 0, len(self) - 1)
        return sample, times - self.times[sample]

    def _gone(self, samples: Indices, since: Array) -> Array:
        """Return where it is some time [s] after samples as it goes there [m], shape (n, 3)."""
        speeds, rates = self._pieces
        speeds, heading = speeds[samples], self.headings[samples]
        level = _turned(_arc(speeds[:, :2] * since[:, None], rates[samples] * since), heading)
        return self.places[samples] + np.column_stack([level, speeds[:, 2] * since])

    @cached_property
    def _pieces(self) -> tuple[Array, Array]:
        """Velocity after each sample as the body sees it there [m/s], (sample, 3), and turn rate [rad/s], (sample,)."""
        goes = np.ones(len(self), dtype=np.bool_)
        goes[[-1, *(cut - 1 for cut in self.cuts)]] = False
        if not goes.any():
            return np.zeros((len(self), 3)), np.zeros(len(self))
        away, turned, lasts = np.diff(self.places, axis=0), np.diff(self.headings), np.diff(self.times)
        level = _unarc(_turned(away[:, :2], -self.headings[:-1]), turned)
        speeds = np.column_stack([level, away[:, 2]]) / lasts[:, None]
        source = last_known(goes)
        return speeds[source], (turned / lasts)[source]


# --- ways to make one ---


def from_speed(times: Array, speed: Array, turn_rate: Array, direction: Array | float = 0.0) -> Course:
    """Return the course of a body that starts where it stands; between the times, all values change evenly.

    Args:
        times: [s], rising, shape (n,).
        speed: [m/s], shape (n,) or one for all.
        turn_rate: To the left [rad/s], shape (n,) or one for all.
        direction: Where it goes, as it sees it: angle to the left of straight ahead [rad], shape (n,) or one for all.

    Raises:
        MotionError: Times do not rise, or numbers are not finite.
    """
    _check_times(times)
    speed, turn_rate, direction = (np.broadcast_to(v, times.shape) for v in (speed, turn_rate, direction))
    for name, values in (("speed", speed), ("turn rate", turn_rate), ("direction", direction)):
        _check_finite(name, values)
    lasts = np.diff(times)
    turned = lasts * np.maximum(np.abs(turn_rate[1:]), np.abs(turn_rate[:-1]))
    fine = _refined(times, np.maximum(lasts / STEP, turned / TURN))
    speed, turn_rate, direction = (np.interp(fine, times, v) for v in (speed, turn_rate, direction))
    lasts, middle = np.diff(fine), _between(direction)
    turns = _between(turn_rate) * lasts
    headings = np.concatenate([[0.0], np.cumsum(turns)])
    ahead = np.column_stack([np.sin(middle), -np.cos(middle)]) * (_between(speed) * lasts)[:, None]
    steps = _turned(_arc(ahead, turns), headings[:-1])
    places = np.zeros((len(fine), 3))
    places[1:, :2] = np.cumsum(steps, axis=0)
    return Course(fine, places, headings)


def along(
    points: Array, times: Array, speed: Array, closed: bool = False, smoothing: float = 0.3, start: float = 0.0
) -> Course:
    """Return the course of a body along a line, looking where the line leads.

    On an open line it stops at the end, on a closed one it goes round and round; at a speed below 0 it goes backward.

    Args:
        points: Corners of the line [m], shape (point, 3) or (point, 2), in the ground frame.
        times: [s], rising, shape (n,).
        speed: Along the line [m/s], shape (n,) or one for all; it changes evenly between the times.
        closed: Whether the last point leads back to the first.
        smoothing: Length of the line over which a corner is spread [m]; 0 keeps it sharp.
        start: Where on the line it is at the first time [m].

    Raises:
        MotionError: The points make no line, times do not rise, or numbers are not finite.
    """
    _check_times(times)
    speed = np.broadcast_to(speed, times.shape)
    _check_finite("speed", speed)
    line = smoothed(points, closed, smoothing)
    lasts = np.diff(times)
    way = lasts * np.maximum(np.abs(speed[1:]), np.abs(speed[:-1]))
    corner = max(smoothing, 1e-3 * line.length)
    fine = _refined(times, np.maximum(lasts / STEP, way / (0.25 * corner)))
    steps = _between(np.interp(fine, times, speed)) * np.diff(fine)
    places, headings = line.at(start + np.concatenate([[0.0], np.cumsum(steps)]))
    return Course(fine, places, headings)


def from_frames(times: Array, matrices: Array, least_jump: float = 0.25) -> Course:
    """Return the course of a body that something moves already.

    Args:
        times: [s], rising, shape (n,).
        matrices: How its character frame is moved from the start, rigid, in the ground frame, shape (n, 4, 4).
        least_jump: Shorter steps are no jumps [m].

    Raises:
        MotionError: Times do not rise, or numbers are not finite.
    """
    _check_times(times)
    _check_finite("matrices", matrices)
    # The turn about up that is part of any turn: it knows its way until a body lies on its back.
    sine, cosine = matrices[:, 1, 0] - matrices[:, 0, 1], matrices[:, 0, 0] + matrices[:, 1, 1]
    upright = np.hypot(sine, cosine) > 1e-6
    if upright.any():
        known = last_known(upright)
        sine, cosine = sine[known], cosine[known]
    headings = np.unwrap(np.arctan2(sine, cosine))
    places = matrices[:, :3, 3].copy()
    step = np.sqrt((np.diff(places, axis=0) ** 2).sum(axis=1))
    sudden = (step > least_jump) & _stands_out(step)
    turned = np.abs(np.diff(headings))
    sudden |= (turned > SUDDEN_TURN) & _stands_out(turned)
    return Course(times, places, headings, tuple((np.flatnonzero(sudden) + 1).tolist()))


def _stands_out(steps: Array) -> Array:
    """Return whether each step is much longer than those near it, shape (step,)."""
    around = np.pad(steps, NEAR)
    near = np.stack([around[i : i + len(steps)] for i in range(2 * NEAR + 1) if i != NEAR])
    return steps > SUDDEN * near.max(axis=0)


def _refined(times: Array, parts: Array) -> Array:
    """Return times with each interval cut into as many equal parts as asked for, at least one."""
    counts = np.maximum(np.ceil(parts - 1e-9), 1.0).astype(np.intp)
    interval = np.repeat(np.arange(len(counts)), counts)
    place = np.arange(len(interval)) - np.repeat(np.cumsum(counts) - counts, counts)
    fine = times[interval] + np.diff(times)[interval] * (place / counts[interval])
    return np.append(fine, times[-1:])


def _between(values: Array) -> Array:
    return 0.5 * (values[1:] + values[:-1])


# --- arcs ---


def _turned(vectors: Array, angles: Array) -> Array:
    """Return vectors on the ground turned to the left, shapes (n, 2) and (n,)."""
    sine, cosine = np.sin(angles), np.cos(angles)
    x, y = vectors[:, 0], vectors[:, 1]
    return np.column_stack([cosine * x - sine * y, sine * x + cosine * y])


def _arc(ways: Array, turns: Array) -> Array:
    """Return where arcs lead that set out along ``ways``, are as long, and turn by ``turns`` [rad]; (n, 2), (n,)."""
    return _turned(ways, 0.5 * turns) * np.sinc(turns / (2.0 * np.pi))[:, None]


def _unarc(chords: Array, turns: Array) -> Array:
    """Return the ways of arcs that lead along ``chords``; turns are half a turn at most."""
    return _turned(chords, -0.5 * turns) / np.sinc(turns / (2.0 * np.pi))[:, None]


# --- what is refused ---


def _check_times(times: Array) -> None:
    if len(times) == 0:
        raise MotionError("the course has no times: give it at least one")
    _check_finite("times", times)
    falls = np.flatnonzero(np.diff(times) <= 0.0)
    if len(falls):
        i = int(falls[0])
        raise MotionError(
            f"the times of the course must rise, but {times[i + 1]:g} s follows {times[i]:g} s: sort them"
        )


def _check_finite(name: str, values: Array) -> None:
    if not np.isfinite(values).all():
        row = int(np.flatnonzero(~np.isfinite(np.reshape(values, (len(values), -1))).all(axis=1))[0])
        raise MotionError(f"the course's {name} at sample {row} are no finite numbers: mend the curve or the speed")
