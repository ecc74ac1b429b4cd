"""Length constraints between particles, Hecker 2008 §4.3.1: enforced softly, by moving both ends along the constraint.

All constraints of a call are between different particles, and all frames are one batch.
"""

import numpy as np

from .. import quat
from ..arrays import Array

TINY = 1e-12
NEAR = 0.25
"""Share of its length below which a constraint that is pressed together pushes the less, the shorter it is."""


def softened(error: Array, width: Array | float) -> Array:
    """Return how much of a length error is corrected: C1, quadratic up to ``width``, all but half of it beyond.

    Args:
        error: [m], any shape.
        width: Errors smaller than this are corrected less and less [m], positive.
    """
    inside = np.minimum(np.maximum(error, -width), width)
    return error - inside + inside * np.abs(inside) / (2.0 * width)


def beyond(distance: Array, start: Array, full: Array, least: Array) -> Array:
    """Return the length error of simplified limbs: none while they can be expected to bend, C1 up to their length.

    Args:
        distance: From where a limb starts to its goal [m], shape (frame, limb).
        start: Distance from which on there is an error [m], shape (limb,).
        full: Distance from which on the error grows as the distance does [m], shape (limb,).
        least: Distance to which a limb may shrink [m], shape (limb,).
    """
    room = np.maximum(full - start, TINY)
    over = np.maximum(distance - start, 0.0)
    inside = np.minimum(over, room)
    return inside * inside / (2.0 * room) + (over - inside) + np.minimum(distance - least, 0.0)


def corrections(start: Array, end: Array, rest: Array, width: Array | float) -> Array:
    """Return the way by which the ends of constraints come nearer to each other in all, shape (..., 3).

    Ends that all but coincide do not tell which way to part: the nearer they are, the less they do.

    Args:
        start: Rootward particles [m], shape (..., 3).
        end: Leafward particles, the same shape.
        rest: Lengths that the constraints want [m], shape (...).
        width: Of `softened`.
    """
    away = end - start
    distance = quat.length(away)
    share = softened(distance - rest, width) / np.maximum(distance, NEAR * rest + TINY)
    return share[..., None] * away


def together(ways: Array) -> Array:
    """Return how far a particle moves that several constraints want to move, (frame, constraint, 3) to (frame, 3).

    Each counts by how far it wants: one alone moves it all its way, and two that want the same do not move it twice.
    """
    sizes = quat.length(ways)
    return (sizes[..., None] * ways).sum(axis=1) / np.maximum(sizes.sum(axis=-1), TINY)[:, None]


def shares(weights: Array) -> Array:
    """Return the parts that some things have in their mean, alike where none of them counts, shape (..., n)."""
    some = weights + TINY
    return some / some.sum(axis=-1, keepdims=True)


def smooth_step(value: Array, low: float, high: float) -> Array:
    """Return 0 below ``low``, 1 above ``high`` and a smooth way between."""
    t = np.minimum(np.maximum((value - low) / (high - low), 0.0), 1.0)
    return t * t * (3.0 - 2.0 * t)
