"""Tracks: where something is over time that commands name as their target."""

from dataclasses import dataclass

import numpy as np

from ..arrays import Array


@dataclass(frozen=True, eq=False)
class Track:
    """Places over time, in the frame of the ground on which the character sets out."""

    times: Array
    """[s], rising, shape (n,)."""
    places: Array
    """[m], shape (n, 3)."""
    surface: Array | None = None
    """Points of its surface as seen from its place at the first time [m], shape (point, 3), where it is to be held."""

    @classmethod
    def at_place(cls, place: Array) -> "Track":
        """Return the track of what stays at a place [m], shape (3,)."""
        return cls(np.zeros(1), np.asarray(place, dtype=np.float64)[None])

    def at(self, times: Array) -> Array:
        """Return places at times [s], held beyond the ends, shape (n,) to (n, 3)."""
        return np.stack([np.interp(times, self.times, self.places[:, i]) for i in range(3)], axis=-1)
