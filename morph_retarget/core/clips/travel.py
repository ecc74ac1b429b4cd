"""Travel: the way of a body over the ground, apart from its poses.

Poses of a clip are seen from a frame that travels over the ground (Feng 2013 §5.2, the base transformation M). So clips
can be looped, blended and turned without any thought of where they were made, and the way is put together anew.
"""

from dataclasses import dataclass

import numpy as np

from ..arrays import Array, Indices


@dataclass(frozen=True, eq=False)
class Travel:
    """Frames on the ground, one for each time, as seen from the first of a clip: +X left, -Y ahead, character frame."""

    places: Array
    """[m], shape (n, 2)."""
    headings: Array
    """To the left [rad], unwrapped, shape (n,)."""

    def __len__(self) -> int:
        return len(self.headings)

    def __getitem__(self, rows: slice | Indices) -> "Travel":
        return Travel(self.places[rows], self.headings[rows])

    @classmethod
    def still(cls, count: int = 1) -> "Travel":
        """Return that of what stays where it is."""
        return cls(np.zeros((count, 2)), np.zeros(count))

    def then(self, other: "Travel") -> "Travel":
        """Return where ``other`` leads from here; either may be one for all."""
        return Travel(self.places + turned(other.places, self.headings), self.headings + other.headings)

    def inverse(self) -> "Travel":
        """Return the way back."""
        return Travel(-turned(self.places, -self.headings), -self.headings)

    def since(self, start: "Travel") -> "Travel":
        """Return the same as seen from ``start``."""
        return start.inverse().then(self)

    def steps(self) -> "Travel":
        """Return what leads from each frame to the next, as seen from each, shape (n - 1)."""
        return self[1:].since(self[:-1])

    def summed(self) -> "Travel":
        """Return where steps lead one after the other from where they start, shape (n + 1)."""
        headings = np.concatenate([[0.0], np.cumsum(self.headings)])
        places = np.zeros((len(headings), 2))
        np.cumsum(turned(self.places, headings[:-1]), axis=0, out=places[1:])
        return Travel(places, headings)

    def mixed(self, other: "Travel", share: Array) -> "Travel":
        """Return what lies between these and ``other``, part by part; for steps, which are short. Share has (n,)."""
        places = self.places + share[:, None] * (other.places - self.places)
        return Travel(places, self.headings + share * (other.headings - self.headings))

    def at(self, rows: Array) -> "Travel":
        """Return frames between those of a sampled way, at rows that need not be whole; held beyond its ends."""
        rows = np.clip(rows, 0.0, len(self) - 1.0)
        low = np.minimum(rows.astype(np.intp), max(len(self) - 2, 0))
        high = np.minimum(low + 1, len(self) - 1)
        return self[low].mixed(self[high], rows - low)


def turned(vectors: Array, angles: Array) -> Array:
    """Return vectors on the ground turned to the left by angles [rad], shapes (n, 2) and (n,), either one for all."""
    sine, cosine = np.sin(angles), np.cos(angles)
    x, y = vectors[..., 0], vectors[..., 1]
    return np.stack([cosine * x - sine * y, sine * x + cosine * y], axis=-1)
