"""Keyed bones as poses: forward kinematics of what a transfer or the solver found."""

import numpy as np

from . import quat
from .arrays import Array, Indices
from .play import Played
from .skeleton import Pose, Skeleton, pose_from_basis


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


def played(skeleton: Skeleton, found: Played) -> Pose:
    """Return the pose that a played clip makes, armature space."""
    moved, shifts = np.array([found.root]), found.shift[:, None]
    if found.stretched is not None:
        moved = np.append(moved, found.stretched.bones)
        shifts = np.concatenate([shifts, found.stretched.shifts], axis=1)
    return pose_of(skeleton, found.bones, found.basis, moved, shifts)
