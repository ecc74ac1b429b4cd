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
SPEED = 0.95
"""For a figure of 1.75 m [m/s]."""
FLAT, HEEL_OFF, TOE_OFF = 0.12, 0.38, 0.6
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

    @property
    def on_ground(self) -> Flags:
        """When some part of each foot touches the ground, left and right, shape (frame, 2)."""
        return self.phase % 1.0 <= TOE_OFF


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
    bob = -0.044 - 0.018 * np.cos(2.0 * angle)
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
    """Turns of a figure's bones from rest, in the world; a bone without one follows the bone it hangs on."""

    def __init__(self, skeleton: Skeleton, frames: int) -> None:
        self.skeleton = skeleton
        self.frames = frames
        self.turns: dict[str, Array] = {}
        self.hips = np.zeros((frames, 3))

    def rest(self, bone: str) -> Array:
        return self.skeleton.rest_positions[self.skeleton.index[bone]]

    def turn(self, bone: str, turn: Array) -> None:
        """Turn a bone, whatever it hangs on does."""
        if bone in self.skeleton.index:
            self.turns[bone] = turn

    def add(self, bone: str, turn: Array) -> None:
        """Turn a bone on top of the one that it hangs on."""
        above = self._above(bone) if bone in self.skeleton.index else None
        if above is not None:
            self.turns[bone] = quat.multiply(self.of(above), turn)

    def of(self, bone: str) -> Array:
        """Return the turn of a bone, shape (frame, 4)."""
        if bone in self.turns:
            return self.turns[bone]
        above = self._above(bone)
        return quat.identity(self.frames) if above is None else self.of(above)

    def place(self, bone: str) -> Array:
        """Return the head of a bone, shape (frame, 3)."""
        above = self._above(bone)
        if bone == "hips":
            return self.hips
        if above is None:
            return np.broadcast_to(self.rest(bone), (self.frames, 3))
        return self.place(above) + quat.rotate(self.of(above), self.rest(bone) - self.rest(above))

    def pose(self) -> Pose:
        names = self.skeleton.names
        turns = np.stack([self.of(name) for name in names], axis=1)
        places = np.stack([self.place(name) for name in names], axis=1)
        return Pose(quat.multiply(turns, self.skeleton.rest_rotations), places)

    def _above(self, bone: str) -> str | None:
        parent = int(self.skeleton.parents[self.skeleton.index[bone]])
        return None if parent < 0 else self.skeleton.names[parent]


def _turn(axis: Array, angles: Array | float) -> Array:
    return quat.from_rotation_vector(np.asarray(angles)[..., None] * axis)


def _ease(x: Array) -> Array:
    x = np.clip(x, 0.0, 1.0)
    return x * x * (3.0 - 2.0 * x)


# --- legs ---


def _leg(body: _Body, made: Walk, side: str, i: int) -> None:
    upper, lower, foot, toes = (side + part for part in ("UpperLeg", "LowerLeg", "Foot", "Toes"))
    rest = _Foot(body.rest(foot), body.rest(toes) if toes in body.skeleton.index else None)
    cycle, part = np.floor(made.phase[:, i]), made.phase[:, i] % 1.0
    # The body is over the foot in the middle of its stance.
    middle = cycle + 0.5 * TOE_OFF - 0.5 * i
    ankle = rest.ankle + rest.path(part, made.speed * CYCLE)
    ankle[:, 1] -= made.speed * CYCLE * middle
    hip = body.place(upper)
    thigh, shin = body.rest(lower) - body.rest(upper), body.rest(foot) - body.rest(lower)
    knee = _knee(hip, ankle, float(np.linalg.norm(thigh)), float(np.linalg.norm(shin)))
    body.turn(upper, _swing(thigh, knee - hip))
    body.turn(lower, _swing(shin, ankle - knee))
    pitch = _pitch(part)
    body.turn(foot, _turn(X, pitch))
    rolling = (part > HEEL_OFF) & (part < TOE_OFF)
    follows = np.where(part < TOE_OFF, 0.0, _ease((part - TOE_OFF) / 0.1))
    body.turn(toes, _turn(X, np.where(rolling, 0.0, np.where(part < HEEL_OFF, pitch, follows * pitch))))


def _pitch(part: Array) -> Array:
    """Return how far the heel is up, by the part of the cycle [rad]."""
    strike = STRIKE_PITCH * (1.0 - _ease(part / FLAT))
    lift = LIFT_PITCH * ((np.clip(part, HEEL_OFF, TOE_OFF) - HEEL_OFF) / (TOE_OFF - HEEL_OFF)) ** 2
    swing = _ease((part - TOE_OFF) / (1.0 - TOE_OFF))
    return np.where(part < TOE_OFF, strike + lift, LIFT_PITCH + swing * (STRIKE_PITCH - LIFT_PITCH))


