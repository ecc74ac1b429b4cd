"""Branch points within reach of each other, Hecker 2008 §4.3.2: a projection, and no piece folds over.

Where a piece would have to lead back along the one before it, or its ends would coincide, it has no direction that
follows its goals: so toward that it turns back to where it would be carried. What is out of its own reach is nearest
to the goal; what lies behind its back is implausible (§4.3), and fails gracefully.
"""

import numpy as np

from .. import quat, rotation
from ..arrays import Array
from . import constraints, spine_closing, spine_stretching
from .constraints import TINY
from .spine import FOLD, Rest
from .spine_lines import angles, led, steps
from .spine_wanted import Wanted

BOW = 1.0
"""How much a piece bows, as the square root of the share by which it is shorter, for a way of all of its length."""
PRESSED = 0.98
"""Share of its length to which limbs alone press a piece together: it would zigzag, and they gain little by that."""
SLOW = 0.999
"""Share of its length from which on the spine slows down toward goals that it cannot reach."""


def within(rest: Rest, wanted: Wanted, particles: Array, starts: Array, most: Array) -> tuple[Array, Array]:
    """Return branch points within reach of each other [m], shape (frame, node, 3), and what ``most`` became for that.

    Args:
        rest: The root-relative rest pose.
        wanted: What bends the spine.
        particles: The branch points [m], shape (frame, node, 3).
        starts: Where limbs start, from their branch points [m], shape (frame or 1, pull, 3).
        most: Farthest that the ends of each piece come from each other [m], shape (frame or 1, piece).
    """
    out, least = particles.copy(), _least(rest, wanted)
    last = out.shape[1] - 1
    for node in range(last, 0, -1):
        wanted.bring(out, node)
        if node > 1:
            way = _apart(out[:, node], out[:, node - 1], least[:, node - 1], most[:, node - 1])
            out[:, node - 1] += way if wanted.counts is None else wanted.counts[:, node, None] * way
    _outward(rest, wanted, out, least, most)
    _arrive(rest, wanted, out, 0, most)
    _return(rest, wanted, out, most)
    held = rest.spine.held
    if held:  # the trunk does not leave behind what feet hold
        wanted.carry(out, held, constraints.together(_held_back(rest, wanted, out, starts, held)))
        way = wanted.pins[:, -1] - out[:, held]
        most = spine_stretching.from_held(rest.spine, held, way, wanted.pinned[:, -1], most)
        _arrive(rest, wanted, out, held, most)
    if held or last > 1:
        _outward(rest, wanted, out, least, most)
    return out, most


def eased(rest: Rest, held: Array, moved: Array, way: Array, piece: int) -> Array:
    """Return the way of a branch point that takes it nearer to the one before it the less, the straighter the piece.

    A straight piece that gets shorter bows by the square root of that: it would swing what it carries away farther than
    it brings it nearer. So its bow grows as the way does.

    Args:
        rest: The root-relative rest pose.
        held: The branch point before it [m], shape (frame, 3).
        moved: The branch point [m], shape (frame, 3).
        way: How far it wants to move [m], shape (frame, 3).
        piece: The piece between them.
    """
    full = rest.spine.pieces.full[piece]
    own = moved - held
    before = quat.length(own)
    axis = own / np.maximum(before, TINY)[:, None]
    inward = np.maximum(-quat.dot(way, axis), 0.0)
    bow = np.sqrt(np.maximum(1.0 - before / full, 0.0)) + BOW * inward / full
    nearer = np.minimum(inward, np.maximum(before - full * (1.0 - bow * bow), 0.0))
    return way + (inward - nearer)[:, None] * axis


def _least(rest: Rest, wanted: Wanted) -> Array:
    """Return the nearest that the ends of each piece come to each other [m], shape (frame or 1, piece)."""
    if not wanted.is_loose:
        return rest.least
    pressed = np.maximum(rest.least, np.minimum(PRESSED * rest.spine.pieces.full, rest.chords))
    return rest.least + wanted.loose * (pressed - rest.least)


def _apart(held: Array, moved: Array, least: Array, most: Array) -> Array:
    """Return the way by which a branch point comes within reach of one farther out [m], shape (frame, 3).

    Where the two all but coincide, nothing tells which way to part: the nearer they are, the less they do.
    """
    away = moved - held
    distance = quat.length(away)
    wanted = np.minimum(np.maximum(distance, least), most)
    return (wanted / np.maximum(distance, 0.5 * least + TINY) - 1.0)[:, None] * away


def _outward(rest: Rest, wanted: Wanted, particles: Array, least: Array, most: Array) -> None:
    """Bring each branch point within reach of the one before it, and to where its piece does not fold over."""
    before, size, carrying = rest.constraints[:, 0], rest.chords[:, 0], _Carrying(rest, particles)
    for node in range(1, particles.shape[1]):
        piece = node - 1
        away = particles[:, node] - particles[:, piece]
        distance, nearest = quat.length(away), least[:, piece]
        reach = np.minimum(np.maximum(distance, nearest), most[:, piece])
        came = (reach / np.maximum(distance, TINY))[:, None] * away
        folded = (quat.dot(before, away) < rest.levels[:, piece] * size * distance) | (distance < nearest)
        rows = np.flatnonzero(folded)
        if len(rows):
            home, share = carrying.direction(piece), distance / np.maximum(nearest, TINY)
            own = home if len(home) == 1 else home[rows]
            came[rows] = reach[rows, None] * _unfolded(away[rows], own, share[rows])
        wanted.carry(particles, node, came - away)
        before, size = came, reach


