"""Exact bone lengths: the shape that the particles give a chain, bent until the bones span the wanted distance.

The particle solver lets constraints stretch and compress; a skinned bone must not. So a chain keeps the shape that
the solver found for it, and one number is left: by how much the angles between its bones and the line from its start
to its end are multiplied. 0 is the straight chain, 1 the shape as it is, more folds it up. The distance falls with it,
which makes the right one easy to find, and the answer depends on the frame's own shape alone.
"""

import numpy as np

from .. import quat
from ..arrays import Array

STEPS = 24
"""Most steps; a few are enough for all that can be reached."""
EXACT = 1e-10
"""Error of a squared distance that is left, as a share of the square of the chain's length."""
FOLD = 0.97 * np.pi
"""No bone turns farther than this from the line [rad]."""
FEW = 64
"""So many chains are not worth parting those that are open from those that are there."""
_TINY = 1e-12


def close(shape: Array, lengths: Array, axis: Array, distance: Array) -> Array:
    """Return directions of bones that span a distance, as near as they can, shape (frame, chain, bone, 3).

    The bones then end in the direction of the result's own sum, which is near ``axis`` but not on it.

    Args:
        shape: Unit directions of the bones, shape (frame, chain, bone, 3).
        lengths: Of the bones [m], 0 where a chain has fewer, shape (chain, bone) or (frame, chain, bone).
        axis: Unit vectors along which the chains reach, shape (frame or 1, chain, 3).
        distance: Between start and end [m], shape (frame, chain).
    """
    line = axis[..., None, :]
    along = quat.dot(shape, np.broadcast_to(line, shape.shape))
    across = shape - along[..., None] * line
    sine = quat.length(across)
    angles = np.arctan2(sine, along)
    sides = across / np.maximum(sine, _TINY)[..., None]
    factor = _factor(angles, sides, lengths, distance)
    bent = factor[..., None] * angles
    return np.cos(bent)[..., None] * line + np.sin(bent)[..., None] * sides


def _factor(angles: Array, sides: Array, lengths: Array, distance: Array) -> Array:
    """Return what the angles of each chain are multiplied by, shape (frame, chain).

    Newton's method for the square of that factor, of which the square of the distance is nearly a linear function; kept
    between bounds that close in, by bisection where a step would leave them.
    """
    full = lengths.sum(axis=-1)
    high = (FOLD / np.maximum(_widest(angles, sides, lengths), 1e-6)) ** 2
    shape, bones = high.shape, angles.shape[-1]
    out = np.minimum(high, 1.0).ravel()
    rows, found, low, high = np.arange(out.size), out, np.zeros_like(out), high.ravel()
    square = np.broadcast_to(np.minimum(distance, full) ** 2, shape).ravel()
    close_enough = np.broadcast_to(EXACT * (full**2), shape).ravel()
    lengths = np.broadcast_to(lengths, angles.shape).reshape(-1, bones)
    angles, sides = angles.reshape(-1, bones), sides.reshape(-1, bones, 3)
    for _ in range(STEPS):
        factor = np.sqrt(np.maximum(found, _TINY))
        bent = factor[:, None] * angles
        cosine, sine = lengths * np.cos(bent), lengths * np.sin(bent)
        along = cosine.sum(axis=-1)
        across = np.matmul(sine[:, None], sides)[:, 0]
        excess = along * along + quat.dot(across, across) - square
        # What is there stays as it is, to the bit, however long other frames take.
        open_ = np.abs(excess) > close_enough
        if not open_.any():
            break
        turning = np.matmul((angles * cosine)[:, None], sides)[:, 0]
        slope = (quat.dot(across, turning) - along * (angles * sine).sum(axis=-1)) / factor
        # Behind its shortest a chain gets longer again: there is no way there.
        too_long = (excess > 0.0) & (slope < 0.0)
        low, high = np.where(too_long, found, low), np.where(too_long, high, found)
        step = np.maximum(found - excess / np.minimum(slope, -_TINY), 0.0)
        inside = (step >= low) & (step <= high)
        found = np.where(open_, np.where(inside, step, 0.5 * (low + high)), found)
        out[rows] = found
        if len(rows) > FEW and 2 * np.count_nonzero(open_) < len(rows):
            # A few take many steps, those above all that cannot get there: the others need not wait for them.
            rows, found, low, high = rows[open_], found[open_], low[open_], high[open_]
            square, close_enough = square[open_], close_enough[open_]
            lengths, angles, sides = lengths[open_], angles[open_], sides[open_]
    return np.sqrt(out).reshape(shape)


def _widest(angles: Array, sides: Array, lengths: Array) -> Array:
    """Return the widest angle of each chain [rad], shape (frame, chain): between bones and the line.

    Of two bones, it is the one between them: a knee must not fold through itself.
    """
    there = lengths > 0.0
    widest = (angles * there).max(axis=-1)
    if lengths.shape[-1] < 2:
        return widest
    last = angles[..., -2:, None] * sides[..., -2:, :]
    return np.where(there.sum(axis=-1) == 2, np.maximum(quat.length(last[..., 1, :] - last[..., 0, :]), widest), widest)
