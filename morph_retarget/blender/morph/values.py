"""What armature objects keep of generalized actions: the keyed values of channels, and how they play."""

from collections.abc import Callable

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from ..declaring import OVERRIDABLE_LIST, Listener, overridable, telling

value_listeners: list[Callable[["MORPHRETARGET_PG_values", str], None]] = []
"""Called after a value of a channel was set by hand, with the name of its property."""
character_listeners: list[Listener] = []
"""Called after a setting of a character has changed."""
tell_character = telling(character_listeners)
"""Tells that a setting of a character has changed."""
OF_CHARACTER = overridable(tell_character)
"""What such settings are declared with."""


def _valued(part: str) -> Callable[["MORPHRETARGET_PG_values", bpy.types.Context], None]:
    def tell(own: "MORPHRETARGET_PG_values", _: bpy.types.Context) -> None:
        """Tell that a value was set."""
        for listener in value_listeners:
            listener(own, part)

    return tell


class MORPHRETARGET_PG_deform(bpy.types.PropertyGroup):
    """A scalar curve for shape keys and custom properties of the same name."""

    value: FloatProperty(name="Value", description="Of shape keys and custom properties that are called like it")


class MORPHRETARGET_PG_values(bpy.types.PropertyGroup):
    """The values of one channel; `name` is the channel's."""

    position: FloatVectorProperty(
        name="Position",
        description="Generalized position",
        size=3,
        default=(0.0, 0.0, 0.0),
        precision=3,
        step=1,
        update=_valued("position"),
    )
    rotation: FloatVectorProperty(
        name="Rotation",
        description="Generalized rotation, a quaternion",
        size=4,
        subtype="QUATERNION",
        default=(1.0, 0.0, 0.0, 0.0),
        update=_valued("rotation"),
    )
    weight: FloatProperty(
        name="Weight",
        description="How much the channel counts",
        default=1.0,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        update=_valued("weight"),
    )
    deforms: CollectionProperty(
        type=MORPHRETARGET_PG_deform, name="Deforms", description="Scalar curves, such as open and closed"
    )
    target: PointerProperty(
        type=bpy.types.Object,
        name="Target",
        description="Object that the channel moves relative to, on this character",
        **OF_CHARACTER,
    )
    target_bone: StringProperty(
        name="Bone",
        description="Bone of the target; its origin when empty",
        **OF_CHARACTER,
    )
    active_body: StringProperty(
        name="Active Body", description="Bone that curves are specialized for and keys are kept for"
    )


class Performer:
    """How an armature plays generalized actions; part of the rig's own group."""

    channels: CollectionProperty(
        type=MORPHRETARGET_PG_values,
        name="Channels",
        description="Generalized values by channel",
        override=OVERRIDABLE_LIST,
    )
    variant: IntProperty(
        name="Variant",
        description="Which of the ways in which the action can play on this character",
        min=0,
        **OF_CHARACTER,
    )
    bends_spine: BoolProperty(
        name="Bend Spine",
        description="Bend and twist the spine so that heads, mouths, hands and feet come to their goals: more "
        "natural poses and more that can be reached. Takes longer while keys are edited",
        **OF_CHARACTER,
    )
    allows_stretch: BoolProperty(
        name="Allow Stretch",
        description="Let limbs get longer and shorter to come to goals out of reach, and a spine that bends: up to "
        "120 % and down to 10 %. Off, bones keep their lengths. Bones that are connected cannot move",
        **OF_CHARACTER,
    )
    avoids_collisions: BoolProperty(
        name="Avoid Self-Collision",
        description="Swivel arms and legs out of the trunk, the head and each other; hands and feet stay at their "
        "goals. Takes longer while keys are edited",
        **OF_CHARACTER,
    )
    keeps_above_ground: BoolProperty(
        name="Keep above Ground",
        description="Turn hands, tails and wings up where they would go below the ground, as far as no goal places "
        "them. The ground is level, at the height of the feet; with locomotion nothing is turned up",
        default=True,
        **OF_CHARACTER,
    )
    use_joint_limits: BoolProperty(
        name="Joint Limits",
        description="Turn no bone further than its own limits for inverse kinematics allow, where it has any",
        default=True,
        **OF_CHARACTER,
    )
    stands_for: PointerProperty(
        type=bpy.types.Object,
        name="Stands For",
        description="Character whose channel is edited through this object's curves",
        options={"HIDDEN"},
    )
    stands_for_body: StringProperty(name="Body", description="Body whose curves this object shows", options={"HIDDEN"})
    stands_for_channel: StringProperty(
        name="Channel", description="Channel that is edited through this object's curves", options={"HIDDEN"}
    )
    muted: BoolProperty(
        name="Mute",
        description="Leave the pose of this character alone",
        **OF_CHARACTER,
    )


CLASSES = (MORPHRETARGET_PG_deform, MORPHRETARGET_PG_values)
