"""Gaze: eyes, head, neck and spine turn together toward a target (Feng 2013 §6.2).

The way to look is two angles, to the side and up, in the frame of what carries the joints that turn; so a head that is
turned stays as upright as the motion has it. The joints share them by their weights up to their limits. Where the
target is farther round than all of them reach, as behind, the character looks as far to that side as it can.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ... import quat
from ...arrays import Array
from ...locomotion.moving import heading_of, pointed, rise_of
from ..commands.parameters import Parameter
from . import sharing, timing
from .actor import Actor
from .behaviour import AIMED, Behaviour, Cue, Scene
from .posture import Posture

SPEED, EYES_SPEED = 180.0, 450.0
"""Peak speeds of heads and eyes [deg/s]."""
LEVELS = ("eyes", "head", "chest", "waist")
"""How far down joints take part."""
GAZE = Behaviour(
    "gaze",
    "Look at something, and follow it where it moves",
    {
        **AIMED,
        "level": Parameter("chest", "What takes part beside all above it", choices=LEVELS),
        "speed": Parameter(SPEED, "How fast the head turns at most", "deg/s", 5.0, 720.0),
        "amount": Parameter(1.0, "Share of the way that it turns", "", 0.0, 1.0),
    },
)
ROUNDS = 4
"""How often the way to look is found anew from where turning has brought the eyes."""
NEAR = 0.03
"""A target nearer to the eyes than this share of the character's height is gradually ignored."""
QUICK = 0.12
"""No head turns in less [s]."""
EYE = np.radians([28.0, 22.0])
"""How far eyes turn against the head, to the side and up [rad] …"""
EYE_SHARE = np.array([0.3, 0.35])
"""… and their share while they are not at that limit."""
CROSSING = np.radians(12.0)
"""How far each eye turns from there toward what is near [rad]."""
EYES_QUICK = 0.04
"""No eye moves in less [s]."""
FORWARD = np.array([0.0, -1.0, 0.0])


@dataclass(frozen=True, eq=False)
class _Lookers:
    """The joints that may look, and how far they turn."""

    actor: Actor
    joints: tuple[int, ...]
    """From below, the head last."""
    weights: Mapping[str, Array]
    """For each level, shape (joint,)."""
    limits: Array
    """To the side and up [rad], shape (2, joint)."""

    @classmethod
    def of(cls, actor: Actor) -> "_Lookers":
        """Return those of a character."""
        assert actor.head is not None, "only what has a head looks"
        back, neck = actor.back, actor.neck
        half = len(back) // 2
        head = (45.0, 35.0) if neck else (65.0, 50.0)
        groups: list[tuple[str, Sequence[int], float, tuple[float, float]]] = [
            ("waist", back[:half], 0.1, (25.0, 20.0)),
            ("chest", back[half:], 0.2, (30.0, 15.0)),
            ("head", neck, 0.3, (35.0, 30.0)),
            ("head", (actor.head,), 0.4, head),
        ]
        rows = [
            (joint, level, weight / len(joints), np.radians(most) / len(joints))
            for level, joints, weight, most in groups
            for joint in joints
        ]
        weights = {
            level: np.array([weight * (LEVELS.index(own) <= LEVELS.index(level)) for _, own, weight, _ in rows])
            for level in LEVELS
        }
        if not actor.eyes:
            weights["eyes"] = weights["head"]
        return cls(actor, tuple(row[0] for row in rows), weights, np.array([row[3] for row in rows]).T)

    @cached_property
    def eye(self) -> Array:
        """How far the eyes turn besides [rad], shape (2,)."""
        return EYE if self.actor.eyes else np.zeros(2)

    def shared(self, level: str, start: Array, wanted: Array, amount: float) -> Array:
        """Return how far joints and eyes turn, shape (n, 2 joint + 2): see `_Ways`.

        Args:
            level: Which joints take part.
            start: Where the head looks by itself, to the side and up [rad], shape (n, 2).
            wanted: Where it shall look [rad], shape (n, 2).
            amount: Share of the way.
        """
        weights = self.weights[level]
        most = np.where(weights > 0.0, self.limits, 0.0).sum(axis=1)
        away = amount * (np.clip(wanted, -most - self.eye, most + self.eye) - start)
        share = EYE_SHARE if self.actor.eyes else np.zeros(2)
        body = np.sign(away) * np.maximum((1.0 - share) * np.abs(away), np.abs(away) - self.eye)
        body = np.clip(body, -most, most)
        columns = [sharing.cumulated(body[:, i], weights, self.limits[i]) for i in range(2)]
        return np.column_stack([*columns, np.clip(away, body - self.eye, body + self.eye)])

    def turned(self, posture: Posture, frame: Array, start: Array, turns: Array) -> Posture:
        """Return a posture whose head has turned.

        Args:
            posture: As the motion has it.
            frame: How what carries the joints is turned, shape (n, 4).
            start: Where the head looks then, in that frame [rad], shape (n, 2).
            turns: How far joints turn, to the side and then up [rad], shape (n, 2 joint).
        """
        back = quat.multiply(quat.conjugate(pointed(start[:, 0], start[:, 1])), quat.conjugate(frame))
        changes: dict[int, Array] = {}
        for k, joint in enumerate(self.joints):
            side, up = turns[:, k], turns[:, len(self.joints) + k]
            now = quat.multiply(frame, pointed(start[:, 0] + side, start[:, 1] + up))
            changes[joint] = quat.multiply(now, back)
        return posture.turned(self.actor.tree, changes)


