"""Serial chains of joints that reach for a point by bending further the way they bend at rest.

A chain has one degree of freedom of its own, its bend: from straight, over its rest shape, to curled up. The bend
that brings its end to a distance is read from a table made once for the chain, and one smallest rotation then aims
it. So the pose depends on the goal alone, knees and elbows keep the side to which they bend at rest, and all frames are
one batch.
"""

from dataclasses import dataclass

import numpy as np

from .. import quat
from ..arrays import Array

STRAIGHT = np.radians(3.0)
"""A joint that bends less than this at rest bends the way of the chain's hint."""
CURL = 0.85 * np.pi
"""Most that one joint bends [rad]."""
CURL_IN_ALL = 1.6 * np.pi
"""Most that all joints of a chain bend together [rad]."""
SAMPLES = 129
SOFT = 0.97
"""Share of a chain's length from which on it slows down toward goals that it cannot reach …"""
FIRM = 0.999
"""… and how far it stretches in the end."""


@dataclass(frozen=True, eq=False)
class Chain:
    """Joints in line and a point at their end, at rest."""

    segments: Array
    """From each joint to the next, the last one to the end [m], shape (joint, 3)."""
    axes: Array
    """Axis about which each joint bends, unit vectors, shape (joint, 3); the first joint's is unused."""
    extra: Array
    """Angle by which each joint turns beyond its rest for each bend of the table [rad], shape (bend, joint)."""
    distances: Array
    """From the first joint to the end for each bend [m], falling, shape (bend,)."""

    @property
    def rest_distance(self) -> float:
        """From the first joint to the end at rest [m]."""
        return float(np.linalg.norm(self.segments.sum(axis=0)))

    @classmethod
    def make(cls, points: Array, hint: Array) -> "Chain":
        """Return the chain through points, each joint and then the end.

        Args:
            points: At rest [m], shape (joint + 1, 3).
            hint: Where the middle of the chain moves when it bends, for chains that are straight at rest; shape (3,).
        """
        segments = np.diff(points, axis=0)
        count = len(segments)
        before, after = quat.unit(segments[:-1]), quat.unit(segments[1:])
        vectors = quat.to_rotation_vector(quat.between(before, after))
        angles = np.concatenate([[0.0], quat.length(vectors)])
        along = quat.unit(points[-1] - points[0])
        usual = quat.unit(quat.cross(hint - (hint @ along) * along, along))
        if not usual.any():
            usual = quat.unit(quat.cross(np.eye(3)[int(np.argmin(np.abs(along)))], along))
        axes = np.tile(usual, (count, 1))
        bent = angles > STRAIGHT
        axes[bent] = quat.unit(vectors[bent[1:]])
        most = min(CURL, CURL_IN_ALL / max(count - 1, 1))
        bends = np.linspace(-1.0, 1.0, SAMPLES)[:, None]
        open_up, curl_up = angles * bends, np.maximum(most - angles, 0.0) * bends
        extra = np.where(bends < 0.0, open_up, curl_up)
        extra[:, 0] = 0.0
        ends = _ends(segments, axes, extra)[1]
        distances = np.minimum.accumulate(quat.length(ends) - 1e-12 * np.arange(SAMPLES))
        return cls(segments, axes, extra, distances)

    def reach(self, goals: Array) -> tuple[Array, Array]:
        """Return how each joint turns from rest to bring the end to a goal, and where the end comes to lie.

        Args:
            goals: From the first joint [m], in its rest frame, shape (frame, 3).

        Returns:
            Turns, shape (frame, joint, 4), and ends [m], shape (frame, 3).
        """
        away = quat.length(goals)
        distance = self._reachable(away)
        # np.interp wants rising abscissae.
        places = np.interp(-distance, -self.distances, np.arange(SAMPLES, dtype=np.float64))
        low = np.minimum(places.astype(np.intp), SAMPLES - 2)
        part = (places - low)[:, None]
        extra = (1.0 - part) * self.extra[low] + part * self.extra[low + 1]
        turns, ends = _ends(self.segments, self.axes, extra)
        direction = np.where(away[:, None] > 1e-9, goals, ends)
        aim = quat.between(ends, direction)
        return quat.multiply(aim[:, None], turns), quat.rotate(aim, ends)

    def _reachable(self, away: Array) -> Array:
        """Return distances within reach: those near the chain's length are approached ever more slowly."""
        full = float(self.distances[0])
        soft = max(SOFT * full, self.rest_distance)
        room = max(FIRM * full - soft, 1e-9 * max(full, 1e-9))
        beyond = np.maximum(away - soft, 0.0)
        return np.where(away > soft, soft + room * (1.0 - np.exp(-beyond / room)), away)


def _ends(segments: Array, axes: Array, extra: Array) -> tuple[Array, Array]:
    """Return each joint's turn from rest, all those before it included, and the end, for extra angles of the joints."""
    turns = np.empty((*extra.shape, 4))
    own = quat.from_axis_angle(axes, extra)
    turns[:, 0] = own[:, 0]
    ends = quat.rotate(turns[:, 0], segments[0])
    for joint in range(1, len(segments)):
        turns[:, joint] = quat.multiply(turns[:, joint - 1], own[:, joint])
        ends = ends + quat.rotate(turns[:, joint], segments[joint])
    return turns, ends
