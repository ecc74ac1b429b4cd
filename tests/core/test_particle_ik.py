"""Laws of the pose step, on bodies of any shape. Poses are rebuilt from turns of joints alone, and measured."""

from collections.abc import Mapping
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from morph_retarget.core import quat
from morph_retarget.core.arrays import Array, Indices
from morph_retarget.core.solve import posing
from morph_retarget.core.solve.goals import Goals
from morph_retarget.core.solve.posing import BodyPose
from tests import goal_sets, pose_measures
from tests.goal_sets import HUMAN, STRETCH, Hinged, Sets, Subject, rows
from tests.pose_measures import MEET, solved

SETS = 120
SHARE, LEAST, ALONE = 0.99, 0.96, 0.75
"""Of goals within the workspace that are met: on all rigs together, on each, and of one hand alone."""
NEAR = 1e-6
"""Poses are the same when bodies are as near as this, as a share of the character's size …"""
TURN = 1e-5
"""… and turned alike as much as this [rad]: rounding, amplified where a limb is nearly straight."""
JUMP, AT_THE_EDGE = 20.0, 25.0
"""Nothing turns further while goals move by 1 % of a way or of the character's size, or leave the workspace [deg]."""
CREATURES = ("biped", "hound", "beetle", "bird", "snake", "asura", "lopside")
SYMMETRIC = ("biped", "hound", "beetle", "bird", "asura")
RIGS = (
    "m2m_human",
    "daz_genesis8",
    "mixamo_mpfb",
    "quaternius_cyberpunk_ikfeet",
    "max_biped_bip001",
    "rigify_cat",
    "m2m_spider",
    "m2m_kaiju",
    "quaternius_wolf",
    "rigify_bird",
    "m2m_snake",
    "sketchbook_boxman",
)
"""Twist bones, clavicles on the neck, feet that hang on the ground, tails, eight legs, stumps, no limbs at all."""


@cache
def _creatures() -> Mapping[str, Subject]:
    return {name: Subject(character) for name, character in goal_sets.creatures().items()}


@cache
def _rigs(data: Path) -> Mapping[str, Subject]:
    return {name: Subject(character) for name, character in goal_sets.real(data, RIGS).items()}


@pytest.fixture(params=CREATURES)
def subject(request: pytest.FixtureRequest) -> Subject:
    """Return each of the sample characters."""
    return _creatures()[request.param]


def _sets(subject: Subject, count: int = SETS, seed: int = 1) -> Sets:
    return goal_sets.random_sets(subject, np.random.default_rng(seed), count)


def _apart(subject: Subject, pose: BodyPose, places: Array, turns: Array, bodies: Indices) -> tuple[float, float]:
    """Return how far bodies are from where they should be, over the character's size, and how far turned [rad]."""
    away = quat.length(pose.positions[:, bodies] - places).max() / (HUMAN * subject.scale)
    return float(away), float(quat.angle_between(pose.turns[:, bodies], turns).max())


# --- the sets themselves ---


def test_sets_can_be_met_together(subject: Subject) -> None:
    sets = _sets(subject)
    places, _ = sets.pose
    assert pose_measures.misses(subject, sets.goals, places).max() == 0.0
    assert pose_measures.length_errors(subject, places).max() < 1e-9
    for hinged in subject.limbs:
        line = subject.bodies.tree.path(hinged.first, hinged.limb.end)
        chord = quat.length(places[:, line[-1]] - places[:, line[0]])
        whole = quat.length(np.diff(subject.bodies.positions[line], axis=0)).sum()
        assert chord.max() <= max(STRETCH, chord.min() / whole) * whole * (1 + 1e-9)


def test_ways_lead_from_set_to_set(subject: Subject) -> None:
    sets = _sets(subject, 2)
    for way in (sets.toward(0, 1, 10).goals, sets.straight(0, 1, 10)):
        assert len(way) == 11
        assert np.abs(way.positions[[0, -1]] - sets.goals.positions).max() < 1e-9 * subject.scale
        assert quat.angle_between(way.turns[[0, -1]], sets.goals.turns).max() < 1e-6


# --- accuracy ---


def _met(subject: Subject, goals: Goals) -> tuple[float, float]:
    """Return the share of goals but the root's that are met, and how far bodies are turned from them [rad]."""
    pose = solved(subject, goals)
    missed = pose_measures.misses(subject, goals, pose_measures.rebuilt(subject, pose))
    assert missed[:, 0].max() <= 1e-6 * MEET, "the root is where it is wanted"
    turned = quat.angle_between(pose.turns[:, goals.bodies], goals.turns)
    return float((missed[:, 1:] <= MEET).mean()), float(turned.max())


