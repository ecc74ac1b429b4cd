"""Which bone is the mirror image of which: by name, by place, and by the shape of the tree."""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Array, Flags, Indices
from ..tree import Tree
from .names import Reading
from .words import SENSES, Sense

MIDLINE = -2
ALONE = -1


def named_partners(readings: Sequence[Reading]) -> Indices:
    """Return each bone's partner as the names tell: same words, same numbers, the other side; ALONE where none."""
    groups: dict[tuple[object, ...], dict[int, list[int]]] = defaultdict(lambda: defaultdict(list))
    for bone, reading in enumerate(readings):
        if reading.side:
            words = tuple(w for w in reading.words if w not in _SIDE_WORDS)
            groups[words][reading.side].append(bone)
    out = np.full(len(readings), ALONE)
    for sides in groups.values():
        for left, right in zip(sides.get(1, []), sides.get(-1, []), strict=False):
            out[left], out[right] = right, left
    return out


_SIDE_WORDS = frozenset(w for w, s in SENSES.items() if {Sense.LEFT, Sense.RIGHT} & set(s)) | {"l", "r"}


@dataclass(frozen=True, eq=False)
class Lateral:
    """What the named pairs say of the axis from side to side."""

    axis: Array
    """Unit vector, of either sign, shape (3,)."""
    agreement: float
    """How well the pairs that were asked agree, 0 … 1."""
    symmetry: float
    """How well all of them do."""


def lateral(positions: Array, partners: Indices, tree: Tree) -> Lateral:
    """Return the axis between the two sides that the named pairs agree on.

    Hips and shoulders keep it in a rest whose limbs are bent, as in a fighting stance: pairs that start at the trunk
    tell it there.

    Args:
        positions: Bone heads [m], shape (bone, 3).
        partners: What `named_partners` found.
        tree: The bones.
    """
    left = np.flatnonzero(partners >= 0)
    left = left[left < partners[left]]
    steps = positions[left] - positions[partners[left]]
    size = np.linalg.norm(steps, axis=-1)
    good = size > 1e-4 * max(float(np.ptp(positions, axis=0).max()), 1e-9)
    if good.sum() == 0:
        return Lateral(np.array([1.0, 0.0, 0.0]), 0.0, 0.0)
    left, ways = left[good], steps[good] / size[good, None]
    first = of_trunk(left, partners[left], tree)
    trials = [_common_axis(ways), *([_common_axis(ways[first])] if first.sum() >= 2 else [])]
    return Lateral(*max(trials, key=lambda trial: trial[1]), symmetry=trials[0][1])


def of_trunk(left: Indices, right: Indices, tree: Tree) -> Flags:
    """Return which pairs of bones hang on no other pair of them, as hips, shoulders and eyes, shape (pair,)."""
    apart = {*left.tolist(), *right.tolist()}
    return np.array([int(tree.parents[bone]) not in apart for bone in left], dtype=bool)


def _common_axis(ways: Array) -> tuple[Array, float]:
    """Return the axis that unit vectors agree on, whatever their signs, and how well they do: names may be swapped."""
    values, vectors = np.linalg.eigh(ways.T @ ways / len(ways))
    return vectors[:, -1], float(values[-1])


def reflection_error(positions: Array, axis: Array, center: float) -> float:
    """Return how far the bones are from their own mirror image: mean nearest distance over the rig's size."""
    image = positions - 2.0 * (positions @ axis - center)[:, None] * axis
    distance = np.linalg.norm(image[:, None, :] - positions[None, :, :], axis=-1).min(axis=1)
    return float(distance.mean()) / max(float(np.linalg.norm(np.ptp(positions, axis=0))), 1e-9)


def partners(
    positions: Array,
    tree: Tree,
    by_name: Indices,
    axis: Array,
    center: float,
    size: float,
) -> Indices:
    """Return each bone's mirror partner, MIDLINE for bones on the plane and ALONE for odd ones.

    Args:
        positions: Bone heads [m], shape (bone, 3).
        tree: The bones.
        by_name: What `named_partners` found; names win over places.
        axis: Unit normal of the plane of symmetry.
        center: The plane's place along ``axis`` [m].
        size: Height of the rig [m], for tolerances.
    """
    return _Pairing(positions, tree, by_name, axis, center, size).find()


