"""Loop, Grünvogel 2003 §5.3.3, which can blend its own ends as the paper asks for in §8."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...arrays import Array
from ..clip import Clip
from ..frames import Frames
from ..travel import Travel
from . import ways
from .aggregate import ClipAggregate
from .rows import replaced
from .seam import Seam


@dataclass(frozen=True, eq=False)
class Loop(ClipAggregate):
    """A clip that is repeated (eqs. 4 and 5); one without end stays as it is.

    Between its last frame and the first of the next round it goes from the one to the other. The way over the ground
    goes on from round to round; the step that closes a round is the mean of the clip's last and its first.
    """

    count: int
    """Rounds; 0 or less for as many as there is time."""
    clip: Clip
    blend: float = 0.0
    """Frames on either side of the seam over which the ends are bent toward each other, at most half a round; for
    clips whose last frame does not lead to their first."""
    closing: float = 1.0
    """Frames from the last frame to the first again; other than 1 for a cycle that was warped in time."""

    def __post_init__(self) -> None:
        self.checked(blend=self.blend, closing=self.closing)
        if not self.clip.is_finite:
            return
        if self.closing < 0.0 or self.cycle <= 0.0:
            raise self.refused(f"a round of {self.cycle:g} frames cannot be repeated: give it a longer closing")
        if not 0.0 <= self.blend <= 0.5 * self.cycle:
            raise self.refused(f"it blends over {self.blend:g} frames: choose 0 to {0.5 * self.cycle:g}, half a round")

    @property
    def parts(self) -> tuple[Clip, ...]:
        """The clip."""
        return (self.clip,)

    @property
    def label(self) -> str:
        """With its number of rounds, if it has one."""
        return f"Loop {self.count}" if self.count > 0 else "Loop"

    @property
    def cycle(self) -> float:
        """Frames of a round, up to the first frame of the next; infinite for a clip without end."""
        return self.clip.length - 1.0 + self.closing if self.clip.is_finite else np.inf

    @property
    def length(self) -> float:
        """Frames of all rounds, 0 without end."""
        if self.count <= 0 or not self.clip.is_finite:
            return 0.0
        return self.count * self.cycle - self.closing + 1.0

    def frame(self, times: Array) -> Frames:
        """Return frames at times, shape (n,)."""
        if not self.clip.is_finite:
            return self.clip.frame(times)
        _, into = self._rounds(times)
        last = self.clip.length - 1.0
        out = self._clip_frames(np.minimum(into, last))
        closing = np.flatnonzero(into > last)
        if not len(closing):
            return out
        return replaced(out, closing, out[closing].mixed(self._first, (into[closing] - last) / self.closing))

    def travel(self, times: Array) -> Travel:
        """Return where it has led at times, shape (n,)."""
        if not self.clip.is_finite:
            return self.clip.travel(times)
        rounds, into = self._rounds(times)
        last = self.clip.length - 1.0
        own = self.clip.travel(self.clip.start + np.minimum(into, last))
        rest = ways.scaled(self._closing_step, np.maximum(into - last, 0.0))
        return ways.repeated(self._whole, rounds).then(own).then(rest)

    def _rounds(self, times: Array) -> tuple[Array, Array]:
        """Return how many rounds are over, and how far into the next each time is [frames]."""
        since = self.held(times) - self.start
        rounds = np.floor(since / self.cycle)
        return rounds, np.clip(since - rounds * self.cycle, 0.0, self.cycle)

    def _clip_frames(self, into: Array) -> Frames:
        frames = self.clip.frame(self.clip.start + into)
        return frames if self.blend == 0.0 else self._seam.closed(frames, into)

    @cached_property
    def _first(self) -> Frames:
        return self._clip_frames(np.zeros(1))

    @cached_property
    def _seam(self) -> Seam:
        gap = min(1.0, 0.5 * (self.clip.length - 1.0))
        near = gap * np.arange(3.0)
        ends = self.clip.frame(np.concatenate([self.start + near, self.clip.end - near[::-1]]))
        return Seam(ends, gap, self.closing, self.cycle, self.blend)

    @cached_property
    def _closing_step(self) -> Travel:
        """A frame's way between the last frame and the first."""
        gap = min(1.0, self.clip.length - 1.0)
        if gap <= 0.0:
            return Travel.still()
        way = self.clip.travel(np.array([self.start, self.start + gap, self.clip.end - gap, self.clip.end])).steps()
        return ways.scaled(way[:1].mixed(way[2:], np.array([0.5])), 1.0 / gap)

    @cached_property
    def _whole(self) -> Travel:
        """Where a round leads."""
        return self.clip.travel(np.array([self.clip.end])).then(ways.scaled(self._closing_step, self.closing))
