"""Whether bodies come to their goals, as far as goals can be come to.

A goal out of its limb's reach is met by a limb that stretches toward it (Hecker 2008 §4.3, "graceful failure"). So what
is judged is the distance that is left beyond what no pose of that limb could make up for. Nor does a spine fold in two
to come to a goal before its nose: such a goal is implausible, which is the third of the paper's failures to be graceful
in. What hangs on one joint, as both mandibles on a head, gives that its goals together (`solve.allotment`), so the
middle of such bodies shall come to the middle of their goals. Goals that count in part are meant to be met in part, and
are not judged.
"""

from collections.abc import Sequence

import numpy as np

from .. import quat
from ..arrays import Array
from .performance import Aim, Performance
from .verdict import Found

COUNTS = 0.99
"""Influence from which on a goal shall be met."""
SHORTEST = 0.05
"""No limb counts for shorter than this share of the character's size."""


def missed(performance: Performance) -> Found:
    """Return how far bodies stay from goals that they could come to [shares of their limbs' lengths]."""
    aims = [aim for aim in performance.aims if aim.joints or aim.body == performance.root]
    together = [[aim, *(other for other in aims if other is not aim and _go_together(aim, other))] for aim in aims]
    shares = [_missed(performance, own) for own in together]
    names = [performance.names[aim.body] for aim in aims]
    return Found.worst(np.stack(shares, axis=-1), names) if shares else Found(0.0)


def _go_together(aim: Aim, other: Aim) -> bool:
    """Return whether the same joints bring two bodies to their goals."""
    return bool(aim.joints) and aim.joints == other.joints


def _missed(performance: Performance, aims: Sequence[Aim]) -> Array:
    """Return how far the middle of bodies that go together stays from that of their goals, shape (frame,)."""
    aim, bodies, wanted = aims[0], [aim.body for aim in aims], np.mean([aim.places for aim in aims], axis=0)
    away, length = quat.length(performance.places[:, bodies].mean(axis=1) - wanted), SHORTEST * performance.size
    if aim.joints:
        full, least = performance.hierarchy.lengths(aim.joints, aim.body)
        offsets = performance.hierarchy.rest[bodies] - performance.hierarchy.rest[aim.joints[-1]]
        full += float(quat.length(offsets.mean(axis=0)) - quat.length(offsets[0]))  # the middle does not reach as far
        least = max(least, aim.folds * full)
        distance = quat.length(wanted - performance.places[:, aim.joints[0]])
        away = away - np.maximum(np.maximum(distance - aim.stretch * full, least - distance), 0.0)
        length = max(length, full)
    counts = np.min([aim.influence for aim in aims], axis=0) >= COUNTS
    return np.where(counts, np.maximum(away, 0.0) / length, 0.0)
