"""How people stand to walk, whatever stance they rest in: feet under their hips, side by side, toes to the front.

Rigs that rest in a fighting stance, or with feet wide apart or turned out, would go on standing so at every step. Legs
stay as bent as they rest, so hips rise where feet come in from the sides; knees turn with the feet.
"""

from dataclasses import replace

import numpy as np

from ...arrays import Array
from ...character.character import Character
from . import legs
from .legs import LEVEL, Leg, Legs
from .sizes import Sizes

OUT = np.radians(10.0)
"""Feet that are turned further out or in than this are turned back to it."""
BACKWARD = np.radians(100.0)
"""Feet that point further out or in than this do not stand: who kneels rests on the toes."""
SPLAYED = 0.1
"""Feet stand no further outside their hips than this [leg lengths] …"""
STAGGERED = 0.05
"""… and no further before or behind the middle of a pair."""


def upright(character: Character, found: Legs) -> tuple[Legs, float]:
    """Return legs as their body stands to walk, and by how much it then is higher than at rest [m].

    Args:
        character: What the rig is; only people who stand at rest are moved.
        found: Its legs at rest.
    """
    if not character.humanoid or not found.legs or Sizes.of(found.legs, 1.0).lying.any():
        return found, 0.0
    homes = np.array([_home(leg, found.legs) for leg in found.legs])
    raised = float(np.min([_raised(leg, home) for leg, home in zip(found.legs, homes, strict=True)]))
    up = np.array([0.0, 0.0, raised])
    own = tuple(
        replace(leg, home=home, hip=leg.hip + up, turn=_turn(leg)) for leg, home in zip(found.legs, homes, strict=True)
    )
    return Legs(own, legs.grouped(own)), raised


def _home(leg: Leg, others: tuple[Leg, ...]) -> Array:
    """Return where the foot's joint stands to walk [m], shape (3,)."""
    pair = [other.home[1] for other in others if other.row == leg.row]
    middle, most = float(np.mean(pair)), STAGGERED * leg.length
    out = leg.home.copy()
    out[0] = leg.hip[0] + leg.side * min(leg.side * (leg.home[0] - leg.hip[0]), SPLAYED * leg.length)
    out[1] = middle + np.clip(leg.home[1] - middle, -most, most)
    return out


def _raised(leg: Leg, home: Array) -> float:
    """Return by how much the hip is higher over a foot that was moved, with the leg as long as at rest [m]."""
    reach, aside = np.linalg.norm(leg.home - leg.hip), np.linalg.norm((home - leg.hip) * LEVEL)
    return float(np.sqrt(max(reach**2 - aside**2, 0.0)) - (leg.hip - leg.home)[2])


def _turn(leg: Leg) -> float:
    """Return the turn of a foot about the vertical from rest [rad]."""
    out = leg.side * float(np.arctan2(leg.tip[0], -leg.tip[1])) if leg.tip[:2].any() else 0.0
    if abs(out) > BACKWARD:
        return 0.0
    return leg.side * (float(np.clip(out, -OUT, OUT)) - out)


def swivels(character: Character, found: Legs) -> dict[str, float]:
    """Return by how much legs swivel with their feet, by the names of these [degrees]; see `LimbSettings.swivel`."""
    names = character.skeleton.names
    return {names[leg.foot]: float(np.degrees(leg.side * leg.turn)) for leg in found.legs if leg.turn}