def test_goals_within_the_workspace_are_met(subject: Subject) -> None:
    share, turned = _met(subject, _sets(subject).goals)
    assert share >= LEAST
    assert turned < TURN


def test_goals_within_the_workspace_are_met_on_real_rigs(data: Path) -> None:
    found = {name: _met(subject, _sets(subject).goals) for name, subject in _rigs(data).items()}
    short = {name: round(share, 3) for name, (share, _) in found.items() if share < LEAST}
    assert not short
    assert np.mean([share for share, _ in found.values()]) >= SHARE
    assert max(turned for _, turned in found.values()) < TURN


def test_a_goal_alone_is_met(subject: Subject) -> None:
    """Whatever else is free: the root stays, and one hand, foot or head goes where it could go with it.

    The feet have goals as well: a trunk does not move the legs that nobody poses. Of a hand nothing but the spine's own
    shape tells how the spine shall bend for it, so fewer are met than when the head has a goal.
    """
    sets = _sets(subject)
    still = Sets(subject, sets.own.copy(), np.zeros_like(sets.shift))
    still.own[:, subject.root] = quat.IDENTITY
    goals = still.goals
    feet = [i for i, body in enumerate(goals.bodies.tolist()) if body in {leg.end for leg in subject.character.legs}]
    for i, body in enumerate(goals.bodies.tolist()):
        chosen = [i, *(j for j in feet if j != i)]
        some = goal_sets.goals_of(goals.bodies[chosen], goals.positions[:, chosen], goals.turns[:, chosen])
        pose = posing.solve(subject.plan_for(some.bodies), some)
        misses = pose_measures.misses(subject, some, pose_measures.rebuilt(subject, pose))
        assert (misses[:, 0] <= MEET).mean() >= ALONE, subject.bodies.names[body]
        assert np.abs(pose.positions[:, subject.root] - subject.bodies.positions[subject.root]).max() == 0.0


# --- lengths ---


def _assert_lengths(subject: Subject, goals: Goals, what: str) -> None:
    pose = solved(subject, goals)
    assert pose_measures.length_errors(subject, pose.positions).max() <= 1e-5, what
    assert pose_measures.gaps(subject, pose.positions).max(initial=0.0) <= 1e-5, what
    away = np.abs(pose.positions - pose_measures.rebuilt(subject, pose)).max()
    assert away <= NEAR * HUMAN * subject.scale + 1e-12 * np.abs(goals.positions).max(), what


def test_bones_keep_their_lengths(subject: Subject) -> None:
    for what, goals in {"random": _sets(subject).goals, **goal_sets.hard(subject, 30)}.items():
        _assert_lengths(subject, goals, what)


def test_bones_of_real_rigs_keep_their_lengths(data: Path) -> None:
    for name, subject in _rigs(data).items():
        _assert_lengths(subject, _sets(subject, 30).goals, name)


# --- rest ---


def _assert_rest(subject: Subject, pose: BodyPose, what: str) -> None:
    everything = np.arange(len(subject.bodies))
    away, turned = _apart(subject, pose, subject.bodies.positions, quat.IDENTITY, everything)
    assert away <= 1e-9, what
    assert turned <= 1e-7, what


def test_without_goals_the_pose_is_the_rest_pose(subject: Subject) -> None:
    nothing = goal_sets.goals_of(subject.goals[:0], np.empty((3, 0, 3)), np.empty((3, 0, 4)))
    _assert_rest(subject, posing.solve(subject.plan_for([]), nothing), "no goals")


def test_goals_without_influence_leave_the_rest_pose(subject: Subject) -> None:
    goals = _sets(subject, 5).goals
    none = np.zeros_like(goals.position_influence)
    _assert_rest(subject, solved(subject, Goals(goals.bodies, goals.positions, goals.turns, none, none)), "none")


def test_goals_at_rest_are_the_rest_pose(subject: Subject) -> None:
    goals = goal_sets.at_rest(subject, 3)
    _assert_rest(subject, solved(subject, goals), "all")
    for i, body in enumerate(goals.bodies.tolist()):
        one = goal_sets.goals_of(goals.bodies[[i]], goals.positions[:, [i]], goals.turns[:, [i]])
        _assert_rest(subject, posing.solve(subject.plan_for([body]), one), subject.bodies.names[body])


def test_goals_at_rest_are_the_rest_pose_of_real_rigs(data: Path) -> None:
    for name, subject in _rigs(data).items():
        _assert_rest(subject, solved(subject, goal_sets.at_rest(subject)), name)


