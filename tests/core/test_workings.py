"""What is to be seen of a pose: it is the pose, and says truly which goals were met."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from morph_retarget.core import quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.solve import posing
from morph_retarget.core.solve.goals import Goals
from morph_retarget.core.solve.plan import Plan
from morph_retarget.core.solve.settings import DEFAULT
from morph_retarget.core.solve.workings import TOLERANCE, Workings, workings_of
from tests import goal_sets, pose_measures
from tests.goal_sets import Subject
from tests.skeletons import skeleton_of
from tools.figure import Bone, Build, humanoid

SETS = 12
CREATURES = ("biped", "hound", "beetle", "bird", "snake", "asura", "lopside")


@pytest.fixture(params=CREATURES, scope="module")
def subject(request: pytest.FixtureRequest) -> Subject:
    """Return each of the sample characters."""
    return Subject(goal_sets.creatures()[request.param])


def _goals(subject: Subject, seed: int = 1) -> Goals:
    return goal_sets.random_sets(subject, np.random.default_rng(seed), SETS).goals


def _seen(plan: Plan, goals: Goals) -> Workings:
    return workings_of(plan, goals, posing.solve(plan, goals))


def _unbent(subject: Subject) -> Plan:
    wanted = [(int(body), True, True) for body in subject.goals]
    return posing.prepare(subject.character, subject.bodies.positions, subject.root, wanted, DEFAULT)


def _states(seen: Workings) -> Array:
    return np.stack([seen.met, seen.missed, seen.blended, seen.fixed])


def test_every_goal_appears_once_and_in_one_state(subject: Subject) -> None:
    goals = _goals(subject)
    seen = _seen(subject.plan, goals)
    assert sorted(seen.bodies.tolist()) == sorted(set(subject.goals.tolist()))
    assert (_states(seen).sum(axis=0) == 1).all()
    assert not seen.blended.any(), "all of them count in full"
    np.testing.assert_array_equal(seen.asked, goals.positions)


def test_goals_are_met_exactly_where_the_error_is_within_the_tolerance(subject: Subject) -> None:
    sets = goal_sets.random_sets(subject, np.random.default_rng(2), SETS)
    for goals in (sets.goals, goal_sets.beyond(sets, 1.5), goal_sets.beyond(sets, 0.3)):
        pose = posing.solve(subject.plan, goals)
        seen = workings_of(subject.plan, goals, pose)
        errors = quat.length(pose_measures.rebuilt(subject, pose)[:, subject.goals] - goals.positions)
        clear = np.abs(errors - seen.tolerance) > 1e-9 * subject.scale
        np.testing.assert_array_equal(seen.met[clear], (errors <= seen.tolerance)[clear])
    assert 0.5e-3 * subject.scale < seen.tolerance <= 1e-3 * subject.scale, "a millimetre on a human"


def test_at_rest_all_goals_are_met(subject: Subject) -> None:
    goals = goal_sets.at_rest(subject)
    assert _seen(subject.plan, goals).met.all()
    assert _seen(_unbent(subject), goals).met.all()


def test_places_are_those_of_the_pose(subject: Subject) -> None:
    for plan in (subject.plan, _unbent(subject)):
        goals = _goals(subject, 3)
        pose = posing.solve(plan, goals)
        seen = workings_of(plan, goals, pose)
        limbs = [limb for wave in plan.waves for limb in wave.limbs]
        lines = [[*limb.path, limb.body] for limb in limbs]
        np.testing.assert_array_equal(seen.came, pose.positions[:, goals.bodies])
        drawn = sorted({body for line in lines for body in line})
        assert seen.joints.shape[1] == len(drawn), "each particle once"
        assert _apart(seen.joints, pose.positions[:, drawn]) == 0.0
        assert seen.bones.shape[1] == len({bone for line in lines for bone in pairwise(line)}), "each bone once"


def test_bones_are_as_long_as_at_rest(subject: Subject) -> None:
    seen, rest = (_seen(subject.plan, goals) for goals in (_goals(subject, 4), goal_sets.at_rest(subject)))
    lengths, own = (quat.length(found.bones[:, :, 1] - found.bones[:, :, 0]) for found in (seen, rest))
    np.testing.assert_allclose(lengths, np.broadcast_to(own, lengths.shape), atol=1e-9 * subject.scale)


def test_the_spine_leads_from_branch_point_to_branch_point(subject: Subject) -> None:
    trunk, goals = subject.plan.trunk, _goals(subject, 5)
    seen = _seen(subject.plan, goals)
    still = _seen(subject.plan, goal_sets.at_rest(subject))
    if trunk is None:
        assert seen.branches.shape[1] == seen.spine.shape[1] == seen.pulls.shape[1] == 0
        return
    np.testing.assert_allclose(still.branches[0], trunk.spine.points[list(trunk.spine.nodes)], atol=1e-9)
    np.testing.assert_array_equal(seen.spine[:, :, 0], seen.branches[:, :-1])
    np.testing.assert_array_equal(seen.spine[:, :, 1], seen.branches[:, 1:])
    chords = quat.length(seen.spine[:, :, 1] - seen.spine[:, :, 0])
    assert (chords <= trunk.spine.most * (1.0 + 1e-6)).all(), "no farther apart than their bones reach"
    assert seen.pulls.shape[1] == len(trunk.spine.pulls)
    np.testing.assert_array_equal(seen.pulls[:, :, 1], goals.positions[:, list(trunk.pulls)])


def test_branch_points_with_goals_of_their_own_are_where_these_came_to(subject: Subject) -> None:
    """A head that ends the spine is its last branch point."""
    trunk = subject.plan.trunk
    own = [pin for pin in trunk.pins if pin.owner == pin.body] if trunk else []
    seen = _seen(subject.plan, _goals(subject, 6))
    for pin in own:
        came = seen.came[:, seen.bodies.tolist().index(pin.owner)]
        np.testing.assert_allclose(seen.branches[:, pin.node], came, atol=1e-9 * subject.scale)


def test_without_a_spine_that_bends_there_are_limbs_alone(subject: Subject) -> None:
    seen = _seen(_unbent(subject), _goals(subject))
    assert seen.branches.shape == (SETS, 0, 3)
    assert seen.spine.shape == seen.pulls.shape == (SETS, 0, 2, 3)
    assert (_states(seen).sum(axis=0) == 1).all()


def test_goals_that_count_in_part_are_not_missed(subject: Subject) -> None:
    goals = _goals(subject, 7)
    half = replace(goals, position_influence=np.full_like(goals.position_influence, 0.5))
    seen = _seen(subject.plan, half)
    assert not seen.missed.any()
    assert seen.blended.any()
    rounded = replace(goals, position_influence=np.full_like(goals.position_influence, 1.0 - 1e-12))
    assert not _seen(subject.plan, rounded).blended.any()


def test_goals_that_ask_for_turns_alone_are_in_no_state(subject: Subject) -> None:
    goals = _goals(subject, 8)
    turns = replace(goals, position_influence=np.zeros_like(goals.position_influence))
    assert not _states(_seen(subject.plan, turns)).any()


def test_what_cannot_be_moved_is_told_from_what_was_missed() -> None:
    bones = [*humanoid(), Bone("mouth", "head", (0.0, -0.1, 1.6), (0.0, -0.15, 1.6))]
    character = analyze(skeleton_of(bones))
    rest = character.local_to_character.points(character.skeleton.rest_positions)
    index = character.skeleton.index
    wanted = [index[name] for name in ("hips", "head", "mouth", "leftHand")]
    plan = posing.prepare(character, rest, wanted[0], [(body, True, False) for body in wanted])
    assert plan.unreachable == (index["mouth"],)
    asked = rest[wanted][None] + np.array([0.0, -3.0, 0.0]) * np.array([0, 0, 1, 1])[:, None]
    ones = np.ones((1, 4))
    seen = _seen(plan, Goals(np.array(wanted), asked, quat.identity(1, 4), ones, ones))
    assert seen.movable.tolist() == [True, True, False, True]
    assert seen.met.tolist() == [[True, True, False, False]]
    assert seen.fixed.tolist() == [[False, False, True, False]]
    assert seen.missed.tolist() == [[False, False, False, True]]
    assert seen.errors[0, 3] > TOLERANCE * 1.75


def test_limbs_that_share_a_stem_hang_together() -> None:
    """Two fingers with goals: one arm, drawn once, and a finger each."""
    character = analyze(skeleton_of(humanoid(build=Build(fingers=2))))
    rest, index = character.local_to_character.points(character.skeleton.rest_positions), character.skeleton.index
    wanted = [index["hips"], index["leftThumbDistal"], index["leftIndexDistal"]]
    plan = posing.prepare(character, rest, wanted[0], [(body, True, False) for body in wanted])
    ones = np.ones((1, 3))
    asked = rest[wanted][None] + np.array([0.0, -0.05, 0.05])
    seen = _seen(plan, Goals(np.array(wanted), asked, quat.identity(1, 3), ones, ones))
    assert seen.movable.all()
    assert seen.bones.shape[1] == seen.joints.shape[1] - 1, "a tree"
    lengths = np.sort(quat.length(seen.bones[0, :, 1] - seen.bones[0, :, 0]))
    still = _seen(plan, Goals(np.array(wanted), rest[wanted][None], quat.identity(1, 3), ones, ones))
    np.testing.assert_allclose(lengths, np.sort(quat.length(still.bones[0, :, 1] - still.bones[0, :, 0])), atol=1e-9)


def test_frames_are_seen_alike_alone_and_together(subject: Subject) -> None:
    goals = _goals(subject, 9)
    whole, alone = _seen(subject.plan, goals), _seen(subject.plan, goal_sets.rows(goals, slice(3, 4)))
    for name in ("came", "joints", "bones", "branches", "spine", "pulls"):
        np.testing.assert_allclose(getattr(whole, name)[3:4], getattr(alone, name), atol=1e-9 * subject.scale)


def _apart(some: Array, others: Array) -> float:
    """Return how far points are from the nearest of others at most [m], shapes (frame, n, 3)."""
    return float(quat.length(some[:, :, None] - others[:, None]).min(axis=2).max(initial=0.0))
