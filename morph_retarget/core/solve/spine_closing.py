"""Exact bone lengths of a spine: the shape that a chain has, bent until its bones span the wanted distance.

As in `closing`, one number is left: here it multiplies the tangents of half the angles between bones and the line from
start to end. Of a chain with many bones those that lead far off the line anyway then bend less than the others, and
none turns over; small angles are multiplied as they are.
"""

import numpy as np

from .. import quat
from ..arrays import Array
from .constraints import TINY

STEPS = 24
"""Most steps; a few are enough for all that can be reached."""
EXACT = 1e-10
"""Error of a squared distance that is left, as a share of the square of the chain's length."""
FOLD = float(np.tan(0.97 * 0.5 * np.pi))
"""Tangent of half the angle by which no bone turns farther from the line."""


def close(shape: Array, lengths: Array, axis: Array, distance: Array) -> Array:
    """Return directions of bones that span a distance, as near as they can, shape (frame, chain, bone, 3).

    The bones then end in the direction of the result's own sum, which is near ``axis`` but not on it.

    Args:
        shape: Unit directions of the bones, shape (frame, chain, bone, 3).
        lengths: Of the bones [m], 0 where a chain has fewer, shape (chain, bone) or (frame, chain, bone).
        axis: Unit vectors along which the chains reach, shape (frame or 1, chain, 3).
        distance: Between start and end [m], shape (frame, chain).
    """
    along = quat.dot(shape, axis[..., None, :])
    # Square to the line, as long as the tangents of half the angles.
    halves = (shape - along[..., None] * axis[..., None, :]) / np.maximum(1.0 + along, 1e-6)[..., None]
    squares = quat.dot(halves, halves)
    factor = _factor(halves, squares, lengths, distance)[..., None]
    share = 1.0 / (1.0 + factor * squares)
    sides = (2.0 * np.sqrt(factor) * share)[..., None] * halves
    return (2.0 * share - 1.0)[..., None] * axis[..., None, :] + sides


def _factor(halves: Array, squares: Array, lengths: Array, distance: Array) -> Array:
    """Return the square of what the tangents of each chain are multiplied by, shape (frame, chain).

    Newton's method: the square of the distance is nearly a linear function of it; kept between bounds that close in, by
    bisection where a step would leave them.
    """
    full = lengths.sum(axis=-1)
    low: Array = np.zeros_like(distance)
    high: Array = FOLD**2 / np.maximum((squares * (lengths > 0.0)).max(axis=-1), TINY)
    found: Array = np.minimum(high, 1.0)
    square, close_enough = np.minimum(distance, full) ** 2, EXACT * full * full
    for _ in range(STEPS):
        share = lengths / (1.0 + found[..., None] * squares)
        along = 2.0 * share.sum(axis=-1) - full
        across = 2.0 * np.matmul(share[..., None, :], halves)[..., 0, :]
        excess = along * along + found * quat.dot(across, across) - square
        # What is there stays as it is, to the bit, however long other frames take.
        open_ = np.abs(excess) > close_enough
        if not open_.any():
            break
        # How shares, and what they lead to, change with the factor.
        change = -share * share / np.maximum(lengths, TINY) * squares
        aside = 2.0 * np.matmul(change[..., None, :], halves)[..., 0, :]
        slope = 4.0 * along * change.sum(axis=-1)
        slope += quat.dot(across, across) + 2.0 * found * quat.dot(across, aside)
        # Behind its shortest a chain gets longer again: there is no way there.
        too_long = (excess > 0.0) & (slope < 0.0)
        low, high = np.where(too_long, found, low), np.where(too_long, high, found)
        step = np.maximum(found - excess / np.minimum(slope, -TINY), 0.0)
        inside = (step >= low) & (step <= high)
        found = np.where(open_, np.where(inside, step, 0.5 * (low + high)), found)
    return found
