"""The ground that carries a body: what is laid over a gait goes up and down with it."""

from collections.abc import Mapping
from functools import cache

import numpy as np
import pytest

from morph_retarget.core.arrays import Array
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.character.character import Character
from morph_retarget.core.ground import Ground, heights_on
from morph_retarget.core.locomotion import course, getting_about
from morph_retarget.core.locomotion.footless.crawling import Movement
from morph_retarget.core.locomotion.moving import Moving
from morph_retarget.core.locomotion.settings import GaitSettings
from morph_retarget.core.locomotion.stepping.gait import Gait
from morph_retarget.core.morph.bodies import Bodies
from morph_retarget.core.play import root_of
from tests import goal_sets
from tests.skeletons import skeleton_of
from tools.figure import Bone

TIMES = np.arange(0.0, 8.0, 1.0 / 24.0)
SPEED, SLOPE = 0.6, 0.25
WAY = course.from_speed(np.array([0.0, 8.0]), np.array(SPEED), np.zeros(()))
KINDS: Mapping[str, Movement | None] = {
    "biped": None,
    "hound": None,
    "beetle": None,
    "snake": None,
    "snake as an inch-worm": Movement.INCHWORM,
    "snake in the air": Movement.FLOAT,
    "hopper": Movement.INCHWORM,
}
every = pytest.mark.parametrize("kind", KINDS)


@cache
def _character(kind: str) -> Character:
    if kind == "hopper":
        low, neck, end = (np.array([0.0, y, 0.08]) for y in (0.0, -0.4, -0.6))
        return analyze(skeleton_of([Bone("Spine", None, low, neck), Bone("Head", "Spine", neck, end)]))
    return goal_sets.creatures()[kind.split()[0]]


def _moving(kind: str, ground: Ground | None, way: course.Course = WAY) -> Moving:
    character = _character(kind)
    return getting_about.prepare(character, root_of(Bodies.of(character)), way, GaitSettings(), KINDS[kind], ground)


def _slope(points: Array) -> Array:
    return -SLOPE * points[:, 1]


def _stairs(points: Array) -> Array:
    return 0.08 * np.floor(-points[:, 1] / 0.4)


def _hills(points: Array) -> Array:
    return 0.15 * np.sin(0.9 * points[:, 0]) + 0.2 * np.cos(0.8 * points[:, 1])


@every
def test_over_level_ground_they_are_as_high_as_that(kind: str) -> None:
    assert np.abs(_moving(kind, None).floors(TIMES)).max() < 1e-9
    raised = _moving(kind, lambda points: np.full(len(points), 0.3))
    assert np.abs(raised.floors(TIMES) - 0.3).max() < 1e-9


@every
def test_up_a_slope_they_rise_with_the_course(kind: str) -> None:
    moving = _moving(kind, _slope)
    high = moving.floors(TIMES) + SLOPE * WAY.at(TIMES)[0][:, 1]
    # Between two steps a body is carried at one height, and gets ahead of it.
    assert np.abs(high).max() < 0.12
    rate = np.polyfit(TIMES, moving.floors(TIMES), 1)[0]
    assert rate == pytest.approx(SLOPE * SPEED, rel=0.05)


@every
@pytest.mark.parametrize("ground", [_hills, _stairs], ids=["hills", "stairs"])
def test_they_do_not_jump_where_the_ground_does(kind: str, ground: Ground) -> None:
    moving, fine = _moving(kind, ground), np.arange(1.0, 7.0, 1e-3)
    found = moving.floors(fine)
    assert np.ptp(found) > 0.1
    assert np.abs(np.diff(found)).max() < 0.01


@every
def test_a_frame_alone_is_what_it_is_among_others_to_the_bit(kind: str) -> None:
    moving = _moving(kind, _hills)
    whole = moving.floors(TIMES)
    for frame in (0, 7, 100, 191):
        assert moving.floors(TIMES[frame : frame + 1])[0] == whole[frame]
    order = np.random.default_rng(5).permutation(len(TIMES))
    assert (moving.floors(TIMES[order]) == whole[order]).all()


@every
def test_the_root_keeps_its_height_over_them(kind: str) -> None:
    level, hilly = _moving(kind, None), _moving(kind, _slope)
    plain, there = (moving.evaluate(TIMES).positions[:, 0, 2] for moving in (level, hilly))
    # Legs that reach uphill and downhill lower the hips a little, and what is long tilts about its middle.
    assert np.abs(there - hilly.floors(TIMES) - plain).max() < 0.1


def test_where_there_is_no_ground_they_are_as_high_as_the_course() -> None:
    for kind in KINDS:
        moving = _moving(kind, lambda points: np.full(len(points), np.nan))
        assert np.abs(moving.floors(TIMES)).max() < 1e-9


@pytest.mark.parametrize(("kind", "walks"), [("biped", True), ("snake", False)])
def test_who_has_feet_walks_and_who_has_none_crawls(kind: str, walks: bool) -> None:
    assert isinstance(_moving(kind, None), Gait) is walks


def test_where_there_is_no_ground_something_else_counts() -> None:
    points = np.random.default_rng(2).normal(size=(4, 3, 3))
    otherwise = np.arange(12.0).reshape(4, 3)
    found = heights_on(lambda at: np.where(at[:, 0] > 0.0, at[:, 1], np.nan), points, otherwise)
    assert (found == np.where(points[..., 0] > 0.0, points[..., 1], otherwise)).all()
    assert heights_on(lambda at: np.full(len(at), np.nan), np.zeros(3), 0.5) == 0.5
