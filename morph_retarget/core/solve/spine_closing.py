"""Exact bone lengths of a spine: the shape that a chain has, bent until its bones span the wanted distance.

As in `closing`, one number is left: here it multiplies the tangents of half the angles between bones and the line from
start to end. Of a chain with many bones those that lead far off the line anyway then bend less than the others, and
none turns over; small angles are multiplied as they are.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .. import quat
from ..arrays import Array, Flags
from . import spanning
from .constraints import TINY

FOLD = float(np.tan(0.97 * 0.5 * np.pi))
"""Tangent of half the angle by which no bone turns farther from the line."""


@dataclass(frozen=True, eq=False)
class _Tangents:
    """Chains of which the tangents of half the angles between bones and the line are multiplied by a number's root."""

    halves: Array
    """Square to the line, as long as these tangents, shape (row, bone, 3)."""
    squares: Array
    """Of the tangents, shape (row, bone)."""
    lengths: Array
    """Of the bones [m], shape (row, bone)."""

    def at(self, rows: Flags) -> "_Tangents":
        """Return some of the chains."""
        return _Tangents(self.halves[rows], self.squares[rows], self.lengths[rows])

    def spans(self, number: Array) -> tuple[Array, Callable[[], Array]]:
        """Return the squares of their distances and what tells the slopes, see `spanning.Bend`."""
        share = self.lengths / (1.0 + number[:, None] * self.squares)
        along = 2.0 * share.sum(axis=-1) - self._full
        across = np.matmul(share[:, None], self._wholes)[:, 0]
        sides = quat.dot(across, across)

        def slope() -> Array:
            # By how much shares, and what they lead to, get less.
            change = share * share * self._losses
            aside = np.matmul(change[:, None], self._wholes)[:, 0]
            return sides - 4.0 * along * change.sum(axis=-1) - 2.0 * number * quat.dot(across, aside)

        return along * along + number * sides, slope

    @cached_property
    def _full(self) -> Array:
        return self.lengths.sum(axis=-1)

    @cached_property
    def _wholes(self) -> Array:
        return 2.0 * self.halves

    @cached_property
    def _losses(self) -> Array:
        return self.squares / np.maximum(self.lengths, TINY)


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
    # Square to the line, as long as the tangents of half the angles.
    halves = (shape - along[..., None] * line) / np.maximum(1.0 + along, 1e-6)[..., None]
    squares = quat.dot(halves, halves)
    most = FOLD**2 / np.maximum((squares * (lengths > 0.0)).max(axis=-1), TINY)
    own = np.empty_like(squares)
    own[:] = lengths
    bend = _Tangents(halves.reshape(-1, bones, 3), squares.reshape(-1, bones), own.reshape(-1, bones))
    number = spanning.number(bend, most.ravel(), distance.ravel()).reshape(distance.shape)[..., None]
    share = 1.0 / (1.0 + number * squares)
    sides = (2.0 * np.sqrt(number) * share)[..., None] * halves
    return (2.0 * share - 1.0)[..., None] * line + sides
