"""What the bodies of a character do over a clip, on its way from a performance to goals."""

from dataclasses import dataclass

import numpy as np

from .. import quat
from ..arrays import Array
from ..character.character import Character
from ..clips.travel import Travel
from ..skeleton import Pose


@dataclass(frozen=True, eq=False)
class Moved:
    """What the bodies of a character do over a clip, character frame of where it sets out."""

    turns: Array
    """Of all bodies from rest, shape (frame, body, 4)."""
    positions: Array
    """Of all bodies [m], shape (frame, body, 3)."""
    travel: Travel
    """The way over the ground that is part of it."""
    contacts: Array
    """How far each foot stands, the feet of the character's legs, shape (frame, foot)."""

    @classmethod
    def of(cls, character: Character, pose: Pose, travel: Travel, contacts: Array) -> "Moved":
        """Return a pose in armature space, shape (frame, bone, ...), as what bodies do."""
        place = character.local_to_character
        rest = np.broadcast_to(quat.conjugate(character.skeleton.rest_rotations), pose.rotations.shape)
        turns = place.turns(quat.multiply(pose.rotations, rest))
        return cls(turns, place.points(pose.positions), travel, contacts)
