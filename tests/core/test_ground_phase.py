"""The ground phase: what is only turned, or hangs beyond a goal, stays above the ground; places stay as they are."""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from morph_retarget.core import play, quat
from morph_retarget.core.arrays import Array, Indices
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.character.morphology import Capability, LimbKind
from morph_retarget.core.morph.bind import GeneralizedAction, bind
from morph_retarget.core.morph.channels import Channel, Values
from morph_retarget.core.morph.context import Context
from morph_retarget.core.solve import ground_phase, posing
from morph_retarget.core.solve.goals import Goals
from morph_retarget.core.solve.ground_phase import Lifting
from morph_retarget.core.solve.hierarchy import Hierarchy
from morph_retarget.core.solve.plan import Plan
from morph_retarget.core.solve.posing import BodyPose
from morph_retarget.core.solve.settings import SolverSettings
from tests import goal_sets, pose_measures
from tests.goal_sets import Subject, rows
from tests.skeletons import skeleton_of
from tools.figure import Build, humanoid

NAMES = ("hound", "bird", "snake", "asura", "human")
MOST = np.radians(70.0)
"""Most that tails, wings and hands are turned [rad]."""
LEFT = 0.05
"""Of how deep bodies are below the ground, what may be left at most: what hangs on a joint below the ground stays there
if it would have to point up steeply …"""
SUNK = 0.001
"""… and what may be left where the joints are above it [shares of the size]."""
JUMP = np.radians(20.0)
"""No joint turns further than without while goals go on by a hundredth of their way [rad]."""
EXACT = 1e-12


@cache
def _subjects() -> Mapping[str, Subject]:
    found = {name: Subject(c) for name, c in goal_sets.creatures().items() if name in NAMES}
    human = analyze(skeleton_of(humanoid(build=Build(fingers=3, arms_down=60.0)), np.random.default_rng(2)))
    return {**found, "human": Subject(human)}


@pytest.fixture(params=NAMES)
def subject(request: pytest.FixtureRequest) -> Subject:
    return _subjects()[request.param]


def _turned(subject: Subject) -> list[int]:
    """Return tails and wings."""
    own = subject.character
    wings = [limb for limb in own.limbs if limb.kind is LimbKind.WING]
    parts = (*own.tails, *((*limb.bones, *limb.digits) for limb in wings))
    return [bone for part in parts for bone in part if bone != subject.root]


def _hands(subject: Subject) -> list[int]:
    return [limb.end for limb in subject.character.limbs if limb.kind is LimbKind.ARM]


def _feet(subject: Subject) -> list[int]:
    return subject.bodies.with_capability(Capability.FOOT)


def _plan(subject: Subject) -> Plan:
    placed = [*_hands(subject), *_feet(subject)]
    wanted = [(subject.root, True, True), *((body, True, False) for body in placed)]
    wanted += [(body, False, True) for body in _turned(subject)]
    return posing.prepare(subject.character, subject.bodies.positions, subject.root, wanted)


def _lifting(subject: Subject, plan: Plan) -> Lifting | None:
    return Lifting.of(Hierarchy(subject.character, subject.bodies.positions, subject.root), plan)


def _goals(subject: Subject, seed: int, frames: int) -> Goals:
    """Return goals that have hands low, tails and wings turned by a lot, and the root lowered and tilted."""
    rng, rest = np.random.default_rng(seed), subject.bodies.positions
    placed, turned = [*_hands(subject), *_feet(subject)], _turned(subject)
    bodies: Indices = np.array([subject.root, *placed, *turned], dtype=np.intp)
    positions = np.repeat(rest[bodies][None], frames, axis=0)
    size = subject.bodies.extents.max()
    positions[:, 0, 2] *= 1.0 - rng.uniform(0.1, 0.6, frames)
    for i, hand in enumerate(_hands(subject), 1):
        positions[:, i, 2] = rng.uniform(0.02, 0.15, frames) * size
        positions[:, i, 0] = rest[hand, 0] * rng.uniform(0.4, 0.8, frames)
        positions[:, i, 1] = rest[hand, 1] - rng.uniform(0.0, 0.3, frames) * size
    axes = quat.unit(rng.normal(size=(frames, 1, 3)) + 0.4 * rng.normal(size=(frames, len(bodies), 3)))
    turns = quat.from_axis_angle(axes, rng.uniform(0.0, MOST, (frames, len(bodies))))
    # Trunks stoop, so that hands reach down, or rear up, so that tails hang down.
    turns[:, 0] = quat.from_axis_angle(np.array([1.0, 0.0, 0.0]), rng.choice([-0.9, 1.3], frames))
    return goal_sets.goals_of(bodies, positions, turns)


def _way(subject: Subject, seed: int, steps: int) -> Goals:
    """Return the way from one set of goals to another."""
    two, share = _goals(subject, seed, 2), np.linspace(0.0, 1.0, steps + 1)[:, None]
    positions = two.positions[[0]] + share[..., None] * (two.positions[1] - two.positions[0])
    return goal_sets.goals_of(two.bodies, positions, quat.slerp(two.turns[[0]], two.turns[[1]], share))


def _both(subject: Subject, goals: Goals) -> tuple[BodyPose, BodyPose]:
    """Return a pose, and what becomes of it."""
    plan = _plan(subject)
    lifting, pose = _lifting(subject, plan), posing.solve(plan, goals)
    assert lifting is not None
    return pose, ground_phase.lifted(lifting, pose)


