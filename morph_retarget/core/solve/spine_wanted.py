"""What bends a spine: goals of its branch points, and of the limbs that pull at them."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..arrays import Array, Flags
from .spine import Spine


@dataclass(frozen=True, eq=False)
class Wanted:
    """What bends a spine, in the frame of what carries it and from its first joint."""

    pins: Array
    """Goals of the branch points themselves [m], shape (frame, node, 3)."""
    pinned: Array
    """How much they count, 0 where a branch point has none, shape (frame, node)."""
    goals: Array
    """Where the limbs that pull shall end [m], shape (frame, pull, 3)."""
    weights: Array
    """How much they count, shape (frame, pull)."""
    held: Array
    """How far the body at the last branch point has a turn of its own, shape (frame,)."""
    counts: Array | None = None
    """How much anything wants of each branch point or of those beyond, shape (frame, node); None where it is all."""

    @cached_property
    def asked(self) -> list[bool]:
        """Whether each branch point has a goal that counts."""
        return [bool(own.any()) for own in self.pinned.T]

    @cached_property
    def loose(self) -> Array:
        """How far no goal of a branch point at their ends or beyond holds pieces, shape (frame, piece)."""
        beyond = np.maximum.accumulate(self.pinned[:, :0:-1], axis=1)
        return 1.0 - beyond[:, ::-1]

    @cached_property
    def is_loose(self) -> bool:
        """Whether limbs alone bend any piece, if only in part."""
        return bool(self.loose.any())

    def at(self, rows: Flags) -> "Wanted":
        """Return what is wanted in some frames."""
        counts = None if self.counts is None else self.counts[rows]
        pins, pinned, goals, weights = (own[rows] for own in (self.pins, self.pinned, self.goals, self.weights))
        return Wanted(pins, pinned, goals, weights, self.held[rows], counts)

    def carry(self, particles: Array, node: int, way: Array) -> None:
        """Move a branch point, and those beyond it as far as nothing wants anything of them.

        Args:
            particles: All branch points [m], shape (frame, node, 3); they are changed.
            node: The branch point.
            way: How far it moves [m], shape (frame, 3).
        """
        particle = particles[:, node]
        particle += way
        if self.counts is not None:
            particles[:, node + 1 :] += (1.0 - self.counts[:, node + 1 :, None]) * way[:, None]

    def bring(self, particles: Array, node: int) -> None:
        """Move a branch point to its goal as far as that counts; arguments as for `carry`."""
        if self.asked[node]:
            self.carry(particles, node, self.pinned[:, node, None] * (self.pins[:, node] - particles[:, node]))

    def count_of_bone(self, spine: Spine, joint: int) -> Array:
        """Return how much anything wants of a bone, of those beyond, and of limbs that they carry, shape (frame,)."""
        assert self.counts is not None, "all counts in full"
        out = self.counts[:, spine.bone_of[0][joint] + 1]
        for weight, pull in zip(self.weights.T, spine.pulls, strict=True):
            if pull.joint >= joint:
                out = np.maximum(out, weight)
        return out
