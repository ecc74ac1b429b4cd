"""Leaning: a trunk that bends to bring a shoulder, or a mouth, to where it is wanted.

The joints of the trunk turn one after the other toward that, each as much as it helps and as its limit allows, several
times over (cyclic coordinate descent). All frames are one batch, and each starts from its own posture.
"""

from collections.abc import Sequence

import numpy as np

from ... import quat
from ...arrays import Array
from ...locomotion.moving import eased
from . import timing
from .actor import Actor
from .arms import Arm
from .behaviour import Scene
from .handling import POINT, QUICK, Step
from .posture import Posture

ROUNDS = 24
"""How often all joints turn."""
EAGER = 0.6
"""Share of the way that a joint turns each time."""
BACK_LEAST, BACK_MOST = np.radians([-15.0, -35.0, -45.0]), np.radians([75.0, 35.0, 45.0])
"""How far all joints of a back bend together: forward, to the side and round [rad] …"""
NECK_LEAST, NECK_MOST = np.radians([-45.0, -35.0, -35.0]), np.radians([45.0, 35.0, 35.0])
"""… and one of a neck, or a head."""
STRETCHED = 0.95
"""Share of its length up to which an arm reaches without leaning."""
LEVELLED = 0.7
"""How far the head and the other arm do not go along with a trunk that leans."""
LEANS = np.radians(150.0)
"""Peak speed of a joint of the trunk that leans by itself [rad/s]."""
SNOUT = 0.06
"""How far in front of its joint a head takes things that has no mouth, in heights of the body."""


def leaned(
    actor: Actor,
    scene: Scene,
    posture: Posture,
    arm: Arm | None,
    mouth: int | None,
    steps: Sequence[Step],
    hanging: Sequence[int] = (),
) -> tuple[Posture, tuple[float, ...]]:
    """Return a posture that leans to bring a shoulder near enough, or a mouth to what it reaches for.

    Args:
        actor: The character.
        scene: When, and where the targets are.
        posture: What the motion does.
        arm: That reaches; None for the mouth.
        mouth: The mouth.
        steps: What the hand or the mouth does.
        hanging: First joints of other arms: these go on hanging as they did.

    Returns:
        Also when it is there in each step [s].
    """
    end = arm.joints[0] if arm is not None else mouth
    joints = [] if end is None else [j for j in actor.line if j == end or actor.tree.is_below(j, end)]
    if arm is not None:
        joints = [joint for joint in joints if joint in actor.back]
    if end is None or not joints:
        return posture, tuple(step.at for step in steps)
    # A head that is its own mouth has that in front of it.
    point = posture.point(end, SNOUT * actor.height * actor.forward) if end == joints[-1] else posture.positions[:, end]
    times, values, arrives = scene.times, np.zeros((len(scene.times), 3 * len(joints))), list[float]()
    for step in steps:
        way = np.zeros_like(values)
        if step.behaviour is not None:
            target = scene.track(step.values).at(times)
            if arm is None:
                way = told(toward(actor, posture, joints, point, target, np.zeros(len(times))))
            elif step.behaviour is not POINT and step.values.get("lean", True):
                way = _leaning(arm, posture, joints, point, target)
        far = float(np.abs(timing.at(times, way - values, step.at)).max())
        lasts = 0.0 if step.cue.sudden else step.stroke or max(QUICK, timing.BELL * far / LEANS)
        values = values + timing.risen(times, step.at, lasts)[:, None] * (way - values)
        arrives.append(step.at + lasts)
    turns = turned(values)
    changes = {joint: turns[:, k] for k, joint in enumerate(joints)}
    if arm is not None:
        # What hangs goes on hanging, and the head comes up again.
        level = quat.slerp(turns[:, -1], quat.identity(len(posture)), LEVELLED)
        free = [joint for joint in hanging if actor.tree.is_below(joints[-1], joint)]
        changes |= dict.fromkeys([*free, *([] if actor.head is None else [actor.head])], level)
    return posture.turned(actor.tree, changes), tuple(arrives)


