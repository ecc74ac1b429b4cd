"""The spine phase, Hecker 2008 §4.3.2: what bends the spine so that limbs, heads and mouths come to their goals.

Particles stand where several things meet, the *branch points*, with one constraint between neighbours, however many
bones there are. Limbs are single constraints from a branch point to their goals. When the iterations are over, splines
put the bones between the branch points in shape, and `closing` gives them back their lengths.
"""

from dataclasses import dataclass

import numpy as np

from .. import quat, rotation
from ..arrays import Array, Flags, Indices
from . import closing, constraints, spine_stretching
from .constraints import TINY
from .spine import Rest, Spine, tangents, transported

PASSES = 2
"""How often branch points are brought within reach of each other, inward and outward."""
MISSED = 1e-4
"""Share of the spine's length by which limbs may fall short of their goals before it gives way."""
FAR = 0.15
"""Share of the spine's length up to which it gives way the more, the more limbs fall short."""
EAGER = 2.0
"""By how much more than limbs fall short branch points give way: what else holds the spine takes part of it back."""


@dataclass(frozen=True, eq=False)
class Wanted:
    """What bends a spine, in the frame of what carries it and from its first joint."""

    pins: Array
    """Goals of the branch points themselves [m], shape (frame, node, 3)."""
    pinned: Array
    """How much they count, 0 where a branch point has none, shape (frame, node)."""
    goals: Array
    """Where the limbs that pull shall end [m], shape (frame, pull, 3)."""
    weights: Array
    """How much they count, shape (frame, pull)."""
    held: Array
    """How far the body at the last branch point has a turn of its own, shape (frame,)."""

    def at(self, rows: Flags) -> "Wanted":
        """Return what is wanted in some frames."""
        return Wanted(self.pins[rows], self.pinned[rows], self.goals[rows], self.weights[rows], self.held[rows])


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


@dataclass(frozen=True, eq=False)
class _Work:
    """A spine in the making."""

    rest: Rest
    wanted: Wanted
    particles: Array
    """The branch points [m], shape (frame, node, 3)."""
    twists: Array
    """How far they turn about the spine [rad], shape (frame, node)."""
    most: Array
    """Farthest that the ends of each piece come from each other [m], shape (frame or 1, piece)."""
    starts: Array
    """Where limbs start, from their branch points, as far as that is known [m], shape (frame or 1, pull, 3)."""

    def at(self, rows: Flags, starts: Array) -> "_Work":
        """Return what is left to do in some frames, where it is known by now where limbs start."""
        most = self.most if len(self.most) == 1 else self.most[rows]
        rest, wanted = self.rest.at(rows), self.wanted.at(rows)
        return _Work(rest, wanted, self.particles[rows], self.twists[rows], most, starts)


def solve(rest: Rest, wanted: Wanted) -> Bent:
    """Return how a spine bends, and stretches if it may.

    Args:
        rest: The root-relative rest pose.
        wanted: What bends it.
    """
    stirred = _stirred(rest, wanted)
    if stirred.all():
        return _solved(rest, wanted)
    if not stirred.any():
        return Bent(rest.turns)
    still = Bent(np.broadcast_to(rest.turns, (len(stirred), *rest.turns.shape[1:])).copy())
    return still.put(np.flatnonzero(stirred), _solved(rest.at(stirred), wanted.at(stirred)))


def _solved(rest: Rest, wanted: Wanted) -> Bent:
    """Return how a spine bends in frames in which it has to."""
    particles = np.repeat(rest.nodes, len(wanted.goals), axis=0) if len(rest.nodes) == 1 else rest.nodes.copy()
    _iterate(rest, wanted, particles)
    most = spine_stretching.most(rest.spine, wanted.pins, wanted.pinned, wanted.goals, wanted.weights)
    work = _Work(rest, wanted, particles, np.zeros(particles.shape[:2]), most, rest.starts)
    bent = _reconstructed(work)
    rows: Indices = np.arange(len(bent.turns))
    for _ in range(rest.spine.settings.refinements if rest.spine.pulls else 0):
        short, arms, starts, missed = _short(work, bent.at(rows))
        still = np.maximum(np.abs(short).max(axis=(1, 2)), missed) > MISSED * rest.spine.size
        if not still.any():
            break
        rows, work = rows[still], work.at(still, starts[still])
        _give_way(work, short[still], arms[still])
        bent = bent.put(rows, _reconstructed(work))
    return bent


