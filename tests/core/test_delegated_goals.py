"""Goals that several bodies give to the one that carries them, as two mouths on a head do (Hecker 2008 §4.3.1)."""

from collections.abc import Sequence

import numpy as np
import pytest

from morph_retarget.core import quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.character.character import Character
from morph_retarget.core.morph.bodies import Bodies
from morph_retarget.core.solve import posing
from morph_retarget.core.solve.goals import Goals
from morph_retarget.core.solve.plan import Plan
from morph_retarget.core.solve.settings import SolverSettings
from tests.skeletons import skeleton_of
from tools.figure import Bone, Build, humanoid

MOUTHS = ("mouth.L", "mouth.R")
FRAMES = 120
MET = 0.001
"""[m]"""


def _figure(mouths: Sequence[str] = MOUTHS, wide: float = 0.04) -> Character:
    """Return a humanoid whose head has mouths, those called L on the left."""
    bones = [*humanoid(1.75, build=Build(spine=3, neck=1))]
    for name in mouths:
        side = wide if name.endswith("L") else -wide
        bones.append(Bone(name, "head", (side, -0.1, 1.62), (side, -0.15, 1.62)))
    return analyze(skeleton_of(bones))


def _plan(character: Character, bends: bool, turns: bool = False, mouths: Sequence[str] = MOUTHS) -> Plan:
    index = character.skeleton.index
    wanted = [(index["hips"], True, True), *((index[name], True, turns) for name in mouths)]
    return posing.prepare(
        character, Bodies.of(character).positions, index["hips"], wanted, SolverSettings(bends_spine=bends)
    )


def _goals(plan: Plan, ends: Sequence[int], ways: Array, shares: Sequence[float], turns: Array | None = None) -> Goals:
    """Return goals that move each of some bodies by ways, shape (frame, body, 3), and turn it if it shall be turned."""
    frames, bodies = len(ways), np.array([plan.root, *ends])
    positions = np.broadcast_to(plan.rest[bodies], (frames, len(bodies), 3)).copy()
    positions[:, 1:] += ways
    own = np.broadcast_to(quat.IDENTITY, (frames, len(bodies), 4)).copy()
    influence = np.broadcast_to(np.array([1.0, *shares]), (frames, len(bodies)))
    turned = np.zeros((frames, len(bodies)))
    turned[:, 0] = 1.0
    if turns is not None:
        own[:, 1:], turned[:, 1:] = turns, shares
    return Goals(bodies, positions, own, influence, turned)


def _nods(frames: int = FRAMES) -> Array:
    """Return ways on which heads nod to all sides, within reach, shape (frame, 3)."""
    t = np.linspace(0.0, 2.0 * np.pi, frames)
    return np.stack([0.05 * np.sin(2.0 * t), 0.04 * np.cos(t) - 0.06, 0.02 * np.sin(t) - 0.05], axis=-1)


def _errors(plan: Plan, goals: Goals) -> Array:
    """Return how far bodies are from their goals, shape (frame, body, 3), without the root's."""
    pose = posing.solve(plan, goals)
    return pose.positions[:, goals.bodies[1:]] - goals.positions[:, 1:]


@pytest.mark.parametrize("bends", [True, False])
@pytest.mark.parametrize("shares", [(1.0, 1.0), (1.0, 0.3), (1.0, 0.0), (0.2, 1.0)])
def test_the_middle_of_mouths_comes_to_that_of_their_goals_weighed_as_these_count(
    bends: bool, shares: tuple[float, float]
) -> None:
    character = _figure()
    plan = _plan(character, bends)
    ends = [character.skeleton.index[name] for name in MOUTHS]
    goals = _goals(plan, ends, np.repeat(_nods()[:, None], 2, axis=1), shares)
    errors, weights = _errors(plan, goals), np.array(shares)
    middle = (weights[:, None] * errors).sum(axis=1) / weights.sum()
    assert plan.unreachable == ()
    assert np.linalg.norm(middle, axis=-1).max() < MET


@pytest.mark.parametrize("bends", [True, False])
def test_mouths_that_count_half_bring_the_head_half_the_way(bends: bool) -> None:
    character = _figure()
    plan = _plan(character, bends)
    ends = [character.skeleton.index[name] for name in MOUTHS]
    ways = np.repeat(_nods()[:, None], 2, axis=1)
    whole, half, none = (
        posing.solve(plan, _goals(plan, ends, ways, (share, share))).positions[:, ends].mean(axis=1)
        for share in (1.0, 0.5, 0.0)
    )
    assert np.abs(none - plan.rest[ends].mean(axis=0)).max() < 1e-9
    share = np.linalg.norm(half - none, axis=-1) / np.linalg.norm(whole - none, axis=-1)
    assert share.min() > 0.3
    assert share.max() < 0.7


