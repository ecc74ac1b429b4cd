"""What actions keep to be generalized ones: definitions of channels, and the characters they are for."""

from collections.abc import Callable
from enum import StrEnum
from typing import Any

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from ...core.character.morphology import Capability
from ...core.morph.branch import Answer
from ...core.morph.channels import MirrorRule, SideConstraint, TargetKind
from ...core.morph.context import Depth, Extent, Height, LimbModifier, Side, Space
from ...core.morph.movement import PositionMode, RotationMode, ScaleMode
from ..declaring import Listener, telling
from ..directing import annotations
from ..directing.annotations import Annotated

definition_listeners: list[Listener] = []
"""Called after a definition on an action has changed."""
_defined = telling(definition_listeners)
movement_listeners: list[Callable[["MORPHRETARGET_PG_channel"], None]] = []
"""Called before those, after a movement mode of a channel has changed."""
name_listeners: list[Callable[["MORPHRETARGET_PG_channel", str], None]] = []
"""Called after a channel was renamed, with its old name."""


def _moved(own: "MORPHRETARGET_PG_channel", context: bpy.types.Context) -> None:
    for listener in movement_listeners:
        listener(own)
    _defined(own, context)


def _named(own: "MORPHRETARGET_PG_channel", context: bpy.types.Context) -> None:
    """Keep names unlike each other, and let everything that knows a channel by its name follow."""
    others = [c.name for c in of_action(own.id_data).channels if c != own]
    name = unlike(own.name or "Channel", others)
    if name != own.name:
        own.name = name  # comes back here
        return
    old, own.known_as = own.known_as, own.name
    if old and old != own.name:
        for listener in name_listeners:
            listener(own, old)
    _defined(own, context)


def unlike(name: str, taken: list[str]) -> str:
    """Return ``name`` with a number behind it if it is taken, in Blender's manner."""
    stem, number = name, 0
    while name in taken:
        number += 1
        name = f"{stem}.{number:03}"
    return name


def _items(kinds: type[StrEnum], words: dict[Any, tuple[str, str]]) -> Any:
    return [(kind.value, *words[kind]) for kind in kinds]


_CAPABILITIES: Any = [
    (c.value, c.value.title(), f"Bodies that are {words}")
    for c, words in {
        Capability.ROOT: "the root that carries all others",
        Capability.SPINE: "segments of the spine",
        Capability.NECK: "segments of the neck",
        Capability.HEAD: "heads",
        Capability.MOUTH: "mouths",
        Capability.EYE: "eyes",
        Capability.EAR: "ears",
        Capability.GRASPER: "graspers: hands, or what takes things in their place",
        Capability.FOOT: "feet",
        Capability.LIMB: "segments of legs and arms",
        Capability.TAIL: "segments of tails",
        Capability.WING: "segments of wings",
        Capability.FIN: "segments of fins",
        Capability.FINGER: "segments of fingers",
    }.items()
]
_SPACES = _items(
    Space,
    {
        Space.BOUNDS: ("Character", "Zones divide the whole character"),
        Space.SETSPACE: ("Setspace", "Zones divide the bodies that have the capability"),
    },
)


def _zones(kinds: type[StrEnum]) -> Any:
    return [
        (
            kind.value,
            kind.value.title(),
            "Wherever they are" if kind.value == "any" else f"The {kind.value}; halves include the center zone",
        )
        for kind in kinds
    ]


class MORPHRETARGET_PG_context(bpy.types.PropertyGroup):
    """A query for bodies; its constraints intersect."""

    capability: EnumProperty(
        name="Type", description="What the bodies can do", items=_CAPABILITIES, default="grasper", update=_defined
    )
    depth: EnumProperty(name="Front/Back", description="Zone from front to back", items=_zones(Depth), update=_defined)
    side: EnumProperty(
        name="Left/Right",
        description="Zone from its left to its right",
        items=_zones(Side),
        update=_defined,
    )
    height: EnumProperty(
        name="Top/Bottom", description="Zone from top to bottom", items=_zones(Height), update=_defined
    )
    depth_space: EnumProperty(name="Of", description="What front and back divide", items=_SPACES, update=_defined)
    side_space: EnumProperty(name="Of", description="What left and right divide", items=_SPACES, update=_defined)
    height_space: EnumProperty(name="Of", description="What top and bottom divide", items=_SPACES, update=_defined)
    extent: EnumProperty(
        name="Extent",
        description="Only the one body that lies farthest",
        items=[
            (
                e.value,
                "All" if e is Extent.NONE else e.value.replace("_", "").title(),
                "The bodies that are left over"
                if e is Extent.NONE
                else f"The one farthest to the {e.value.removesuffix('_most')}",
            )
            for e in Extent
        ],
        update=_defined,
    )
    modifier: EnumProperty(
        name="Limb",
        description="What the found bodies are exchanged for",
        items=_items(
            LimbModifier,
            {
                LimbModifier.NONE: ("As Found", "The bodies themselves"),
                LimbModifier.SPINE_SEGMENT: ("Spine Segment", "What carries their limbs: the first spine body above"),
            },
        ),
        update=_defined,
    )


