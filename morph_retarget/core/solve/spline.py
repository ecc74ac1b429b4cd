"""Spine splines, Hecker 2008 §4.3.2: the shape of the bones between two branch points, told by its ends alone.

A quintic Hermite spline has a place, a first and a second derivative at each end. It is fitted to the joints between
by linear least squares; where these are too few to tell all, it stays as near to the straight line as it can.
"""

from dataclasses import dataclass

import numpy as np

from ..arrays import Array

_HERMITE = np.array(
    [
        [1.0, 0.0, 0.0, -10.0, 15.0, -6.0],  # place at the start
        [0.0, 0.0, 0.0, 10.0, -15.0, 6.0],  # place at the end
        [0.0, 1.0, 0.0, -6.0, 8.0, -3.0],  # first derivative at the start
        [0.0, 0.0, 0.0, -4.0, 7.0, -3.0],  # first derivative at the end
        [0.0, 0.0, 0.5, -1.5, 1.5, -0.5],  # second derivative at the start
        [0.0, 0.0, 0.0, 0.5, -1.0, 0.5],  # second derivative at the end
    ]
)
"""Powers of t in each of the six basis functions."""


@dataclass(frozen=True, eq=False)
class Splines:
    """The linear maps of splines through joints; all that depends on nothing but the parameters along them."""

    parameters: Array
    """Of the joints, 0 at the first and 1 at the last, shape (spline, joint)."""
    fit: Array
    """From the joints to the six vectors of the spline, shape (spline, 6, joint)."""
    places: Array
    """From these to places at the parameters, shape (spline, joint, 6)."""

    @property
    def middles(self) -> Array:
        """Parameters half-way between the joints, shape (spline, joint - 1)."""
        return 0.5 * (self.parameters[:, 1:] + self.parameters[:, :-1])

    @classmethod
    def through(cls, lengths: Array) -> "Splines":
        """Return the splines for joints at distances [m] from each other, shape (spline, joint - 1)."""
        along = np.concatenate([np.zeros((len(lengths), 1)), np.cumsum(lengths, axis=-1)], axis=-1)
        t = along / np.maximum(along[:, -1:], 1e-12)
        powers = t[..., None] ** np.arange(6)
        places = powers @ _HERMITE.T
        # A straight line: both first derivatives lead from end to end.
        fit = np.zeros((len(t), 6, t.shape[1]))
        fit[:, [0, 2, 3], 0] = [1.0, -1.0, -1.0]
        fit[:, [1, 2, 3], -1] = [1.0, 1.0, 1.0]
        left = np.eye(t.shape[1]) - places @ fit
        fit[:, 2:] += np.linalg.pinv(places[:, 1:-1, 2:]) @ left[:, 1:-1]
        return cls(t, fit, places)
