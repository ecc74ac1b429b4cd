"""TimeShift, Grünvogel 2003 §5.3.1."""

from dataclasses import dataclass

from ...arrays import Array
from ..clip import Clip
from ..frames import Frames
from ..travel import Travel
from .aggregate import ClipAggregate


@dataclass(frozen=True, eq=False)
class TimeShift(ClipAggregate):
    """A clip that is played later (eqs. 1 and 2)."""

    shift: float
    """[frames], negative for earlier."""
    clip: Clip

    def __post_init__(self) -> None:
        self.checked(shift=self.shift)

    @property
    def parts(self) -> tuple[Clip, ...]:
        """The clip."""
        return (self.clip,)

    @property
    def start(self) -> float:
        """First frame."""
        return self.clip.start + self.shift

    def frame(self, times: Array) -> Frames:
        """Return frames at times, shape (n,)."""
        return self.clip.frame(times - self.shift)

    def travel(self, times: Array) -> Travel:
        """Return where it has led at times, shape (n,)."""
        return self.clip.travel(times - self.shift)


def started_at(start: float, clip: Clip) -> Clip:
    """Return a clip moved in time so that it starts at a frame."""
    return clip if clip.start == start else TimeShift(start - clip.start, clip)
