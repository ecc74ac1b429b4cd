"""A user lets a rig with controls follow live, takes steps back, and gives the source another action meanwhile."""

from collections.abc import Iterator

import bpy
import numpy as np

from morph_retarget.blender import live
from morph_retarget.blender.properties import of_rig, of_scene
from tests.blender import control_rigs, scenes
from tests.window.hand import Hand
from tests.window.scenes import choose, search, until
from tools.figure import blender

CONTROL = "Anim Hips"


def path(hand: Hand) -> Iterator[None]:
    """Play it."""
    source = scenes.walker()
    target = control_rigs.controlled(blender, lambda joint: f"Anim {blender(joint)}")
    settings = of_scene(bpy.context.scene)
    settings.source, settings.target = source, target
    choose(source, target)
    bpy.ops.ed.undo_push(message="Two armatures")
    yield
    yield from search(hand, "morph retarget live")
    yield from until(lambda: of_rig(_target()).live_source, "a live target")
    first = _at(20)
    assert np.abs(first - _at(1)).max() > 0.1, "its control moves"
    scenes.empty_object()
    bpy.ops.ed.undo_push(message="Something else")
    hand.press("Z", ctrl=True)
    yield from until(lambda: "Empty" not in bpy.data.objects, "the step taken back")
    assert of_rig(_target()).live_source is not None
    assert np.abs(_at(20) - first).max() < 1e-5, "it follows on"
    scenes.walk(bpy.data.objects["Walker"], scenes.gait.walk(scenes.STEP, scenes.FPS, 1.0), "Slow")
    _at(19)
    yield from until(lambda: np.abs(_at(20) - first).max() > 0.01, "the other action")
    assert of_rig(_target()).live_source is not None
    assert not live.problems


def _target() -> bpy.types.Object:
    return bpy.data.objects["Puppet"]


def _at(frame: int) -> np.ndarray:
    """Return where the control of the hips is at a frame, shape (3,)."""
    bpy.context.scene.frame_set(frame)
    return np.array(_target().pose.bones[CONTROL].location)
