"""Batched quaternion and vector verbs.

Quaternions are ``(w, x, y, z)`` on the last axis, unit length unless stated, and all functions broadcast over the
leading axes. Vectors are on the last axis as well.
"""

from collections.abc import Callable
from functools import wraps

import numpy as np
from numpy.typing import ArrayLike

from .arrays import Array

IDENTITY: Array = np.array([1.0, 0.0, 0.0, 0.0])
_TINY = 1e-12
_VECDOT: Callable[[Array, Array], Array] | None = getattr(np, "vecdot", None)
"""For few vectors half the time; NumPy 2 has it."""


BLOCK = 8192
"""Products of more elements than this are made block by block: temporaries that fit into the cache are worth it."""


def _in_blocks(width: int) -> Callable[[Callable[[Array, Array, Array], None]], Callable[[Array, Array], Array]]:
    """Make a product, given by how it fills ``out``, work on blocks of rows; its last axis is ``width`` long."""

    def decorate(fill: Callable[[Array, Array, Array], None]) -> Callable[[Array, Array], Array]:
        """Return the product that ``fill`` makes, whatever shapes the two factors have."""

        @wraps(fill)
        def product(a: Array, b: Array) -> Array:
            shape = np.broadcast_shapes(a.shape[:-1], b.shape[:-1])
            out = np.empty((*shape, width))
            if out.size <= width * BLOCK:
                fill(a, b, out)
                return out
            step = max(BLOCK * shape[0] * width // out.size, 1)
            for start in range(0, shape[0], step):
                rows = slice(start, start + step)
                fill(_rows(a, out, rows), _rows(b, out, rows), out[rows])
            return out

        return product

    return decorate


def _rows(v: Array, out: Array, rows: slice) -> Array:
    """Return the rows of ``v`` that belong to ``rows`` of ``out``; all of it where it is the same for each row."""
    return v[rows] if v.ndim == out.ndim and len(v) > 1 else v


def identity(*shape: int) -> Array:
    """Return identity quaternions, shape ``(*shape, 4)``."""
    out = np.zeros((*shape, 4))
    out[..., 0] = 1.0
    return out


@_in_blocks(4)
def multiply(a: Array, b: Array, out: Array) -> None:
    """Return the product ``a b``: the rotation that applies ``b`` first and then ``a``."""
    aw, ax, ay, az = a[..., 0], a[..., 1], a[..., 2], a[..., 3]
    bw, bx, by, bz = b[..., 0], b[..., 1], b[..., 2], b[..., 3]
    out[..., 0] = aw * bw - ax * bx - ay * by - az * bz
    out[..., 1] = aw * bx + ax * bw + ay * bz - az * by
    out[..., 2] = aw * by - ax * bz + ay * bw + az * bx
    out[..., 3] = aw * bz + ax * by - ay * bx + az * bw


_LEFT = np.array([[0, 1, 2, 3], [1, 0, 3, 2], [2, 3, 0, 1], [3, 2, 1, 0]])
_LEFT_SIGNS = np.array([[1.0, -1.0, -1.0, -1.0], [1.0, 1.0, -1.0, 1.0], [1.0, 1.0, 1.0, -1.0], [1.0, -1.0, 1.0, 1.0]])
_RIGHT_SIGNS = np.array([[1.0, -1.0, -1.0, -1.0], [1.0, 1.0, 1.0, -1.0], [1.0, -1.0, 1.0, 1.0], [1.0, 1.0, -1.0, 1.0]])


def before_matrix(q: Array) -> Array:
    """Return what products ``q p`` multiply ``p`` by, shape ``(..., 4, 4)``; for few, a tenth of the time."""
    return q[..., _LEFT] * _LEFT_SIGNS


def after_matrix(q: Array) -> Array:
    """Return what products ``p q`` multiply ``p`` by, shape ``(..., 4, 4)``."""
    return q[..., _LEFT] * _RIGHT_SIGNS


def conjugate(q: Array) -> Array:
    """Return the inverse of unit quaternions."""
    return q * np.array([1.0, -1.0, -1.0, -1.0])


def dot(a: Array, b: Array) -> Array:
    """Return the inner product over the last axis, which is dropped."""
    return _VECDOT(a, b) if _VECDOT is not None else np.einsum("...i,...i->...", a, b)


def length(v: Array) -> Array:
    """Return the length over the last axis, which is dropped (several times faster than ``numpy.linalg.norm``)."""
    return np.sqrt(dot(v, v))


def normalize(q: Array) -> Array:
    """Return ``q`` at unit length; a zero quaternion becomes the identity."""
    size = length(q)[..., None]
    if size.min(initial=1.0) > _TINY:
        return q / size
    return np.where(size <= _TINY, IDENTITY, q / np.maximum(size, _TINY))


@_in_blocks(3)
def cross(a: Array, b: Array, out: Array) -> None:
    """Return the cross product of 3-vectors (several times faster than ``numpy.cross`` on large batches)."""
    ax, ay, az = a[..., 0], a[..., 1], a[..., 2]
    bx, by, bz = b[..., 0], b[..., 1], b[..., 2]
    out[..., 0] = ay * bz - az * by
    out[..., 1] = az * bx - ax * bz
    out[..., 2] = ax * by - ay * bx


@_in_blocks(3)
def rotate(q: Array, v: Array, out: Array) -> None:
    """Return vectors ``v`` turned by ``q``."""
    w, x, y, z = q[..., 0], q[..., 1], q[..., 2], q[..., 3]
    vx, vy, vz = v[..., 0], v[..., 1], v[..., 2]
    # v + w t + u x t with t = 2 u x v; written out, it needs the fewest passes over memory.
    tx, ty, tz = 2.0 * (y * vz - z * vy), 2.0 * (z * vx - x * vz), 2.0 * (x * vy - y * vx)
    out[..., 0] = vx + w * tx + (y * tz - z * ty)
    out[..., 1] = vy + w * ty + (z * tx - x * tz)
    out[..., 2] = vz + w * tz + (x * ty - y * tx)


def from_rotation_vector(r: Array) -> Array:
    """Return the exponential map of rotation vectors [rad], shape ``(..., 3)`` to ``(..., 4)``."""
    angle = length(r)[..., None]
    half = 0.5 * angle
    # sin(half)/angle by its series near zero, so that the map stays smooth there.
    regular: Array = np.sin(half) / np.maximum(angle, 1e-6)
    series: Array = 0.5 - angle * angle / 48.0
    scale = np.where(angle > 1e-6, regular, series)
    return np.concatenate([np.cos(half), scale * r], axis=-1)


def to_rotation_vector(q: Array) -> Array:
    """Return the logarithmic map [rad] of unit quaternions, the shorter way round (length at most pi)."""
    q = np.where(q[..., :1] < 0.0, -q, q)
    sine = length(q[..., 1:])[..., None]
    angle = 2.0 * np.arctan2(sine, q[..., :1])
    scale = np.where(sine > 1e-9, angle / np.maximum(sine, 1e-9), 2.0)
    return scale * q[..., 1:]


def from_axis_angle(axis: ArrayLike, angle: ArrayLike) -> Array:
    """Return rotations by ``angle`` [rad] about unit ``axis``."""
    half = 0.5 * np.asarray(angle, dtype=np.float64)[..., None]
    return np.concatenate([np.cos(half), np.sin(half) * np.asarray(axis, dtype=np.float64)], axis=-1)


def direction(y: Array, x: Array) -> Array:
    """Return the angles [rad] from the x axis to points (x, y), to the bit the same wherever these lie in memory.

    NumPy before 2 takes another way, which rounds otherwise, where a column of vectors ends next to its result.
    """
    return np.arctan2(y.copy(), x.copy())


def angle_between(a: Array, b: Array) -> Array:
    """Return the angle [rad] of the rotation that leads from ``a`` to ``b``."""
    cosine = np.abs(dot(a, b))
    # arccos is blind near 1; the chord is not.
    chord = np.minimum(length(a - b), length(a + b))
    wide: Array = 2.0 * np.arccos(np.clip(cosine, 0.0, 1.0))
    narrow: Array = 4.0 * np.arcsin(np.clip(chord / 2.0, 0.0, 1.0))
    return np.where(cosine < 0.9, wide, narrow)


def unit(v: Array) -> Array:
    """Return vectors at unit length; zero vectors stay zero."""
    size = length(v)[..., None]
    if size.min(initial=1.0) > _TINY:
        return v / size
    return v / np.where(size > _TINY, size, 1.0) * (size > _TINY)


def between(a: Array, b: Array) -> Array:
    """Return the smallest rotations that turn directions ``a`` onto ``b``.

    Opposite directions turn by pi about an axis square to ``a``; a zero vector on either side gives the identity.
    """
    a, b = unit(a), unit(b)
    a, b = np.broadcast_arrays(a, b)
    w = 1.0 + dot(a, b)[..., None]
    q = np.concatenate([w, cross(a, b)], axis=-1)
    opposite = (w < 1e-9) & (length(a)[..., None] > 0.5)
    if opposite.any():
        # Square to a: cross with the coordinate axis that a leans on least.
        least = np.eye(3)[np.argmin(np.abs(a), axis=-1)]
        side = unit(cross(a, least))
        q = np.where(opposite, np.concatenate([np.zeros_like(w), side], axis=-1), q)
    return normalize(q)


def slerp(a: Array, b: Array, t: ArrayLike) -> Array:
    """Return the spherical interpolation from ``a`` (t = 0) to ``b`` (t = 1), the shorter way round."""
    t = np.asarray(t, dtype=np.float64)[..., None]
    out = np.empty((*np.broadcast_shapes(a.shape[:-1], b.shape[:-1], t.shape[:-1]), 4))
    if out.size <= 4 * BLOCK:
        _slerp(a, b, t, out)
        return out
    step = max(BLOCK * len(out) * 4 // out.size, 1)
    for start in range(0, len(out), step):
        rows = slice(start, start + step)
        _slerp(_rows(a, out, rows), _rows(b, out, rows), _rows(t, out, rows), out[rows])
    return out


def _slerp(a: Array, b: Array, t: Array, out: Array) -> None:
    """Sum shares of both: a quarter of the time of a product with an exponential."""
    sides = dot(a, b)
    cosine = np.minimum(np.abs(sides), 1.0)
    angle = np.arccos(cosine)
    sine = np.sqrt((1.0 - cosine) * (1.0 + cosine))
    part = t[..., 0] * angle
    later = np.sin(part) / np.maximum(sine, 1e-12)
    if angle.min(initial=1.0) <= 1e-7:  # a line
        later = np.where(angle > 1e-7, later, t[..., 0])
    np.einsum("...,...i->...i", np.cos(part) - cosine * later, a, out=out)
    out += np.einsum("...,...i->...i", np.copysign(later, sides), b)


def mean(q: Array, shares: Array) -> Array:
    """Return the mean of rotations less than half a turn apart, shape (..., n, 4) to (..., 4).

    Args:
        q: Rotations.
        shares: How much each counts, shape (..., n).
    """
    alike = np.where(dot(q, q[..., :1, :]) < 0.0, -1.0, 1.0)
    return normalize(((shares * alike)[..., None] * q).sum(axis=-2))


def twist_about(q: Array, axis: Array) -> Array:
    """Return the twist part of ``q`` about unit ``axis``: ``q = swing * twist`` with the swing square to the axis."""
    along = dot(q[..., 1:], axis)[..., None]
    return normalize(np.concatenate([q[..., :1], along * axis], axis=-1))


def continuous(q: Array) -> Array:
    """Return quaternions along axis 0 with signs chosen so that neighbours never jump to the antipode."""
    dots = dot(q[1:], q[:-1])
    if (dots >= 0.0).all():
        return q
    flips = np.cumprod(np.where(dots < 0.0, -1.0, 1.0), axis=0)
    out = q.copy()
    out[1:] *= flips[..., None]
    return out


def to_matrix(q: Array) -> Array:
    """Return rotation matrices, shape ``(..., 3, 3)``."""
    w, x, y, z = q[..., 0], q[..., 1], q[..., 2], q[..., 3]
    x2, y2, z2 = x + x, y + y, z + z
    wx, wy, wz = w * x2, w * y2, w * z2
    xx, yy, zz = x * x2, y * y2, z * z2
    xy, xz, yz = x * y2, x * z2, y * z2
    out = np.empty((*w.shape, 3, 3))
    out[..., 0, 0] = 1.0 - (yy + zz)
    out[..., 0, 1] = xy - wz
    out[..., 0, 2] = xz + wy
    out[..., 1, 0] = xy + wz
    out[..., 1, 1] = 1.0 - (xx + zz)
    out[..., 1, 2] = yz - wx
    out[..., 2, 0] = xz - wy
    out[..., 2, 1] = yz + wx
    out[..., 2, 2] = 1.0 - (xx + yy)
    return out


def _products() -> Array:
    """Return what takes the nine numbers of a rotation matrix to the products 4 q_i q_j, less the identity, (9, 16)."""
    out = np.zeros((3, 3, 4, 4))
    for i, signs in enumerate(((1, 1, -1, -1), (1, -1, 1, -1), (1, -1, -1, 1))):
        out[i, i] = np.diag(signs)
    for row, column, other in ((2, 1, 1), (0, 2, 2), (1, 0, 3)):
        out[row, column, [0, other], [other, 0]] = 1.0
        out[column, row, [0, other], [other, 0]] = -1.0
        out[row, column, [row + 1, column + 1], [column + 1, row + 1]] += 1.0
        out[column, row, [row + 1, column + 1], [column + 1, row + 1]] += 1.0
    return out.reshape(9, 16)


_PRODUCTS, _FOUR = _products(), np.eye(4).ravel()


def from_matrix(m: Array) -> Array:
    """Return the quaternions of proper rotation matrices, shape ``(..., 3, 3)`` to ``(..., 4)``.

    Each row of the products 4 q_i q_j is a multiple of the quaternion; the one with the largest divisor is used, so it
    is exact for every angle.
    """
    products = m.reshape(-1, 9) @ _PRODUCTS + _FOUR
    best = products[:, ::5].argmax(axis=-1)
    rows = products.reshape(-1, 4, 4)[np.arange(len(best)), best]
    return normalize(rows.reshape(*m.shape[:-2], 4))
