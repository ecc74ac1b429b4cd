"""Keyed bones as poses: forward kinematics of what a transfer or the solver found."""

import numpy as np

from .. import quat
from ..arrays import Array, Indices
from ..skeleton import Pose, Skeleton, pose_from_basis


def pose_of(skeleton: Skeleton, bones: Indices, basis: Array, moved: Indices, shifts: Array) -> Pose:
    """Return the pose that keys make, armature space.

    Args:
        skeleton: The bones.
        bones: Those that are turned, shape (n,).
        basis: Their rotations in their own rest frames, shape (frame, n, 4).
        moved: Bones that are moved, shape (m,).
        shifts: How far from where their parents hold them, in the rest frames of these, armature space,
            shape (frame, m, 3).
    """
    rotations, locations = quat.identity(len(basis), len(skeleton)), np.zeros((len(basis), len(skeleton), 3))
    rotations[:, bones] = basis
    locations[:, moved] = quat.rotate(quat.conjugate(skeleton.rest_rotations[moved]), shifts)
    return pose_from_basis(skeleton, rotations, locations)
