"""Pace: how far a cyclic motion has got over time, so that cycles of any length go in step.

The paper warps each cycle to its speed and blends from one to the next (Grünvogel 2003 eqs 15–23), so that feet drift
apart while two cycles of different lengths are blended. Here both follow one pace during a blend, which goes over from
the one to the other: phases agree at every frame.
"""

import math
from dataclasses import dataclass

import numpy as np

from ...arrays import Array
from ..clip import Clip
from ..frames import Frames
from ..operators.aggregate import ClipAggregate
from ..operators.envelope import risen
from ..travel import Travel


@dataclass(frozen=True, eq=False)
class Pace:
    """The phase of a cycle over time, in cycles; between its keys and beyond them it goes on evenly."""

    frames: Array
    """Rising, shape (key,)."""
    phases: Array
    """Rising, shape (key,)."""
    before: float
    """Cycles per frame up to the first key."""
    after: float
    """Cycles per frame from the last key on."""

    @classmethod
    def steady(cls, frame: float, phase: float, rate: float) -> "Pace":
        """Return one that has a phase at a frame and goes on evenly [cycles per frame]."""
        return cls(np.array([frame]), np.array([phase]), rate, rate)

    def at(self, frames: Array) -> Array:
        """Return phases at frames, shape (n,)."""
        inside = np.interp(frames, self.frames, self.phases)
        early, late = np.minimum(frames - self.frames[0], 0.0), np.maximum(frames - self.frames[-1], 0.0)
        return inside + self.before * early + self.after * late

    def rate(self, frame: float) -> float:
        """Return how fast it goes at a frame [cycles per frame]."""
        if frame < self.frames[0]:
            return self.before
        if frame >= self.frames[-1]:
            return self.after
        right = int(np.searchsorted(self.frames, frame, side="right"))
        step = self.frames[right] - self.frames[right - 1]
        return float((self.phases[right] - self.phases[right - 1]) / step)

    def reached(self, phase: float, frame: float) -> float:
        """Return the first frame, not before another one, at which a phase of the cycle is reached."""
        now = float(self.at(np.array([frame]))[0])
        wanted = phase + math.ceil(now - phase - 1e-9)
        if wanted >= self.phases[-1]:
            return max(float(self.frames[-1] + (wanted - self.phases[-1]) / self.after), frame)
        if wanted <= self.phases[0]:
            return max(float(self.frames[0] - (self.phases[0] - wanted) / self.before), frame)
        return max(float(np.interp(wanted, self.phases, self.frames)), frame)

    def going_over(self, frame: float, rate: float, lasts: float) -> "Pace":
        """Return one that goes over to another rate.

        Args:
            frame: From when on.
            rate: The rate that it comes to [cycles per frame].
            lasts: In how many frames.
        """
        kept = self.frames < frame
        steps = np.append(np.arange(0.0, lasts, 1.0), lasts) if lasts > 0.0 else np.zeros(1)
        now, start = self.rate(frame), float(self.at(np.array([frame]))[0])
        rates = now + (rate - now) * risen(0.5 * (steps[1:] + steps[:-1]), 0.0, lasts)
        phases = start + np.concatenate([[0.0], np.cumsum(rates * np.diff(steps))])
        return Pace(
            np.concatenate([self.frames[kept], frame + steps]),
            np.concatenate([self.phases[kept], phases]),
            self.before if kept.any() else now,
            rate,
        )


@dataclass(frozen=True, eq=False)
class Paced(ClipAggregate):
    """A cyclic motion without end that follows a pace."""

    pace: Pace
    cycle: Clip
    """Without end; starts at frame 0 and is the same again after each period, beside its travel."""
    period: float
    """Frames of it that one cycle takes."""
    zero: float
    """Frame of it at which a cycle begins."""
    first: float
    """From when on it is played."""

    @property
    def start(self) -> float:
        """From when on it is played."""
        return self.first

    @property
    def length(self) -> float:
        """Without end."""
        return 0.0

    @property
    def parts(self) -> tuple[Clip, ...]:
        """The cycle."""
        return (self.cycle,)

    @property
    def label(self) -> str:
        """How fast it goes in the end."""
        return f"Pace: a cycle in {1.0 / self.pace.after:.3g} frames"

    def frame(self, times: Array) -> Frames:
        """Return frames at times, shape (n,)."""
        return self.cycle.frame(self._own(self.held(times)))

    def travel(self, times: Array) -> Travel:
        """Return where it has led at times, shape (n,)."""
        own = self._own(np.concatenate([[self.first], self.held(times)]))
        way = self.cycle.travel(own)
        return way[1:].since(way[:1])

    def _own(self, times: Array) -> Array:
        """Return frames of the cycle, as many whole periods late as keep all of them after its start."""
        phases = self.pace.at(times)
        behind = np.floor(float(self.pace.at(np.array([self.first]))[0]))
        return self.zero % self.period + (phases - behind) * self.period
