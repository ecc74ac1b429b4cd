"""Laws of a spine that bends as actions have it: turned by goals for turns, and pulled by hands, feet and mouths."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path

import numpy as np
import pytest

from morph_retarget.core import quat
from morph_retarget.core.arrays import Array, Flags, Indices
from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.solve import posing, spine_closing, spine_lines
from morph_retarget.core.solve.goals import Goals
from morph_retarget.core.solve.posing import BodyPose, Plan
from tests import goal_sets, pose_measures
from tests.goal_sets import HUMAN, SETTINGS, Subject, rows

STEPS, FINER = 240, 32
"""Steps of a way, and into how many the one is parted in which joints turn the most."""
WIDE, BETWEEN = 25.0, 60.0
"""Nothing turns further in a step [deg], nor where several pairs of hands pull a spine to and fro …"""
LEFT = 8.0
"""… and by no more than this where steps are 32 times smaller: a jump would stay as it is."""
CREATURES = ("biped", "hound", "beetle", "bird", "snake", "asura", "lopside")
SYMMETRIC = ("biped", "hound", "asura")
RIGS = ("mixamo_mpfb", "quaternius_wolf", "rigify_cat", "m2m_human")
_TURNED = (Capability.SPINE, Capability.NECK, Capability.HEAD)
_PLACED = (Capability.GRASPER, Capability.FOOT, Capability.MOUTH)


@dataclass(frozen=True, eq=False)
class Actor:
    """A character whose trunk is turned, whose hands swing, and whose mouth has a goal that comes and goes."""

    subject: Subject

    @cached_property
    def bodies(self) -> Indices:
        """The root, what is turned, and what is placed."""
        found = self.subject.bodies
        own = [b for capability in (*_TURNED, *_PLACED) for b in found.with_capability(capability)]
        return np.array(list(dict.fromkeys([self.subject.root, *own])), dtype=np.intp)

    def _are(self, capabilities: tuple[Capability, ...]) -> Flags:
        own = [{*self.subject.bodies.capabilities[b]} for b in self.bodies]
        return np.array([not found.isdisjoint(capabilities) for found in own], dtype=np.bool_)

    @cached_property
    def turned(self) -> Flags:
        """Which are turned, shape (body,)."""
        return self._are((*_TURNED, Capability.ROOT))

    @cached_property
    def placed(self) -> Flags:
        """Which are placed, shape (body,)."""
        return self._are(_PLACED) | (self.bodies == self.subject.root)

    @cached_property
    def mouths(self) -> Flags:
        """Which are mouths, shape (body,)."""
        return self._are((Capability.MOUTH,))

    @cached_property
    def plan(self) -> Plan:
        """How the pose step meets the goals."""
        subject = self.subject
        wanted = [(int(b), bool(p), bool(t)) for b, p, t in zip(self.bodies, self.placed, self.turned, strict=True)]
        return posing.prepare(subject.character, subject.bodies.positions, subject.root, wanted, SETTINGS)

    def goals(self, times: Array, seed: int = 0, influence: float | None = None) -> Goals:
        """Return goals at times from 0 to 1; mouths have some influence, or one that comes and goes."""
        rng, count = np.random.default_rng(seed), len(self.bodies)
        size = HUMAN * self.subject.scale

        def wave(most: float) -> Array:
            phases, speeds = rng.uniform(0.0, 2.0 * np.pi, (count, 3)), rng.uniform(0.5, 1.5, (count, 3))
            return most * np.sin(2.0 * np.pi * speeds * times[:, None, None] + phases)

        places = self.subject.bodies.positions[self.bodies] + wave(0.06 * size)
        vectors = wave(np.radians(15.0))
        # One way to lean for the whole trunk, and a little that is each one's own.
        vectors = 0.5 * vectors + 0.5 * vectors[:, [int(np.argmax(self.turned))]]
        comes = np.sin(np.pi * times) ** 2 if influence is None else np.full(len(times), influence)
        position = np.where(self.mouths, comes[:, None], 1.0) * self.placed
        turns = quat.from_rotation_vector(vectors)
        return Goals(self.bodies, places, turns, position, np.where(self.turned, np.ones_like(position), 0.0))

    def solved(self, goals: Goals) -> BodyPose:
        """Return the pose."""
        return posing.solve(self.plan, goals)


@cache
def _creatures() -> Mapping[str, Actor]:
    return {name: Actor(Subject(character)) for name, character in goal_sets.creatures().items()}


@pytest.fixture(params=CREATURES)
def actor(request: pytest.FixtureRequest) -> Actor:
    """Return each of the sample characters."""
    return _creatures()[request.param]


def _steps(actor: Actor, pose: BodyPose) -> Array:
    """Return how far each joint of the spine turns from frame to frame, at least as far on its parent [deg]."""
    joints = list(actor.plan.trunk.joints) if actor.plan.trunk is not None else []
    parents = actor.subject.bodies.parents[joints]
    turns, above = pose.turns[:, joints], pose.turns[:, parents]
    own = quat.multiply(quat.conjugate(above), turns)
    found = np.minimum(quat.angle_between(own[1:], own[:-1]), quat.angle_between(turns[1:], turns[:-1]))
    return np.degrees(found.max(axis=1, initial=0.0))


def _assert_smooth(actor: Actor, seed: int, what: str = "") -> None:
    times = np.linspace(0.0, 1.0, STEPS + 1)
    steps = _steps(actor, actor.solved(actor.goals(times, seed)))
    worst = int(steps.argmax())
    pulls = 0 if actor.plan.trunk is None else len(actor.plan.trunk.pulls)
    assert steps[worst] <= (WIDE if pulls < 3 else BETWEEN), what
    finer = np.linspace(times[worst], times[worst + 1], FINER + 1)
    assert _steps(actor, actor.solved(actor.goals(finer, seed))).max() <= LEFT, what


# --- smoothness ---


@pytest.mark.parametrize("seed", [0, 1])
def test_small_changes_of_goals_are_small_changes_of_the_spine(actor: Actor, seed: int) -> None:
    _assert_smooth(actor, seed)


def test_small_changes_of_goals_are_small_changes_of_the_spines_of_real_rigs(data: Path) -> None:
    for name, character in goal_sets.real(data, RIGS).items():
        for seed in (0, 1):
            _assert_smooth(Actor(Subject(character)), seed, name)


@pytest.mark.parametrize("name", ["biped", "hound", "snake"])
def test_a_head_whose_goal_goes_through_the_spine_does_not_jump(name: str) -> None:
    """Where a goal vanishes in the spine's base, or lies straight behind it, no direction is the right one."""
    subject = _creatures()[name].subject
    head = subject.bodies.with_capability(Capability.HEAD)[0]
    plan = subject.plan_for([subject.root, head])
    assert plan.trunk is not None
    base, rest = subject.bodies.positions[plan.trunk.joints[0]], subject.bodies.positions[head]
    way = rest - base
    aside = quat.unit(quat.cross(way, np.array([0.3, 1.0, 0.2])))
    for off in (0.0, 0.02):
        shares = np.linspace(0.9, -0.9, 4001)[:, None]
        places = np.broadcast_to(subject.bodies.positions[[subject.root, head]], (len(shares), 2, 3)).copy()
        places[:, 1] = base + shares * way + off * quat.length(way) * aside
        goals = goal_sets.goals_of(np.array([subject.root, head]), places, quat.identity(len(shares), 2))
        turns = posing.solve(plan, goals).turns[:, list(plan.trunk.joints)]
        assert np.degrees(pose_measures.step_turns(turns).max()) <= 2.0