def _loose(subject: Subject) -> list[int]:
    """Return what hangs on tails, wings and hands, the former themselves included."""
    tops = {*_hands(subject), *_turned(subject)}
    below = {body for top in tops for body in subject.tree.below(top)}
    return sorted(below | {*_turned(subject)})


def _depths(subject: Subject, pose: BodyPose) -> Array:
    """Return how deep these are below the ground [shares of the size], shape (frame, body)."""
    own = _loose(subject)
    floor = np.minimum(subject.bodies.positions[own, 2], 0.0)
    return np.maximum(floor - pose.positions[:, own, 2], 0.0) / subject.bodies.extents.max()


@pytest.mark.parametrize("name", ["bird", "snake", "asura", "human"])
def test_what_hangs_loose_comes_up_from_below_the_ground(name: str) -> None:
    subject = _subjects()[name]
    before, after = (_depths(subject, pose) for pose in _both(subject, _goals(subject, 1, 300)))
    assert (before.max(axis=1) > 0.02).sum() > 10, "there is something to be done"
    assert after.sum() < LEFT * before.sum()


def test_fingers_lie_on_the_ground_where_a_hand_is_above_it() -> None:
    for name in ("asura", "human"):
        subject = _subjects()[name]
        before, after = (_depths(subject, pose) for pose in _both(subject, _goals(subject, 2, 300)))
        assert before.max() > 0.02
        assert after.max() < SUNK


def test_nothing_that_has_a_place_moves(subject: Subject) -> None:
    goals = _goals(subject, 3, 100)
    before, after = _both(subject, goals)
    placed = [subject.root, *_hands(subject), *_feet(subject)]
    assert np.abs(after.positions[:, placed] - before.positions[:, placed]).max() < EXACT
    feet = _feet(subject)
    assert quat.angle_between(after.turns[:, feet], before.turns[:, feet]).max(initial=0.0) < EXACT
    assert pose_measures.length_errors(subject, after.positions).max() < 1e-9


def test_what_is_above_the_ground_stays_as_it_is_to_the_bit(subject: Subject) -> None:
    plan = _plan(subject)
    lifting, goals = _lifting(subject, plan), _goals(subject, 4, 40)
    assert lifting is not None
    high = replace(goals, positions=goals.positions + np.array([0.0, 0.0, 10.0 * subject.scale]))
    still = goal_sets.goals_of(
        goals.bodies, np.repeat(plan.rest[goals.bodies][None], 2, axis=0), quat.identity(2, len(goals.bodies))
    )
    for own in (high, still):
        pose = posing.solve(plan, own)
        assert np.array_equal(ground_phase.lifted(lifting, pose).rotations, pose.rotations)


def test_a_pose_does_not_depend_on_other_frames(subject: Subject) -> None:
    goals, order = _goals(subject, 5, 60), np.random.default_rng(5).permutation(60)
    _, whole = _both(subject, goals)
    _, mixed = _both(subject, rows(goals, order))
    assert np.abs(mixed.rotations - whole.rotations[order]).max() < EXACT
    for frame in range(0, 60, 12):
        _, alone = _both(subject, rows(goals, slice(frame, frame + 1)))
        assert np.abs(alone.rotations - whole.rotations[frame]).max() < 1e-9


def test_small_steps_of_goals_are_small_steps_of_joints(subject: Subject) -> None:
    for seed in range(6):
        before, after = _both(subject, _way(subject, seed, 100))
        more = quat.angle_between(after.turns[1:], after.turns[:-1])
        more -= quat.angle_between(before.turns[1:], before.turns[:-1])
        assert more.max() < JUMP


@pytest.mark.parametrize("name", ["hound", "bird", "asura", "human"])
def test_mirrored_goals_make_the_mirrored_pose(name: str) -> None:
    subject = _subjects()[name]
    partner, goals = pose_measures.partners(subject), _goals(subject, 7, 60)
    assert partner is not None
    _, pose = _both(subject, goals)
    _, again = _both(subject, pose_measures.mirrored(goals, partner))
    turns = pose.turns[:, partner] * pose_measures.MIRROR_TURN
    assert quat.angle_between(again.turns, turns).max() < 1e-5


def test_who_flies_about_the_origin_has_no_ground() -> None:
    subject = _subjects()["bird"]
    plan, lower = _plan(subject), subject.bodies.positions - np.array([0.0, 0.0, subject.bodies.extents[2]])
    low = replace(plan, rest=lower)
    assert Lifting.of(Hierarchy(subject.character, lower, subject.root), low) is None


def test_actions_alone_are_kept_above_the_ground_and_only_if_that_is_wanted() -> None:
    """What lies beneath an action, as a gait does, knows the ground itself."""
    subject = _subjects()["snake"]
    tail = Channel("Tail", Context(Capability.TAIL), poses_position=False)
    binding = bind(GeneralizedAction("Down", (tail,)), subject.bodies)
    down = quat.from_rotation_vector(np.radians([[[-40.0, 0.0, 0.0]]]))
    values = Values(np.zeros((1, 1, 3)), down, np.ones((1, 1)))
    depths: list[float] = []
    for on in (False, True):
        part = play.prepare(subject.character, binding, SolverSettings(keeps_above_ground=on))
        depths.append(float(_depths(subject, play.evaluate(part, values, {}).pose).max()))
    assert depths[0] > 0.05
    assert depths[1] < SUNK
    over = play.prepare(
        subject.character, binding, SolverSettings(keeps_above_ground=True), lower=[(subject.root, True, True)]
    )
    assert over.lifting is None
