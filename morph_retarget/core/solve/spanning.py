"""How much a chain has to bend for its bones to span a distance: the one number that `closing` and others leave open.

The square of the distance is nearly a linear function of that number over another one, which is known at 0, where the
chain is straight: each step takes the one that has the same value and slope where it stands. Numbers are kept between
bounds that close in, by bisection where a step would leave them. All chains of all frames are rows of one batch.
"""

from collections.abc import Callable
from typing import Protocol, Self

import numpy as np

from ..arrays import Array, Flags
from .constraints import TINY

STEPS = 24
"""Most steps; a few are enough for all that can be reached."""
EXACT = 1e-10
"""Error of a squared distance that is left, as a share of the square of the chain's length."""
FEW = 64
"""So many chains are not worth parting those that are open from those that are there."""


class Bend(Protocol):
    """Chains that bend the more, the larger a number is; 1 is the shape that they have."""

    @property
    def lengths(self) -> Array:
        """Of their bones [m], 0 where a chain has fewer, shape (row, bone)."""
        ...

    def at(self, rows: Flags) -> Self:
        """Return some of the chains."""
        ...

    def spans(self, number: Array) -> tuple[Array, Callable[[], Array]]:
        """Return the squares of the distances that they span [m²], and what returns by how much more for more of it.

        Args:
            number: Of each chain, shape (row,), as both that is returned.
        """
        ...


def number(bend: Bend, most: Array, distance: Array) -> Array:
    """Return the number for which chains span distances, or come as near as they can, shape (row,).

    Args:
        bend: The chains.
        most: Largest number, shape (row,).
        distance: Between start and end of each chain [m], shape (row,).
    """
    straight = bend.lengths.sum(axis=-1) ** 2
    square, close_enough = np.minimum(distance * distance, straight), EXACT * straight
    out = np.minimum(most, 1.0)
    rows, found, low, high = np.arange(len(out)), out, np.zeros_like(out), most
    for _ in range(STEPS):
        spanned, slope_of = bend.spans(found)
        excess = spanned - square
        # What is there stays as it is, to the bit, however long other frames take.
        open_ = np.abs(excess) > close_enough
        if not open_.any():
            break
        slope = slope_of()
        # Behind its shortest a chain gets longer again: there is no way there.
        too_long = (excess > 0.0) & (slope < 0.0)
        low, high = np.where(too_long, found, low), np.where(too_long, high, found)
        steep, short = (straight - spanned) / np.maximum(-found * slope, TINY), straight - square
        step = found * short / np.maximum(short - steep * excess, TINY)
        inside = (step >= low) & (step <= high)
        found = np.where(open_, np.where(inside, step, 0.5 * (low + high)), found)
        if len(rows) > FEW and 2 * np.count_nonzero(open_) < len(rows):
            # A few take many steps, those above all that cannot get there: the others need not wait for them.
            out[rows] = found
            rows, found, low, high = rows[open_], found[open_], low[open_], high[open_]
            bend, square, close_enough = bend.at(open_), square[open_], close_enough[open_]
            straight = straight[open_]
    out[rows] = found
    return out
