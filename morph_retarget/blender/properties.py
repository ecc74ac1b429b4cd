"""What users set in the window and files keep: one group on scenes, one on objects."""

import contextlib
from collections.abc import Callable, Generator
from dataclasses import replace
from typing import Any

import bpy
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

from ..core.character.analysis import Overrides
from ..core.character.character import Character
from ..core.character.control_given import Reaching
from ..core.character.frame import WORLD_AXES, axis
from ..core.character.joints import PARENTS, JointMatch
from ..core.errors import MappingError
from ..core.mocap.feet import FeetSettings
from ..core.mocap.plan import Matching, RetargetSettings
from ..core.mocap.root_motion import RootMotion
from .controls.task import Onto
from .directing import properties as directing
from .directing.properties import Directed
from .laying import Lay
from .locomotion import properties as locomotion
from .locomotion.properties import Walker
from .morph import jiggle_properties, solver_properties, values
from .morph import properties as morph
from .morph.jiggle_properties import Jiggler
from .morph.solver_properties import Solved
from .morph.values import Performer
from .retarget import Options, Reference

BY_USER = ("user", "preset")
"""Origins of joints that the analysis must not change."""

listeners: list[Callable[[bpy.types.Scene], None]] = []
"""Called after a setting has changed that a live pose depends on."""


_together: list[bool] = []
"""Not empty while several settings are changed, of which is told once."""


def _changed(_: object, context: bpy.types.Context) -> None:
    if context.scene is not None and not _together:
        for listener in listeners:
            listener(context.scene)


@contextlib.contextmanager
def together() -> Generator[None]:
    """Tell once of all that is changed meanwhile: each time, a live target is given its motion anew."""
    _together.append(True)
    try:
        yield
    finally:
        _together.pop()
    _changed(None, bpy.context)


def _chosen_by_user(joint: "MORPHRETARGET_PG_joint", context: bpy.types.Context) -> None:
    joint.by, joint.confidence = "user", 1.0
    _changed(joint, context)


def _is_armature(_: object, ob: bpy.types.Object) -> bool:
    return ob.type == "ARMATURE"


def _is_mesh(_: object, ob: bpy.types.Object) -> bool:
    return ob.type == "MESH"


_OVERRIDABLE: Any = {"LIBRARY_OVERRIDABLE"}
_OVERRIDABLE_LIST: Any = {"LIBRARY_OVERRIDABLE", "USE_INSERTION"}
_AXES: Any = [
    ("AUTO", "Automatic", "Found from the rig itself"),
    *((name, name, f"The world's {name} axis") for name in WORLD_AXES),
]


class MORPHRETARGET_PG_joint(bpy.types.PropertyGroup):
    """One canonical joint and the bone found or chosen for it; `name` is the joint."""

    bone: StringProperty(
        name="Bone",
        description="Bone that plays this joint; empty when the rig has none",
        update=_chosen_by_user,
        override=_OVERRIDABLE,
    )
    control: StringProperty(
        name="Control",
        description="Bone that animators move for this joint; found by itself when empty",
        update=_changed,
        override=_OVERRIDABLE,
    )
    reach: StringProperty(
        name="IK Control",
        description="Bone that brings this hand or foot to a place; found by itself when empty",
        update=_changed,
        override=_OVERRIDABLE,
    )
    pole: StringProperty(
        name="Pole",
        description="Bone that the elbow or knee of this limb points to; found by itself when empty",
        update=_changed,
        override=_OVERRIDABLE,
    )
    switch: StringProperty(
        name="Switch",
        description="Data path of the bone's property that switches this limb, and its value for IK, as "
        'Properties["ik_left_arm"] = 1; found by itself when empty',
        update=_changed,
        override=_OVERRIDABLE,
    )
    also: StringProperty(
        name="Further Bones",
        description="Further bones that turn as this joint of the source does, separated by commas",
        update=_changed,
        override=_OVERRIDABLE,
    )
    confidence: FloatProperty(name="Confidence", description="How sure the match is", min=0.0, max=1.0)
    by: StringProperty(name="Found By", description="What decided: name, topology, geometry, user or preset")

    def hold(self, said: Reaching) -> None:
        """Keep what is said of how the joint is brought to a place."""
        self.reach, self.pole, self.switch = said.control, said.pole, said.switch


class MORPHRETARGET_PG_contact(bpy.types.PropertyGroup):
    """An interval in which a foot stands; `name` is the foot's bone on the source."""

    start: IntProperty(name="Start", description="First frame on the ground", update=_changed)
    end: IntProperty(name="End", description="Last frame on the ground", update=_changed)


