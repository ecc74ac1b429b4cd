"""Gaits: feet keep in reach of the body; they leave in time, land with room beside each other and clear of walls."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from morph_retarget.core import quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.locomotion.stepping import legs, plants, reaching
from morph_retarget.core.locomotion.stepping.gait import Gait
from morph_retarget.core.locomotion.stepping.legs import FORWARD
from tests import gait_courses, gait_measures, goal_sets
from tests.gait_courses import Size, Trial
from tests.goal_sets import Subject
from tests.legged import crawler
from tests.morph_bodies import real_characters
from tests.skeletons import skeleton_of

WALKS = 0.3
NAMES = ("biped", "hound", "beetle", "six feet")


@cache
def _subject(name: str) -> Subject:
    return Subject(analyze(skeleton_of(crawler(6))) if name == "six feet" else goal_sets.creatures()[name])


@cache
def _gait(name: str, course: str) -> Gait:
    subject = _subject(name)
    trial = gait_courses.all_of(Size.of(legs.find(subject.character)), WALKS)[course]
    return gait_measures.prepared(subject, trial)


def _stances(made: Gait) -> tuple[Array, Array]:
    """Return how long stances within the course last, and how long they usually do [s], each (n,)."""
    own, first, last = made.steps.contacts, made.course.times[0], made.course.times[-1]
    seen = (own.touch > first) & (own.lift < last)
    return own.lift[seen] - own.touch[seen], made.steps.usual[seen]


# --- who leaves in time ---


@pytest.mark.parametrize("name", NAMES)
def test_in_a_steady_walk_on_level_ground_no_foot_leaves_early(name: str) -> None:
    lasts, usual = _stances(_gait(name, "straight"))
    assert np.abs(lasts / usual - 1.0).max() < 1e-6


def test_feet_that_a_sudden_start_would_leave_behind_leave_in_time() -> None:
    made = _gait("six feet", "stop-and-go")
    times = gait_measures.frames_of(made.course)
    goals = made.evaluate(times)
    root = goals.bodies.tolist().index(made.wanted[0][0])
    rest = float(goals.positions[0, root, 2])
    assert goals.positions[:, root, 2].min() > (1.0 - 0.25) * rest


@pytest.mark.parametrize("course", ["stop-and-go", "stairs", "hill", "figure-eight"])
@pytest.mark.parametrize("name", NAMES)
def test_the_last_foot_on_the_ground_does_not_leave_early(name: str, course: str) -> None:
    made = _gait(name, course)
    assert made.contacts(np.linspace(made.course.times[0], made.course.times[-1], 2000)).any(axis=1).all()


# --- strides to the side ---


@pytest.mark.parametrize("name", NAMES)
def test_feet_that_go_to_a_side_land_beside_the_others_with_room(name: str) -> None:
    made = _gait(name, "sideways")
    own, sizes = made.steps.contacts, made.steps.sizes
    places = made.steps.plants.places[..., :2]
    for leg, other in ((i, j) for i in range(len(sizes.lengths)) for j in range(len(sizes.lengths)) if i != j):
        room = reaching.room(quat.length(sizes.homes[leg, :2] - sizes.homes[other, :2]), sizes.lengths[leg])
        touch = own.touch[leg, : own.counts[leg]]
        cycle = own.cycles(touch)[:, other]
        stands = (own.touch[other, cycle] < touch) & (touch < own.lift[other, cycle])
        away = quat.length(places[leg, : len(touch)] - places[other, cycle])
        assert (away[stands] > (1.0 - 1e-6) * room).all()


@pytest.mark.parametrize("name", NAMES)
def test_standing_feet_of_who_goes_to_a_side_are_in_reach_of_hips_that_are_lowered_a_little(name: str) -> None:
    made = _gait(name, "sideways")
    own, sizes = made.steps.contacts, made.steps.sizes
    lowered = sizes.hips - np.array([0.0, 0.0, reaching.CROUCHES]) * sizes.lengths[:, None]
    for times in (own.touch, own.lift):
        seen = (own.touch > made.course.times[0]) & (own.lift < made.course.times[-1])
        at, _ = made.course.at(times[seen])
        row = np.nonzero(seen)[0]
        away = quat.length(made.steps.plants.places[seen] - at - lowered[row])
        assert (away < reaching.LONGEST * sizes.lengths[row]).all()


# --- what is in the way ---


def test_soles_stand_clear_of_steps_before_and_behind_them() -> None:
    made = _gait("biped", "stairs")
    stood, sizes = made.steps.plants, made.steps.sizes
    ground = gait_courses.stairs(Size.of(made.legs))
    near = (plants.WALL - 0.01) * sizes.lengths.max()
    for offset, way in ((sizes.tips, near), (sizes.heels, -near)):
        ends = stood.places + quat.rotate(stood.turns, np.broadcast_to(offset[:, None], stood.places.shape))
        rises = ground((ends + way * FORWARD).reshape(-1, 3)) - ground(ends.reshape(-1, 3))
        assert (rises < plants.WALL * sizes.lengths.max()).all()


def test_legs_that_do_not_stand_at_rest_are_told_of(data: Path) -> None:
    told = {name: made.warnings for name, made in _straight(data, "reallusion_cc3_bvh", "smplx").items()}
    assert any("rest pose" in warning for warning in told["reallusion_cc3_bvh"])
    assert not any("rest pose" in warning for warning in told["smplx"])


def _straight(data: Path, *names: str) -> dict[str, Gait]:
    out = dict[str, Gait]()
    for name in names:
        subject = Subject(real_characters(data)[name])
        way = gait_courses.straight(Size.of(legs.find(subject.character)), WALKS)
        out[name] = gait_measures.prepared(subject, Trial(way, steady=True))
    return out
