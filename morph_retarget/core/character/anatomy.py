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
from .names import Reading, read_names
from .words import SENSES, Sense

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
    parents = _mend(skeleton, positions, tails, readings, scores)
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


_NEXT_IN_LIMB = (("LowerLeg", "Foot"), ("LowerArm", "Hand"))


def _mend(
    skeleton: Skeleton,
    positions: Array,
    tails: Array,
    readings: Sequence[Reading],
    scores: Sequence[Mapping[str, float]],
) -> Indices:
    """Put bones back under what they belong to.

    Deform bones that hang on mechanism bones (Rigify) come under the deform bone of the same name; feet and hands that
    hang on the root (baked inverse kinematics) under the limb at whose end they lie.
    """
    parents = _past_mechanism(skeleton, readings)
    lengths = np.linalg.norm(positions - positions[parents], axis=-1) * (parents >= 0)
    extent = max(float(np.ptp(positions, axis=0).max()), 1e-9)
    depth = np.array([len(skeleton.tree.ancestors[b]) for b in range(len(skeleton))])
    ends = [b for b in range(len(skeleton)) if depth[b] >= 2 and lengths[b] > 1e-3 * extent]
    ends = [b for b in ends if all(readings[c].has(Sense.END) for c in skeleton.tree.children[b])]
    ends = [b for b in ends if not joint_names.is_thing(readings[b])]
    for bone in range(len(skeleton)):
        parent = int(parents[bone])
        hangs_loose = depth[bone] == 1 or (parent >= 0 and joint_names.is_thing(readings[parent]))
        if not hangs_loose or joint_names.is_thing(readings[bone]):
            continue
        for end in ends:
            if end == bone or bone in skeleton.tree.ancestors[end]:
                continue
            named = readings[bone].side == readings[end].side != 0 and any(
                scores[end].get(upper, 0.0) > 2.0 and scores[bone].get(lower, 0.0) > 2.0
                for upper, lower in _NEXT_IN_LIMB
            )
            gap = np.linalg.norm(positions[bone] - tails[end])
            reach = np.linalg.norm(positions[bone] - positions[end])
            touches = gap < 0.25 * lengths[end] and 0.4 * lengths[end] < reach < 1.6 * lengths[end]
            near = named and reach < 2.0 * lengths[end]
            if (touches or near) and not (readings[bone].known and not named):
                parents[bone] = end
                break
    return parents


def _past_mechanism(skeleton: Skeleton, readings: Sequence[Reading]) -> Indices:
    """Return parents in which controls and mechanism bones above body bones are replaced by their body twins."""
    things = [joint_names.is_thing(r) for r in readings]
    twins: dict[tuple[object, ...], int] = {}
    for bone, reading in enumerate(readings):
        if not things[bone]:
            twins.setdefault(_plain(reading), bone)
    parents = skeleton.tree.parents.copy()
    for bone in range(len(skeleton)):
        parent = int(parents[bone])
        if things[bone] or parent < 0 or not readings[parent].has(Sense.MECHANISM):
            continue
        for above in skeleton.tree.ancestors[bone]:
            twin = twins.get(_plain(readings[above]), above) if things[above] else above
            if not things[twin] and twin != bone and bone not in skeleton.tree.ancestors[twin]:
                parents[bone] = twin
                break
    return parents


def _plain(reading: Reading) -> tuple[object, ...]:
    """Return a name without the words that tell what its bone is for."""
    return reading.side, tuple(w for w in reading.words if not set(SENSES.get(w, ())) & {Sense.MECHANISM, Sense.NOISE})


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
