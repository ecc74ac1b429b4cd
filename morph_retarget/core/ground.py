"""The ground: how high it is under points."""

from collections.abc import Callable

import numpy as np

from .arrays import Array

OFF_GROUND = 0.1
"""Of a character that rests lower than this share of its size below z = 0, nobody knows where its ground is: it flies
or swims about its origin."""

Ground = Callable[[Array], Array]
"""Height of the ground under points [m], shape (n, 3) to shape (n,), in their own space; NaN where there is none."""


def heights_on(ground: Ground, points: Array, otherwise: Array | float) -> Array:
    """Return how high the ground is under points [m], shape (..., 3) to (...).

    Args:
        ground: The ground.
        points: [m], shape (..., 3).
        otherwise: What counts where there is none [m], shape (...) or one for all.
    """
    found = ground(points.reshape(-1, 3)).reshape(points.shape[:-1])
    return np.where(np.isfinite(found), found, otherwise)
