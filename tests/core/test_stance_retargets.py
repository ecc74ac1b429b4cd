"""Clips on rigs that rest in a stance: knees bend forward and toes point ahead, as they do in the clip."""

from functools import cache

import numpy as np
import pytest

from morph_retarget.core import pipeline, quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.character.character import Character
from morph_retarget.core.mocap.plan import RetargetSettings, prepare
from morph_retarget.core.skeleton import Pose
from tests.skeletons import joints, play, skeleton_of
from tests.stances import STANCES, stand
from tools import gait
from tools.figure import Build, humanoid, vrm

STEPS = gait.walk(3.0, 30.0)
SIDES = ("left", "right")
FACING = 90.0
"""Turn of some rigs about the vertical [deg]."""


@cache
def _rig(stance: str, facing: float = 0.0) -> Character:
    return analyze(stand(humanoid(build=Build(arms_down=40.0)), stance, vrm, facing))


@cache
def _walker() -> Character:
    return analyze(skeleton_of(humanoid()))


def _walking(target: Character) -> dict[str, Array]:
    """Return the joints of both legs of a rig that walks, character frame, by name, shapes (frame, 3)."""
    clip = gait.pose(_walker().skeleton, STEPS)
    result = pipeline.evaluate(prepare(_walker(), target, RetargetSettings()), clip, 1 / 30)
    names = [side + part for side in SIDES for part in ("UpperLeg", "LowerLeg", "Foot", "Toes")]
    return dict(zip(names, np.moveaxis(joints(target, play(target, result), *names), 1, 0), strict=True))


def _aside(ways: Array) -> Array:
    """Return how far ways point to a side from straight ahead [deg], shape (frame,)."""
    return np.abs(np.degrees(np.arctan2(ways[:, 0], -ways[:, 1])))


@pytest.mark.parametrize("facing", [0.0, FACING])
@pytest.mark.parametrize("stance", STANCES)
def test_knees_bend_forward_and_toes_point_ahead(stance: str, facing: float) -> None:
    found = _walking(_rig(stance, facing))
    for side in SIDES:
        hip, knee, ankle, ball = (found[side + part] for part in ("UpperLeg", "LowerLeg", "Foot", "Toes"))
        along = quat.unit(ankle - hip)
        bend = knee - hip - quat.dot(knee - hip, along)[:, None] * along
        assert np.median(_aside(bend)) < 10.0
        assert np.median(_aside(ball - ankle)) < 10.0


def test_a_clip_of_one_who_rests_in_a_stance_does_not_turn_feet_in() -> None:
    """The source may be the one whose rest is turned: its own feet are where they are."""
    source, target = _rig("turned out"), _walker()
    still = np.tile(source.skeleton.rest_positions, (3, 1, 1)), np.tile(source.skeleton.rest_rotations, (3, 1, 1))
    clip = Pose(still[1], still[0])
    result = pipeline.evaluate(prepare(source, target, RetargetSettings()), clip, 1 / 30)
    names = [side + part for side in SIDES for part in ("Foot", "Toes")]
    theirs, ours = joints(source, clip, *names), joints(target, play(target, result), *names)
    for i in (0, 2):
        assert np.allclose(_aside(ours[:, i + 1] - ours[:, i]), _aside(theirs[:, i + 1] - theirs[:, i]), atol=3.0)


def test_small_turns_of_feet_at_rest_stay_those_of_the_rig() -> None:
    plan = prepare(_walker(), _rig("bent forward"), RetargetSettings())
    assert all(leg.turn == (1.0, 0.0, 0.0, 0.0) for leg in plan.links.legs)