def _give_way(work: _Work, short: Array, arms: Array) -> None:
    """Move and twist branch points so that limbs come nearer to their goals.

    Args:
        work: The branch points and their twists.
        short: How far limbs fall short [m], shape (frame, pull, 3).
        arms: Where they start, from the joints that carry them [m], shape (frame, pull, 3).
    """
    spine, particles, twists = work.rest.spine, work.particles, work.twists
    most = np.radians(spine.settings.twist)
    for node, own in spine.pulled.items():
        ways, lever = short.take(own.pulls, axis=1), arms.take(own.pulls, axis=1)
        axis = particles[:, node] - particles[:, node - 1]
        axis = (axis / np.maximum(quat.length(axis), TINY)[:, None])[:, None]
        lever = spine.twist_shares[own.pulls][:, None] * (lever - np.matmul(lever, axis.swapaxes(1, 2)) * axis)
        # What each adds to the twist that would bring its limb nearest.
        turning = np.matmul(rotation.cross(lever, ways), axis.swapaxes(1, 2)).sum(axis=(1, 2))
        twist = twists[:, node] + EAGER * turning / np.maximum((lever * lever).sum(axis=(1, 2)), TINY)
        twists[:, node] = np.minimum(np.maximum(twist, -most), most)
        particles[:, node] += EAGER * constraints.together(ways)


def _stirred(rest: Rest, wanted: Wanted) -> Flags:
    """Return in which frames anything wants the spine to bend, shape (frame,)."""
    tiny = 1e-9 * rest.spine.size
    out = (wanted.pinned[..., None] * np.abs(wanted.pins - rest.nodes)).max(axis=(1, 2)) > tiny
    for node in rest.spine.pulled:
        if out.all():
            break
        out |= np.abs(_pulled(rest, wanted, rest.nodes, node)).max(axis=(1, 2)) > tiny
    return out


def _iterate(rest: Rest, wanted: Wanted, particles: Array) -> None:
    """Enforce all constraints from the leaves inward, several times; what buckles is pulled back to rest."""
    spine, settings = rest.spine, rest.spine.settings
    count = particles.shape[1]
    if count == 2 and not spine.pulls:  # a single branch point has nobody to come to terms with
        particles[:, 1] += wanted.pinned[:, 1, None] * (wanted.pins[:, 1] - particles[:, 1])
        _unbuckle(rest, particles)
        return
    free = 1.0 - wanted.pinned[..., None]
    free[:, 0] = 0.0
    shares = free[:, 1:] / np.maximum(free[:, 1:] + free[:, :-1], TINY)
    pinned = [bool(own.any()) for own in wanted.pinned.T]
    width = settings.softness * rest.chords
    for turn in range(settings.outer_iterations):
        for node in range(count - 1, 0, -1):
            own = particles[:, node]
            if node in spine.pulled:
                own += constraints.together(_pulled(rest, wanted, particles, node))
            if pinned[node]:
                own += wanted.pinned[:, node, None] * (wanted.pins[:, node] - own)
            change = constraints.corrections(particles[:, node - 1], own, rest.chords[:, node - 1], width[:, node - 1])
            moved = shares[:, node - 1] * change
            own -= moved
            if node > 1:
                particles[:, node - 1] += change - moved
        if turn % 2:  # twice in five is enough to see it fold
            _unbuckle(rest, particles)


def _pulled(rest: Rest, wanted: Wanted, particles: Array, node: int) -> Array:
    """Return how far limbs move their branch point, shape (frame, limb, 3)."""
    own = rest.spine.pulled[node]
    away = wanted.goals[:, own.pulls] - rest.starts[:, own.pulls] - particles[:, node, None]
    distance = quat.length(away)
    error = constraints.beyond(distance, own.start, own.full, own.least)
    return (wanted.weights[:, own.pulls] * error / np.maximum(distance, TINY))[..., None] * away


