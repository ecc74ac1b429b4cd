"""Travel: the slow part of a body's way over the ground and of its facing; sway and bob are not part of it."""

import numpy as np

from .arrays import Array
from .smoothing import between_ends

TRAVEL_TIME = 0.5
"""Slower changes than this count as travel [s]."""


def slow_way(places: Array, headings: Array, seconds_per_frame: float) -> Array:
    """Return the slow way of a body, exact in the first and the last frame, shape (frame, 3): x, y and heading.

    Args:
        places: Of the body on the ground [m], shape (frame, 2).
        headings: To the left [rad], shape (frame,).
        seconds_per_frame: Time between frames [s].
    """
    width = max(round(TRAVEL_TIME / seconds_per_frame), 1)
    return between_ends(np.column_stack([places, np.unwrap(headings)]), width)
