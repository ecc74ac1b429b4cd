"""The skeleton: names, parents and rest transforms of bones, and forward kinematics over batches of frames."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from . import quat
from .arrays import Array, Flags, Indices
from .errors import RigError
from .tree import Tree


@dataclass(frozen=True, eq=False)
class Skeleton:
    """A tree of bones at rest. Parents always stand before their children.

    All transforms are in one space, the armature's own; `Placement` leads from there to the world.
    """

    names: tuple[str, ...]
    parents: Indices
    """Index of each bone's parent, -1 for roots, shape (bone,)."""
    rest_positions: Array
    """Bone heads, shape (bone, 3)."""
    rest_rotations: Array
    """Bone orientations as quaternions (w, x, y, z), shape (bone, 4)."""
    rest_tails: Array
    """Bone tails, shape (bone, 3). Importers guess them: directions come from heads wherever a child exists."""
    deform: Flags | None = None
    """Whether a bone may move a mesh, shape (bone,); None when nobody knows."""
    inherits: Flags | None = None
    """Whether a bone takes over its parent's rotation, shape (bone,); None when all do."""
    index: dict[str, int] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        if not self.names:
            raise RigError("the armature has no bones: choose one that has")
        assert (self.parents < np.arange(len(self.names))).all(), "parents must stand before their children"
        object.__setattr__(self, "index", {name: i for i, name in enumerate(self.names)})

    def __len__(self) -> int:
        return len(self.names)

    @cached_property
    def tree(self) -> Tree:
        """Who hangs on whom."""
        return Tree(self.parents)

    @cached_property
    def local_offsets(self) -> Array:
        """Head of each bone in its parent's rest frame (in armature space for roots), shape (bone, 3)."""
        out = self.rest_positions.copy()
        child = np.flatnonzero(self.parents >= 0)
        parent = self.parents[child]
        step = self.rest_positions[child] - self.rest_positions[parent]
        out[child] = quat.rotate(quat.conjugate(self.rest_rotations[parent]), step)
        return out

    @cached_property
    def local_rotations(self) -> Array:
        """Rest rotation of each bone in its parent's rest frame, shape (bone, 4)."""
        out = self.rest_rotations.copy()
        child = np.flatnonzero(self.parents >= 0)
        parent = self.parents[child]
        out[child] = quat.multiply(quat.conjugate(self.rest_rotations[parent]), self.rest_rotations[child])
        return out


@dataclass(frozen=True, eq=False)
class Pose:
    """The pose of all bones over a batch of frames, in armature space."""

    rotations: Array
    """Bone orientations, shape (frame, bone, 4)."""
    positions: Array
    """Bone heads, shape (frame, bone, 3)."""

    def __len__(self) -> int:
        return len(self.rotations)


def pose_from_basis(skeleton: Skeleton, basis_rotations: Array, basis_locations: Array) -> Pose:
    """Return the pose that channel values make (forward kinematics).

    Args:
        skeleton: The bones.
        basis_rotations: Rotation of each bone relative to its rest, in its own rest frame, shape (frame, bone, 4).
        basis_locations: Translation in the same frame, shape (frame, bone, 3).
    """
    frames = len(basis_rotations)
    rotations = np.empty((frames, len(skeleton), 4))
    positions = np.empty((frames, len(skeleton), 3))
    local = quat.multiply(skeleton.local_rotations, basis_rotations)
    shift = skeleton.local_offsets + quat.rotate(skeleton.local_rotations, basis_locations)
    for level in skeleton.tree.levels:
        parents = skeleton.parents[level]
        if parents[0] < 0:
            rotations[:, level] = local[:, level]
            positions[:, level] = shift[:, level]
            continue
        above = rotations[:, parents]
        rotations[:, level] = quat.multiply(above, local[:, level])
        positions[:, level] = positions[:, parents] + quat.rotate(above, shift[:, level])
    return Pose(rotations, positions)
