"""Enforcing foot and hand positions on transferred motion (Feng 2013 §4.2, §5.2)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .. import quat
from ..arrays import Array, Flags, Indices
from ..smoothing import moving_average, upper_envelope
from ..solve import jacobian_ik
from ..solve.jacobian_ik import Effector, JacobianSettings, Problem
from .links import NONE, LimbLinks

REACH = 0.9985
"""Legs are kept a trifle short of straight, where a millimetre of reach costs degrees of knee."""
DROP_TIME = 0.15
"""The hips sink to let a foot reach its place, and rise again, over about this time [s]."""


@dataclass(frozen=True, eq=False)
class Solved:
    """Turns and what the solver could not do."""

    turns: Array
    """Shape (frame, link, 4)."""
    error: Array
    """Largest distance of an end from its place [m], shape (frame,)."""


def reach(leg: LimbLinks, rest: Array) -> float:
    """Return the length of a straight limb on the target [m]."""
    steps = np.diff(rest[list(leg.chain)], axis=0)
    return float(np.linalg.norm(steps, axis=-1).sum())


def hips_drop(
    legs: Sequence[LimbLinks], roots: Array, targets: Array, standing: Flags, rest: Array, seconds_per_frame: float
) -> Array:
    """Return how far the hips must sink for all standing feet to be reached, smooth over time [m], shape (frame,).

    Args:
        legs: Of the pair.
        roots: Place of each hip joint, shape (frame, foot, 3).
        targets: Where the ankles shall be, shape (frame, foot, 3).
        standing: Whether each foot stands, shape (frame, foot).
        rest: Place of each link at rest, shape (link, 3).
        seconds_per_frame: Of the clip [s].
    """
    need = np.zeros(len(roots))
    for f, leg in enumerate(legs):
        away = roots[:, f] - targets[:, f]
        longest = REACH * reach(leg, rest)
        level = np.sum(away[:, :2] ** 2, axis=-1)
        highest = np.sqrt(np.maximum(longest**2 - level, (0.3 * longest) ** 2))
        need = np.maximum(need, np.where(standing[:, f], away[:, 2] - highest, 0.0))
    return upper_envelope(need, max(round(DROP_TIME / seconds_per_frame), 1)) if need.any() else need


def hips_follow(transferred: Array, targets: Array, standing: Flags, seconds_per_frame: float) -> Array:
    """Return by how much the hips shall rise for the standing feet to be where they are meant to, shape (frame,) [m].

    Bodies of other proportions reach another height with the same joint angles; the hips make up for that, so that
    knees need not. Of two standing feet the lower one counts: bending a leg looks better than overstretching it.

    Args:
        transferred: Ankles as transferred, shape (frame, foot, 3).
        targets: Where they shall be, shape (frame, foot, 3).
        standing: Whether each foot stands, shape (frame, foot).
        seconds_per_frame: Of the clip [s].
    """
    rise: Array = np.where(standing, (targets - transferred)[..., 2], np.inf).min(axis=1)
    known = np.flatnonzero(np.isfinite(rise))
    if not len(known):
        return np.zeros(len(transferred))
    bridged = np.interp(np.arange(len(rise)), known, rise[known])
    return moving_average(bridged, max(round(DROP_TIME / seconds_per_frame), 1))


SOFT_REACH = 0.93
"""A leg in the air that is to reach farther than this share of its length is slowed down on the way to straight."""
SOFT_TIME = 0.03
"""Time over which that sets in after a foot leaves, and ends before it lands [s]."""


def soften_reach(
    legs: Sequence[LimbLinks], roots: Array, targets: Array, standing: Flags, rest: Array, seconds_per_frame: float
) -> Array:
    """Return ``targets`` such that no leg snaps straight in the air, shape (frame, foot, 3).

    The last bit of reach costs a knee most of its turn, so the way out is eased there. Standing feet are left alone.

    Args:
        legs: Of the pair.
        roots: Place of each hip joint, shape (frame, foot, 3).
        targets: Where the ankles shall be, shape (frame, foot, 3).
        standing: Whether each foot stands, shape (frame, foot).
        rest: Place of each link at rest, shape (link, 3).
        seconds_per_frame: Of the clip [s].
    """
    out = targets.copy()
    width = max(round(SOFT_TIME / seconds_per_frame), 1)
    for f, leg in enumerate(legs):
        away = targets[:, f] - roots[:, f]
        share: Array = quat.length(away) / reach(leg, rest)
        room = REACH - SOFT_REACH
        slowed: Array = REACH - room * np.exp(-(share - SOFT_REACH) / room)
        eased = np.where(share > SOFT_REACH, slowed, share)
        weight = 1.0 - np.minimum(upper_envelope(standing[:, f].astype(np.float64), width), 1.0)
        shrink = 1.0 + weight * (eased / np.maximum(share, 1e-9) - 1.0)
        out[:, f] = roots[:, f] + shrink[:, None] * away
    return out


def enforce(
    limbs: Sequence[LimbLinks],
    turns: Array,
    points: Array,
    targets: Array,
    rest: Array,
    above: Indices,
    height: float,
    settings: JacobianSettings,
) -> Solved:
    """Return turns with which all ends are at their targets; the ends keep their own orientation.

    Limbs that share joints (two hands on one spine) are solved together, others side by side.

    Args:
        limbs: Legs or arms.
        turns: Of all links, shape (frame, link, 4).
        points: Places of all links, shape (frame, link, 3).
        targets: Where the ends shall be, shape (frame, limb, 3).
        rest: Place of each link at rest, shape (link, 3).
        above: The link that carries each link, shape (link,).
        height: Of the character [m].
        settings: Of the solver.
    """
    out = turns.copy()
    error = np.zeros(len(turns))
    for group in _groups(limbs):
        members = [limbs[i] for i in group]
        joints = sorted({j for limb in members for j in limb.chain[:-1]})
        place = {j: k for k, j in enumerate(joints)}
        parents = [place.get(int(above[j]), NONE) for j in joints]
        offsets = np.array(
            [rest[j] - rest[above[j]] if p != NONE else np.zeros(3) for j, p in zip(joints, parents, strict=True)]
        )
        effectors = [Effector(place[m.chain[-2]], rest[m.end] - rest[m.chain[-2]]) for m in members]
        problem = Problem(parents, offsets, effectors)
        wanted, start = targets[:, group], turns
        if len(group) == 1:
            wanted = _within_reach(members[0], points, wanted[:, 0], rest)[:, None]
            start = _bent(members[0], turns, points, wanted[:, 0], rest)
        solved = jacobian_ik.solve(
            problem, turns[:, joints], points[:, joints], wanted, points[:, 0], height, settings, start[:, joints]
        )
        out[:, joints] = solved.turns
        if len(group) == 1:
            out = _unfolded(members[0], out, turns, rest)
        error = np.maximum(error, solved.error)
    return Solved(out, error)


def _within_reach(limb: LimbLinks, points: Array, targets: Array, rest: Array) -> Array:
    """Return ``targets`` no farther from the limb's first joint than it can reach with a trace of a bend.

    The paper's sphere around the root is wider; beyond a straight leg it would leave the knee to snap to and fro.
    """
    away = targets - points[:, limb.chain[0]]
    distance = quat.length(away)[..., None]
    shrink = np.minimum(1.0, REACH * reach(limb, rest) / np.maximum(distance, 1e-12))
    return points[:, limb.chain[0]] + shrink * away


STRAIGHT = np.radians(3.0)
"""A knee or elbow that is bent by less has no direction of its own."""


OTHER_SIDE = 0.3
"""A knee that came in this far on the wrong side of the leg is meant to be there [leg lengths]."""


def _bent(limb: LimbLinks, turns: Array, points: Array, targets: Array, rest: Array) -> Array:
    """Return turns in which a straight limb that must shorten is bent a little the right way.

    On a straight limb no joint can bring its end nearer, so the Jacobian has no way to begin.
    """
    if len(limb.chain) != 3:
        return turns
    upper, lower, end = limb.chain
    first, second = _segment(turns, rest, upper, lower), _segment(turns, rest, lower, end)
    bend = _angle(first, second)
    whole = quat.length(first + second)
    shorter = quat.length(targets - points[:, upper]) < 0.999 * whole
    stuck = (bend < STRAIGHT) & shorter
    if not stuck.any():
        return turns
    out = turns.copy()
    hinge = quat.unit(quat.cross(quat.unit(first[stuck]), _pole(limb, turns[stuck])))
    angle = np.full(int(stuck.sum()), 2.0 * STRAIGHT)
    out[stuck, upper] = quat.multiply(quat.from_axis_angle(hinge, 0.5 * angle), turns[stuck, upper])
    out[stuck, lower] = quat.multiply(quat.from_axis_angle(hinge, -0.5 * angle), turns[stuck, lower])
    return out


def _unfolded(limb: LimbLinks, turns: Array, before: Array, rest: Array) -> Array:
    """Return turns in which no knee or elbow has gone over to the other side of a straight limb."""
    if len(limb.chain) != 3:
        return turns
    upper, lower, end = limb.chain
    first, second = _segment(turns, rest, upper, lower), _segment(turns, rest, lower, end)
    side = _side(first, second, _pole(limb, turns))
    came = _side(_segment(before, rest, upper, lower), _segment(before, rest, lower, end), _pole(limb, before))
    flipped = (side < 0.0) & (came > -OTHER_SIDE * reach(limb, rest))
    if not flipped.any():
        return turns
    out = turns.copy()
    line = quat.unit(first[flipped] + second[flipped])
    for link, segment in ((upper, first[flipped]), (lower, second[flipped])):
        off = segment - np.sum(segment * line, axis=-1, keepdims=True) * line
        out[flipped, link] = quat.multiply(quat.between(segment, segment - 2.0 * off), turns[flipped, link])
    return out


def _segment(turns: Array, rest: Array, top: int, bottom: int) -> Array:
    return quat.rotate(turns[:, top], rest[bottom] - rest[top])


def _angle(a: Array, b: Array) -> Array:
    return np.arccos(np.clip(np.sum(quat.unit(a) * quat.unit(b), axis=-1), -1.0, 1.0))


def _side(first: Array, second: Array, pole: Array) -> Array:
    """Return how far a lower segment is folded back from its pole, negative when over the front, shape (frame,)."""
    along = quat.unit(first)
    square = pole - np.sum(pole * along, axis=-1, keepdims=True) * along
    return -np.sum(second * square, axis=-1)


def _pole(limb: LimbLinks, turns: Array) -> Array:
    """Return the direction in which a knee or elbow points, shape (frame, 3)."""
    return quat.rotate(turns[:, limb.chain[0]], np.asarray(limb.pole))


def _groups(limbs: Sequence[LimbLinks]) -> list[list[int]]:
    """Return the limbs in groups that share no joint."""
    groups: list[tuple[set[int], list[int]]] = []
    for i, limb in enumerate(limbs):
        joints, members = set(limb.chain[:-1]), [i]
        for group in [g for g in groups if g[0] & joints]:
            groups.remove(group)
            joints |= group[0]
            members = group[1] + members
        groups.append((joints, members))
    return [members for _, members in groups]