def test_tangents_do_not_turn_back_where_the_last_piece_is_short() -> None:
    rng = np.random.default_rng(0)
    ways = np.array([0.0, 0.0, 1.0]) + 0.4 * rng.normal(size=(200, 3, 3))
    ways = quat.unit(ways) * np.array([1.0, 1.0, 0.02])[:, None]
    at = np.concatenate([np.zeros((200, 1, 3)), np.cumsum(ways, axis=1)], axis=1)
    found = spine_lines.tangents(at, ways[:, 0])
    assert quat.dot(found[:, -1], quat.unit(ways[:, -1])).min() > 0.5


# --- what nothing is wanted of ---


def test_a_goal_without_influence_does_not_matter(actor: Actor) -> None:
    times = np.linspace(0.0, 1.0, 9)
    goals = actor.goals(times, 3, influence=0.0)
    pose, places = actor.solved(goals), goals.positions.copy()
    places[:, actor.mouths] += 0.3 * actor.subject.scale
    again = actor.solved(Goals(goals.bodies, places, goals.turns, goals.position_influence, goals.rotation_influence))
    assert (again.rotations == pose.rotations).all()


def test_a_head_that_nothing_is_wanted_of_keeps_its_own_turn_and_its_neck_too() -> None:
    """Hands that pull at the spine do not bend a neck whose mouth has no goal."""
    actor = _creatures()["biped"]
    goals = actor.goals(np.linspace(0.0, 1.0, 21), 4, influence=0.0)
    pose = actor.solved(goals)
    for capability in (Capability.NECK, Capability.HEAD):
        for body in actor.subject.bodies.with_capability(capability):
            wanted = goals.turns[:, list(goals.bodies).index(body)]
            assert quat.angle_between(pose.turns[:, body], wanted).max() < 1e-6


