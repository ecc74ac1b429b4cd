"""Cycles in a motion: where one begins, and after how long the body is the same again.

Bodies are compared by the places of their joints beside their way over the ground. A cycle's length is found to a part
of a frame: to where the body, as it moves in that frame, comes nearest to where it was.
"""

from dataclasses import dataclass

import numpy as np

from ...arrays import Array
from .seen import Seen

SHORTEST, LONGEST = 0.25, 4.0
"""Of cycles that are looked for within a motion [s]."""
ALIKE = 0.5
"""Bodies that go in cycles differ after one by less than this share of how much they differ in all."""
NEARLY = 1.3
"""The first cycle that fits about as well as the best, up to this factor, is the one; others are several of it."""
COARSE = 1.0 / 60.0
"""Cycles are first looked for in frames that are this far apart [s]."""
LIKENESS_TIME = 0.06
"""A cycle is cut where the body is most alike for this time to either side [s]: it then also moves alike."""
MOST_OPEN = 2.0
"""A whole motion is a cycle if its last frame and its first are no further apart than so many of its steps …"""
MOST_APART = 0.35
"""… and than this share of how much its frames differ."""
MOVES = 0.3
"""A body that is slower than this share of its mean at the ends of a motion rests there."""


@dataclass(frozen=True)
class Cycle:
    """Some frames of a motion after which it is the same again."""

    first: float
    """Row in which it begins."""
    length: float
    """Rows after which it begins again."""
    whole: bool
    """Whether it is all of the motion, and the frame after its last one the first."""


def closing(seen: Seen) -> Cycle | None:
    """Return the whole motion as a cycle, None where its end does not lead to its beginning.

    Some clips hold their first frame once more at their end, some stop just before it.
    """
    shape = _flat(seen)
    if len(shape) < 4:
        return None
    gap = shape[0] - shape[-1]
    step = 0.5 * (shape[1] - shape[0] + shape[-1] - shape[-2])
    longest = max(_length(shape[1] - shape[0]), _length(shape[-1] - shape[-2]))
    usual = float(np.linalg.norm(np.diff(shape, axis=0), axis=1).mean())
    apart = _length(gap)
    if apart > MOST_OPEN * max(longest, 0.5 * usual) or apart > MOST_APART * _spread(shape):
        return None
    more = float(gap @ step) / max(float(step @ step), 1e-18)
    # What hardly moves at its ends tells nothing of a part of a frame.
    more = float(np.clip(more, 0.0, MOST_OPEN)) if apart > 0.1 * usual else 0.0
    return Cycle(0.0, len(shape) - 1 + more, whole=True)


def rests_at_ends(seen: Seen) -> bool:
    """Return whether the body comes from rest and goes back to it."""
    speeds = np.linalg.norm(np.diff(_flat(seen), axis=0), axis=1)
    return len(speeds) < 2 or float(max(speeds[0], speeds[-1])) < MOVES * float(speeds.mean())


def find(seen: Seen) -> Cycle | None:
    """Return the best cycle within a motion, None where it is never the same again."""
    shape = _flat(seen)
    # About how long it is can be told from fewer frames.
    every = max(round(COARSE / seen.step), 1)
    few = shape[::every]
    shortest = max(round(SHORTEST / (every * seen.step)), 3)
    longest = min(round(LONGEST / (every * seen.step)), len(few) * 3 // 4)
    if longest <= shortest + 2:
        return None
    lags = np.arange(shortest, longest)
    errors = np.array([_difference(few, lag) for lag in lags.tolist()])
    dips = np.flatnonzero((errors[1:-1] < errors[:-2]) & (errors[1:-1] <= errors[2:])) + 1
    good = dips[errors[dips] < ALIKE]
    if not len(good):
        return None
    lag = int(lags[good[errors[good] < NEARLY * errors[good].min()][0]])
    return _best(shape, every * lag, max(round(LIKENESS_TIME / seen.step), 1))


def _best(shape: Array, lag: int, reach: int) -> Cycle:
    """Return the cycle of about some length whose ends fit best."""
    best, found = np.inf, (0, lag)
    for own in range(max(lag - max(lag // 10, 1), 2), min(lag + max(lag // 10, 1), len(shape) - 2) + 1):
        # The frame after a cycle has one after itself, to which its length may reach.
        errors = ((shape[own:-1] - shape[: -own - 1]) ** 2).sum(axis=1)
        width = min(2 * reach + 1, len(errors))
        means = np.convolve(errors, np.ones(width) / width, mode="valid")
        place = int(means.argmin())
        if means[place] < best:
            best, found = float(means[place]), (place + width // 2, own)
    first, own = found
    after = first + own
    low, high = max(after - 1, 0), min(after + 1, len(shape) - 1)
    step = (shape[high] - shape[low]) / (high - low)
    more = float((shape[first] - shape[after]) @ step) / max(float(step @ step), 1e-18)
    return Cycle(float(first), own + float(np.clip(more, -1.0, 1.0)), whole=False)


def _flat(seen: Seen) -> Array:
    """Return the body in each frame as one vector, shape (frame, n); its length is a mean over joints."""
    shape = seen.shape / (seen.size * np.sqrt(seen.shape.shape[1]))
    return shape.reshape(len(shape), -1)


def _spread(shape: Array) -> float:
    return float(np.sqrt(((shape - shape.mean(axis=0)) ** 2).sum(axis=1).mean()))


def _difference(shape: Array, lag: int) -> float:
    """Return how much a motion differs after some frames, as a share of how much it differs in all."""
    apart = np.sqrt(((shape[lag:] - shape[:-lag]) ** 2).sum(axis=1).mean())
    return float(apart) / max(0.5 * (_spread(shape[lag:]) + _spread(shape[:-lag])), 1e-9)


def _length(vector: Array) -> float:
    return float(np.linalg.norm(vector))
