"""What all operators have in common: clips that are made from clips (Grünvogel 2003 §5.3, AbstClipAggregate)."""

from abc import abstractmethod
from functools import cached_property

import numpy as np

from ...arrays import Array, Flags
from ...errors import MotionError
from ..character_model import CharacterModel
from ..clip import Clip


class ClipAggregate(Clip):
    """A clip made from others; as far as it does not say otherwise it is like the first of them."""

    @property
    @abstractmethod
    def parts(self) -> tuple[Clip, ...]:
        """What it is made from, at least one."""

    @property
    def model(self) -> CharacterModel:
        """The body that all parts are made for."""
        return self.parts[0].model

    @property
    def start(self) -> float:
        """First frame."""
        return self.parts[0].start

    @property
    def length(self) -> float:
        """Frames from the first to the last, 0 for a clip without end."""
        return self.parts[0].length

    @property
    def active(self) -> Flags:
        """Joints for which it has data, shape (joint,)."""
        return self.parts[0].active

    @property
    def is_finite(self) -> bool:
        """Whether it ends."""
        return bool(np.isfinite(self.end))

    @property
    def end(self) -> float:
        """Last frame; infinite for a clip without end."""
        return self._ends[1]

    def held(self, times: Array) -> Array:
        """Return times moved to within the clip, shape (n,)."""
        return np.clip(times, *self._ends)

    @cached_property
    def _ends(self) -> tuple[float, float]:
        """First and last frame, kept: in a deep tree each clip asks for those of its parts again and again."""
        return self.start, self.start + self.length - 1.0 if self.length > 0.0 else np.inf

    def checked(self, **numbers: float) -> None:
        """Refuse what cannot be made: numbers that are none, and parts that are made for several bodies.

        Raises:
            MotionError: Names the number, or the part.
        """
        for name, value in numbers.items():
            if not np.isfinite(value):
                raise self.refused(f"{name.replace('_', ' ')} is {value}: give a number")
        for part in self.parts[1:]:
            if part.model is not self.model:
                raise self.refused(f"{part.label!r} is made for another body: transfer it to this one first")

    def refused(self, why: str) -> MotionError:
        """Return the error that tells why it cannot be made."""
        return MotionError(f"{type(self).__name__} of {' and '.join(repr(p.label) for p in self.parts)}: {why}")


def length_to(start: float, end: float) -> float:
    """Return the length of a clip with these ends: 0 for one without end."""
    return end - start + 1.0 if np.isfinite(end) else 0.0
