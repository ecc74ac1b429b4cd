"""Gaits: what characters come to that walk. Poses are rebuilt from the keys of bones and measured on the soles."""

from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from _pytest.mark import ParameterSet

from morph_retarget.core import quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.locomotion.patterns.styles import STYLES
from morph_retarget.core.locomotion.settings import GaitSettings
from morph_retarget.core.locomotion.stepping import legs
from tests import gait_courses, gait_measures, goal_sets
from tests.gait_courses import Size, Trial
from tests.gait_measures import Walked
from tests.goal_sets import Subject
from tests.legged import crawler
from tests.morph_bodies import real_characters
from tests.skeletons import skeleton_of

WALKS = 0.3
"""Dimensionless speed of a walk."""
SLIP = 1e-3
"""What stands moves no further [leg lengths]."""
GAP = 5e-3
"""Soles that stand are no further off the ground [leg lengths]."""
CLEAR = 0.01
"""Flying feet go no deeper into steps and hills [leg lengths]."""
EARLY = 0.02
"""Steps come no earlier or later than the style wants them, and stand no longer or shorter [cycles]."""
QUICK = 25.0 * 24.0 / 0.84
"""No bone turns faster [deg a cycle]: that is 25 degrees in each of 24 frames a second, as often as a human steps."""
NEARLY = 10.0
"""The knee of a leg that carries the body bends no more than this beyond its rest where it is straightest [deg]."""
SUDDEN = 200.0
"""Acceleration of feet [leg lengths a cycle, each cycle]: in flight they are up to five leg lengths a cycle fast."""
NAMES = ("biped", "hound", "beetle", "bird", "three feet")
COURSES = ("straight", "circle", "figure-eight", "stop-and-go", "sideways", "stairs", "hill")
STEADY = ("straight", "circle", "sideways")


_LOPSIDED = "a body that lacks a leg on one side sways further than its legs are made for"
_JERKS = "hips are lowered within a few hundredths of a cycle for strides to the side"
_LAME = {("three feet", course): _LOPSIDED for course in STEADY}
QUICKER = _LAME
"""Walks in which a bone turns too fast, and why."""
JERKY = {**QUICKER, ("biped", "sideways"): _JERKS}
"""Walks in which a foot starts or stops with a jerk, and why."""


def _cases(courses: Sequence[str], known: Mapping[tuple[str, str], str]) -> list[ParameterSet]:
    """Return all walks; those that fall short as far as it is known are expected to."""
    return [
        pytest.param(
            name,
            course,
            marks=[pytest.mark.xfail(reason=known[name, course], strict=True)] if (name, course) in known else [],
        )
        for name in NAMES
        for course in courses
    ]


@cache
def _subjects() -> Mapping[str, Subject]:
    made = {"three feet": crawler(3), "long and short legs": crawler(6, sizes=(1.0, 0.5, 0.5))}
    made |= {f"{feet} feet": crawler(feet) for feet in (6, 7, 12)}
    odd = {name: analyze(skeleton_of(bones)) for name, bones in made.items()}
    return {name: Subject(character) for name, character in {**goal_sets.creatures(), **odd}.items()}


@cache
def _trials(name: str, u: float = WALKS) -> Mapping[str, Trial]:
    return gait_courses.all_of(Size.of(legs.find(_subjects()[name].character)), u)


@cache
def _walked(name: str, course: str) -> Walked:
    return gait_measures.walk(_subjects()[name], _trials(name)[course])


@cache
def _closely(name: str, course: str) -> Walked:
    """Return some cycles in the middle of a course, as finely as steps are measured."""
    made = _walked(name, course).gait
    times = gait_measures.steady_times(made, 0)
    return gait_measures.walk(_subjects()[name], _trials(name)[course], times=times, made=made)


# --- feet ---


@pytest.mark.parametrize(("name", "course"), _cases(COURSES, {}))
def test_what_stands_of_a_foot_does_not_move(name: str, course: str) -> None:
    assert gait_measures.slips(_walked(name, course)).max() < SLIP


def test_feet_of_many_stand_still_though_the_body_sets_out_at_once() -> None:
    assert gait_measures.slips(_walked("6 feet", "stop-and-go")).max() < SLIP


@pytest.mark.parametrize(("name", "course"), _cases(COURSES, {}))
def test_soles_that_stand_are_on_the_ground(name: str, course: str) -> None:
    assert gait_measures.gaps(_walked(name, course)).max() < GAP


@pytest.mark.parametrize("course", [c for c in COURSES if c not in ("stairs", "hill")])
@pytest.mark.parametrize("name", NAMES)
def test_feet_do_not_fly_through_level_ground(name: str, course: str) -> None:
    assert gait_measures.sinks(_walked(name, course)).max() < GAP


@pytest.mark.parametrize("course", ["stairs", "hill"])
@pytest.mark.parametrize("name", NAMES)
def test_flying_feet_clear_edges_and_humps(name: str, course: str) -> None:
    assert gait_measures.sinks(_walked(name, course)).max() < CLEAR


