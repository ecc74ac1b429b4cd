"""Which joint, which foot and which translation is whose mirror image on a character model."""

from dataclasses import dataclass

import numpy as np

from ...arrays import Array, Indices
from ...character import mirror
from ...character.names import read_names
from ..character_model import CharacterModel


@dataclass(frozen=True, eq=False)
class Partners:
    """For each item the one on the other side, or itself; the partner of a partner is the item again."""

    joints: Indices
    """Shape (joint,)."""
    moving: Indices
    """Among `CharacterModel.moving`, shape (moving,)."""
    feet: Indices
    """Among `CharacterModel.feet`, shape (foot,)."""


def partners_of(model: CharacterModel) -> Partners:
    """Return the partners, by names first and then by places."""
    own = model.character
    skeleton = own.skeleton
    places = own.local_to_character.points(skeleton.rest_positions)
    by_name = mirror.named_partners(read_names(skeleton.names))
    axis = np.array([1.0, 0.0, 0.0])
    found = mirror.partners(places, skeleton.tree, by_name, axis, _middle(places, by_name), own.frame.height)
    joints = np.where(found >= 0, found, np.arange(len(found)))
    # What carries the body carries its image.
    for joint in (model.root, *skeleton.tree.ancestors[model.root]):
        joints[[joint, joints[joint]]] = joint, joints[joint]
    return Partners(joints, _among(model.moving, joints), _among(model.feet, joints))


def _middle(places: Array, by_name: Indices) -> float:
    left = np.flatnonzero(by_name >= 0)
    return float(np.median(0.5 * (places[left, 0] + places[by_name[left], 0]))) if len(left) else 0.0


def _among(chosen: Indices, joints: Indices) -> Indices:
    """Return the partners of chosen joints by their places; those whose partner was not chosen have none."""
    place = {int(joint): i for i, joint in enumerate(chosen)}
    return np.array([place.get(int(joints[joint]), i) for i, joint in enumerate(chosen)], dtype=np.intp)