@pytest.mark.parametrize("bends", [True, False])
def test_one_mouth_alone_is_brought_there_as_ever(bends: bool) -> None:
    both, single = _figure(), _figure(MOUTHS[:1])
    poses = []
    for character in (both, single):
        plan = _plan(character, bends, mouths=MOUTHS[:1])
        goals = _goals(plan, [character.skeleton.index[MOUTHS[0]]], _nods()[:, None], (1.0,))
        places = posing.solve(plan, goals).positions
        poses.append(places[:, [character.skeleton.index[name] for name in single.skeleton.names]])
    assert np.abs(poses[0] - poses[1]).max() < 1e-12


@pytest.mark.parametrize("bends", [True, False])
def test_it_does_not_matter_which_mouth_comes_first(bends: bool) -> None:
    poses = []
    ways = np.stack([_nods(), 0.7 * _nods()], axis=1)
    for order in ((0, 1), (1, 0)):
        names = [MOUTHS[i] for i in order]
        character = _figure(names)
        plan = _plan(character, bends, mouths=names)
        goals = _goals(
            plan, [character.skeleton.index[n] for n in names], ways[:, order], [(1.0, 0.6)[i] for i in order]
        )
        places = posing.solve(plan, goals).positions
        poses.append(places[:, [character.skeleton.index[name] for name in sorted(character.skeleton.names)]])
    assert np.abs(poses[0] - poses[1]).max() < 1e-9


@pytest.mark.parametrize("bends", [True, False])
def test_the_head_follows_without_jumps_while_one_mouth_takes_over_from_the_other(bends: bool) -> None:
    character = _figure()
    plan = _plan(character, bends)
    ends = [character.skeleton.index[name] for name in MOUTHS]
    ways = np.broadcast_to(np.array([[0.05, -0.06, -0.05], [-0.05, -0.04, -0.06]]), (FRAMES, 2, 3))
    goals = _goals(plan, ends, ways, (1.0, 1.0))
    part = np.linspace(0.0, 1.0, FRAMES)
    shares = np.stack([np.ones(FRAMES), 1.0 - part, part], axis=-1)
    moved = posing.solve(plan, Goals(goals.bodies, goals.positions, goals.turns, shares, goals.rotation_influence))
    steps = quat.angle_between(moved.turns[1:], moved.turns[:-1])
    assert steps.max() < np.radians(2.0)
    assert quat.angle_between(moved.turns[0], moved.turns[-1]).max() > np.radians(5.0)


def test_a_head_turns_between_what_its_mouths_are_turned_to() -> None:
    character = _figure()
    plan = _plan(character, bends=True, turns=True)
    ends, head = [character.skeleton.index[name] for name in MOUTHS], character.skeleton.index["head"]
    turns = np.zeros((3, 2, 4))
    turns[:, 0] = quat.from_rotation_vector(np.array([0.0, 0.0, 0.6]))
    turns[:, 1] = quat.from_rotation_vector(np.array([0.0, 0.0, 0.2]))
    still = np.zeros((3, 2, 3))
    for shares, angle in (((1.0, 1.0), 0.4), ((1.0, 0.0), 0.6), ((0.0, 1.0), 0.2)):
        pose = posing.solve(plan, _goals(plan, ends, still, shares, turns))
        expected = quat.from_rotation_vector(np.array([0.0, 0.0, angle]))
        assert quat.angle_between(pose.turns[:, head], expected).max() < 1e-6
    pose = posing.solve(plan, _goals(plan, ends, still, (1.0, 1.0), turns))
    assert quat.angle_between(pose.turns[:, ends], turns).max() < 1e-6, "each mouth has its own"


def test_a_head_that_has_a_goal_of_its_own_takes_none_of_its_mouths() -> None:
    character = _figure()
    index = character.skeleton.index
    wanted = [(index["hips"], True, True), (index["head"], True, True), *((index[m], True, False) for m in MOUTHS)]
    for bends in (True, False):
        plan = posing.prepare(
            character, Bodies.of(character).positions, index["hips"], wanted, SolverSettings(bends_spine=bends)
        )
        assert sorted(plan.unreachable) == sorted(index[m] for m in MOUTHS)


def test_both_mouths_are_known_to_be_moved_by_the_same_joints() -> None:
    character = _figure()
    for bends in (True, False):
        plan = _plan(character, bends)
        left, right = (plan.joints_of(character.skeleton.index[name]) for name in MOUTHS)
        assert left == right
        assert character.skeleton.index["head"] in left
