"""The spine phase, Hecker 2008 §4.3.2: what bends the spine so that limbs, heads and mouths come to their goals.

Particles stand where several things meet, the *branch points*, with one constraint between neighbours, however many
bones there are. Limbs are single constraints from a branch point to their goals. When the iterations are over,
`spine_shape` puts the bones between the branch points in shape.

What small changes of goals change is small. So nothing is decided by comparing: corrections that end do so smoothly,
directions that vanish or turn back have been led past that before, and what nothing holds is carried along.
"""

from dataclasses import dataclass, replace

import numpy as np

from .. import quat, rotation
from ..arrays import Array, Flags
from . import constraints, spine_giving, spine_reach, spine_shape, spine_stretching
from .constraints import TINY
from .spine import Rest
from .spine_giving import Pulls
from .spine_lines import angles, steps
from .spine_shape import Bent
from .spine_wanted import Wanted

__all__ = ["Bent", "Wanted", "solve"]

MISSED, WHOLLY = 1e-4, 4e-4
"""Shares of the spine's length by which limbs may fall short of their goals before it gives way, and from which on it
does so as much as it can."""
FAR = 0.15
"""Share of the spine's length up to which it gives way the more, the more limbs fall short."""
EAGER = 1.8
"""By how much more than limbs fall short branch points give way: what else holds the spine takes part of it back."""
LEVER = 0.05
"""Share of the spine's length below which a limb's start is too near to the spine to twist it."""
_STAYS = np.zeros((1, 3))


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
    stretched: Array
    """The same where feet hold the spine back, so that it has to stretch."""
    starts: Array
    """Where limbs start, from their branch points, as far as that is known [m], shape (frame or 1, pull, 3)."""

    def at(self, rows: Flags) -> "_Work":
        """Return it in some frames."""
        if rows.all():
            return self
        some = (self.most, self.stretched, self.starts)
        most, stretched, starts = (own if len(own) == 1 else own[rows] for own in some)
        rest, wanted = self.rest.at(rows), self.wanted.at(rows)
        return _Work(rest, wanted, self.particles[rows], self.twists[rows], most, stretched, starts)


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
    spine, frames = rest.spine, len(wanted.goals)
    particles = np.repeat(rest.nodes, frames, axis=0) if len(rest.nodes) == 1 else rest.nodes.copy()
    _iterate(rest, wanted, particles)
    most = spine_stretching.most(spine, wanted.pins, wanted.pinned, wanted.goals, wanted.weights)
    most = np.maximum(most, rest.chords)
    particles, stretched = spine_reach.within(rest, wanted, particles, rest.starts, most)
    work = _Work(rest, wanted, particles, np.zeros(particles.shape[:2]), most, stretched, rest.starts)
    bent = _shaped(work)
    rows = np.arange(frames)
    for _ in range(spine.settings.refinements if spine.pulls else 0):
        short, arms, starts, missed = _short(work, bent.at(rows))
        most_short = np.maximum(quat.length(short).max(axis=1), missed)
        share = constraints.smooth_step(most_short, MISSED * spine.size, WHOLLY * spine.size)
        moving = share > 0.0
        if not moving.any():
            break
        rows = rows[moving]
        work = replace(work, starts=starts).at(moving)
        work = _given_way(work, short[moving], arms[moving], share[moving])
        bent = bent.put(rows, _shaped(work))
    return bent


def _shaped(work: _Work) -> Bent:
    """Return the bones."""
    return spine_shape.of(work.rest, work.wanted, work.particles, work.twists, work.stretched)


def _stirred(rest: Rest, wanted: Wanted) -> Flags:
    """Return in which frames anything wants the spine to bend, shape (frame,)."""
    tiny = 1e-9 * rest.spine.size
    out = (wanted.pinned[..., None] * np.abs(wanted.pins - rest.nodes)).max(axis=(1, 2)) > tiny
    for node in rest.spine.pulled:
        if out.all():
            break
        out |= np.abs(Pulls.of(rest, wanted, node).ways(rest.nodes[:, node])).max(axis=(1, 2)) > tiny
    return out


# --- iterations ---


def _iterate(rest: Rest, wanted: Wanted, particles: Array) -> None:
    """Enforce all constraints from the leaves inward, several times; what buckles is pulled back to rest."""
    spine, settings = rest.spine, rest.spine.settings
    count = particles.shape[1]
    if count == 2 and not spine.pulls:  # a single branch point has nobody to come to terms with
        wanted.bring(particles, 1)
        _unbuckle(rest, particles)
        return
    free = 1.0 - wanted.pinned[..., None]
    free[:, 0] = 0.0
    shares = free[:, 1:] / np.maximum(free[:, 1:] + free[:, :-1], TINY)
    width = settings.softness * rest.chords
    pulls = {node: Pulls.of(rest, wanted, node) for node in spine.pulled}
    for turn in range(settings.outer_iterations):
        for node in range(count - 1, 0, -1):
            own, way = particles[:, node], _STAYS
            if node in pulls:
                way = spine_giving.way(rest, wanted, particles, node, pulls[node].ways(own))
            if wanted.asked[node]:
                way = way + wanted.pinned[:, node, None] * (wanted.pins[:, node] - own - way)
            change = constraints.corrections(
                particles[:, node - 1], own + way, rest.chords[:, node - 1], width[:, node - 1]
            )
            moved = shares[:, node - 1] * change
            wanted.carry(particles, node, way - moved)
            if node > 1:
                wanted.carry(particles, node - 1, change - moved)
        if turn % 2:  # twice in five is enough to see it fold
            _unbuckle(rest, particles)
    for node in range(1, count):  # where goals do not say how near they come, pieces bow as much as they are moved
        if not free[:, node].any():
            continue
        away = particles[:, node] - particles[:, node - 1]
        kept = away * (rest.chords[:, node - 1] / np.maximum(quat.length(away), TINY))[:, None]
        start = particles[:, node - 1] + kept
        way = spine_reach.eased(rest, particles[:, node - 1], start, away - kept, node - 1) - (away - kept)
        wanted.carry(particles, node, free[:, node] * way)


