"""Mending a rig's tree: who would hang on whom, had no mechanism and no inverse kinematics taken its bones apart."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from ..arrays import Array, Indices
from ..skeleton import Skeleton
from . import joint_names
from .names import Reading
from .words import SENSES, Sense

_EXTREMITIES = (Sense.ANKLE, Sense.FOOT, Sense.PAW, Sense.TOE, Sense.WRIST, Sense.HAND)
_LIMBS = (
    Sense.LEG, Sense.UPPER_LEG, Sense.LOWER_LEG, Sense.KNEE, Sense.ARM, Sense.UPPER_ARM, Sense.LOWER_ARM, Sense.ELBOW,
)  # fmt: skip
PAW_REACH = 0.3
"""A paw beside the body's tree ends a limb that breaks off no further away than this share of the rig's extent …"""
LEAST_GAP = 0.4
"""… and no nearer than this share of the limb's last bone: what lies in it is no paw but a target."""
SAME_GAP = 0.05
"""Two such gaps are mirror images when they differ by no more than this share of the longer one."""
HALF_GAP = 0.1
"""Halves of a body lie no further apart than this share of the rig's extent."""
_NEXT_IN_LIMB = (("LowerLeg", "Foot"), ("LowerArm", "Hand"))


def mend(
    skeleton: Skeleton,
    positions: Array,
    tails: Array,
    readings: Sequence[Reading],
    scores: Sequence[Mapping[str, float]],
) -> Indices:
    """Put bones back under what they belong to.

    Deform bones that hang on mechanism bones (Rigify) come under the deform bone of the same name; feet and hands that
    hang on the root or are roots themselves (baked inverse kinematics) under the limb at whose end they lie; a half of
    the body that is a tree of its own under the nearest bone of the half with the hips.

    Args:
        skeleton: The rig.
        positions: Bone heads in the world [m], shape (bone, 3).
        tails: Bone tails in the world [m], shape (bone, 3).
        readings: What the names say.
        scores: Log-odds of unsided joints by name.

    Returns:
        The parent of each bone, -1 for roots, shape (bone,).
    """
    parents = _past_mechanism(skeleton, readings)
    body = _largest(skeleton, readings)
    for half, carrier in _halves(skeleton, parents, positions, tails, readings):
        parents[half] = carrier
        body |= _tree_of(skeleton, half) | _tree_of(skeleton, carrier)
    lengths = np.linalg.norm(positions - positions[parents], axis=-1) * (parents >= 0)
    extent = max(float(np.ptp(positions, axis=0).max()), 1e-9)
    depth = np.array([len(skeleton.tree.ancestors[b]) for b in range(len(skeleton))])
    ends = [b for b in range(len(skeleton)) if depth[b] >= 2 and lengths[b] > 1e-3 * extent]
    ends = [b for b in ends if all(readings[c].has(Sense.END) for c in skeleton.tree.children[b])]
    ends = [b for b in ends if not joint_names.is_thing(readings[b])]
    for bone in range(len(skeleton)):
        parent = int(parents[bone])
        root = parent < 0 and bone not in body
        hangs_loose = root or depth[bone] == 1 or (parent >= 0 and joint_names.is_thing(readings[parent]))
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
            if (touches or near) and not (readings[bone].known and not named) and bone not in _above(parents, end):
                parents[bone] = end
                break
    for paw, end in _paws(parents, positions, readings, body, [e for e in ends if e in body]):
        parents[paw] = end
    return parents


def _above(parents: Indices, bone: int) -> Iterator[int]:
    """Yield the bones on which a bone hangs so far, from its parent upward."""
    while (bone := int(parents[bone])) >= 0:
        yield bone


def _largest(skeleton: Skeleton, readings: Sequence[Reading]) -> frozenset[int]:
    """Return the bones of the tree that holds most of the body; a rig may have others beside it."""
    trees = [(root, *skeleton.tree.below(root)) for root in skeleton.tree.roots]
    return frozenset(max(trees, key=lambda tree: sum(not joint_names.is_thing(readings[b]) for b in tree)))


def _tree_of(skeleton: Skeleton, bone: int) -> frozenset[int]:
    """Return all bones of the tree that a bone is part of."""
    root = [bone, *skeleton.tree.ancestors[bone]][-1]
    return frozenset((root, *skeleton.tree.below(root)))


