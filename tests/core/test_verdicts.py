"""Verdicts: each fails on a performance that is made to violate it, and passes on a sound one."""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from morph_retarget.core import quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.character.character import Character
from morph_retarget.core.errors import MotionError
from morph_retarget.core.skeleton import pose_from_basis
from morph_retarget.core.verdicts import crossing, goals, grounding, hinges, lengths, popping, sliding
from morph_retarget.core.verdicts.judging import DEFAULT, VERDICTS, Limits, judge
from morph_retarget.core.verdicts.performance import Aim, Performance, Turn
from morph_retarget.core.verdicts.verdict import Found, Verdict
from tests import goal_sets
from tests.skeletons import skeleton_of
from tools.figure import Bone, humanoid, moved

FRAMES, FPS = 13, 24.0
X, Y, Z = np.eye(3)


@cache
def _human(scale: float = 1.0) -> Character:
    eyes = [Bone("leftEye", "head", (0.03, -0.08, 1.62), (0.03, -0.1, 1.62))]
    return analyze(skeleton_of(moved([*humanoid(), *eyes], np.diag([scale, scale, scale, 1.0]))))


@cache
def _two_eyed() -> Character:
    eyes = [
        Bone(f"{side}Eye", "head", (x, -0.08, 1.62), (x, -0.1, 1.62)) for side, x in (("left", 0.03), ("right", -0.03))
    ]
    return analyze(skeleton_of([*humanoid(), *eyes]))


def _bone(character: Character, name: str) -> int:
    return character.skeleton.index[name]


def _performance(
    turns: Mapping[str, Array] | None = None, shift: Array | None = None, character: Character | None = None
) -> Performance:
    """Return a human whose bones are turned, by rotation vectors [deg], shape (frame or 1, 3), and whose hips move."""
    own = character or _human()
    count = len(own.skeleton)
    rotations, locations = quat.identity(FRAMES, count), np.zeros((FRAMES, count, 3))
    for name, turn in (turns or {}).items():
        rotations[:, _bone(own, name)] = quat.from_rotation_vector(np.radians(turn))
    if shift is not None:
        locations[:, _bone(own, "hips")] = shift
    pose = pose_from_basis(own.skeleton, rotations, locations)
    return Performance.of_pose(own, _bone(own, "hips"), pose, 1.0 / FPS)


def _aim(performance: Performance, name: str, shift: Array, influence: float = 1.0) -> Aim:
    """Return a goal for a hand, off from where it is at rest."""
    body, side = _bone(performance.character, name), name.removesuffix("Hand")
    places = np.broadcast_to(performance.rest[body] + shift, (FRAMES, 3))
    joints = tuple(_bone(performance.character, side + part) for part in ("UpperArm", "LowerArm"))
    return Aim(body, places, np.full(FRAMES, influence), joints)


def _arm(performance: Performance) -> float:
    own = _aim(performance, "leftHand", np.zeros(3))
    return performance.hierarchy.lengths(own.joints, own.body)[0]


# --- what is sound ---


@pytest.mark.parametrize("name", [name for name, own in goal_sets.creatures().items() if own.limbs])
def test_who_stands_still_passes_every_verdict(name: str) -> None:
    subject = goal_sets.Subject(goal_sets.creatures()[name])
    own = subject.character.skeleton
    still = pose_from_basis(own, quat.identity(FRAMES, len(own)), np.zeros((FRAMES, len(own), 3)))
    found = judge(Performance.of_pose(subject.character, subject.root, still, 1.0 / FPS))
    assert tuple(found) == VERDICTS
    assert [name for name, verdict in found.items() if not verdict.passed] == []


def test_verdicts_do_not_depend_on_size() -> None:
    turns = {"leftLowerLeg": -30.0 * X, "leftUpperArm": np.linspace(0.0, 90.0, FRAMES)[:, None] * Y}
    small, large = (
        judge(_performance(turns, np.array([0.0, 0.0, -0.1 * scale]), _human(scale))) for scale in (1.0, 100.0)
    )
    for name in VERDICTS:
        assert small[name].value == pytest.approx(large[name].value, rel=1e-6, abs=1e-9), name


