"""Mask: only a part of the body (Grünvogel 2003 §4)."""

from dataclasses import dataclass

from ...arrays import Array, Flags
from ..clip import Clip
from ..frames import Frames
from ..travel import Travel
from .aggregate import ClipAggregate
from .rows import Portion, masked


@dataclass(frozen=True, eq=False)
class Mask(ClipAggregate):
    """A clip of which only some joints count; the others rest, and without the root it leads nowhere."""

    joints: Flags
    """Shape (joint,), see `CharacterModel.part`."""
    clip: Clip

    def __post_init__(self) -> None:
        if self.joints.shape != (len(self.model),):
            raise self.refused(f"{self.joints.size} joints are marked and the body has {len(self.model)}: mark each")

    @property
    def parts(self) -> tuple[Clip, ...]:
        """The clip."""
        return (self.clip,)

    @property
    def active(self) -> Flags:
        """Joints for which it has data, shape (joint,)."""
        return self.clip.active & self.joints

    def frame(self, times: Array) -> Frames:
        """Return frames at times, shape (n,)."""
        return masked(self.model, self.clip.frame(times), Portion.of(self.model, self.active))

    def travel(self, times: Array) -> Travel:
        """Return where it has led at times, shape (n,)."""
        return self.clip.travel(times) if self.active[self.model.root] else Travel.still(len(times))
