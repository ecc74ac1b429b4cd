"""The body under analysis: one rig's names, mended tree, mirror pairs and rest shape, seen in one trial frame."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from .. import quat
from ..arrays import Array, Flags, Indices
from ..skeleton import Skeleton
from ..tree import Tree
from . import joint_names, mirror
from .mending import mend
from .names import Reading, read_names
from .words import Sense

EXTRA_HOP = 0.1
"""Cost of passing over a bone that is known to be a twist or helper bone, or has no length."""
BODY_HOP = 0.7
"""Cost of passing over any other bone."""


@dataclass(frozen=True, eq=False)
class Evidence:
    """What names and the tree say, before any frame is chosen."""

    skeleton: Skeleton
    positions: Array
    """Bone heads in the world [m], shape (bone, 3)."""
    tails: Array
    """Bone tails in the world [m], shape (bone, 3)."""
    readings: Sequence[Reading]
    scores: Sequence[Mapping[str, float]]
    """Log-odds of unsided joints by name, see `joint_names.joint_scores`."""
    tree: Tree
    """Who hangs on whom after detached bones were put back where they belong."""
    by_name: Indices
    """Mirror partners by name, see `mirror.named_partners`."""

    def __len__(self) -> int:
        return len(self.skeleton)

    def score(self, bone: int, joint: str) -> float:
        """Return the names' log-odds that ``bone`` is the unsided ``joint``."""
        table = self.scores[bone]
        return table.get(joint, table[""])

    @cached_property
    def thing(self) -> Flags:
        """Bones that their names exclude from the body: hair, cloth, props, controls; shape (bone,)."""
        return np.array([joint_names.is_thing(r) for r in self.readings])

    @cached_property
    def extent(self) -> float:
        """Largest side of the box around the bones [m], without far-away roots."""
        kept = self.positions[self.solid]
        return max(float(np.ptp(kept, axis=0).max()), 1e-9)

    @cached_property
    def solid(self) -> Flags:
        """Bones whose places say something about the body: no things, no roots that only carry one bone."""
        out = ~self.thing
        for bone, parent in enumerate(self.tree.parents):
            lone = len(self.tree.children[bone]) == 1
            if (parent < 0 or not out[parent]) and lone and not self.readings[bone].has(Sense.HIPS, Sense.HIP):
                out[bone] = False
        return out if out.sum() >= 2 else np.ones(len(self), dtype=bool)

    @cached_property
    def passing(self) -> Array:
        """Cost of the bones from each root down to and including each bone, shape (bone,)."""
        out = np.zeros(len(self))
        for bone in self.tree.order:
            parent = int(self.tree.parents[bone])
            coincident = (
                parent >= 0 and np.linalg.norm(self.positions[bone] - self.positions[parent]) < 1e-3 * self.extent
            )
            own = EXTRA_HOP if coincident or joint_names.is_extra(self.readings[bone]) else BODY_HOP
            out[bone] = own + (out[parent] if parent >= 0 else 0.0)
        return out

    def hops(self, top: int, bottom: int) -> float:
        """Return the cost of the bones passed over between ``top`` and its descendant ``bottom``."""
        parent = int(self.tree.parents[bottom])
        return float(self.passing[parent] - self.passing[top])


def collect(skeleton: Skeleton, positions: Array, tails: Array) -> Evidence:
    """Read the names of a rig, mend its tree and return the evidence for all later decisions.

    Args:
        skeleton: The rig.
        positions: Bone heads in the world [m], shape (bone, 3).
        tails: Bone tails in the world [m], shape (bone, 3).
    """
    readings = _without_false_ends(skeleton, read_names(skeleton.names))
    scores = [joint_names.joint_scores(r) for r in readings]
    parents = mend(skeleton, positions, tails, readings, scores)
    return Evidence(skeleton, positions, tails, readings, scores, Tree(parents), mirror.named_partners(readings))


