"""Serial chains of joints that reach for a point by bending further the way they bend at rest.

A chain has one degree of freedom of its own, its bend: from straight, over its rest shape, to curled up. The bend
that brings its end to a distance is read from a table made once for the chain, and one smallest rotation then aims
it. So the pose depends on the goal alone, knees and elbows keep the side to which they bend at rest, and all frames are
one batch.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .. import quat, rotation
from ..arrays import Array, Flags, Indices
from ..rotation import Hinges

STRAIGHT = np.radians(3.0)
"""A joint that bends less than this at rest bends the way of the chain's hint."""
CURL = 0.85 * np.pi
"""Most that one joint bends [rad]."""
CURL_IN_ALL = 1.6 * np.pi
"""Most that all joints of a chain bend together [rad]."""
SAMPLES = 65
"""Bends of a table from rest to straight, and from rest to curled up."""
MOST_STEPS = 4 * SAMPLES
"""The same where joints wait for each other."""
WAITING = 0.05
"""A joint waits more and more when it helps less than this share of what the most helpful one does."""
FLAT = 1e-4
"""A chain does not curl up further when a bend shortens it by less than this share of its length: it would snap."""
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

    @cached_property
    def hinges(self) -> Hinges:
        """What the joints turn about."""
        return Hinges(self.axes)

    @cached_property
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
        curl = np.maximum(most - angles, 0.0)
        curl[0] = 0.0
        opened, curled = _bends(segments, axes, -angles, bent), _bends(segments, axes, curl, bent)
        extra = np.concatenate([opened[:0:-1], curled])
        distances = quat.length(_ends(segments, axes, extra)[1])
        kept = _falling(distances, len(opened) - 1)
        return cls(segments, axes, extra[kept], distances[kept])

    def reach(self, goals: Array) -> tuple[Array, Array]:
        """Return how each joint turns from rest to bring the end to a goal, and where the end comes to lie.

        Args:
            goals: From the first joint [m], in its rest frame, shape (frame, 3).

        Returns:
            Rotation matrices, shape (frame, joint, 3, 3), and ends [m], shape (frame, 3).
        """
        away = quat.length(goals)
        distance = self._reachable(away)
        # np.interp wants rising abscissae.
        last = len(self.distances) - 1
        places = np.interp(-distance, -self.distances, np.arange(last + 1, dtype=np.float64))
        low = np.clip(places.astype(np.intp), 0, max(last - 1, 0))
        part = (places - low)[:, None]
        extra = (1.0 - part) * self.extra[low] + part * self.extra[np.minimum(low + 1, last)]
        own = self.hinges.turned(extra)
        turns = np.empty_like(own)
        turns[:, 0] = own[:, 0]
        ends = rotation.apply(turns[:, 0], self.segments[0])
        for joint in range(1, len(self.segments)):
            np.matmul(turns[:, joint - 1], own[:, joint], out=turns[:, joint])
            ends = ends + rotation.apply(turns[:, joint], self.segments[joint])
        # Over the rest direction, so that only goals straight behind that are singular, whatever the bend: half turns
        # about it, once from the end and once to the goal, cancel out.
        aim = np.matmul(self._half_way(goals), self._half_way(ends))
        return np.matmul(aim[:, None], turns), rotation.apply(aim, ends)

    def _half_way(self, vectors: Array) -> Array:
        """Return half turns about what lies between vectors and the end at rest, shape (frame, 3, 3)."""
        lengths = quat.length(vectors)[:, None]
        between = self.rest_direction + vectors / np.maximum(lengths, 1e-9)
        odd = quat.dot(between, between) < 1e-9
        if odd.any():
            between[odd] = self.aside
        return rotation.half_turn(between)

    @cached_property
    def rest_direction(self) -> Array:
        """Of the end at rest from the first joint; that of the first segment where the chain closes on itself."""
        whole = self.segments.sum(axis=0)
        return quat.unit(whole if np.linalg.norm(whole) > 1e-9 else self.segments[0])

    @cached_property
    def aside(self) -> Array:
        """A direction square to it."""
        return quat.unit(quat.cross(self.rest_direction, np.eye(3)[np.argmin(np.abs(self.rest_direction))]))

    def _reachable(self, away: Array) -> Array:
        """Return distances within reach: those near the chain's length are approached ever more slowly."""
        full = float(self.distances[0])
        soft = max(SOFT * full, self.rest_distance)
        room = max(FIRM * full - soft, 1e-9 * max(full, 1e-9))
        beyond = np.maximum(away - soft, 0.0)
        return np.where(away > soft, soft + room * (1.0 - np.exp(-beyond / room)), away)


def _bends(segments: Array, axes: Array, most: Array, bent: Flags) -> Array:
    """Return angles by which the joints turn from rest on, until they have turned by ``most``, shape (bend, joint).

    All turn in proportion, as long as that shortens the chain (or lengthens it, when they open). In chains that are
    bent one way and the other it may not; then the joints that hinder wait.
    """
    way = 1.0 if most.sum() > 0.0 else -1.0
    extra = np.linspace(0.0, 1.0, SAMPLES)[:, None] * most
    if not bent.any() or (way * np.diff(quat.length(_ends(segments, axes, extra)[1])) <= 0.0).all():
        return extra
    rows, step = [extra[0]], extra[1]
    for _ in range(MOST_STEPS):
        turns, ends = _ends(segments, axes, rows[-1][None])
        arms = np.cumsum(quat.rotate(turns[0], segments)[::-1], axis=0)[::-1]
        helps = -quat.dot(quat.cross(quat.rotate(turns[0], axes), arms), np.broadcast_to(ends[0], arms.shape))
        helps[0] = 0.0
        share = np.clip(helps / max(WAITING * float(helps.max()), 1e-9 * float(quat.dot(ends, ends)[0])), 0.0, 1.0)
        share[~bent & (np.abs(rows[-1]) < STRAIGHT)] = 1.0
        row = rows[-1] + share * step
        row = np.minimum(row, most) if way > 0.0 else np.maximum(row, most)
        if np.abs(row - rows[-1]).max() < 1e-3 * np.abs(step).max():
            break
        rows.append(row)
    return np.array(rows)


def _falling(distances: Array, rest: int) -> Indices:
    """Return the bends, from the straightest to the most curled, between which a chain only shortens; rest is one.

    A chain gets longer again when it curls up beyond itself; and it first gets straight when it stands a little bent
    against its hint. Bends between which it would snap are left out.
    """
    kept = [rest]
    for bend in range(rest - 1, -1, -1):
        if distances[bend] > distances[kept[0]]:
            kept.insert(0, bend)
    for bend in range(rest + 1, len(distances)):
        if distances[bend] < distances[kept[-1]]:
            kept.append(bend)
        elif kept[-1] > rest:
            # Near its shortest, a chain is not measured well between bends.
            del kept[max(len(kept) - 2, kept.index(rest) + 1) :]
            break
    while kept[-1] > rest and distances[kept[-2]] - distances[kept[-1]] < FLAT * distances[kept[0]]:
        kept.pop()
    return np.array(kept, dtype=np.intp)


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