def test_what_leads_to_no_goal_is_carried_along(subject: Subject) -> None:
    """Ears, wings, fingers and toes keep to what they hang on (Hecker 2008 §4.3.1)."""
    pose = solved(subject, _sets(subject, 20).goals)
    leading = {*subject.joints.tolist(), *subject.goals.tolist()}
    carried = [b for b in subject.of_root.tolist() if b not in leading]
    above = subject.bodies.parents[carried]
    assert quat.angle_between(pose.turns[:, carried], pose.turns[:, above]).max(initial=0.0) < 1e-7


# --- symmetries ---


def test_goals_moved_rigidly_move_the_pose_rigidly(subject: Subject) -> None:
    sets, rng = _sets(subject, 60), np.random.default_rng(4)
    goals, bodies = sets.goals, subject.of_root
    turn = quat.normalize(rng.normal(size=(60, 1, 4)))
    shift = 10.0 * subject.scale * rng.normal(size=(60, 1, 3))
    moved = goal_sets.goals_of(
        goals.bodies, quat.rotate(turn, goals.positions) + shift, quat.multiply(turn, goals.turns)
    )
    pose, again = solved(subject, goals), solved(subject, moved)
    places, turns = quat.rotate(turn, pose.positions[:, bodies]) + shift, quat.multiply(turn, pose.turns[:, bodies])
    away, turned = _apart(subject, again, places, turns, bodies)
    assert away <= NEAR
    assert turned <= TURN


@pytest.mark.parametrize("name", SYMMETRIC)
def test_mirrored_goals_make_the_mirrored_pose(name: str) -> None:
    subject = _creatures()[name]
    partner = pose_measures.partners(subject)
    assert partner is not None
    goals = _sets(subject, 60).goals
    pose, again = solved(subject, goals), solved(subject, pose_measures.mirrored(goals, partner))
    places, turns = (
        pose.positions[:, partner] * pose_measures.MIRROR,
        pose.turns[:, partner] * pose_measures.MIRROR_TURN,
    )
    away, turned = _apart(subject, again, places, turns, np.arange(len(subject.bodies)))
    assert away <= NEAR
    assert turned <= TURN


# --- smoothness ---


def test_small_steps_of_goals_are_small_steps_of_joints(subject: Subject) -> None:
    """On a way from set to set, a hundredth of it turns nothing by 20 degrees."""
    sets = _sets(subject, 8)
    pose = solved(subject, sets.ways(range(0, 8, 2), range(1, 8, 2), 100).goals)
    assert np.degrees(pose_measures.step_turns(pose.turns, 4).max()) <= JUMP


@pytest.mark.parametrize("step", [1e-3, 1e-5])
def test_tiny_changes_of_goals_are_tiny_changes_of_poses(subject: Subject, step: float) -> None:
    """What is nearly straight bends with the square root of the distance that is left; nothing is steeper."""
    sets, rng = _sets(subject), np.random.default_rng(5)
    goals, pose = sets.goals, solved(subject, sets.goals)
    moved = step * HUMAN * subject.scale * quat.unit(rng.normal(size=goals.positions.shape))
    turn = quat.from_rotation_vector(step * quat.unit(rng.normal(size=goals.positions.shape)))
    turned = quat.multiply(turn, goals.turns)
    again = solved(subject, goal_sets.goals_of(goals.bodies, goals.positions + moved, turned))
    turns = np.degrees(quat.angle_between(again.turns, pose.turns).max(axis=1))
    assert np.percentile(turns, 99.0) <= JUMP * np.sqrt(step / 1e-2)
    assert turns.max() <= JUMP


def test_a_goal_that_leaves_the_workspace_does_not_snap(subject: Subject) -> None:
    """Limbs stretch out toward goals that run away from them, and never turn by 25 degrees in a step of 1 %."""
    sets = _sets(subject, 4)
    for i in range(4):
        shares = np.linspace(1.0, 2.0, 101)
        ways = [goal_sets.beyond(sets, share) for share in shares]
        goals = goal_sets.goals_of(
            subject.goals,
            np.array([way.positions[i] for way in ways]),
            np.array([way.turns[i] for way in ways]),
        )
        assert np.degrees(pose_measures.step_turns(solved(subject, goals).turns).max()) <= AT_THE_EDGE


# --- naturalness ---


def _bends(subject: Subject, hinged: Hinged, turns: Array) -> Array:
    """Return how far hinges bend beyond straight, to the side to which they do at rest [rad], shape (frame, hinge)."""
    line, rest = subject.bodies.tree.path(hinged.first, hinged.limb.end), subject.bodies.positions
    out = np.empty((len(turns), len(hinged.hinges)))
    for i, (hinge, axis) in enumerate(zip(hinged.hinges, hinged.axes, strict=True)):
        place = line.index(hinge)
        upper, turn = line[place - 1], turns[:, line[place - 1]]
        before = quat.rotate(turn, quat.unit(rest[hinge] - rest[upper]))
        after = quat.rotate(turns[:, hinge], quat.unit(rest[line[place + 1]] - rest[hinge]))
        out[:, i] = np.arctan2(quat.dot(quat.cross(before, after), quat.rotate(turn, axis)), quat.dot(before, after))
    # What is folded up altogether has bent by half a turn, a little more or less.
    return np.where(out < -0.75 * np.pi, out + 2.0 * np.pi, out)


