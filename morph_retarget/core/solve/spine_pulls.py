"""Limbs that pull at a spine, Hecker 2008 §4.3.2: single constraints from a branch point to a goal."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from ..arrays import Array, Indices
from .limb_settings import LimbSettings


@dataclass(frozen=True, eq=False)
class Pull:
    """A limb that pulls at a branch point."""

    node: int
    joint: int
    """The joint whose bone carries it."""
    start: Array
    """Where it starts, from that joint at rest [m], shape (3,)."""
    chord: float
    """From there to its end at rest [m]."""
    full: float
    """Length when it is stretched [m] …"""
    least: float
    """… and when it is folded up."""
    holds: bool = False
    """Whether its goal counts more than those of the spine: feet stay where they stand."""
    settings: LimbSettings = field(default=LimbSettings())

    @property
    def begin(self) -> float:
        """Distance of its goal from which on it pulls [m]."""
        return max(self.settings.spine_start * self.full, self.chord)

    @property
    def reach(self) -> float:
        """Up to where it reaches its goal without slowing down [m]."""
        return max(self.settings.slow_down * self.full, self.chord)


@dataclass(frozen=True, eq=False)
class PulledNode:
    """The limbs that pull at a branch point."""

    pulls: Indices
    """Their places among all that pull, shape (limb,)."""
    start: Array
    """Distance of their goals from which on they pull [m], shape (limb,)."""
    full: Array
    """Distance from which on they pull with all that is missing [m], shape (limb,)."""
    least: Array
    """Distance below which they push [m], shape (limb,)."""

    @classmethod
    def of(cls, pulls: Sequence[Pull], node: int, shrink: float) -> "PulledNode":
        """Return those of a node."""
        own = [i for i, pull in enumerate(pulls) if pull.node == node]
        chord: Array = np.array([pulls[i].chord for i in own])
        full: Array = np.array([pulls[i].full for i in own])
        start: Array = np.array([pulls[i].begin for i in own])
        return cls(np.array(own, dtype=np.intp), start, full, shrink * chord)
