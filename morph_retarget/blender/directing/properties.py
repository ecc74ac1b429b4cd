"""What armature objects keep of their directing: a list of commands, and what these are understood with.

The list is kept in the order in which commands were given; whoever shows or reads it puts it in order of time. So no
command moves within it while its frame is dragged, and an override in another file can add to it.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from ...core.arrays import Array
from ...core.clips.commands.command import Command, Verb
from ...core.errors import MotionError, listed
from ..declaring import OVERRIDABLE, OVERRIDABLE_LIST, proposed
from ..locomotion.properties import Source
from ..morph.properties import unlike
from ..precision import plain
from ..sampling import seconds_per_frame
from . import known
from .changes import SETTING, owner_of, tell, together
from .parameters import Kind, MORPHRETARGET_PG_parameter, Target, kind_of, target_name, told

_VERBS: Any = [
    (Verb.START.value, "Start", "Begin it, or change what runs already", "PLAY", 0),
    (Verb.STOP.value, "Stop", "Finish it in a believable way: a foot in the air lands first", "PAUSE", 1),
    (Verb.RESET.value, "Reset", "Leave off at once", "LOOP_BACK", 2),
]


def _rig(own: bpy.types.PropertyGroup) -> Any:
    """Return all that is known about the armature that settings belong to."""
    return owner_of(own).morph_retarget  # type: ignore[attr-defined]


def _models(own: "MORPHRETARGET_PG_command", _: bpy.types.Context, text: str) -> list[str]:
    """Return the names that are proposed for a model while it is typed."""
    return proposed(known.models(owner_of(own)), text)


class MORPHRETARGET_PG_command(bpy.types.PropertyGroup):
    """One command: when it is given, and what shall be done."""

    frame: FloatProperty(
        name="Frame",
        description="Frame of the scene at which it is given",
        default=1.0,
        step=100,
        precision=1,
        **SETTING,
    )
    verb: EnumProperty(name="Verb", description="What shall be done with the motion", items=_VERBS, **SETTING)
    model: StringProperty(
        name="Model",
        description="Motion or behavior that is meant: walk, run, jump, wave, gaze, reach and others",
        default="walk",
        search=_models,
        **SETTING,
    )
    parameters: CollectionProperty(
        type=MORPHRETARGET_PG_parameter,
        name="Parameters",
        description="How it shall be done; what is not said is as usual",
        override=OVERRIDABLE_LIST,
    )
    mute: BoolProperty(name="Mute", description="Act as if this command were not there", **SETTING)
    origin: StringProperty(
        name="Origin",
        description="Script and line that it was read from; empty for one that was given here",
        options={"HIDDEN"},
        override=OVERRIDABLE,
    )

    def set(self, name: str, value: object) -> MORPHRETARGET_PG_parameter:
        """Return a parameter that now has a value, made if it was not there.

        Raises:
            MotionError: A parameter cannot hold the value.
        """
        with together(self):
            item = self.parameters.get(name)
            if item is None:
                item = self.parameters.add()
                item.name = name
            item.fill(value)
        return item

    def expect(self, name: str) -> MORPHRETARGET_PG_parameter:
        """Return a new parameter, which holds what is usual where that is known."""
        with together(self):
            found = known.parameters(owner_of(self), self.model).get(name)
            name = unlike(name, [item.name for item in self.parameters])
            item = self.parameters.add()
            item.name = name
            if found is not None:
                item.fill(found.default)
                item.kind = kind_of(name, found).value
        return item

    def remove(self, name: str) -> None:
        """Take a parameter away.

        Raises:
            MotionError: There is none of that name.
        """
        place = self.parameters.find(name)
        if place < 0:
            names = listed([item.name for item in self.parameters])
            raise MotionError(f"{self.words!r} has no parameter {name!r}: choose one of {names or 'none'}")
        self.parameters.remove(place)
        tell(self)

    @property
    def words(self) -> str:
        """It in short."""
        return f"{self.verb} {self.model}"

    @property
    def how(self) -> str:
        """Its parameters in short."""
        return ", ".join(f"{item.name} {told(item.value)}" for item in self.parameters)

    def read(self, time: float) -> Command:
        """Return it as the core takes it, given at a time [s]."""
        values = {item.name: item.value for item in self.parameters}
        here = f"frame {plain(self.frame):g}"
        origin = f"{self.origin} ({here})" if self.origin else here
        return Command(time, Verb(self.verb), self.model, values, origin)


class MORPHRETARGET_PG_directing(bpy.types.PropertyGroup):
    """What a character is told to do."""

    commands: CollectionProperty(
        type=MORPHRETARGET_PG_command,
        name="Commands",
        description="What the character is told to do, and when",
        override=OVERRIDABLE_LIST,
    )
    active_command: IntProperty(name="Active Command", description="Command that is shown below the list")
    library: StringProperty(
        name="Library",
        description="File of base motions that commands are carried out with; the starter library when empty",
        subtype="FILE_PATH",
        **(SETTING | {"options": {"PATH_SUPPORTS_BLEND_RELATIVE"}}),
    )
    clips: StringProperty(
        name="Clips",
        description="Folder of clips (BVH, FBX, glTF, .blend) that a library is built from, "
        "beside the actions of selected armatures",
        subtype="DIR_PATH",
        options={"PATH_SUPPORTS_BLEND_RELATIVE"},
        override=OVERRIDABLE,
    )
    obstacles: PointerProperty(
        type=bpy.types.Collection,
        name="Obstacles",
        description="Collection of the objects that the character goes around on its way to a target",
        **SETTING,
    )

    @property
    def library_path(self) -> Path | None:
        """The file of the library, None for the starter library."""
        text = self.library.strip()
        return Path(bpy.path.abspath(text, library=owner_of(self).library)) if text else None

    @property
    def enabled(self) -> bool:
        """Whether the character does what it is told."""
        gait = _rig(self).gait
        return gait.enabled and gait.source == Source.COMMANDS

    def command(self, frame: float, verb: str, model: str, /, **parameters: object) -> MORPHRETARGET_PG_command:
        """Return a new command.

        Args:
            frame: Of the scene, at which it is given.
            verb: ``start``, ``stop`` or ``reset``.
            model: Name of the motion or behaviour.
            parameters: Numbers, texts, yes or no, places in the world [m], objects or pose bones.

        Raises:
            MotionError: There is no such verb, or a parameter cannot hold its value.
        """
        if verb not in [known.value for known in Verb]:
            raise MotionError(f"there is no verb {verb!r}: choose one of {listed(Verb)}")
        with together(self):
            # Overrides find what was added by its name.
            name = unlike("Command", [item.name for item in self.commands])
            item = self.commands.add()
            item.name = name
            try:
                item.frame, item.verb, item.model = frame, verb, model
                for name, value in parameters.items():
                    item.set(name, value)
            except MotionError:
                self.commands.remove(len(self.commands) - 1)
                raise
            self.active_command = len(self.commands) - 1
        return item

    def remove(self, place: int) -> None:
        """Remove a command."""
        self.commands.remove(place)
        self.active_command = min(place, len(self.commands) - 1)
        tell(self)

    def clear(self) -> None:
        """Remove all commands."""
        self.commands.clear()
        self.active_command = 0
        tell(self)

    @property
    def order(self) -> list[int]:
        """Places of the commands in order of time; those of the same frame as they were given."""
        return sorted(range(len(self.commands)), key=lambda place: self.commands[place].frame)

    def commands_of(self, scene: bpy.types.Scene) -> list[Command]:
        """Return the commands of the list as the core takes them, in order of time, without those that are muted."""
        return self.commands_at(lambda frames: frames * seconds_per_frame(scene))

    def commands_at(self, times: Callable[[Array], Array]) -> list[Command]:
        """Return the same; ``times`` gives the times [s] of frames of the scene."""
        heard = [self.commands[place] for place in self.order if not self.commands[place].mute]
        frames = np.array([plain(item.frame) for item in heard])
        return [item.read(time) for item, time in zip(heard, times(frames).tolist(), strict=True)]

    @property
    def targets(self) -> dict[str, Target]:
        """Objects and bones that the commands name, by the names that they have in them."""
        items = [item for command in self.commands if not command.mute for item in command.parameters]
        pairs = [(item.target, item.target_bone) for item in items if item.kind == Kind.TARGET]
        return {target_name(ob, bone): (ob, bone) for ob, bone in pairs if ob is not None}


class Directed:
    """What a character has for its directing; part of the rig's own group."""

    directing: PointerProperty(
        type=MORPHRETARGET_PG_directing,
        name="Directing",
        description="What this character is told to do",
        override=OVERRIDABLE,
    )


CLASSES = (MORPHRETARGET_PG_parameter, MORPHRETARGET_PG_command, MORPHRETARGET_PG_directing)
