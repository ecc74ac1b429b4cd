"""Whether limbs go through the trunk, the head or each other.

Bones are as thick as a rule says (`capsules`), which is wrong by some. So limbs that touch, or press into each other by
a part of their thickness, are no fault: what is judged is how deep they do. What is near at rest may come as near.
"""

from dataclasses import dataclass

import numpy as np

from .. import quat
from ..arrays import Array, Indices
from ..solve import capsules as thickness
from ..solve.capsules import Capsules
from .performance import Performance
from .verdict import Found

BEADS = 5
"""Points on each bone that are looked at, its start the first."""
TINY = 1e-9
BLOCK = 64
"""Frames that are looked at together."""


@dataclass(frozen=True, eq=False)
class _Pairs:
    """Which bones are kept apart from which, and how far."""

    bones: Indices
    others: Indices
    clear: Array
    """How near the beads of the bone may come to the other's axis [m], shape (pair, bead)."""


def crossed(performance: Performance) -> Found:
    """Return how deep a limb's bone goes into another bone [shares of both radii].

    1 is where the axes cross.
    """
    own = Capsules.of(performance.character, performance.rest)
    pairs = _pairs(performance, own)
    if not len(pairs.bones):
        return Found(0.0)
    thick = own.radii[pairs.bones] + own.radii[pairs.others]
    shares = np.concatenate(
        [
            _depths(performance, own, pairs, slice(first, first + BLOCK)) / thick
            for first in range(0, len(performance), BLOCK)
        ]
    )
    names = [performance.names[int(body)] for body in own.bodies]
    both = [f"{names[a]} in {names[b]}" for a, b in zip(pairs.bones.tolist(), pairs.others.tolist(), strict=True)]
    return Found.worst(shares, both)


def _pairs(performance: Performance, own: Capsules) -> _Pairs:
    limbs = [frozenset(limb.bones) for limb in performance.character.limbs]
    of_limb = [next((i for i, limb in enumerate(limbs) if body in limb), -1) for body in own.carriers]
    limb_of: Indices = np.array(of_limb, dtype=np.intp)
    points = own.starts[:, None] + np.linspace(0.0, 1.0, BEADS)[:, None] * (own.ends - own.starts)[:, None]
    first = np.array([_starts_limb(performance, limbs, body) for body in own.carriers], dtype=np.float64)
    clear = thickness.clearances(points, own.radii, first, own, 0.0)
    apart = (limb_of[:, None] >= 0) & (limb_of[:, None] != limb_of)
    apart &= (clear > TINY).any(axis=-1)
    bones, others = np.nonzero(apart)
    return _Pairs(bones, others, clear[bones, others])


def _starts_limb(performance: Performance, limbs: list[frozenset[int]], body: int) -> bool:
    """Return whether a bone is the first of a limb: what carries it keeps its start where it is."""
    above = performance.hierarchy.ancestors[body]
    return any(body in limb and limb.isdisjoint(above) for limb in limbs)


def _depths(performance: Performance, own: Capsules, pairs: _Pairs, rows: slice) -> Array:
    """Return how much nearer bones come than they may [m], shape (frame, pair)."""
    places, turns, rest = performance.places[rows], performance.turns[rows], performance.rest
    starts, ends = (
        places[:, own.bodies] + quat.rotate(turns[:, own.bodies], points - rest[own.bodies])
        for points in (own.starts, own.ends)
    )
    shares = np.linspace(0.0, 1.0, BEADS)[:, None]
    a = starts[:, pairs.bones, None]
    beads = a + shares * (ends[:, pairs.bones, None] - a)
    others = starts[:, pairs.others, None], ends[:, pairs.others, None]
    away = thickness.distances(beads, beads, *(np.broadcast_to(end, beads.shape) for end in others))
    return np.maximum(pairs.clear - away, 0.0).max(axis=-1)