class MORPHRETARGET_PG_channel(bpy.types.PropertyGroup):
    """A channel of a generalized action; its keyed values are on the characters, under the same name."""

    name: StringProperty(name="Name", description="Name of the channel, in the Graph Editor too", update=_named)
    known_as: StringProperty(name="Known As", description="Name before the last change", options={"HIDDEN"})
    keyed_in: StringProperty(
        name="Keyed In", description="Movement modes that the stored keys are meant in", options={"HIDDEN"}
    )
    context: PointerProperty(
        type=MORPHRETARGET_PG_context, name="Context", description="Which bodies the channel poses"
    )
    secondary: PointerProperty(
        type=MORPHRETARGET_PG_context, name="Secondary Context", description="Which bodies are its target"
    )
    position: EnumProperty(
        name="Position",
        description="What positions are measured from",
        items=_items(
            PositionMode,
            {
                PositionMode.REST_RELATIVE: ("Rest Relative", "From each body's own rest position"),
                PositionMode.ABSOLUTE: (
                    "Absolute",
                    "The same place on all characters; the rest pose of one is then not that of the others",
                ),
            },
        ),
        update=_moved,
    )
    rotation: EnumProperty(
        name="Rotation",
        description="What rotations are measured from",
        items=_items(
            RotationMode,
            {
                RotationMode.REST_RELATIVE: ("Rest Relative", "From each body's own rest orientation"),
                RotationMode.ABSOLUTE: (
                    "Absolute",
                    "The same orientation on all characters, as for a palm that points up; "
                    "the rest pose of one is then not that of the others",
                ),
            },
        ),
        update=_moved,
    )
    scale: EnumProperty(
        name="Scale",
        description="What positions are scaled by",
        items=_items(
            ScaleMode,
            {
                ScaleMode.NONE: ("None", "The same distance on all characters"),
                ScaleMode.CREATURE_SIZE: ("Creature Size", "By the width, depth and height of the character"),
                ScaleMode.LIMB_LENGTH: ("Limb Length", "By the way from the body to the nearest spine segment"),
            },
        ),
        update=_moved,
    )
    ground_relative: BoolProperty(
        name="Ground Relative", description="Z is 0 at rest and 1 at the ground", update=_moved
    )
    sagittal_relative: BoolProperty(
        name="Sagittal Relative",
        description="X is 0 at rest and 1 on the plane of symmetry, so that claps meet",
        update=_moved,
    )
    secondary_relative: BoolProperty(
        name="Secondary Relative",
        description="X leads from the rest position to the target: 0 at rest, 1 at the target",
        update=_moved,
    )
    directional_only: BoolProperty(
        name="Directional Only",
        description="Turn with the target and keep the size of the movement, as for a punch",
        update=_moved,
    )
    look_at: BoolProperty(
        name="Look At",
        description="Rotations are added to looking at the target; no rotation means looking at it, not the rest pose",
        update=_moved,
    )
    target: EnumProperty(
        name="Target",
        description="What the movement is relative to",
        items=_items(
            TargetKind,
            {
                TargetKind.NONE: ("None", "There is no target"),
                TargetKind.CONTEXT: ("Own Bodies", "The nearest body that the secondary context selects"),
                TargetKind.EXTERNAL: ("External", "An object or bone, chosen for each character"),
            },
        ),
        update=_moved,
    )
    poses_position: BoolProperty(
        name="Position", description="The channel places its bodies", default=True, update=_defined
    )
    poses_rotation: BoolProperty(
        name="Rotation", description="The channel turns its bodies", default=True, update=_defined
    )
    position_weight: FloatProperty(
        name="Position Weight",
        description="Share of the channel in positions, times its keyed weight",
        default=1.0,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        update=_defined,
    )
    rotation_weight: FloatProperty(
        name="Rotation Weight",
        description="Share of the channel in rotations, times its keyed weight",
        default=1.0,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        update=_defined,
    )
    priority: IntProperty(
        name="Priority",
        description="Channels of higher priority take bodies first; of equal ones, the upper in the list",
        update=_defined,
    )
    blend_group: StringProperty(
        name="Blend Group",
        description="Channels with the same name here share the bodies that both select; empty shares with none",
        update=_defined,
    )
    varies: BoolProperty(
        name="Single Body",
        description="Play on one of the selected bodies at a time; each is a variant of the action",
        update=_defined,
    )
    variant_group: StringProperty(
        name="Variant Group",
        description="Channels with the same name here change their bodies together; empty varies alone",
        update=_defined,
    )
    variant_side: EnumProperty(
        name="Side",
        description="Where the body is, compared with that of the first channel that varies",
        items=_items(
            SideConstraint,
            {
                SideConstraint.ANY: ("Any", "On any side"),
                SideConstraint.SAME: ("Same", "On the same side"),
                SideConstraint.OPPOSITE: ("Opposite", "On the other side"),
            },
        ),
        update=_defined,
    )
    mirror: EnumProperty(
        name="Mirror",
        description="Which bodies move as the mirror image of what is keyed",
        items=_items(
            MirrorRule,
            {
                MirrorRule.NEVER: ("Never", "None"),
                MirrorRule.LEFT: ("Keyed for Left", "Those on the right side"),
                MirrorRule.RIGHT: ("Keyed for Right", "Those on the left side"),
                MirrorRule.VARIANT: ("With Variant", "All, when the first channel that varies is mirrored"),
            },
        ),
        update=_defined,
    )


