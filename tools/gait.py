"""A walk made of formulas, for figures of `figure.humanoid` with VRM names: the sample clip and the tests play it.

Feet strike with the heel, lie flat, roll over the ball and swing; the pelvis bobs, sways and turns; the spine and the
arms swing against it. All is a function of time, so a cycle's end is its beginning moved on.
"""

from dataclasses import dataclass

import numpy as np

from morph_retarget.core import quat
from morph_retarget.core.arrays import Array, Flags
from morph_retarget.core.skeleton import Pose, Skeleton

X, Y, Z = np.eye(3)
FORWARD, UP = -Y, Z

CYCLE = 1.1
"""Time of two steps [s]."""
SPEED = 1.05
"""For a figure of 1.75 m [m/s]."""
FLAT, HEEL_OFF, TOE_OFF = 0.08, 0.38, 0.6
"""Parts of the cycle at which the foot lies flat, its heel leaves and its toes leave."""
STRIKE_PITCH, LIFT_PITCH = np.radians(-18.0), np.radians(42.0)
"""Toes up when the heel strikes; heel up when the toes leave."""


@dataclass(frozen=True, eq=False)
class Walk:
    """Times and phases of a walk."""

    time: Array
    """[s], shape (frame,)."""
    phase: Array
    """Cycles of the left and the right foot since each struck first, shape (frame, 2)."""
    waves: Array
    """How much the right arm waves, 0 … 1, shape (frame,)."""
    speed: float
    """[m/s]."""

    @property
    def cycle_seconds(self) -> float:
        """Time of two steps [s]."""
        return CYCLE

    @property
    def distance(self) -> float:
        """Way that the body goes [m]."""
        return self.speed * float(self.time[-1])

    @property
    def flat(self) -> Flags:
        """When each foot lies flat, left and right, shape (frame, 2)."""
        part = self.phase % 1.0
        return (part >= FLAT) & (part <= HEEL_OFF)


def walk(seconds: float, fps: float, height: float = 1.75, wave: tuple[float, float] | None = None) -> Walk:
    """Return a walk along the figure's own front.

    Args:
        seconds: Duration.
        fps: Frames a second.
        height: Of the figure [m].
        wave: Time at which the right arm goes up and at which it comes down [s].
    """
    time = np.arange(round(seconds * fps) + 1) / fps
    phase = np.stack([time / CYCLE, time / CYCLE + 0.5], axis=-1)
    waves = np.zeros(len(time))
    if wave is not None:
        waves = _ease((time - wave[0]) / 0.5) * (1.0 - _ease((time - wave[1]) / 0.5))
    return Walk(time, phase, waves, SPEED * height / 1.75)


def pose(skeleton: Skeleton, made: Walk) -> Pose:
    """Return the walk as a pose of a figure, whatever the axes of its bones."""
    body = _Body(skeleton, len(made.time))
    angle = 2.0 * np.pi * made.phase[:, 0]
    rest = skeleton.rest_positions
    height = rest[skeleton.index["hips"], 2]
    yaw = _turn(UP, np.radians(5.0) * np.cos(angle - 0.3))
    lean = quat.multiply(_turn(Y, np.radians(2.5) * np.sin(angle)), _turn(X, np.full(len(angle), np.radians(3.0))))
    body.turn("hips", quat.multiply(yaw, lean))
    bob = -0.045 - 0.012 * np.cos(2.0 * angle - 0.5)
    sway = 0.018 * np.sin(angle - 0.4)
    body.hips = np.stack([sway, -made.speed * made.time, 1.0 + bob], axis=-1) * [height, 1.0, height]
    twist = _turn(UP, -np.radians(4.0) * np.cos(angle - 0.3))
    for bone in ("spine", "chest", "upperChest"):
        body.add(bone, twist)
    for bone in ("neck", "head"):
        body.add(bone, _turn(UP, np.radians(2.0) * np.cos(angle - 0.3)))
    for i, (side, sign) in enumerate((("left", 1.0), ("right", -1.0))):
        _leg(body, made, side, i)
        _arm(body, made, side, sign, angle)
    return body.pose()


class _Body:
    """Turns of a figure's bones from rest, in the world."""

    def __init__(self, skeleton: Skeleton, frames: int) -> None:
        self.skeleton = skeleton
        self.frames = frames
        self.turns: dict[str, Array] = {}
        self.hips = np.zeros((frames, 3))

    def rest(self, bone: str) -> Array:
        return self.skeleton.rest_positions[self.skeleton.index[bone]]

    def turn(self, bone: str, turn: Array) -> None:
        self.turns[bone] = turn

    def parent(self, bone: str) -> str:
        return self.skeleton.names[self.skeleton.parents[self.skeleton.index[bone]]]

    def of(self, bone: str) -> Array:
        """Return the turn of a bone, that of the bone it hangs on when it has none of its own."""
        if bone in self.turns:
            return self.turns[bone]
        index = self.skeleton.index[bone]
        if self.skeleton.parents[index] < 0:
            return quat.identity(self.frames)
        return self.of(self.parent(bone))

    def add(self, bone: str, turn: Array) -> None:
        """Turn a bone on top of the one that it hangs on."""
        if bone in self.skeleton.index:
            self.turns[bone] = quat.multiply(turn, self.of(self.parent(bone)))

    def place(self, bone: str) -> Array:
        """Return the head of a bone, shape (frame, 3)."""
        if bone == "hips":
            return self.hips
        above = self.parent(bone)
        if above not in self.skeleton.tree_names_below_hips:
            return self.hips + self.rest(bone) - self.rest("hips")
        return self.place(above) + quat.rotate(self.of(above), self.rest(bone) - self.rest(above))

    def pose(self) -> Pose:
        skeleton = self.skeleton
        rotations = np.empty((self.frames, len(skeleton), 4))
        positions = np.empty((self.frames, len(skeleton), 3))
        for i, name in enumerate(skeleton.names):
            rotations[:, i] = quat.multiply(self.of(name), skeleton.rest_rotations[i])
            positions[:, i] = self.place(name)
        return Pose(rotations, positions)
