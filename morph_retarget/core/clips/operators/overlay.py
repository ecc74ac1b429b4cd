"""Overlay: a motion of some joints over one of the whole body, as a wave over a walk (Grünvogel 2003 §6.2.3)."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...arrays import Array, Flags
from ..clip import Clip
from ..frames import Frames
from ..travel import Travel
from .aggregate import ClipAggregate
from .blend import Blend
from .embed import Embed
from .envelope import risen
from .rows import mingled
from .section import Section


@dataclass(frozen=True, eq=False)
class Overlay(ClipAggregate):
    """A clip with another on some of its joints: for as long as that lasts, faded in and out within its own frames.

    It is as long as the lower clip. The feet of legs that are overlaid are the upper clip's, and with the root the way
    over the ground as well. A joint that the lower clip does not have is the upper clip's throughout.
    """

    lower: Clip
    upper: Clip
    joints: Flags
    """Those on which the upper clip is laid, where it has them, shape (joint,)."""
    fade_in: float = 0.0
    """Frames from where the upper clip starts until it counts alone."""
    fade_out: float = 0.0
    """Frames at its end in which it goes."""
    smooth: bool = True
    """Whether it comes and goes gently."""

    def __post_init__(self) -> None:
        self.checked(fade_in=self.fade_in, fade_out=self.fade_out)
        if self.joints.shape != (len(self.model),):
            raise self.refused(f"{self.joints.size} joints are marked and the body has {len(self.model)}: mark each")
        lasts = self.upper.end - self.upper.start
        if min(self.fade_in, self.fade_out) < 0.0 or self.fade_in + self.fade_out > lasts:
            raise self.refused(
                f"it fades in over {self.fade_in:g} and out over {self.fade_out:g} frames, of {lasts:g}: fade faster"
            )

    @property
    def parts(self) -> tuple[Clip, ...]:
        """Both clips."""
        return self.lower, self.upper

    @property
    def active(self) -> Flags:
        """Joints that it has."""
        return self.lower.active | self.laid

    @property
    def laid(self) -> Flags:
        """Joints that the upper clip moves, shape (joint,)."""
        return self.joints & self.upper.active

    def share(self, times: Array) -> Array:
        """Return how much the upper clip counts at times, shape (n,)."""
        come = risen(times, self.upper.start, self.upper.start + self.fade_in, self.smooth)
        if not self.upper.is_finite:
            return come
        if self.fade_out == 0.0:  # its last frame is still seen
            return come * (times <= self.upper.end)
        return come - risen(times, self.upper.end - self.fade_out, self.upper.end, self.smooth)

    def frame(self, times: Array) -> Frames:
        """Return frames at times, shape (n,)."""
        times = self.held(times)
        return mingled(
            self.model,
            self.share(times),
            lambda rows: self.lower.frame(times[rows]),
            lambda rows: self.upper.frame(times[rows]),
            *self._sole,
        )

    def travel(self, times: Array) -> Travel:
        """Return where it has led at times, shape (n,)."""
        times = self.held(times)
        if not self.laid[self.model.root]:
            return self.lower.travel(times)
        return self._leading.travel(times).since(self._from)

    @cached_property
    def _sole(self) -> tuple[Flags, Flags]:
        """Joints that only the lower clip moves, and only the upper."""
        return ~self.laid, self.laid & ~self.lower.active

    @cached_property
    def _from(self) -> Travel:
        return self._leading.travel(np.array([self.start]))

    @cached_property
    def _leading(self) -> Clip:
        """What has the same way over the ground where the upper clip moves the root: both with all their joints."""
        upper = self.upper
        if not self.lower.active[self.model.root]:
            return upper
        # What begins later than the other holds its first frame until then.
        lower = Section(min(self.lower.start, upper.start), self.lower.end, self.lower)
        come = upper.start + self.fade_in
        if not upper.is_finite:
            return Blend(lower.start, upper.start, upper.start, come, lower, upper, self.smooth)
        going = upper.end - self.fade_out
        return Embed(lower.start, upper.start, upper.start, come, going, upper.end, lower, upper, self.smooth)
