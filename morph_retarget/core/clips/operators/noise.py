"""Noise: a style that keeps a motion from repeating itself (Perlin and Goldberg 1996, which the paper suggests)."""

from dataclasses import dataclass

import numpy as np

from ... import quat
from ...arrays import Array, Flags
from ..character_model import RATE
from ..clip import Clip
from ..frames import Frames
from ..travel import Travel
from . import coherent_noise
from .aggregate import ClipAggregate
from .rows import copied


@dataclass(frozen=True, eq=False)
class Noise(ClipAggregate):
    """A clip some of whose joints turn a little at random, about the pose that it has.

    Feet stay where they are, and so do contacts: what transfers the clip bends the legs to them.
    """

    clip: Clip
    joints: Flags
    """Those that turn, where the clip has them, shape (joint,)."""
    amplitude: float
    """At most, about each axis of a joint [rad]."""
    frequency: float = 1.0
    """How often it swings about [Hz]."""
    seed: int = 0
    """Other ones make other noise; a joint's does not depend on which others turn."""

    def __post_init__(self) -> None:
        self.checked(amplitude=self.amplitude, frequency=self.frequency)
        if self.joints.shape != (len(self.model),):
            raise self.refused(f"{self.joints.size} joints are marked and the body has {len(self.model)}: mark each")
        if self.amplitude < 0.0 or self.frequency < 0.0:
            raise self.refused("amplitude and frequency must be 0 or more: change them")

    @property
    def parts(self) -> tuple[Clip, ...]:
        """The clip."""
        return (self.clip,)

    def frame(self, times: Array) -> Frames:
        """Return frames at times, shape (n,)."""
        times = self.held(times)
        out = self.clip.frame(times)
        joints = np.flatnonzero(self.joints & self.clip.active)
        if self.amplitude == 0.0 or not len(joints):
            return out
        channels = (3 * joints[:, None] + np.arange(3)).ravel()
        turns = coherent_noise.noise(times * self.frequency / RATE, self.seed, channels)
        out = copied(out)
        swung = quat.from_rotation_vector(self.amplitude * turns.reshape(len(times), len(joints), 3))
        out.rotations[:, joints] = quat.multiply(out.rotations[:, joints], swung)
        return out

    def travel(self, times: Array) -> Travel:
        """Return where it has led at times, shape (n,)."""
        return self.clip.travel(times)
