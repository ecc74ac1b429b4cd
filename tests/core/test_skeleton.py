"""Forward kinematics."""

import numpy as np
import pytest

from morph_retarget.core import quat
from morph_retarget.core.errors import RigError
from morph_retarget.core.skeleton import Skeleton, pose_from_basis
from tests.skeletons import skeleton_of
from tools.figure import Build, humanoid


def test_without_channels_the_pose_is_the_rest() -> None:
    skeleton = skeleton_of(humanoid(build=Build(fingers=5)), np.random.default_rng(5))
    pose = pose_from_basis(skeleton, quat.identity(3, len(skeleton)), np.zeros((3, len(skeleton), 3)))
    assert np.abs(pose.positions - skeleton.rest_positions).max() < 1e-12
    assert quat.angle_between(pose.rotations, skeleton.rest_rotations).max() < 1e-9


def test_every_bone_is_its_parent_times_its_own_channels() -> None:
    rng = np.random.default_rng(6)
    skeleton = skeleton_of(humanoid(build=Build(fingers=2, root=True)), rng)
    basis, shift = quat.normalize(rng.normal(size=(4, len(skeleton), 4))), rng.normal(size=(4, len(skeleton), 3))
    pose = pose_from_basis(skeleton, basis, shift)
    for bone, parent in enumerate(skeleton.parents):
        rest = _matrix(skeleton.rest_rotations[bone], skeleton.rest_positions[bone])
        above = np.eye(4)
        if parent >= 0:
            to_rest = np.linalg.inv(_matrix(skeleton.rest_rotations[parent], skeleton.rest_positions[parent]))
            above = _matrix(pose.rotations[0, parent], pose.positions[0, parent]) @ to_rest
        expected = above @ rest @ _matrix(basis[0, bone], shift[0, bone])
        assert np.abs(_matrix(pose.rotations[0, bone], pose.positions[0, bone]) - expected).max() < 1e-9


def _matrix(rotation: np.ndarray, position: np.ndarray) -> np.ndarray:
    out = np.eye(4)
    out[:3, :3], out[:3, 3] = quat.to_matrix(rotation), position
    return out


def test_a_skeleton_needs_bones() -> None:
    with pytest.raises(RigError, match="has no bones: choose one that has"):
        Skeleton((), np.zeros(0, dtype=int), np.zeros((0, 3)), np.zeros((0, 4)), np.zeros((0, 3)))
