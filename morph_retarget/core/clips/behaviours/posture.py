"""Postures: how a body that plays a motion stands, and what turning some of its bodies changes."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ... import quat
from ...arrays import Array, Flags, Indices
from ...tree import Tree


@dataclass(frozen=True, eq=False)
class Posture:
    """Turns and places of all bodies over a batch of frames, ground frame in which the character sets out."""

    turns: Array
    """From rest, shape (n, body, 4)."""
    positions: Array
    """[m], shape (n, body, 3)."""

    def __len__(self) -> int:
        return len(self.turns)

    def __getitem__(self, rows: Indices | Flags | slice) -> "Posture":
        return Posture(self.turns[rows], self.positions[rows])

    def turned(self, tree: Tree, changes: Mapping[int, Array]) -> "Posture":
        """Return the posture with some bodies turned, and all that they carry.

        Args:
            tree: Who carries whom.
            changes: What turns each body and all that it carries, down to the next one that is told here, (n, 4).
        """
        turns, positions = self.turns.copy(), self.positions.copy()
        by: dict[int, Array] = {}
        for body in tree.order:
            parent = int(tree.parents[body])
            above = by.get(parent)
            own = changes.get(body, above)
            if above is not None:
                positions[:, body] = positions[:, parent] + quat.rotate(
                    above, self.positions[:, body] - self.positions[:, parent]
                )
            if own is not None:
                by[body] = own
                turns[:, body] = quat.multiply(own, turns[:, body])
        return Posture(turns, positions)

    def seen(self, body: int, rest: Array) -> Array:
        """Return where a rest direction of a body points, shape (3,) to (n, 3)."""
        return quat.rotate(self.turns[:, body], np.broadcast_to(rest, (len(self), 3)))

    def point(self, body: int, rest: Array) -> Array:
        """Return where a point of a body is [m], its rest place from the body's joint, shape (3,) to (n, 3)."""
        return self.positions[:, body] + self.seen(body, rest)
