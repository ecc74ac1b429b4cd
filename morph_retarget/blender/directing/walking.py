"""Directed characters as those that go are: prepared for a whole clip, live and when they are baked."""

from collections.abc import Sequence

from ...core.character.character import Character
from ...core.clips.commands.command import Command
from ...core.directing import director
from ...core.directing.director import Directions
from ...core.solve.settings import SolverSettings
from ..locomotion.going import Going
from ..locomotion.walk import Walk
from . import libraries
from .reading import Briefing


def walk_of(character: Character, own: Going, told: Briefing, solver: SolverSettings) -> Walk:
    """Return how a character does what it is told.

    Args:
        character: What it is.
        own: Where it sets out, and when.
        told: What it is told.
        solver: Settings of the solver.

    Raises:
        MorphError: Its library cannot be read, or is for no body like this.
    """
    clock = own.clock
    library = libraries.of(character, told.library, _models(told.commands))
    directions = Directions(
        told.commands, told.targets, own.ground(character.frame.height), told.obstacles, solver, told.warnings
    )
    made = director.prepare(character, library, directions, float(clock.times(clock.frames)[-1]))
    return Walk(made, made.course, clock)


def _models(commands: Sequence[Command]) -> tuple[str, ...]:
    """Return whom commands address, in the order of their names."""
    return tuple(sorted({command.model for command in commands}))
