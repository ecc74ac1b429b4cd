"""Two armatures in Blender, one that walks and one to give its walk to, and the retarget from one to the other."""

from dataclasses import dataclass

import bpy
import numpy as np

from morph_retarget.blender import actions, retarget, rig
from morph_retarget.blender.retarget import Options, Outcome
from morph_retarget.core.mocap.plan import RetargetSettings
from tools import armatures, gait
from tools.figure import CHIBI, Build, blender, humanoid

from .figures import seconds

FPS = 30
BUILDS = {22: Build(), 52: Build(fingers=5)}
"""Number of bones to the figure that has as many."""


@dataclass(frozen=True)
class Pair:
    """Two armatures of the open scene with as many bones each."""

    walker: bpy.types.Object
    """Plays the clip."""
    sprout: bpy.types.Object
    """Plays nothing; its proportions, names, axes and arms are others."""


def open_pair(bones: int, frames: int) -> Pair:
    """Replace the open file with a pair.

    Args:
        bones: Of each armature, a key of `BUILDS`.
        frames: Of the clip.
    """
    bpy.ops.wm.read_homefile(use_empty=True)
    return add_pair(bones, frames)


def add_pair(bones: int, frames: int) -> Pair:
    """Add a pair to the open scene, see `open_pair`."""
    bpy.context.scene.render.fps = FPS
    walker = armatures.build("Walker", humanoid(1.8, build=BUILDS[bones]))
    own = rig.read(walker).skeleton
    assert len(own) == bones, "the table of builds says how many"
    armatures.key(walker, own, gait.pose(own, gait.walk((frames - 1) / FPS, FPS, height=1.8)), "Walk")
    sprout = armatures.build("Sprout", humanoid(1.1, CHIBI, BUILDS[bones], blender), np.random.default_rng(7))
    bpy.context.view_layer.update()
    return Pair(walker, sprout)


def transfer(pair: Pair, plant_feet: bool) -> Outcome:
    """Return the whole retarget, from two armatures nobody has looked at to a new action."""
    scene = bpy.context.scene
    options = Options(RetargetSettings(plant_feet=plant_feet))
    action, slot = actions.assigned(pair.walker)
    source = retarget.run(retarget.read_source(rig.read(pair.walker), action, slot, scene))
    target = rig.read(pair.sprout)
    return retarget.retarget(source, target, retarget.character_of(target), options, scene)


def timed(pair: Pair, plant_feet: bool) -> float:
    """Return the time of the whole retarget [s], and leave the file as it was."""
    taken = seconds(lambda: transfer(pair, plant_feet))
    forget(pair)
    return taken


def forget(pair: Pair) -> None:
    """Take the sprout's action away."""
    action, _ = actions.assigned(pair.sprout)
    pair.sprout.animation_data_clear()
    bpy.data.actions.remove(action)
