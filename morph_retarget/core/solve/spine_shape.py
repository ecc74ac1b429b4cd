"""The bones of a spine between its branch points, Hecker 2008 §4.3.2: splines through them, and a frame along these.

`spine_closing` gives the bones back their lengths. They turn from rest by the smallest rotations from bone to bone, so
that no turn depends on how far the spine has turned in all; where the body at its end has a turn of its own, they go
over to that, as far as a neck twists.
"""

from dataclasses import dataclass

import numpy as np

from .. import quat, rotation
from ..arrays import Array, Indices
from . import constraints, spine_closing, spine_stretching
from .constraints import TINY
from .spine import Rest
from .spine_lines import carried, led, steps, tangents
from .spine_wanted import Wanted

NEAR = 0.25
"""Squared cosine of half the angle up to which bones go along with a turn of what they end at: 120 degrees."""


@dataclass(frozen=True, eq=False)
class Bent:
    """What became of a spine, in the frame of what carries it."""

    turns: Array
    """How its bones turn from rest, shape (frame or 1, joint, 3, 3)."""
    factors: Array | None = None
    """By what factors they are longer, shape (frame, joint), None where none is."""

    def at(self, rows: Indices) -> "Bent":
        """Return it in some frames."""
        return Bent(self.turns[rows], None if self.factors is None else self.factors[rows])

    def put(self, rows: Indices, other: "Bent") -> "Bent":
        """Return it with other ones in some frames."""
        self.turns[rows] = other.turns
        factors = self.factors
        if factors is None and other.factors is not None:
            factors = np.ones(self.turns.shape[:2])
        if factors is not None:
            factors[rows] = 1.0 if other.factors is None else other.factors
        return Bent(self.turns, factors)


def of(rest: Rest, wanted: Wanted, particles: Array, twists: Array, most: Array) -> Bent:
    """Return how bones turn from rest, and by what factors they are longer.

    Args:
        rest: The root-relative rest pose.
        wanted: What bends the spine.
        particles: The branch points, within reach of each other [m], shape (frame, node, 3).
        twists: How far they turn about the spine [rad], shape (frame, node).
        most: Farthest that the ends of each piece come from each other [m], shape (frame or 1, piece).
    """
    spine, pieces = rest.spine, rest.spine.pieces
    along = steps(particles)
    distance = quat.length(along)
    axes = along / np.maximum(distance, TINY)[..., None]
    swings = _swings(rest, wanted, particles, twists)
    shape = _splined(rest, particles, swings, distance)
    if shape.shape[2] > 1:
        shape = _bowed(rest, shape, swings, axes, distance)
    factors = spine_stretching.factors(spine, distance, most)
    lengths = pieces.lengths if factors is None else factors * pieces.lengths
    closed = spine_closing.close(shape, lengths, axes, distance)
    ends = (lengths[..., None] * closed).sum(axis=-2)
    closed = _turned(rotation.between(quat.unit(ends), axes), closed)
    turns = _carried(rest, wanted, twists, spine.of_bones(closed))
    if rest.is_turned:
        turns = np.matmul(turns, rest.turns)
    piece, place = spine.bone_of
    return Bent(turns, None if factors is None else factors[:, piece, place])


def _swings(rest: Rest, wanted: Wanted, particles: Array, twists: Array) -> Array:
    """Return how branch points turn from the root-relative rest pose, shape (frame, node, 3, 3).

    By the smallest rotations of tangents from one to the next. The root is known; a body with a turn of its own is not
    turned away from it, unless that leads back.
    """
    posed = tangents(particles, rest.constraints[:, 0])
    out = np.empty((*posed.shape, 3))
    out[:, 0] = rotation.IDENTITY
    out[:, 1:] = carried(rest.tangents[:, 1:], posed[:, 1:])
    if twists.any():
        out[:, 1:] = np.matmul(rotation.about(posed[:, 1:], twists[:, 1:]), out[:, 1:])
    if wanted.held.any():
        back = rotation.transposed(out[:, -1])
        share = wanted.held * _near(back)
        if (share == 1.0).all():
            out[:, -1] = rotation.IDENTITY
            return out
        left = quat.from_rotation_vector(share[:, None] * quat.to_rotation_vector(quat.from_matrix(back)))
        turned = np.matmul(quat.to_matrix(left), out[:, -1])
        out[:, -1] = np.where((share == 1.0)[:, None, None], rotation.IDENTITY, turned)
    return out


