"""Coherent noise over time, as Perlin and Goldberg 1996 lay it on joints: smooth, at random, and on average nothing."""

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array, Indices

Bits = NDArray[np.uint64]


def noise(times: Array, seed: int, channels: Indices) -> Array:
    """Return noise within -1 … 1, shape (n, channel): any time has its value, whatever else is asked for.

    It is gradient noise: slopes at whole times are drawn at random, and values between two follow first the one and
    then the other. Each slope adds as much before its time as it takes away after it, so the integral stays near 0
    however long it gets.

    Args:
        times: In units of the noise, in one of which it swings about once, shape (n,).
        seed: Other ones make other noise.
        channels: Numbers of independent noises, shape (channel,).
    """
    keys = _scrambled(np.array([seed % 2**64], dtype=np.uint64)) ^ _scrambled(channels.astype(np.uint64))
    # Each is 0 at whole times, so not all at the same.
    places = times[:, None] + _uniform(_scrambled(keys))
    cells = np.floor(places)
    into = places - cells
    before, after = _slopes(cells.astype(np.int64), keys)
    share = into**3 * (10.0 - 15.0 * into + 6.0 * into * into)
    return 2.0 * (before * into + share * (after * (into - 1.0) - before * into))


def _slopes(cells: NDArray[np.int64], keys: Bits) -> tuple[Array, Array]:
    """Return the slopes at whole times and at the next ones, shapes (n, channel)."""
    if not len(cells):
        return np.zeros(cells.shape), np.zeros(cells.shape)
    low = cells.min(axis=0)
    deep = int((cells - low).max(initial=0)) + 2
    if len(cells) < 2 * deep:
        return _slope(cells, keys), _slope(cells + 1, keys)
    # Many times between few whole ones.
    all_ = _slope(low + np.arange(deep)[:, None], keys)
    return np.take_along_axis(all_, cells - low, axis=0), np.take_along_axis(all_, cells - low + 1, axis=0)


def _slope(cells: NDArray[np.int64], keys: Bits) -> Array:
    return 2.0 * _uniform(_scrambled(cells.astype(np.uint64) ^ keys)) - 1.0


def _uniform(bits: Bits) -> Array:
    """Return numbers within 0 … 1."""
    return (bits >> np.uint64(11)).astype(np.float64) * 2.0**-53


def _scrambled(bits: Bits) -> Bits:
    """Return bits of which each depends on all (the finalizer of SplitMix64, Steele et al. 2014)."""
    bits = bits + np.uint64(0x9E3779B97F4A7C15)
    bits = (bits ^ (bits >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    bits = (bits ^ (bits >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return bits ^ (bits >> np.uint64(31))
