"""What is done in a soak: each operation is what a user may do with the open file, with random choices."""

import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from random import Random

import bpy
import numpy as np

from morph_retarget.blender import actions
from morph_retarget.blender.morph import keys
from morph_retarget.blender.morph.properties import of_action
from morph_retarget.blender.properties import of_rig, of_scene
from tools import armatures, creatures
from tools.figure import humanoid

from . import bystander, edits

SAMPLES = Path(__file__).resolve().parents[2] / "sample_blends"
MOST = 4
"""Characters that are added to a file; samples may have more."""
ours = bpy.ops.morph_retarget


class World:
    """The open file, and random choices in it."""

    def __init__(self, seed: int) -> None:
        self.rng = Random(seed)
        self.folder = tempfile.TemporaryDirectory(prefix="soak_")
        self.samples = sorted(SAMPLES.glob("*.blend")) + sorted((SAMPLES / "characters").glob("*.blend"))
        self.saved = Path(self.folder.name, "soak.blend")
        self.began()

    def began(self) -> None:
        """Add bystanders to a file that was opened just now, and begin its history."""
        bystander.add()
        self.before = bystander.fingerprint()
        bpy.ops.ed.undo_push(message="begin")

    def characters(self) -> list[bpy.types.Object]:
        """Return the armatures that operations may change."""
        found = [ob for ob in bpy.context.scene.objects if ob.type == "ARMATURE"]
        return [ob for ob in found if ob.name != bystander.NAME]

    def character(self) -> bpy.types.Object:
        """Return one of them, made the active and the only selected object; a new one if there is none."""
        if not self.characters():
            add(self)
        ob = self.rng.choice(self.characters())
        select(ob)
        return ob

    def name(self) -> str:
        """Return the name of one of them."""
        return self.character().name


def select(*obs: bpy.types.Object) -> None:
    """Select objects and no others; the last one is the active one."""
    if bpy.context.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    for ob in bpy.context.view_layer.objects:
        ob.select_set(ob in obs)
    bpy.context.view_layer.objects.active = obs[-1]


# --- files ---


def new(world: World) -> None:
    """Begin with an empty file and a character."""
    bpy.ops.wm.read_homefile(use_empty=True)
    world.began()
    add(world)


def sample(world: World) -> None:
    """Open a sample."""
    bpy.ops.wm.open_mainfile(filepath=str(world.rng.choice(world.samples)), load_ui=False)
    world.began()


def save(world: World) -> None:
    """Save the file."""
    bpy.ops.wm.save_as_mainfile(filepath=str(world.saved), copy=True)


def reopen(world: World) -> None:
    """Save the file and open it again."""
    save(world)
    bpy.ops.wm.open_mainfile(filepath=str(world.saved), load_ui=False)
    bpy.ops.ed.undo_push(message="reopened")


def undo(world: World) -> None:
    """Take some steps back, and perhaps some of them again."""
    count = world.rng.randint(1, 3)
    for _ in range(count):
        bpy.ops.ed.undo()
    for _ in range(world.rng.randint(0, count)):
        bpy.ops.ed.redo()


def redo(_: World) -> None:
    """Take it again."""
    bpy.ops.ed.redo()


# --- characters ---


def add(world: World) -> None:
    """Add a character, bones rolled at random."""
    if len(world.characters()) >= MOST:
        return
    made = {**creatures.CREATURES, "human": lambda: humanoid(world.rng.uniform(0.5, 2.5))}
    name = world.rng.choice(sorted(made))
    if bpy.context.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    ob = armatures.build(name.capitalize(), made[name](), np.random.default_rng(world.rng.randrange(99)))
    ob.location = (world.rng.uniform(-3.0, 3.0), world.rng.uniform(-3.0, 3.0), 0.0)


def delete(world: World) -> None:
    """Delete a character."""
    bpy.data.objects.remove(world.character())


def rename(world: World) -> None:
    """Rename a character or one of its bones."""
    ob = world.character()
    if world.rng.random() < 0.5:
        ob.name = world.rng.choice(("Ann", 'Bob "B"', "😀"))
    else:
        world.rng.choice(list(ob.data.bones)).name = world.rng.choice(("Bone", "Arm.L", "a'b"))


def reshape(world: World) -> None:
    """Move a joint of an armature in Edit mode, or take a bone away."""
    ob = world.character()
    bpy.ops.object.mode_set(mode="EDIT")
    bone = world.rng.choice(list(ob.data.edit_bones))
    if world.rng.random() < 0.3 and len(ob.data.edit_bones) > 3:
        ob.data.edit_bones.remove(bone)
    else:
        bone.tail.x += world.rng.uniform(-0.1, 0.1)
    bpy.ops.object.mode_set(mode="OBJECT")


def analyse(world: World) -> None:
    """Find out what a rig is."""
    ours.analyze(rig=world.name())


def place(world: World) -> None:
    """Move, turn or scale a character."""
    ob, rng = world.character(), world.rng
    ob.location.x, ob.rotation_euler.z = rng.uniform(-2.0, 2.0), rng.uniform(-3.0, 3.0)
    ob.scale = (rng.choice((0.01, 1.0, 1.0, 100.0)),) * 3