def _paws(
    parents: Indices, positions: Array, readings: Sequence[Reading], body: frozenset[int], ends: Sequence[int]
) -> list[tuple[int, int]]:
    """Return bones beside the body's tree that end limbs which break off, and the last bones of those limbs.

    Such a paw may be called anything and be far from the bone above it. So it needs a mirror image, and of the whole
    body the last bone of its limb must be the nearest to it.

    Args:
        parents: Of all bones, as far as they are mended, shape (bone,).
        positions: Bone heads in the world [m], shape (bone, 3).
        readings: What the names say.
        body: Bones of the body's tree, or of those of its halves.
        ends: Those with which its branches end.
    """
    solid = [b for b in sorted(body) if parents[b] >= 0 and not joint_names.is_thing(readings[b])]
    solid = [b for b in solid if not readings[b].has(Sense.END, Sense.ROOT)]
    farthest = PAW_REACH * float(np.ptp(positions, axis=0).max())
    found: dict[int, tuple[float, int]] = {}
    for bone in _tops(parents, readings, body) if solid else ():
        gaps = np.linalg.norm(positions[solid] - positions[bone], axis=-1)
        end, gap = solid[int(np.argmin(gaps))], float(gaps.min())
        length = float(np.linalg.norm(positions[end] - positions[parents[end]]))
        named = _may_be(readings[bone], _EXTREMITIES) and _may_be(readings[end], _LIMBS)
        fits = named and end in ends and readings[bone].side == readings[end].side
        if fits and LEAST_GAP * length < gap < farthest:
            found[end] = min((gap, bone), found.get(end, (np.inf, bone)))
    return [
        (bone, end)
        for end, (gap, bone) in found.items()
        if any(e != end and abs(g - gap) <= SAME_GAP * max(g, gap) for e, (g, _) in found.items())
    ]


def _halves(
    skeleton: Skeleton, parents: Indices, positions: Array, tails: Array, readings: Sequence[Reading]
) -> list[tuple[int, int]]:
    """Return roots of halves of a body, and the bones of the half with the hips next to which these halves lie.

    Some rigs turn chest and hips alike from nothing: each half has limbs on both of its sides.

    Args:
        skeleton: The rig.
        parents: Of all bones, as far as they are mended, shape (bone,).
        positions: Bone heads in the world [m], shape (bone, 3).
        tails: Bone tails in the world [m], shape (bone, 3).
        readings: What the names say.
    """
    roots = [b for b in skeleton.tree.roots if parents[b] < 0]
    if len(roots) < 2:
        return []
    trees = {root: [root, *skeleton.tree.below(root)] for root in roots}
    limbs = {root: [b for b in tree if _is_limb(readings[b])] for root, tree in trees.items()}
    halves = [root for root in roots if {1, -1} <= {readings[b].side for b in limbs[root]}]
    halves.sort(key=lambda root: (not any(readings[b].has(Sense.HIPS) for b in trees[root]), -len(trees[root])))
    if len(halves) < 2:
        return []
    middle = [b for b in trees[halves[0]] if not readings[b].side and not readings[b].has(Sense.TAIL)]
    found: list[tuple[int, int]] = []
    for root in halves[1:]:
        gaps = [min(float(np.linalg.norm(ends[b] - positions[root])) for ends in (positions, tails)) for b in middle]
        if min(gaps, default=np.inf) < HALF_GAP * float(np.ptp(positions, axis=0).max()):
            carrier = middle[int(np.argmin(gaps))]
            marks_end = readings[carrier].has(Sense.END) and parents[carrier] >= 0
            found.append((root, int(parents[carrier]) if marks_end else carrier))
    return found


def _is_limb(reading: Reading) -> bool:
    """Return whether a name says a part of an arm or a leg, and which side it is on."""
    return reading.side != 0 and reading.has(*_LIMBS, *_EXTREMITIES) and not joint_names.is_thing(reading)


def _tops(parents: Indices, readings: Sequence[Reading], body: frozenset[int]) -> Iterator[int]:
    """Yield bones beside the body's tree that hang on nothing or on controls."""
    for bone, reading in enumerate(readings):
        above = int(parents[bone])
        hangs_loose = above < 0 or (above not in body and joint_names.is_thing(readings[above]))
        if bone not in body and hangs_loose and not joint_names.is_thing(reading):
            yield bone


def _may_be(reading: Reading, senses: Sequence[Sense]) -> bool:
    """Return whether a name says one of some senses, or nothing."""
    return reading.has(*senses) or not reading.known


def _past_mechanism(skeleton: Skeleton, readings: Sequence[Reading]) -> Indices:
    """Return parents in which controls and mechanism bones above body bones are replaced by their body twins."""
    things = [joint_names.is_thing(r) for r in readings]
    twins: dict[tuple[int, tuple[str, ...]], int] = {}
    for bone, reading in enumerate(readings):
        if not things[bone] and not all(word.isdigit() for word in _plain(reading)[1]):  # a number is no name
            twins.setdefault(_plain(reading), bone)
    parents = skeleton.tree.parents.copy()
    for bone in range(len(skeleton)):
        parent = int(parents[bone])
        if things[bone] or parent < 0 or not readings[parent].has(Sense.MECHANISM):
            continue
        for above in skeleton.tree.ancestors[bone]:
            twin = twins.get(_plain(readings[above]), above) if things[above] else above
            if (
                not things[twin]
                and twin != bone
                and bone not in (*skeleton.tree.ancestors[twin], *_above(parents, twin))
            ):
                parents[bone] = twin
                break
    return parents


def _plain(reading: Reading) -> tuple[int, tuple[str, ...]]:
    """Return a name without the words that tell what its bone is for."""
    return reading.side, tuple(w for w in reading.words if not set(SENSES.get(w, ())) & {Sense.MECHANISM, Sense.NOISE})
