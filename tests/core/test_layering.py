"""Layering: goals of an action over those of a gait."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from morph_retarget.core import layering, quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.layering import Layer
from morph_retarget.core.solve.goals import Goals

seeds = st.integers(0, 10_000)
few = settings(max_examples=25)
FRAMES = 6


def _goals(rng: np.random.Generator, bodies: list[int], influence: float | None = None) -> Goals:
    count = len(bodies)
    place, turn = rng.uniform(size=(2, FRAMES, count)) if influence is None else np.full((2, FRAMES, count), influence)
    turns = quat.normalize(rng.normal(size=(FRAMES, count, 4)))
    return Goals(np.array(bodies, dtype=np.intp), rng.normal(size=(FRAMES, count, 3)), turns, place, turn)


def _row(goals: Goals, body: int) -> int:
    return goals.bodies.tolist().index(body)


def _assert_goal(both: Goals, own: Goals, body: int) -> None:
    """Check that a body has the goal of one layer."""
    i, j = _row(both, body), _row(own, body)
    assert np.allclose(both.positions[:, i], own.positions[:, j])
    assert quat.angle_between(both.turns[:, i], own.turns[:, j]).max() < 1e-6
    assert np.allclose(both.position_influence[:, i], own.position_influence[:, j])
    assert np.allclose(both.rotation_influence[:, i], own.rotation_influence[:, j])


@few
@given(seeds)
def test_bodies_that_one_layer_alone_has_keep_its_goals(seed: int) -> None:
    rng = np.random.default_rng(seed)
    upper, lower = _goals(rng, [4, 1, 7]), _goals(rng, [2, 5])
    both = layering.together(upper, lower)
    assert both.bodies.tolist() == [4, 1, 7, 2, 5]
    for body in (4, 1, 7):
        _assert_goal(both, upper, body)
    for body in (2, 5):
        _assert_goal(both, lower, body)


@few
@given(seeds)
def test_an_upper_layer_that_does_not_count_leaves_the_lower_one(seed: int) -> None:
    rng = np.random.default_rng(seed)
    upper, lower = _goals(rng, [3, 2, 8], 0.0), _goals(rng, [8, 5, 3])
    both = layering.together(upper, lower)
    for body in (8, 5, 3):
        _assert_goal(both, lower, body)


@few
@given(seeds)
def test_an_upper_layer_that_counts_in_full_hides_the_lower_one(seed: int) -> None:
    rng = np.random.default_rng(seed)
    upper, lower = _goals(rng, [3, 2, 8], 1.0), _goals(rng, [8, 5, 3])
    both = layering.together(upper, lower)
    for body in (3, 2, 8):
        _assert_goal(both, upper, body)


@few
@given(seeds)
def test_influence_leads_from_the_lower_layer_to_the_upper_one(seed: int) -> None:
    rng = np.random.default_rng(seed)
    upper, lower = _goals(rng, [3], float(rng.uniform())), _goals(rng, [3], 1.0)
    both, share = layering.together(upper, lower), upper.position_influence[..., None]
    assert np.allclose(both.positions, lower.positions + share * (upper.positions - lower.positions))
    wanted = quat.slerp(lower.turns, upper.turns, upper.rotation_influence)
    assert quat.angle_between(both.turns, wanted).max() < 1e-6
    assert np.allclose([both.position_influence, both.rotation_influence], 1.0)


@few
@given(seeds)
def test_both_layers_together_count_no_less_than_either_and_never_more_than_in_full(seed: int) -> None:
    rng = np.random.default_rng(seed)
    upper, lower = _goals(rng, [0, 1]), _goals(rng, [1, 0])
    both = layering.together(upper, lower)
    for whole, a, b in (
        (both.position_influence, upper.position_influence, lower.position_influence),
        (both.rotation_influence, upper.rotation_influence, lower.rotation_influence),
    ):
        assert (whole >= np.maximum(a, b[:, ::-1]) - 1e-12).all()
        assert whole.max() <= 1.0


def test_layers_are_not_changed_by_being_laid_together() -> None:
    rng = np.random.default_rng(2)
    upper, lower = _goals(rng, [0, 1]), _goals(rng, [1, 2])
    before = [values.copy() for own in (upper, lower) for values in _values(own)]
    layering.together(upper, lower)
    after = [values for own in (upper, lower) for values in _values(own)]
    assert all((a == b).all() for a, b in zip(before, after, strict=True))


def _values(goals: Goals) -> list[Array]:
    return [goals.positions, goals.turns, goals.position_influence, goals.rotation_influence]


@pytest.mark.parametrize("upper", [[], [(1, True, False), (2, False, True)]])
def test_what_is_wanted_stands_in_the_order_of_the_goals(upper: list[tuple[int, bool, bool]]) -> None:
    lower = [(0, True, True), (2, True, False), (1, False, False)]
    rng = np.random.default_rng(3)
    both = layering.together(_goals(rng, [b for b, _, _ in upper]), _goals(rng, [b for b, _, _ in lower]))
    wanted = layering.wanted(upper, lower)
    assert [body for body, _, _ in wanted] == both.bodies.tolist()
    kinds = {body: (place, turn) for body, place, turn in wanted}
    assert kinds[2] == ((True, True) if upper else (True, False))


# --- what goes along with the lower layer ---


def _layer(rng: np.random.Generator) -> Layer:
    turns = quat.normalize(rng.normal(size=(FRAMES, 4)))
    return Layer(_goals(rng, [0, 1]), rng.normal(size=(FRAMES, 3)), turns)


@few
@given(seeds)
def test_a_target_that_the_body_carries_along_is_seen_where_it_was(seed: int) -> None:
    """Goals are made as the body sees the target, and carried to where the body is: that meets the target."""
    rng = np.random.default_rng(seed)
    layer, target = _layer(rng), rng.normal(size=(1, 3))
    seen = layer.seen({4: target})[4]
    goals = Goals(np.array([9]), seen[:, None], quat.identity(FRAMES, 1), np.ones((FRAMES, 1)), np.ones((FRAMES, 1)))
    carried = layer.carries(goals)
    assert np.allclose(carried.positions[:, 0], np.broadcast_to(target, (FRAMES, 3)))
    assert quat.angle_between(carried.turns[:, 0], layer.turns).max() < 1e-6


def test_frames_of_a_layer_are_those_of_the_whole() -> None:
    layer = _layer(np.random.default_rng(5))
    part = layer.at(slice(2, 4))
    assert (part.goals.positions == layer.goals.positions[2:4]).all()
    assert (part.goals.rotation_influence == layer.goals.rotation_influence[2:4]).all()
    assert (part.places == layer.places[2:4]).all()
    assert (part.turns == layer.turns[2:4]).all()