@pytest.mark.parametrize("feet", [7, 12])
def test_long_bodies_bend_over_what_they_go_on(feet: int) -> None:
    walked = _walked(f"{feet} feet", "stairs")
    assert gait_measures.slips(walked).max() < SLIP
    assert gait_measures.gaps(walked).max() < GAP
    spine = [walked.subject.bodies.names.index(f"spine{i}") for i in range((feet + 1) // 2)]
    level = quat.rotate(walked.turns[:, spine], np.array([0.0, -1.0, 0.0]))
    assert np.degrees(np.ptp(np.arcsin(level[..., 2]), axis=1)).max() > 20.0


@pytest.mark.parametrize("course", STEADY)
@pytest.mark.parametrize("name", NAMES)
def test_feet_step_when_the_style_wants_them_to(name: str, course: str) -> None:
    walked = _closely(name, course)
    found, wanted = gait_measures.steps_of(walked, 0), gait_measures.wanted_steps(walked, 0)
    assert np.abs(found.duty - wanted.duty).max() < EARLY
    assert gait_measures.apart(found.triggers, wanted.triggers).max() < EARLY


@pytest.mark.parametrize(
    ("name", "style"),
    [(name, s.name) for name, feet in (("biped", 2), ("hound", 4), ("beetle", 6)) for s in STYLES.values()
     if s.change is None and s.suits(feet)],
)  # fmt: skip
def test_a_style_comes_out_in_its_own_step_order(name: str, style: str) -> None:
    subject, settings = _subjects()[name], GaitSettings(styles=((style, 1.0),))
    trial = _trials(name, 0.6)["straight"]
    made = gait_measures.prepared(subject, trial, settings)
    times = gait_measures.steady_times(made, 0)
    walked = gait_measures.walk(subject, trial, settings, times, made)
    found, wanted = gait_measures.steps_of(walked, 0), gait_measures.wanted_steps(walked, 0, settings)
    assert gait_measures.apart(found.triggers, wanted.triggers).max() < EARLY
    assert np.abs(found.duty - wanted.duty).max() < EARLY


def test_short_legs_step_as_much_oftener_as_their_group_says() -> None:
    name = "long and short legs"
    made = _walked(name, "straight").gait
    often: list[float] = []
    for number, group in enumerate(made.legs.groups):
        times = gait_measures.steady_times(made, 0)
        walked = gait_measures.walk(_subjects()[name], _trials(name)["straight"], times=times, made=made)
        stands = gait_measures.resting(walked)[:, list(group.legs)]
        often.append(float((stands[1:] & ~stands[:-1]).sum(axis=0).mean()))
        assert made.paces[number].frequency[-1] == float(group.ratio) * made.paces[0].frequency[-1]
    assert often == [gait_measures.CYCLES * float(group.ratio) for group in made.legs.groups]
    assert len(often) > 1


# --- the whole body ---


@pytest.mark.parametrize(("name", "course"), _cases(STEADY, QUICKER))
def test_no_bone_turns_in_jerks(name: str, course: str) -> None:
    fastest = gait_measures.SAMPLES * gait_measures.jumps(_closely(name, course)).max()
    assert fastest < QUICK


@pytest.mark.parametrize(("name", "course"), _cases(STEADY, JERKY))
def test_flying_feet_neither_stop_nor_start_with_a_jerk(name: str, course: str) -> None:
    walked = _closely(name, course)
    feet = [leg.foot for leg in walked.gait.legs.legs]
    moved = np.diff(walked.places[:, feet], n=2, axis=0) * gait_measures.SAMPLES**2 / walked.lengths[:, None]
    assert quat.length(moved).max() < SUDDEN


@pytest.mark.parametrize("course", COURSES)
@pytest.mark.parametrize("name", NAMES)
def test_knees_bend_to_the_side_they_are_made_for(name: str, course: str) -> None:
    assert not gait_measures.flips(_walked(name, course)).any()


@pytest.mark.parametrize("name", NAMES)
def test_a_body_goes_where_its_course_goes(name: str) -> None:
    walked = _walked(name, "figure-eight")
    places, _ = walked.gait.course.at(walked.times)
    root = walked.gait.wanted[0][0]
    away = walked.places[:, root, :2] - places[:, :2]
    rest = walked.subject.bodies.positions[root, :2]
    assert np.abs(np.hypot(*away.T) - np.hypot(*rest)).max() < 0.3 * walked.lengths.max()


FLAT = frozenset({"reallusion_cc3_bvh"})
"""Rigs whose rest is no pose to walk from: all bones of a leg lie on each other's line."""


def test_feet_of_all_real_rigs_with_knees_stand_still_on_the_ground(data: Path) -> None:
    missed: dict[str, float] = {}
    for name, character in real_characters(data).items():
        found = legs.find(character)
        if name in FLAT or not found.legs or any(len(leg.path) < 3 for leg in found.legs):
            continue
        trial = Trial(gait_courses.straight(Size.of(found), WALKS), steady=True)
        walked = gait_measures.walk(Subject(character), trial, times=_spread(trial, 120))
        slip, gap = gait_measures.slips(walked).max(), gait_measures.gaps(walked).max()
        if slip > SLIP or gap > GAP or gait_measures.flips(walked).any():
            missed[name] = float(slip)
    assert not missed


def _spread(trial: Trial, count: int) -> Array:
    return np.linspace(trial.course.times[0], trial.course.times[-1], count)


# --- looks ---


@pytest.mark.parametrize("name", ["biped", "asura"])
def test_the_leg_that_carries_a_walking_biped_is_nearly_straight(name: str) -> None:
    subject, trial = _subjects()[name], _trials(name, 0.44)["straight"]
    walked = gait_measures.walk(subject, trial)
    for i, leg in enumerate(walked.gait.legs.legs):
        hip, knee, foot = (walked.places[:, bone] for bone in (leg.path[0], leg.path[1], leg.foot))
        bent = np.degrees(quat.angle_between(quat.between(hip - knee, foot - knee), quat.identity()))
        carries = walked.gait.contacts(walked.times).sum(axis=1) == 1
        alone = carries & walked.gait.contacts(walked.times)[:, i]
        rest = subject.bodies.positions[[leg.path[0], leg.path[1], leg.foot]]
        still = np.degrees(quat.angle_between(quat.between(rest[0] - rest[1], rest[2] - rest[1]), quat.identity()))
        assert still - bent[alone].max() < NEARLY
