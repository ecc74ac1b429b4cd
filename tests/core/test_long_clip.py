"""Long clips: played block by block, they are what they are as a whole."""

import numpy as np
import pytest

from morph_retarget.core import long_clip, play, quat
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.long_clip import BLOCK
from morph_retarget.core.morph.bind import GeneralizedAction, bind
from morph_retarget.core.morph.bodies import Bodies
from morph_retarget.core.morph.channels import Channel, TargetKind, Values
from morph_retarget.core.morph.context import Context
from morph_retarget.core.morph.movement import Movement, ScaleMode
from tests.skeletons import skeleton_of
from tools.figure import Build, humanoid

LIMB = Movement(scale=ScaleMode.LIMB_LENGTH)
CHANNELS = (
    Channel("Body", Context(Capability.ROOT), LIMB),
    Channel("Head", Context(Capability.HEAD), Movement(look_at=True), TargetKind.EXTERNAL, poses_position=False),
    Channel("Feet", Context(Capability.FOOT), LIMB),
    Channel(
        "To the head",
        Context(Capability.GRASPER),
        Movement(secondary_relative=True),
        TargetKind.CONTEXT,
        secondary=Context(Capability.HEAD),
    ),
)


def _part() -> play.Part:
    character = analyze(skeleton_of(humanoid(1.75, build=Build(fingers=1)), np.random.default_rng(0)))
    return play.prepare(character, bind(GeneralizedAction("Long", CHANNELS), Bodies.of(character)))


def _values(frames: int) -> Values:
    rng, count = np.random.default_rng(1), len(CHANNELS)
    turns = quat.from_rotation_vector(rng.uniform(-0.4, 0.4, (frames, count, 3)))
    deforms = {(1, "open"): rng.uniform(0.0, 1.0, frames)}
    return Values(rng.uniform(-0.3, 0.3, (frames, count, 3)), turns, rng.uniform(0.0, 1.0, (frames, count)), deforms)


@pytest.mark.parametrize("moving", [False, True])
def test_a_clip_of_several_blocks_is_that_of_one(moving: bool) -> None:
    part, frames = _part(), 2 * BLOCK + 7
    values = _values(frames)
    target = np.random.default_rng(2).uniform(-2.0, 2.0, (frames if moving else 1, 3))
    whole, shares = play.evaluate(part, values, {1: target}), list[float]()
    steps = long_clip.evaluate(part, values, {1: target})
    while True:
        try:
            shares.append(next(steps))
        except StopIteration as end:
            found = end.value
            break
    assert shares == [BLOCK / frames, 2 * BLOCK / frames]
    assert quat.angle_between(found.basis, whole.basis).max() < 1e-9
    for one, other in (
        (found.shift, whole.shift),
        (found.pose.positions, whole.pose.positions),
        (found.goals.positions, whole.goals.positions),
        (found.followed, whole.followed),
        *((found.deforms[key], whole.deforms[key]) for key in whole.deforms),
    ):
        assert one.shape == other.shape
        assert np.abs(one - other).max() < 1e-9


@pytest.mark.parametrize("frames", [1, BLOCK])
def test_a_short_clip_is_played_at_once(frames: int) -> None:
    assert list(long_clip.evaluate(_part(), _values(frames), {1: np.zeros((1, 3))})) == []