class _Carrying:
    """Where pieces are carried by those before them, found from one to the next as far as it is asked for."""

    def __init__(self, rest: Rest, particles: Array) -> None:
        self._rest, self._particles = rest, particles
        self._turn, self._done = rotation.IDENTITY[None], 0

    def direction(self, piece: int) -> Array:
        """Return where a piece is carried, unit vectors, shape (frame or 1, 3); never one before the last asked for."""
        rest, particles = self._rest, self._particles
        for i in range(self._done, piece):
            own = quat.unit(particles[:, i + 1] - particles[:, i])
            self._turn = led(self._turn, rest.axes[:, i], rest.backs[:, i], own)
        self._done = piece
        return rotation.apply(self._turn, rest.axes[:, piece])


def _unfolded(away: Array, home: Array, share: Array) -> Array:
    """Return directions that go back to where they are carried as ways vanish or fold over, shape (frame, 3).

    Args:
        away: The ways [m], shape (frame, 3).
        home: Where they are carried, unit vectors, shape (frame or 1, 3).
        share: Lengths of the ways over the least that they may have, shape (frame,).
    """
    angle = angles(home, away)
    wanted = angle * (1.0 - constraints.smooth_step(angle, FOLD, np.pi)) * constraints.smooth_step(share, 0.0, 1.0)
    aside = quat.unit(away - quat.dot(away, home)[:, None] * home)
    return np.cos(wanted)[:, None] * home + np.sin(wanted)[:, None] * aside


def _held_back(rest: Rest, wanted: Wanted, particles: Array, starts: Array, node: int) -> Array:
    """Return how far limbs hold their branch point back that it must not leave behind, shape (frame, limb, 3)."""
    own = rest.spine.pulled[node]
    away = wanted.goals.take(own.pulls, axis=1) - starts.take(own.pulls, axis=1) - particles[:, node, None]
    distance = quat.length(away)
    share = wanted.weights.take(own.pulls, axis=1) * np.maximum(distance - own.full, 0.0)
    return (share / np.maximum(distance, TINY))[..., None] * away


def _arrive(rest: Rest, wanted: Wanted, particles: Array, first: int, most: Array) -> None:
    """Bring the last branch point to its goal, where the constraints from a branch point on can reach it together.

    Bringing neighbours within reach, one after the other, gets there only slowly when the spine is nearly straight.
    """
    if particles.shape[1] - first < 3 or not wanted.asked[-1]:
        return
    way = wanted.pinned[:, -1, None] * (wanted.pins[:, -1] - particles[:, -1])
    rows = np.flatnonzero(np.abs(way).max(axis=-1) > 1e-9 * rest.spine.size)
    if not len(rows):
        return
    own, most = particles[rows, first:], (most if len(most) == 1 else most[rows])[:, first:]
    goal = own[:, -1] + way[rows] - own[:, 0]
    distance = quat.length(goal)
    along = steps(own)
    lengths = np.minimum(quat.length(along), most)
    missing, room = np.maximum(distance - lengths.sum(axis=-1), 0.0), most - lengths
    lengths = lengths + np.minimum(missing / np.maximum(room.sum(axis=-1), TINY), 1.0)[:, None] * room
    chord = quat.length(rest.nodes[:, -1] - rest.nodes[:, first])
    distance = _slowed(distance, chord if len(chord) == 1 else chord[rows], lengths.sum(axis=-1))
    axis = quat.unit(goal)
    chain = spine_closing.close(quat.unit(along)[:, None], lengths[:, None], axis[:, None], distance[:, None])[:, 0]
    ends = (lengths[..., None] * chain).sum(axis=1)
    chain = rotation.apply(rotation.between(quat.unit(ends), axis)[:, None], chain)
    particles[rows, first + 1 :] = own[:, :1] + (lengths[..., None] * chain).cumsum(axis=1)


def _return(rest: Rest, wanted: Wanted, particles: Array, most: Array) -> None:
    """Bring branch points back to goals of their own from where one that is farther out has drawn them."""
    for node in range(1, len(wanted.asked) - 1):
        if not wanted.asked[node]:
            continue
        rows = wanted.pinned[:, node] > 0.0
        own, moved = wanted.at(rows), particles[rows]
        own.bring(moved, node)
        _arrive(rest.at(rows), own, moved, node, most if len(most) == 1 else most[rows])
        particles[rows] += own.pinned[:, node, None, None] * (moved - particles[rows])


def _slowed(distance: Array, chord: Array, full: Array) -> Array:
    """Return distances within reach [m], shape (frame,): those next to the longest are approached ever more slowly.

    A chain that is nearly straight bends by the square root of what it is shorter.
    """
    soft = np.minimum(np.maximum(SLOW * full, chord), full)
    room = np.maximum(0.9 * (full - soft), TINY)
    beyond = np.maximum(distance - soft, 0.0)
    return np.minimum(distance, soft) - room * np.expm1(-beyond / room)
