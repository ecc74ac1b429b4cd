"""How results look: the target at some frames, as Blender evaluates it, so that constraints and drivers count."""

from dataclasses import replace

import bpy
import numpy as np

from ...core.skeleton import Pose
from ...core.validation import drawing
from ...core.validation.drawing import Strip
from ...core.verdicts.performance import Performance
from .. import rig
from ..retarget import Outcome
from ..sampling import seconds_per_frame


def strip_of(ob: bpy.types.Object, outcome: Outcome) -> Strip:
    """Return pictures of what an armature was given, from the first frame of the scene to the last.

    The rows of the pictures count from the scene's first frame; the scene stays at the frame it was at.
    """
    scene, own, character = rig.scene_of(), rig.read(ob), outcome.plan.target
    rows = drawing.chosen(scene.frame_end - scene.frame_start + 1)
    before = scene.frame_current, scene.frame_subframe
    try:
        poses = [_pose(ob, own, scene.frame_start + row) for row in rows.tolist()]
    finally:
        scene.frame_set(before[0], subframe=before[1])
    turns, places = (np.array(part) for part in zip(*poses, strict=True))
    root = int(outcome.plan.links.target[0])
    performance = Performance.of_pose(character, root, Pose(turns, places), seconds_per_frame(scene))
    return replace(drawing.strip_of(performance), rows=rows)


def _pose(ob: bpy.types.Object, own: rig.Rig, frame: int) -> tuple[np.ndarray, np.ndarray]:
    rig.scene_of().frame_set(frame)
    return rig.read_pose(own, ob.evaluated_get(bpy.context.evaluated_depsgraph_get()))
