"""What armature objects keep of their locomotion: how fast and where they go, and in what manner they step."""

from dataclasses import replace
from enum import StrEnum
from math import pi
from typing import Any

import bpy
from bpy.props import BoolProperty, CollectionProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty

from ...core.locomotion.footless.crawling import Movement
from ...core.locomotion.patterns.styles import STYLES
from ...core.locomotion.settings import GaitSettings, Layers
from ..declaring import OVERRIDABLE, OVERRIDABLE_LIST, Listener, fixed, only, overridable, telling
from . import foot_path

course_listeners: list[Listener] = []
"""Called after a setting of where a character goes has changed."""
manner_listeners: list[Listener] = []
"""Called after a setting of how it goes there has changed."""
tell_course = telling(course_listeners)
"""Tells that a setting of where a character goes has changed."""
tell_manner = telling(manner_listeners)
"""Tells that a setting of how a character goes has changed."""
_COURSE = overridable(tell_course)
_MANNER = fixed(tell_manner)
"""Of settings that are the same for a whole clip."""

_DEFAULT = GaitSettings()
FASTEST = 100.0
"""Speeds are kept below this [m/s]."""
KEYED = ("speed", "turn_rate", "direction", "weight")
"""What may change over time; all else is the same for a whole clip."""


class Source(StrEnum):
    """What makes a character go."""

    SPEED = "SPEED"
    PATH = "PATH"
    OWN = "OWN"
    COMMANDS = "COMMANDS"


AUTO = "auto"
"""The way to get about that suits the character."""

STYLE_ITEMS: Any = [(name, style.title, style.description.removesuffix(".")) for name, style in STYLES.items()]
_SOURCES: Any = [
    (Source.SPEED.value, "Speed", "It goes from where it stands, by its speed, turn rate and direction"),
    (Source.PATH.value, "Path", "It goes along a curve by its speed"),
    (Source.OWN.value, "Own", "Its object is moved already: by keys, a constraint or what it hangs on"),
    (Source.COMMANDS.value, "Commands", "It does what its list of commands says: see Directing"),
]
_MOVEMENTS: Any = [
    (AUTO, "Automatic", "On its feet, or as its shape suggests where there are none"),
    (Movement.SERPENTINE.value, "Serpentine", "The body winds along one line, as snakes do"),
    (Movement.INCHWORM.value, "Inchworm", "The rear is drawn up, then the front goes on, as caterpillars do"),
    (Movement.FLOAT.value, "Float", "It hovers at the height at which it rests"),
]


def _number(name: str, description: str, default: float, **options: Any) -> Any:
    return FloatProperty(name=name, description=description, default=default, **(_COURSE | options))


def _factor(name: str, description: str, default: float, most: float = 1.0, soft: float = 1.0) -> Any:
    return _number(name, description, default, min=0.0, max=most, soft_max=soft, subtype="FACTOR", **_MANNER)


def _style(name: str, description: str) -> Any:
    return EnumProperty(name=name, description=description, items=STYLE_ITEMS, **_MANNER)


class MORPHRETARGET_PG_gait_layer(bpy.types.PropertyGroup):
    """A style that is layered on others."""

    style: _style("Style", "Manner of going that is mixed in")
    weight: _factor("Weight", "How much the style counts, the character's own counting as 1", 1.0, 10.0)
    group: IntProperty(
        name="Legs",
        description="Group of legs that goes in this style, 1 for the longest legs; 0 mixes it into that of all. "
        "Styles of a group take the place of those of all legs",
        min=0,
        max=99,
        soft_max=4,
        **_MANNER,
    )


