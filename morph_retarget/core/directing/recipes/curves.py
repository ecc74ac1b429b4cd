"""Curves through keys: smooth, and never beyond the keys where these turn round.

Between keys a curve is a cubic whose slope at a key is the mean of those to its neighbours, but level where the keys
turn round and at the ends, and never so steep that the curve would overshoot (Fritsch & Carlson 1980). Blender's
automatic, clamped handles look much the same.
"""

import numpy as np

from ...arrays import Array

STEEPEST = 3.0
"""A slope of more than this many times that to either neighbour may overshoot."""


def curve(frames: Array, values: Array, at: Array, period: float | None = None) -> Array:
    """Return values between keys, held beyond them, or repeated.

    Args:
        frames: Of the keys, rising, shape (key,).
        values: Shape (key, component).
        at: Frames, shape (n,).
        period: After how many frames the keys come again; None where they do not.
    """
    if period is not None and len(frames) > 1:
        own = frames < frames[0] + period - 1e-6
        frames, values = frames[own], values[own]
        frames = np.concatenate([frames[-1:] - period, frames, frames[:2] + period])
        values = np.concatenate([values[-1:], values, values[np.arange(2) % len(values)]])
        at = frames[1] + (at - frames[1]) % period
    if len(frames) == 1:
        return np.repeat(values, len(at), axis=0)
    wide = np.diff(frames)
    secants = np.diff(values, axis=0) / wide[:, None]
    slopes = np.zeros_like(values)
    before, after = secants[:-1], secants[1:]
    least = STEEPEST * np.minimum(np.abs(before), np.abs(after))
    slopes[1:-1] = np.where(before * after > 0.0, np.clip(0.5 * (before + after), -least, least), 0.0)
    at = np.clip(at, frames[0], frames[-1])
    left = np.clip(np.searchsorted(frames, at, side="right") - 1, 0, len(wide) - 1)
    step = wide[left][:, None]
    s = (at - frames[left])[:, None] / step
    low, high = values[left], values[left + 1]
    bent = low + (3.0 - 2.0 * s) * s * s * (high - low)
    return bent + step * s * (1.0 - s) * ((1.0 - s) * slopes[left] - s * slopes[left + 1])
