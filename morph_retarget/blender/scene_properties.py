"""What scenes keep: the settings of the panel, for the retarget that shall be done."""

from dataclasses import replace

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty, StringProperty

from ..core.mocap.feet import FeetSettings
from ..core.mocap.plan import Matching, RetargetSettings
from ..core.mocap.root_motion import RootMotion
from .changes import changed
from .controls.task import Onto
from .declaring import only
from .laying import Lay
from .retarget import Options, Reference


class MORPHRETARGET_PG_scene(bpy.types.PropertyGroup):
    """What shall be done: the settings of the panel."""

    version: IntProperty(name="Data Version", description="Form of this data, for upgrades", default=0)
    source: PointerProperty(
        type=bpy.types.Object, name="Source", description="Armature that has the motion", poll=only("ARMATURE")
    )
    target: PointerProperty(
        type=bpy.types.Object, name="Target", description="Armature that shall get the motion", poll=only("ARMATURE")
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
        update=changed,
    )
    reference_frame: IntProperty(
        name="Frame", description="Frame of the clip that looks like the target's rest pose", default=1, update=changed
    )
    matching: EnumProperty(
        name="Matching",
        description="How the two poses correspond",
        items=[
            (Matching.AUTO.value, "Automatic", "Bone directions between humanoids, as they stand otherwise"),
            (Matching.DIRECTIONS.value, "Bone Directions", "Bones of the target point where those of the source do"),
            (Matching.AS_THEY_STAND.value, "As They Stand", "Both poses mean the same, whatever they look like"),
        ],
        update=changed,
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
        update=changed,
    )
    scale: FloatProperty(
        name="Travel Scale",
        description="Way of the target over that of the source; 0 takes the ratio of leg lengths",
        min=0.0,
        soft_max=10.0,
        update=changed,
    )
    plant_feet: BoolProperty(
        name="Plant Feet", description="Keep feet in place while they stand", default=True, update=changed
    )
    lock: FloatProperty(
        name="Lock",
        description="How much of the source's own foot slide to remove",
        default=1.0,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        update=changed,
    )
    ground: PointerProperty(
        type=bpy.types.Object,
        name="Ground",
        description="Mesh that the feet follow; a flat floor when empty",
        poll=only("MESH"),
        update=changed,
    )
    mirror: BoolProperty(name="Mirror", description="Change left and right over", update=changed)
    reach_hands: BoolProperty(
        name="Reach With Hands",
        description="Bring the hands to the source's places, scaled, as for contact with objects",
        update=changed,
    )
    all_actions: BoolProperty(
        name="All Actions", description="Retarget every action of the source, each to an action of its own"
    )
    use_range: BoolProperty(name="Frame Range", description="Retarget only a part of the clip", update=changed)
    frame_start: IntProperty(name="Start", description="First frame of the source", default=1, update=changed)
    frame_end: IntProperty(name="End", description="Last frame of the source", default=250, update=changed)
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
        update=changed,
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


CLASSES = (MORPHRETARGET_PG_scene,)
