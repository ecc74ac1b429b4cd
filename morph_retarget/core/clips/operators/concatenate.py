"""Concatenate: one clip after the other, at the frames at which they fit best (Grünvogel 2003 §5.4)."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...arrays import Array, Flags
from ..clip import Clip
from ..frames import Frames
from ..travel import Travel
from . import likeness
from .aggregate import ClipAggregate
from .blend import Blend


@dataclass(frozen=True, eq=False)
class Concatenate(ClipAggregate):
    """A clip that goes over to another where the body is most alike, with the same feet on the ground.

    Among the last frames of the first clip and the first frames of the second those two are sought whose joints are
    nearest to each other and move most alike. If no two frames have the same feet on the ground, those are taken that
    differ in as few as can be. The blend lies about them, or as near to that as both clips reach.
    """

    first: Clip
    second: Clip
    window: float
    """Frames at the end of the first and at the beginning of the second among which is sought."""
    blend: float = 8.0
    """Frames in which it goes over."""

    def __post_init__(self) -> None:
        self.checked(window=self.window, blend=self.blend)
        if not self.first.is_finite:
            raise self.refused(f"{self.first.label!r} has no end to go on from: cut a section from it")
        if self.window < 0.0 or self.blend < 0.0:
            raise self.refused("window and blend must be 0 frames or more: change them")

    @property
    def parts(self) -> tuple[Clip, ...]:
        """Both clips."""
        return self.first, self.second

    @property
    def active(self) -> Flags:
        """Joints that either has."""
        return self.first.active | self.second.active

    @property
    def length(self) -> float:
        """Frames that it has, 0 when the second clip has no end."""
        return self.blended.length

    @cached_property
    def match(self) -> tuple[float, float]:
        """Frames of the first and of the second clip that fit best."""
        first, second = self.first, self.second
        tail = np.arange(first.end, max(first.end - self.window, first.start) - 1e-9, -1.0)
        head = np.arange(second.start, min(second.start + self.window, second.end) + 1e-9, 1.0)
        other_feet = likeness.standing_otherwise(first, tail, second, head)
        away = likeness.unlikeness(first, tail, second, head)
        away[other_feet > other_feet.min()] = np.inf
        row, column = np.unravel_index(int(away.argmin()), away.shape)
        return float(tail[row]), float(head[column])

    @cached_property
    def blended(self) -> Blend:
        """The same as a blend."""
        here, there = self.match
        before = max(0.5 * self.blend, self.blend - (self.first.end - here))
        before = min(before, there - self.second.start, here - self.first.start)
        begin = here - before
        start = here - (there - self.second.start)
        return Blend(self.start, start, begin, begin + self.blend, self.first, self.second)

    def frame(self, times: Array) -> Frames:
        """Return frames at times, shape (n,)."""
        return self.blended.frame(times)

    def travel(self, times: Array) -> Travel:
        """Return where it has led at times, shape (n,)."""
        return self.blended.travel(times)
