"""Generalized actions for tests: made from channels and keys, played by figures and creatures."""

from collections.abc import Mapping, Sequence

import bpy
import numpy as np

from morph_retarget.blender import retarget
from morph_retarget.blender.morph import bake, cast, definitions, keys
from morph_retarget.blender.morph.bake import Options, Outcome
from morph_retarget.blender.properties import of_rig
from morph_retarget.core.arrays import Array
from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.morph.channels import Channel, TargetKind
from morph_retarget.core.morph.context import Context, Side
from morph_retarget.core.morph.movement import Movement, ScaleMode
from tests.blender import scenes
from tools import armatures, creatures

LIMB = Movement(scale=ScaleMode.LIMB_LENGTH)
HANDS = Channel("Hands", Context(Capability.GRASPER), LIMB)
LEFT_HAND = Channel("Left hand", Context(Capability.GRASPER, side=Side.LEFT), LIMB)
FEET = Channel("Feet", Context(Capability.FOOT), LIMB)
REACH = Channel(
    "Reach", Context(Capability.GRASPER), Movement(secondary_relative=True), target=TargetKind.EXTERNAL, varies=True
)
Keys = Mapping[str, Mapping[int, Sequence[float]]]
"""Positions by name of the channel and frame."""
DIP = {"Hands": {1: (0.0, 0.0, 0.0), 11: (-0.1, -0.1, -0.5), 21: (0.0, 0.0, 0.0)}}


def action(name: str, channels: Sequence[Channel]) -> bpy.types.Action:
    """Return a new generalized action without keys."""
    made = bpy.data.actions.new(name)
    made.use_fake_user = True
    for channel in channels:
        definitions.add(made, channel)
    return made


def play(made: bpy.types.Action, *characters: bpy.types.Object, keyed: Keys | None = None) -> None:
    """Let characters play an action, and key positions on it."""
    for ob in characters:
        cast.add(ob, made)
    for channel, poses in (keyed or {}).items():
        for frame, position in poses.items():
            of_rig(characters[0]).channels[channel].position = position
            keys.insert(characters[0], channel, ["position"], frame)


def dip(*characters: bpy.types.Object) -> bpy.types.Action:
    """Return an action that lowers the hands and raises them again, frames 1 to 21, which characters play."""
    made = action("Dip", [HANDS])
    play(made, *characters, keyed=DIP)
    return made


def creature(kind: str, name: str = "") -> bpy.types.Object:
    """Return one of the sample creatures without its flesh."""
    return armatures.build(name or kind.title(), getattr(creatures, kind)())


def baked(*characters: bpy.types.Object, options: Options | None = None) -> list[Outcome]:
    """Bake characters and return what was made."""
    return retarget.run(bake.bake(characters, bpy.context.scene, options or Options()))


def shown(ob: bpy.types.Object, frames: Sequence[float]) -> Array:
    """Return where all bones of a character are in the world, shape (frame, bone, 3)."""
    return scenes.heads(ob, [bone.name for bone in ob.pose.bones], frames)


def apart(a: Array, b: Array) -> float:
    """Return the largest distance between points that should be one [m]."""
    return float(np.linalg.norm(a - b, axis=-1).max())
