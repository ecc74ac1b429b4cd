"""The motion of a performance on the character that shows it: transferred once, after all blending (Feng 2013 §5.1)."""

from dataclasses import replace

import numpy as np

from .. import keyed, pipeline, quat
from ..arrays import Array, Flags
from ..character.character import Character
from ..clips import posing
from ..clips.character_model import RATE, CharacterModel
from ..clips.frames import Frames
from ..clips.spots import STANDS
from ..clips.travel import Travel
from ..ground import Ground
from ..mocap import plan as planning
from ..pipeline import Result
from ..skeleton import Pose
from . import planting
from .moved import Moved


def scale_between(model: CharacterModel, target: Character) -> float:
    """Return the target's travel over the model's.

    Raises:
        RigError: Just one of the two has legs.
        MappingError: They share no joints.
    """
    return 1.0 if model.character is target else planning.prepare(model.character, target).scale


def on(target: CharacterModel, model: CharacterModel, frames: Frames, travel: Travel, ground: Ground | None) -> Moved:
    """Return frames of clips on the character that shows them.

    Args:
        target: The character that shows them.
        model: The body that the clips are made for.
        frames: One after the other at `RATE`.
        travel: Of the same frames.
        ground: Terrain under the target, its character frame, or None.

    Raises:
        RigError: Just one of the two has legs.
        MappingError: They share no joints.
    """
    pose = posing.pose_of(model, frames, travel)
    feet = planting.places(model, frames, travel, model.character.local_to_character.points(pose.positions))
    character = target.character
    if model.character is character:
        own = Moved.of(character, pose, travel, frames.contacts)
        return planting.plant(character, model.root, own, feet, ground)
    plan = planning.prepare(model.character, character)
    # Feng 2013 §5.2: feet keep to the places that were blended, and not to where blended rotations bring them.
    ankles, standing = _feet_of(plan, model, frames, feet)
    result = pipeline.evaluate(plan, pose, 1.0 / RATE, standing, ground, ankles)
    scaled = Travel(plan.scale * travel.places, travel.headings)
    found = Moved.of(character, _pose_of(character, result), scaled, _contacts_of(plan, character, result))
    return _carried_by_root(target, found, int(result.moved[0]))


def _carried_by_root(target: CharacterModel, moved: Moved, hips: int) -> Moved:
    """Return a motion in which the root carries the hips, where these hang on it: it is the root that is moved."""
    root = target.root
    if root not in target.character.skeleton.tree.ancestors[hips]:
        return moved
    rest = target.character.local_to_character.points(target.character.skeleton.rest_positions)
    turns, positions = moved.turns.copy(), moved.positions.copy()
    turns[:, root] = turns[:, hips]
    positions[:, root] = positions[:, hips] + quat.rotate(turns[:, hips], rest[root] - rest[hips])
    return replace(moved, turns=turns, positions=positions)


def _feet_of(plan: planning.Plan, model: CharacterModel, frames: Frames, places: Array) -> tuple[Array, Flags]:
    """Return where the legs of a plan have their feet by the clips, NaN where they do not tell, and when they stand."""
    own = {int(joint): i for i, joint in enumerate(model.feet)}
    found = np.full((len(frames), len(plan.links.legs), 3), np.nan)
    standing = np.zeros(found.shape[:2], dtype=np.bool_)
    for i, leg in enumerate(plan.links.legs):
        row = own.get(int(plan.links.source[leg.end, 0]))
        if row is not None:
            found[:, i], standing[:, i] = places[:, row], frames.contacts[:, row] > STANDS
    return found, standing


def _pose_of(target: Character, result: Result) -> Pose:
    """Return a transferred motion as poses in armature space."""
    return keyed.pose_of(target.skeleton, result.bones, result.basis, result.moved, result.shifts)


def _contacts_of(plan: planning.Plan, target: Character, result: Result) -> Array:
    """Return when the target's own feet stand, shape (frame, foot)."""
    standing: Flags = result.source.steps.standing
    by_bone = {int(plan.links.target[leg.end]): i for i, leg in enumerate(plan.links.legs)}
    out = np.zeros((len(standing), len(target.legs)))
    for i, leg in enumerate(target.legs):
        if leg.end in by_bone:
            out[:, i] = standing[:, by_bone[leg.end]]
    return out
