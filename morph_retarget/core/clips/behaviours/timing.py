"""When behaviours come and go: soft beginnings and ends, changes while they run, and limits of speed.

Movements that are not disturbed have the smallest jerk: speed rises and falls like a bell, and its peak is
`BELL` times the mean.
"""

import math
from collections.abc import Sequence

import numpy as np

from ... import smoothing
from ...arrays import Array
from ...locomotion.moving import eased

BELL = 1.9
"""Peak speed of a movement of smallest jerk over its mean speed (1.875), and a little more."""
ROUNDED = 2
"""Frames to either side over which the corners are rounded that limits of speed leave."""


def risen(times: Array, start: float, lasts: float) -> Array:
    """Return a way from 0 at a time to 1 at a later one, of smallest jerk, held outside; at once if it takes no time.

    Args:
        times: [s], shape (n,).
        start: When it begins [s].
        lasts: How long it takes [s].
    """
    if lasts <= 0.0:
        return (times >= start).astype(np.float64)
    return eased((times - start) / lasts)


def passing(
    times: Array, starts: Sequence[float], lasts: Sequence[float], ways: Sequence[Array | None]
) -> tuple[Array, Array]:
    """Return values that pass from each way to the next one, and how far they count, shapes (n, k) and (n,).

    Before the first way, and where there is none, nothing counts; there the values are those of the way beside.

    Args:
        times: [s], shape (n,).
        starts: When it begins to pass to each way [s].
        lasts: For how long it does [s].
        ways: Values for all times, shapes (n, k); None for nothing.
    """
    width = next((way.shape[1] for way in ways if way is not None), 1)
    values, counts = np.zeros((len(times), width)), np.zeros(len(times))
    for start, last, way in zip(starts, lasts, ways, strict=True):
        rise = risen(times, start, last)
        before = (1.0 - rise) * counts
        if way is None:
            counts = before
            continue
        now = before + rise
        share = np.where(now > 0.0, rise / np.maximum(now, 1e-12), 1.0)[:, None]
        values = values + share * (way - values)
        counts = now
    return values, counts


def limited(values: Array, judged: Sequence[int], most: float, step: float) -> Array:
    """Return values that follow others no faster than allowed, shape (n, k); the first is where it is wanted.

    It goes through the whole clip from its first frame, so that any frame is the same whatever is shown before.

    Args:
        values: What is followed, shape (n, k).
        judged: Columns whose speed together is limited; the others are held back with them.
        most: Speed, in the values' own unit per second.
        step: From frame to frame [s].
    """
    own, reach = values[:, list(judged)], most * step
    if len(values) < 2 or np.sqrt((np.diff(own, axis=0) ** 2).sum(axis=1)).max() <= reach:
        return values
    rows, heads = values.tolist(), own.tolist()
    now, head, out = rows[0], heads[0], [rows[0]]
    for row, wanted in zip(rows[1:], heads[1:], strict=True):
        away = math.dist(head, wanted)
        share = 1.0 if away <= reach else reach / away
        now = [a + share * (b - a) for a, b in zip(now, row, strict=True)]
        head = [a + share * (b - a) for a, b in zip(head, wanted, strict=True)]
        out.append(now)
    followed = np.array(out)
    width = min(ROUNDED, len(values) - 1)
    return np.column_stack([smoothing.moving_average(followed[:, i], width) for i in range(followed.shape[1])])


def at(times: Array, values: Array, time: float) -> Array:
    """Return values at one time, between those of frames, shapes (n,) and (n, k) to (k,)."""
    return np.array([np.interp(time, times, values[:, i]) for i in range(values.shape[1])])


def step_of(times: Array) -> float:
    """Return the time from frame to frame [s]."""
    return float(times[-1] - times[0]) / max(len(times) - 1, 1)
