"""The motion path in the viewport: where the active channel brings the active body, and its target.

Hecker 2008 draws this red curve (figures 2 and 3): it shows how a movement bends when its target moves.
"""

import bpy
import numpy as np

from ...core.errors import MorphError
from ..morph import paths, stage
from .strokes import PATH, TARGET, THICK, Stroke

CROSS = 0.03
"""Half the width of the target's cross, as a share of the character's size."""
KEY = 7.0
"""Size of the points at keys [px]."""


def strokes(ob: bpy.types.Object, scene: bpy.types.Scene, graph: bpy.types.Depsgraph) -> list[Stroke]:
    """Return what is drawn of a character's active channel, nothing where that places nothing."""
    try:
        found = paths.path_of(ob, scene, graph)
    except MorphError:
        return []  # the panel tells what is wrong
    if found is None:
        return []
    out = [Stroke("LINE_STRIP", stage.to_world(ob, found.line), PATH, THICK)]
    if len(found.keyed):
        out.append(Stroke("POINTS", stage.to_world(ob, found.keyed), PATH, KEY))
    if found.target is not None:
        arms = CROSS * found.size * np.stack([np.eye(3), -np.eye(3)], axis=1).reshape(6, 3)
        out.append(Stroke("LINES", stage.to_world(ob, found.target + arms), TARGET, THICK))
    return out
