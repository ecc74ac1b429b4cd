"""How a character stands that is going to go: the goals of its gait, which are the same wherever it goes."""

from functools import lru_cache

import numpy as np

from ...core.character.character import Character
from ...core.directing import director
from ...core.locomotion import course, getting_about
from ...core.locomotion.footless.crawling import Movement
from ...core.locomotion.moving import Moving
from ...core.locomotion.settings import GaitSettings
from .properties import MORPHRETARGET_PG_gait, Source

STAYS = course.from_speed(np.array([0.0, 1.0]), np.zeros(2), np.zeros(2))
"""The course of what goes nowhere."""


def of(character: Character, root: int, own: MORPHRETARGET_PG_gait) -> Moving:
    """Return the gait of a character that stays where it is.

    Args:
        character: What it is.
        root: The body that carries all others.
        own: Settings of its locomotion; a foot that stays flies along no path.

    Raises:
        MorphError: It cannot go in any way.
    """
    if own.source == Source.COMMANDS:
        return director.standing(character)
    return _staying(character, root, own.manner(), own.chosen_movement())


@lru_cache(maxsize=32)  # an edit asks first whether it has other goals, and then for the gait
def _staying(character: Character, root: int, settings: GaitSettings, movement: Movement | None) -> Moving:
    return getting_about.prepare(character, root, STAYS, settings, movement)
