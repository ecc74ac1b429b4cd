"""A generalized action or a gait as it is judged: bones rebuilt from its keys, and what was asked for.

Keys hold rotations and the places of a few bones, as they are written to an action; what the solver thought of them
does not count.
"""

from collections.abc import Sequence

import numpy as np

from .. import quat
from ..arrays import Array, Flags
from ..character.character import Character
from ..ground import Ground
from ..play import Played
from ..skeleton import Pose, pose_from_basis
from ..solve import detached
from ..solve.plan import Plan
from .performance import Aim, Performance, Turn


def performance_of(
    character: Character,
    played: Played,
    seconds_per_frame: float,
    standing: Flags | None = None,
    ground: Ground | None = None,
) -> Performance:
    """Return what a character plays, to be judged.

    Args:
        character: Who plays.
        played: What came out.
        seconds_per_frame: Time between frames [s].
        standing: When feet stand, where a gait knows, shape (frame, leg).
        ground: How high the ground is, character frame; None where it is level at 0.
    """
    plan = played.pose.plan
    own = Performance.of_pose(character, played.root, rebuilt(character, played), seconds_per_frame)
    return Performance(
        character,
        played.root,
        own.places,
        own.turns,
        seconds_per_frame,
        tuple(_aims(played, own.hierarchy.trunk)),
        tuple(_turned(played)),
        standing,
        ground,
        _slack(plan),
    )


def rebuilt(character: Character, played: Played) -> Pose:
    """Return the pose that keys make, armature space, by forward kinematics alone."""
    skeleton, frames = character.skeleton, len(played.basis)
    rotations, locations = quat.identity(frames, len(skeleton)), np.zeros((frames, len(skeleton), 3))
    rotations[:, played.bones] = played.basis
    locations[:, played.root] = _in_own_frame(skeleton.rest_rotations[played.root], played.shift)
    if played.stretched is not None:
        bones = played.stretched.bones
        locations[:, bones] = _in_own_frame(skeleton.rest_rotations[bones], played.stretched.shifts)
    return pose_from_basis(skeleton, rotations, locations)


def _in_own_frame(rest: Array, shifts: Array) -> Array:
    return quat.rotate(quat.conjugate(rest), shifts)


def _aims(played: Played, trunk: frozenset[int]) -> Sequence[Aim]:
    """Return where bodies were asked to be; ``trunk`` are the bodies of which no limb is made."""
    goals, plan = played.goals, played.pose.plan
    stretch = plan.settings.stretch if plan.settings.allows_stretch else 1.0
    placed = goals.position_influence.max(axis=0, initial=0.0) > 0.0
    out: list[Aim] = []
    for i, body in enumerate(goals.bodies.tolist()):
        if placed[i]:
            joints = plan.joints_of(body)
            folds = 0.0 if trunk.isdisjoint(joints) else plan.settings.spine_shrink
            out.append(Aim(body, goals.positions[:, i], goals.position_influence[:, i], joints, stretch, folds))
    return out


def _turned(played: Played) -> Sequence[Turn]:
    goals = played.goals
    asked = goals.rotation_influence.max(axis=0, initial=0.0) > 0.0
    return [
        Turn(body, goals.turns[:, i], goals.rotation_influence[:, i])
        for i, body in enumerate(goals.bodies.tolist())
        if asked[i]
    ]


def _slack(plan: Plan) -> dict[int, float]:
    """Return how far bodies may be moved off what carries them [m]."""
    out = dict[int, float]()
    for body in plan.stretched:
        above = int(plan.parents[body])
        if above < 0:
            continue
        length = float(np.linalg.norm(plan.rest[body] - plan.rest[above]))
        out[body] = (plan.settings.stretch - 1.0) * length if plan.settings.allows_stretch else 0.0
        if body in plan.detached:
            path = plan.rest[[*plan.joints_of(body), body]]
            out[body] += detached.GAP * float(np.linalg.norm(np.diff(path, axis=0), axis=-1).sum())
    return out
