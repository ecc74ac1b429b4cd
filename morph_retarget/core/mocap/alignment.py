"""Aligning the rest pose of one body with a pose of another, segment by segment (Feng 2013 §4.1, figure 5).

Each target segment is turned the shortest way onto the direction of the source's segment, from the hips outward, and
each joint first takes over the turn of the joint above it, so that twist stays relative to the rest.
"""

from dataclasses import dataclass

import numpy as np

from .. import quat
from ..arrays import Array
from .links import NONE, Links


@dataclass(frozen=True, eq=False)
class Alignment:
    """Rotations that belong to a pair of bodies, in the character frame."""

    source: Array
    """Turn of each link from the source's rest to its alignment pose, shape (link, 4)."""
    target: Array
    """Turn of each link from the target's rest to the same alignment pose, shape (link, 4)."""

    @property
    def post(self) -> Array:
        """What follows the source's turn to make the target's: ``target_turn = source_turn * post``."""
        return quat.multiply(quat.conjugate(self.source), self.target)


# Joints whose own orientation means something at rest, and does not follow from the direction of one segment.
UPRIGHT_JOINTS = frozenset({"hips", "head", "jaw", "leftEye", "rightEye"})


def align(
    links: Links,
    source_points: Array,
    source_turns: Array,
    target_points: Array,
    target_turns: Array,
    heading: Array,
) -> Alignment:
    """Return the alignment of a target in its reference pose with a source in its own.

    Args:
        links: Of the pair.
        source_points: Place of each link on the source in its reference pose, character frame, shape (link, 3).
        source_turns: Turn of each link from the source's rest to that pose, shape (link, 4).
        target_points: Place of each link on the target in its reference pose, character frame, shape (link, 3).
        target_turns: Turn of each link from the target's rest to that pose, shape (link, 4).
        heading: Turn about the vertical from the target's facing to the source's, shape (4,).
    """
    carried = quat.identity(len(links))
    for i, name in enumerate(links.names):
        above = int(links.above[i])
        carried[i] = heading if name in UPRIGHT_JOINTS or above == NONE else carried[above]
        after = int(links.after[i])
        if after != NONE:
            own = quat.rotate(carried[i], target_points[after] - target_points[i])
            carried[i] = quat.multiply(quat.between(own, source_points[after] - source_points[i]), carried[i])
    return Alignment(source_turns, quat.multiply(carried, target_turns))


def stand_alike(source_turns: Array, target_turns: Array, heading: Array) -> Alignment:
    """Return the alignment of two bodies whose reference poses are taken to correspond as they are."""
    return Alignment(source_turns, quat.multiply(heading, target_turns))


def facing(links: Links, points: Array) -> Array:
    """Return the turn about the vertical from the front to where a body in some pose faces, shape (4,).

    Args:
        links: Of the pair.
        points: Places of the links, character frame, shape (link, 3).
    """
    across = np.zeros(3)
    for i, name in enumerate(links.names):
        if name.startswith(("left", "right")) and name.endswith(("UpperLeg", "UpperArm")):
            across += points[i] if name.startswith("left") else -points[i]
    if np.linalg.norm(across[:2]) < 1e-9:
        return quat.IDENTITY
    return quat.from_axis_angle(np.array([0.0, 0.0, 1.0]), np.arctan2(across[1], across[0]))
