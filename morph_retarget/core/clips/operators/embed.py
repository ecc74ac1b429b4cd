"""Embed, Grünvogel 2003 §5.3.7."""

from dataclasses import dataclass
from functools import cached_property

from ...arrays import Array, Flags
from ..clip import Clip
from ..frames import Frames
from ..travel import Travel
from .aggregate import ClipAggregate
from .blend import Blend


@dataclass(frozen=True, eq=False)
class Embed(ClipAggregate):
    """A clip within another (eq. 14, figure 4): blended to it and back again.

    The outer clip goes on underneath, so afterwards it is as far as it would have been without. Where the inner clip
    has ended it holds its last frame. As with `Blend`, of eq. 13 only tA ≤ ts1 ≤ te1 ≤ ts2 ≤ te2 and tB ≤ te1 count.
    """

    outer_start: float
    """New first frame of the outer clip, tA."""
    inner_start: float
    """New first frame of the inner clip, tB."""
    begin_in: float
    """Last frame of the outer clip alone, ts1."""
    finish_in: float
    """First frame of the inner clip alone, te1."""
    begin_out: float
    """Last frame of the inner clip alone, ts2."""
    finish_out: float
    """First frame of the outer clip alone, te2."""
    outer: Clip
    inner: Clip
    smooth: bool = True
    """Whether shares start and end gently."""

    def __post_init__(self) -> None:
        self.checked(begin_of_the_second_blend=self.begin_out, end_of_the_second_blend=self.finish_out)
        if self.begin_out < self.finish_in:
            raise self.refused(
                f"it leaves the inner clip at {self.begin_out:g}, before it has come to it at {self.finish_in:g}: "
                "leave it later"
            )
        _ = self.blends  # which tell what else is out of order

    @property
    def parts(self) -> tuple[Clip, ...]:
        """Both clips."""
        return self.outer, self.inner

    @cached_property
    def blends(self) -> Blend:
        """The same as two blends."""
        there = Blend(
            self.outer_start, self.inner_start, self.begin_in, self.finish_in, self.outer, self.inner, self.smooth
        )
        return Blend(
            self.outer_start, self.outer_start, self.begin_out, self.finish_out, there, self.outer, self.smooth
        )

    @property
    def start(self) -> float:
        """First frame, tA."""
        return self.outer_start

    @property
    def length(self) -> float:
        """Frames that it has, 0 when the outer clip has no end."""
        return self.blends.length

    @property
    def active(self) -> Flags:
        """Joints that either has."""
        return self.blends.active

    def frame(self, times: Array) -> Frames:
        """Return frames at times, shape (n,)."""
        return self.blends.frame(times)

    def travel(self, times: Array) -> Travel:
        """Return where it has led at times, shape (n,)."""
        return self.blends.travel(times)
