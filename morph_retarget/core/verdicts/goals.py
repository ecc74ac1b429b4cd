"""Whether bodies come to their goals, as far as goals can be come to.

A goal out of its limb's reach is met by a limb that stretches toward it (Hecker 2008 §4.3, "graceful failure"). So what
is judged is the distance that is left beyond what no pose of that limb could make up for. Nor does a spine fold in two
to come to a goal before its nose: such a goal is implausible, which is the third of the paper's failures to be graceful
in. Goals that count in part are meant to be met in part, and are not judged.
"""

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
    """Return how far a body stays from a goal that it could come to [shares of its limb's length]."""
    aims = [aim for aim in performance.aims if aim.joints or aim.body == performance.root]
    shares = [_missed(performance, aim) for aim in aims]
    names = [performance.names[aim.body] for aim in aims]
    return Found.worst(np.stack(shares, axis=-1), names) if shares else Found(0.0)


def _missed(performance: Performance, aim: Aim) -> Array:
    away = quat.length(performance.places[:, aim.body] - aim.places)
    length = SHORTEST * performance.size
    if aim.joints:
        full, least = performance.hierarchy.lengths(aim.joints, aim.body)
        least = max(least, aim.folds * full)
        distance = quat.length(aim.places - performance.places[:, aim.joints[0]])
        away = away - np.maximum(np.maximum(distance - aim.stretch * full, least - distance), 0.0)
        length = max(length, full)
    return np.where(aim.influence >= COUNTS, np.maximum(away, 0.0) / length, 0.0)
