"""The time that the core takes for a clip in one batch: transfer and foot constraints, Blender aside."""

import numpy as np

from morph_retarget.core import pipeline
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.mocap.plan import prepare
from tests.skeletons import skeleton_of
from tools import gait
from tools.figure import CHIBI, Build, blender, humanoid

from .figures import Figure, medians, seconds

FRAMES, FPS = 300, 30.0
BUILD = Build(spine=5, neck=3, fingers=5, twists=1, root=True)
"""Gives 65 bones."""
REPETITIONS = 40


def run() -> list[Figure]:
    """Return the time a frame."""
    rng = np.random.default_rng(0)
    walker = skeleton_of(humanoid(1.75, build=BUILD), rng)
    sprout = skeleton_of(humanoid(1.1, CHIBI, BUILD, blender), rng)
    plan = prepare(analyze(walker), analyze(sprout))
    pose = gait.pose(walker, gait.walk((FRAMES - 1) / FPS, FPS))
    [median] = medians([lambda: seconds(lambda: pipeline.evaluate(plan, pose, 1.0 / FPS))], REPETITIONS)
    figure = 1e6 * median / len(pose)
    print(f"{len(walker)} bones to {len(sprout)}, {len(plan.links)} joints linked, {len(pose)} frames")
    return [Figure("core: transfer and foot constraints", figure, "µs a frame", 60.0)]