def _held_back(work: _Work, node: int) -> Array:
    """Return how far limbs hold their branch point back that it must not leave behind, shape (frame, limb, 3)."""
    own, wanted = work.rest.spine.pulled[node], work.wanted
    away = wanted.goals[:, own.pulls] - work.starts[:, own.pulls] - work.particles[:, node, None]
    distance = quat.length(away)
    share = wanted.weights[:, own.pulls] * np.maximum(distance - own.full, 0.0)
    return (share / np.maximum(distance, TINY))[..., None] * away


def _unbuckle(rest: Rest, particles: Array) -> None:
    """Pull branch points back to the root-relative rest pose where a constraint folds over against its neighbour."""
    settings = rest.spine.settings
    along = np.diff(particles, axis=1)
    before = np.concatenate([np.broadcast_to(rest.constraints[:, :1], along[:, :1].shape), along[:, :-1]], axis=1)
    low, high = np.radians(settings.buckling_start), np.radians(settings.buckling_full)
    # Mostly nothing folds: no constraint leads far off the one before it.
    if (quat.dot(before, along) > np.cos(0.5 * low) * quat.length(before) * quat.length(along)).all():
        return
    fold = _angles(before, along) - rest.folds
    if (fold > low).any():
        share = settings.anti_buckling * constraints.smooth_step(fold, low, high)
        particles[:, 1:] += share[..., None] * (rest.nodes[:, 1:] - particles[:, 1:])


def _short(work: _Work, bent: Bent) -> tuple[Array, Array, Array, Array]:
    """Return how far limbs fall short of their goals, or go too far, and where they start, shapes (frame, pull, 3).

    The starts are from the joints that carry the limbs, and again from their branch points; the last is by how much the
    last branch point misses its goal [m], shape (frame,).
    """
    rest, wanted = work.rest, work.wanted
    spine, turns = rest.spine, bent.turns
    segments = spine.segments if bent.factors is None else bent.factors[..., None] * spine.segments
    bones = np.cumsum(rotation.apply(turns, segments), axis=1)
    places = np.concatenate([np.zeros((len(bones), 1, 3)), bones], axis=1)
    joints = [pull.joint for pull in spine.pulls]
    arms = rotation.apply(turns[:, joints], np.array([pull.start for pull in spine.pulls]))
    away = wanted.goals - places[:, joints] - arms
    distance = quat.length(away)
    error = np.maximum(distance - spine.reach, 0.0) + np.minimum(distance - spine.folded, 0.0)
    # What is out of reach anyway pulls no harder than what is just beyond.
    error = error / np.sqrt(1.0 + (error / (FAR * spine.size)) ** 2)
    share = wanted.weights * error / np.maximum(distance, TINY)
    nodes = [spine.nodes[pull.node] for pull in spine.pulls]
    missed = wanted.pinned[:, -1] * quat.length(places[:, spine.nodes[-1]] - wanted.pins[:, -1])
    return share[..., None] * away, arms, places[:, joints] + arms - places[:, nodes], missed


def _project(rest: Rest, wanted: Wanted, particles: Array, most: Array) -> None:
    """Bring neighbouring branch points within reach of each other, first from the outermost inward."""
    spine, count = rest.spine, particles.shape[1]
    for _ in range(PASSES if count > 2 else 1):
        for node in range(count - 1, 0, -1):
            particles[:, node] += wanted.pinned[:, node, None] * (wanted.pins[:, node] - particles[:, node])
            if node > 1:
                particles[:, node - 1] = _within(particles[:, node], particles[:, node - 1], spine, node - 1, most)
        for node in range(1, count):
            particles[:, node] = _within(particles[:, node - 1], particles[:, node], spine, node - 1, most)


