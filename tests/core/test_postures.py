"""How people walk whose rest is a stance: toes and knees to the front, feet under the hips, whatever the rest does."""

from functools import cache

import numpy as np
import pytest

from morph_retarget.core import quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.character.character import Character
from morph_retarget.core.locomotion import getting_about
from morph_retarget.core.locomotion.stepping import legs, posture
from morph_retarget.core.solve.limb_settings import LimbSettings
from morph_retarget.core.solve.settings import SolverSettings
from tests import gait_courses, gait_measures
from tests.gait_courses import Size, Trial
from tests.gait_measures import Walked
from tests.goal_sets import Subject
from tests.stances import stand
from tools.figure import Build, humanoid, vrm

STANDING = ("fighting", "wide", "turned out")


@cache
def _character(stance: str) -> Character:
    return analyze(stand(humanoid(build=Build(arms_down=40.0)), stance, vrm))


@cache
def _walked(stance: str) -> Walked:
    character = _character(stance)
    trial = Trial(gait_courses.straight(Size.of(legs.find(character)), 0.3), steady=True)
    return gait_measures.walk(Subject(character), trial)


def _outward(ways: Array, side: int) -> Array:
    """Return how far ways point out to the side of a leg from straight ahead [deg], shape (...)."""
    return np.degrees(np.arctan2(side * ways[..., 0], -ways[..., 1]))


@pytest.mark.parametrize("stance", STANDING)
def test_toes_and_knees_point_ahead(stance: str) -> None:
    walked = _walked(stance)
    stands = walked.gait.contacts(walked.times)
    for i, leg in enumerate(legs.find(walked.subject.character).legs):
        tips = quat.rotate(walked.turns[:, leg.foot], np.broadcast_to(leg.tip, (len(walked.times), 3)))
        assert np.abs(_outward(tips[stands[:, i]], leg.side)).mean() < 16.0
        hip, knee, foot = (walked.places[:, bone] for bone in (*leg.path[:2], leg.foot))
        along = quat.unit(foot - hip)
        bend = knee - hip - quat.dot(knee - hip, along)[:, None] * along
        assert np.abs(np.median(_outward(bend, leg.side))) < 16.0


@pytest.mark.parametrize("stance", STANDING)
def test_feet_come_under_the_hips_and_stand_still(stance: str) -> None:
    walked = _walked(stance)
    stands = walked.gait.contacts(walked.times)
    for i, leg in enumerate(walked.gait.legs.legs):
        out = leg.side * (walked.places[stands[:, i], leg.foot, 0] - leg.hip[0])
        assert out.max() < (posture.SPLAYED + 0.02) * leg.length
    assert gait_measures.slips(walked).max() < 1e-3
    assert gait_measures.gaps(walked).max() < 5e-3
    assert not gait_measures.flips(walked).any()


@pytest.mark.parametrize("stance", STANDING)
def test_legs_stay_as_long_as_they_rest(stance: str) -> None:
    found = legs.find(_character(stance))
    upright, raised = posture.upright(_character(stance), found)
    assert raised >= 0.0
    spans = [(quat.length(leg.home - leg.hip), leg.length) for leg in (*found.legs, *upright.legs)]
    before, after = np.array(spans).reshape(2, -1, 2)
    assert (after[:, 0] < before[:, 0] + 1e-9).all(), "a leg is stretched"
    assert np.isclose(after[:, 0], before[:, 0]).any(), "the body is lower than it could be"


@pytest.mark.parametrize("stance", ["kneeling", "bent forward"])
def test_feet_that_do_not_stand_or_stand_well_are_not_turned(stance: str) -> None:
    upright, _ = posture.upright(_character(stance), legs.find(_character(stance)))
    assert not any(leg.turn for leg in upright.legs)


def test_knees_turn_with_feet_beyond_what_the_user_has_set() -> None:
    character = _character("turned out")
    trial = Trial(gait_courses.straight(Size.of(legs.find(character)), 0.3), steady=True)
    moving = gait_measures.prepared(Subject(character), trial)
    own = SolverSettings(pull=0.5, limbs={"leftFoot": LimbSettings(swivel=12.0, softness=0.3)})
    tuned = getting_about.tuned(own, moving)
    turn = float(np.degrees(moving.legs.legs[0].turn))
    assert turn < -20.0, "the left foot is turned in, to the right"
    assert tuned.limbs["leftFoot"] == LimbSettings(swivel=12.0 + turn, softness=0.3)
    assert tuned.limbs["rightFoot"] == LimbSettings(swivel=pytest.approx(turn), pull=0.5)
