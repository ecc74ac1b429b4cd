"""Revert, Grünvogel 2003 §5.3.4."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...arrays import Array
from ..clip import Clip
from ..frames import Frames
from ..travel import Travel
from .aggregate import ClipAggregate


@dataclass(frozen=True, eq=False)
class Revert(ClipAggregate):
    """A clip played backward from one of its frames to its first (eqs. 6 and 7).

    Frame t1 is the first that it shows, still at t1, and the clip's first its last, at 2 t1 - t0. Where t1 is outside
    of the clip, the clip stays as it is.
    """

    turning: float
    """Frame of the clip from which it goes back, t1."""
    clip: Clip

    def __post_init__(self) -> None:
        self.checked(turning=self.turning)

    @property
    def parts(self) -> tuple[Clip, ...]:
        """The clip."""
        return (self.clip,)

    @property
    def reverts(self) -> bool:
        """Whether the frame from which it goes back is within the clip."""
        return self.clip.start <= self.turning <= self.clip.end

    @property
    def start(self) -> float:
        """First frame."""
        return self.turning if self.reverts else self.clip.start

    @property
    def length(self) -> float:
        """Frames that it has; never without end where it reverts."""
        return self.turning - self.clip.start + 1.0 if self.reverts else self.clip.length

    def frame(self, times: Array) -> Frames:
        """Return frames at times, shape (n,)."""
        return self.clip.frame(self._own(times))

    def travel(self, times: Array) -> Travel:
        """Return where it has led at times, shape (n,)."""
        way = self.clip.travel(self._own(times))
        return way.since(self._from) if self.reverts else way

    @cached_property
    def _from(self) -> Travel:
        return self.clip.travel(np.array([self.turning]))

    def _own(self, times: Array) -> Array:
        return 2.0 * self.turning - self.held(times) if self.reverts else times
