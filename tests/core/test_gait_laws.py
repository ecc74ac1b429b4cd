"""Gaits: what is true of any of them, whoever walks wherever."""

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from morph_retarget.core import quat
from morph_retarget.core.arrays import Array, Indices
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.errors import MotionError, RigError
from morph_retarget.core.locomotion import course
from morph_retarget.core.locomotion.course import Course
from morph_retarget.core.locomotion.moving import UP
from morph_retarget.core.locomotion.settings import GaitSettings
from morph_retarget.core.locomotion.stepping import gait, legs
from morph_retarget.core.locomotion.stepping.gait import Gait
from morph_retarget.core.play import root_of
from morph_retarget.core.solve.goals import Goals
from tests import gait_courses, gait_measures, goal_sets
from tests.gait_courses import Size, Trial
from tests.goal_sets import Subject
from tests.legged import crawler, stilts
from tests.pose_measures import MIRROR, MIRROR_TURN, partners
from tests.skeletons import skeleton_of
from tools.creatures import CREATURES
from tools.figure import Bone, Build, humanoid, moved

WALKS, RUNS = 0.3, 1.2
NAMES = ("biped", "hound", "beetle", "lopside")
SAME = 1e-9
"""What is the same but for rounding [hip heights, rad]."""


@cache
def _subject(name: str) -> Subject:
    return Subject(goal_sets.creatures()[name])


def _of(bones: Sequence[Bone]) -> Subject:
    return Subject(analyze(skeleton_of(bones)))


def _size(subject: Subject) -> Size:
    return Size.of(legs.find(subject.character))


def _gait(subject: Subject, way: Course, settings: GaitSettings | None = None) -> Gait:
    return gait_measures.prepared(subject, Trial(way, steady=False), settings or GaitSettings())


def _times(way: Course, count: int = 60) -> Array:
    return np.linspace(way.times[0], way.times[-1], count)


def _assert_same(a: Goals, b: Goals, size: float, near: float = SAME) -> None:
    assert (a.bodies == b.bodies).all()
    assert np.abs(a.positions - b.positions).max() < near * size
    assert quat.angle_between(a.turns, b.turns).max() < 1e-7 + near
    assert (a.position_influence == b.position_influence).all()
    assert (a.rotation_influence == b.rotation_influence).all()


def _carried(goals: Goals, turn: Array, shift: Array) -> Goals:
    """Return goals that are turned and moved, by frame or all alike; only places that count are moved."""
    turns = quat.multiply(np.broadcast_to(turn[..., None, :], goals.turns.shape), goals.turns)
    places = quat.rotate(np.broadcast_to(turn[..., None, :], goals.turns.shape), goals.positions) + shift[..., None, :]
    return replace(goals, turns=turns, positions=places * (goals.position_influence > 0.0)[..., None])


# --- time ---


@pytest.mark.parametrize("name", NAMES)
def test_a_frame_alone_is_the_frame_in_the_clip_bit_for_bit(name: str) -> None:
    subject = _subject(name)
    size = _size(subject)
    trial = gait_courses.all_of(size, WALKS)["hill"]
    made = gait_measures.prepared(subject, trial)
    times = _times(trial.course)
    whole, order = made.evaluate(times), np.random.default_rng(1).permutation(len(times))
    mixed = made.evaluate(times[order])
    assert (mixed.positions == whole.positions[order]).all()
    assert (mixed.turns == whole.turns[order]).all()
    for frame in (0, 17, 59):
        alone = made.evaluate(times[[frame]])
        assert (alone.positions[0] == whole.positions[frame]).all()
        assert (alone.turns[0] == whole.turns[frame]).all()


@pytest.mark.parametrize("name", NAMES)
def test_who_stands_stands_still_on_all_feet(name: str) -> None:
    subject = _subject(name)
    made = _gait(subject, gait_courses.standing(5.0))
    times = np.linspace(0.0, 5.0, 40)
    goals = made.evaluate(times)
    assert made.contacts(times).all()
    assert np.ptp(goals.positions, axis=0).max() < SAME
    assert quat.angle_between(goals.turns, goals.turns[:1]).max() < SAME
    feet = [goals.bodies.tolist().index(leg.foot) for leg in made.legs.legs]
    homes = np.array([leg.home for leg in made.legs.legs])
    assert np.abs(goals.positions[:, feet] - homes).max() < SAME