class _Pairing:
    """The walk down both halves of a tree at once."""

    def __init__(self, positions: Array, tree: Tree, by_name: Indices, axis: Array, center: float, size: float) -> None:
        self.tree = tree
        self.by_name = by_name
        self.axis = axis
        self.center = center
        self.size = size
        self.out = np.full(len(positions), ALONE)
        self.weight, middles = _subtrees(tree, positions)
        # A bone may start on the plane (a clavicle at the neck, a hip joint at the pelvis): where it leads counts too.
        self.offset = 0.5 * ((positions + middles) @ axis) - center
        self.on_plane = np.abs(positions @ axis - center) < 0.02 * size
        self.places = np.concatenate([positions, middles], axis=-1)

    def find(self) -> Indices:
        """Return the partner of each bone."""
        self._walk(self.tree.roots)
        return self.out

    def _pair(self, left: int, right: int) -> None:
        self.out[left], self.out[right] = right, left
        self._match(self.tree.children[left], self.tree.children[right])

    def _match(self, left: Sequence[int], right: Sequence[int]) -> None:
        """Pair the children of two partners."""
        rest_l, rest_r = list(left), list(right)
        for bone in left:
            other = int(self.by_name[bone])
            if other in rest_r:
                self._pair(bone, other)
                rest_l.remove(bone)
                rest_r.remove(other)
        for bone in rest_l:
            other = self._nearest_image(bone, rest_r, 0.08 * self.size)
            if other is not None:
                self._pair(bone, other)
                rest_r.remove(other)

    def _walk(self, bones: Sequence[int]) -> None:
        """Sort the children of a bone on the plane into midline, pairs and odd ones."""
        rest = list(bones)
        for bone in bones:
            other = int(self.by_name[bone])
            if bone in rest and other >= 0 and self.out[bone] == ALONE and self.out[other] == ALONE:
                rest = [b for b in rest if b not in (bone, other)]
                self._pair(bone, other)
        for bone in sorted(rest, key=lambda b: -abs(self.offset[b])):
            if self.out[bone] != ALONE or bone not in rest:
                continue
            rest.remove(bone)
            other = self._opposite(bone, rest)
            if other is not None:
                rest.remove(other)
                self._pair(bone, other)
                continue
            if self.on_plane[bone]:
                self.out[bone] = MIDLINE
            self._walk(self.tree.children[bone])

    def _opposite(self, bone: int, rest: Sequence[int]) -> int | None:
        if abs(self.offset[bone]) <= 0.004 * self.size:
            return None
        candidates = [b for b in rest if self.offset[b] * self.offset[bone] <= 0.0]
        return self._nearest_image(bone, candidates, 0.04 * self.size)

    def _nearest_image(self, bone: int, candidates: Sequence[int], tolerance: float) -> int | None:
        """Return the candidate whose head and subtree lie nearest to the mirror image of the bone's."""
        if not candidates:
            return None
        halves = self.places[bone].reshape(2, 3)
        images = halves - 2.0 * (halves @ self.axis - self.center)[:, None] * self.axis
        others = np.asarray(candidates)
        # Heads must agree; what hangs below them only roughly (one hand may hold a weapon).
        distance = np.linalg.norm(self.places[others].reshape(-1, 2, 3) - images, axis=-1) @ np.array([0.75, 0.25])
        # Coincident bones (a twist bone at its parent's child) are told apart by what hangs on them.
        cost = distance / tolerance + np.abs(np.log(self.weight[others] / self.weight[bone]))
        best = int(np.argmin(cost))
        return int(others[best]) if distance[best] < tolerance else None


def _subtrees(tree: Tree, positions: Array) -> tuple[Indices, Array]:
    """Return how many bones hang on each bone, itself included, and their mean place."""
    sizes = np.ones(len(tree), dtype=np.intp)
    sums = positions.copy()
    for bone in reversed(tree.order):
        for child in tree.children[bone]:
            sizes[bone] += sizes[child]
            sums[bone] += sums[child]
    return sizes, sums / sizes[:, None]
