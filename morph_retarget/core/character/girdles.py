"""Girdles: bones at the start of arms that lie in the trunk, as collar bones do. Arms swing about where these end."""

import numpy as np

from ..arrays import Array
from .character import Character
from .morphology import Limb, LimbKind

BONES = 4
"""An arm with a girdle has at least so many: that, upper arm, forearm and hand."""
INNER = 0.5
"""A girdle starts nearer to the middle than this share of how far from it it ends …"""
SHORT = 0.45
"""… and is no longer than this share of its arm."""


def find(character: Character, rest: Array) -> frozenset[int]:
    """Return the girdles of a character: what is known as shoulders, and what lies like one where nothing is known.

    Args:
        character: What the rig is.
        rest: Rest positions of all bones [m], character frame, shape (bone, 3).
    """
    known = {character.bone("leftShoulder"), character.bone("rightShoulder")}
    arms = [limb for limb in character.limbs if limb.kind is LimbKind.ARM]
    seen = {limb.bones[0] for limb in arms if known.isdisjoint(limb.bones) and _starts_in_trunk(limb, rest)}
    return frozenset(bone for bone in (*known, *seen) if bone is not None)


def _starts_in_trunk(arm: Limb, rest: Array) -> bool:
    if len(arm.bones) < BONES:
        return False
    line = rest[list(arm.bones)]
    lengths = np.linalg.norm(np.diff(line, axis=0), axis=-1)
    is_short = bool(lengths[0] <= SHORT * lengths.sum())
    return is_short and arm.side != 0 and 0.0 <= arm.side * float(line[0, 0]) < INNER * arm.side * float(line[1, 0])
