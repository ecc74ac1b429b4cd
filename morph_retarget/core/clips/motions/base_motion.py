"""Base motions: the clips that motion models work with, and what is known of each (Grünvogel 2003 §5.4)."""

from dataclasses import dataclass

from ...errors import MotionError
from ..clip import ClipPrimitive
from ..frames import Frames
from .annotations import Annotations


@dataclass(frozen=True, eq=False)
class BaseMotion:
    """A clip that was made beforehand, with its annotations."""

    name: str
    clip: ClipPrimitive
    """Starts at frame 0; its travel counts from there."""
    annotations: Annotations

    def __post_init__(self) -> None:
        if self.clip.start != 0.0:
            raise MotionError(f"base motion {self.name!r} starts at frame {self.clip.start:g}: let it start at 0")
        feet = len(self.clip.model.feet)
        # A loop's last strike may lie between its last frame and its first.
        last = self.clip.end + (1.0 if self.annotations.cycle else 0.0)
        for strike in self.annotations.strikes:
            if strike.foot >= feet:
                raise MotionError(
                    f"base motion {self.name!r}: annotation 'strikes' names foot {strike.foot}, but its body has {feet}"
                )
            if not 0.0 <= strike.frame <= last:
                raise MotionError(
                    f"base motion {self.name!r}: annotation 'strikes' holds frame {strike.frame:g}: "
                    f"give one from 0 to {last:g}"
                )
        try:
            self.clip.model.part(*self.annotations.parts)
        except MotionError as error:
            raise MotionError(f"base motion {self.name!r}: annotation 'parts': {error}") from error

    @property
    def start_pose(self) -> Frames:
        """Its first frame."""
        return self.clip.data[:1]

    @property
    def end_pose(self) -> Frames:
        """Its last frame."""
        return self.clip.data[-1:]

    @property
    def kind(self) -> str:
        """What it is an example of."""
        return self.annotations.kind
