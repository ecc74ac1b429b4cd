"""What all ways to get about have in common: prepared for a course, they give goals for any frames."""

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from .. import quat
from ..arrays import Array
from ..solve.goals import Goals

UP: Array = np.array([0.0, 0.0, 1.0])
LEFT: Array = np.array([1.0, 0.0, 0.0])


class Moving(Protocol):
    """A character on its course, on feet or without."""

    @property
    def wanted(self) -> tuple[tuple[int, bool, bool], ...]:
        """For each goal its body, and whether it has a place and a turn, as `posing.prepare` asks for it."""
        ...

    @property
    def warnings(self) -> tuple[str, ...]:
        """What the user should know."""
        ...

    def evaluate(self, times: Array, carried: Array | None = None) -> Goals:
        """Return goals for a batch of frames.

        Args:
            times: [s], shape (frame,).
            carried: From the ground frame to the character's own frame, where its object moves, shape (frame, 4, 4).
        """
        ...

    def floors(self, times: Array) -> Array:
        """Return how high the ground is that carries the body, ground frame [m], shape (frame,).

        It is that under the middle of the body as its feet, or what lies on the ground, feel it, so it does not jump
        where the ground does. What hovers feels the ground about it at many points: an edge is many small steps.

        Args:
            times: [s], shape (frame,).
        """
        ...


def wanted_of(bodies: Sequence[int]) -> tuple[tuple[int, bool, bool], ...]:
    """Return the goals of what turns some bodies and places the first of them, which is the root."""
    return tuple((body, i == 0, True) for i, body in enumerate(bodies))


def goals_of(bodies: Sequence[int], root: Array, turns: Array, carried: Array | None) -> Goals:
    """Return goals that count in full.

    Args:
        bodies: The root first.
        root: Its place [m], ground frame, shape (frame, 3).
        turns: Of all bodies from rest, shape (frame, body, 4).
        carried: From the ground frame to the character's own, shape (frame, 4, 4), or None where they are the same.
    """
    places = np.zeros((len(root), len(bodies), 3))
    places[:, 0] = root
    if carried is not None:
        places, turns = carried_by(carried, places, turns)
    whole = np.ones(turns.shape[:2])
    placed = np.zeros_like(whole)
    placed[:, 0] = 1.0
    return Goals(np.array(bodies, dtype=np.intp), places, turns, placed, whole)


def carried_by(matrices: Array, places: Array, turns: Array) -> tuple[Array, Array]:
    """Return places and turns as another frame sees them, shapes (frame, n, 3) and (frame, n, 4).

    Args:
        matrices: From the one frame to the other, rigid, shape (frame, 4, 4).
        places: [m], shape (frame, n, 3).
        turns: Shape (frame, n, 4).
    """
    own = matrices[:, :3, :3]
    turned = np.broadcast_to(quat.from_matrix(own)[:, None], turns.shape)
    return places @ np.swapaxes(own, -1, -2) + matrices[:, None, :3, 3], quat.multiply(turned, turns)


def eased(share: Array) -> Array:
    """Return a way from 0 to 1 that starts and ends softly, held outside, of any shape."""
    share = np.clip(share, 0.0, 1.0)
    return share * share * share * (10.0 - 15.0 * share + 6.0 * share * share)


def pointed(headings: Array, rises: Array) -> Array:
    """Return the turns, without any roll, of what looks along -Y to headings [rad] and upward [rad], (..., 4)."""
    return quat.multiply(quat.from_axis_angle(UP, headings), quat.from_axis_angle(LEFT, -rises))


def heading_of(ways: Array) -> Array:
    """Return the headings of ways over the ground [rad], shape (..., 2 or 3) to (...)."""
    return quat.direction(ways[..., 0], -ways[..., 1])


def rise_of(ways: Array) -> Array:
    """Return by what angle ways go up [rad], shape (..., 3) to (...)."""
    return quat.direction(ways[..., 2], np.hypot(ways[..., 0], ways[..., 1]))
