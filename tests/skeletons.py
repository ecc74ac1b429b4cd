"""Figures as skeletons and motions, for tests of the core."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from morph_retarget.core import quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.character.character import Character
from morph_retarget.core.pipeline import Result
from morph_retarget.core.skeleton import Pose, Skeleton, pose_from_basis
from tools.figure import Bone


def skeleton_of(bones: Sequence[Bone], rng: np.random.Generator | None = None) -> Skeleton:
    """Return figure bones as a skeleton; with ``rng`` every bone gets axes of its own that mean nothing."""
    place = {bone.name: i for i, bone in enumerate(bones)}
    count = len(bones)
    rotations = quat.identity(count) if rng is None else quat.normalize(rng.normal(size=(count, 4)))
    return Skeleton(
        tuple(b.name for b in bones),
        np.array([-1 if b.parent is None else place[b.parent] for b in bones]),
        np.array([b.head for b in bones]),
        rotations,
        np.array([b.tail for b in bones]),
    )


def numbered(bones: Sequence[Bone], rng: np.random.Generator) -> tuple[list[Bone], dict[str, str]]:
    """Return the bones under names that say nothing, and each old name's new one."""
    numbers = rng.permutation(len(bones)) + 1
    names = {b.name: f"joint{n}" for b, n in zip(bones, numbers, strict=True)}
    return [Bone(names[b.name], names.get(b.parent or ""), b.head, b.tail) for b in bones], names


def wild(skeleton: Skeleton, frames: int, rng: np.random.Generator, reach: float = 0.6) -> Pose:
    """Return a smooth motion in which every bone turns up to ``reach`` [rad] and the root wanders."""
    waves = _waves(rng, frames, len(skeleton), reach)
    locations = np.zeros((frames, len(skeleton), 3))
    locations[:, 0] = 0.3 * _waves(rng, frames, 1, 1.0)[:, 0]
    return pose_from_basis(skeleton, quat.from_rotation_vector(waves), locations)


def _waves(rng: np.random.Generator, frames: int, count: int, reach: float) -> Array:
    time = np.linspace(0.0, 2.0 * np.pi, frames)[:, None, None]
    rates, phases = rng.uniform(0.5, 2.0, (count, 3)), rng.uniform(0.0, 6.0, (count, 3))
    return reach * np.sin(rates * time + phases) / np.sqrt(3.0)


def play(character: Character, result: Result) -> Pose:
    """Return the pose that a result's keys make on its target, by forward kinematics alone."""
    skeleton, frames = character.skeleton, len(result.basis)
    rotations, locations = quat.identity(frames, len(skeleton)), np.zeros((frames, len(skeleton), 3))
    rotations[:, result.bones] = result.basis
    rest = skeleton.rest_rotations[result.moved]
    locations[:, result.moved] = quat.rotate(quat.conjugate(rest), result.shifts)
    return pose_from_basis(skeleton, rotations, locations)


def joints(character: Character, pose: Pose, *names: str) -> Array:
    """Return the places of some joints, character frame, shape (frame, joint, 3)."""
    bones = [character.bone(name) for name in names]
    assert None not in bones
    return character.local_to_character.points(pose.positions[:, bones])


def bent(skeleton: Skeleton, amount: float, seed: int) -> Skeleton:
    """Return a skeleton whose rest is bent at every bone, as if posed at random.

    Args:
        skeleton: At rest.
        amount: Standard deviation of the turn about each axis [rad].
        seed: Of the turns.
    """
    turns = quat.from_rotation_vector(np.random.default_rng(seed).normal(0.0, amount, (len(skeleton), 3)))
    heads, tails = skeleton.rest_positions.copy(), skeleton.rest_tails.copy()
    for bone, parent in enumerate(skeleton.parents):
        if parent >= 0:
            turns[bone] = quat.multiply(turns[parent], turns[bone])
            step = skeleton.rest_positions[bone] - skeleton.rest_positions[parent]
            heads[bone] = heads[parent] + quat.rotate(turns[parent], step)
        tails[bone] = heads[bone] + quat.rotate(turns[bone], skeleton.rest_tails[bone] - skeleton.rest_positions[bone])
    return replace(skeleton, rest_positions=heads, rest_tails=tails)