@pytest.mark.parametrize("u", [WALKS, RUNS])
@pytest.mark.parametrize("name", NAMES)
def test_who_stops_puts_every_foot_beside_the_others_and_stands_still(name: str, u: float) -> None:
    subject = _subject(name)
    size = _size(subject)
    way = gait_courses.stop_and_go(size, u)
    way = course.from_speed(np.append(way.times, way.times[-1] + 20.0), np.append(_speeds(way), 0.0), np.zeros(()))
    made = _gait(subject, way)
    last = way.times[-1] - np.array([2.0, 1.0, 0.0])
    goals, (places, _) = made.evaluate(last), way.at(last)
    assert made.contacts(last).all()
    assert np.ptp(goals.positions, axis=0).max() < SAME
    feet = [goals.bodies.tolist().index(leg.foot) for leg in made.legs.legs]
    homes = np.array([leg.home for leg in made.legs.legs])
    assert np.abs(goals.positions[0, feet] - homes - places[0]).max() < 0.02 * size.height


def _speeds(way: Course) -> Array:
    return np.append(quat.length(np.diff(way.places, axis=0)) / np.diff(way.times), 0.0)


@pytest.mark.parametrize("name", NAMES)
def test_who_sets_out_does_so_from_a_stand_on_all_feet(name: str) -> None:
    subject = _subject(name)
    way = gait_courses.stop_and_go(_size(subject), WALKS)
    made = _gait(subject, way)
    begin = np.array([way.times[0]])
    assert made.contacts(begin).all()
    goals = made.evaluate(begin)
    feet = [goals.bodies.tolist().index(leg.foot) for leg in made.legs.legs]
    assert np.abs(goals.positions[0, feet] - [leg.home for leg in made.legs.legs]).max() < SAME


@pytest.mark.parametrize("name", ["biped", "hound"])
def test_a_course_that_goes_on_for_longer_is_walked_the_same_until_then(name: str) -> None:
    subject = _subject(name)
    way = gait_courses.stop_and_go(_size(subject), WALKS)
    times = _times(way)
    for more in (1.0 / 24.0, 10.0):
        longer = Course(
            np.append(way.times, way.times[-1] + more),
            np.concatenate([way.places, way.places[-1:]]),
            np.append(way.headings, way.headings[-1]),
        )
        _assert_same(_gait(subject, way).evaluate(times), _gait(subject, longer).evaluate(times), 1.0)


@pytest.mark.parametrize("name", NAMES)
def test_feet_are_not_flung_after_a_body_that_jumps_elsewhere(name: str) -> None:
    subject = _subject(name)
    size = _size(subject)
    times = np.arange(0.0, 200.0) / 24.0
    ahead = np.cumsum(np.full(len(times), size.speed(WALKS) / 24.0))
    matrices = np.tile(np.eye(4), (len(times), 1, 1))
    matrices[:, 1, 3] = -ahead - 40.0 * size.height * (times > 4.0)
    way = course.from_frames(times, matrices, least_jump=size.height)
    assert len(way.cuts) == 1
    made = _gait(subject, way)
    fine = np.linspace(times[0], times[-1], 800)
    goals, (places, _) = made.evaluate(fine), way.at(fine)
    feet = [goals.bodies.tolist().index(leg.foot) for leg in made.legs.legs]
    homes = np.array([leg.home for leg in made.legs.legs])
    away = goals.positions[:, feet] - places[:, None] - homes
    assert np.abs(away).max() < 2.0 * max(leg.length for leg in made.legs.legs)


# --- where and how large ---


@pytest.mark.parametrize("name", NAMES)
def test_a_course_that_is_moved_moves_the_walk_with_it(name: str) -> None:
    subject = _subject(name)
    size = _size(subject)
    way = gait_courses.figure_eight(size, WALKS)
    angle, shift = 2.1, np.array([3.0, -7.0, 0.0]) * size.height
    turn = quat.from_axis_angle(UP, np.array(angle))
    there = Course(way.times, quat.rotate(turn, way.places) + shift, way.headings + angle)
    times = _times(way)
    here, moved_there = _gait(subject, way).evaluate(times), _gait(subject, there).evaluate(times)
    _assert_same(_carried(here, turn, shift), moved_there, size.height, 1e-6)


@pytest.mark.parametrize("factor", [1e-3, 1e3])
@pytest.mark.parametrize("bones", [humanoid(build=Build(root=True)), crawler(4)], ids=["a human", "four feet"])
def test_a_body_of_another_size_walks_alike(bones: list[Bone], factor: float) -> None:
    """Lengths go with the size, times with its root, as those of pendulums do."""
    own, other = _of(bones), _of(moved(bones, np.diag([factor, factor, factor, 1.0])))
    way = gait_courses.circle(_size(own), WALKS)
    scaled = Course(np.sqrt(factor) * way.times, factor * way.places, way.headings)
    here = _gait(own, way).evaluate(_times(way))
    there = _gait(other, scaled).evaluate(_times(scaled))
    _assert_same(replace(here, positions=factor * here.positions), there, factor * _size(own).height, 1e-6)


