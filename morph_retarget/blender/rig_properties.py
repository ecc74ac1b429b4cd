"""What armature objects keep: joints and their bones, when feet stand, and all that the wings of the house add."""

from typing import Any

import bpy
from bpy.props import (
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from ..core.character.analysis import Overrides
from ..core.character.character import Character
from ..core.character.control_given import Reaching
from ..core.character.frame import WORLD_AXES, axis
from ..core.character.joints import PARENTS, JointMatch
from ..core.errors import MappingError
from .changes import changed, together
from .declaring import OVERRIDABLE, OVERRIDABLE_LIST, only, overridable
from .directing.properties import Directed
from .locomotion.properties import Walker
from .morph.jiggle_properties import Jiggler
from .morph.solver_properties import Solved
from .morph.values import Performer

BY_USER = ("user", "preset")
"""Origins of joints that the analysis must not change."""

_AXES: Any = [
    ("AUTO", "Automatic", "Found from the rig itself"),
    *((name, name, f"The world's {name} axis") for name in WORLD_AXES),
]


def _chosen_by_user(joint: "MORPHRETARGET_PG_joint", context: bpy.types.Context) -> None:
    joint.by, joint.confidence = "user", 1.0
    changed(joint, context)


class MORPHRETARGET_PG_joint(bpy.types.PropertyGroup):
    """One canonical joint and the bone found or chosen for it; `name` is the joint."""

    bone: StringProperty(
        name="Bone",
        description="Bone that plays this joint; empty when the rig has none",
        update=_chosen_by_user,
        override=OVERRIDABLE,
    )
    control: StringProperty(
        name="Control",
        description="Bone that animators move for this joint; found by itself when empty",
        **overridable(changed),
    )
    reach: StringProperty(
        name="IK Control",
        description="Bone that brings this hand or foot to a place; found by itself when empty",
        **overridable(changed),
    )
    pole: StringProperty(
        name="Pole",
        description="Bone that the elbow or knee of this limb points to; found by itself when empty",
        **overridable(changed),
    )
    switch: StringProperty(
        name="Switch",
        description="Data path of the bone's property that switches this limb, and its value for IK, as "
        'Properties["ik_left_arm"] = 1; found by itself when empty',
        **overridable(changed),
    )
    also: StringProperty(
        name="Further Bones",
        description="Further bones that turn as this joint of the source does, separated by commas",
        **overridable(changed),
    )
    confidence: FloatProperty(name="Confidence", description="How sure the match is", min=0.0, max=1.0)
    by: StringProperty(name="Found By", description="What decided: name, topology, geometry, user or preset")

    def hold(self, said: Reaching) -> None:
        """Keep what is said of how the joint is brought to a place."""
        self.reach, self.pole, self.switch = said.control, said.pole, said.switch


class MORPHRETARGET_PG_contact(bpy.types.PropertyGroup):
    """An interval in which a foot stands; `name` is the foot's bone on the source."""

    start: IntProperty(name="Start", description="First frame on the ground", update=changed)
    end: IntProperty(name="End", description="Last frame on the ground", update=changed)


class MORPHRETARGET_PG_rig(Performer, Solved, Jiggler, Walker, Directed, bpy.types.PropertyGroup):
    """What is known about one armature."""

    joints: CollectionProperty(
        type=MORPHRETARGET_PG_joint,
        name="Joints",
        description="Canonical joints and their bones",
        override=OVERRIDABLE_LIST,
    )
    active_joint: IntProperty(name="Active Joint", description="Joint that the buttons beside the list act on")
    kind: StringProperty(name="Kind", description="What the rig was found to be")
    up: EnumProperty(name="Up", description="Direction to the rig's head, in the world", items=_AXES, update=changed)
    forward: EnumProperty(
        name="Forward", description="Direction in which the rig looks, in the world", items=_AXES, update=changed
    )
    contacts: CollectionProperty(
        type=MORPHRETARGET_PG_contact, name="Contacts", description="When the feet of this source stand"
    )
    active_contact: IntProperty(name="Active Contact", description="Contact that the buttons beside the list act on")
    contacts_action: StringProperty(name="Action", description="Action that the contacts belong to")
    live_source: PointerProperty(
        type=bpy.types.Object,
        name="Live Source",
        description="Armature that this one follows while frames change; nothing when empty",
        poll=only("ARMATURE"),
        override=OVERRIDABLE,
    )

    home: FloatVectorProperty(
        name="Home",
        description="Transform of the object before it began to follow, where the motion moves the object itself",
        size=16,
        options={"HIDDEN"},
        override=OVERRIDABLE,
    )

    def show(self, character: Character) -> None:
        """Fill the list with what was found; all joints are listed, those without a bone too."""
        given = {joint.name: joint.by for joint in self.joints if joint.by in BY_USER}
        controls, further = self.controls(), {joint.name: joint.also for joint in self.joints}
        reaches = self.reaches()
        with together():
            self.joints.clear()
            for name in PARENTS:
                match = character.joints.get(name) or JointMatch("", 0.0, "")
                joint = self.joints.add()
                joint.name, joint.bone = name, match.bone
                joint.confidence, joint.by = match.confidence, given.get(name, match.by)
                joint.control, joint.also = controls.get(name, ""), further.get(name, "")
                joint.hold(reaches.get(name, Reaching()))
        self.active_joint = min(self.active_joint, len(self.joints) - 1)
        self.kind = "Humanoid" if character.humanoid else f"Creature, {len(character.legs)} legs"

    def overrides(self) -> Overrides:
        """Return what the user has set about the rig."""
        return Overrides(
            up=None if self.up == "AUTO" else axis(self.up),
            forward=None if self.forward == "AUTO" else axis(self.forward),
            joints={joint.name: joint.bone for joint in self.joints if joint.by in BY_USER},
        )

    def controls(self) -> dict[str, str]:
        """Return the controls that the user has named, joint to bone."""
        return {joint.name: joint.control for joint in self.joints if joint.control}

    def reaches(self) -> dict[str, Reaching]:
        """Return what the user says of how hands and feet are brought to places, by joint."""
        said = {joint.name: Reaching(joint.reach, joint.pole, joint.switch) for joint in self.joints}
        return {name: reach for name, reach in said.items() if reach != Reaching()}

    def further(self) -> tuple[tuple[str, str], ...]:
        """Return joints with the further bones that the user lets follow them."""
        named = [(joint.name, bone.strip()) for joint in self.joints for bone in joint.also.split(",")]
        return tuple((joint, bone) for joint, bone in named if bone)

    def assign(self, name: str, bone: str, by: str = "user") -> None:
        """Give a joint a bone; a joint that had the bone before loses it.

        Raises:
            MappingError: There is no such joint, or the rig has not been analysed.
        """
        joint = self.joints.get(name)
        if joint is None:
            raise MappingError(f"joint {name!r} is not in the list: analyze the rig, and use VRM 1.0 names")
        with together():
            for other in self.joints:
                if bone and other.bone == bone and other.name != name:
                    other.bone = ""
            joint.bone = bone
            joint.by = by


CLASSES = (MORPHRETARGET_PG_joint, MORPHRETARGET_PG_contact, MORPHRETARGET_PG_rig)