def _unbuckle(rest: Rest, particles: Array) -> None:
    """Pull branch points back to the root-relative rest pose where a constraint folds over against its neighbour."""
    settings = rest.spine.settings
    lines = np.empty_like(particles)
    lines[:, 0], lines[:, 1:] = rest.constraints[:, 0], steps(particles)
    before, along, sizes = lines[:, :-1], lines[:, 1:], quat.length(lines)
    low, high = np.radians(settings.buckling_start), np.radians(settings.buckling_full)
    # Mostly nothing folds: no constraint leads far off the one before it.
    if (quat.dot(before, along) > np.cos(0.5 * low) * sizes[:, :-1] * sizes[:, 1:]).all():
        return
    fold = angles(before, along) - rest.folds
    if (fold > low).any():
        share = settings.anti_buckling * constraints.smooth_step(fold, low, high)
        particles[:, 1:] += share[..., None] * (rest.nodes[:, 1:] - particles[:, 1:])


# --- giving way ---


def _short(work: _Work, bent: Bent) -> tuple[Array, Array, Array, Array]:
    """Return how far limbs fall short of their goals, or go too far, and where they start, shapes (frame, pull, 3).

    The starts are from the joints that carry the limbs, and again from their branch points; the last is by how much the
    last branch point misses its goal [m], shape (frame,).
    """
    rest, wanted = work.rest, work.wanted
    spine, turns = rest.spine, bent.turns
    segments = spine.segments if bent.factors is None else bent.factors[..., None] * spine.segments
    places = np.zeros((len(turns), len(spine.points), 3))
    rotation.apply(turns, segments).cumsum(axis=1, out=places[:, 1:])
    arms = rotation.apply(turns.take(spine.pull_joints, axis=1), spine.pull_starts)
    starts = places.take(spine.pull_joints, axis=1) + arms
    away = wanted.goals - starts
    distance = quat.length(away)
    error = np.maximum(distance - spine.reach, 0.0) + np.minimum(distance - spine.folded, 0.0)
    # What is out of reach anyway pulls no harder than what is just beyond.
    error = error / np.sqrt(1.0 + (error / (FAR * spine.size)) ** 2)
    share = wanted.weights * error / np.maximum(distance, TINY)
    missed = wanted.pinned[:, -1] * quat.length(places[:, spine.nodes[-1]] - wanted.pins[:, -1])
    return share[..., None] * away, arms, starts - places.take(spine.pull_points, axis=1), missed


def _given_way(work: _Work, short: Array, arms: Array, share: Array) -> _Work:
    """Return branch points that have moved and twisted so that limbs come nearer to their goals.

    Args:
        work: The branch points and their twists.
        short: How far limbs fall short [m], shape (frame, pull, 3).
        arms: Where they start, from the joints that carry them [m], shape (frame, pull, 3).
        share: How much of it they do, shape (frame,).
    """
    spine, particles, twists = work.rest.spine, work.particles.copy(), work.twists.copy()
    most, least = np.radians(spine.settings.twist), (LEVER * spine.size) ** 2
    for node, own in spine.pulled.items():
        ways, lever = short.take(own.pulls, axis=1), arms.take(own.pulls, axis=1)
        axis = particles[:, node] - particles[:, node - 1]
        axis = (axis / np.maximum(quat.length(axis), TINY)[:, None])[:, None]
        lever = spine.twist_shares[own.pulls][:, None] * (lever - np.matmul(lever, axis.swapaxes(1, 2)) * axis)
        # What each adds to the twist that would bring its limb nearest.
        turning = np.matmul(rotation.cross(lever, ways), axis.swapaxes(1, 2)).sum(axis=(1, 2))
        twist = twists[:, node] + EAGER * share * turning / ((lever * lever).sum(axis=(1, 2)) + least)
        twists[:, node] = np.minimum(np.maximum(twist, -most), most)
        held = particles[:, node - 1]
        way = EAGER * spine_giving.way(work.rest, work.wanted, particles, node, ways)
        work.wanted.carry(particles, node, spine_reach.eased(work.rest, held, particles[:, node], way, node - 1))
    particles, stretched = spine_reach.within(work.rest, work.wanted, particles, work.starts, work.most)
    # Part of the way there is between the two, and within reach as both are.
    particles = work.particles + share[:, None, None] * (particles - work.particles)
    return replace(work, particles=particles, twists=twists, stretched=stretched)
