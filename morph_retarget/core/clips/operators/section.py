"""A section of a clip, or a clip that is held on beyond its ends."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...arrays import Array
from ..clip import Clip
from ..frames import Frames
from ..travel import Travel
from .aggregate import ClipAggregate, length_to


@dataclass(frozen=True, eq=False)
class Section(ClipAggregate):
    """What a clip shows from one frame to another, at the same times; where it has ended, its last frame."""

    first: float
    """[frames]"""
    last: float
    """[frames]; infinite for a section without end."""
    clip: Clip

    def __post_init__(self) -> None:
        self.checked(first_frame=self.first)
        if np.isnan(self.last) or self.last < self.first:
            raise self.refused(f"it ends at frame {self.last:g}, before it begins at {self.first:g}: end it later")

    @property
    def parts(self) -> tuple[Clip, ...]:
        """The clip."""
        return (self.clip,)

    @property
    def start(self) -> float:
        """First frame."""
        return self.first

    @property
    def length(self) -> float:
        """Frames that it has, 0 without end."""
        return length_to(self.first, self.last)

    def frame(self, times: Array) -> Frames:
        """Return frames at times, shape (n,)."""
        return self.clip.frame(self.held(times))

    def travel(self, times: Array) -> Travel:
        """Return where it has led at times, shape (n,), as seen from its own first frame."""
        return self.clip.travel(self.held(times)).since(self._from)

    @cached_property
    def _from(self) -> Travel:
        return self.clip.travel(np.array([self.first]))