def _arrive(rest: Rest, wanted: Wanted, particles: Array, first: int, most: Array) -> None:
    """Bring the last branch point to its goal, where the constraints from a branch point on can reach it together.

    Bringing neighbours within reach, one after the other, gets there only slowly when the spine is nearly straight.
    """
    way = wanted.pinned[:, -1, None] * (wanted.pins[:, -1] - particles[:, -1])
    rows = np.flatnonzero(np.abs(way).max(axis=-1) > 1e-9 * rest.spine.size)
    if particles.shape[1] - first < 3 or not len(rows):
        return
    own, most = particles[rows, first:], (most if len(most) == 1 else most[rows])[:, first:]
    goal = own[:, -1] + way[rows] - own[:, 0]
    distance = quat.length(goal)
    along = np.diff(own, axis=1)
    lengths = np.minimum(quat.length(along), most)
    missing, room = np.maximum(distance - lengths.sum(axis=-1), 0.0), most - lengths
    lengths = lengths + np.minimum(missing / np.maximum(room.sum(axis=-1), TINY), 1.0)[:, None] * room
    distance = np.minimum(distance, lengths.sum(axis=-1))
    axis = quat.unit(goal)
    chain = closing.close(quat.unit(along)[:, None], lengths[:, None], axis[:, None], distance[:, None])[:, 0]
    ends = (lengths[..., None] * chain).sum(axis=1)
    chain = rotation.apply(rotation.between(quat.unit(ends), axis)[:, None], chain)
    particles[rows, first + 1 :] = own[:, :1] + np.cumsum(lengths[..., None] * chain, axis=1)


def _within(held: Array, moved: Array, spine: Spine, piece: int, most: Array) -> Array:
    """Return a particle moved to within the reach of a piece from another one, shape (frame, 3)."""
    away = moved - held
    distance = quat.length(away)
    wanted = np.minimum(np.maximum(distance, spine.least[piece]), most[:, piece])
    return held + (wanted / np.maximum(distance, TINY))[:, None] * away


def _reconstructed(work: _Work) -> Bent:
    """Return how the bones turn from rest, after bringing the branch points within reach of each other."""
    rest, wanted, particles, twists, most = work.rest, work.wanted, work.particles, work.twists, work.most
    _project(rest, wanted, particles, most)
    _arrive(rest, wanted, particles, 0, most)
    if held := rest.spine.held:  # the trunk does not leave behind what feet hold
        particles[:, held] += constraints.together(_held_back(work, held))
        way = wanted.pins[:, -1] - particles[:, held]
        most = spine_stretching.from_held(rest.spine, held, way, wanted.pinned[:, -1], most)
        _arrive(rest, wanted, particles, held, most)
        for node in range(1, particles.shape[1]):
            particles[:, node] = _within(particles[:, node - 1], particles[:, node], rest.spine, node - 1, most)
    spine, pieces = rest.spine, rest.spine.pieces
    along = np.diff(particles, axis=1)
    distance = quat.length(along)
    axes = along / np.maximum(distance, TINY)[..., None]
    swings = _swings(rest, wanted, particles, twists)
    shape = _splined(rest, particles, swings, distance)
    lean = np.sqrt(np.maximum(1.0 - (distance / spine.most) ** 2, 0.0))
    leaning = (lean > 0.0)[..., None, None]
    if spine.leans.any() and leaning.any():
        aside = rotation.apply(np.matmul(swings[:, :-1, None], rest.piece_turns[:, :, :1]), spine.leans)
        shape = np.where(leaning, quat.unit(shape + lean[..., None, None] * aside), shape)
    factors = spine_stretching.factors(spine, distance, most)
    lengths = pieces.lengths if factors is None else factors * pieces.lengths
    closed = closing.close(shape, lengths, axes, distance)
    ends = (lengths[..., None] * closed).sum(axis=-2)
    closed = rotation.apply(rotation.between(quat.unit(ends), axes)[:, :, None], closed)
    turns = _carried(rest, swings, closed)
    if rest.is_turned:
        turns = np.matmul(turns, rest.piece_turns)
    piece, place = spine.bone_of
    return Bent(turns[:, piece, place], None if factors is None else factors[:, piece, place])


