"""A spine that stretches, Hecker 2008 §4.3.2: where goals are farther apart than it is long, its pieces get longer.

How far is found from the goals alone, before the iterations: what lies between two places that are wanted may come as
much farther apart as these are out of its reach. So a spine that reaches its goals is the same as one that keeps its
lengths.
"""

import numpy as np

from .. import quat
from ..arrays import Array
from .constraints import TINY
from .spine import Spine
from .stretching import EXACT


def most(spine: Spine, pins: Array, pinned: Array, goals: Array, weights: Array) -> Array:
    """Return the farthest that the ends of each piece come from each other [m], shape (frame or 1, piece).

    Args:
        spine: The spine.
        pins: Goals of the branch points, from the first joint [m], shape (frame, node, 3).
        pinned: How much they count, shape (frame, node).
        goals: Where the limbs that pull shall end, from there [m], shape (frame, pull, 3).
        weights: How much they count, shape (frame, pull).
    """
    room = spine.room
    if not room.any():
        return spine.most[None]
    shares = np.zeros((len(pins), len(room)))
    wanted = [node for node in range(1, len(spine.nodes)) if pinned[:, node].any()]
    for i, node in enumerate(wanted):
        for before in (0, *wanted[:i]):
            away = quat.length(pins[:, node] - pins[:, before])
            weight = pinned[:, node] * (pinned[:, before] if before else 1.0)
            _allow(spine, slice(before, node), away, weight, shares)
    for i, pull in enumerate(spine.pulls):
        # Limbs stretch as well, and their starts are somewhere about the branch point.
        own = spine.settings.stretch * (pull.full + float(quat.length(spine.still.starts[0, i])))
        _allow(spine, slice(0, pull.node), quat.length(goals[:, i]) - own, weights[:, i], shares)
    return spine.most + shares * room if shares.any() else spine.most[None]


def _allow(spine: Spine, pieces: slice, away: Array, weight: Array, shares: Array) -> None:
    """Let pieces come as much farther as they have to, to span a distance, as a share of their room."""
    share = weight * _share(away, spine.most[pieces].sum(), spine.room[pieces].sum())
    shares[:, pieces] = np.maximum(shares[:, pieces], share[:, None])


def _share(away: Array, reach: Array, room: Array) -> Array:
    """Return how much of the room there is beyond a reach it takes to span a distance, 0 to 1."""
    over = np.where(away > (1.0 + EXACT) * reach, away - reach, 0.0)
    return np.minimum(over / np.maximum(room, TINY), 1.0)


def from_held(spine: Spine, held: int, way: Array, weight: Array, farthest: Array) -> Array:
    """Return what `most` becomes where the last branch point has to come to its goal from one that feet hold.

    Args:
        spine: The spine.
        held: The branch point that feet hold.
        way: From there to the goal [m], shape (frame, 3).
        weight: How much that counts, shape (frame,).
        farthest: From `most`.
    """
    room = spine.most[held:] + spine.room[held:] - farthest[:, held:]
    share = weight * _share(quat.length(way), farthest[:, held:].sum(axis=-1), room.sum(axis=-1))
    if not (spine.room[held:].any() and share.any()):
        return farthest
    return np.concatenate(
        [np.broadcast_to(farthest[:, :held], (len(way), held)), farthest[:, held:] + share[:, None] * room], axis=1
    )


def factors(spine: Spine, distance: Array, farthest: Array) -> Array | None:
    """Return by what factors bones are longer, shape (frame, piece, bone), None where none is.

    Args:
        spine: The spine.
        distance: Between the ends of the pieces [m], shape (frame, piece).
        farthest: From `most`.
    """
    if spine.free is None:
        return None
    over = np.where(farthest > spine.most, np.maximum(distance - spine.pieces.full, 0.0), 0.0)
    if not over.any():
        return None
    longer = np.minimum(over / np.maximum(spine.elastic.sum(axis=-1), TINY), spine.settings.stretch - 1.0)
    return 1.0 + longer[..., None] * (spine.elastic > 0.0)
