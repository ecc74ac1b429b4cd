"""All that a directed character is told and what is around it, read from settings, markers and objects."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import bpy
import numpy as np

from ...core.arrays import Array
from ...core.clips.behaviours.reaching import GRASP
from ...core.clips.commands.command import Command, Value
from ...core.clips.commands.parameters import told
from ...core.clips.motions.library import Library
from ...core.clips.track import Track
from ..locomotion.going import Clock
from ..morph import query, stage
from ..properties import of_rig
from . import libraries, obstacles, orders, tracking
from .known import TARGET
from .libraries import Stamp


@dataclass(frozen=True, eq=False)
class Briefing:
    """What a character is told, in the frame of the ground on which it sets out."""

    commands: tuple[Command, ...] = ()
    """In order of time, counted from frame 0 of the scene."""
    targets: Mapping[str, Track] = field(default_factory=dict[str, Track])
    """By the names that commands use."""
    obstacles: tuple[Array, ...] = ()
    """What they cover of the ground, each shape (corner, 2) [m], convex and counter-clockwise."""
    library: Stamp | None = None
    """Tells its library from others; None for the starter library."""
    warnings: tuple[str, ...] = ()

    @cached_property
    def key(self) -> tuple[object, ...]:
        """Equal for what gives the same performance."""
        tracks = {
            name: (track.places.tobytes(), b"" if track.surface is None else track.surface.tobytes())
            for name, track in self.targets.items()
        }
        return self.commands, tracks, tuple(one.tobytes() for one in self.obstacles), self.library, self.warnings


def read(
    ob: bpy.types.Object,
    clock: Clock,
    graph: bpy.types.Depsgraph,
    from_world: Array,
    height: float,
    stepped: Mapping[str, Array] | None = None,
) -> Briefing:
    """Return what a character is told.

    Args:
        ob: The character.
        clock: Which frames are asked for.
        graph: Gives the targets and the obstacles.
        from_world: Leads from the world to the ground frame, shape (4, 4).
        height: Of the character, ground frame [m].
        stepped: What `places_now` says at each of the clock's frames, each shape (frame, 3), where that was asked.

    Raises:
        MotionError: A target can be known by stepping through the frames alone.
    """
    own = of_rig(ob).directing
    commands, warnings = orders.commands_of(ob, clock)
    meant = orders.targets_of(ob, commands)
    grasped = {command.parameters.get(TARGET) for command in commands if command.model == GRASP.name}
    tracks: dict[str, Track] = {}
    for name, target in meant.items():
        if target[0] == ob:
            warnings.append(f"{ob.name!r} cannot have itself for a target: choose another object than {name!r}")
            continue
        places = tracking.places(ob, target, clock.frames, graph) if stepped is None else stepped[name]
        held = name in grasped and not target[1]
        surface = tracking.surface_of(target[0], clock.first, graph) if held else None
        seen = None if surface is None else surface @ from_world[:3, :3].T
        tracks[name] = Track(clock.times(clock.frames)[: len(places)], _through(from_world, places), seen)
    for command in commands:
        name = command.parameters.get(TARGET)
        if isinstance(name, str) and name and name not in meant:
            warnings.append(told(command, f"there is no object {name!r}: choose another target"))
    around = own.obstacles
    covered = () if around is None else obstacles.outlines(around, clock.first, graph, from_world, height)
    placed = tuple(_on_ground(command, from_world) for command in commands)
    library = own.library_path
    known = None if library is None else libraries.stamp(library)
    return Briefing(placed, tracks, covered, known, tuple(warnings))


# --- targets ---


def reasons_to_step(ob: bpy.types.Object) -> tuple[str, ...]:
    """Return which targets of a character only stepping through frames can tell, empty for none."""
    meant = orders.targets_of(ob)
    others = {name: target for name, target in meant.items() if target[0] != ob}
    return tuple(f"target {name!r}" for name, target in others.items() if tracking.reason_to_step(ob, target))


def places_now(ob: bpy.types.Object, graph: bpy.types.Depsgraph) -> dict[str, Array]:
    """Return where the targets of a character are at the frame that is evaluated [m], world space, each shape (3,)."""
    meant = orders.targets_of(ob)
    return {name: stage.place_of(*target, graph) for name, target in meant.items() if target[0] != ob}


def watched(ob: bpy.types.Object) -> list[bpy.types.ID]:
    """Return what a directed character has to be directed anew for when it is edited."""
    out: list[bpy.types.ID] = []
    for who in (ob, *tracking.behind(ob)):
        own, gait = of_rig(who).directing, of_rig(who).gait
        around = own.obstacles
        near = [target for target, _ in orders.targets_of(who).values()]
        near += [] if around is None else list(around.all_objects)
        near += [] if who == ob else [one for one in (who, gait.path, gait.ground) if one is not None]
        for one in near:
            out += _moving(one, ob)
        out += [] if around is None else [around]
    return out


def _moving(one: bpy.types.Object, ob: bpy.types.Object) -> list[bpy.types.ID]:
    """Return an object with its data, what it hangs on, and the actions that move them; but for a character itself."""
    out: list[bpy.types.ID] = [] if one.data is None else [one.data]
    above: bpy.types.Object | None = one
    while above is not None and above != ob:
        out.append(above)
        if above.animation_data is not None and above.animation_data.action is not None:
            out.append(above.animation_data.action)
        above = above.parent
    return out


def library_now(ob: bpy.types.Object) -> Library | None:
    """Return the library of a character as far as it is known already; for panels, which must not make it."""
    member = query.member_now(ob)
    return None if member is None else libraries.kept(member.character, of_rig(ob).directing.library_path)


# --- places ---


def _on_ground(command: Command, from_world: Array) -> Command:
    """Return a command whose places are in the ground frame instead of the world."""
    values: dict[str, Value] = {name: _moved(value, from_world) for name, value in command.parameters.items()}
    return replace(command, parameters=values)


def _moved(value: Value, from_world: Array) -> Value:
    if not isinstance(value, tuple):
        return value
    point = _through(from_world, np.array([(*value, 0.0)[:3]], dtype=np.float64))[0]
    return tuple(point.tolist()[: len(value)])


def _through(matrix: Array, points: Array) -> Array:
    return points @ matrix[:3, :3].T + matrix[:3, 3]
