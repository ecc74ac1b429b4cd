"""Holding: what a hand has closed on goes along with it until it is let go."""

from dataclasses import dataclass

import numpy as np

from ... import quat
from ...arrays import Array
from ..track import Track
from . import timing


@dataclass(frozen=True, eq=False)
class Holding:
    """Something that is in a character's hand, or mouth."""

    target: str
    """Its name; empty for a place."""
    body: int
    """What holds it."""
    start: float
    """From when [s] …"""
    end: float
    """… to when; infinite if it is not let go."""

    def carried(self, track: Track, times: Array, places: Array, turns: Array) -> tuple[Array, Array]:
        """Return where the thing is and how it has turned over time: it stays where it is let go.

        Args:
            track: Where it is by itself.
            times: Of the frames [s], shape (n,).
            places: Of the body in the pose that the solver has found [m], shape (n, 3).
            turns: Of the body from rest then, shape (n, 4).

        Returns:
            Places [m], shape (n, 3), and turns from how it lay, shape (n, 4).
        """
        first = int(np.argmin(np.abs(times - self.start)))
        held = np.clip(times, self.start, self.end)
        # Held frames that lie between two of the times are as those of the nearest.
        rows = np.abs(times[None] - held[:, None]).argmin(axis=1)
        turned = quat.multiply(quat.normalize(turns[rows]), quat.conjugate(turns[first]))
        own = track.at(times)
        away = timing.at(times, own, self.start) - places[first]
        moved = places[rows] + quat.rotate(turned, np.broadcast_to(away, own.shape))
        before = times < self.start
        return np.where(before[:, None], own, moved), np.where(before[:, None], quat.IDENTITY, turned)
