"""Getting about in any way: on feet where a character has them, and without where it has none."""

from ..character.character import Character
from ..ground import Ground
from ..solve.settings import SolverSettings
from .course import Course
from .footless import crawling
from .footless.crawling import Movement
from .moving import Moving
from .settings import GaitSettings
from .stepping import gait, posture
from .stepping.gait import Gait


def prepare(
    character: Character,
    root: int,
    course: Course,
    settings: GaitSettings,
    movement: Movement | None = None,
    ground: Ground | None = None,
) -> Moving:
    """Return how a character goes along a course.

    Args:
        character: What the rig is.
        root: The body that carries all others.
        course: Where it goes.
        settings: In what manner it steps.
        movement: What carries it; None for its feet, or for what suits it where it has none.
        ground: What it goes on, in the ground frame; None for a ground as high as the course.

    Raises:
        RigError: It cannot go like that.
        MotionError: The settings lead nowhere.
    """
    if movement is None and character.legs:
        return gait.prepare(character, root, course, settings, ground)
    return crawling.prepare(character, root, course, settings, ground, movement)


def tuned(settings: SolverSettings, moving: Moving) -> SolverSettings:
    """Return settings of the solver with which a body goes as it is meant to: knees turn with their feet.

    Args:
        settings: Of the character.
        moving: How it goes.
    """
    return settings.swivelled(posture.swivels(moving.character, moving.legs)) if isinstance(moving, Gait) else settings
