"""What armature objects keep of their directing: a list of commands, and what these are understood with.

The list is kept in the order in which commands were given; whoever shows or reads it puts it in order of time. So no
command moves within it while its frame is dragged, and an override in another file can add to it.
"""

import contextlib
from collections.abc import Callable, Generator, Sequence
from enum import StrEnum
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from ...core.arrays import Array
from ...core.clips.commands.command import Command, Value, Verb
from ...core.clips.commands.parameters import Parameter
from ...core.errors import MotionError, listed
from ..locomotion.properties import Source
from ..morph.properties import unlike
from ..precision import plain
from ..sampling import seconds_per_frame
from . import known
from .known import TARGET

command_listeners: list[Callable[[bpy.types.ID], None]] = []
"""Called after a command, or what commands are understood with, has changed."""

_OVERRIDABLE: Any = {"LIBRARY_OVERRIDABLE"}
_OVERRIDABLE_LIST: Any = {"LIBRARY_OVERRIDABLE", "USE_INSERTION"}
OF_BONE = " : "
"""Between the name of an armature and that of its bone, in the name of a target."""


class Kind(StrEnum):
    """What a parameter holds."""

    NUMBER = "NUMBER"
    TEXT = "TEXT"
    SWITCH = "SWITCH"
    PLACE = "PLACE"
    TARGET = "TARGET"


_KINDS: Any = [
    (Kind.NUMBER.value, "Number", "A number, such as a speed"),
    (Kind.TEXT.value, "Text", "A word, such as a side or a style"),
    (Kind.SWITCH.value, "Switch", "Yes or no"),
    (Kind.PLACE.value, "Place", "A place in the world"),
    (Kind.TARGET.value, "Target", "An object, or a bone of an armature, wherever it is at the time"),
]
_VERBS: Any = [
    (Verb.START.value, "Start", "Begin it, or change what runs already", "PLAY", 0),
    (Verb.STOP.value, "Stop", "Finish it in a believable way: a foot in the air lands first", "PAUSE", 1),
    (Verb.RESET.value, "Reset", "Leave off at once", "LOOP_BACK", 2),
]


Target = tuple[bpy.types.Object, str]
"""An object and the name of its bone, or empty for the object itself."""

_together: list[bool] = []
"""Not empty while several settings are changed, of which is told once."""


def tell(own: Any, _: bpy.types.Context | None = None) -> None:
    """Tell that something about the commands has changed."""
    for listener in () if _together else command_listeners:
        listener(own.id_data)


@contextlib.contextmanager
def together(own: Any) -> Generator[None]:
    """Tell once of all that is changed meanwhile."""
    _together.append(True)
    try:
        yield
    finally:
        _together.pop()
    tell(own)


_SETTING: Any = {"options": set(), "override": _OVERRIDABLE, "update": tell}
"""Of what is the same for a whole clip: it cannot be keyed."""


def _owner(own: bpy.types.PropertyGroup) -> bpy.types.ID:
    assert own.id_data is not None, "settings belong to an object"
    return own.id_data


def _rig(own: bpy.types.PropertyGroup) -> Any:
    """Return all that is known about the armature that settings belong to."""
    return _owner(own).morph_retarget  # type: ignore[attr-defined]


def _models(own: "MORPHRETARGET_PG_command", _: bpy.types.Context, text: str) -> list[str]:
    """Return the names that are proposed for a model while it is typed."""
    names = known.models(_owner(own))
    return [name for name in names if text.lower() in name] or list(names)


def _parameters(own: "MORPHRETARGET_PG_parameter", _: bpy.types.Context, text: str) -> list[str]:
    """Return the names that are proposed for a parameter while it is typed."""
    names = known.parameters(_owner(own), own.command.model)
    return [name for name in names if text.lower() in name] or list(names)


def _choices(own: "MORPHRETARGET_PG_parameter", _: bpy.types.Context, text: str) -> list[str]:
    """Return the words that are proposed for a text while it is typed."""
    found = known.parameters(_owner(own), own.command.model).get(own.name)
    choices = () if found is None else found.choices
    return [choice for choice in choices if text.lower() in choice] or list(choices)


def _named(own: "MORPHRETARGET_PG_parameter", _: bpy.types.Context) -> None:
    """Let a parameter that was named hold what its model expects."""
    found = known.parameters(_owner(own), own.command.model).get(own.name)
    with together(own):
        if found is not None and kind_of(own.name, found) is not Kind(own.kind):
            own.fill(found.default)
            own.kind = kind_of(own.name, found).value