# --- goals ---


def test_a_goal_within_reach_that_is_not_come_to_is_missed_by_its_distance() -> None:
    performance = _performance()
    away = replace(performance, aims=(_aim(performance, "leftHand", np.array([-0.1, 0.0, 0.0])),))
    found = goals.missed(away)
    assert found.value == pytest.approx(0.1 / _arm(performance))
    assert found.name == "leftHand"
    assert goals.missed(replace(performance, aims=(_aim(performance, "leftHand", np.zeros(3)),))).value < 1e-9


def test_a_goal_out_of_reach_is_met_by_a_limb_that_stretches_toward_it() -> None:
    performance = _performance()
    ahead = replace(performance, aims=(_aim(performance, "leftHand", np.array([2.0, 0.0, 0.0])),))
    assert goals.missed(ahead).value < DEFAULT.goals
    behind = replace(performance, aims=(_aim(performance, "leftHand", np.array([-2.0, 0.0, 0.0])),))
    assert goals.missed(behind).value > 0.5


def test_a_spine_need_not_fold_for_a_goal_before_its_nose() -> None:
    performance = _performance()
    near = replace(_aim(performance, "leftHand", np.zeros(3)), folds=0.7)
    start, way = performance.rest[near.joints[0]], _arm(performance) * X
    for share in (0.98, 0.7, 0.5):
        asked = replace(near, places=np.broadcast_to(start + share * way, (FRAMES, 3)))
        left = goals.missed(replace(performance, aims=(asked,))).value
        assert left == pytest.approx(1.0 - max(share, 0.7), abs=0.02)


def test_what_hangs_on_one_joint_shall_come_to_its_goals_together() -> None:
    performance = _performance(character=_two_eyed())
    joints = tuple(_bone(performance.character, name) for name in ("neck", "head"))
    eyes = [_bone(performance.character, name) for name in ("leftEye", "rightEye")]

    def missed(*shifts: Array) -> float:
        places = [
            np.broadcast_to(performance.rest[eye] + by, (FRAMES, 3)) for eye, by in zip(eyes, shifts, strict=True)
        ]
        aims = tuple(Aim(eye, own, np.ones(FRAMES), joints) for eye, own in zip(eyes, places, strict=True))
        return goals.missed(replace(performance, aims=aims)).value

    down = np.array([0.0, 0.02, -0.05])
    assert missed(np.array([-0.03, 0.0, 0.0]), np.array([0.03, 0.0, 0.0])) < 1e-9, (
        "both to one place: the middle counts"
    )
    assert missed(down, down) > DEFAULT.goals


def test_a_goal_that_counts_in_part_is_not_judged() -> None:
    performance = _performance()
    part = replace(performance, aims=(_aim(performance, "leftHand", np.array([-0.1, 0.0, 0.0]), 0.5),))
    assert goals.missed(part).value == 0.0


def test_the_root_has_to_be_where_it_is_asked_to_be() -> None:
    performance = _performance(shift=np.array([0.0, 0.0, 0.2]))
    hips = performance.root
    asked = Aim(hips, np.broadcast_to(performance.rest[hips], (FRAMES, 3)), np.ones(FRAMES), ())
    assert goals.missed(replace(performance, aims=(asked,))).value > DEFAULT.goals


# --- the ground ---


def test_who_sinks_is_below_the_ground_by_that_much() -> None:
    performance = _performance(shift=np.array([0.0, 0.0, -0.1]))
    assert grounding.sunk(performance).value * performance.size == pytest.approx(0.1, abs=0.01)
    assert grounding.sunk(_performance(shift=np.array([0.0, 0.0, 0.3]))).value == 0.0


def test_the_ground_may_be_anything() -> None:
    hill = replace(_performance(), ground=lambda points: np.full(len(points), 0.25))
    assert grounding.sunk(hill).value * hill.size == pytest.approx(0.25, abs=0.01)
    nothing = replace(
        _performance(shift=np.array([0.0, 0.0, -1.0])), ground=lambda points: np.full(len(points), np.nan)
    )
    assert grounding.sunk(nothing).value == 0.0


