"""Ways over the ground that are put together anew: steps mixed and summed, and cycles repeated."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ...arrays import Array, Flags
from ..travel import Travel, turned

STEP = 0.25
"""Frames from one node of a summed way to the next; frames of clips are whole, so curves between them are as fine."""


@dataclass(frozen=True, eq=False)
class Way:
    """A travel known at some times, from where the first of them is."""

    nodes: Array
    """[frames], ascending, shape (n,)."""
    travel: Travel
    """Shape (n,)."""

    def at(self, times: Array) -> Travel:
        """Return where it has led at times, held beyond the ends."""
        return self.travel.at(np.interp(times, self.nodes, np.arange(len(self.nodes), dtype=np.float64)))

    @property
    def whole(self) -> Travel:
        """Where it ends."""
        return self.travel[-1:]


def between(first: float, last: float) -> Array:
    """Return nodes from one frame to another, both included."""
    return np.append(np.arange(first, last - 1e-6 * STEP, STEP), last)


def blended(nodes: Array, first: Travel, second: Travel, share: Callable[[Array], Array]) -> Way:
    """Return the way whose steps are on their way from those of one travel to those of another.

    Args:
        nodes: [frames].
        first: At the nodes.
        second: At the nodes.
        share: Of the second at any times.
    """
    middle = 0.5 * (nodes[1:] + nodes[:-1])
    return Way(nodes, first.steps().mixed(second.steps(), share(middle)).summed())


def scaled(step: Travel, by: float | Array) -> Travel:
    """Return steps that lead only so far; for short ones."""
    by = np.asarray(by, dtype=np.float64)
    return Travel(step.places * by[..., None], step.headings * by)


def repeated(cycle: Travel, counts: Array) -> Travel:
    """Return where a cycle leads that is gone through so many times, shape (n,): a power of a motion of the plane.

    Args:
        cycle: One.
        counts: Whole numbers, shape (n,).
    """
    heading = float(cycle.headings[0])
    # Whole turns lead nowhere else; what is left is within half a turn, where only 0 makes the sum's divisor vanish.
    half = 0.5 * (heading - 2.0 * np.pi * round(heading / (2.0 * np.pi)))
    # The sum of a vector turned by 0, 1, 2 … cycles is a chord of the circle on which its ends lie.
    size = counts if abs(half) < 1e-12 else np.sin(counts * half) / np.sin(half)
    places = size[:, None] * turned(cycle.places, (counts - 1.0) * half)
    return Travel(places, counts * heading)


def pieced(times: Array, pieces: Sequence[tuple[Flags, Callable[[Array], Travel]]]) -> Travel:
    """Return a travel whose rows come from several sources, each asked for the times of its own rows alone."""
    places, headings = np.zeros((len(times), 2)), np.zeros(len(times))
    for rows, source in pieces:
        if rows.any():
            part = source(times[rows])
            places[rows], headings[rows] = part.places, part.headings
    return Travel(places, headings)