def _leaning(arm: Arm, posture: Posture, joints: Sequence[int], shoulder: Array, target: Array) -> Array:
    """Return how a trunk leans to bring a target within reach of an arm, as `told` tells it.

    It does so less for what is out of reach all the same.
    """
    actor, far = arm.actor, quat.length(target - shoulder)
    enough = STRETCHED * arm.length + 0.5 * float(quat.length(arm.hand.middle))
    trunk = float(quat.length(actor.rest[arm.joints[0]] - actor.rest[joints[0]]))
    share = 1.0 - eased((far - enough - trunk) / actor.height)
    out, rows = np.zeros((len(far), 3 * len(joints))), np.flatnonzero((far > enough) & (share > 0.0))
    spare = np.full(len(rows), enough)
    turns = toward(actor, posture[rows], joints, shoulder[rows], target[rows], spare)
    out[rows] = share[rows, None] * told(turns)
    return out


def toward(actor: Actor, posture: Posture, joints: Sequence[int], point: Array, goal: Array, spare: Array) -> Array:
    """Return how joints turn to bring a point near to a goal, shape (n, joint, 4): each with all that it carries.

    Args:
        actor: The character.
        posture: How it stands.
        joints: Of its trunk, from below.
        point: That shall come near, carried by the last of them [m], shape (n, 3).
        goal: Where to [m], shape (n, 3).
        spare: How near is enough [m], shape (n,).
    """
    count, rows = len(joints), len(posture)
    places = np.concatenate([posture.positions[:, list(joints)], point[:, None]], axis=1)
    turns = quat.identity(rows, count)
    back = max(sum(joint in actor.back for joint in joints), 1)
    least = [BACK_LEAST / back if joint in actor.back else NECK_LEAST for joint in joints]
    most = [BACK_MOST / back if joint in actor.back else NECK_MOST for joint in joints]
    frame = posture.turns[:, actor.root]
    for _ in range(ROUNDS):
        for k in range(count):
            away = goal - places[:, -1]
            distance = quat.length(away)
            # It need not come nearer than is enough, so it is not brought there.
            aim = goal - (np.minimum(spare, distance) / np.maximum(distance, 1e-12))[:, None] * away
            step = quat.between(places[:, -1] - places[:, k], aim - places[:, k])
            step = quat.from_rotation_vector(EAGER * quat.to_rotation_vector(step))
            before = turns[:, k - 1] if k else quat.identity(rows)
            own = quat.multiply(quat.conjugate(before), quat.multiply(step, turns[:, k]))
            vector = quat.rotate(quat.conjugate(frame), quat.to_rotation_vector(own))
            own = quat.from_rotation_vector(quat.rotate(frame, np.clip(vector, least[k], most[k])))
            step = quat.multiply(quat.multiply(before, own), quat.conjugate(turns[:, k]))
            turns[:, k:] = quat.multiply(step[:, None], turns[:, k:])
            start = places[:, k : k + 1]
            places[:, k + 1 :] = start + quat.rotate(step[:, None], places[:, k + 1 :] - start)
    return turns


def told(turns: Array) -> Array:
    """Return how joints turn against those below them, as rotation vectors, shapes (n, joint, 4) to (n, 3 joint)."""
    before = np.concatenate([quat.identity(len(turns), 1), turns[:, :-1]], axis=1)
    return quat.to_rotation_vector(quat.multiply(quat.conjugate(before), turns)).reshape(len(turns), 3 * turns.shape[1])


def turned(vectors: Array) -> Array:
    """Return what `told` told, shapes (n, 3 joint) to (n, joint, 4)."""
    out = quat.from_rotation_vector(vectors.reshape(len(vectors), vectors.shape[1] // 3, 3))
    for k in range(1, out.shape[1]):
        out[:, k] = quat.multiply(out[:, k - 1], out[:, k])
    return out
