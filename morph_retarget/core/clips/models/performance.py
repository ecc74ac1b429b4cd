"""Performances: what a character does from its first command on, at any frame (Grünvogel 2003 §6).

A motion tree holds from the frame at which the controller built it to the next one. Where it leads is counted from
there, so trees may come and go while the way over the ground goes on.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ...arrays import Array, Flags
from ..character_model import CharacterModel
from ..clip import Clip
from ..frames import Frames
from ..operators.rows import placed
from ..operators.ways import pieced
from ..travel import Travel
from .footed import standing
from .token import Token


@dataclass(frozen=True, eq=False)
class Segment:
    """A motion tree and the frame from which it holds."""

    start: float
    tree: Clip
    place: Travel
    """Where the character is at the start, one place."""
    tokens: tuple[Token, ...]
    """All motions that have influence, or wait."""

    def travel(self, times: Array) -> Travel:
        """Return where the character is at times, shape (n,)."""
        way = self.tree.travel(np.concatenate([[self.start], times]))
        return self.place.then(way[1:].since(way[:1]))


@dataclass(frozen=True, eq=False)
class Performance:
    """All motion of a character, as a function of time alone."""

    model: CharacterModel
    segments: tuple[Segment, ...]
    """In order of time, at least one; the first holds before its start as well."""
    warnings: tuple[str, ...] = ()
    """Commands, or parts of them, that could not be obeyed, with where they were written."""

    def frame(self, times: Array) -> Frames:
        """Return frames at times [frames], shape (n,)."""
        parts: list[tuple[Flags, Frames]] = []
        for segment, rows in self._rows(times):
            parts.append((rows, segment.tree.frame(times[rows])))
        out = placed(len(times), parts) if parts else self.segments[0].tree.frame(times)
        return replace(out, contacts=standing(out.contacts))

    def travel(self, times: Array) -> Travel:
        """Return where the character is at times, shape (n,), without a break from segment to segment."""
        return pieced(times, [(rows, segment.travel) for segment, rows in self._rows(times)])

    @property
    def settled(self) -> float:
        """Frame from which on nothing begins and nothing ends any more."""
        return self.segments[-1].start

    def tree_at(self, frame: float) -> Clip:
        """Return the motion tree that holds at a frame."""
        return self._segment(frame).tree

    def tokens_at(self, frame: float) -> tuple[Token, ...]:
        """Return the motions that have influence at a frame, or wait for others to end."""
        return tuple(token for token in self._segment(frame).tokens if frame <= token.influence)

    @cached_property
    def _starts(self) -> Array:
        return np.array([segment.start for segment in self.segments[1:]])

    def _segment(self, frame: float) -> Segment:
        return self.segments[int(np.searchsorted(self._starts, frame, side="right"))]

    def _rows(self, times: Array) -> list[tuple[Segment, Flags]]:
        """Return the segments that times fall into, with the rows of each."""
        own = np.searchsorted(self._starts, times, side="right")
        return [(self.segments[i], own == i) for i in np.unique(own).tolist()]
