"""The time that a motion tree takes: frames and ways of one that is as deep as those that motion models build."""

import numpy as np

from morph_retarget.core import quat
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.clips.character_model import CharacterModel
from morph_retarget.core.clips.clip import Clip
from morph_retarget.core.clips.operators.blend import Blend
from morph_retarget.core.clips.operators.loop import Loop
from morph_retarget.core.clips.operators.noise import Noise
from morph_retarget.core.clips.operators.overlay import Overlay
from morph_retarget.core.clips.operators.time_shift import TimeShift
from morph_retarget.core.clips.operators.time_warp import TimeWarp
from morph_retarget.core.morph.bodies import Bodies
from morph_retarget.core.play import root_of
from tests.random_clips import wander
from tests.skeletons import skeleton_of
from tools.figure import humanoid

from .core import BUILD
from .figures import Figure, medians, seconds

FRAMES = 250
REPETITIONS = 40


def run() -> list[Figure]:
    """Return the time a frame."""
    character = analyze(skeleton_of(humanoid(1.75, build=BUILD), np.random.default_rng(0)))
    model = CharacterModel(character, root_of(Bodies.of(character)))
    clip, times = tree(model), np.arange(float(FRAMES))
    turns, others = clip.frame(times).rotations, clip.frame(times + 0.5).rotations
    share = np.linspace(0.0, 1.0, FRAMES)[:, None]
    frame, way, slerp = medians(
        [
            lambda: seconds(lambda: clip.frame(times)),
            lambda: seconds(lambda: clip.travel(times)),
            lambda: seconds(lambda: quat.slerp(turns, others, share)),
        ],
        REPETITIONS,
    )
    frame, way, slerp = (1e6 * taken / FRAMES for taken in (frame, way, slerp))
    print(f"depth {_depth(clip)}, {FRAMES} frames of {len(model)} joints")
    print(
        f"frames {frame:.3g} µs, ways {way:.3g} µs; a slerp of as many {slerp:.3g} µs, so {frame / slerp:.3g} of these"
    )
    return [Figure("clips: a motion tree of depth 6", frame + way, "µs a frame", 20.0, slerp)]


def tree(model: CharacterModel) -> Clip:
    """Return a start that goes over to a walk and then to a run, both warped to their speeds, with a wave over them."""
    start, walk, run_, wave = (
        wander(1, 30, model=model),
        wander(2, 32, model=model),
        wander(3, 22, model=model),
        wander(4, 90, model.part("arms"), model=model),
    )
    walking = Loop(0, TimeWarp(((0.0, 0.0), (31.0, 27.3)), walk), 6.0, 27.3 / 31.0)
    running = Loop(0, TimeWarp(((0.0, 0.0), (21.0, 23.1)), run_), 6.0, 1.1)
    going = Blend(0.0, 130.0, 120.0, 140.0, Blend(0.0, 25.0, 20.0, 30.0, start, walking), running)
    waving = Overlay(going, TimeShift(80.5, wave), model.part("arms"), 10.0, 10.0)
    return Noise(waving, model.part("head", "trunk"), 0.03, 0.5)


def _depth(clip: Clip) -> int:
    """Return how many operators lie over the deepest primitive."""
    return 1 + max(map(_depth, clip.parts)) if clip.parts else 0
