"""What generalized actions cost: specializing and blending in the core, and an edit with many characters in Blender."""

from pathlib import Path

import bpy
import numpy as np

from morph_retarget.blender import registration
from morph_retarget.blender.io import load
from morph_retarget.blender.io.load import Request
from morph_retarget.blender.morph import cast, definitions, keys
from morph_retarget.core import play, quat
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.morph.bind import GeneralizedAction, bind
from morph_retarget.core.morph.bodies import Bodies
from morph_retarget.core.morph.channels import Channel, MirrorRule, TargetKind, Values
from morph_retarget.core.morph.context import Context, Extent, Height, Side
from morph_retarget.core.morph.movement import Movement, RotationMode, ScaleMode
from tests.skeletons import skeleton_of
from tools.figure import Build, humanoid

from .figures import Figure, medians, seconds

BUILD = Build(spine=4, neck=2, root=True)
"""Gives 25 bones."""
FRAMES = 250
CHARACTERS = ("asura", "beetle", "biped", "bird", "hound", "lopside")
SAMPLES = Path(__file__).resolve().parents[2] / "sample_blends" / "characters"
REPETITIONS = 40
ALONE = 20
"""Single frames that one repetition takes the mean of."""

_LIMB, _SIZE = Movement(scale=ScaleMode.LIMB_LENGTH), Movement(scale=ScaleMode.CREATURE_SIZE)
CHANNELS = (
    Channel("Body", Context(Capability.ROOT), _SIZE),
    Channel("Feet", Context(Capability.FOOT), Movement(scale=ScaleMode.LIMB_LENGTH, ground_relative=True)),
    Channel("Chest", Context(Capability.SPINE, extent=Extent.TOP_MOST), poses_position=False),
    Channel("Neck", Context(Capability.NECK), poses_position=False),
    Channel("Head", Context(Capability.HEAD), Movement(look_at=True), TargetKind.EXTERNAL, poses_position=False),
    Channel("Hands", Context(Capability.GRASPER), _LIMB, blend_group="hands", mirror=MirrorRule.LEFT),
    Channel("Clap", Context(Capability.GRASPER), Movement(sagittal_relative=True), blend_group="hands"),
    Channel(
        "Reach",
        Context(Capability.GRASPER, side=Side.LEFT),
        Movement(secondary_relative=True),
        TargetKind.EXTERNAL,
        blend_group="hands",
    ),
    Channel("Palms", Context(Capability.GRASPER), Movement(rotation=RotationMode.ABSOLUTE), blend_group="hands"),
    Channel("Legs", Context(Capability.LIMB, height=Height.BOTTOM), poses_position=False),
)


def run() -> list[Figure]:
    """Return the times of a frame in a batch, of one frame alone, and of an edit."""
    batch, alone, posed = _core()
    return [
        Figure("perform: specialize and blend, in a batch of 250", 1e6 * batch / FRAMES, "µs a frame", 10.0),
        Figure("perform: specialize and blend, one frame alone", 1e6 * alone, "µs", 300.0),
        Figure("perform: the same and the pose, in a batch of 250", 1e6 * posed / FRAMES, "µs a frame"),
        Figure("perform: from an edited key to all six characters", 1e3 * _edit(), "ms", 16.0),
    ]


def _core() -> tuple[float, float, float]:
    """Return the times of goals for a batch and for one frame, and of poses for a batch [s]."""
    character = analyze(skeleton_of(humanoid(1.75, build=BUILD), np.random.default_rng(0)))
    part = play.prepare(character, bind(GeneralizedAction("Bench", CHANNELS), Bodies.of(character)))
    batch, one = _values(FRAMES), _values(1)
    target = {i: np.array([[0.3, -0.6, 1.2]]) for i, c in enumerate(CHANNELS) if c.target is TargetKind.EXTERNAL}
    print(f"{len(CHANNELS)} channels pose {len(part.binding.entries)} times on {len(character.skeleton)} bones")
    times = medians(
        [
            lambda: seconds(lambda: play.goals_at(part, batch, target)),
            lambda: seconds(lambda: [play.goals_at(part, one, target) for _ in range(ALONE)]) / ALONE,
            lambda: seconds(lambda: play.evaluate(part, batch, target)),
        ],
        REPETITIONS,
    )
    return times[0], times[1], times[2]


def _values(frames: int) -> Values:
    rng, count = np.random.default_rng(1), len(CHANNELS)
    rotations = quat.from_rotation_vector(rng.uniform(-0.5, 0.5, (frames, count, 3)))
    return Values(rng.uniform(-0.3, 0.3, (frames, count, 3)), rotations, np.ones((frames, count)))


def _edit() -> float:
    """Return the time from the change of one key to the new pose on all characters [s]."""
    bpy.ops.wm.read_homefile(use_empty=True)
    registration.register("morph_retarget")
    try:
        cast_ = [load.add(Request(SAMPLES / f"{name}.blend"))[0] for name in CHARACTERS]
        action = bpy.data.actions.new("Bench")
        for channel in CHANNELS:
            definitions.add(action, channel)
        target = bpy.data.objects.new("Target", None)
        target.location = (0.3, -0.6, 1.2)
        for ob in cast_:
            cast.add(ob, action)
            for item in ob.morph_retarget.channels:
                item.target = target
        for frame in (1, 50):
            keys.insert(cast_[0], "Hands", ("position",), frame)
        bpy.context.scene.frame_set(20)
        curve = keys.curves(action)[keys.path("Hands", "position"), 1]
        turn = iter(range(10**6))

        def edit() -> float:
            curve.keyframe_points[1].co.y = -0.3 - 0.002 * next(turn)  # a pose that has never been shown
            return seconds(lambda: (curve.update(), bpy.context.view_layer.update()))

        [median] = medians([edit], REPETITIONS)
    finally:
        registration.unregister()
    return median
