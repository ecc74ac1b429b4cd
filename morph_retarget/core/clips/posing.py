"""From poses to frames of clips and back: the travel taken out, and put in again."""

import numpy as np

from .. import quat
from ..arrays import Array
from ..skeleton import Pose, pose_from_basis
from .character_model import CharacterModel
from .frames import Frames
from .spots import spots_of
from .travel import Travel

UP: Array = np.array([0.0, 0.0, 1.0])


def frames_of(model: CharacterModel, pose: Pose, travel: Travel, contacts: Array, cycle: bool = False) -> Frames:
    """Return poses as seen from a travel.

    What is above the root rests, so what moves the root goes over to it.

    Args:
        model: The body.
        pose: Armature space, shape (n, joint, ...).
        travel: Of each frame.
        contacts: How far each foot stands, shape (n, foot).
        cycle: Whether the frame after the last is the first again.
    """
    skeleton, place = model.character.skeleton, model.character.local_to_character
    seen = moved(model, pose, travel.inverse())
    above = skeleton.tree.ancestors[model.root]
    seen.rotations[:, above] = skeleton.rest_rotations[above]
    seen.positions[:, above] = skeleton.rest_positions[above]
    child = skeleton.parents >= 0
    parents = np.where(child, skeleton.parents, 0)
    carried = quat.multiply(seen.rotations[:, parents], skeleton.local_rotations)
    carried[:, ~child] = skeleton.local_rotations[~child]
    rotations = quat.normalize(quat.multiply(quat.conjugate(carried), seen.rotations))
    rotations[:, above] = quat.IDENTITY
    moving = model.moving
    over = parents[moving]
    away = quat.rotate(quat.conjugate(seen.rotations[:, over]), seen.positions[:, moving] - seen.positions[:, over])
    away[:, ~child[moving]] = seen.positions[:, moving[~child[moving]]]
    turned = np.broadcast_to(quat.conjugate(skeleton.local_rotations[moving]), (len(away), len(moving), 4))
    translations = quat.rotate(turned, away - skeleton.local_offsets[moving])
    return Frames(
        rotations, translations, spots_of(model, place.points(pose.positions), travel, contacts, cycle), contacts
    )


def pose_of(model: CharacterModel, frames: Frames, travel: Travel | None = None) -> Pose:
    """Return frames as poses in armature space, where the travel leads or on the spot."""
    locations = np.zeros((len(frames), len(model), 3))
    locations[:, model.moving] = frames.translations
    pose = pose_from_basis(model.character.skeleton, frames.rotations, locations)
    return pose if travel is None else moved(model, pose, travel)


def moved(model: CharacterModel, pose: Pose, travel: Travel) -> Pose:
    """Return poses carried over the ground by a travel."""
    place = model.character.local_to_character
    back = place.inverse()
    turns = quat.from_axis_angle(UP, travel.headings)
    shifts = np.column_stack([travel.places, np.zeros(len(travel))])
    points = quat.rotate(turns[:, None], place.points(pose.positions)) + shifts[:, None]
    # The turn about the vertical as the armature sees it.
    local = quat.multiply(quat.multiply(back.turn, turns), place.turn)
    return Pose(quat.multiply(local[:, None], pose.rotations), back.points(points))
