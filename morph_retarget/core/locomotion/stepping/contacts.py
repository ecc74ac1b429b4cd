"""When feet touch down and lift off: the cycles of each foot as times.

A foot's own cycle starts at its step trigger with the touch-down; it stands for the duty factor's share of the cycle
and flies for the rest (Hecker 2008 §4.2; Alexander 2003). Triggers and duty factors change with the speed; a foot's own
phase never runs backward all the same, so a foot whose trigger moves waits a little or hurries a little.
"""

from dataclasses import dataclass

import numpy as np

from ...arrays import Array, Flags, Indices
from .pace import Pace

SHORTEST = 0.12
"""Least share of a cycle that a foot flies for, whatever the changes of its gait."""
LAST_FLIGHT = 0.3
"""How long a foot still flies that is in the air when the course ends [idle cycles]."""


@dataclass(frozen=True, eq=False)
class Contacts:
    """The cycles of all feet, in order; those of feet with fewer than others are filled up with endless standing."""

    touch: Array
    """Start of each stance [s], shape (leg, cycle)."""
    lift: Array
    """Its end [s], shape (leg, cycle)."""
    counts: Indices
    """Cycles of each foot, shape (leg,)."""

    def cycles(self, times: Array) -> Indices:
        """Return the cycle that each foot is in, shape (frame,) to (frame, leg)."""
        found = [
            np.searchsorted(row[:count], times, side="right") - 1
            for row, count in zip(self.touch, self.counts.tolist(), strict=True)
        ]
        return np.maximum(np.stack(found, axis=-1), 0)

    def standing(self, times: Array) -> Flags:
        """Return which feet are on the ground, shape (frame,) to (frame, leg)."""
        return times[:, None] <= self.lift[np.arange(len(self.lift)), self.cycles(times)]


def of_feet(pace: Pace) -> list[tuple[Array, Array]]:
    """Return for each foot of a group the touch-down and lift-off of each of its cycles [s]."""
    duty, triggers = pace.pattern.duty, pace.pattern.triggers
    phases = pace.phase[:, None] - np.unwrap(triggers, period=1.0, axis=0)
    phases = np.maximum.accumulate(phases, axis=0)
    phases = _landed(pace, phases, duty)
    ends = np.maximum.accumulate(phases - duty, axis=0)
    return [_cycles(pace, phases[:, foot], ends[:, foot]) for foot in range(phases.shape[1])]


def cut(cycle: tuple[Array, Array], jump: float) -> tuple[Array, Array]:
    """Return a foot's touch-downs and lift-offs with the body's jump to elsewhere, at a time [s], between two of them.

    It stands until then, also where it would have flown, and from then on.
    """
    touch, lift = cycle
    k = int(np.searchsorted(touch, jump, side="right")) - 1
    if k < 0 or touch[k] == jump:
        return cycle
    if jump < lift[k]:
        return np.insert(touch, k + 1, jump), np.insert(lift, k, jump)
    touch, lift = touch.copy(), lift.copy()
    lift[k], touch[k + 1] = jump, jump
    return touch, lift


def together(cycles: list[tuple[Array, Array]]) -> Contacts:
    """Return the cycles of all feet as one table."""
    most = max(len(touch) for touch, _ in cycles)
    touch, lift = np.full((len(cycles), most), np.inf), np.full((len(cycles), most), np.inf)
    for row, (down, up) in enumerate(cycles):
        touch[row, : len(down)], lift[row, : len(up)] = down, up
    return Contacts(touch, lift, np.array([len(down) for down, _ in cycles]))


def _landed(pace: Pace, phases: Array, duty: Array) -> Array:
    """Return the phases with feet put down where the cycle waits: none is left in the air."""
    waits = np.flatnonzero(pace.waits)
    out = phases.copy()
    for start in waits[np.diff(waits, prepend=-2) > 1].tolist():
        landing = np.floor(out[start]) + 1.0
        flies = out[start] - (landing - 1.0) >= duty[start]
        # Who stands from the beginning has landed before.
        elapsed = pace.times[start:] - pace.times[start] if start else np.full(len(out), np.inf)
        landed = np.minimum(out[start] + pace.idle * elapsed[:, None], landing)
        out[start:] = np.where(flies, np.maximum(out[start:], landed), out[start:])
    return out


def _cycles(pace: Pace, phase: Array, end: Array) -> tuple[Array, Array]:
    """Return the touch-downs and lift-offs of one foot [s], each (cycle,)."""
    numbers = np.arange(float(np.floor(phase[0])), float(np.floor(phase[-1])) + 1.0)
    touch, lift = _crossings(pace.times, phase, numbers), _crossings(pace.times, end, numbers)
    if np.isfinite(lift[-1]):  # it lands after the grid's end
        touch, lift = np.append(touch, lift[-1] + LAST_FLIGHT / pace.idle), np.append(lift, np.inf)
    after = np.append(touch[1:], np.inf)
    flight = np.where(np.isfinite(after), SHORTEST * (after - touch), 0.0)
    return touch, np.minimum(np.maximum(lift, touch), after - flight)


def _crossings(times: Array, rising: Array, values: Array) -> Array:
    """Return when a curve first gets to each value: before the grid at its start, never if it does not."""
    right = np.searchsorted(rising, values, side="left")
    out = np.full(len(values), np.inf)
    inside = (right > 0) & (right < len(rising))
    at = right[inside]
    low, high = rising[at - 1], rising[at]
    share = (values[inside] - low) / np.maximum(high - low, 1e-300)
    out[inside] = times[at - 1] + share * (times[at] - times[at - 1])
    out[right == 0] = times[0]
    return out
