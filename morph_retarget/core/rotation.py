"""Rotations as matrices, for work on few at a time: a product costs a tenth of that of quaternions there.

Matrices are on the last two axes, shape (..., 3, 3), vectors on the last one; all functions broadcast over what leads.
"""

import numpy as np

from . import quat
from .arrays import Array

_IDENTITY = np.eye(3)
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
    return (2.0 / quat.dot(axes, axes))[..., None, None] * axes[..., :, None] * axes[..., None, :] - _IDENTITY


class Hinges:
    """Rotations about axes that stay the same."""

    def __init__(self, axes: Array) -> None:
        """Take unit vectors, shape (hinge, 3)."""
        x, y, z = axes[..., 0], axes[..., 1], axes[..., 2]
        zero = np.zeros_like(x)
        rows = [np.stack(row, axis=-1) for row in ((zero, -z, y), (z, zero, -x), (-y, x, zero))]
        self._skew = np.stack(rows, axis=-2)
        self._square = self._skew @ self._skew

    def turned(self, angles: Array) -> Array:
        """Return the rotations by angles [rad], shape (..., hinge) to (..., hinge, 3, 3)."""
        sine, rest = np.sin(angles)[..., None, None], (1.0 - np.cos(angles))[..., None, None]
        return _IDENTITY + sine * self._skew + rest * self._square