class MORPHRETARGET_PG_parameter(bpy.types.PropertyGroup):
    """One thing that is said about how a command is carried out."""

    name: StringProperty(
        name="Name", description="What is said", search=_parameters, options=set(), override=_OVERRIDABLE, update=_named
    )
    kind: EnumProperty(name="Kind", description="What it holds", items=_KINDS, **_SETTING)
    number: FloatProperty(name="Number", description="Value of a number", step=10, precision=3, **_SETTING)
    text: StringProperty(name="Text", description="Value of a text", search=_choices, **_SETTING)
    switch: BoolProperty(name="Switch", description="Value of a switch", **_SETTING)
    place: FloatVectorProperty(
        name="Place", description="A place in the world", size=3, subtype="TRANSLATION", precision=3, **_SETTING
    )
    target: PointerProperty(type=bpy.types.Object, name="Target", description="Object that is meant", **_SETTING)
    target_bone: StringProperty(name="Bone", description="Bone of the target; its origin when empty", **_SETTING)

    @property
    def command(self) -> "MORPHRETARGET_PG_command":
        """The command that it belongs to."""
        found = _owner(self).path_resolve(self.path_from_id().rpartition(".parameters[")[0])
        assert isinstance(found, MORPHRETARGET_PG_command), "parameters are parts of commands"
        return found

    @property
    def value(self) -> Value:
        """What it holds, as the core takes it; a target is told by its name."""
        match Kind(self.kind):
            case Kind.NUMBER:
                return plain(self.number)
            case Kind.TEXT:
                return self.text
            case Kind.SWITCH:
                return self.switch
            case Kind.PLACE:
                return tuple(plain(number) for number in self.place)
            case Kind.TARGET:
                return target_name(self.target, self.target_bone)

    def fill(self, value: object) -> None:
        """Hold a value: a number, a text, yes or no, two or three coordinates [m], an object or a pose bone.

        Raises:
            MotionError: It is none of these.
        """
        if isinstance(value, bool):
            self.kind, self.switch = Kind.SWITCH.value, value
        elif isinstance(value, int | float):
            self.kind, self.number = Kind.NUMBER.value, float(value)
        elif isinstance(value, str):
            self.kind, self.text = Kind.TEXT.value, value
        elif isinstance(value, bpy.types.Object):
            self.kind, self.target, self.target_bone = Kind.TARGET.value, value, ""
        elif isinstance(value, bpy.types.PoseBone):
            self.kind, self.target, self.target_bone = Kind.TARGET.value, value.id_data, value.name
        elif _is_place(value):
            place: Any = value
            self.kind, self.place = Kind.PLACE.value, (*place, 0.0)[:3]
        else:
            raise MotionError(
                f"parameter {self.name!r} cannot be {value!r}: give a number, a text, yes or no, a place or an object"
            )


def _is_place(value: Any) -> bool:
    if not isinstance(value, Sequence) and not hasattr(value, "__len__"):
        return False
    return len(value) in {2, 3} and all(isinstance(number, int | float) for number in value)


class MORPHRETARGET_PG_command(bpy.types.PropertyGroup):
    """One command: when it is given, and what shall be done."""

    frame: FloatProperty(
        name="Frame",
        description="Frame of the scene at which it is given",
        default=1.0,
        step=100,
        precision=1,
        **_SETTING,
    )
    verb: EnumProperty(name="Verb", description="What shall be done with the motion", items=_VERBS, **_SETTING)
    model: StringProperty(
        name="Model",
        description="Motion or behavior that is meant: walk, run, jump, wave, gaze, reach and others",
        default="walk",
        search=_models,
        **_SETTING,
    )
    parameters: CollectionProperty(
        type=MORPHRETARGET_PG_parameter,
        name="Parameters",
        description="How it shall be done; what is not said is as usual",
        override=_OVERRIDABLE_LIST,
    )
    mute: BoolProperty(name="Mute", description="Act as if this command were not there", **_SETTING)

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
            found = known.parameters(_owner(self), self.model).get(name)
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
        return Command(time, Verb(self.verb), self.model, values, f"frame {plain(self.frame):g}")


class MORPHRETARGET_PG_directing(bpy.types.PropertyGroup):
    """What a character is told to do."""

    commands: CollectionProperty(
        type=MORPHRETARGET_PG_command,
        name="Commands",
        description="What the character is told to do, and when",
        override=_OVERRIDABLE_LIST,
    )
    active_command: IntProperty(name="Active Command", description="Command that is shown below the list")
    library: StringProperty(
        name="Library",
        description="File of base motions that commands are carried out with; the starter library when empty",
        subtype="FILE_PATH",
        **(_SETTING | {"options": {"PATH_SUPPORTS_BLEND_RELATIVE"}}),
    )
    clips: StringProperty(
        name="Clips",
        description="Folder of clips (BVH, FBX, glTF, .blend) that a library is built from, "
        "beside the actions of selected armatures",
        subtype="DIR_PATH",
        options={"PATH_SUPPORTS_BLEND_RELATIVE"},
        override=_OVERRIDABLE,
    )
    obstacles: PointerProperty(
        type=bpy.types.Collection,
        name="Obstacles",
        description="Collection of the objects that the character goes around on its way to a target",
        **_SETTING,
    )

    @property
    def library_path(self) -> Path | None:
        """The file of the library, None for the starter library."""
        text = self.library.strip()
        return Path(bpy.path.abspath(text, library=_owner(self).library)) if text else None

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
        override=_OVERRIDABLE,
    )


def kind_of(name: str, parameter: Parameter) -> Kind:
    """Return what a parameter of a model holds; what is called a target is an object."""
    default = parameter.default
    if name == TARGET:
        return Kind.TARGET
    if isinstance(default, bool):
        return Kind.SWITCH
    if isinstance(default, int | float):
        return Kind.NUMBER
    return Kind.TEXT if isinstance(default, str) else Kind.PLACE


def target_name(ob: bpy.types.Object | None, bone: str) -> str:
    """Return the name of an object or of one of its bones in commands, empty for nothing."""
    return "" if ob is None else f"{ob.name}{OF_BONE}{bone}" if bone else ob.name


def found(name: object) -> bpy.types.Object | bpy.types.PoseBone | None:
    """Return the object or the bone that a name in a command means, None for none."""
    ob = bpy.data.objects.get(name) if isinstance(name, str) else None
    if ob is not None or not isinstance(name, str):
        return ob
    owner, _, bone = name.partition(OF_BONE)
    ob = bpy.data.objects.get(owner)
    return None if ob is None or ob.pose is None else ob.pose.bones.get(bone)


def told(value: Value) -> str:
    """Return a value in words."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, tuple):
        return "(" + ", ".join(f"{number:.3g}" for number in value) + ")"
    return value or "nothing" if isinstance(value, str) else f"{value:.4g}"


CLASSES = (MORPHRETARGET_PG_parameter, MORPHRETARGET_PG_command, MORPHRETARGET_PG_directing)