def test_knees_and_elbows_bend_the_way_they_do_at_rest(subject: Subject) -> None:
    """Wherever the goals are: a leg that is nearly straight is overstretched by 3 degrees at most.

    Limbs of several hinges may fold through themselves for goals that are nearer than they can come.
    """
    for what, goals in {"random": _sets(subject).goals, **goal_sets.hard(subject, 30)}.items():
        pose = solved(subject, goals)
        for hinged in subject.limbs:
            if what != "random" and len(hinged.hinges) > 1:
                continue
            least = _bends(subject, hinged, pose.turns).min(initial=0.0)
            assert np.degrees(least) >= -3.0, (what, subject.bodies.names[hinged.limb.end])


# --- failing gracefully ---


def test_hard_goals_make_poses_without_nan(subject: Subject) -> None:
    for what, goals in goal_sets.hard(subject, 30).items():
        pose = solved(subject, goals)
        assert np.isfinite(pose.positions).all(), what
        assert np.isfinite(pose.shift).all(), what
        assert np.abs(quat.length(pose.turns) - 1.0).max() < 1e-9, what


def test_hard_goals_make_poses_without_nan_on_real_rigs(data: Path) -> None:
    for name, subject in _rigs(data).items():
        for what, goals in goal_sets.hard(subject, 30).items():
            pose = solved(subject, goals)
            assert np.isfinite(pose.positions).all(), (name, what)
            assert np.abs(quat.length(pose.turns) - 1.0).max() < 1e-9, (name, what)


def test_limbs_reach_for_goals_at_infinity(subject: Subject) -> None:
    """A hand that cannot be where it should at least goes there: its limb points at the goal, within 5 degrees."""
    goals = rows(goal_sets.at_infinity(subject, np.random.default_rng(6), 60), slice(0, None, 2))
    pose = solved(subject, goals)
    place = {int(body): i for i, body in enumerate(goals.bodies)}
    for hinged in subject.limbs:
        start, end = pose.positions[:, hinged.first], pose.positions[:, hinged.limb.end]
        toward = quat.unit(goals.positions[:, place[hinged.limb.end]] - start)
        pointing = quat.dot(quat.unit(end - start), toward)
        assert pointing.min() >= np.cos(np.radians(5.0)), subject.bodies.names[hinged.limb.end]


# --- path independence ---


def _same(pose: BodyPose, other: BodyPose, chosen: Indices | slice) -> bool:
    """Return whether a pose is some frames of another, bit for bit."""
    places = np.array_equal(pose.positions, other.positions[chosen])
    return (
        places and np.array_equal(pose.turns, other.turns[chosen]) and np.array_equal(pose.shift, other.shift[chosen])
    )


def _goals_of_all_kinds(subject: Subject) -> Goals:
    """Return goals in reach and hard ones, with influences of any size."""
    parts = [_sets(subject, 60).goals, *goal_sets.hard(subject, 30).values()]
    places, turns = (np.concatenate([getattr(part, name) for part in parts]) for name in ("positions", "turns"))
    influence = np.random.default_rng(7).uniform(0.0, 1.0, (2, *places.shape[:2]))
    influence[:, ::2] = 1.0
    return Goals(subject.goals, places, turns, influence[0], influence[1])


def test_frames_in_any_order_have_the_same_poses(subject: Subject) -> None:
    goals = _goals_of_all_kinds(subject)
    pose, rng = solved(subject, goals), np.random.default_rng(8)
    for order in (np.arange(len(goals))[::-1], rng.permutation(len(goals))):
        same = _same(solved(subject, rows(goals, order)), pose, order)
        assert same


def test_frames_one_by_one_have_the_poses_of_a_batch(subject: Subject) -> None:
    goals = _goals_of_all_kinds(subject)
    pose = solved(subject, goals)
    for frame in range(0, len(goals), 16):
        one = slice(frame, frame + 1)
        same = _same(solved(subject, rows(goals, one)), pose, one)
        assert same, frame


def test_parts_of_a_batch_have_the_poses_of_the_whole(subject: Subject) -> None:
    goals = _goals_of_all_kinds(subject)
    pose = solved(subject, goals)
    for part in (slice(0, 7), slice(7, 48), slice(48, None)):
        same = _same(solved(subject, rows(goals, part)), pose, part)
        assert same
