"""Pose goals: where some bodies of a character shall be, the interface between all that poses and what solves."""

from dataclasses import dataclass

from ..arrays import Array, Indices


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
