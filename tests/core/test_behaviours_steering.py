"""Steering: ways around what stands on the ground, and how a body goes along them."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from morph_retarget.core.arrays import Array
from morph_retarget.core.clips.behaviours import steering
from morph_retarget.core.clips.behaviours.obstacles import Obstacle, disc, hull, nearest_free
from morph_retarget.core.clips.behaviours.steering import path_around
from morph_retarget.core.clips.character_model import RATE
from morph_retarget.core.errors import MotionError

few = settings(max_examples=15, deadline=None)
seeds = st.integers(0, 100_000)


def _box(middle: Array, width: float, depth: float, turn: float) -> Array:
    c, s = np.cos(turn), np.sin(turn)
    corners = np.array([[-width, -depth], [width, -depth], [width, depth], [-width, depth]])
    return middle + corners @ np.array([[c, s], [-s, c]])


def _field(rng: np.random.Generator, most: int = 10) -> list[Array]:
    """Return discs and boxes about the origin, which may lie over each other."""
    out: list[Array] = []
    for _ in range(rng.integers(1, most + 1)):
        middle = rng.uniform(-4.0, 4.0, 2)
        if rng.random() < 0.5:
            out.append(disc(middle, rng.uniform(0.1, 0.8)))
        else:
            out.append(_box(middle, rng.uniform(0.1, 1.2), rng.uniform(0.1, 1.2), rng.uniform(0.0, 6.0)))
    return out


def _clear(points: Array, covered: Array) -> Array:
    """Return how far points are from what covers the ground [m], below 0 within, shape (n,)."""
    own = Obstacle(hull(covered))
    away = np.array([np.linalg.norm(own.edge_points(point) - point, axis=1).min() for point in points])
    return np.where(own.holds(points), -away, away)


@few
@given(seed=seeds)
def test_ways_keep_off_obstacles(seed: int) -> None:
    rng = np.random.default_rng(seed)
    obstacles, radius = _field(rng), rng.uniform(0.15, 0.4)
    start, goal = np.array([-7.0, rng.uniform(-4.0, 4.0)]), rng.uniform(-5.0, 5.0, 2)
    try:
        way = path_around(start, goal, obstacles, radius)
    except MotionError:
        return  # it is walled in
    points = way.at(np.linspace(0.0, way.length, 300))
    assert min(_clear(points, own).min() for own in obstacles) > radius - 1e-9
    assert np.abs(points[0] - start).max() < 1e-12
    assert way.length >= np.linalg.norm(points[-1] - start) - 1e-9
    if not way.warnings:
        assert np.abs(points[-1] - goal).max() < 1e-12


def test_a_way_that_nothing_blocks_is_straight() -> None:
    way = path_around(np.zeros(2), np.array([3.0, 4.0]), [disc(np.array([5.0, -5.0]), 1.0)], 0.3)
    assert len(way.points) == 2
    assert abs(way.length - 5.0) < 1e-12


def test_a_way_around_a_disc_is_hardly_longer_than_the_shortest() -> None:
    """Two tangents and an arc."""
    radius, far = 1.0 + 0.3, 4.0
    way = path_around(np.array([-far, 0.0]), np.array([far, 0.0]), [disc(np.zeros(2), 1.0, 48)], 0.3)
    tangent = np.sqrt(far**2 - radius**2)
    shortest = 2.0 * tangent + radius * (np.pi - 2.0 * np.arccos(radius / far))
    assert shortest < way.length < 1.02 * shortest


def test_a_goal_in_an_obstacle_becomes_the_nearest_place_beside_it() -> None:
    obstacle = disc(np.zeros(2), 1.0)
    way = path_around(np.array([-4.0, 0.1]), np.array([-0.2, 0.0]), [obstacle], 0.25)
    assert way.warnings
    assert 1.24 < np.linalg.norm(way.points[-1]) < 1.35
    inside = path_around(np.array([0.5, 0.0]), np.array([4.0, 0.0]), [obstacle], 0.25)
    assert inside.warnings
    assert np.abs(inside.points[0] - [0.5, 0.0]).max() < 1e-12


def test_what_is_walled_in_has_no_way() -> None:
    walls = [_box(np.array([0.0, side * 2.0]), 2.2, 0.2, 0.0) for side in (1.0, -1.0)]
    walls += [_box(np.array([side * 2.0, 0.0]), 0.2, 2.2, 0.0) for side in (1.0, -1.0)]
    with pytest.raises(MotionError, match="no way"):
        path_around(np.zeros(2), np.array([6.0, 0.0]), walls, 0.3)


def test_places_that_are_no_numbers_are_told() -> None:
    with pytest.raises(MotionError, match="no number"):
        path_around(np.array([np.nan, 0.0]), np.zeros(2), [], 0.3)


@few
@given(seed=seeds)
def test_the_nearest_free_place_is_free_and_near(seed: int) -> None:
    rng = np.random.default_rng(seed)
    obstacles = [Obstacle.of(own, 0.3) for own in _field(rng)]
    place = rng.uniform(-4.0, 4.0, 2)
    found = nearest_free(obstacles, place)
    assert not any(own.holds(found[None])[0] for own in obstacles)
    around = place + np.linalg.norm(found - place) * 0.98 * np.column_stack(
        [np.cos(np.linspace(0.0, 6.28, 60)), np.sin(np.linspace(0.0, 6.28, 60))]
    )
    if np.linalg.norm(found - place) > 1e-6:
        assert all(any(own.holds(point[None])[0] for own in obstacles) for point in around)


@few
@given(seed=seeds)
def test_a_body_goes_along_its_way_no_faster_than_it_may(seed: int) -> None:
    rng = np.random.default_rng(seed)
    speed, heading, facing = rng.uniform(0.5, 3.0), rng.uniform(-3.0, 3.0), rng.uniform(-3.0, 3.0)
    try:
        way = path_around(np.array([-7.0, 0.0]), rng.uniform(-5.0, 5.0, 2), _field(rng), 0.3)
    except MotionError:
        return
    gone = steering.paced(way, speed, heading, facing)
    steps = np.hypot(*np.diff(gone.places, axis=0).T) * RATE
    assert steps.max() < 1.02 * speed
    assert (np.abs(np.diff(gone.headings)) * RATE).max() < 1.2 * steering.ON_THE_SPOT
    assert steps[0] < 0.2 * speed
    assert steps[-1] < 0.2 * speed
    assert np.abs(gone.places[[0, -1]] - way.points[[0, -1]]).max() < 1e-6
    assert abs(gone.headings[0] - heading) < 1e-9
    assert abs(np.sin(0.5 * (gone.headings[-1] - facing))) < 1e-9


def test_a_body_that_is_there_only_turns() -> None:
    gone = steering.paced(path_around(np.ones(2), np.ones(2), [], 0.3), 1.3, 0.0, 1.5)
    assert np.abs(gone.places - 1.0).max() < 1e-12
    assert abs(gone.headings[-1] - 1.5) < 1e-12
