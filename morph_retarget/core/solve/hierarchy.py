"""A character's hierarchy as planning reads it: what trunk and limbs are, whatever the goals and the settings."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .. import quat
from ..arrays import Array
from ..character import girdles
from ..character.character import Character
from ..character.morphology import Capability, Limb
from ..tree import Tree
from . import detached


@dataclass(frozen=True, eq=False)
class Hierarchy:
    """A character at rest, and the body that carries all that the solver moves."""

    character: Character
    rest: Array
    """Rest positions of all bodies [m], character frame, shape (body, 3)."""
    root: int
    fixed: frozenset[int] = frozenset()
    """Bodies whose joints cannot move off where their parents hold them."""

    @property
    def names(self) -> Sequence[str]:
        """Of all bodies."""
        return self.character.skeleton.names

    @cached_property
    def tree(self) -> Tree:
        """What carries which body: its parent, and feet and hands their limbs."""
        return detached.carried(self.character, self.root, self.fixed)

    @cached_property
    def ancestors(self) -> Sequence[Sequence[int]]:
        """Of each body, from what carries it upward."""
        return self.tree.ancestors

    @cached_property
    def detached(self) -> Mapping[int, int]:
        """Feet and hands that do not hang on their limbs, and what each hangs on, -1 when it hangs on nothing."""
        parents = self.character.skeleton.parents
        return {int(body): int(parents[body]) for body in np.flatnonzero(parents != self.tree.parents)}

    @cached_property
    def axes(self) -> Array:
        """Rest axes of all bodies in the character frame, mirrored if the armature is, shape (body, 3, 3)."""
        rest = quat.to_matrix(self.character.skeleton.rest_rotations)
        return self.character.local_to_character.rotation @ rest

    @cached_property
    def loose(self) -> frozenset[int]:
        """Bones that do not go with what carries them by themselves, and so must be turned to be carried along.

        Those that do not take over their parents' rotation, and those that hang elsewhere.
        """
        inherits = self.character.skeleton.inherits
        alone = () if inherits is None else np.flatnonzero(~inherits).tolist()
        return frozenset({*alone, *self.detached})

    # --- trunk ---

    @cached_property
    def midline(self) -> tuple[int, ...]:
        """Spine, neck and head, also where the root does not carry them."""
        own = self.character
        return (*own.spine, *own.neck, *([] if own.head is None else [own.head]))

    @cached_property
    def way(self) -> tuple[int, ...]:
        """The bodies of the trunk from the root, which is not among them, to the head or to where the spine ends."""
        head, carried = self.character.head, [body for body in self.midline if self.root in self.ancestors[body]]
        if not carried:
            return ()
        last = head if head in carried else max(carried, key=lambda body: len(self.ancestors[body]))
        above = self.ancestors[last]
        return (*reversed(above[: above.index(self.root)]), last)

    @cached_property
    def trunk(self) -> frozenset[int]:
        """The root and the bodies of the trunk."""
        return frozenset({self.root, *self.way})

    @cached_property
    def above_root(self) -> frozenset[int]:
        """What carries the root, and so the whole body."""
        return frozenset(self.ancestors[self.root])

    # --- limbs ---

    @cached_property
    def outer(self) -> frozenset[int]:
        """Bodies of limbs and tails."""
        own = self.character
        parts = (*own.tails, *((*limb.bones, *limb.digits) for limb in own.limbs))
        return frozenset(body for part in parts for body in part)

    def is_on_limb(self, body: int) -> bool:
        """Return whether a body is part of a limb or tail, or hangs on one."""
        return any(bone in self.outer for bone in (body, *self.ancestors[body]))

    def is_foot(self, body: int) -> bool:
        """Return whether a body stands on the ground."""
        return Capability.FOOT in self.character.capabilities.get(self.names[body], ())

    def limb_of(self, body: int) -> Limb | None:
        """Return the limb of the character that a body is part of."""
        return next((limb for limb in self.character.limbs if body in limb.bones or body in limb.digits), None)

    def hinged(self, path: tuple[int, ...]) -> tuple[int, ...]:
        """Return the joints of a limb that bend: not girdles, and of humanoid limbs not what only twists."""
        for upper, lower, end in self._humanoid_limbs:
            if upper in path and lower in path:
                there = path.index(end) if end in path else len(path)
                return (upper, lower, *path[there:])
        return path[1:] if len(path) > 2 and path[0] in self._girdles else path

    def lengths(self, joints: Sequence[int], body: int) -> tuple[float, float]:
        """Return the length of a limb when it is stretched, and when it is folded up [m].

        Args:
            joints: Of the limb, from what carries it outward.
            body: The one at its end.
        """
        bones = np.linalg.norm(np.diff(self.rest[[*joints, body]], axis=0), axis=-1)
        full = float(bones.sum())
        return full, max(2.0 * float(bones.max(initial=0.0)) - full, 0.0)

    @cached_property
    def _humanoid_limbs(self) -> list[tuple[int, ...]]:
        """Upper and lower bone and end of the arms and legs of a humanoid; between these are bones that twist."""
        if not self.character.humanoid:
            return []
        parts = (("UpperArm", "LowerArm", "Hand"), ("UpperLeg", "LowerLeg", "Foot"))
        found = [[self.character.bone(side + part) for part in row] for side in ("left", "right") for row in parts]
        return [tuple(bone for bone in row if bone is not None) for row in found if None not in row]

    @cached_property
    def _girdles(self) -> frozenset[int]:
        """Shoulders, which lie in the trunk."""
        return girdles.find(self.character, self.rest)
