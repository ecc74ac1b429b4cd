"""A motion as it is looked at to find its annotations: places over the ground, sizes and speeds.

All is in the character frame; lengths are measured by the legs, so that bodies of any size look alike.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ... import quat
from ...arrays import Array
from ...character.character import Character
from ...skeleton import Pose
from ...travelling import slow_way

SHORTEST = 3
"""A motion with fewer frames tells nothing."""
LONE = 5.0
"""A first frame from which the body leaps this many times as far as it ever moves between two others is a pose of its
own, such as the T-pose with which mocap files begin."""


@dataclass(frozen=True, eq=False)
class Seen:
    """A motion without its lone first frame."""

    character: Character
    pose: Pose
    """Armature space, shape (frame, ...)."""
    step: float
    """Time between two frames [s]."""
    first: int
    """Frames that were left out before it."""

    @classmethod
    def of(cls, character: Character, pose: Pose, seconds_per_frame: float) -> "Seen":
        """Return a motion ready to be looked at.

        Args:
            character: Who moves.
            pose: Armature space, shape (frame, bone, ...).
            seconds_per_frame: Time between frames [s].
        """
        first = int(_is_lone(pose))
        own = Pose(pose.rotations[first:], pose.positions[first:])
        return cls(character, own, seconds_per_frame, first)

    def __len__(self) -> int:
        return len(self.pose)

    @cached_property
    def places(self) -> Array:
        """Of all joints [m], shape (frame, joint, 3)."""
        return self.character.local_to_character.points(self.pose.positions)

    @cached_property
    def size(self) -> float:
        """Length of the legs, or for a body without any half its height [m]."""
        rest = self.character.local_to_character.points(self.character.skeleton.rest_positions)
        lengths = [np.linalg.norm(np.diff(rest[list(leg.bones)], axis=0), axis=-1).sum() for leg in self.character.legs]
        longest = max((float(length) for length in lengths), default=0.0)
        return longest if longest > 1e-6 else 0.5 * self.character.frame.height

    @cached_property
    def root(self) -> int:
        """The joint whose way is the body's."""
        own = self.character
        return own.spine[0] if own.spine else int(own.skeleton.tree.roots[0])

    @cached_property
    def headings(self) -> Array:
        """Where the body faces [rad], to the left, shape (frame,): square to its pairs of limbs, else as its root."""
        across = np.zeros((len(self), 2))
        by_side: dict[tuple[str, int, int], int] = {(m.kind, m.row, m.side): m.bones[0] for m in self.character.limbs}
        for (kind, row, side), bone in by_side.items():
            if side > 0 and (kind, row, -1) in by_side:
                across += (self.places[:, bone] - self.places[:, by_side[kind, row, -1]])[:, :2]
        if np.hypot(*across.T).min() > 1e-3 * self.size:
            return np.unwrap(quat.direction(across[:, 1], across[:, 0]))
        rest = self.character.skeleton.rest_rotations[self.root]
        turns = quat.multiply(self.pose.rotations[:, self.root], quat.conjugate(rest))
        ahead = quat.rotate(self.character.local_to_character.turns(turns), np.array([0.0, -1.0, 0.0]))
        return np.unwrap(quat.direction(ahead[:, 0], -ahead[:, 1]))

    @cached_property
    def way(self) -> Array:
        """Slow way of the body, shape (frame, 3): place on the ground [m] and heading [rad]."""
        return slow_way(self.places[:, self.root, :2], self.headings, self.step)

    @cached_property
    def velocity(self) -> Array:
        """Of the slow way over the ground [m/s], shape (frame, 2)."""
        return gradient(self.way[:, :2], self.step)

    @cached_property
    def soles(self) -> tuple[Array, ...]:
        """Points of each foot that may touch the ground: its joint and those of its toes [m], each (frame, n, 3)."""
        below = self.character.skeleton.tree.below
        return tuple(self.places[:, [leg.end, *below(leg.end)]] for leg in self.character.legs)

    @cached_property
    def shape(self) -> Array:
        """Places of the joints beside the body's slow way, turned to its heading [m], shape (frame, joint, 3)."""
        away = self.places.copy()
        away[..., :2] -= self.way[:, None, :2]
        turns = quat.from_axis_angle(np.array([0.0, 0.0, 1.0]), -self.way[:, 2])
        return quat.rotate(turns[:, None], away)


def gradient(values: Array, step: float) -> Array:
    """Return the change of ``values`` over time, shape (frame, ...), zero for a single frame."""
    return np.gradient(values, step, axis=0) if len(values) > 1 else np.zeros_like(values)


def _is_lone(pose: Pose) -> bool:
    if len(pose) < SHORTEST + 1:
        return False
    moved = quat.length(np.diff(pose.positions, axis=0)).max(axis=1)
    return bool(moved[0] > LONE * moved[1:].max())
