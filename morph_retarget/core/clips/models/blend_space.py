"""Blend spaces: which examples of a motion make one with given parameters, and with which weights.

Each example lies at a place: its speed, its turn, the height that it reaches. What lies between examples is made from
the corners of the smallest simplex around it, as Delaunay's triangulation has them, so that weights change
continuously with the parameters, one example alone counts at its own place, and no more than needed are blended. What
lies outside is made as the nearest place inside.
"""

from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import numpy as np

from ...arrays import Array, Indices
from ...errors import MotionError

NEAREST = 12
"""No more examples than this, the nearest, are tried together."""
TOLERANCE = 1e-9


@dataclass(frozen=True, eq=False)
class BlendSpace:
    """Examples and their places."""

    places: Array
    """Of the examples, shape (example, dimension)."""

    def __post_init__(self) -> None:
        if self.places.ndim != 2 or not len(self.places):
            raise MotionError("a blend space has no examples: give it at least one")
        if not np.isfinite(self.places).all():
            raise MotionError("a blend space has an example at a place that is no number: give it finite parameters")

    @cached_property
    def spread(self) -> Array:
        """By what each dimension is divided, so that distances along all are alike, shape (dimension,)."""
        wide = np.ptp(self.places, axis=0)
        return np.where(wide > TOLERANCE, wide, 1.0)

    @cached_property
    def varies(self) -> Indices:
        """Dimensions along which examples differ."""
        return np.flatnonzero(np.ptp(self.places, axis=0) > TOLERANCE)

    def weights(self, wanted: Array) -> Array:
        """Return how much each example counts at a place, shape (dimension,) to (example,); the sum is 1."""
        out = np.zeros(len(self.places))
        points = ((self.places - wanted) / self.spread)[:, self.varies]
        away = (points * points).sum(axis=1)
        near = np.argsort(away, kind="stable")[:NEAREST]
        best = np.inf, np.inf
        for count in range(1, min(len(self.varies) + 1, len(near)) + 1):
            chosen = np.array(list(combinations(near.tolist(), count)))
            shares = _barycentric(points[chosen])
            rest = np.einsum("mc,mcd->md", shares, points[chosen])
            # The corners of Delaunay's simplices are those with the least mean square distance.
            missed, wide = (rest * rest).sum(axis=1), (shares * away[chosen]).sum(axis=1)
            missed[np.isnan(missed)] = np.inf
            for row in np.flatnonzero(missed <= min(best[0], float(missed.min())) + TOLERANCE):
                rated = float(missed[row]), float(wide[row])
                if rated[0] < best[0] - TOLERANCE or rated[1] < best[1] - TOLERANCE:
                    best = rated
                    out[:] = 0.0
                    out[chosen[row]] = shares[row]
        return out

    def place_of(self, weights: Array) -> Array:
        """Return the place at which weights lie, shape (dimension,)."""
        return weights @ self.places


def _barycentric(points: Array) -> Array:
    """Return the shares of points whose sum is nearest to the origin on their flat, NaN where that is outside them.

    Args:
        points: Of several simplices, shape (simplex, corner, dimension).

    Returns:
        Shape (simplex, corner).
    """
    if points.shape[1] == 1:
        return np.ones(points.shape[:2])
    edges = points[:, 1:] - points[:, :1]
    square = edges @ np.swapaxes(edges, -1, -2)
    sizes = np.prod(np.diagonal(square, axis1=-2, axis2=-1), axis=-1)
    flat = np.abs(np.linalg.det(square)) <= TOLERANCE * sizes
    square[flat] = np.eye(square.shape[-1])
    shares = np.linalg.solve(square, -edges @ points[:, 0, :, None])[..., 0]
    out = np.concatenate([1.0 - shares.sum(axis=1, keepdims=True), shares], axis=1)
    out[flat | (out.min(axis=1) < -TOLERANCE)] = np.nan
    out = np.maximum(out, 0.0)
    return out / out.sum(axis=1, keepdims=True)
