"""Rotations as matrices, for work on few at a time: a product costs a tenth of that of quaternions there.

Matrices are on the last two axes, shape (..., 3, 3), vectors on the last one; all functions broadcast over what leads.
"""

import numpy as np

from . import quat
from .arrays import Array

IDENTITY: Array = np.eye(3)
IDENTITY.flags.writeable = False
_OPPOSITE = 1e-12
_LEVI_CIVITA: Array = np.cross(np.eye(3)[:, None], np.eye(3)[None]).transpose(2, 0, 1)


def apply(rotation: Array, vectors: Array) -> Array:
    """Return vectors turned, shape (..., 3)."""
    return np.matmul(rotation, vectors[..., None])[..., 0]


def cross(a: Array, b: Array) -> Array:
    """Return cross products (for few at a time; see `quat.cross` for many)."""
    return np.einsum("ijk,...j,...k->...i", _LEVI_CIVITA, a, b)


def transposed(rotation: Array) -> Array:
    """Return the inverse rotations."""
    return np.swapaxes(rotation, -1, -2)


def half_turn(axes: Array) -> Array:
    """Return the rotations by half a turn about axes of any length but 0.

    The smallest rotation from unit vector a to unit vector b is half a turn about a and then one about a + b.
    """
    share = 2.0 / np.maximum(quat.dot(axes, axes), 1e-300)
    return share[..., None, None] * (axes[..., :, None] * axes[..., None, :]) - IDENTITY


def between(a: Array, b: Array) -> Array:
    """Return the smallest rotations that turn unit vectors ``a`` onto unit vectors ``b``.

    Opposite ones turn about an axis square to ``a``.
    """
    middle = a + b
    odd = quat.dot(middle, middle) < _OPPOSITE
    if odd.any():
        least = np.eye(3)[np.argmin(np.abs(a), axis=-1)]
        middle = np.where(odd[..., None], cross(a, least), middle)
    return np.matmul(half_turn(middle), half_turn(a))