def _splined(rest: Rest, particles: Array, swings: Array, distance: Array) -> Array:
    """Return the directions of bones along splines, shape (frame, piece, bone, 3)."""
    splines = rest.spine.splines
    before, after = swings[:, :-1], swings[:, 1:]
    ratio = (distance / np.maximum(rest.chords, TINY))[..., None, None]
    posed = np.empty((*distance.shape, 6, 3))
    posed[:, :, 0], posed[:, :, 1] = particles[:, :-1], particles[:, 1:]
    posed[:, :, 2::2] = ratio * _turned(before, rest.splined[:, :, 2::2])
    posed[:, :, 3::2] = ratio * _turned(after, rest.splined[:, :, 3::2])
    places = np.matmul(splines.places, posed)
    if rest.strays:
        # What the splines do not meet turns with the nearer end, more and more with the farther one.
        parameters = splines.parameters[..., None]
        near, far = _turned(before, rest.offsets), _turned(after, rest.offsets)
        places += near + parameters * (far - near)
    bones = places[:, :, 1:] - places[:, :, :-1]
    size = quat.length(bones)[..., None]
    return np.where(size > TINY, bones / np.maximum(size, TINY), rest.spine.pieces.directions)


def _bowed(rest: Rest, shape: Array, swings: Array, axes: Array, distance: Array) -> Array:
    """Return directions of bones that are bowed the way they are at rest, shape (frame, piece, bone, 3).

    A piece that has to get shorter than its bones bows to one side or to the other, and there is no way between: so the
    side is that of its rest, whatever its ends ask for; straight ones bow to where they lean.
    """
    full, chord, square = rest.spine.pieces.full**2, rest.chords**2, distance * distance
    shorter = np.sqrt(np.maximum(chord - square, 0.0) / full)
    room = np.maximum(full - square, 0.0)
    grown = np.sqrt(room / np.maximum(full - chord, 0.01 * room + TINY * TINY * full))
    grown = 1.0 + (1.0 - rest.straight) * (grown - 1.0)
    own = grown[..., None, None] * rest.bows + shorter[..., None, None] * rest.leans
    own = _turned(led(swings[:, :-1], rest.axes, rest.backs, axes), own)
    lengths = rest.spine.pieces.lengths
    size = (lengths * quat.dot(own, own)).sum(axis=-1)
    share = (lengths * quat.dot(own, shape)).sum(axis=-1) / np.maximum(size, TINY * rest.spine.size)
    inside = np.minimum(np.maximum(share, 0.0), 1.0)
    more = np.where(share < 1.0, 0.5 + 0.5 * inside * inside - share, 0.0)
    return quat.unit(shape + more[..., None, None] * own)


def _carried(rest: Rest, wanted: Wanted, twists: Array, directions: Array) -> Array:
    """Return how bones turn from the root-relative rest pose, shape (frame, joint, 3, 3).

    A frame is carried along them by the smallest rotations from bone to bone. Twists are those of the branch points at
    both ends, and bones go over from one to the other.
    """
    out = carried(rest.directions, directions)
    piece, middles = rest.spine.bone_of[0], rest.spine.middles
    if wanted.held.any():
        back = rotation.transposed(out[:, -1])
        twists = twists.copy()
        own = wanted.held * _near(back)
        twists[:, -1] += own * (_twist(back, directions[:, -1]) - twists[:, -1])
    # What is none but for rounding is none, whatever other frames do.
    twists = np.where(np.abs(twists) < 1e-9, 0.0, twists)
    if not twists.any():
        return out
    share = (1.0 - middles) * twists.take(piece, axis=1) + middles * twists.take(piece + 1, axis=1)
    return np.matmul(rotation.about(directions, share), out)


def _turned(turns: Array, vectors: Array) -> Array:
    """Return vectors of pieces that are turned alike, shapes (frame, piece, 3, 3) and (frame or 1, piece, n, 3)."""
    return np.matmul(vectors, rotation.transposed(turns))


def _near(turned: Array) -> Array:
    """Return how near turns are, 1 up to 120 degrees and 0 by half a turn, where their axis is lost, shape (frame,)."""
    trace = turned[..., 0, 0] + turned[..., 1, 1] + turned[..., 2, 2]
    return constraints.smooth_step(0.25 * (1.0 + trace), 0.0, NEAR)


def _twist(left: Array, direction: Array) -> Array:
    """Return how far rotations turn about directions [rad], shape (...)."""
    along = quat.dot(rotation.axes_of(left), direction)
    trace = left[..., 0, 0] + left[..., 1, 1] + left[..., 2, 2]
    return 2.0 * np.arctan2(along, 1.0 + trace)