def drag(world: World) -> None:
    """Turn a bone in Pose mode."""
    ob = world.character()
    bpy.ops.object.mode_set(mode="POSE")
    bone = world.rng.choice(list(ob.pose.bones))
    bone.rotation_quaternion = [world.rng.gauss(0.0, 1.0) for _ in range(4)]
    bone.location.x += world.rng.uniform(-0.1, 0.1)
    bpy.context.view_layer.update()


# --- motions ---


def bind(world: World) -> None:
    """Let a character play a new generalized action, one of the file, or the channels of a preset."""
    name, found = world.name(), [action.name for action in bpy.data.actions if len(of_action(action).channels)]
    what = world.rng.random()
    if what < 0.4 or not found:
        ours.new_action(name="Soaked", character=name)
    elif what < 0.8:
        ours.add_character(character=name, action=world.rng.choice(found))
    else:
        ours.load_channels(action=world.rng.choice(found))


def channel(world: World) -> None:
    """Add, remove, double or move a channel."""
    world.name()
    kinds = [item.identifier for item in ours.add_channel.get_rna_type().properties["capability"].enum_items]
    world.rng.choice((
        lambda: ours.add_channel(capability=world.rng.choice(kinds)),
        ours.remove_channel, ours.duplicate_channel, ours.move_channel, ours.rest_channel,
    ))()  # fmt: skip


def key(world: World) -> None:
    """Set values of a channel and key them."""
    ob = world.character()
    items = list(of_rig(ob).channels)
    if not items:
        return
    item = world.rng.choice(items)
    item.position = [world.rng.gauss(0.0, 0.5) for _ in range(3)]
    keys.insert(ob, item.name, [world.rng.choice(("position", "rotation", "weight"))], world.rng.randint(1, 60))


def change(world: World) -> None:
    """Change any property of ours."""
    edits.edit(world.rng.choice(edits.groups(world.rng)), world.rng)
    bpy.context.view_layer.update()


def leave(world: World) -> None:
    """Take a character from its action or its way."""
    world.rng.choice((ours.remove_character, ours.remove_locomotion))(character=world.name())


def go(world: World) -> None:
    """Let a character go over the ground."""
    name = world.name()
    if world.rng.random() < 0.6:
        ours.add_locomotion(character=name)
    else:
        styles = [item.identifier for item in ours.add_gait_style.get_rna_type().properties["style"].enum_items]
        ours.add_gait_style(character=name, style=world.rng.choice(styles))


def command(world: World) -> None:
    """Direct a character."""
    ob, rng = world.character(), world.rng
    ours.direct(character=ob.name)
    verb, model = rng.choice(("start", "stop", "reset")), rng.choice(("walk", "wave", "gaze", "jump", "go", "nobody"))
    own = of_rig(ob).directing.command(rng.randint(1, 60), verb, model)
    if rng.random() < 0.5:
        own.set(rng.choice(("speed", "target", "place")), rng.choice((1.0, "Bystander", (1.0, -2.0, 0.0))))
    if rng.random() < 0.3:
        rng.choice((ours.commands_to_markers, ours.markers_to_commands, ours.remove_command))(character=ob.name)


def jiggle(world: World) -> None:
    """Give a bone settings of its own for jiggles or for the solver."""
    ob = world.character()
    bone = world.rng.choice(list(ob.data.bones)).name
    world.rng.choice((ours.add_jiggle_settings, ours.add_limb_settings))(character=ob.name, bone=bone)


def bake(world: World) -> None:
    """Bake what a character plays."""
    ours.bake_action(character=world.name())


def retarget(world: World) -> None:
    """Give one character the motion of another, live or as keys."""
    moving = [ob for ob in world.characters() if actions.assigned(ob)[0] is not None]
    source = world.rng.choice(moving or [world.character()])
    target = world.character()
    settings = of_scene(bpy.context.scene)
    settings.source, settings.target = source, target
    world.rng.choice((ours.retarget, ours.live_start, ours.swap, ours.live_stop))()


# --- time ---


def play(world: World) -> None:
    """Play some frames."""
    first = world.rng.randint(1, 60)
    for frame in range(first, first + 5):
        bpy.context.scene.frame_set(frame)


def scrub(world: World) -> None:
    """Go to any frame, or between two."""
    whole, part = divmod(edits.number(world.rng), 1.0)
    bpy.context.scene.frame_set(int(whole), subframe=part)


OPERATIONS: Mapping[Callable[[World], None], int] = {
    new: 3, sample: 4, save: 3, reopen: 4, undo: 14, redo: 2, add: 6, delete: 2, rename: 2, reshape: 2, analyse: 5,
    place: 3, drag: 5, bind: 8, channel: 8, key: 10, change: 20, leave: 3, go: 5, command: 5, jiggle: 3, bake: 3,
    retarget: 6, play: 10, scrub: 10,
}  # fmt: skip
"""How often each is done, by turns."""
