"""What is said about how a command is carried out: numbers, words, places, and objects by their names."""

from collections.abc import Sequence
from enum import StrEnum
from typing import Any

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, FloatVectorProperty, PointerProperty, StringProperty

from ...core.clips.commands.command import Value
from ...core.clips.commands.parameters import Parameter
from ...core.errors import MotionError
from ..declaring import OVERRIDABLE, proposed
from ..precision import plain
from . import known
from .changes import SETTING, owner_of, together
from .known import TARGET

OF_BONE = " : "
"""Between the name of an armature and that of its bone, in the name of a target."""
Target = tuple[bpy.types.Object, str]
"""An object and the name of its bone, or empty for the object itself."""


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


def _parameters(own: "MORPHRETARGET_PG_parameter", _: bpy.types.Context, text: str) -> list[str]:
    """Return the names that are proposed for a parameter while it is typed."""
    return proposed(known.parameters(owner_of(own), own.model), text)


def _choices(own: "MORPHRETARGET_PG_parameter", _: bpy.types.Context, text: str) -> list[str]:
    """Return the words that are proposed for a text while it is typed."""
    found = known.parameters(owner_of(own), own.model).get(own.name)
    return [] if found is None else proposed(found.choices, text)


def _named(own: "MORPHRETARGET_PG_parameter", _: bpy.types.Context) -> None:
    """Let a parameter that was named hold what its model expects."""
    found = known.parameters(owner_of(own), own.model).get(own.name)
    with together(own):
        if found is not None and kind_of(own.name, found) is not Kind(own.kind):
            own.fill(found.default)
            own.kind = kind_of(own.name, found).value


class MORPHRETARGET_PG_parameter(bpy.types.PropertyGroup):
    """One thing that is said about how a command is carried out."""

    name: StringProperty(
        name="Name", description="What is said", search=_parameters, options=set(), override=OVERRIDABLE, update=_named
    )
    kind: EnumProperty(name="Kind", description="What it holds", items=_KINDS, **SETTING)
    number: FloatProperty(name="Number", description="Value of a number", step=10, precision=3, **SETTING)
    text: StringProperty(name="Text", description="Value of a text", search=_choices, **SETTING)
    switch: BoolProperty(name="Switch", description="Value of a switch", **SETTING)
    place: FloatVectorProperty(
        name="Place", description="A place in the world", size=3, subtype="TRANSLATION", precision=3, **SETTING
    )
    target: PointerProperty(type=bpy.types.Object, name="Target", description="Object that is meant", **SETTING)
    target_bone: StringProperty(name="Bone", description="Bone of the target; its origin when empty", **SETTING)

    @property
    def model(self) -> str:
        """Whom the command addresses that it belongs to."""
        command: Any = owner_of(self).path_resolve(self.path_from_id().rpartition(".parameters[")[0])
        return command.model

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
