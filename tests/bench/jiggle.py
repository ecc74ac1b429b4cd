"""What jiggles cost: thirty bones on a body that runs, turns and leaps, simulated over a clip."""

import numpy as np

from morph_retarget.core import jiggling, quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.jiggling import Jiggling
from morph_retarget.core.skeleton import Pose
from morph_retarget.core.solve.jiggle_kinds import JiggleSettings
from tests.skeletons import skeleton_of
from tools.figure import Bone, humanoid

from .figures import Figure, medians, seconds

STRANDS, SEGMENTS = 6, 5
FRAMES, STEP = 250, 1 / 24
REPETITIONS = 40


def run() -> list[Figure]:
    """Return the times of a frame in a batch, without and with a ground, and how long the search takes."""
    free, grounded = _hairy(JiggleSettings()), _hairy(JiggleSettings(ground=True))
    pose = _carried(free)
    print(f"{len(free.chains)} bones jiggle on {len(free.character.skeleton)}, over {FRAMES} frames")
    times = medians(
        [
            lambda: seconds(lambda: jiggling.changes(free, pose, STEP)),
            lambda: seconds(lambda: jiggling.changes(grounded, pose, STEP)),
            lambda: seconds(lambda: jiggling.prepare(free.character, (), free.settings)),
        ],
        REPETITIONS,
    )
    return [
        Figure("jiggle: 30 bones", 1e6 * times[0] / FRAMES, "µs a frame", 30.0),
        Figure("jiggle: 30 bones and the ground", 1e6 * times[1] / FRAMES, "µs a frame"),
        Figure("jiggle: finding what jiggles", 1e3 * times[2], "ms"),
    ]


def _hairy(settings: JiggleSettings) -> Jiggling:
    """Return a human with six strands of hair, five bones each, and what jiggles on it."""
    bones = humanoid(1.75)
    for strand in range(STRANDS):
        side = 0.04 * (strand - 0.5 * (STRANDS - 1))
        places = [(side, 0.1 + 0.01 * i, 1.65 - 0.08 * i) for i in range(SEGMENTS + 1)]
        names = [f"hair_{strand}_{i}" for i in range(SEGMENTS)]
        above = ["head", *names]
        bones += [Bone(names[i], above[i], places[i], places[i + 1]) for i in range(SEGMENTS)]
    return jiggling.prepare(analyze(skeleton_of(bones, np.random.default_rng(0))), (), settings)


def _carried(what: Jiggling) -> Pose:
    time = np.arange(FRAMES) * STEP
    turns = quat.from_rotation_vector(np.stack([0.2 * np.sin(7.0 * time), 0.0 * time, 2.0 * np.sin(time)], axis=-1))
    places: Array = np.stack([np.sin(time), np.cos(2.0 * time), 0.1 * np.sin(6.0 * time)], axis=-1)
    rest = what.character.skeleton.rest_positions[what.chains.bones]
    rotations = quat.multiply(turns[:, None], what.chains.rest)
    return Pose(rotations, places[:, None] + quat.rotate(turns[:, None], rest))
