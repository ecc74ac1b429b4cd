"""Smoothing curves over time with a raised-cosine window."""

from collections.abc import Sequence
from typing import cast

import numpy as np

from .arrays import Array, Indices


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


def bridged(values: Array, runs: Sequence[tuple[int, int]]) -> Array:
    """Return ``values`` with the gaps between runs bridged smoothly, held before the first and after the last.

    Args:
        values: Shape (frame, n).
        runs: First and last frame of each run; without any nothing is known and all is 0.
    """
    if not runs:
        return np.zeros_like(values)
    edges = [t for run in runs for t in run]
    out = _smooth_steps(np.arange(len(values)), np.array(edges, dtype=np.float64), values[edges])
    for first, last in runs:
        out[first : last + 1] = values[first : last + 1]
    return out


def _smooth_steps(frames: Indices, times: Array, values: Array) -> Array:
    """Return ``values`` at ``times`` interpolated with level ends, constant outside, shape (frame, n)."""
    place = np.clip(np.searchsorted(times, frames, side="right") - 1, 0, len(times) - 2)
    span = np.maximum(times[place + 1] - times[place], 1e-9)
    t = np.clip((frames - times[place]) / span, 0.0, 1.0)[:, None]
    t = t * t * (3.0 - 2.0 * t)
    return values[place] + t * (values[place + 1] - values[place])
