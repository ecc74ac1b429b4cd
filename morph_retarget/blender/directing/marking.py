"""Commands as pose markers: an animator drags them along the time line of the Action editor.

A marker of a character's action whose name reads as a command ("start walk speed=1.2") is one, beside those of the
list; every other marker is an event (`morph.events`). Each command lives in one place, list or marker, so nothing has
to be kept equal, and undo, renders and linked files need no care. Characters that share an action share its markers.
"""

from collections.abc import Callable

import bpy

from ...core.clips.commands import line
from ...core.clips.commands.command import Command, Verb
from ...core.errors import MotionError, RigError
from ..morph import events
from .changes import together
from .known import TARGET
from .parameters import found
from .properties import MORPHRETARGET_PG_directing

LONGEST = 63
"""Letters of a marker's name that Blender keeps [bytes]."""
_VERBS = frozenset(verb.value for verb in Verb)


def is_command(name: str) -> bool:
    """Return whether the name of a marker is meant as a command."""
    words = name.split(maxsplit=1)
    return len(words) > 0 and words[0].lower() in _VERBS


def read(action: bpy.types.Action, time: Callable[[float], float]) -> tuple[list[Command], list[str]]:
    """Return the commands among an action's markers in order of time, and what is wrong with the others.

    Args:
        action: The action.
        time: Returns the time of one of its frames [s].
    """
    commands: list[Command] = []
    warnings: list[str] = []
    for name, frame in events.markers_of(action):
        if is_command(name):
            origin = f"marker at frame {frame} of {action.name!r}"
            try:
                commands.append(Command(time(frame), *line.parse(name), origin))
            except MotionError as error:
                warnings.append(f"{origin}: {error}")
    return commands, warnings


def to_markers(own: MORPHRETARGET_PG_directing, action: bpy.types.Action) -> int:
    """Move the commands of a list onto markers of an action, and return how many; those that are muted stay.

    Raises:
        RigError: The action is linked.
        MotionError: A command is too long for a marker.
    """
    _check(action)
    moved = [place for place in own.order if not own.commands[place].mute]
    texts: list[tuple[str, int]] = []
    for place in moved:
        item = own.commands[place]
        values = {parameter.name: parameter.value for parameter in item.parameters}
        text = line.written(Verb(item.verb), item.model, values)
        if len(text.encode()) > LONGEST:
            raise MotionError(f"{text!r} is too long for the name of a marker: say less, or mute it so that it stays")
        texts.append((text, round(item.frame)))
    with together(own):
        for text, frame in texts:
            action.pose_markers.new(text).frame = frame
        for place in sorted(moved, reverse=True):
            own.commands.remove(place)
    return len(moved)


def to_list(own: MORPHRETARGET_PG_directing, action: bpy.types.Action) -> int:
    """Move the commands among an action's markers to a list, and return how many.

    Raises:
        RigError: The action is linked.
        MotionError: A marker cannot be read; all stay where they are.
    """
    _check(action)
    markers = [marker for marker in action.pose_markers if is_command(marker.name)]
    read = [(marker.frame, *line.parse(marker.name)) for marker in markers]
    with together(own):
        for frame, verb, model, parameters in read:
            values = {name: found(value) or value if name == TARGET else value for name, value in parameters.items()}
            own.command(frame, verb, model, **values)
        for marker in markers:
            action.pose_markers.remove(marker)
    return len(markers)


def _check(action: bpy.types.Action) -> None:
    if action.library is not None:
        raise RigError(f"action {action.name!r} is linked from {action.library.filepath}: make it local first")
