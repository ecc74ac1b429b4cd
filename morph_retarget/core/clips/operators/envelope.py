"""How much a clip counts over time: up at one place, down at another."""

import numpy as np

from ...arrays import Array
from ...solve.constraints import smooth_step


def risen(times: Array, first: float, last: float, smooth: bool = True) -> Array:
    """Return a way from 0 at ``first`` to 1 at ``last``, held outside; at once where both are the same frame.

    Args:
        times: [frames], shape (n,).
        first: [frames]; infinite for what never rises.
        last: [frames].
        smooth: Whether it starts and ends gently.
    """
    if not np.isfinite(first):
        return np.full(len(times), 0.0 if first > 0.0 else 1.0)
    if last <= first:
        return (times >= last).astype(np.float64)
    return smooth_step(times, first, last) if smooth else np.clip((times - first) / (last - first), 0.0, 1.0)