class MORPHRETARGET_PG_gait(bpy.types.PropertyGroup):
    """How a character goes."""

    enabled: BoolProperty(
        name="Locomotion",
        description="Let legs, or the whole body where there are none, carry the character over the ground",
        **_MANNER,
    )
    style: _style("Style", "Manner of going; Auto goes from a walk to faster gaits with the speed")
    layers: CollectionProperty(
        type=MORPHRETARGET_PG_gait_layer,
        name="Further Styles",
        description="Styles that are mixed in, and styles of single groups of legs",
        override=OVERRIDABLE_LIST,
    )
    active_layer: IntProperty(name="Active", description="Style that the buttons beside the list act on")
    source: EnumProperty(
        name="Goes By",
        description="What makes the character go",
        items=_SOURCES,
        **_MANNER,
    )
    speed: _number(
        "Speed",
        "Way over the ground in a second; at 0 it stands. Key it to let the gait change with it",
        1.2,
        min=-FASTEST,
        max=FASTEST,
        soft_min=0.0,
        soft_max=6.0,
        step=10,
        unit="VELOCITY",
    )
    turn_rate: _number(
        "Turn Rate",
        "Angle by which it turns to its left in a second",
        0.0,
        min=-20.0 * pi,
        max=20.0 * pi,
        soft_min=-pi,
        soft_max=pi,
        step=100,
        subtype="ANGLE",
    )
    direction: _number(
        "Direction",
        "Where it goes as it sees it: ahead at 0, to its left at 90°, backward at 180°",
        0.0,
        min=-4.0 * pi,
        max=4.0 * pi,
        soft_min=-pi,
        soft_max=pi,
        step=100,
        subtype="ANGLE",
    )
    path: PointerProperty(
        type=bpy.types.Object,
        name="Path",
        description="Curve that it goes along, from its first point; round and round where it is cyclic. "
        "One that moves counts as it is at the first frame of the scene",
        poll=only("CURVE"),
        **_COURSE,
    )
    ground: PointerProperty(
        type=bpy.types.Object,
        name="Ground",
        description="Mesh that it goes on; a flat floor when empty",
        poll=only("MESH"),
        **_COURSE,
    )
    stride: _number(
        "Stride",
        "Length of the steps; shorter ones follow each other faster",
        _DEFAULT.stride,
        min=0.01,
        max=4.0,
        soft_max=2.0,
        subtype="FACTOR",
        **_MANNER,
    )
    step_height: _factor("Step Height", "How high feet are lifted", _DEFAULT.step_height, 10.0, 3.0)
    width: _factor(
        "Width", "How far to the side the feet are put down; at 0 they are on one line", _DEFAULT.width, 4.0, 2.0
    )
    crouch: _number(
        "Crouch",
        "How much the hips are lowered, as a share of the legs' length",
        _DEFAULT.crouch,
        min=-0.2,
        max=0.9,
        soft_min=0.0,
        soft_max=0.5,
        precision=3,
        **_MANNER,
    )
    body: _factor("Body", "How much hips and spine move with the steps", _DEFAULT.body, 4.0, 2.0)
    arms: _factor("Arms", "How much of the arms is the gait's; at 0 they are left alone", _DEFAULT.arms)
    foot_roll: _factor("Foot Roll", "How far feet roll over heel and ball", _DEFAULT.foot_roll, 2.0, 1.5)
    tilt: _factor("Tilt", "How much feet and body tilt with the slope of the ground", _DEFAULT.tilt)
    weight: _number(
        "Weight",
        "How much of what the legs and the body do is the gait's; can be keyed",
        1.0,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
    )
    foot_path: PointerProperty(
        type=bpy.types.Object,
        name="Foot Path",
        description="Empty whose keys from frame 0 to 100 are the flight of a foot: Y location the share of its way, "
        "Z its height as a share of the style's, X outward in leg lengths, X rotation the toes downward",
        poll=only("EMPTY"),
        **overridable(tell_manner),
    )
    movement: EnumProperty(
        name="Movement",
        description="What carries the character: its feet, or its body",
        items=_MOVEMENTS,
        **_MANNER,
    )

    def settings(self) -> GaitSettings:
        """Return the manner of stepping as the core takes it.

        Raises:
            MotionError: The foot path cannot be read.
        """
        plain = self.manner()
        return plain if self.foot_path is None else replace(plain, path=foot_path.of(self.foot_path))

    def manner(self) -> GaitSettings:
        """Return the same without the foot path. Blender keeps fewer digits, so that 0.98 would be another."""
        groups: dict[int, Layers] = {}
        for item in self.layers:
            groups[item.group] = (*groups.get(item.group, ()), (item.style, round(item.weight, 6)))
        factors = ("stride", "step_height", "width", "crouch", "body", "arms", "foot_roll", "tilt")
        return GaitSettings(
            styles=((self.style, 1.0), *groups.pop(0, ())),
            of_group={group - 1: layers for group, layers in groups.items()},
            **{name: round(getattr(self, name), 6) for name in factors},
        )

    def chosen_movement(self) -> Movement | None:
        """Return how it shall get about, None for what suits it."""
        return None if self.movement == AUTO else Movement(self.movement)

    def add(self, style: str, group: int = 0) -> MORPHRETARGET_PG_gait_layer:
        """Return a new layer."""
        item = self.layers.add()
        item.style, item.group = style, group
        self.active_layer = len(self.layers) - 1
        tell_manner(self)
        return item

    def remove(self, place: int) -> None:
        """Remove a layer."""
        self.layers.remove(place)
        self.active_layer = min(place, len(self.layers) - 1)
        tell_manner(self)


class Walker:
    """What a character has for its locomotion; part of the rig's own group."""

    gait: PointerProperty(
        type=MORPHRETARGET_PG_gait,
        name="Locomotion",
        description="How this character goes over the ground",
        override=OVERRIDABLE,
    )


CLASSES = (MORPHRETARGET_PG_gait_layer, MORPHRETARGET_PG_gait)