def _without_false_ends(skeleton: Skeleton, readings: Sequence[Reading]) -> list[Reading]:
    """Return readings in which "end" counts only for bones with which a branch really ends."""
    out = list(readings)
    for bone, reading in enumerate(readings):
        goes_on = [
            c
            for c in skeleton.tree.children[bone]
            if not readings[c].has(Sense.END) and not joint_names.is_thing(readings[c])
        ]
        if goes_on and reading.has(Sense.END):
            out[bone] = replace(reading, senses=reading.senses - {Sense.END})
    return out


@dataclass(frozen=True, eq=False)
class Body:
    """The evidence seen in one trial frame: axes, height, and mirror pairs."""

    evidence: Evidence
    axes: Array
    """Rows: left, back, up (unit, world space), shape (3, 3)."""
    points: Array
    """Bone heads in the trial frame, ground at z = 0, middle at x = 0, in heights of the rig; shape (bone, 3)."""
    size: float
    """Height of the rig [m]."""
    partner: Indices
    """Mirror partner of each bone, or `mirror.MIDLINE`, or `mirror.ALONE`."""
    pairs: Indices
    """Pairs as (left, right) bones, shape (pair, 2)."""
    midline: Indices
    """Bones that may belong to the trunk."""

    @cached_property
    def pair_points(self) -> Array:
        """Mean place of each pair, folded onto the left side, shape (pair, 3)."""
        left, right = self.points[self.pairs[:, 0]], self.points[self.pairs[:, 1]]
        return 0.5 * (left + right * np.array([-1.0, 1.0, 1.0]))

    @cached_property
    def pair_of(self) -> dict[int, int]:
        """The pair that a bone belongs to."""
        return {int(bone): p for p, both in enumerate(self.pairs) for bone in both}

    def pair_score(self, pair: int, joint: str) -> float:
        """Return the names' log-odds that a pair is the left and right ``joint``."""
        left, right = self.pairs[pair]
        return 0.5 * (self.evidence.score(int(left), joint) + self.evidence.score(int(right), joint))


def see(evidence: Evidence, left: Array, up: Array) -> Body:
    """Return the body seen with the given axes (unit vectors, square to each other, world space)."""
    axes = np.stack([left, quat.cross(up, left), up])
    turned = evidence.positions @ axes.T
    kept = turned[evidence.solid]
    size = max(float(np.ptp(kept[:, 2])), 0.1 * evidence.extent)
    center = _middle(evidence, turned)
    points = (turned - np.array([center, 0.0, kept[:, 2].min()])) / size
    partner = mirror.partners(evidence.positions, evidence.tree, evidence.by_name, left, center, size)
    bones = np.arange(len(evidence))
    paired = bones[partner >= 0]
    lefts = paired[(points[paired, 0] > points[partner[paired], 0] + 1e-9)]
    level = paired[np.abs(points[paired, 0] - points[partner[paired], 0]) <= 1e-9]
    lefts = np.concatenate([lefts, level[level < partner[level]]])
    pairs = np.stack([lefts, partner[lefts]], axis=-1) if len(lefts) else np.empty((0, 2), dtype=np.intp)
    midline = bones[partner < 0]
    return Body(evidence, axes, points, size, partner, pairs, midline)


def _middle(evidence: Evidence, turned: Array) -> float:
    """Return the place of the plane of symmetry along the first axis."""
    left = np.flatnonzero(evidence.by_name >= 0)
    if len(left) >= 2:
        return float(np.median(0.5 * (turned[left, 0] + turned[evidence.by_name[left], 0])))
    kept = turned[evidence.solid]
    trials = (0.5 * float(kept[:, 0].min() + kept[:, 0].max()), float(np.median(kept[:, 0])), 0.0)
    unit = np.array([1.0, 0.0, 0.0])
    return min(trials, key=lambda c: mirror.reflection_error(kept, unit, c))
