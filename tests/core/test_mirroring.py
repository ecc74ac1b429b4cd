"""Mirrored transfers: twice is the motion again, and once is what the mirror shows."""

import numpy as np
import pytest

from morph_retarget.core import pipeline, quat
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.errors import MappingError
from morph_retarget.core.mocap import mirroring
from morph_retarget.core.mocap.motion import SourceMotion
from morph_retarget.core.mocap.plan import Plan, RetargetSettings, prepare
from morph_retarget.core.skeleton import Pose, Skeleton
from tests.skeletons import skeleton_of
from tools import gait
from tools.figure import CHIBI, Bone, Build, humanoid

FPS = 30.0


@pytest.fixture(scope="module")
def walker() -> Skeleton:
    return skeleton_of(humanoid())


@pytest.fixture(scope="module")
def walk(walker: Skeleton) -> Pose:
    return gait.pose(walker, gait.walk(1.1, FPS, 1.75, (0.1, 0.6)))


def plan_of(walker: Skeleton, mirror: bool) -> Plan:
    target = skeleton_of(humanoid(height=1.1, proportions=CHIBI, build=Build(spine=4, arms_down=40.0)))
    return prepare(analyze(walker), analyze(target), RetargetSettings(mirror=mirror))


def test_links_have_partners_on_the_other_side() -> None:
    for name, other in (
        ("leftHand", "rightHand"),
        ("hips", "hips"),
        ("leg0.l[1]", "leg0.r[1]"),
        ("Left Foot 2", "Right Foot 2"),
        ("tail0[2]", "tail0[2]"),
    ):
        assert mirroring.other_side(name) == other
        assert mirroring.other_side(other) == name


def test_further_bones_turn_as_a_joint_does_and_wrong_ones_are_refused(walker: Skeleton, walk: Pose) -> None:
    claw = Bone("Claw", "rightHand", (-0.5, 0.0, 0.9), (-0.6, 0.0, 0.8))
    target = analyze(skeleton_of([*humanoid(height=1.1), claw]))
    plan = prepare(analyze(walker), target, RetargetSettings(also=(("leftHand", "Claw"),)))
    motion = pipeline.evaluate(plan, walk, 1.0 / FPS).motion
    own, joint = plan.links.index("leftHand+Claw"), plan.links.index("leftHand")
    relative = quat.multiply(motion.turns[:, own], quat.conjugate(motion.turns[:, joint]))
    assert quat.angle_between(relative, relative[:1]).max() < 1e-6
    for also, message in (
        (("leftPaw", "Claw"), "'leftPaw', which is no joint"),
        (("leftHand", "Nobody"), "the target has no such bone"),
        (("jaw", "Claw"), "which the source does not have"),
        (("leftHand", "rightHand"), "but is rightHand already"),
    ):
        with pytest.raises(MappingError, match=message):
            prepare(analyze(walker), target, RetargetSettings(also=(also,)))


def test_mirrored_twice_is_the_motion_again(walker: Skeleton, walk: Pose) -> None:
    plan = plan_of(walker, mirror=False)
    source = SourceMotion.read(plan, walk, 1.0 / FPS, None)
    again = source
    for _ in range(2):
        again = mirroring.mirrored(again, plan.links, plan.transfer.post)
    assert quat.angle_between(again.turns, source.turns).max() < 1e-9
    assert np.abs(again.points - source.points).max() < 1e-12
    assert (again.steps.ankle == source.steps.ankle).all()


def test_a_mirrored_transfer_is_what_the_mirror_shows_of_the_plain_one(walker: Skeleton, walk: Pose) -> None:
    plain, mirrored = (
        pipeline.evaluate(plan, walk, 1.0 / FPS) for plan in (plan_of(walker, False), plan_of(walker, True))
    )
    plan = plan_of(walker, mirror=True)
    other = mirroring.partners(plan.links)
    expected = plain.motion.points[:, other] * np.array([-1.0, 1.0, 1.0])
    assert np.linalg.norm(mirrored.motion.points - expected, axis=-1).max() < 1e-3 * plan.target.frame.height
