"""Euler angles in Blender's six orders: "XYZ" turns about X first, then Y, then Z, all about fixed axes."""

import numpy as np

from . import quat
from .arrays import Array

ORDERS = ("XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX")


def to_quaternions(angles: Array, order: str) -> Array:
    """Return rotations for Euler angles [rad] about x, y and z, shape (..., 3) to (..., 4)."""
    half = 0.5 * angles
    cosines, sines = np.cos(half), np.sin(half)
    parts: list[Array] = []
    for letter in order:
        axis = "XYZ".index(letter)
        part = np.zeros((*angles.shape[:-1], 4))
        part[..., 0] = cosines[..., axis]
        part[..., 1 + axis] = sines[..., axis]
        parts.append(part)
    return quat.multiply(parts[2], quat.multiply(parts[1], parts[0]))


def from_quaternions(rotations: Array, order: str) -> Array:
    """Return Euler angles [rad] about x, y and z, shape (frame, ..., 4) to (frame, ..., 3), without leaps over time.

    Of the two sets of angles that make one rotation the one nearer to the frame before is taken, and full turns are
    added so that curves run on.
    """
    i, j, k = ("XYZ".index(letter) for letter in order)
    sign = 1.0 if (j - i) % 3 == 1 else -1.0
    m = quat.to_matrix(rotations)
    cosine = np.hypot(m[..., i, i], m[..., j, i])
    out = np.empty((*rotations.shape[:-1], 3))
    out[..., j] = quat.direction(-sign * m[..., k, i], cosine)
    regular = cosine > 1e-7
    out[..., i] = np.where(
        regular, quat.direction(sign * m[..., k, j], m[..., k, k]), quat.direction(-sign * m[..., j, k], m[..., j, j])
    )
    out[..., k] = np.where(regular, quat.direction(sign * m[..., j, i], m[..., i, i]), 0.0)
    return _continuous(out, i, j, k)


def _continuous(angles: Array, i: int, j: int, k: int) -> Array:
    """Return angles that run on from frame to frame, choosing between each set and its twin.

    How far a set is from the twin of the one before does not depend on which of the two was chosen there, so the
    changes from one to the other can be found for all frames at once and then added up.
    """
    twin = angles.copy()
    twin[..., i] += np.pi
    twin[..., j] = np.pi - twin[..., j]
    twin[..., k] += np.pi
    changes = _distance(angles[1:], twin[:-1]) < _distance(angles[1:], angles[:-1])
    odd = np.zeros(angles.shape[:-1], dtype=bool)
    odd[1:] = np.cumsum(changes, axis=0) % 2 == 1
    return np.unwrap(np.where(odd[..., None], twin, angles), axis=0)


def _distance(a: Array, b: Array) -> Array:
    step = a - b
    turns: Array = np.round(step / (2.0 * np.pi))
    return np.abs(step - 2.0 * np.pi * turns).sum(axis=-1)
