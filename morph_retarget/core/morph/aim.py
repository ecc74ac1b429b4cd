"""Aiming at targets: frames whose x axis leads to one, and the look-at controller (Hecker 2008 §3.2.2)."""

from dataclasses import dataclass

import numpy as np

from .. import quat, rotation
from ..arrays import Array, Flags, Indices
from .bodies import FORWARD, LEFT, UP

AHEAD: Array = np.stack([FORWARD, LEFT, UP], axis=-1)
"""Axes of a frame whose target is straight ahead, as columns: toward it, left, up."""
FREE = np.radians(45.0)
"""A gaze follows its target fully up to this angle from the body's forward."""
MOST = np.radians(80.0)
"""It never turns farther than this."""


@dataclass(frozen=True, eq=False)
class Aims:
    """Which of some bodies move relative to targets, or look at them."""

    tiny: float
    """Distance below which a target is gradually taken for straight ahead [m]."""
    aimed: Indices
    """Bodies whose frames lead to a target, shape (aimed,)."""
    rest: Array
    """Their rest positions, seen in the mirror where they are mirrored [m], shape (aimed, 3)."""
    flip: Array
    """What takes them to the mirror and back: -1 along the lateral axis of mirrored ones, else 1, shape (aimed, 3)."""
    flat: Array
    """0 along the vertical of those whose frames only turn about it, else 1, shape (aimed, 3)."""
    only_turned: Flags
    """Whether the x axis keeps its scale, shape (aimed,)."""
    looking: Indices
    """Bodies that look at a target, shape (looking,)."""
    forwards: Array
    """Where these look at rest, unit vectors, shape (looking, 3)."""
    eyes: Array
    """Their rest positions [m], shape (looking, 3)."""

    def turned(self, targets: Array, axes: Array, scale: Array) -> tuple[Array, Array]:
        """Return axes and scales of all bodies with those of the aimed ones turned and stretched toward targets.

        The axes are turned from straight ahead to the target by the smallest rotation, which is singular for targets
        straight behind alone.

        Args:
            targets: [m], shape (frame, body, 3).
            axes: Shape (1, body, 3, 3).
            scale: Shape (1, body, 3).
        """
        axes, scale = np.repeat(axes, len(targets), axis=0), np.repeat(scale, len(targets), axis=0)
        if not len(self.aimed):
            return axes, scale
        away = (targets[:, self.aimed] * self.flip - self.rest) * self.flat
        distance = quat.length(away)
        direction = away / np.maximum(distance, 1e-12)[..., None]
        if (distance < self.tiny).any():
            direction = quat.unit(FORWARD + _smooth(distance / self.tiny)[..., None] * (direction - FORWARD))
            direction[~direction.any(axis=-1)] = FORWARD
        axes[:, self.aimed] = _ahead(direction) * self.flip[..., None]
        stretched = np.maximum(distance, 0.1 * self.tiny)
        scale[:, self.aimed, 0] = np.where(self.only_turned, scale[:, self.aimed, 0], stretched)
        return axes, scale

    def gaze(self, targets: Array) -> "Gaze | None":
        """Return what looks at the targets, None when nothing does.

        The direction is taken from where a body rests in its character, as the axes are: what a channel keys does not
        change its own frame, so that keys can be moved to other frames exactly.
        """
        if not len(self.looking):
            return None
        away = targets[:, self.looking] - self.eyes
        turns = quat.from_rotation_vector(toward(self.forwards, away, self.tiny))
        return Gaze(self.looking, quat.before_matrix(turns))


def _ahead(direction: Array) -> Array:
    """Return `AHEAD` turned from straight ahead to a direction by the smallest rotation, shape (..., 3, 3)."""
    s, u, v = np.moveaxis(direction @ AHEAD, -1, 0)
    opposite = s < -1.0 + 1e-9
    share = 1.0 / np.where(opposite, 1.0, 1.0 + s)
    out = np.empty((*s.shape, 3, 3))
    out[..., 0, 0], out[..., 0, 1], out[..., 0, 2] = s, -u, -v
    out[..., 1, 0], out[..., 1, 1], out[..., 1, 2] = u, 1.0 - u * u * share, -u * v * share
    out[..., 2, 0], out[..., 2, 1], out[..., 2, 2] = v, -u * v * share, 1.0 - v * v * share
    if opposite.any():
        out[opposite] = np.diag([-1.0, -1.0, 1.0])  # about the vertical
    return AHEAD @ out


def _smooth(t: Array) -> Array:
    """Return 0 … 1 for 0 … 1, starting and ending gently."""
    t = np.clip(t, 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


@dataclass(frozen=True, eq=False)
class Gaze:
    """Bodies that look at targets. A gaze turns a body's frame, so that a head can nod while it looks."""

    rows: Indices
    """The bodies that look."""
    turns: Array
    """What their rotations multiply by, shape (frame, looking, 4, 4)."""

    def applied(self, turned: Array, back: bool = False) -> Array:
        """Return orientations turned toward the targets, or turned back, shape (frame, body, 4)."""
        turns = rotation.transposed(self.turns) if back else self.turns
        count = max(len(turns), len(turned))
        out = np.broadcast_to(turned, (count, *turned.shape[1:])).copy()
        out[:, self.rows] = rotation.apply(turns, out[:, self.rows])
        return out


def toward(forward: Array, away: Array, tiny: float) -> Array:
    """Return the rotation vectors [rad] by which bodies turn to look along ``away``, limited softly.

    Up to `FREE` the gaze is on the target; beyond, it lags more and more, never more than `MOST` off the body's
    forward; and in the half space behind, it comes back to straight ahead.

    Args:
        forward: Unit vectors, shape (..., 3).
        away: To the targets [m], shape (..., 3).
        tiny: Distance below which a target is gradually ignored [m].
    """
    distance = quat.length(away)
    direction = away / np.maximum(distance, 1e-12)[..., None]
    axis = rotation.cross(forward, direction)
    sine = quat.length(axis)
    angle = np.arctan2(sine, quat.dot(forward, direction))
    soft = FREE + (MOST - FREE) * np.tanh((angle - FREE) / (MOST - FREE))
    limited = np.where(angle > FREE, soft, angle)
    behind = np.clip((angle - 0.5 * np.pi) / (0.5 * np.pi), 0.0, 1.0)
    fade = 0.5 * (1.0 + np.cos(np.pi * behind))
    near = np.clip(distance / tiny, 0.0, 1.0)
    # Small angles turn about a vector that vanishes with them; straight behind, nothing is left to turn by.
    unit = axis / np.maximum(sine, 1e-12)[..., None]
    return (limited * fade * near)[..., None] * unit
