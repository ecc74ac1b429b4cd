"""Where the travel of a clip goes: kept on the hips, moved to a root bone or the object, or taken out.

Travel is the slow part of the hips' way over the ground and of their facing; sway and bob stay with the hips. Its first
and last frame are exact, so that a cycle's end still meets its beginning, and a loop keeps its offset.
"""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from .. import quat
from ..arrays import Array
from ..travelling import slow_way


class RootMotion(StrEnum):
    """What becomes of the travel."""

    HIPS = "hips"
    ROOT_BONE = "root"
    OBJECT = "object"
    IN_PLACE = "in-place"


@dataclass(frozen=True, eq=False)
class Travel:
    """The slow way of a body over the ground, character frame."""

    turns: Array
    """Turn about the vertical since the first frame, shape (frame, 4)."""
    points: Array
    """Place on the ground since the first frame [m], shape (frame, 3)."""


def find_travel(hips: Array, facings: Array, seconds_per_frame: float) -> Travel:
    """Return the travel of a clip.

    Args:
        hips: Places of the hips, character frame [m], shape (frame, 3).
        facings: Turn of the hips from rest, shape (frame, 4).
        seconds_per_frame: Of the clip [s].
    """
    forward = quat.rotate(facings, np.array([0.0, -1.0, 0.0]))
    slow = slow_way(hips[:, :2], np.arctan2(forward[:, 0], -forward[:, 1]), seconds_per_frame)
    slow -= slow[0]
    points = np.column_stack([slow[:, :2], np.zeros(len(slow))])
    return Travel(quat.from_axis_angle(np.array([0.0, 0.0, 1.0]), slow[:, 2]), points)


def without(travel: Travel, points: Array, pivot: Array) -> Array:
    """Return ``points``, shape (frame, link, 3), as seen by something that travels from ``pivot``, shape (3,)."""
    ground = pivot * np.array([1.0, 1.0, 0.0])
    return ground + quat.rotate(quat.conjugate(travel.turns)[:, None], points - travel.points[:, None] - ground)
