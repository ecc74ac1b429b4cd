"""Stances: a body as those imagine it who make actions, whatever its rest pose is.

Recipes were made on a human who holds the arms 40 degrees below the horizontal. Rigs rest with arms spread out, or
hanging; hands that shall meet at the chest would meet before the face of the one, and at the hips of the other.
"""

from dataclasses import replace

import numpy as np

from .. import quat
from ..arrays import Array
from ..character.character import Character
from ..character.morphology import Capability, LimbKind
from ..clips.character_model import CharacterModel
from ..morph.bodies import Bodies

LOWERED = np.radians(40.0)
"""How far below the horizontal arms were held by the human for whom recipes were made."""


def actor(model: CharacterModel) -> Bodies:
    """Return the bodies to which recipes are bound: arms held as usual, and the root where the body is carried.

    Only places that actions are relative to are changed. What the solver poses are the bodies as they rest.
    """
    own = Bodies.of(model.character)
    tags = [
        frozenset(tag - {Capability.ROOT} | ({Capability.ROOT} if body == model.root else set[Capability]()))
        for body, tag in enumerate(own.capabilities)
    ]
    return replace(own, positions=_arms_held(model.character, own.positions), capabilities=tags)


def _arms_held(character: Character, rest: Array) -> Array:
    """Return the places of all bodies with a human's arms turned about their shoulders, shape (body, 3)."""
    out = rest.copy()
    if not character.humanoid:
        return out
    for limb in character.limbs:
        top, elbow, end = (character.bone(name) for name in _arm(limb.side))
        if limb.kind is not LimbKind.ARM or top is None or elbow is None or top not in limb.bones:
            continue
        ways = quat.unit(rest[elbow] - rest[top])
        held = np.array([limb.side * np.cos(LOWERED), 0.0, -np.sin(LOWERED)])
        turn = quat.between(ways, held)
        # Twist bones and fingers go along; a hand that hangs elsewhere does as well.
        arm = {*character.skeleton.tree.below(top), *limb.bones[limb.bones.index(top) + 1 :], *limb.digits}
        moved = sorted(arm if end is None else {*arm, end})
        out[moved] = rest[top] + quat.rotate(np.broadcast_to(turn, (len(moved), 4)), rest[moved] - rest[top])
    return out


def _arm(side: int) -> tuple[str, str, str]:
    name = "left" if side > 0 else "right"
    return f"{name}UpperArm", f"{name}LowerArm", f"{name}Hand"
