"""The limb phase: limbs that reach. Poses are rebuilt from bones and measured."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from morph_retarget.core import quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.solve import limb_phase
from morph_retarget.core.solve.limb_phase import STRAIGHT, Limbs
from morph_retarget.core.solve.settings import DEFAULT

seeds = st.integers(0, 10_000)
few = settings(max_examples=30)
UP = np.array([0.0, 0.0, 1.0])
ELBOW_BACK = np.array([0.0, 1.0, 0.0])


def _chain(rng: np.random.Generator, joints: int, bend: float) -> tuple[Limbs, float]:
    """Return a limb of uneven bones in any direction that bends at rest, each joint its own way; and its length."""
    way = quat.unit(rng.normal(size=3))
    segments: list[Array] = []
    size = 10.0 ** rng.uniform(-2.0, 2.0)
    for _ in range(joints):
        segments.append(size * rng.uniform(0.1, 1.0) * way)
        way = quat.rotate(quat.from_axis_angle(quat.unit(rng.normal(size=3)), bend * rng.uniform(-1.0, 1.0)), way)
    points = np.concatenate([[np.zeros(3)], np.cumsum(segments, axis=0)])
    return Limbs.of([points], [quat.unit(rng.normal(size=3))]), float(quat.length(np.array(segments)).sum())


def _reach(limb: Limbs, goals: Array) -> tuple[Array, Array]:
    """Return the turns of a limb that reaches, shape (frame, joint, 4), and where the turned bones lead."""
    rotations = limb_phase.solve(limb, goals[:, None])[:, 0]
    assert np.abs(np.linalg.det(rotations) - 1.0).max() < 1e-9
    turns = quat.from_matrix(rotations)
    return turns, quat.rotate(turns, limb.segments[0]).sum(axis=1)


def _arm(bend: float = 0.4) -> Limbs:
    """Return an arm of two bones of 0.3 m that hangs down and bends its elbow backward by ``bend`` [rad]."""
    elbow = np.array([0.0, np.sin(bend / 2), -np.cos(bend / 2)]) * 0.3
    return Limbs.of([np.array([np.zeros(3), elbow, elbow * [1, 0, 2]])], [ELBOW_BACK])


@few
@given(seed=seeds, joints=st.integers(2, 6), bend=st.sampled_from([0.0, 0.02, 0.3, 1.0, 2.0]))
def test_a_limb_reaches_every_point_within_its_reach(seed: int, joints: int, bend: float) -> None:
    rng = np.random.default_rng(seed)
    limb, length = _chain(rng, joints, bend)
    full, chord = limb.full[0], limb.chords[0]
    least, most = limb.shapes.least[0], max(DEFAULT.slow_down * full, chord)
    goals = quat.unit(rng.normal(size=(300, 3))) * rng.uniform(least, most, (300, 1))
    _, ends = _reach(limb, goals)
    assert quat.length(ends - goals).max() < 1e-3 * length


@few
@given(seed=seeds, joints=st.integers(2, 6), bend=st.sampled_from([0.0, 0.02, 0.3, 1.0]))
def test_a_limb_stretches_out(seed: int, joints: int, bend: float) -> None:
    limb, length = _chain(np.random.default_rng(seed), joints, bend)
    _, ends = _reach(limb, 10.0 * length * quat.unit(limb.segments[0].sum(axis=0))[None])
    assert quat.length(ends)[0] >= 0.998 * length


@few
@given(seed=seeds, joints=st.integers(2, 6))
def test_a_straight_limb_folds_up(seed: int, joints: int) -> None:
    limb, length = _chain(np.random.default_rng(seed), joints, 0.0)
    assert limb.shapes.least[0] <= max(0.5 * length, 1.2 * (2.0 * limb.lengths.max() - length))


@few
@given(seed=seeds, joints=st.integers(1, 6), bend=st.sampled_from([0.0, 1e-3, 0.02, 0.3, 1.0, 2.0]))
def test_the_rest_goal_is_the_rest_pose(seed: int, joints: int, bend: float) -> None:
    limb, length = _chain(np.random.default_rng(seed), joints, bend)
    goal = limb.segments[0].sum(axis=0)
    turns, ends = _reach(limb, goal[None])
    assert quat.angle_between(turns, quat.IDENTITY).max() < 1e-6
    assert quat.length(ends - goal).max() < 1e-6 * length


@settings(max_examples=12)
@given(seed=seeds, joints=st.integers(2, 6), bend=st.sampled_from([0.0, 0.02, 0.3, 1.0, 2.0]))
def test_a_limb_never_snaps_whether_its_goal_is_in_reach_or_not(seed: int, joints: int, bend: float) -> None:
    rng = np.random.default_rng(seed)
    limb, length = _chain(rng, joints, bend)
    # Next to its first joint a goal has no direction; and straight opposite there is more than one way to turn round.
    away, way = length * np.linspace(0.05, 1.5, 30001), quat.unit(rng.normal(size=3))
    way *= np.sign(way @ limb.segments[0].sum(axis=0))
    turns, ends = _reach(limb, away[:, None] * way)
    # Joints that stand a little bent against their hint go over to its side at once.
    jump = 0.05 if bend > STRAIGHT or bend == 0.0 else 2.0 * STRAIGHT
    assert quat.angle_between(turns[1:], turns[:-1]).max() < jump
    assert quat.length(np.diff(ends, axis=0)).max() < 1e-2 * length


def test_a_goal_beyond_reach_is_approached_ever_more_slowly() -> None:
    away = np.linspace(0.5, 3.0, 2001)
    limb = _arm()
    _, ends = _reach(limb, away[:, None] * quat.unit(np.array([1.0, -2.0, 0.5])))
    distance = quat.length(ends)
    step = np.diff(distance)
    inside = away[1:] < DEFAULT.slow_down * 0.6
    assert np.abs(distance - away)[1:][inside].max() < 1e-4
    assert (step > -1e-6).all()
    assert (np.diff(step[~inside]) < 1e-4).all()
    assert distance.max() <= DEFAULT.full_reach * 0.6 + 1e-5
    assert np.abs(quat.unit(ends) - quat.unit(np.array([1.0, -2.0, 0.5]))).max() < 1e-9


def test_bones_keep_their_lengths() -> None:
    """Turns are rotations: what they do not change is length."""
    rng = np.random.default_rng(3)
    limb, _ = _chain(rng, 4, 1.0)
    turns, _ = _reach(limb, 5.0 * rng.normal(size=(100, 3)))
    assert np.abs(quat.length(turns) - 1.0).max() < 1e-12


@pytest.mark.parametrize("bend", [0.4, 0.06, 0.01, 0.0, -0.01, -0.04])
def test_elbows_keep_the_side_to_which_they_bend(bend: float) -> None:
    """Hardly bent arms bend the way of the hint, even those that stand a little overstretched at rest."""
    assert bend > -STRAIGHT
    limb = _arm(bend)
    heights = np.linspace(0.18, 0.55, 200)
    turns, ends = _reach(limb, -heights[:, None] * UP)
    elbows = quat.rotate(turns[:, 0], limb.segments[0][0])
    behind = quat.dot(elbows, np.broadcast_to(ELBOW_BACK, elbows.shape))
    assert (behind > 0.0).all()
    assert (np.diff(behind) < 0.0).all()
    assert np.abs(elbows[:, 0]).max() < 1e-9
    assert quat.length(ends + heights[:, None] * UP).max() < 1e-3


def test_each_pose_of_a_limb_depends_on_its_own_goal_alone() -> None:
    rng = np.random.default_rng(5)
    limb, length = _chain(rng, 3, 1.0)
    goals = length * rng.normal(size=(500, 3))
    order = rng.permutation(500)
    assert np.array_equal(_reach(limb, goals[order])[0], _reach(limb, goals)[0][order])


@pytest.mark.parametrize("count", [1, 2, 3])
def test_a_limb_without_length_stays_as_it_is(count: int) -> None:
    limb = Limbs.of([np.zeros((count + 1, 3))], [np.zeros(3)])
    for goal in (np.zeros((1, 3)), np.array([[0.3, -0.2, 0.1]]), np.full((1, 3), 1e9)):
        turned = limb_phase.solve(limb, goal[:, None])
        assert np.isfinite(turned).all()
        assert np.abs(np.linalg.det(turned) - 1.0).max() < 1e-9
