"""Pose goals: where some bodies of a character shall be, the interface between all that poses and what solves."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .. import quat
from ..arrays import Array, Indices
from . import constraints


@dataclass(frozen=True, eq=False)
class Goals:
    """Places and turns wanted for some bodies over a clip, character frame."""

    bodies: Indices
    """The bodies, each once, shape (goal,)."""
    positions: Array
    """[m], shape (frame, goal, 3)."""
    turns: Array
    """Turn of each body from its rest, shape (frame, goal, 4)."""
    position_influence: Array
    """0 leaves the body where its parents carry it, 1 brings it to the goal, shape (frame, goal)."""
    rotation_influence: Array
    """The same for the turn, shape (frame, goal)."""

    def __len__(self) -> int:
        return len(self.positions)

    def with_means(self, means: Sequence[tuple[int, tuple[int, ...]]]) -> "Goals":
        """Return the goals, and one more for each of some bodies: the mean turn of others, weighed by their influence.

        Args:
            means: Bodies, and the goals whose turns they are given.
        """
        if not means:
            return self
        turns = np.empty((len(self), len(means), 4))
        influence = np.empty((len(self), len(means)))
        for i, (_, goals) in enumerate(means):
            counts = self.rotation_influence[:, goals]
            turns[:, i] = quat.mean(self.turns[:, goals], constraints.shares(counts))
            influence[:, i] = counts.max(axis=1)
        nowhere = np.zeros((len(self), len(means)))
        return Goals(
            np.concatenate([self.bodies, np.array([body for body, _ in means], dtype=np.intp)]),
            np.concatenate([self.positions, np.zeros((*nowhere.shape, 3))], axis=1),
            np.concatenate([self.turns, turns], axis=1),
            np.concatenate([self.position_influence, nowhere], axis=1),
            np.concatenate([self.rotation_influence, influence], axis=1),
        )
