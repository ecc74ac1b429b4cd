"""All commands that a character is given, from its list and from the markers of its action, and whom they name."""

from collections.abc import Sequence

import bpy
import numpy as np

from ...core.arrays import Array
from ...core.clips.commands.command import Command
from ..locomotion.going import Clock
from ..morph import cast
from ..properties import of_rig
from . import marking
from .known import TARGET
from .parameters import Target, found


def commands_of(ob: bpy.types.Object, clock: Clock) -> tuple[list[Command], list[str]]:
    """Return the commands of a character's list and of its action's markers in order of time, and warnings.

    Places are those of the world.
    """
    own, action = of_rig(ob).directing, cast.action_of(ob)
    commands, warnings = own.commands_at(clock.times), list[str]()
    if action is not None:
        marked, warnings = marking.read(action, lambda frame: float(clock.times(_in_scene(clock, frame))))
        commands += marked
    return sorted(commands, key=lambda command: command.time), warnings


def marked(ob: bpy.types.Object) -> tuple[tuple[str, int], ...]:
    """Return the names and frames of markers that are commands to a character.

    Blender tells nobody when markers are dragged, so this is looked at with each frame.
    """
    action = cast.action_of(ob)
    markers = () if action is None else action.pose_markers
    return tuple([(marker.name, marker.frame) for marker in markers if marking.is_command(marker.name)])


def _in_scene(clock: Clock, frame: float) -> Array:
    """Return the frame of the scene at which a character is at a frame of its action, shape ()."""
    return np.asarray(clock.start + (frame - clock.start) / clock.rate)


def targets_of(ob: bpy.types.Object, commands: Sequence[Command] | None = None) -> dict[str, Target]:
    """Return the objects and bones that commands to a character name, by their names.

    Args:
        ob: The character.
        commands: All that it is told, where that is known.
    """
    out = of_rig(ob).directing.targets
    for command in commands_of(ob, Clock(0.0, 1.0, 1.0))[0] if commands is None else commands:
        name = command.parameters.get(TARGET)
        other = found(name)
        if isinstance(name, str) and name not in out and other is not None:
            out[name] = (other, "") if isinstance(other, bpy.types.Object) else (other.id_data, other.name)
    return out
