"""Directed characters as those that go are: prepared for a whole clip, live and when they are baked."""

from collections.abc import Mapping, Sequence

import bpy

from ...core.arrays import Array
from ...core.character.character import Character
from ...core.clips.commands.command import Command
from ...core.clips.models.performance import Performance
from ...core.directing import director
from ...core.directing.director import Directed, Directions
from ...core.solve.settings import SolverSettings
from ..locomotion import walks
from ..locomotion.going import Clock, Going
from ..locomotion.guides import Asked, Guide
from ..locomotion.properties import Source
from ..locomotion.walk import Walk
from ..morph.member import Member
from . import libraries, orders, reading
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


def performance_of(member: Member, scene: bpy.types.Scene) -> Performance | None:
    """Return what a character does, None if nothing leads it or stepping through frames alone can tell."""
    walks.number(member, scene, bpy.context.evaluated_depsgraph_get())
    known = performance_known(member.rig.object, scene)
    return None if known is None else known[0]


def performance_known(ob: bpy.types.Object, scene: bpy.types.Scene) -> tuple[Performance, Clock] | None:
    """Return what a character was found to do when it was last shown, with its clock; None before that."""
    walk = walks.known(ob, scene)
    if walk is None or not isinstance(walk.gait, Directed) or walk.gait.performance is None:
        return None
    return walk.gait.performance, walk.clock


def _models(commands: Sequence[Command]) -> tuple[str, ...]:
    """Return whom commands address, in the order of their names."""
    return tuple(sorted({command.model for command in commands}))


def _asked(member: Member, own: Going, graph: bpy.types.Depsgraph, targets: Mapping[str, Array] | None = None) -> Asked:
    ob, character = member.rig.object, member.character
    told = reading.read(ob, own.clock, graph, own.from_world, character.frame.height, targets)
    return (own.key, told.key, member.solver), lambda: walk_of(character, own, told, member.solver)


GUIDE = Guide(Source.COMMANDS, _asked, orders.marked, reading.watched, reading.reasons_to_step, reading.places_now)
"""Leads those that do what they are told."""
