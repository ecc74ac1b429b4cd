"""Rotations as matrices, for work on few at a time: a product costs a tenth of that of quaternions there.

Matrices are on the last two axes, shape (..., 3, 3), vectors on the last one; all functions broadcast over what leads.
"""

import numpy as np

from . import quat
from .arrays import Array

IDENTITY: Array = np.eye(3)
IDENTITY.flags.writeable = False
_OPPOSITE = 1e-12
_ACROSS: Array = np.cross(np.eye(3)[:, None], np.eye(3)[None]).swapaxes(1, 2).reshape(3, 9)
"""From a vector to the nine numbers of `across`."""


def apply(rotation: Array, vectors: Array) -> Array:
    """Return vectors turned, shape (..., 3)."""
    return np.matmul(rotation, vectors[..., None])[..., 0]


def cross(a: Array, b: Array) -> Array:
    """Return cross products (for few at a time; see `quat.cross` for many)."""
    return apply(across(a), b)


def across(vectors: Array) -> Array:
    """Return the matrices that take vectors to the cross products of these with them, shape (..., 3, 3)."""
    return np.matmul(vectors, _ACROSS).reshape(*vectors.shape, 3)


def axes_of(rotation: Array) -> Array:
    """Return what rotations turn about, as long as twice the sine of the angle, shape (..., 3)."""
    return np.matmul(rotation.reshape(*rotation.shape[:-2], 9), _ACROSS.T)


def transposed(rotation: Array) -> Array:
    """Return the inverse rotations."""
    return rotation.swapaxes(-1, -2)


def about(axes: Array, angles: Array) -> Array:
    """Return rotations by angles [rad] about unit vectors, by Rodrigues' formula."""
    own = across(axes)
    sine, rest = np.sin(angles)[..., None, None], (1.0 - np.cos(angles))[..., None, None]
    return IDENTITY + sine * own + rest * np.matmul(own, own)


def half_turn(axes: Array, squares: Array | None = None) -> Array:
    """Return the rotations by half a turn about axes of any length but 0.

    Args:
        axes: Shape (..., 3).
        squares: Of their lengths, if these are known, shape (...).
    """
    out = np.matmul(axes[..., :, None], axes[..., None, :])
    squares = quat.dot(axes, axes) if squares is None else squares
    out *= (2.0 / np.maximum(squares, 1e-300))[..., None, None]
    out -= IDENTITY
    return out


def half_way(a: Array, b: Array) -> Array:
    """Return half turns about what lies midway between unit vectors, of opposite ones about an axis square to ``a``.

    The smallest rotation from one to the other is half a turn about the first and then this.
    """
    middle = a + b
    squares = quat.dot(middle, middle)
    odd = squares < _OPPOSITE
    if not odd.any():
        return half_turn(middle, squares)
    least = np.eye(3)[np.argmin(np.abs(a), axis=-1)]
    return half_turn(np.where(odd[..., None], cross(a, least), middle))


def between(a: Array, b: Array) -> Array:
    """Return the smallest rotations that turn unit vectors ``a`` onto unit vectors ``b``.

    Opposite ones turn about an axis square to ``a``.
    """
    return np.matmul(half_way(a, b), half_turn(a))