class MORPHRETARGET_PG_rig(Performer, Solved, Jiggler, Walker, Directed, bpy.types.PropertyGroup):
    """What is known about one armature."""

    joints: CollectionProperty(
        type=MORPHRETARGET_PG_joint,
        name="Joints",
        description="Canonical joints and their bones",
        override=_OVERRIDABLE_LIST,
    )
    active_joint: IntProperty(name="Active Joint", description="Joint that the buttons beside the list act on")
    kind: StringProperty(name="Kind", description="What the rig was found to be")
    up: EnumProperty(name="Up", description="Direction to the rig's head, in the world", items=_AXES, update=_changed)
    forward: EnumProperty(
        name="Forward", description="Direction in which the rig looks, in the world", items=_AXES, update=_changed
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
        poll=_is_armature,
        override=_OVERRIDABLE,
    )

    home: FloatVectorProperty(
        name="Home",
        description="Transform of the object before it began to follow, where the motion moves the object itself",
        size=16,
        options={"HIDDEN"},
        override=_OVERRIDABLE,
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


class MORPHRETARGET_PG_scene(bpy.types.PropertyGroup):
    """What shall be done: the settings of the panel."""

    version: IntProperty(name="Data Version", description="Form of this data, for upgrades", default=0)
    source: PointerProperty(
        type=bpy.types.Object, name="Source", description="Armature that has the motion", poll=_is_armature
    )
    target: PointerProperty(
        type=bpy.types.Object, name="Target", description="Armature that shall get the motion", poll=_is_armature
    )
    shown: EnumProperty(
        name="Shown Rig",
        description="Rig whose joints are listed",
        items=[
            ("SOURCE", "Source", "Joints of the rig that has the motion"),
            ("TARGET", "Target", "Joints of the rig that shall get it"),
        ],
        default="TARGET",
    )
    reference: EnumProperty(
        name="Rest Pose",
        description="Pose of the source that stands for the target's rest pose",
        items=[
            (Reference.AUTO.value, "Automatic", "The rest pose, or a good frame where the rest is no pose of a body"),
            (Reference.REST.value, "Rest", "The rest poses of both"),
            (Reference.FRAME.value, "Frame", "A frame of the clip, against the target's rest pose"),
            (Reference.CURRENT.value, "Current Poses", "The poses in which both stand now"),
        ],
        update=_changed,
    )
    reference_frame: IntProperty(
        name="Frame", description="Frame of the clip that looks like the target's rest pose", default=1, update=_changed
    )
    matching: EnumProperty(
        name="Matching",
        description="How the two poses correspond",
        items=[
            (Matching.AUTO.value, "Automatic", "Bone directions between humanoids, as they stand otherwise"),
            (Matching.DIRECTIONS.value, "Bone Directions", "Bones of the target point where those of the source do"),
            (Matching.AS_THEY_STAND.value, "As They Stand", "Both poses mean the same, whatever they look like"),
        ],
        update=_changed,
    )
    root_motion: EnumProperty(
        name="Root Motion",
        description="What carries the way over the ground",
        items=[
            (RootMotion.HIPS.value, "Hips", "The hips, as in the clip"),
            (RootMotion.ROOT_BONE.value, "Root Bone", "The topmost bone above the hips"),
            (RootMotion.OBJECT.value, "Object", "The armature object"),
            (RootMotion.IN_PLACE.value, "In Place", "Nothing: the character stays where it is"),
        ],
        update=_changed,
    )
    scale: FloatProperty(
        name="Travel Scale",
        description="Way of the target over that of the source; 0 takes the ratio of leg lengths",
        min=0.0,
        soft_max=10.0,
        update=_changed,
    )
    plant_feet: BoolProperty(
        name="Plant Feet", description="Keep feet in place while they stand", default=True, update=_changed
    )
    lock: FloatProperty(
        name="Lock",
        description="How much of the source's own foot slide to remove",
        default=1.0,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        update=_changed,
    )
    ground: PointerProperty(
        type=bpy.types.Object,
        name="Ground",
        description="Mesh that the feet follow; a flat floor when empty",
        poll=_is_mesh,
        update=_changed,
    )
    mirror: BoolProperty(name="Mirror", description="Change left and right over", update=_changed)
    reach_hands: BoolProperty(
        name="Reach With Hands",
        description="Bring the hands to the source's places, scaled, as for contact with objects",
        update=_changed,
    )
    all_actions: BoolProperty(
        name="All Actions", description="Retarget every action of the source, each to an action of its own"
    )
    use_range: BoolProperty(name="Frame Range", description="Retarget only a part of the clip", update=_changed)
    frame_start: IntProperty(name="Start", description="First frame of the source", default=1, update=_changed)
    frame_end: IntProperty(name="End", description="Last frame of the source", default=250, update=_changed)
    name_template: StringProperty(
        name="Name",
        description="Name of the new action; {action}, {source} and {target} are filled in",
        default=Options.name,
    )
    resample: BoolProperty(
        name="Whole Frames", description="Key whole frames when the clip has another frame rate than the scene"
    )
    keep_others: BoolProperty(
        name="Keep Other Bones",
        description="Take over what the target's present action does to bones that are not mapped",
        default=True,
    )
    lay: EnumProperty(
        name="Result",
        description="What becomes of the target's own animation",
        items=[
            (Lay.REPLACE.value, "Replace", "The target plays the new action; the old one is kept in the file"),
            (Lay.STASH.value, "Stash", "The target plays on; the new action waits on a muted track of the NLA"),
            (Lay.ADD.value, "Add", "What changes from the first frame on is laid over what the target plays"),
        ],
    )
    selected_only: BoolProperty(
        name="Selected Bones",
        description="Move only the bones of the target that are selected; all others keep their animation",
    )
    jiggles: BoolProperty(
        name="Jiggles",
        description="Let tails, ears, hair and the like follow, as far as the clip does not move them; "
        "how is set in the panel Jiggles, for the target",
    )
    onto: EnumProperty(
        name="Write On",
        description="What gets the keys on a rig with controls",
        items=[
            (Onto.AUTO.value, "Automatic", "Controls that turn parts where the rig has controls, else its bones"),
            (Onto.FK.value, "FK Controls", "Controls that turn parts, with the switches of limbs set to FK"),
            (Onto.IK.value, "IK Hands and Feet", "Controls that bring hands and feet to places, FK for all else"),
            (Onto.NONE.value, "Bones", "The bones in the list of joints, whatever moves them besides"),
        ],
        update=_changed,
    )
    show_paths: BoolProperty(
        name="Motion Paths",
        description="Draw where the active channel brings the active body of the active character, and its target",
        default=True,
    )
    show_solver: BoolProperty(
        name="Solver",
        description="Draw the goals of the active character's pose, green where they are met, "
        "and the particles and constraints that it was found with",
    )

    def options(self) -> Options:
        """Return the settings as the retarget takes them."""
        return Options(
            settings=RetargetSettings(
                matching=Matching(self.matching),
                plant_feet=self.plant_feet,
                reach_hands=self.reach_hands,
                root_motion=RootMotion(self.root_motion),
                scale=self.scale,
                mirror=self.mirror,
                feet=replace(FeetSettings(), lock=self.lock),
            ),
            reference=Reference(self.reference),
            reference_frame=self.reference_frame,
            frames=(self.frame_start, self.frame_end) if self.use_range else None,
            name=self.name_template,
            resample=self.resample,
            keep_others=self.keep_others,
            onto=Onto(self.onto),
            lay=Lay(self.lay),
        )


def of_scene(scene: bpy.types.Scene) -> MORPHRETARGET_PG_scene:
    """Return a scene's settings."""
    return scene.morph_retarget  # type: ignore[attr-defined]


def of_rig(ob: bpy.types.Object) -> MORPHRETARGET_PG_rig:
    """Return what is known about an armature."""
    return ob.morph_retarget  # type: ignore[attr-defined]


CLASSES = (
    *values.CLASSES,
    *jiggle_properties.CLASSES,
    *solver_properties.CLASSES,
    *locomotion.CLASSES,
    *directing.CLASSES,
    *morph.CLASSES,
    MORPHRETARGET_PG_joint,
    MORPHRETARGET_PG_contact,
    MORPHRETARGET_PG_rig,
    MORPHRETARGET_PG_scene,
)


def attach() -> None:
    """Put the groups on scenes, objects and actions."""
    morph.attach()
    rig = PointerProperty(type=MORPHRETARGET_PG_rig, name="Morph Retarget", override=_OVERRIDABLE)
    scene = PointerProperty(type=MORPHRETARGET_PG_scene, name="Morph Retarget")
    bpy.types.Object.morph_retarget = rig  # type: ignore[attr-defined]
    bpy.types.Scene.morph_retarget = scene  # type: ignore[attr-defined]


def detach() -> None:
    """Take them off again."""
    del bpy.types.Scene.morph_retarget  # type: ignore[attr-defined]
    del bpy.types.Object.morph_retarget  # type: ignore[attr-defined]
    morph.detach()
