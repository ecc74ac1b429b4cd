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

    def ahead(self) -> "Lead | None":
        """Return what leads straight ahead, one metre, None when nothing leads anywhere."""
        if not len(self.aimed):
            return None
        count = len(self.aimed)
        return Lead(self.aimed, AHEAD * self.flip[None, ..., None], np.ones((1, count)))

    def lead(self, targets: Array) -> "Lead | None":
        """Return what leads to the targets, None when nothing does.

        The axes are turned from straight ahead to the target by the smallest rotation, which is singular for targets
        straight behind alone.

        Args:
            targets: [m], shape (frame, body, 3).
        """
        if not len(self.aimed):
            return None
        away = (targets.take(self.aimed, axis=1) * self.flip - self.rest) * self.flat
        distance = quat.length(away)
        direction = away / np.maximum(distance, 1e-12)[..., None]
        if (distance < self.tiny).any():
            direction = quat.unit(FORWARD + _smooth(distance / self.tiny)[..., None] * (direction - FORWARD))
            direction[~direction.any(axis=-1)] = FORWARD
        lengths = np.where(self.only_turned, 1.0, np.maximum(distance, 0.1 * self.tiny))
        return Lead(self.aimed, _ahead(direction) * self.flip[..., None], lengths)

    def gaze(self, targets: Array) -> "Gaze | None":
        """Return what looks at the targets, None when nothing does.

        The direction is taken from where a body rests in its character, as the axes are: what a channel keys does not
        change its own frame, so that keys can be moved to other frames exactly.
        """
        if not len(self.looking):
            return None
        away = targets.take(self.looking, axis=1) - self.eyes
        turns = toward(self.forwards, away, self.tiny)
        return Gaze(self.looking, quat.before_matrix(turns))


_HALF_TURNED = AHEAD * np.array([1.0, -1.0, -1.0])
"""`AHEAD` after half a turn about straight ahead."""


def _ahead(direction: Array) -> Array:
    """Return `AHEAD` turned from straight ahead to a direction by the smallest rotation, shape (..., 3, 3)."""
    between = direction + FORWARD
    behind = direction @ FORWARD < -1.0 + 1e-9
    if behind.any():
        between[behind] = LEFT  # about the vertical
    return np.matmul(rotation.half_turn(between), _HALF_TURNED)


def _smooth(t: Array) -> Array:
    """Return 0 … 1 for 0 … 1, starting and ending gently."""
    t = np.clip(t, 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


@dataclass(frozen=True, eq=False)
class Lead:
    """Bodies whose frames lead to targets: their x axes end there."""

    rows: Indices
    """The bodies, shape (aimed,)."""
    axes: Array
    """Columns are the generalized axes in the character frame, shape (frame or 1, aimed, 3, 3); left-handed where
    mirrored."""
    lengths: Array
    """What the x axes are stretched by, shape (frame or 1, aimed)."""

    def applied(self, away: Array) -> Array:
        """Return vectors turned and stretched toward the targets, shape (frame, body, 3)."""
        out = _over(away, len(self.axes))
        own = out.take(self.rows, axis=1)
        own[..., 0] *= self.lengths
        out[:, self.rows] = rotation.apply(self.axes, own)
        return out

    def undone(self, away: Array) -> Array:
        """Return vectors from which `applied` makes these."""
        out = _over(away, len(self.axes))
        own = rotation.apply(rotation.transposed(self.axes), out.take(self.rows, axis=1))
        own[..., 0] /= self.lengths
        out[:, self.rows] = own
        return out


@dataclass(frozen=True, eq=False)
class Gaze:
    """Bodies that look at targets. A gaze turns a body's frame, so that a head can nod while it looks."""

    rows: Indices
    """The bodies that look, shape (looking,)."""
    turns: Array
    """What their rotations multiply by, shape (frame or 1, looking, 4, 4)."""

    def applied(self, turned: Array) -> Array:
        """Return orientations turned toward the targets, shape (frame, body, 4)."""
        return self._by(self.turns, turned)

    def undone(self, turned: Array) -> Array:
        """Return orientations turned back."""
        return self._by(rotation.transposed(self.turns), turned)

    def _by(self, turns: Array, turned: Array) -> Array:
        out = _over(turned, len(turns))
        out[:, self.rows] = rotation.apply(turns, out.take(self.rows, axis=1))
        return out


def _over(values: Array, frames: int) -> Array:
    """Return a copy of values, for as many frames as there are when they hold for all of them."""
    if len(values) >= frames:
        return values.copy()
    return np.repeat(values, frames, axis=0)


def toward(forward: Array, away: Array, tiny: float) -> Array:
    """Return the turns by which bodies look along ``away``, limited softly, shape (..., 4).

    Up to `FREE` the gaze is on the target; beyond, it lags more and more, never more than `MOST` off the body's
    forward; and in the half space behind, it comes back to straight ahead.

    Args:
        forward: Unit vectors, shape (..., 3).
        away: To the targets [m], shape (..., 3).
        tiny: Distance below which a target is gradually ignored [m].
    """
    axis = rotation.cross(forward, away)
    sine = quat.length(axis)
    angle = np.arctan2(sine, quat.dot(forward, away))
    if (angle > FREE).any():
        angle = _limited(angle)
    near = np.minimum(quat.length(away) / tiny, 1.0)
    # Small angles turn about a vector that vanishes with them; straight behind, nothing is left to turn by.
    unit = axis / np.maximum(sine, 1e-12 * tiny)[..., None]
    return quat.from_axis_angle(unit, angle * near)


def _limited(angle: Array) -> Array:
    """Return how far bodies turn for how far from ahead their targets are [rad]."""
    soft = FREE + (MOST - FREE) * np.tanh((angle - FREE) / (MOST - FREE))
    behind = np.maximum(angle / (0.5 * np.pi) - 1.0, 0.0)
    return np.where(angle > FREE, soft, angle) * (0.5 + 0.5 * np.cos(np.pi * behind))