def _swings(rest: Rest, wanted: Wanted, particles: Array, twists: Array) -> Array:
    """Return how branch points turn from the root-relative rest pose, by the smallest rotation of tangents.

    Shape (frame, node, 3, 3). The root is known; a body with a turn of its own is not turned away from it.
    """
    posed = tangents(particles, rest.constraints[:, 0])
    out = rotation.between(rest.tangents, posed)
    if twists.any():
        out = np.matmul(quat.to_matrix(quat.from_axis_angle(posed, twists)), out)
    out[:, 0] = rotation.IDENTITY
    out[wanted.held == 1.0, -1] = rotation.IDENTITY
    part = np.flatnonzero((wanted.held != 0.0) & (wanted.held != 1.0))
    if len(part):
        left = (1.0 - wanted.held[part, None]) * quat.to_rotation_vector(quat.from_matrix(out[part, -1]))
        out[part, -1] = quat.to_matrix(quat.from_rotation_vector(left))
    return out


def _splined(rest: Rest, particles: Array, swings: Array, distance: Array) -> Array:
    """Return the directions of bones along splines, shape (frame, piece, bone, 3)."""
    splines = rest.spine.splines
    before, after = swings[:, :-1, None], swings[:, 1:, None]
    ratio = (distance / np.maximum(rest.chords, TINY))[..., None, None]
    posed = np.empty((*distance.shape, 6, 3))
    posed[:, :, 0], posed[:, :, 1] = particles[:, :-1], particles[:, 1:]
    posed[:, :, 2::2] = ratio * rotation.apply(before, rest.splined[:, :, 2::2])
    posed[:, :, 3::2] = ratio * rotation.apply(after, rest.splined[:, :, 3::2])
    places = np.matmul(splines.places, posed)
    if rest.strays:
        # What the splines do not meet turns with the nearer end, more and more with the farther one.
        parameters = splines.parameters[..., None]
        near, far = rotation.apply(before, rest.offsets), rotation.apply(after, rest.offsets)
        places += near + parameters * (far - near)
    bones = np.diff(places, axis=2)
    size = quat.length(bones)[..., None]
    return np.where(size > TINY, bones / np.maximum(size, TINY), rest.spine.pieces.directions)


def _carried(rest: Rest, swings: Array, directions: Array) -> Array:
    """Return how bones turn from the rest pose that a frame carries along them, shape (frame, piece, bone, 3, 3).

    It is carried by the smallest rotations from bone to bone, at rest and posed. What is left to the turns of the
    branch points at both ends are twists, and the bones go over from one to the other.
    """
    directions = rest.spine.unpadded(directions)
    first = np.broadcast_to(rest.directions[:, :, 0], directions[:, :, 0].shape)
    moving = transported(first, directions)
    out = np.matmul(moving, rest.back)
    ends = np.stack([swings[:, :-1], swings[:, 1:]], axis=2)
    both = [0, -1]
    twist = _twist(np.matmul(ends, rotation.transposed(out[:, :, both])), directions[:, :, both])
    # What is none but for rounding is none, whatever other frames do.
    twist[np.abs(twist) < 1e-9] = 0.0
    if not twist.any():
        return out
    t = rest.spine.splines.middles
    share = (1.0 - t) * twist[..., :1] + t * twist[..., 1:]
    return np.matmul(quat.to_matrix(quat.from_axis_angle(directions, share)), out)


def _twist(left: Array, direction: Array) -> Array:
    """Return how far rotations turn about directions [rad], shape (...)."""
    axis = np.stack([left[..., i, j] - left[..., j, i] for i, j in ((2, 1), (0, 2), (1, 0))], axis=-1)
    along = quat.dot(axis, direction)
    trace = left[..., 0, 0] + left[..., 1, 1] + left[..., 2, 2]
    return 2.0 * np.arctan2(along, 1.0 + trace)


def _angles(a: Array, b: Array) -> Array:
    """Return the angles between vectors [rad]."""
    return np.arctan2(quat.length(quat.cross(a, b)), quat.dot(a, b))