@pytest.mark.parametrize("turning", [0.0, 0.15])
@pytest.mark.parametrize("name", ["biped", "hound", "beetle"])
def test_half_a_cycle_later_the_mirror_image_of_a_walk_is_the_walk_of_its_mirror_image(
    name: str, turning: float
) -> None:
    """That holds where the feet of a row step half a cycle after each other."""
    subject = _subject(name)
    partner, size = partners(subject), _size(subject)
    assert partner is not None
    speed = size.speed(WALKS)
    span = np.array([0.0, 20.0 * size.height / speed])
    rate = turning * speed / size.height
    left, right = (course.from_speed(span, np.array(speed), np.array(side * rate)) for side in (1.0, -1.0))
    made, image = _gait(subject, left), _gait(subject, right)
    pace = image.paces[0]
    half = 0.5 / float(np.interp(span.mean(), pace.times, pace.frequency))
    times = span.mean() + np.linspace(0.0, 4.0 * half, 50)
    mirrored = _mirrored(_as_the_body_sees(left, made.evaluate(times), times), partner)
    _assert_same(mirrored, _as_the_body_sees(right, image.evaluate(times + half), times + half), size.height, 1e-6)


def _as_the_body_sees(way: Course, goals: Goals, times: Array) -> Goals:
    places, headings = way.at(times)
    back = quat.from_axis_angle(UP, -headings)
    return _carried(goals, back, -quat.rotate(back, places))


def _mirrored(goals: Goals, partner: Indices) -> Goals:
    place = {int(body): i for i, body in enumerate(goals.bodies)}
    order = [place[int(partner[body])] for body in goals.bodies]
    return replace(goals, positions=goals.positions[:, order] * MIRROR, turns=goals.turns[:, order] * MIRROR_TURN)


# --- extremes ---


ODD_SPEEDS = (1e-6, 0.029, 0.031, 10.0, 100.0)


@pytest.mark.parametrize("u", ODD_SPEEDS)
@pytest.mark.parametrize("name", ["biped", "beetle"])
def test_absurd_speeds_give_poses(name: str, u: float) -> None:
    subject = _subject(name)
    size = _size(subject)
    spins = course.from_speed(np.array([0.0, 4.0]), np.array(size.speed(u)), np.array(3.0 * u))
    for way in (course.from_speed(np.array([0.0, 4.0]), np.array(size.speed(u)), np.zeros(())), spins):
        _assert_finite(_gait(subject, way).evaluate(np.linspace(-1.0, 5.0, 50)))


def _assert_finite(goals: Goals) -> None:
    assert np.isfinite(goals.positions).all()
    assert np.abs(quat.length(goals.turns) - 1.0).max() < 1e-6


def test_sharp_corners_and_ways_that_turn_back_give_poses() -> None:
    subject = _subject("hound")
    size = _size(subject)
    line = size.height * np.array([[0.0, 0.0], [0.0, -5.0], [5.0, -5.0], [0.0, -5.0], [0.0, 0.0]])
    times = np.array([0.0, 20.0 * size.height / size.speed(0.5)])
    _assert_finite(_gait(subject, course.along(line, times, np.array(size.speed(0.5)), smoothing=0.0)).evaluate(times))
    places = np.random.default_rng(3).normal(size=(30, 3)) * [1.0, 1.0, 0.0]
    wild = Course(np.arange(30.0), places, np.cumsum(np.random.default_rng(4).uniform(-3.0, 3.0, 30)))
    _assert_finite(_gait(subject, wild).evaluate(np.linspace(0.0, 29.0, 300)))


def test_where_there_is_no_ground_feet_stand_as_high_as_the_course_and_it_is_said() -> None:
    subject = _subject("biped")
    way = gait_courses.straight(_size(subject), WALKS)
    bare = Trial(way, steady=False, ground=lambda points: np.full(len(points), np.nan))
    made = gait_measures.prepared(subject, bare)
    assert any("no ground under" in warning for warning in made.warnings)
    _assert_same(made.evaluate(_times(way)), _gait(subject, way).evaluate(_times(way)), 1.0)


def test_who_has_no_legs_cannot_walk_and_is_told_what_to_do() -> None:
    snake = Subject(analyze(skeleton_of(CREATURES["snake"]())))
    way = course.from_speed(np.array([0.0, 1.0]), np.array(1.0), np.zeros(()))
    with pytest.raises(RigError, match="no legs to walk on: map its feet"):
        gait.prepare(snake.character, root_of(snake.bodies), way, GaitSettings())


def test_a_style_that_nobody_knows_is_refused_with_all_that_there_are() -> None:
    subject = _subject("biped")
    way = gait_courses.straight(_size(subject), WALKS)
    with pytest.raises(MotionError, match=r"'moonwalk'.*walk"):
        _gait(subject, way, GaitSettings(styles=(("moonwalk", 1.0),)))


