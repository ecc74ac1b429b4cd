"""The limb phase, Hecker 2008 §4.3.3: what bends limbs to their goals once the spine is posed.

Limbs are solved in the frame of what carries them, where their rest is the same for all frames. The *aim
preconditioner* turns a limb from where its end rests to its goal by the smallest rotation and scales it along that way.
Turning back again, what is left for the particles is a limb that is scaled along its own rest line. So the shape that
they find depends on one number alone, the distance of the goal: it is found once for a row of distances, and read from
there for all frames. Limbs of different numbers of joints are one batch; the shorter ones start with joints of no
length.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .. import quat, rotation
from ..arrays import Array, Indices
from . import closing, constraints, swivel
from .constraints import TINY
from .limb_settings import LimbSettings

STRAIGHT = np.radians(3.0)
"""A limb whose joints all bend less than this at rest bends the way of its hint …"""
BENT = np.radians(9.0)
"""… and one with a joint that bends more than this, its own way."""
SAMPLES = 257
"""Distances from the shortest to the rest, and from there to the longest."""
MISSED = 1e-5
"""Share of a limb's length by which a distance may be missed."""
BENDS = 0.8
"""Share of its rest line to which a limb is bent, to see which way it does."""
GIVES_WAY = 0.15
"""Share of a bone's length by which one correction of a neighbour changes it at most."""
_ANY = np.array([0.0, 0.0, -1.0])
LEAN = 1.0
"""How far the bones of a straight limb lean for a way that has vanished altogether, as the tangent of the angle."""


