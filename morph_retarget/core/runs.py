"""Runs: the intervals in which something holds."""

import numpy as np

from .arrays import Flags


def runs(flags: Flags) -> list[tuple[int, int]]:
    """Return the first and last frame of every run of true flags, shape (frame,)."""
    edges = np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8))
    return list(zip(np.flatnonzero(edges == 1).tolist(), (np.flatnonzero(edges == -1) - 1).tolist(), strict=True))
