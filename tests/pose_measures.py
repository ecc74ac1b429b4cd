"""How well poses meet goals, how smoothly joints turn, and mirror images: what is measured of the pose step."""

import numpy as np

from morph_retarget.core import quat
from morph_retarget.core.arrays import Array, Indices
from morph_retarget.core.character.character import Character
from morph_retarget.core.play import Played
from morph_retarget.core.skeleton import pose_from_basis
from morph_retarget.core.solve import posing
from morph_retarget.core.solve.goals import Goals
from morph_retarget.core.solve.posing import BodyPose
from tests.goal_sets import HUMAN, Subject, goals_of, placed

MEET = 1e-3
"""A goal is met by a body of a human that comes as near as this [m]."""


def solved(subject: Subject, goals: Goals) -> BodyPose:
    """Return the pose that the pose step finds for all goals of a character."""
    return posing.solve(subject.plan, goals)


def rebuilt(subject: Subject, pose: BodyPose) -> Array:
    """Return where bodies are when only their turns and the place of the root are believed, shape (frame, body, 3).

    And how far feet and hands are moved that do not hang on their limbs.
    """
    moved = np.zeros(pose.positions.shape)
    if pose.stretched is not None:
        own = list(pose.plan.detached)
        moved[:, own] = pose.stretched[:, pose.plan.led_by[own]]
    return placed(subject, pose.turns, pose.positions[:, subject.root], moved)


def written(character: Character, played: Played) -> tuple[Array, Array]:
    """Return places and turns of all bones that keys make, by forward kinematics alone, (frame, bone, 3) and (…, 4)."""
    skeleton, frames, place = character.skeleton, len(played.basis), character.local_to_character
    rotations, shifts = quat.identity(frames, len(skeleton)), np.zeros((frames, len(skeleton), 3))
    rotations[:, played.bones] = played.basis
    shifts[:, played.root] = played.shift
    if played.stretched is not None:
        shifts[:, played.stretched.bones] = played.stretched.shifts
    rest = skeleton.rest_rotations
    pose = pose_from_basis(skeleton, rotations, quat.rotate(quat.conjugate(rest), shifts))
    return place.points(pose.positions), place.turns(quat.multiply(pose.rotations, quat.conjugate(rest)))


def misses(subject: Subject, goals: Goals, places: Array) -> Array:
    """Return how far bodies are from their goals as if they were a human's [m], shape (frame, goal)."""
    return quat.length(places[:, goals.bodies] - goals.positions) / subject.scale


def length_errors(subject: Subject, places: Array) -> Array:
    """Return by how much bones are longer or shorter than at rest over their length, shape (frame, bone).

    Bones that are shorter than a thousandth of the character count as long as that. What the root hangs on is no bone,
    and there is none between a limb and a foot or hand that hangs elsewhere: see `gaps`.
    """
    no_bones = {subject.root, *subject.plan.detached}
    return _length_errors(subject, places, [body for body in range(len(subject.bodies)) if body not in no_bones])


def gaps(subject: Subject, places: Array) -> Array:
    """Return how far feet and hands that hang elsewhere leave their limbs, as `length_errors`, shape (frame, body)."""
    return _length_errors(subject, places, list(subject.plan.detached))


def _length_errors(subject: Subject, places: Array, among: list[int]) -> Array:
    bodies, parents = subject.bodies, subject.tree.parents
    bones = np.array([body for body in among if parents[body] >= 0], dtype=np.intp)
    above = parents[bones]
    rest = quat.length(bodies.positions[bones] - bodies.positions[above])
    error = np.abs(quat.length(places[:, bones] - places[:, above]) - rest)
    return error / np.maximum(rest, 1e-3 * HUMAN * subject.scale)


def step_turns(turns: Array, ways: int = 1) -> Array:
    """Return the most that any body turns from each frame to the next [rad], shape (frame - ways,).

    Args:
        turns: Shape (frame, body, 4).
        ways: So many of the same length follow each other; nothing is said of what lies between two.
    """
    own = turns.reshape(ways, len(turns) // ways, *turns.shape[1:])
    return quat.angle_between(own[:, 1:], own[:, :-1]).max(axis=2, initial=0.0).ravel()


def goal_motion(subject: Subject, goals: Goals) -> Array:
    """Return how far goals go from each frame to the next, shape (frame - 1,).

    The most of any goal, of what it moves over the character's size and what it turns [rad].
    """
    moved = quat.length(np.diff(goals.positions, axis=0)) / (HUMAN * subject.scale)
    return np.maximum(moved, quat.angle_between(goals.turns[1:], goals.turns[:-1])).max(axis=1)


# --- symmetry ---

MIRROR: Array = np.array([-1.0, 1.0, 1.0])
"""Takes a point to its mirror image."""
MIRROR_TURN: Array = np.array([1.0, 1.0, -1.0, -1.0])
"""Takes a rotation to its mirror image."""


def partners(subject: Subject, tolerance: float = 1e-6) -> Indices | None:
    """Return each body's mirror image, itself in the middle, shape (body,); None when the character is lopsided.

    Args:
        subject: The character.
        tolerance: By how much places may differ, as a share of the character's size.
    """
    bodies = subject.bodies
    out = np.full(len(bodies), -1, dtype=np.intp)
    for level in bodies.tree.levels:
        for body in level:
            parent = int(bodies.parents[body])
            above = int(out[parent]) if parent >= 0 else -1
            apart = quat.length(bodies.positions[level] - bodies.positions[body] * MIRROR)
            fits = apart <= tolerance * bodies.size
            fits &= (bodies.parents[level] == above) & ~np.isin(level, out)
            fits &= np.array([bodies.capabilities[b] == bodies.capabilities[body] for b in level])
            if not fits.any():
                return None
            # Where several bodies lie in one place, one in the middle is its own image.
            out[body] = body if fits[level == body].all() else level[fits][0]
    return out


def mirrored(goals: Goals, partner: Indices) -> Goals:
    """Return the mirror images of goals."""
    place = {int(body): i for i, body in enumerate(goals.bodies)}
    order = [place[int(partner[body])] for body in goals.bodies]
    return goals_of(goals.bodies, goals.positions[:, order] * MIRROR, goals.turns[:, order] * MIRROR_TURN)
