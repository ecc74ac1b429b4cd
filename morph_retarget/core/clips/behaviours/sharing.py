"""Sharing an angle among joints: each by its weight, until one comes to its limit and the others take the rest."""

import numpy as np

from ...arrays import Array


def cumulated(angle: Array, weights: Array, limits: Array) -> Array:
    """Return how far joints of a line turn one after the other, each what those before it do and its own share.

    Args:
        angle: Of all together [rad], shape (n,); more than all limits together is not reached.
        weights: Of the joints, from the first one that turns, shape (joint,), at least 0.
        limits: Of each joint's share [rad], shape (joint,).

    Returns:
        Angles [rad], shape (n, joint).
    """
    able = (weights > 0.0) & (limits > 0.0)
    if not able.any():
        return np.zeros((len(angle), len(weights)))
    full = np.where(able, limits / np.where(able, weights, 1.0), 0.0)
    # All grow as their weights until each has come to its limit: the sum is made of straight pieces.
    levels = np.concatenate([[0.0], np.sort(full[able])])
    sums = np.minimum(levels[:, None] * np.where(able, weights, 0.0), np.where(able, limits, 0.0)).sum(axis=1)
    level = np.interp(np.abs(angle), sums, levels)
    shares = np.minimum(level[:, None] * np.where(able, weights, 0.0), np.where(able, limits, 0.0))
    return np.sign(angle)[:, None] * np.cumsum(shares, axis=1)