def perform(actor: Actor, scene: Scene, posture: Posture, cues: Sequence[Cue]) -> Posture:
    """Return a posture that looks at what commands say; the cues have targets that exist."""
    if not cues or actor.head is None:
        return posture
    lookers = _Lookers.of(actor)
    carrier = int(actor.tree.parents[lookers.joints[0]])
    frame = posture.turns[:, carrier] if carrier >= 0 else quat.identity(len(posture))
    start = _angles(frame, posture.seen(actor.head, actor.forward))
    out = posture
    for _ in range(ROUNDS):
        body, _, _ = _followed(lookers, scene, cues, frame, start, out)
        out = lookers.turned(posture, frame, start, _slow(scene, cues, lookers, body))
    if not actor.eyes:
        return out
    _, eyes, counts = _followed(lookers, scene, cues, frame, start, out)
    eyes = timing.limited(eyes, range(eyes.shape[1]), np.radians(EYES_SPEED), timing.step_of(scene.times))
    return _with_eyes(actor, out, frame, start, eyes, counts)


def _angles(frame: Array, directions: Array) -> Array:
    """Return where directions lead in a frame, to the left and up [rad], shapes (n, 4) and (n, 3) to (n, 2)."""
    own = quat.rotate(quat.conjugate(frame), directions)
    return np.column_stack([heading_of(own), rise_of(own)])


def _followed(
    lookers: _Lookers, scene: Scene, cues: Sequence[Cue], frame: Array, start: Array, posture: Posture
) -> tuple[Array, Array, Array]:
    """Return how far the body turns and how far the eyes look beside it over time, and how far that counts.

    Args:
        lookers: The joints.
        scene: What is looked at.
        cues: When.
        frame: How what carries the joints is turned, shape (n, 4).
        start: Where the head looks by itself in that frame [rad], shape (n, 2).
        posture: Where the eyes are.

    Returns:
        Turns of the joints [rad], shape (n, 2 joint); where each eye looks against `start` [rad], shape (n, 2 eye) or
        (n, 2) without eyes; shape (n,).
    """
    actor, times = lookers.actor, scene.times
    assert actor.head is not None, "only what has a head looks"
    sight, count = posture.point(actor.head, actor.sight), 2 * len(lookers.joints)
    tip, speed = (len(lookers.joints) - 1, count - 1), SPEED
    body, eyes = np.zeros((len(times), count)), np.zeros((len(times), 2 * max(len(actor.eyes), 1)))
    counts = np.zeros(len(times))
    for cue in cues:
        body_way, eyes_way, on = np.zeros_like(body), np.zeros_like(eyes), 0.0
        if cue.values is not None:
            speed, on = cue.number("speed", GAZE.parameters), cue.number("amount", GAZE.parameters)
            level = cue.text("level", GAZE.parameters)
            target = scene.track(cue.values).at(times)
            away = target - sight
            near = np.minimum(quat.length(away) / (NEAR * actor.height), 1.0)[:, None]
            looks = _angles(frame, away)
            whole = lookers.shared(level, start, start + near * (looks - start), on)
            body_way = whole[:, :count]
            own = [_angles(frame, target - posture.positions[:, eye]) - looks for eye in actor.eyes] or [
                np.zeros((1, 2))
            ]
            eyes_way = np.column_stack([whole[:, count:] + near * np.clip(o, -CROSSING, CROSSING) for o in own])
        far = timing.at(times, body_way - body, cue.at)[list(tip)]
        lasts = 0.0 if cue.sudden else max(timing.BELL * float(np.linalg.norm(far)) / np.radians(speed), QUICK)
        rise = timing.risen(times, cue.at, lasts)[:, None]
        body = body + rise * (body_way - body)
        counts = counts + rise[:, 0] * (on - counts)
        far = np.abs(timing.at(times, eyes_way - eyes, cue.at)).max() * np.sqrt(2.0)
        lasts = 0.0 if cue.sudden else max(timing.BELL * far / np.radians(EYES_SPEED), EYES_QUICK)
        eyes = eyes + timing.risen(times, cue.at, lasts)[:, None] * (eyes_way - eyes)
    return body, eyes, counts


def _slow(scene: Scene, cues: Sequence[Cue], lookers: _Lookers, body: Array) -> Array:
    """Return turns of joints [rad], shape (n, 2 joint), as fast as the head may turn at most."""
    fastest = max((cue.number("speed", GAZE.parameters) for cue in cues if cue.values is not None), default=SPEED)
    head = (len(lookers.joints) - 1, 2 * len(lookers.joints) - 1)
    return timing.limited(body, head, np.radians(fastest), timing.step_of(scene.times))


def _with_eyes(actor: Actor, posture: Posture, frame: Array, start: Array, looks: Array, counts: Array) -> Posture:
    """Return a posture whose eyes look some way, as far as they turn in their head."""
    assert actor.head is not None, "only what has a head looks"
    ahead = _angles(frame, posture.seen(actor.head, actor.forward))
    changes: dict[int, Array] = {}
    for i, eye in enumerate(actor.eyes):
        wanted = start + looks[:, 2 * i : 2 * i + 2]
        wanted = ahead + np.clip(wanted - ahead, -EYE - CROSSING, EYE + CROSSING)
        way = quat.rotate(quat.multiply(frame, pointed(wanted[:, 0], wanted[:, 1])), FORWARD)
        turn = quat.between(posture.seen(eye, actor.bodies.forwards[eye]), way)
        changes[eye] = quat.slerp(quat.identity(len(turn)), turn, counts)
    return posture.turned(actor.tree, changes)