@dataclass(frozen=True, eq=False)
class Limbs:
    """Chains that are solved together, at rest in the frames of what carries them."""

    segments: Array
    """From each joint to the next, the last one to the end [m], shape (limb, joint, 3); 0 where there is none."""
    hints: Array
    """Where the joints of straight limbs move when these bend, unit vectors or 0, shape (limb, 3)."""
    settings: tuple[LimbSettings, ...]
    """Of each limb."""
    sides: Indices
    """+1 left, -1 right, 0 in the middle, shape (limb,)."""

    @classmethod
    def of(
        cls,
        points: Sequence[Array],
        hints: Sequence[Array],
        settings: Sequence[LimbSettings] | None = None,
        sides: Sequence[int] | None = None,
    ) -> "Limbs":
        """Return limbs.

        Args:
            points: Of each one its joints and then its end, shapes (joint + 1, 3).
            hints: Where the joints of straight limbs move when these bend, shapes (3,).
            settings: Of each one, those of any limb when left out.
            sides: +1 left, -1 right, 0 in the middle, as all are when left out.
        """
        most = max(len(p) for p in points) - 1
        segments = np.zeros((len(points), most, 3))
        for i, own in enumerate(points):
            segments[i, most + 1 - len(own) :] = np.diff(own, axis=0)
        count = len(points)
        own_sides: Indices = np.array([0] * count if sides is None else sides, dtype=np.intp)
        return cls(segments, np.array(hints), tuple(settings or [LimbSettings()] * count), own_sides)

    @cached_property
    def lengths(self) -> Array:
        """Of the bones [m], shape (limb, joint)."""
        return quat.length(self.segments)

    @cached_property
    def full(self) -> Array:
        """Length of the stretched limbs [m], shape (limb,)."""
        return np.maximum(self.lengths.sum(axis=-1), TINY)

    @cached_property
    def chords(self) -> Array:
        """From start to end at rest [m], shape (limb,)."""
        return quat.length(self.segments.sum(axis=1))

    @cached_property
    def lines(self) -> Array:
        """Unit vectors from start to end at rest, shape (limb, 3).

        That of the first bone where the two coincide, and any where a limb has no length at all.
        """
        whole = self.segments.sum(axis=1)
        first = self.segments[np.arange(len(self.full)), (self.lengths > TINY).argmax(axis=1)]
        out = quat.unit(np.where(self.chords[:, None] > 1e-6 * self.full[:, None], whole, first))
        return np.where(out.any(axis=-1, keepdims=True), out, _ANY)

    @cached_property
    def directions(self) -> Array:
        """Of the bones at rest, unit vectors, shape (limb, joint, 3); the line where a bone has no length."""
        own = quat.unit(self.segments)
        return np.where(own.any(axis=-1, keepdims=True), own, self.lines[:, None])

    @cached_property
    def leans(self) -> Array:
        """How bones lean when a straight limb gets shorter [m], (limb, joint, 3): out to the hint and back again."""
        ahead = quat.dot(self.hints, self.lines)[:, None]
        aside = quat.unit(self.hints - ahead * self.lines)
        other = quat.unit(quat.cross(self.lines, np.eye(3)[np.argmin(np.abs(self.lines), axis=-1)]))
        aside = np.where(aside.any(axis=-1, keepdims=True), aside, other)
        middle = (np.cumsum(self.lengths, axis=-1) - 0.5 * self.lengths) / self.full[:, None]
        turns = quat.dot(self.directions[:, 1:], self.directions[:, :-1]) * (self.lengths[:, :-1] > TINY)
        most = np.arccos(np.clip(np.where(self.lengths[:, :-1] > TINY, turns, 1.0), -1.0, 1.0)).max(axis=-1, initial=0)
        straight = 1.0 - constraints.smooth_step(most, STRAIGHT, BENT)
        out = (LEAN * straight)[:, None] * np.cos(np.pi * middle) * self.lengths
        return out[..., None] * aside[:, None]

    @cached_property
    def aside(self) -> Array:
        """Directions square to the lines, shape (limb, 3)."""
        return quat.unit(quat.cross(self.lines, np.eye(3)[np.argmin(np.abs(self.lines), axis=-1)]))

    @cached_property
    def gives(self) -> Array:
        """Shares of a correction by which the rootward and the leafward particle of a bone move, (limb, joint, 2).

        The two have equal masses; where a limb starts, and at its goal, they are held.
        """
        there = self.lengths > TINY
        free = np.stack([there & (np.cumsum(there, axis=-1) > 1), there], axis=-1).astype(np.float64)
        free[:, -1, 1] = 0.0
        return free / np.maximum(free.sum(axis=-1, keepdims=True), 1.0)

    @cached_property
    def ease(self) -> Array:
        """Where limbs point when they are at ease, unit vectors, shape (limb, 3).

        That is half way from where they rest to where their ends go when they fold, in front of the body. Knees lead,
        and so legs fold to behind it: theirs is where they rest.
        """
        fold = quat.unit(self.hints - quat.dot(self.hints, self.lines)[:, None] * self.lines)
        return np.where(self.hints[:, 1:2] < 0.0, self.lines, quat.unit(self.lines - fold))

    @cached_property
    def limits(self) -> Array:
        """From which shares of their lengths on limbs slow down, and how far they reach, shape (2, limb)."""
        return np.array([(own.slow_down, own.full_reach) for own in self.settings]).T

    @cached_property
    def _slowing(self) -> tuple[Array, Array]:
        """From where on limbs slow down, and how far they get from there [m], shapes (limb,)."""
        slow_down, full_reach = self.limits
        soft = np.maximum(slow_down * self.full, self.chords)
        return soft, np.maximum(full_reach * self.full - soft, 1e-9 * self.full)

    @cached_property
    def room(self) -> Array:
        """Largest correction of a bone that takes no neighbour further than it may go [m], (limb, joint).

        One that is far shorter than its neighbours would be turned over by these.
        """
        none = np.full((len(self.lengths), 1), np.inf)
        room = np.where(self.lengths > TINY, GIVES_WAY * self.lengths, np.inf)
        sides = np.stack([np.append(none, room[:, :-1], axis=1), np.append(room[:, 1:], none, axis=1)], axis=-1)
        return np.where(self.gives > 0.0, sides / np.maximum(self.gives, TINY), np.inf).min(axis=-1)

    def reachable(self, away: Array) -> Array:
        """Return distances within reach, shape (frame, limb).

        Those near a limb's length are approached ever more slowly: it reaches toward what it cannot reach, without a
        snap and without being hyper-extended.
        """
        soft, room = self._slowing
        beyond = np.maximum(away - soft, 0.0)
        return np.minimum(away, soft) - room * np.expm1(-beyond / room)

    def half_way(self, vectors: Array) -> Array:
        """Return half turns about what lies between vectors and the rest lines, shape (..., limb, 3, 3).

        One from the end and one to the goal make the smallest rotations over the rest line, so that only goals straight
        behind that are singular, whatever the bend.
        """
        lengths = quat.length(vectors)[..., None]
        between = self.lines + vectors / np.maximum(lengths, 1e-9)
        squares = quat.dot(between, between)
        odd = squares < 1e-9
        if odd.any():
            between[odd], squares[odd] = np.broadcast_to(self.aside, between.shape)[odd], 1.0
        return rotation.half_turn(between, squares)

    @cached_property
    def top(self) -> Array:
        """Farthest that limbs reach [m], shape (limb,)."""
        return self.reachable(np.full(len(self.full), 1e9) * self.full)

    @cached_property
    def shapes(self) -> "Shapes":
        """What the particles make of the limbs, by the distance of their goals."""
        return Shapes.of(self)

    @cached_property
    def swivels(self) -> Array | None:
        """Turns about the lines from start to end [rad], shape (limb,), None when there are none."""
        angles = np.radians([own.swivel for own in self.settings])
        if not angles.any():
            return None
        bones = self.lengths[..., None] * self.shapes.at(BENDS * self.chords[None])[0]
        return swivel.outward(bones, self.lines, self.hints, self.sides) * angles

    @cached_property
    def _half_turns(self) -> Array:
        return rotation.half_turn(self.directions)

    def turns(self, shape: Array) -> Array:
        """Return the smallest rotations from rest that give the bones directions, shape (frame, limb, joint, 3, 3)."""
        between = shape + self.directions
        squares = quat.dot(between, between)
        odd = squares < 1e-12
        if odd.any():
            between[odd], squares[odd] = np.broadcast_to(self.aside[:, None], shape.shape)[odd], 1.0
        return np.matmul(rotation.half_turn(between, squares), self._half_turns)


