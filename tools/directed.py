"""The sample scene of a directed character: what it is told, and what is around it.

Blender has to know the extension's properties for this: register it first.
"""

from collections.abc import Mapping, Sequence

import bpy
import numpy as np
from mathutils import Matrix

from morph_retarget.blender import rig
from morph_retarget.blender.locomotion.properties import Source
from morph_retarget.blender.properties import of_rig

from . import stage, walks

NAME = "direct_biped"
CREATURE = "biped"
FRAMES = 391
TOLD: Sequence[tuple[int, str, str, Mapping[str, object]]] = (
    (15, "start", "walk", {"speed": 1.0}),
    (75, "start", "wave", {}),
    (150, "start", "walk", {"speed": 1.5}),
    (160, "start", "gaze", {"target": "Bird"}),
    (215, "stop", "walk", {}),
    (255, "stop", "gaze", {}),
    (275, "start", "pick_up", {}),
)
"""Frame, verb, model and parameters of each command."""
FLIGHT: Mapping[int, tuple[float, float, float]] = {
    150: (2.6, -9.0, 1.2), 180: (1.2, -8.2, 2.1), 215: (-0.9, -8.6, 2.3), 255: (-2.4, -9.6, 1.7),
}  # fmt: skip
"""Where the bird is by frame [m]."""
HANDS = ("Hand.L", "Hand.R")
PICKED = (285, 345)
"""Frames between which a hand is at its lowest."""


def furnish(ob: bpy.types.Object) -> None:
    """Let a character do what it is told, in the open scene.

    Args:
        ob: The sample's character, alone in the scene.
    """
    scene = rig.scene_of()
    scene.frame_end = FRAMES
    bpy.ops.morph_retarget.add_locomotion(character=ob.name)
    walks.checkers("Floor", *walks.lattice((-3.0, 3.0), (-10.0, 1.0), 0.5))
    bird, own = _bird(), of_rig(ob)
    own.gait.source = Source.COMMANDS.value
    for frame, verb, model, parameters in TOLD:
        values = {name: bird if name == "target" else value for name, value in parameters.items()}
        own.directing.command(frame, verb, model, **values)
    walks.light_and_camera((4.6, 0.0, 1.3), (0.0, 0.0, 0.8))
    follow = scene.camera.constraints.new("COPY_LOCATION")
    follow.target, follow.subtarget = ob, "Hips"
    follow.use_x, follow.use_z, follow.use_offset = False, False, True
    _apple(ob)
    scene.frame_set(1)


def _bird() -> bpy.types.Object:
    """Return something to look at that flies past."""
    bird = walks.added(stage.fruit_mesh("Bird", 0.06))
    for frame, place in FLIGHT.items():
        bird.location = place
        bird.keyframe_insert("location", frame=frame)
    return bird


def _apple(ob: bpy.types.Object) -> None:
    """Lay something where a hand picks up, and let it go with the hand from there."""
    scene, lowest = rig.scene_of(), (np.inf, 0, "")
    for frame in range(*PICKED):
        scene.frame_set(frame)
        heights = [(float((ob.matrix_world @ ob.pose.bones[name].tail).z), frame, name) for name in HANDS]
        lowest = min(lowest, *heights)
    _, frame, name = lowest
    scene.frame_set(frame)
    hand: Matrix = ob.matrix_world @ ob.pose.bones[name].matrix
    apple = walks.added(stage.fruit_mesh("Apple", 0.035))
    place = ob.matrix_world @ ob.pose.bones[name].tail
    apple.location = (place.x, place.y, 0.035)
    hold = apple.constraints.new("CHILD_OF")
    hold.target, hold.subtarget, hold.inverse_matrix = ob, name, hand.inverted()
    for when, influence in ((frame - 1, 0.0), (frame, 1.0)):
        hold.influence = influence
        hold.keyframe_insert("influence", frame=when)
