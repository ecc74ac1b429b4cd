"""Additive: what one clip does beyond its first frame, on top of another."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ... import quat
from ...arrays import Array, Flags
from ..clip import Clip
from ..frames import Frames
from ..travel import Travel
from .aggregate import ClipAggregate
from .rows import Portion, copied


@dataclass(frozen=True, eq=False)
class Additive(ClipAggregate):
    """A clip with the difference that another makes, as a lean or a breath.

    The difference is that of each frame from the other clip's first, at the same times, for the joints that it has.
    Contacts and the way over the ground stay those of the lower clip, as does its length.
    """

    lower: Clip
    upper: Clip
    weight: float = 1.0
    """How much of the difference counts; below 0 it is turned round."""
    from_rest: bool = False
    """Whether it is the difference from the body at rest instead."""

    def __post_init__(self) -> None:
        self.checked(weight=self.weight)

    @property
    def parts(self) -> tuple[Clip, ...]:
        """Both clips."""
        return self.lower, self.upper

    @property
    def active(self) -> Flags:
        """Joints that either has."""
        return self.lower.active | self.upper.active

    def frame(self, times: Array) -> Frames:
        """Return frames at times, shape (n,)."""
        times = self.held(times)
        out = self.lower.frame(times)
        if self.weight == 0.0:
            return out
        out, upper, base, own = (
            copied(out),
            self.upper.frame(times),
            self._base,
            Portion.of(self.model, self.upper.active),
        )
        joints = np.flatnonzero(own.joints)
        change = quat.multiply(quat.conjugate(base.rotations[:, joints]), upper.rotations[:, joints])
        if self.weight != 1.0:
            change = quat.from_rotation_vector(self.weight * quat.to_rotation_vector(change))
        out.rotations[:, joints] = quat.multiply(out.rotations[:, joints], change)
        out.translations[:, own.moving] += self.weight * (upper.translations - base.translations)[:, own.moving]
        out.feet[:, own.feet] += self.weight * (upper.feet - base.feet)[:, own.feet]
        return out

    def travel(self, times: Array) -> Travel:
        """Return where it has led at times, shape (n,)."""
        return self.lower.travel(times)

    @cached_property
    def _base(self) -> Frames:
        return Frames.at_rest(self.model) if self.from_rest else self.upper.frame(np.array([self.upper.start]))
