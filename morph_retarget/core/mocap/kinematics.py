"""Where the links of a pair are: on the source over a clip, and on the target as its turns carry them."""

import numpy as np

from .. import quat
from ..arrays import Array, Indices
from ..character.frame import Placement
from ..skeleton import Pose, Skeleton
from ..tree import Tree
from .links import Links


def source_turns(links: Links, skeleton: Skeleton, pose: Pose, local_to_character: Placement) -> Array:
    """Return the turn of each link from the source's rest, character frame, shape (frame, link, 4)."""
    bones, place = np.unique(links.source, return_inverse=True)
    place = place.reshape(links.source.shape)
    after = quat.conjugate(quat.multiply(local_to_character.turn, skeleton.rest_rotations[bones]))
    turns = quat.multiply(quat.multiply(local_to_character.turn, pose.rotations[:, bones]), after)
    out = turns[:, place[:, 0]]
    shared = np.flatnonzero(links.weight > 0.0)
    if len(shared):
        out[:, shared] = quat.slerp(out[:, shared], turns[:, place[shared, 1]], links.weight[shared])
    return out


def source_points(links: Links, positions: Array, local_to_character: Placement) -> Array:
    """Return the place of each link on the source, character frame [m], shape (frame, link, 3).

    Args:
        links: Of the pair.
        positions: Bone heads in armature space, shape (frame, bone, 3).
        local_to_character: From the source's armature space to its character frame.
    """
    out = positions[:, links.source[:, 0]]
    shared = np.flatnonzero(links.weight > 0.0)
    if len(shared):
        second = positions[:, links.source[shared, 1]]
        out[:, shared] += links.weight[shared, None] * (second - out[:, shared])
    return local_to_character.points(out)


def follow_curve(links: Links, turns: Array, points: Array, rest: Array) -> Array:
    """Return turns in which chains of unequal length follow the curve of the source's chain.

    Bones that lie between two of the source's have taken over a turn in between, and some bones of the source have no
    counterpart; each target bone is swung onto the direction of the curve where it lies, so that both the ends and the
    shape of the two chains agree.

    Args:
        links: Of the pair.
        turns: Of the target's links, shape (frame, link, 4).
        points: Places of the links on the source, shape (frame, link, 3).
        rest: Places of the links on the target at rest, shape (link, 3).
    """
    out = turns.copy()
    for i in np.flatnonzero(links.curved):
        after = links.after[i]
        own = quat.rotate(turns[:, i], rest[after] - rest[i])
        out[:, i] = quat.multiply(quat.between(own, points[:, after] - points[:, i]), turns[:, i])
    return out


def target_points(rest: Array, turns: Array, tree: Tree) -> Array:
    """Return the place of each link on the target with the first link held at the origin (forward kinematics).

    Args:
        rest: Place of each link at rest, shape (link, 3).
        turns: Turn of each link from rest, shape (frame, link, 4).
        tree: The links.

    Returns:
        Shape (frame, link, 3).
    """
    return place(np.zeros((len(turns), len(rest), 3)), rest, turns, tree, np.arange(1, len(rest)))


def place(points: Array, rest: Array, turns: Array, tree: Tree, links: Indices) -> Array:
    """Return ``points`` with some links put where the links that carry them hold them.

    Args:
        points: Places of all links, shape (frame, link, 3).
        rest: Place of each link at rest, shape (link, 3).
        turns: Turn of each link from rest, shape (frame, link, 4).
        tree: The links.
        links: The links to place, shape (n,).
    """
    out = points.copy()
    wanted = np.zeros(len(tree), dtype=bool)
    wanted[links] = True
    for level in tree.levels[1:]:
        own = level[wanted[level]]
        carriers = tree.parents[own]
        out[:, own] = out[:, carriers] + quat.rotate(turns[:, carriers], rest[own] - rest[carriers])
    return out
