"""The way of a foot during its flight, in a normalized space that knows no size (Hecker 2008 §4.2).

Time runs from 0 at lift-off to 1 at touch-down, and so does the way from one plant to the next. Heights and turns are
shares of what the style asks for, so that one authored path serves all legs.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..arrays import Array
from ..errors import MotionError
from .moving import eased

CLIMB = 0.55
"""Share of a flight in which a foot gets up to a higher plant, or down to a lower one."""
WAITS = 0.25
"""Share for which it waits at most before it goes forward, and for which it has got there before the end."""
SAMPLES = 129
"""Of a path; between them it is straight."""


@dataclass(frozen=True, eq=False)
class FootPath:
    """A foot's flight, sampled evenly over its time."""

    along: Array
    """Share of the way to the next plant, 0 at the start and 1 at the end, shape (sample,)."""
    up: Array
    """Height over the straight way as a share of the style's lift, 0 at both ends, shape (sample,)."""
    side: Array
    """Distance to the outside [leg lengths], 0 at both ends, shape (sample,)."""
    pitch: Array
    """Turn of the toes downward beyond that of the foot's roll [rad], 0 at both ends, shape (sample,)."""

    @cached_property
    def swerves(self) -> bool:
        """Whether it leaves the straight way to a side."""
        return bool(self.side.any())

    @cached_property
    def _rows(self) -> Array:
        return np.stack([self.along, self.up, self.side, self.pitch], axis=-1)

    @cached_property
    def _steps(self) -> Array:
        return np.diff(self._rows, axis=0, append=self._rows[-1:])

    def at(self, flight: Array) -> Array:
        """Return way, height, side and pitch at times of the flight, shape (...) to shape (..., 4)."""
        place = np.clip(flight, 0.0, 1.0) * (len(self.along) - 1)
        left = place.astype(np.intp)
        return self._rows.take(left, axis=0) + (place - left)[..., None] * self._steps.take(left, axis=0)

    def over(self, flight: Array, early: Array, late: Array) -> Array:
        """Return way, height, side, pitch, and share of a climb up and of one down, at times of a flight, (..., 6).

        A foot goes up before it goes forward, and down after it, to clear the edges of steps.

        Args:
            flight: 0 … 1, shape (...).
            early: How much it goes up first, 0 … 1, shape (...) or broadcast to it.
            late: How much it goes down last, likewise.
        """
        out, most = self.at(flight), np.maximum(early, late)
        if most.any():
            waits = WAITS * early
            out[..., 0] = self.at((flight - waits) / (1.0 - waits - WAITS * late))[..., 0]
            steep = eased(np.minimum(flight, 1.0 - flight) / WAITS)
            out[..., 1] += most * np.maximum(steep - out[..., 1], 0.0)
        up, down = eased(flight / CLIMB), eased((flight - 1.0 + CLIMB) / CLIMB)
        up, down = out[..., 0] + early * (up - out[..., 0]), out[..., 0] + late * (down - out[..., 0])
        return np.concatenate([out, up[..., None], down[..., None]], axis=-1)


def arc(highest: float = 0.45, soft: float = 0.35) -> FootPath:
    """Return a flight that leaves and lands softly.

    Args:
        highest: Time at which the foot is highest, 0 … 1.
        soft: Share of the time in which the foot gets up to its speed, and in which it stops again, 0 … 0.5.
    """
    time = np.linspace(0.0, 1.0, SAMPLES)
    skewed = time ** (np.log(0.5) / np.log(highest))
    speed = eased(np.minimum(time, 1.0 - time) / soft)
    way = np.concatenate([[0.0], np.cumsum(speed[1:] + speed[:-1])])
    none = np.zeros(SAMPLES)
    return FootPath(way / way[-1], 16.0 * (skewed * (1.0 - skewed)) ** 2, none, none)


def drawn(along: Array, up: Array, side: Array, pitch: Array) -> FootPath:
    """Return a flight that an animator drew; its ends are put on the plants.

    Args:
        along: Share of the way at times spread evenly over the flight, shape (n,); the others likewise.
        up: Share of the lift.
        side: [leg lengths].
        pitch: [rad].

    Raises:
        MotionError: A curve is not finite, or comes back to where it left.
    """
    time, own = np.linspace(0.0, 1.0, SAMPLES), list[Array]()
    for name, curve in (("way", along), ("height", up), ("side", side), ("pitch", pitch)):
        if not np.isfinite(curve).all():
            raise MotionError(f"the {name} of the foot path is not a number everywhere: mend its curve")
        own.append(np.interp(time, np.linspace(0.0, 1.0, len(curve)), curve))
    length = own[0][-1] - own[0][0]
    if length < 1e-6:
        raise MotionError("the way of the foot path does not go forward: let its curve rise from 0 to 1")
    way = (own[0] - own[0][0]) / length
    return FootPath(way, *[curve - (curve[0] + time * (curve[-1] - curve[0])) for curve in own[1:]])


ARC = arc()
