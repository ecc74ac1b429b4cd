"""Blend, Grünvogel 2003 §5.3.6."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...arrays import Array, Flags
from ..clip import Clip
from ..frames import Frames
from ..travel import Travel
from . import ways
from .aggregate import ClipAggregate, length_to
from .envelope import risen
from .rows import mingled
from .ways import Way


@dataclass(frozen=True, eq=False)
class Blend(ClipAggregate):
    """A clip on its way to another (eq. 12, figure 3).

    The paper demands tA ≤ ts ≤ tB ≤ te (eq. 11), and then needs a second clip that has begun long before (eq. 23). So
    all that is demanded here is tA ≤ ts ≤ te and tB ≤ te. A clip holds its first and its last frame where it has not
    begun or is over. Joints that only one of them has are that one's throughout; the way over the ground is the root
    joint's and feet are the joints that they are.

    While it blends, steps over the ground are mixed and summed; from there the second clip leads on its own way.
    """

    first_start: float
    """New first frame of the first clip, tA."""
    second_start: float
    """New first frame of the second clip, tB."""
    begin: float
    """Last frame of the first clip alone, ts."""
    finish: float
    """First frame of the second clip alone, te."""
    first: Clip
    second: Clip
    smooth: bool = True
    """Whether the share of the second clip starts and ends gently; else it grows linearly."""

    def __post_init__(self) -> None:
        self.checked(
            start_of_the_first=self.first_start,
            start_of_the_second=self.second_start,
            begin_of_the_blend=self.begin,
            end_of_the_blend=self.finish,
        )
        for early, late, told in (
            (self.first_start, self.begin, "the blend begins at {1:g}, before the first clip does at {0:g}"),
            (self.begin, self.finish, "the blend ends at {1:g}, before it begins at {0:g}"),
            (self.second_start, self.finish, "the second clip begins at {0:g}, after the blend is over at {1:g}"),
        ):
            if early > late:
                raise self.refused(f"{told.format(early, late)}: put its frames in order")

    @property
    def parts(self) -> tuple[Clip, ...]:
        """Both clips."""
        return self.first, self.second

    @property
    def start(self) -> float:
        """First frame, tA."""
        return self.first_start

    @property
    def length(self) -> float:
        """Frames up to the end of the second clip and of the blend; 0 if and only if the second has no end."""
        return length_to(self.start, max(self._second_time + self.second.end, self.finish))

    @property
    def active(self) -> Flags:
        """Joints that either has."""
        return self.first.active | self.second.active

    def share(self, times: Array) -> Array:
        """Return how much the second clip counts at times, shape (n,)."""
        return risen(times, self.begin, self.finish, self.smooth)

    def frame(self, times: Array) -> Frames:
        """Return frames at times, shape (n,)."""
        times = self.held(times)
        return mingled(
            self.model,
            self.share(times),
            lambda rows: self.first.frame(times[rows] - self._first_time),
            lambda rows: self.second.frame(times[rows] - self._second_time),
            *self._sole,
        )

    def travel(self, times: Array) -> Travel:
        """Return where it has led at times, shape (n,)."""
        times = self.held(times)
        root = self.model.root
        if not self.second.active[root]:
            return self._first_way(times)
        if not self.first.active[root]:
            return self._second_way(times).since(self._second_at_start)
        early, late = times < self.begin, times >= self.finish
        return ways.pieced(
            times,
            [
                (early, self._first_way),
                (~early & ~late, lambda t: self._at_begin.then(self._window.at(t))),
                (late, lambda t: self._from_finish.then(self._second_way(t))),
            ],
        )

    @cached_property
    def _sole(self) -> tuple[Flags, Flags]:
        """Joints that only the first clip has, and only the second."""
        first, second = self.first.active, self.second.active
        return first & ~second, second & ~first

    @property
    def _first_time(self) -> float:
        """How much later the first clip is played."""
        return self.first_start - self.first.start

    @property
    def _second_time(self) -> float:
        return self.second_start - self.second.start

    def _first_way(self, times: Array) -> Travel:
        return self.first.travel(times - self._first_time)

    def _second_way(self, times: Array) -> Travel:
        return self.second.travel(times - self._second_time)

    @cached_property
    def _second_at_start(self) -> Travel:
        return self._second_way(np.array([self.start]))

    @cached_property
    def _at_begin(self) -> Travel:
        return self._first_way(np.array([self.begin]))

    @cached_property
    def _window(self) -> Way:
        nodes = ways.between(self.begin, self.finish)
        return ways.blended(nodes, self._first_way(nodes), self._second_way(nodes), self.share)

    @cached_property
    def _from_finish(self) -> Travel:
        """What brings the second clip's own way to where the blend has ended."""
        way_there = self._second_way(np.array([self.finish])).inverse()
        return self._at_begin.then(self._window.whole).then(way_there)
