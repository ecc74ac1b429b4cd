"""How a character stands that is going to go: the goals of its gait, which are the same wherever it goes."""

import numpy as np

from ...core.character.character import Character
from ...core.ground import Ground
from ...core.locomotion import course, crawling, gait
from ...core.locomotion.course import Course
from ...core.locomotion.crawling import Movement
from ...core.locomotion.moving import Moving
from ...core.locomotion.settings import GaitSettings
from .properties import MORPHRETARGET_PG_gait


def of(character: Character, root: int, own: MORPHRETARGET_PG_gait) -> Moving:
    """Return the gait of a character that stays where it is.

    Args:
        character: What it is.
        root: The body that carries all others.
        own: Settings of its locomotion.

    Raises:
        MorphError: It cannot go in any way.
    """
    return prepare(character, root, STAYS, own.settings(), own.chosen_movement())


STAYS = course.from_speed(np.array([0.0, 1.0]), np.zeros(2), np.zeros(2))
"""The course of what goes nowhere."""


def prepare(
    character: Character,
    root: int,
    where: Course,
    settings: GaitSettings,
    movement: Movement | None,
    ground: Ground | None = None,
) -> Moving:
    """Return how a character goes along a course, on feet or without.

    Args:
        character: What it is.
        root: The body that carries all others.
        where: The course.
        settings: In what manner it steps.
        movement: What carries it; None for its feet, or for what suits it where it has none.
        ground: What it goes on; None for a flat one.

    Raises:
        MorphError: It cannot go in any way.
    """
    if movement is None and character.legs:
        return gait.prepare(character, root, where, settings, ground)
    return crawling.prepare(character, root, where, settings, ground, movement)