def test_one_leg_hops() -> None:
    subject = _of(crawler(1))
    way = gait_courses.straight(_size(subject), WALKS)
    made = _gait(subject, way)
    assert any("one leg" in warning for warning in made.warnings)
    standing = made.contacts(_times(way, 400))
    assert standing.any()
    assert not standing.all()
    _assert_finite(made.evaluate(_times(way)))


def test_legs_of_one_bone_give_poses_and_it_is_said_that_they_slide() -> None:
    subject = _of(stilts())
    way = gait_courses.straight(_size(subject), WALKS)
    made = _gait(subject, way)
    assert any("no knee" in warning for warning in made.warnings)
    _assert_finite(made.evaluate(_times(way)))


@pytest.mark.parametrize("speed", [1e6, 1e12])
def test_a_speed_at_which_nobody_could_count_the_steps_is_refused(speed: float) -> None:
    subject = _subject("biped")
    with pytest.raises(MotionError, match="lower its speed"):
        _gait(subject, course.from_speed(np.array([0.0, 10.0]), np.full(2, speed), np.zeros(2)))


# --- what an animator tunes ---


def _tuned(name: str, settings: GaitSettings, u: float = WALKS) -> tuple[Gait, Goals, Array]:
    subject = _subject(name)
    way = gait_courses.straight(_size(subject), u)
    made = _gait(subject, way, settings)
    return made, made.evaluate(_times(way, 200)), _times(way, 200)


@pytest.mark.parametrize("name", NAMES)
def test_longer_strides_are_as_much_rarer(name: str) -> None:
    plain, _, _ = _tuned(name, GaitSettings())
    for factor in (0.6, 0.9):
        tuned, _, _ = _tuned(name, GaitSettings(stride=factor))
        assert np.allclose(factor * tuned.paces[0].frequency, plain.paces[0].frequency)


def test_feet_are_lifted_as_much_higher_as_is_asked_for() -> None:
    heights: list[float] = []
    for factor in (1.0, 2.0):
        made, goals, _ = _tuned("beetle", GaitSettings(step_height=factor))
        row = goals.bodies.tolist().index(made.legs.legs[0].foot)
        heights.append(float(np.ptp(goals.positions[:, row, 2])))
    assert np.isclose(heights[1], 2.0 * heights[0], rtol=1e-6)


def test_hips_are_lowered_as_far_as_is_asked_for() -> None:
    roots = [_tuned("biped", GaitSettings(crouch=depth))[1].positions[:, 0, 2].mean() for depth in (0.1, 0.2)]
    length = max(leg.length for leg in legs.find(_subject("biped").character).legs)
    assert np.isclose(roots[0] - roots[1], 0.1 * length, rtol=0.1)


def test_feet_on_one_line_are_put_down_below_the_middle() -> None:
    made, goals, _ = _tuned("hound", GaitSettings(width=0.0))
    feet = [goals.bodies.tolist().index(leg.foot) for leg in made.legs.legs]
    assert np.abs(goals.positions[:, feet, 0]).max() < 1e-3 * made.legs.groups[0].height


def test_arms_that_are_not_the_gaits_have_no_goals() -> None:
    _, with_arms, _ = _tuned("biped", GaitSettings())
    _, without, _ = _tuned("biped", GaitSettings(arms=0.0))
    hands = {_subject("biped").character.bone(side + "UpperArm") for side in ("left", "right")}
    assert hands <= set(with_arms.bodies.tolist())
    assert not hands & set(without.bodies.tolist())


def test_a_body_that_is_not_to_move_is_carried_level() -> None:
    _, goals, _ = _tuned("hound", GaitSettings(body=0.0))
    assert quat.angle_between(goals.turns[:, 0], quat.IDENTITY).max() < 1e-6


def test_the_way_of_the_object_is_taken_out_of_the_goals() -> None:
    """Where the object itself moves along the course, its bones walk on the spot."""
    subject = _subject("biped")
    size = _size(subject)
    way = gait_courses.circle(size, WALKS)
    times = _times(way)
    places, headings = way.at(times)
    back = quat.from_axis_angle(UP, -headings)
    carried = np.tile(np.eye(4), (len(times), 1, 1))
    carried[:, :3, :3], carried[:, :3, 3] = quat.to_matrix(back), -quat.rotate(back, places)
    made = _gait(subject, way)
    seen = _as_the_body_sees(way, made.evaluate(times), times)
    own = made.evaluate(times, carried)
    own = replace(own, positions=own.positions * (own.position_influence > 0.0)[..., None])
    _assert_same(seen, own, size.height, 1e-7)