@dataclass(frozen=True, eq=False)
class _Foot:
    """A foot at rest, on the ground."""

    ankle: Array
    ball: Array | None

    def path(self, part: Array, stride: float) -> Array:
        """Return where the ankle is from its place while the foot is flat, shape (frame, 3)."""
        before, after = self._stance(np.array([TOE_OFF - 1e-4, TOE_OFF])), self._stance(np.array([0.0, 1e-4]))
        start, end = before[1], after[0] + stride * FORWARD
        share = 1.0 - TOE_OFF
        leave, arrive = share * (before[1] - before[0]) / 1e-4, share * (after[1] - after[0]) / 1e-4
        u = ((part - TOE_OFF) / share)[:, None]
        swing = (
            (2 * u**3 - 3 * u**2 + 1) * start
            + (u**3 - 2 * u**2 + u) * leave
            + (3 * u**2 - 2 * u**3) * end
            + (u**3 - u**2) * arrive
        )
        swing += 0.3 * self.ankle[2] * np.sin(np.pi * np.clip(u, 0.0, 1.0)) ** 2 * UP
        return np.where((part < TOE_OFF)[:, None], self._stance(part), swing)

    def _stance(self, part: Array) -> Array:
        """Return the same while the heel, the sole or the ball is on the ground."""
        heel = self.ankle * [1, 1, 0] - 0.5 * self.ankle[2] * FORWARD
        ball = self.ankle * [1, 1, 0] + 1.5 * self.ankle[2] * FORWARD if self.ball is None else self.ball
        pivot = np.where((part < FLAT)[:, None], heel, ball)
        return pivot + quat.rotate(_turn(X, _pitch(part)), self.ankle - pivot) - self.ankle


def _knee(hip: Array, ankle: Array, thigh: float, shin: float) -> Array:
    """Return the place of the knee, in front of the line from hip to ankle."""
    way = ankle - hip
    length = np.linalg.norm(way, axis=-1, keepdims=True)
    way, length = way / length, np.minimum(length, 0.9999 * (thigh + shin))
    ahead = quat.unit(FORWARD - (way @ FORWARD)[:, None] * way)
    along = (thigh**2 + length**2 - shin**2) / (2.0 * length)
    return hip + along * way + np.sqrt(np.maximum(thigh**2 - along**2, 0.0)) * ahead


def _swing(rest: Array, directions: Array) -> Array:
    """Return the turn that takes ``rest`` to each direction while what is at the side stays at the side."""

    def axes(along: Array) -> Array:
        along = quat.unit(along)
        ahead = quat.unit(FORWARD - (along @ FORWARD)[..., None] * along)
        return np.stack([np.cross(along, ahead), ahead, along], axis=-1)

    return quat.from_matrix(axes(directions) @ axes(rest).T)


# --- arms ---


def _arm(body: _Body, made: Walk, side: str, sign: float, angle: Array) -> None:
    upper, lower = f"{side}UpperArm", f"{side}LowerArm"
    along = quat.unit(body.rest(lower) - body.rest(upper))
    hangs = float(np.arctan2(-along[2], abs(along[0])))
    down = _turn(Y, np.full(body.frames, sign * (np.radians(76.0) - hangs)))
    swing = sign * np.radians(22.0) * np.cos(angle) - np.radians(2.0)
    bend = np.radians(16.0) - 0.35 * np.minimum(swing, 0.0)
    arm, forearm = quat.multiply(_turn(X, swing), down), quat.multiply(_turn(X, swing - bend), down)
    if side == "right" and made.waves.any():
        raised = _turn(Y, np.full(body.frames, np.radians(8.0) + hangs))
        beat = np.radians(95.0) + np.radians(24.0) * np.sin(4.0 * np.pi * made.time)
        to_front = _turn(UP, np.full(body.frames, np.radians(80.0)))
        upright = _turn(Y, np.full(body.frames, np.radians(90.0) + hangs))
        arm = quat.slerp(arm, raised, made.waves)
        waving = quat.multiply(_turn(Y, beat - np.radians(90.0)), quat.multiply(to_front, upright))
        forearm = quat.slerp(forearm, waving, made.waves)
    chest = body.of(upper)
    body.turn(upper, quat.multiply(chest, arm))
    body.turn(lower, quat.multiply(chest, forearm))