def solve(limbs: Limbs, goals: Array, influence: Array | float = 1.0) -> Array:
    """Return how each joint turns from where it is carried, to bring the ends to their goals.

    Args:
        limbs: The limbs.
        goals: From where each limb starts, in the frame of what carries it [m], shape (frame, limb, 3).
        influence: Share of their swivels that limbs take, shape (frame, limb).

    Returns:
        Rotation matrices, shape (frame, limb, joint, 3, 3).
    """
    directions = limbs.shapes.at(limbs.reachable(quat.length(goals)))
    return aimed(limbs, goals, directions, (limbs.lengths[..., None] * directions).sum(axis=-2), influence)


def aimed(limbs: Limbs, goals: Array, directions: Array, ends: Array, influence: Array | float) -> Array:
    """Return how joints turn that give bones directions, and then lead the ends to where the goals are.

    Args:
        limbs: The limbs.
        goals: See `solve`.
        directions: Of the bones, unit vectors, shape (frame, limb, joint, 3).
        ends: Where the bones lead [m], shape (frame, limb, 3).
        influence: See `solve`.
    """
    aim, onward = limbs.half_way(np.stack([ends, goals]))
    if limbs.swivels is not None:  # here the ends are on the rest lines
        aim = np.matmul(rotation.about(limbs.lines, influence * limbs.swivels), aim)
    aim = np.matmul(onward, aim)
    return np.matmul(aim[:, :, None], limbs.turns(directions))


