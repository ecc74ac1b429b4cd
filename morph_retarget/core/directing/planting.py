"""Keeping standing feet on their spots in blended motion (Feng 2013 §5.2).

The spot of a foot stays where it is in every clip, also while the foot rolls. Where clips are blended that step on
different spots, it wanders; that is taken out over each contact, and carried over smoothly in flight.
"""

from dataclasses import replace

import numpy as np

from .. import quat
from ..arrays import Array, Flags
from ..character.character import Character
from ..character.morphology import Limb
from ..clips import spots
from ..clips.character_model import RATE, CharacterModel
from ..clips.frames import Frames
from ..clips.spots import STANDS
from ..clips.travel import Travel
from ..ground import Ground, heights_on
from ..mocap import constraints, kinematics
from ..mocap.links import NONE, LimbLinks
from ..runs import runs
from ..smoothing import bridged
from ..solve import detached
from ..solve.jacobian_ik import JacobianSettings
from .moved import Moved

NOTHING = 1e-6
"""Corrections of less than this share of the body's height are none."""
UP: Array = np.array([0.0, 0.0, 1.0])


def places(model: CharacterModel, frames: Frames, travel: Travel, positions: Array) -> Array:
    """Return where the feet of blended frames shall be [m], character frame, shape (frame, foot, 3).

    Args:
        model: The body of the clips.
        frames: One after the other.
        travel: Of the same frames.
        positions: Of its joints, as the frames have them, shape (frame, joint, 3).
    """
    out = positions[:, model.feet].copy()
    wandering = spots.in_world(frames.feet, travel)
    for foot in range(len(model.feet)):
        lacking, found = np.zeros((len(out), 2)), runs(frames.contacts[:, foot] > STANDS)
        for first, last in found:
            inside = slice(first, last + 1)
            spot = wandering[inside, foot, :2]
            lacking[inside] = spot.mean(axis=0) - spot
        out[:, foot, :2] += bridged(lacking, found)
        out[:, foot, 2] = wandering[:, foot, 2]
    return out


def plant(character: Character, root: int, moved: Moved, targets: Array, ground: Ground | None) -> Moved:
    """Return a motion with its feet at their places, on the ground that is there.

    Args:
        character: What moves.
        root: The body that carries all others.
        moved: What its bodies do.
        targets: Where its feet shall be on flat ground [m], shape (frame, foot, 3).
        ground: Terrain, character frame; flat when None, and where there is none.
    """
    rows = [i for i, leg in enumerate(character.legs) if len(leg.bones) > 1]
    legs = [character.legs[row] for row in rows]
    if not legs:
        return moved
    rest, standing = character.local_to_character.points(character.skeleton.rest_positions), moved.contacts > STANDS
    wanted = targets[:, rows]
    if ground is not None:
        rise = _terrain(wanted, standing[:, rows], ground)
        wanted = wanted + rise[..., None] * UP
        # The root follows the lower foot: bending a leg looks better than overstretching it.
        moved = replace(moved, positions=moved.positions + rise.min(axis=1)[:, None, None] * UP)
    if np.abs(wanted - moved.positions[:, [leg.end for leg in legs]]).max() < NOTHING * character.frame.height:
        return moved
    limbs = [_limb(character, leg, rest) for leg in legs]
    hips = moved.positions[:, [leg.bones[0] for leg in legs]]
    drop = constraints.hips_drop(limbs, hips, wanted, standing[:, rows], rest, 1.0 / RATE)
    moved = replace(moved, positions=moved.positions - drop[:, None, None] * UP)
    tree = detached.carried(character, root, frozenset())
    solved = constraints.enforce(
        limbs, moved.turns, moved.positions, wanted, rest, tree.parents, character.frame.height, JacobianSettings()
    )
    below = {body for leg in legs for body in tree.below(leg.bones[0])}
    placed = kinematics.place(moved.positions, rest, solved.turns, tree, np.array(sorted(below), dtype=np.intp))
    return replace(moved, turns=solved.turns, positions=placed)


def _terrain(feet: Array, standing: Flags, ground: Ground) -> Array:
    """Return the height of the ground under feet, interpolated in flight (Feng 2013 eqs 3 and 4) [m], (frame, foot)."""
    out = np.zeros(feet.shape[:2])
    for foot in range(feet.shape[1]):
        found = runs(standing[:, foot])
        heights = np.zeros((len(feet), 1))
        for first, last in found:
            middle = feet[first : last + 1, foot].mean(axis=0)
            heights[first : last + 1] = float(heights_on(ground, middle[None], 0.0)[0])
        out[:, foot] = bridged(heights, found)[:, 0]
    return out


def _limb(character: Character, leg: Limb, rest: Array) -> LimbLinks:
    """Return a leg as the constraints read it, bodies being links."""
    top, middle, bottom = rest[leg.bones[0]], rest[leg.bones[len(leg.bones) // 2]], rest[leg.end]
    line = quat.unit(bottom - top)
    off = middle - top - ((middle - top) @ line) * line
    x, y, z = (float(v) for v in (quat.unit(off) if off.any() else np.array([0.0, -1.0, 0.0])))
    return LimbLinks(character.skeleton.names[leg.end], tuple(leg.bones), NONE, (x, y, z))
