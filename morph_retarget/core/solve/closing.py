"""Exact bone lengths: the shape that the particles give a chain, bent until the bones span the wanted distance.

The particle solver lets constraints stretch and compress; a skinned bone must not. So a chain keeps the shape that
the solver found for it, and one number is left: by how much the angles between its bones and the line from its start
to its end are multiplied. 0 is the straight chain, 1 the shape as it is, more folds it up. The distance falls with it,
which makes the right one easy to find, and the answer depends on the frame's own shape alone.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .. import quat
from ..arrays import Array, Flags
from . import spanning

FOLD = 0.97 * np.pi
"""No bone turns farther than this from the line [rad]."""
_TINY = 1e-12


@dataclass(frozen=True, eq=False)
class _Angles:
    """Chains of which the angles between bones and the line are multiplied by the root of a number."""

    angles: Array
    """[rad], shape (row, bone)."""
    sides: Array
    """To which bones lead off the line, unit vectors, shape (row, bone, 3)."""
    lengths: Array
    """Of the bones [m], shape (row, bone)."""

    def at(self, rows: Flags) -> "_Angles":
        """Return some of the chains."""
        return _Angles(self.angles[rows], self.sides[rows], self.lengths[rows])

    def spans(self, number: Array) -> tuple[Array, Callable[[], Array]]:
        """Return the squares of their distances and what tells the slopes, see `spanning.Bend`."""
        factor = np.sqrt(np.maximum(number, _TINY))
        bent = factor[:, None] * self.angles
        cosine, sine = self.lengths * np.cos(bent), self.lengths * np.sin(bent)
        along, across = cosine.sum(axis=-1), np.matmul(sine[:, None], self.sides)[:, 0]

        def slope() -> Array:
            turning = np.matmul((self.angles * cosine)[:, None], self.sides)[:, 0]
            return (quat.dot(across, turning) - along * (self.angles * sine).sum(axis=-1)) / factor

        return along * along + quat.dot(across, across), slope


def close(shape: Array, lengths: Array, axis: Array, distance: Array) -> Array:
    """Return directions of bones that span a distance, as near as they can, shape (frame, chain, bone, 3).

    The bones then end in the direction of the result's own sum, which is near ``axis`` but not on it.

    Args:
        shape: Unit directions of the bones, shape (frame, chain, bone, 3).
        lengths: Of the bones [m], 0 where a chain has fewer, shape (chain, bone) or (frame, chain, bone).
        axis: Unit vectors along which the chains reach, shape (frame or 1, chain, 3).
        distance: Between start and end [m], shape (frame, chain).
    """
    line, bones = axis[..., None, :], shape.shape[-2]
    along = quat.dot(shape, line)
    across = shape - along[..., None] * line
    sine = quat.length(across)
    angles = np.arctan2(sine, along)
    sides = across / np.maximum(sine, _TINY)[..., None]
    most = (FOLD / np.maximum(_widest(angles, sides, lengths), 1e-6)) ** 2
    own = np.empty_like(angles)
    own[:] = lengths
    bend = _Angles(angles.reshape(-1, bones), sides.reshape(-1, bones, 3), own.reshape(-1, bones))
    number = spanning.number(bend, most.ravel(), distance.ravel()).reshape(distance.shape)
    bent = np.sqrt(number)[..., None] * angles
    return np.cos(bent)[..., None] * line + np.sin(bent)[..., None] * sides


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