def test_a_body_that_rests_deep_below_zero_has_no_ground() -> None:
    standing = _human()
    hovering = replace(standing, frame=replace(standing.frame, origin=standing.frame.origin + Z))
    performance = _performance(shift=np.array([0.0, 0.0, -0.5]), character=hovering)
    assert performance.rest[:, 2].min() == pytest.approx(-1.0, abs=0.05)
    assert grounding.sunk(performance).value == 0.0


# --- slide ---


def _sliding(speed: float) -> Performance:
    """Return a human whose standing feet, with all of him, move sideways at a speed [leg lengths a second]."""
    times = np.arange(FRAMES) / FPS
    own = _performance(shift=(speed * _performance().legs[0].length * times)[:, None] * X)
    return replace(own, standing=np.ones((FRAMES, 2), dtype=bool))


def test_standing_feet_that_move_slide_at_their_speed() -> None:
    assert sliding.slid(_sliding(0.5)).value == pytest.approx(0.5)
    assert sliding.slid(_sliding(0.0)).value < 1e-9
    flying = replace(_sliding(0.5), standing=np.zeros((FRAMES, 2), dtype=bool))
    assert sliding.slid(flying).value == 0.0


def test_a_foot_stands_while_its_goal_does() -> None:
    moving = replace(_sliding(0.5), standing=None)
    foot = _bone(moving.character, "leftFoot")
    still = Aim(foot, np.broadcast_to(moving.rest[foot], (FRAMES, 3)), np.ones(FRAMES), (foot - 1,))
    assert sliding.slid(replace(moving, aims=(still,))).value == pytest.approx(0.5)
    stepping = replace(still, places=moving.places[:, foot])
    other = replace(stepping, body=_bone(moving.character, "rightFoot"))
    assert sliding.slid(replace(moving, aims=(stepping, other))).value == 0.0


def test_a_foot_without_a_goal_stands_while_it_is_slow_and_low() -> None:
    assert sliding.slid(replace(_sliding(0.15), standing=None)).value == pytest.approx(0.15)
    assert sliding.slid(replace(_sliding(1.5), standing=None)).value == 0.0


def test_a_foot_that_rolls_off_its_tip_does_not_slide() -> None:
    performance = replace(_performance(), standing=np.ones((FRAMES, 2), dtype=bool))
    leg = performance.legs[0]
    turns = quat.from_axis_angle(X, np.linspace(0.0, 0.8, FRAMES))
    performance.turns[:, leg.foot] = turns
    performance.places[:, leg.foot] = leg.home + leg.tip - quat.rotate(turns, leg.tip)
    assert np.ptp(performance.places[:, leg.foot, 1]) > 0.02
    assert sliding.slid(performance).value < 1e-9


# --- pops ---


def test_a_turn_in_a_single_frame_pops() -> None:
    jump = np.where(np.arange(FRAMES) < 6, 0.0, 40.0)[:, None] * Z
    found = popping.popped(_performance({"leftLowerArm": jump}))
    assert found.value == pytest.approx(40.0)
    assert (found.name, found.row) == ("leftLowerArm", 6)


def test_a_flicker_pops() -> None:
    flick = np.where(np.arange(FRAMES) == 6, 40.0, 0.0)[:, None] * Z
    assert popping.popped(_performance({"leftLowerArm": flick})).value == pytest.approx(40.0)


def test_a_fast_swing_does_not_pop() -> None:
    swing = 120.0 * (0.5 - 0.5 * np.cos(np.pi * np.clip(np.arange(FRAMES) - 3.0, 0.0, 6.0) / 6.0))
    assert popping.popped(_performance({"leftLowerArm": swing[:, None] * Z})).value < DEFAULT.pop


def test_a_sudden_start_that_was_asked_for_does_not_pop() -> None:
    angle = np.array([0.0] * 6 + [30.0, 42.0] + [46.0] * 5)
    performance = _performance({"head": angle[:, None] * Z})
    assert popping.popped(performance).value > 0.5 * DEFAULT.pop
    head = _bone(performance.character, "head")
    asked = Turn(head, performance.turns[:, head], np.ones(FRAMES))
    assert popping.popped(replace(performance, turned=(asked,))).value < 1e-6


