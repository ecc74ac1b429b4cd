"""Smoothing curves over time with a raised-cosine window."""

from typing import cast

import numpy as np

from .arrays import Array


def filtered(padded: Array, width: int) -> Array:
    """Return a padded curve smoothed over ``width`` frames to either side, shape (frame + 2 * width,) to (frame,)."""
    kernel = np.hanning(2 * width + 3)[1:-1]
    return cast("Array", np.convolve(padded, kernel / kernel.sum(), mode="valid"))


def moving_average(values: Array, width: int) -> Array:
    """Return ``values`` smoothed, ends held, shape (frame,)."""
    return filtered(np.pad(values, width, mode="edge"), width)


def upper_envelope(values: Array, width: int) -> Array:
    """Return a smooth curve that is nowhere below ``values``, shape (frame,)."""
    padded = np.pad(values, width, mode="edge")
    highest: Array = np.lib.stride_tricks.sliding_window_view(padded, 2 * width + 1).max(axis=-1)
    return np.maximum(moving_average(highest, width), values)


def between_ends(values: Array, width: int) -> Array:
    """Return ``values`` without their fast part, exact at both ends, shape (frame, n)."""
    weight = np.linspace(0.0, 1.0, len(values))[:, None]
    ends: Array = values[:1] + weight * (values[-1:] - values[:1])
    rest = values - ends
    # Mirrored about each end, so that the smoothed curve leaves and arrives where the motion does.
    reach = min(width, len(values) - 1)
    padded = np.concatenate([-rest[reach:0:-1], rest, -rest[-2 : -reach - 2 : -1]])
    return ends + np.column_stack([filtered(padded[:, i], reach) for i in range(values.shape[1])])
