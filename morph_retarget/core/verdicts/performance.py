"""What is judged: a character over some frames, whatever made it move, and what it was asked for.

Places and turns are those of the bones as keys make them, so that what is judged is what will be seen.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from .. import quat
from ..arrays import Array, Flags, Indices
from ..character import flesh
from ..character.character import Character
from ..ground import Ground
from ..locomotion.stepping import legs
from ..locomotion.stepping.legs import Leg
from ..skeleton import Pose
from ..solve.hierarchy import Hierarchy


@dataclass(frozen=True, eq=False)
class Aim:
    """Where one body shall be."""

    body: int
    places: Array
    """[m], character frame, shape (frame, 3)."""
    influence: Array
    """1 where that counts in full, 0 where it does not count, shape (frame,)."""
    joints: tuple[int, ...]
    """What brings the body there, from the trunk outward; none for one that is moved itself."""
    stretch: float = 1.0
    """By what factor its limb may get longer."""
    folds: float = 0.0
    """To what share of its length a limb may be folded up at most; 0 where its bones alone set an end to that."""


@dataclass(frozen=True, eq=False)
class Turn:
    """How one body shall be turned."""

    body: int
    turns: Array
    """From rest, character frame, shape (frame, 4)."""
    influence: Array
    """1 where that counts in full, 0 where it does not count, shape (frame,)."""


@dataclass(frozen=True, eq=False)
class Performance:
    """A character over some frames."""

    character: Character
    root: int
    """The body that carries all others."""
    places: Array
    """Of all bones' heads [m], character frame, shape (frame, bone, 3)."""
    turns: Array
    """Of all bones from rest, character frame, shape (frame, bone, 4)."""
    seconds_per_frame: float
    aims: Sequence[Aim] = ()
    """Where bodies were asked to be, as far as that is known."""
    turned: Sequence[Turn] = ()
    """How bodies were asked to be turned, likewise."""
    standing: Flags | None = None
    """When feet stand, shape (frame, leg), legs as `legs` has them; None where only the motion tells."""
    ground: Ground | None = None
    """How high the ground is, character frame; None where it is level at 0."""
    slack: Mapping[int, float] = field(default_factory=dict[int, float])
    """How far bones may be moved off what carries them [m]: where bones may stretch, or hang elsewhere."""

    def __len__(self) -> int:
        return len(self.places)

    @classmethod
    def of_pose(cls, character: Character, root: int, pose: Pose, seconds_per_frame: float) -> "Performance":
        """Return the performance of a pose in armature space, of which nothing else is known."""
        place = character.local_to_character
        rest = character.skeleton.rest_rotations
        turns = place.turns(quat.multiply(pose.rotations, quat.conjugate(rest)))
        return cls(character, root, place.points(pose.positions), turns, seconds_per_frame)

    @cached_property
    def rest(self) -> Array:
        """Of all bones' heads at rest [m], character frame, shape (bone, 3)."""
        return self.character.local_to_character.points(self.character.skeleton.rest_positions)

    @cached_property
    def size(self) -> float:
        """The character's greatest extent at rest [m]; its height would say nothing about a snake."""
        own = self.rest[self.body]
        return float(np.ptp(own, axis=0).max())

    @cached_property
    def hierarchy(self) -> Hierarchy:
        """What carries what."""
        return Hierarchy(self.character, self.rest, self.root)

    @cached_property
    def body(self) -> Indices:
        """The root and all of the body that it carries, no hair, clothes and props, shape (n,)."""
        return flesh.body(self.character, self.hierarchy.tree, self.root)

    @cached_property
    def flesh(self) -> Indices:
        """The same without what only carries the body, as bones on the ground between the feet do, shape (n,)."""
        return flesh.flesh(self.character, self.hierarchy.tree, self.root)

    @cached_property
    def legs(self) -> Sequence[Leg]:
        """The legs that it stands on."""
        return legs.find(self.character).legs

    @property
    def names(self) -> Sequence[str]:
        """Of all bones."""
        return self.character.skeleton.names

    @cached_property
    def soles(self) -> Array:
        """Rearmost points of the soles and those over which they roll off [m], shape (frame, leg, 2, 3)."""
        if not self.legs:
            return np.empty((len(self), 0, 2, 3))
        feet = [leg.foot for leg in self.legs]
        away = np.array([[leg.heel, leg.tip] for leg in self.legs])
        return self.places[:, feet, None] + quat.rotate(self.turns[:, feet, None], away)
