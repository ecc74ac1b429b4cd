"""Finding arms and legs: three joints along a branch, and how well names, shape and place speak for them.

A limb is the triple (upper, lower, end): thigh, shin and foot, or upper arm, forearm and hand, taken from pairs of
mirror bones, with any number of twist or helper bones passed over in between (Feng 2013, Algorithm 3, counts joints
between shoulder and wrist instead). The scores are log-odds; every term of the shape is bounded, so a strange rest
pose cannot outvote clear names.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import overload

import numpy as np

from ..arrays import Array, Indices
from .anatomy import Body
from .mirror import ALONE

SINGLE = -2.0
"""A limb that stands on one side only."""
NO_END = -3.0
"""A limb whose hand or foot is missing."""
LOOSE_END = -2.0
"""A limb whose hand or foot hangs on the root, as in rigs whose inverse kinematics was baked."""
SHAPE_FLOOR = -6.0

Shape = Callable[[Array, Array, Array], Array]


@overload
def bell(value: float, mean: float, width: float, floor: float = -3.0) -> float: ...
@overload
def bell(value: Array, mean: float, width: float, floor: float = -3.0) -> Array: ...
def bell(value: float | Array, mean: float, width: float, floor: float = -3.0) -> float | Array:
    """Return a bounded log-odds bump: 1 at ``mean``, 0.5 one ``width`` away, never below ``floor``."""
    bump = 1.0 - 0.5 * ((value - mean) / width) ** 2
    return max(bump, floor) if isinstance(bump, float) else np.maximum(bump, floor)


@dataclass(frozen=True, eq=False)
class Units:
    """Candidates for limb joints: mirror pairs first, then single bones off the midline."""

    bones: Indices
    """(left, right) bones, shape (unit, 2); -1 on a missing side."""
    points: Array
    """Places folded onto the left side, in heights, shape (unit, 3)."""
    ancestors: list[list[int]]
    """Units above each unit, nearest first."""

    def __len__(self) -> int:
        return len(self.bones)

    @cached_property
    def below(self) -> list[list[int]]:
        """Units below each unit."""
        out: list[list[int]] = [[] for _ in self.ancestors]
        for unit, above in enumerate(self.ancestors):
            for top in above:
                out[top].append(unit)
        return out

    def main(self, unit: int) -> int:
        """Return the bone that stands for the unit in the tree: the left one if there is one."""
        left, right = self.bones[unit]
        return int(left if left >= 0 else right)


def units(body: Body) -> Units:
    """Return all candidates for limb joints of ``body``, in no particular order."""
    evidence = body.evidence
    bones: list[tuple[int, int]] = [(int(a), int(b)) for a, b in body.pairs]
    for bone in np.flatnonzero(body.partner == ALONE):
        side = evidence.readings[int(bone)].side or (1 if body.points[bone, 0] >= 0 else -1)
        bones.append((int(bone), -1) if side > 0 else (-1, int(bone)))
    table = np.array(bones, dtype=np.intp).reshape(-1, 2)
    fold = np.array([1.0, 1.0, 1.0]), np.array([-1.0, 1.0, 1.0])
    points = np.zeros((len(table), 3))
    for side in (0, 1):
        there = table[:, side] >= 0
        points[there] += body.points[table[there, side]] * fold[side]
    points /= np.maximum((table >= 0).sum(axis=1, keepdims=True), 1)
    unit_of = {b: u for u, both in enumerate(bones) for b in both if b >= 0}
    ancestors: list[list[int]] = []
    for left, right in bones:
        above = evidence.tree.ancestors[left if left >= 0 else right]
        ancestors.append(list(dict.fromkeys(unit_of[b] for b in above if b in unit_of)))
    return Units(table, points, ancestors)


@dataclass(frozen=True, eq=False)
class Triples:
    """All candidate limbs of one kind, scored, without their attachment to the trunk."""

    upper: Indices
    lower: Indices
    end: Indices
    """Unit of the end, -1 where the limb has none."""
    score: Array
    shape: Array
    """The part of the score that came from the shape."""


def triples(body: Body, candidates: Units, joints: tuple[str, str, str], shape: Shape, trust: float) -> Triples:
    """Return every triple of units in line, scored as the three unsided ``joints``.

    Args:
        body: The rig in its trial frame.
        candidates: Its limb candidates.
        joints: Names of the upper, lower and end joint ("UpperLeg", "LowerLeg", "Foot").
        shape: Log-odds of the places of upper, lower and end.
        trust: Weight of the shape, 0 … 1; small when the rest pose is no real pose.
    """
    names = np.array([[unit_score(body, candidates, u, j) for j in joints] for u in range(len(candidates))])
    rows: list[tuple[int, int, int]] = []
    for end, above in enumerate(candidates.ancestors):
        if names.size and names[end, 2] <= -6.0 and names[end, 1] <= -6.0:
            continue
        rows += [(upper, lower, end) for i, lower in enumerate(above) for upper in above[i + 1 :]]
        rows += [(upper, end, -1) for upper in above]
    in_line = len(rows)
    rows += _loose_ends(body, candidates)
    if not rows:
        empty = np.empty(0, dtype=np.intp)
        return Triples(empty, empty, empty, np.empty(0), np.empty(0))
    upper, lower, end = np.array(rows).T
    has_end = end >= 0
    points = candidates.points
    form = np.where(has_end, np.maximum(shape(points[upper], points[lower], points[end]), SHAPE_FLOOR), NO_END)
    single = np.where((candidates.bones[upper] < 0).any(axis=1), SINGLE, 0.0)
    score = names[upper, 0] + names[lower, 1] + np.where(has_end, names[end, 2], 0.0)
    score += trust * form + single - _passed_over(body, candidates, upper, lower)
    held = np.flatnonzero(has_end[:in_line])
    score[held] -= _passed_over(body, candidates, lower[held], end[held])
    score[in_line:] += LOOSE_END
    return Triples(upper, lower, end, score, form)


def _passed_over(body: Body, candidates: Units, top: Indices, bottom: Indices) -> Array:
    """Return the cost of the bones between units and others that hang below them, shape (n,)."""
    evidence, bones = body.evidence, candidates.bones
    main: Indices = np.where(bones[:, 0] >= 0, bones[:, 0], bones[:, 1])
    return evidence.passing[evidence.tree.parents[main[bottom]]] - evidence.passing[main[top]]


def _loose_ends(body: Body, candidates: Units) -> Iterator[tuple[int, int, int]]:
    """Yield limbs of two bones together with units that hang on a root and might be their ends."""
    evidence = body.evidence
    loose = [u for u in range(len(candidates)) if len(evidence.tree.ancestors[candidates.main(u)]) == 1]
    loose = [u for u in loose if not evidence.thing[candidates.main(u)] and not candidates.below[u]]
    stumps = [u for u in range(len(candidates)) if candidates.ancestors[u] and not candidates.below[u]]
    for end in loose:
        for lower in stumps:
            if lower not in loose:
                for upper in candidates.ancestors[lower]:
                    yield upper, lower, end


def unit_score(body: Body, candidates: Units, unit: int, joint: str) -> float:
    """Return the names' mean log-odds that a unit's bones are the unsided ``joint``."""
    there = [int(b) for b in candidates.bones[unit] if b >= 0]
    return sum(body.evidence.score(b, joint) for b in there) / len(there)


def _segments(upper: Array, lower: Array, end: Array) -> tuple[Array, Array, Array]:
    first = np.linalg.norm(lower - upper, axis=-1)
    second = np.linalg.norm(end - lower, axis=-1)
    whole = np.linalg.norm(end - upper, axis=-1)
    return np.maximum(first, 1e-6), np.maximum(second, 1e-6), np.maximum(whole, 1e-6)


def leg_shape(upper: Array, lower: Array, end: Array) -> Array:
    """Return how much three places look like hip, knee and ankle of a standing body, shape (n,)."""
    first, second, whole = _segments(upper, lower, end)
    hip = np.maximum(upper[:, 2], 1e-3)
    out = bell(lower[:, 2] / hip, 0.53, 0.13) + bell(end[:, 2] / hip, 0.10, 0.11)
    out += bell(np.log(second / first), 0.0, 0.35)
    out += bell((first + second) / whole - 1.0, 0.0, 0.12)
    out += bell(np.log(whole / 0.45), 0.0, 0.5)
    # The ankle lies under the knee; the ball of the foot lies in front of it.
    out += bell((end[:, 1] - lower[:, 1]) / np.maximum(lower[:, 2] - end[:, 2], 1e-3), 0.0, 0.2, -1.5)
    return out - 4.0 * ((lower[:, 2] > upper[:, 2]) | (end[:, 2] > lower[:, 2]))


def arm_shape(upper: Array, lower: Array, end: Array) -> Array:
    """Return how much three places look like shoulder, elbow and wrist of a standing body, shape (n,)."""
    first, second, whole = _segments(upper, lower, end)
    out = bell(upper[:, 2], 0.80, 0.13)
    out += bell(np.log(second / first), -0.08, 0.3)
    out += bell((first + second) / whole - 1.0, 0.0, 0.12)
    out += bell(np.log(whole / 0.30), 0.0, 0.45)
    out += bell(end[:, 1] - upper[:, 1], -0.02, 0.12)
    return out - 3.0 * (end[:, 2] < 0.2) - 3.0 * (end[:, 0] < upper[:, 0])
