"""Cycles: where in its cycle a character is that goes, whatever carries it.

A cycle brings all that moves back to where it was, as the body itself sees it. A phase is counted in cycles from any
beginning, and rises by 1 in each; it stands still while the body does, unless that hovers.
"""

from math import lcm

import numpy as np

from ..arrays import Array
from ..locomotion.footless.floating import BEAT, Floating
from ..locomotion.footless.hopping import Hopping
from ..locomotion.footless.inchworm import Inchworm
from ..locomotion.footless.serpentine import Serpentine
from ..locomotion.moving import Moving
from ..locomotion.stepping.gait import Gait

SAMPLES, ROUNDS = 129, 2
"""So often the phase is looked at, each time in the interval that was found before."""


def phase_of(moving: Moving, times: Array) -> Array:
    """Return the phase of the cycle at times [s], shape (n,)."""
    if isinstance(moving, Gait):
        first = moving.paces[0]
        return np.interp(times, first.times, first.phase) / rounds_of(moving)
    if isinstance(moving, Serpentine):
        return (moving.track.way(times) - moving.track.start) / moving.wave
    if isinstance(moving, Inchworm):
        return moving.track.along(moving.along, moving.track.way(times)) / moving.stride
    if isinstance(moving, Hopping):
        course = moving.course
        sample = np.clip(np.searchsorted(course.times, times, side="right") - 1, 0, len(course) - 1)
        return moving.hops[sample] + moving.rates[sample] * (times - course.times[sample])
    assert isinstance(moving, Floating), f"nothing is known of the cycles of {type(moving).__name__}"
    return times * BEAT / np.sqrt(moving.size)


def rounds_of(moving: Gait) -> int:
    """Return after how many cycles of its first legs all are back: others go round more often by a simple ratio."""
    return lcm(*(group.ratio.denominator for group in moving.legs.groups))


def reached(moving: Moving, phase: float, low: float, high: float) -> float:
    """Return when the phase is reached, between two times before and after it [s]."""
    for _ in range(ROUNDS):
        times = np.linspace(low, high, SAMPLES)
        found = phase_of(moving, times)
        right = int(np.clip(np.searchsorted(found, phase), 1, SAMPLES - 1))
        low, high = float(times[right - 1]), float(times[right])
    before, after = phase_of(moving, np.array([low, high])).tolist()
    share = (phase - before) / (after - before) if after > before else 0.0
    return low + min(max(share, 0.0), 1.0) * (high - low)
