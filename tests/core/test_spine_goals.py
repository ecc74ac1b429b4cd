"""Laws of a spine whose goals cannot all be met: it bends as far as that helps, and what is nearer in keeps its own."""

from collections.abc import Sequence
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from morph_retarget.core import quat
from morph_retarget.core.arrays import Array, Indices
from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.solve import posing
from morph_retarget.core.solve.goals import Goals
from morph_retarget.core.solve.posing import Plan
from tests import goal_sets
from tests.goal_sets import SETTINGS, Subject, rows

UPRIGHT = ("biped", "asura")
BEASTS = ("quaternius_wolf", "rigify_cat", "m2m_fox")
SLIGHT = 22.0
"""Most that a bone of the spine turns where hands reach down along it, by a twentieth of an arm too far [deg]."""


@cache
def _subject(name: str) -> Subject:
    return Subject(goal_sets.creatures()[name])


def _trunk(plan: Plan) -> list[int]:
    assert plan.trunk is not None
    return list(plan.trunk.joints)


def _plan(subject: Subject, placed: Sequence[int]) -> Plan:
    """Return how bodies come to places, with no goals for turns but the root's."""
    wanted = [(body, True, body == subject.root) for body in placed]
    return posing.prepare(subject.character, subject.bodies.positions, subject.root, wanted, SETTINGS)


def _goals(bodies: Indices, places: Array, influence: Array) -> Goals:
    still = np.zeros_like(influence)
    return Goals(bodies, places, quat.identity(*influence.shape), influence, still)


# --- limbs alone ---


@pytest.mark.parametrize("name", UPRIGHT)
def test_hands_that_reach_down_along_a_spine_do_not_make_it_zigzag(name: str) -> None:
    subject = _subject(name)
    hands = subject.bodies.with_capability(Capability.GRASPER)
    bodies = np.array([subject.root, *hands], dtype=np.intp)
    plan = _plan(subject, bodies.tolist())
    assert plan.trunk is not None
    shares = np.linspace(0.0, 0.05, 101)
    places = np.broadcast_to(subject.bodies.positions[bodies], (len(shares), len(bodies), 3)).copy()
    pulls = {int(bodies[goal]): pull for goal, pull in zip(plan.trunk.pulls, plan.trunk.spine.pulls, strict=True)}
    for i, hand in enumerate(hands, 1):
        pull = pulls[hand]
        start = subject.bodies.positions[plan.trunk.joints[pull.joint]] + pull.start
        places[:, i] = start - np.array([0.0, 0.0, 1.0]) * (pull.full * (1.0 + shares))[:, None]
    turns = posing.solve(plan, _goals(bodies, places, np.ones(places.shape[:2]))).turns[:, _trunk(plan)]
    assert np.degrees(quat.angle_between(turns, quat.identity(1))).max() <= SLIGHT


# --- several goals of a spine ---


def _reaching(subject: Subject, shares: Array) -> tuple[Plan, Goals, int]:
    """Return a beast whose chest moves a little, and whose head shall go far beyond its reach, as far as that counts.

    Returns:
        The plan, the goals, and the chest.
    """
    bodies = subject.bodies
    head = bodies.with_capability(Capability.HEAD)[0]
    plan = _plan(subject, [subject.root, head])
    line = [*_trunk(plan), head]
    chest = line[len(line) // 2]
    plan = _plan(subject, [subject.root, chest, head])
    own = np.array([subject.root, chest, head], dtype=np.intp)
    places = np.broadcast_to(bodies.positions[own], (len(shares), 3, 3)).copy()
    base = bodies.positions[line[0]]
    turn = quat.from_rotation_vector(np.array([np.radians(8.0), 0.0, 0.0]))
    places[:, 1] = base + quat.rotate(turn, bodies.positions[chest] - base)
    places[:, 2] += 0.5 * subject.bodies.size * np.array([0.0, -0.6, -0.8])
    influence = np.ones((len(shares), 3))
    influence[:, 2] = shares
    return plan, _goals(own, places, influence), chest


@pytest.fixture(scope="module", params=BEASTS)
def beast(request: pytest.FixtureRequest, data: Path) -> Subject:
    """Return some real beasts."""
    return Subject(goal_sets.real(data, [request.param])[request.param])


def test_a_chest_keeps_its_goal_when_the_head_cannot_come_to_its_own(beast: Subject) -> None:
    plan, goals, chest = _reaching(beast, np.ones(1))
    pose = posing.solve(plan, goals)
    length = float(np.linalg.norm(beast.bodies.positions[chest] - beast.bodies.positions[_trunk(plan)[0]]))
    assert quat.length(pose.positions[:, chest] - goals.positions[:, 1]).max() < 0.01 * length


def test_each_goal_of_a_spine_has_its_own_joints(beast: Subject) -> None:
    plan, _, chest = _reaching(beast, np.ones(1))
    head = beast.bodies.with_capability(Capability.HEAD)[0]
    inner, outer = plan.joints_of(chest), plan.joints_of(head)
    assert inner
    assert outer
    assert {*inner}.isdisjoint(outer)
    assert [*inner, *outer] == _trunk(plan)


def test_goals_that_hardly_count_hardly_bend_a_spine(beast: Subject) -> None:
    """So that an influence that is faded out ends without a jump."""
    shares = np.linspace(0.0, 1.0, 1001)
    plan, goals, _ = _reaching(beast, shares)
    turns = posing.solve(plan, goals).turns[:, _trunk(plan)]
    away = np.degrees(quat.angle_between(turns, turns[:1])).max(axis=1)
    assert away[10] <= 0.05 * away[-1]
    assert np.diff(away).max() <= 0.02 * away[-1]


def test_frames_bend_alike_alone_and_among_others(beast: Subject) -> None:
    """To the bit, also where a goal counts in some frames only."""
    plan, goals, _ = _reaching(beast, np.array([0.0, 0.3, 1.0, 0.0, 1.0]))
    goals.position_influence[:, 1] = [0.0, 1.0, 0.5, 1.0, 0.0]
    together = posing.solve(plan, goals).turns
    for i in range(len(together)):
        alone = posing.solve(plan, rows(goals, slice(i, i + 1))).turns
        np.testing.assert_array_equal(alone[0], together[i])
