"""Clips: motions over time, from which others are made (Grünvogel 2003 §5.3, table 1).

A clip is a description. It is evaluated for any batch of times alone, and the same times always give the same frames.
"""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from ..arrays import Array, Flags
from ..errors import MotionError
from .character_model import CharacterModel
from .frames import Frames
from .travel import Travel


class Clip(ABC):
    """The common interface of all motion data. Times are frames of `character_model.RATE`, and need not be whole."""

    @property
    @abstractmethod
    def model(self) -> CharacterModel:
        """The body that it is made for."""

    @property
    @abstractmethod
    def start(self) -> float:
        """First frame."""

    @property
    @abstractmethod
    def length(self) -> float:
        """Frames from the first to the last, both included; 0 or less for a clip without end."""

    @property
    @abstractmethod
    def active(self) -> Flags:
        """Joints for which it has data, shape (joint,)."""

    @abstractmethod
    def frame(self, times: Array) -> Frames:
        """Return frames at times, shape (n,); beyond its ends the clip holds its first and its last frame."""

    @abstractmethod
    def travel(self, times: Array) -> Travel:
        """Return where it has led over the ground at times, shape (n,), as seen from its first frame."""

    @property
    def parts(self) -> Sequence["Clip"]:
        """What it is made from: the branches of the motion tree (§5.5), none for a primitive."""
        return ()

    @property
    def label(self) -> str:
        """What it is called in a picture of the motion tree."""
        return type(self).__name__

    @property
    def is_finite(self) -> bool:
        """Whether it ends."""
        return self.length > 0.0

    @property
    def end(self) -> float:
        """Last frame; infinite for a clip without end."""
        return self.start + self.length - 1.0 if self.is_finite else np.inf

    def held(self, times: Array) -> Array:
        """Return times moved to within the clip, shape (n,)."""
        return np.clip(times, self.start, self.end)


@dataclass(frozen=True, eq=False)
class ClipPrimitive(Clip):
    """Animation data that was made beforehand (§5.3, figure 2): a frame for each whole time from the start."""

    name: str
    own_model: CharacterModel
    data: Frames
    way: Travel
    """Of the same frames; the first stands at the origin."""
    joints: Flags = field(default_factory=lambda: np.zeros(0, dtype=np.bool_))
    """Joints for which there is data, shape (joint,); empty for all."""
    first: float = 0.0

    def __post_init__(self) -> None:
        if not len(self.data):
            raise MotionError(f"clip {self.name!r} has no frames: choose one that has")
        if len(self.data) != len(self.way):
            raise MotionError(
                f"clip {self.name!r} has {len(self.data)} frames and {len(self.way)} places: give both as many"
            )
        if self.data.rotations.shape[1] != len(self.own_model):
            raise MotionError(f"clip {self.name!r} is made for another body: transfer it to this one first")
        arrays = (self.data.rotations, self.data.translations, self.data.feet, self.way.places, self.way.headings)
        if not all(np.isfinite(array).all() for array in arrays):
            raise MotionError(f"clip {self.name!r} holds values that are no numbers: make it anew or mend its keys")

    @property
    def model(self) -> CharacterModel:
        """The body that it is made for."""
        return self.own_model

    @property
    def start(self) -> float:
        """First frame."""
        return self.first

    @property
    def length(self) -> float:
        """Frames that it has."""
        return float(len(self.data))

    @property
    def active(self) -> Flags:
        """Joints for which it has data."""
        return self.joints if len(self.joints) else np.ones(len(self.own_model), dtype=np.bool_)

    @property
    def label(self) -> str:
        """Its name."""
        return self.name

    def frame(self, times: Array) -> Frames:
        """Return frames at times, shape (n,), between those that it has."""
        return self.data.at(times - self.first)

    def travel(self, times: Array) -> Travel:
        """Return where it has led at times, shape (n,)."""
        return self.way.at(times - self.first)