def test_a_goal_that_jumps_is_no_excuse() -> None:
    jump = np.where(np.arange(FRAMES) < 6, 0.0, 40.0)[:, None] * Z
    performance = _performance({"head": jump})
    head = _bone(performance.character, "head")
    asked = Turn(head, performance.turns[:, head], np.ones(FRAMES))
    assert popping.popped(replace(performance, turned=(asked,))).value == pytest.approx(40.0)


def test_what_keeps_its_direction_while_its_parent_pops_does_not_pop() -> None:
    jump = np.where(np.arange(FRAMES) < 6, 0.0, 40.0)[:, None] * Z
    performance = _performance({"head": jump, "leftEye": -jump})
    assert popping.popped(performance).name == "head"


# --- hyperextension ---


def test_a_knee_that_bends_forward_is_overextended_and_one_that_bends_back_is_not() -> None:
    found = hinges.overextended(_performance({"leftLowerLeg": -40.0 * X}))
    assert found.value == pytest.approx(40.0, abs=10.0)
    assert found.name == "leftLowerLeg"
    for angle in (10.0, 90.0, 150.0):
        assert hinges.overextended(_performance({"leftLowerLeg": angle * X})).value == 0.0


def test_an_elbow_that_bends_back_is_overextended_wherever_its_arm_points() -> None:
    for turn in (np.zeros(3), 70.0 * Y, -60.0 * Z, np.array([50.0, 30.0, -20.0])):
        assert hinges.overextended(_performance({"leftUpperArm": turn, "leftLowerArm": 40.0 * Z})).value > 25.0
        assert hinges.overextended(_performance({"leftUpperArm": turn, "leftLowerArm": -90.0 * Z})).value == 0.0


# --- crossing ---


def test_an_arm_that_goes_through_the_trunk_crosses_it() -> None:
    through = _performance({"leftUpperArm": np.array([0.0, 100.0, 0.0]), "leftLowerArm": np.array([0.0, 60.0, 0.0])})
    found = crossing.crossed(through)
    assert found.value > DEFAULT.crossing, found
    assert crossing.crossed(_performance({"leftUpperArm": -60.0 * Z})).value < 0.1


def test_legs_that_change_sides_cross_each_other() -> None:
    crossed = _performance({"leftUpperLeg": 12.0 * Y, "rightUpperLeg": -12.0 * Y})
    assert crossing.crossed(crossed).value > DEFAULT.crossing


# --- lengths ---


def test_a_bone_that_gets_longer_changes_its_length() -> None:
    performance = _performance()
    hand = _bone(performance.character, "leftHand")
    performance.places[5, hand, 0] += 0.05
    found = lengths.changed(performance)
    assert found.value * performance.size == pytest.approx(0.05, rel=1e-3)
    assert (found.row, found.name) == (5, "leftHand")
    assert lengths.changed(replace(performance, slack={hand: 0.051})).value == 0.0
    assert lengths.changed(_performance({"leftUpperArm": 70.0 * Y})).value < 1e-9


# --- judging ---


def test_what_cannot_be_measured_does_not_pass() -> None:
    performance = _performance()
    performance.places[3] = np.nan
    found = judge(performance)
    assert not found["lengths"].passed
    assert not found["ground"].passed


def test_a_verdict_tells_value_limit_and_where() -> None:
    verdict = Verdict(Found(0.5, 3, "leftFoot"), 0.1, "leg lengths/s")
    assert not verdict.passed
    assert verdict.told == "0.5 leg lengths/s (limit 0.1), worst at 'leftFoot'"
    assert Verdict(Found(0.1), 0.1, "deg").passed


def test_limits_are_changed_by_name() -> None:
    assert DEFAULT.with_({"pop": 5.0}) == replace(Limits(), pop=5.0)
    with pytest.raises(MotionError, match="there is no verdict 'speed': choose one of goals, ground"):
        DEFAULT.with_({"speed": 1.0})
