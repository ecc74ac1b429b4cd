"""The character frame: where a body's left, front and up are, its ground and its height.

Convention (Blender's own habit): origin on the ground under the root, +X to the character's left, -Y forward, +Z up.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np

from .. import quat
from ..arrays import Array
from ..errors import RigError

WORLD_AXES: dict[str, Array] = {
    "+X": np.array([1.0, 0.0, 0.0]),
    "-X": np.array([-1.0, 0.0, 0.0]),
    "+Y": np.array([0.0, 1.0, 0.0]),
    "-Y": np.array([0.0, -1.0, 0.0]),
    "+Z": np.array([0.0, 0.0, 1.0]),
    "-Z": np.array([0.0, 0.0, -1.0]),
}


@dataclass(frozen=True, eq=False)
class Placement:
    """Where an armature stands in the world: ``world = scale * rotation @ local + translation``.

    ``rotation`` is orthogonal; its determinant is -1 for a mirrored object.
    """

    rotation: Array
    """Shape (3, 3)."""
    scale: float
    translation: Array
    """[m], shape (3,)."""

    @classmethod
    def identity(cls) -> Self:
        """Return the placement of an object that was never moved."""
        return cls(np.eye(3), 1.0, np.zeros(3))

    @classmethod
    def from_matrix(cls, matrix: Array) -> tuple[Self, float]:
        """Return the closest placement to an object matrix, shape (4, 4), and how far the matrix is from it.

        The second value is the relative size of the shear or uneven scale that had to be dropped, 0 for none.

        Raises:
            RigError: The matrix flattens space (a scale of zero), or has values that are no numbers.
        """
        if not np.isfinite(matrix).all():
            raise RigError("the armature object is placed by values that are no numbers: clear its transform")
        linear = matrix[:3, :3]
        u, stretches, vt = np.linalg.svd(linear)
        if stretches[-1] < 1e-9 * max(stretches[0], 1e-30):
            raise RigError("the armature object is scaled to zero: give it a scale")
        scale = float(np.cbrt(np.prod(stretches)))
        return cls(u @ vt, scale, matrix[:3, 3].copy()), float(stretches[0] / stretches[-1] - 1.0)

    @property
    def mirrored(self) -> bool:
        """Whether left and right change sides on the way to the world."""
        return float(np.linalg.det(self.rotation)) < 0.0

    def points(self, local: Array) -> Array:
        """Return points, shape (..., 3), in the world [m]."""
        return self.scale * local @ self.rotation.T + self.translation

    def directions(self, local: Array) -> Array:
        """Return directions, shape (..., 3), turned into the world."""
        return local @ self.rotation.T

    @cached_property
    def turn(self) -> Array:
        """Quaternion that takes rotations of local space to world space by conjugation, shape (4,).

        A rotation's axis is a pseudo-vector, so a mirror turns it the other way round; the product of the matrix and
        its determinant is therefore a proper rotation in both cases.
        """
        return quat.from_matrix(self.rotation * np.sign(np.linalg.det(self.rotation)))

    def turns(self, local: Array) -> Array:
        """Return rotations of local space, shape (..., 4), as the same rotations of world space."""
        return quat.multiply(quat.multiply(self.turn, local), quat.conjugate(self.turn))

    def inverse(self) -> "Placement":
        """Return the way back."""
        back = self.rotation.T
        return Placement(back, 1.0 / self.scale, -(back @ self.translation) / self.scale)

    def then(self, other: "Placement") -> "Placement":
        """Return this placement followed by ``other``."""
        return Placement(other.rotation @ self.rotation, self.scale * other.scale, other.points(self.translation))


@dataclass(frozen=True, eq=False)
class CharacterFrame:
    """A body's own axes in the world, its ground point and its size."""

    up: Array
    """Unit vector, world space, shape (3,)."""
    forward: Array
    """Unit vector square to ``up``, world space, shape (3,)."""
    origin: Array
    """Point on the ground under the root [m], world space, shape (3,)."""
    height: float
    """Ground to the top of the head [m]."""

    @property
    def left(self) -> Array:
        """Unit vector to the character's own left."""
        return quat.cross(self.up, self.forward)

    @property
    def world_to_character(self) -> Placement:
        """The way from world space to the character frame, size unchanged."""
        axes = np.stack([self.left, -self.forward, self.up])
        return Placement(axes, 1.0, -(axes @ self.origin))


def axis(name: str) -> Array:
    """Return the world axis called ``name`` ("+X" … "-Z"; a missing sign means plus).

    Raises:
        RigError: There is no such axis.
    """
    key = name if name[:1] in "+-" else f"+{name}"
    try:
        return WORLD_AXES[key.upper()]
    except KeyError:
        raise RigError(f"unknown axis {name!r}: choose one of {', '.join(WORLD_AXES)}") from None
