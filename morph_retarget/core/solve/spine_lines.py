"""Lines of branch points and of bones: where they lead, and how a frame turns that is carried along them."""

import numpy as np

from .. import quat, rotation
from ..arrays import Array


def carried(rest: Array, posed: Array) -> Array:
    """Return how a frame turns that is carried along a line, by the smallest rotation at each place.

    None but that from where the line before it takes a direction to where it is, so the bends of the rest do not count.

    Args:
        rest: Directions along the line at rest, unit vectors, shape (frame or 1, place, 3).
        posed: The same as they are now, shape (frame, place, 3).

    Returns:
        Rotation matrices, shape (frame, place, 3, 3).
    """
    out, back = np.empty((*posed.shape, 3)), rotation.half_turn(rest)
    turn = rotation.IDENTITY[None]
    for i in range(posed.shape[1]):
        out[:, i] = turn = led(turn, rest[:, i], back[:, i], posed[:, i])
    return out


def led(turn: Array, rest: Array, back: Array, posed: Array) -> Array:
    """Return turns that go on by the smallest rotations that take what they carry to where it is.

    Args:
        turn: Shape (..., 3, 3).
        rest: Directions that it carries, at rest, unit vectors, shape (..., 3).
        back: Half turns about these, shape (..., 3, 3).
        posed: Where they lead now, unit vectors, shape (..., 3).
    """
    # To turn and then half about where a direction leads now is to turn half about where it led, and then to turn.
    return np.matmul(rotation.half_way(rotation.apply(turn, rest), posed), np.matmul(turn, back))


def steps(at: Array) -> Array:
    """Return the ways from each point to the next, shape (frame, point - 1, 3)."""
    return at[:, 1:] - at[:, :-1]


def tangents(at: Array, first: Array) -> Array:
    """Return tangents of branch points: three-point differences, and at the end that of a natural cubic spline.

    As that runs from branch point to branch point at the same speed, it turns back nowhere, however short its last
    piece is. The paper's formula for the end has its first difference the other way round, as a straight line tells.

    Args:
        at: The branch points [m], shape (frame, node, 3).
        first: Where the first one's tangent leads, which is known, shape (frame or 1, 3).

    Returns:
        Unit vectors, shape (frame, node, 3).
    """
    out = np.empty_like(at)
    out[:, 0] = first
    out[:, 1:-1] = at[:, 2:] - at[:, :-2]
    out[:, :-1] = quat.unit(out[:, :-1])
    out[:, -1] = quat.unit(1.5 * quat.unit(at[:, -1] - at[:, -2]) - 0.5 * out[:, -2])
    return out


def angles(a: Array, b: Array) -> Array:
    """Return the angles between vectors [rad]."""
    return np.arctan2(quat.length(quat.cross(a, b)), quat.dot(a, b))