def _answer(what: str) -> Any:
    return EnumProperty(
        name=what,
        description=f"{what}: what a character must be for the action to bind to it",
        items=_items(
            Answer,
            {
                Answer.IGNORE: ("Ignore", "It does not matter"),
                Answer.TRUE: ("Yes", "The character must"),
                Answer.FALSE: ("No", "The character must not"),
            },
        ),
        update=_defined,
    )


class MORPHRETARGET_PG_action(Annotated, bpy.types.PropertyGroup):
    """What makes an action a generalized one, or a base motion."""

    version: IntProperty(name="Data Version", description="Form of this data, for upgrades", default=0)
    channels: CollectionProperty(
        type=MORPHRETARGET_PG_channel, name="Channels", description="What the action poses, and how"
    )
    active_channel: IntProperty(name="Active Channel", description="Channel that the buttons act on")
    movement: StringProperty(
        name="Movement",
        description="Actions with the same name here are branches of one movement; the one that fits is played",
    )
    upright_spine: _answer("Upright Spine")
    has_graspers: _answer("Has Graspers")
    has_feet: _answer("Has Feet")
    has_mouth: _answer("Has Mouth")
    has_tail: _answer("Has Tail")
    has_wings: _answer("Has Wings")
    leg_count: IntProperty(
        name="Leg Count",
        description="Number of legs a character must have; -1 does not matter",
        default=-1,
        min=-1,
        soft_max=12,
        update=_defined,
    )
    remap: BoolProperty(
        name="Remap Keys",
        description="Change the keys when a movement mode is changed, so that the active body moves as before",
        default=True,
    )


def of_action(action: bpy.types.ID | None) -> MORPHRETARGET_PG_action:
    """Return what makes an action a generalized one."""
    assert action is not None, "definitions belong to an action"
    return action.morph_retarget  # type: ignore[attr-defined]


CLASSES = (
    MORPHRETARGET_PG_context,
    MORPHRETARGET_PG_channel,
    *annotations.CLASSES,
    MORPHRETARGET_PG_action,
)


def attach() -> None:
    """Put the group on actions; that on objects is part of the rig's."""
    group = PointerProperty(type=MORPHRETARGET_PG_action, name="Morph Retarget")
    bpy.types.Action.morph_retarget = group  # type: ignore[attr-defined]


def detach() -> None:
    """Take it off again."""
    del bpy.types.Action.morph_retarget  # type: ignore[attr-defined]
