"""Choosing a frame of a clip that can stand for a rest pose, for skeletons whose own rest is no pose of a body."""

import numpy as np

from .. import quat
from ..arrays import Array
from ..character.character import Character
from ..character.frame import WORLD_AXES
from ..character.joints import SIDES
from ..skeleton import Pose

MOST_FRAMES = 240
"""Longer clips are looked at in steps."""
_SEGMENTS = tuple(
    (side + a, side + b)
    for side in SIDES
    for a, b in (("UpperLeg", "LowerLeg"), ("LowerLeg", "Foot"), ("UpperArm", "LowerArm"), ("LowerArm", "Hand"))
)


def upright_axis(character: Character, pose: Pose) -> Array:
    """Return the world axis that leads from feet to head over most of a clip, unit vector.

    Args:
        character: Judged by names; its own frame is not used.
        pose: The clip, armature space.
    """
    head = character.bone("head")
    feet = [b for s in SIDES if (b := character.bone(f"{s}Foot")) is not None]
    if head is None or not feet:
        return WORLD_AXES["+Z"]
    rise = (pose.positions[:, head] - pose.positions[:, feet].mean(axis=1)).mean(axis=0)
    world = character.placement.directions(rise)
    best = max(WORLD_AXES.values(), key=lambda axis: float(axis @ world))
    # A clip that is spent lying down says little; the world's own up then stands.
    return best if best @ quat.unit(world) > 0.8 else WORLD_AXES["+Z"]


def standing_frame(character: Character, pose: Pose, up: Array) -> int:
    """Return the row in which a body stands most plainly: legs straight down, head up, arms straight.

    Args:
        character: Judged by names.
        pose: The clip, armature space.
        up: World axis, shape (3,).
    """
    rows = _rows(pose)
    points = character.placement.points(pose.positions[rows])
    score = np.zeros(len(rows))
    for a, b in _SEGMENTS:
        first, second = character.bone(a), character.bone(b)
        if first is not None and second is not None and "Leg" in a:
            score -= quat.unit(points[:, second] - points[:, first]) @ up
    for side in SIDES:
        bones = [character.bone(side + j) for j in ("UpperArm", "LowerArm", "Hand")]
        if None not in bones:
            upper, lower, hand = (points[:, b] for b in bones)
            score += 0.5 * np.sum(quat.unit(lower - upper) * quat.unit(hand - lower), axis=-1)
    hips, head = character.bone("hips"), character.bone("head")
    if hips is not None and head is not None:
        score += 2.0 * (quat.unit(points[:, head] - points[:, hips]) @ up)
    return int(rows[np.argmax(score)])


def frame_like_rest(source: Character, target: Character, pose: Pose) -> int:
    """Return the row in which the source comes nearest to the target's rest, whichever way it faces.

    The nearer it comes, the less twist the alignment has to guess.
    """
    rows = _rows(pose)
    theirs = source.local_to_character.points(pose.positions[rows])
    ours = target.local_to_character.points(target.skeleton.rest_positions)
    facing = _facing(source, theirs)
    score = np.zeros(len(rows))
    for a, b in (*_SEGMENTS, ("hips", "head"), ("leftUpperArm", "rightUpperArm")):
        bones = [c.bone(j) for c in (source, target) for j in (a, b)]
        if None not in bones:
            p, q, r, s = bones
            own = quat.rotate(quat.conjugate(facing), quat.unit(theirs[:, q] - theirs[:, p]))
            score += own @ quat.unit(ours[s] - ours[r])
    return int(rows[np.argmax(score)])


def _rows(pose: Pose) -> np.ndarray:
    return np.unique(np.linspace(0, len(pose) - 1, min(len(pose), MOST_FRAMES)).astype(np.intp))


def _facing(character: Character, points: Array) -> Array:
    """Return the turn about the vertical to where a body faces in each frame, shape (frame, 4)."""
    left, right = character.bone("leftUpperLeg"), character.bone("rightUpperLeg")
    if left is None or right is None:
        return quat.identity(len(points))
    across = points[:, left] - points[:, right]
    return quat.from_axis_angle(np.array([0.0, 0.0, 1.0]), quat.direction(across[:, 1], across[:, 0]))