@dataclass(frozen=True, eq=False)
class Shapes:
    """Directions of limbs' bones for a row of distances from the shortest over the rest to the longest.

    The steps are small where the shape changes fast: next to the shortest, to the rest of straight limbs, and to the
    longest it does so with the square root of the distance.
    """

    least: Array
    """Shortest distance [m], shape (limb,)."""
    rest: Array
    """Of the limbs' ends at rest [m], shape (limb,)."""
    top: Array
    """Longest [m], shape (limb,)."""
    directions: Array
    """Unit vectors, shape (limb, distance, joint, 3)."""

    @classmethod
    def of(cls, limbs: Limbs) -> "Shapes":
        """Return the shapes of limbs."""
        rest = np.minimum(limbs.chords, limbs.top)
        # Not all limbs fold up altogether: the shortest distance is the one below which some are not come to.
        asked = np.linspace(0.02, 0.999, SAMPLES)[:, None] * rest
        came = quat.length((limbs.lengths[..., None] * _solved(limbs, asked)).sum(axis=-2))
        missed = np.abs(came - asked) > MISSED * limbs.full
        last = SAMPLES - 1 - missed[::-1].argmax(axis=0)
        least = np.where(missed.any(axis=0), asked[np.minimum(last + 1, SAMPLES - 1), np.arange(len(rest))], asked[0])
        y = np.linspace(0.0, 1.0, SAMPLES)[:, None]
        shorter = least + (rest - least) * 0.5 * (1.0 - np.cos(np.pi * y))
        longer = rest + (limbs.top - rest) * np.sin(0.5 * np.pi * y)
        directions = _solved(limbs, np.concatenate([shorter, longer[1:]]))
        directions[SAMPLES - 1] = limbs.directions
        return cls(least, rest, limbs.top, directions.swapaxes(0, 1).copy())

    @cached_property
    def _per_metre(self) -> tuple[Array, Array]:
        """What a metre is of the ways from the rest to the shortest and to the longest distance, shapes (limb,)."""
        return 1.0 / np.maximum(self.rest - self.least, TINY), 1.0 / np.maximum(self.top - self.rest, TINY)

    @cached_property
    def _rows(self) -> tuple[Array, Indices]:
        """The directions as one row for each limb and distance, and where each limb's begin."""
        limbs, distances, *shape = self.directions.shape
        starts: Indices = distances * np.arange(limbs, dtype=np.intp)
        return self.directions.reshape(limbs * distances, *shape), starts

    def at(self, distance: Array) -> Array:
        """Return directions for distances [m], shape (frame, limb) to (frame, limb, joint, 3)."""
        away = distance - self.rest
        away[np.abs(away) < 1e-12 * self.top] = 0.0  # what is the rest but for rounding is the rest
        shorter, longer = self._per_metre
        below = np.minimum(np.maximum(1.0 + away * shorter, 0.0), 1.0)
        above = np.minimum(np.maximum(away * longer, 0.0), 1.0)
        place = (SAMPLES - 1) / np.pi * (np.arccos(1.0 - 2.0 * below) + 2.0 * np.arcsin(above))
        low = np.minimum(place.astype(np.intp), 2 * SAMPLES - 3)
        part = (place - low)[..., None, None]
        rows, starts = self._rows
        low_rows = low + starts
        lower = rows.take(low_rows, axis=0)
        directions = lower + part * (rows.take(low_rows + 1, axis=0) - lower)
        return directions / quat.length(directions)[..., None]


def _solved(limbs: Limbs, distance: Array) -> Array:
    """Return the directions of bones that the particles find for distances, shape (frame, limb, joint, 3)."""
    shape = _enforced(limbs, _aimed(limbs, distance))
    return closing.close(shape, limbs.lengths, limbs.lines[None], distance)


def _aimed(limbs: Limbs, distance: Array) -> Array:
    """Return the bones of limbs that are scaled along their rest lines to a distance, shape (frame, limb, joint, 3).

    Straight ones would stay straight; they lean to their hints as they get shorter.
    """
    scale = distance / np.maximum(limbs.chords, 0.1 * limbs.full)
    lean = np.sqrt(np.maximum(1.0 - scale * scale, 0.0))
    along = quat.dot(limbs.segments, np.broadcast_to(limbs.lines[:, None], limbs.segments.shape))
    scaled = limbs.segments + ((scale - 1.0)[..., None] * along)[..., None] * limbs.lines[:, None]
    return scaled + lean[..., None, None] * limbs.leans


def _enforced(limbs: Limbs, segments: Array) -> Array:
    """Return the directions of bones whose lengths have been enforced, from the end inward, several times."""
    count = segments.shape[-2]
    softness = np.array([own.softness for own in limbs.settings])
    turns = np.array([own.outer_iterations for own in limbs.settings])
    lengths, width = limbs.lengths, softness[:, None] * np.maximum(limbs.lengths, TINY)
    # Particles are held as the bones between them: to move one is to lengthen the bone before it and shorten the next.
    bones = [segments[..., i, :] for i in range(count)]
    for turn in range(turns.max() if count > 1 else 0):
        for i in range(count - 1, -1, -1):
            distance = quat.length(bones[i])
            share = constraints.softened(distance - lengths[:, i], width[:, i]) / np.maximum(distance, TINY)
            rootward, leafward = limbs.gives[:, i, 0, None], limbs.gives[:, i, 1, None]
            most = limbs.room[:, i] / np.maximum(np.abs(share) * distance, TINY)
            change = (np.minimum(most, 1.0) * share)[..., None] * bones[i]
            change = np.where((turn < turns)[:, None], change, 0.0)
            bones[i] = bones[i] - (rootward + leafward) * change
            if i > 0:
                bones[i - 1] = bones[i - 1] + rootward * change
            if i < count - 1:
                bones[i + 1] = bones[i + 1] + leafward * change
    shape = np.stack(bones, axis=-2)
    size = quat.length(shape)[..., None]
    return np.where(size > TINY, shape / np.maximum(size, TINY), limbs.directions)