# --- symmetries ---


def test_goals_at_rest_are_the_rest_pose(actor: Actor) -> None:
    goals = actor.goals(np.array([0.3]), 0)
    rest = actor.subject.bodies.positions
    still = Goals(
        goals.bodies,
        rest[None, goals.bodies],
        quat.identity(1, len(goals.bodies)),
        goals.position_influence,
        goals.rotation_influence,
    )
    pose = actor.solved(still)
    assert np.abs(pose.positions - rest).max() <= 1e-9 * HUMAN * actor.subject.scale
    assert quat.angle_between(pose.turns, quat.IDENTITY).max() <= 1e-7


@pytest.mark.parametrize("name", SYMMETRIC)
def test_mirrored_goals_make_the_mirrored_pose(name: str) -> None:
    actor = _creatures()[name]
    partner = pose_measures.partners(actor.subject)
    assert partner is not None
    goals = actor.goals(np.linspace(0.1, 0.9, 30), 5)
    place = {int(body): i for i, body in enumerate(goals.bodies)}
    order = [place[int(partner[body])] for body in goals.bodies]
    mirrored = Goals(
        goals.bodies,
        goals.positions[:, order] * pose_measures.MIRROR,
        goals.turns[:, order] * pose_measures.MIRROR_TURN,
        goals.position_influence[:, order],
        goals.rotation_influence[:, order],
    )
    pose, again = actor.solved(goals), actor.solved(mirrored)
    away = np.abs(again.positions - pose.positions[:, partner] * pose_measures.MIRROR).max()
    assert away <= 1e-6 * HUMAN * actor.subject.scale
    assert quat.angle_between(again.turns, pose.turns[:, partner] * pose_measures.MIRROR_TURN).max() <= 1e-5


def test_goals_moved_rigidly_move_the_pose_rigidly(actor: Actor) -> None:
    rng, goals = np.random.default_rng(6), actor.goals(np.linspace(0.1, 0.9, 30), 6)
    turn, shift = quat.normalize(rng.normal(size=(30, 1, 4))), rng.normal(size=(30, 1, 3))
    moved = Goals(
        goals.bodies,
        quat.rotate(turn, goals.positions) + shift,
        quat.multiply(turn, goals.turns),
        goals.position_influence,
        goals.rotation_influence,
    )
    joints = list(actor.plan.trunk.joints) if actor.plan.trunk is not None else []
    pose, again = actor.solved(goals), actor.solved(moved)
    assert quat.angle_between(again.turns[:, joints], quat.multiply(turn, pose.turns[:, joints])).max() <= 1e-5


def test_a_frame_is_the_same_whatever_others_are_solved_with_it(actor: Actor) -> None:
    goals = actor.goals(np.linspace(0.0, 1.0, 40), 7)
    pose = actor.solved(goals)
    for part in (slice(3, 4), slice(0, 11), slice(11, 40)):
        assert (actor.solved(rows(goals, part)).rotations == pose.rotations[part]).all()


# --- bones ---


def test_bones_span_the_distance_between_the_ends() -> None:
    rng = np.random.default_rng(8)
    lengths = np.array([[0.0, 0.3, 0.2, 0.4, 0.1], [0.2, 0.2, 0.2, 0.2, 0.2]])
    axis = quat.unit(rng.normal(size=(300, 2, 3)))
    # Bowed, and a little to all sides: what leads to one side alone is turned as a whole, and spans what it did.
    side = quat.unit(quat.cross(axis, rng.normal(size=(300, 2, 3))))[:, :, None]
    bow = np.cos(np.pi * np.linspace(0.1, 0.9, 5))[:, None] * rng.uniform(0.1, 1.0, (300, 2, 1, 1))
    shape = quat.unit(axis[:, :, None] + bow * side + 0.03 * rng.normal(size=(300, 2, 5, 3)))
    distance = lengths.sum(axis=-1) * rng.uniform(0.75, 1.0, (300, 2))
    found = spine_closing.close(shape, lengths, axis, distance)
    assert np.abs(quat.length(found) - 1.0).max() < 1e-12
    ends = quat.length((lengths[..., None] * found).sum(axis=2))
    assert np.abs(ends - distance).max() < 1e-8
