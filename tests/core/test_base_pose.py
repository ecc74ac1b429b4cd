"""Limbs that goals for turns pose, as those of a clip do: with goals for their ends they set out from there."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from pathlib import Path

import numpy as np
import pytest

from morph_retarget.core import quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.solve import posing
from morph_retarget.core.solve.goals import Goals
from morph_retarget.core.solve.plan import Plan
from morph_retarget.core.solve.posing import BodyPose
from morph_retarget.core.solve.settings import SolverSettings
from tests import goal_sets
from tests.goal_sets import Subject, random_sets, rows
from tests.morph_bodies import unlike_characters
from tests.skeletons import skeleton_of
from tools.creatures import CREATURES
from tools.figure import Build, humanoid

FRAMES = 24
STEPS = 240
EXACT = 1e-9
"""Share of a character's size that is left to rounding."""
MET = 1e-6
"""Goals in reach are met to this share of the character's size."""
JUMP = np.radians(12.0)
"""Most that a joint turns while the influence grows by a 240th: a limb that folds up turns fast on its way."""


@dataclass(frozen=True, eq=False)
class Posed:
    """A character whose limbs are all posed by goals for turns, and goals that their ends could be at as well."""

    subject: Subject
    seed: int

    @cached_property
    def _sets(self) -> tuple[goal_sets.Sets, goal_sets.Sets]:
        """A pose, and the same with the joints of limbs in other poses."""
        rng = np.random.default_rng(self.seed)
        first, second = (random_sets(self.subject, rng, FRAMES) for _ in range(2))
        own, plan = first.own.copy(), self.plan()
        for end in self.ends:
            joints = list(plan.joints_of(end))
            own[:, joints] = second.own[:, joints]
        return first, replace(second, own=own, shift=first.shift)

    @cached_property
    def base(self) -> tuple[Array, Array]:
        """Places [m] and turns of all bodies as they are posed, shapes (frame, body, 3) and (frame, body, 4)."""
        return self._sets[0].pose

    @cached_property
    def ends(self) -> list[int]:
        """The bodies that get goals: ends of limbs whose bones hang on each other, and that the root carries."""
        carried = self.subject.of_root
        return [limb.limb.end for limb in self.subject.limbs if limb.limb.end in carried]

    @cached_property
    def wanted(self) -> list[tuple[int, bool, bool]]:
        """Goals for the turns of all bodies that the root carries, its place, and the places of the ends."""
        root = self.subject.root
        return [(body, body == root or body in self.ends, True) for body in self.subject.of_root.tolist()]

    def plan(self, settings: SolverSettings | None = None) -> Plan:
        """Return how the goals are met."""
        return _plan(self.subject, tuple(self.wanted), settings or SolverSettings())

    def goals(self, influence: Array, turning: float = 1.0) -> Goals:
        """Return goals of which those for the ends count in part, shape (frame,)."""
        bodies = self.subject.of_root
        places, turns = self.base
        out = goal_sets.goals_of(bodies, places[:, bodies].copy(), turns[:, bodies])
        ends = [bodies.tolist().index(end) for end in self.ends]
        out.positions[:, ends] = self._sets[1].pose[0][:, self.ends]
        share = np.zeros(out.positions.shape[:2])
        share[:, bodies.tolist().index(self.subject.root)] = 1.0
        share[:, ends] = influence[:, None]
        return replace(out, position_influence=share, rotation_influence=np.full_like(share, turning))

    @property
    def size(self) -> float:
        """Of the character [m]."""
        return self.subject.bodies.size


@lru_cache(maxsize=64)
def _plan(subject: Subject, wanted: tuple[tuple[int, bool, bool], ...], settings: SolverSettings) -> Plan:
    return posing.prepare(subject.character, subject.bodies.positions, subject.root, wanted, settings)


def _figure(build: Build) -> Subject:
    return Subject(analyze(skeleton_of(humanoid(build=build), np.random.default_rng(0))))


FIGURES = {
    "an adult": Build(fingers=2),
    "hanging arms and twist bones": Build(fingers=1, twists=2, arms_down=75.0),
}


def _own_subjects() -> Iterator[tuple[str, Subject]]:
    yield from ((name, _figure(build)) for name, build in FIGURES.items())
    for name, make in CREATURES.items():
        subject = Subject(analyze(skeleton_of(make(), np.random.default_rng(0))))
        if subject.limbs:
            yield name, subject


OWN = dict(_own_subjects())
own = pytest.mark.parametrize("subject", OWN.values(), ids=OWN)


def _assert_as_posed(posed: Posed, pose: BodyPose) -> None:
    places, turns = posed.base
    bodies = posed.subject.of_root
    assert np.abs(pose.positions[:, bodies] - places[:, bodies]).max() < EXACT * posed.size
    assert quat.angle_between(pose.turns[:, bodies], turns[:, bodies]).max() < 1e-7


def _assert_met(posed: Posed, pose: BodyPose, goals: Goals) -> None:
    at = [goals.bodies.tolist().index(end) for end in posed.ends]
    missed = quat.length(pose.positions[:, posed.ends] - goals.positions[:, at])
    assert missed.max() < MET * posed.size


def _assert_laws(posed: Posed) -> None:
    plan = posed.plan()
    _assert_as_posed(posed, posing.solve(plan, posed.goals(np.zeros(FRAMES))))
    goals = posed.goals(np.ones(FRAMES))
    _assert_met(posed, posing.solve(plan, goals), goals)


@own
def test_without_influence_limbs_stay_as_they_were_posed_and_with_all_of_it_they_meet_their_goals(
    subject: Subject,
) -> None:
    _assert_laws(Posed(subject, 1))


def test_without_influence_limbs_of_real_rigs_stay_as_they_were_posed_and_with_all_of_it_they_meet_their_goals(
    data: Path,
) -> None:
    for character in unlike_characters(data).values():
        posed = Posed(Subject(character), 2)
        if posed.ends:
            _assert_laws(posed)


@own
def test_limbs_go_over_to_their_goals_smoothly(subject: Subject) -> None:
    posed = Posed(subject, 3)
    plan, goals = posed.plan(), posed.goals(np.ones(FRAMES))
    ends = [goals.bodies.tolist().index(end) for end in posed.ends]
    for frame in range(6):
        own = rows(goals, np.full(STEPS + 1, frame))
        own.position_influence[:, ends] = np.linspace(0.0, 1.0, STEPS + 1)[:, None]
        turns = posing.solve(plan, own).turns
        assert quat.angle_between(turns[1:], turns[:-1]).max() < JUMP


@own
def test_limbs_that_are_at_their_goals_stay_as_they_were_posed(subject: Subject) -> None:
    posed = Posed(subject, 4)
    goals = posed.goals(np.linspace(0.0, 1.0, FRAMES))
    at = [goals.bodies.tolist().index(end) for end in posed.ends]
    goals.positions[:, at] = posed.base[0][:, posed.ends]
    pose = posing.solve(posed.plan(), goals)
    assert np.abs(pose.positions - posing.solve(posed.plan(), posed.goals(np.zeros(FRAMES))).positions).max() < (
        1e-6 * posed.size
    )


@own
def test_any_frame_alone_is_posed_as_among_others(subject: Subject) -> None:
    posed = Posed(subject, 5)
    plan, goals = posed.plan(), posed.goals(np.linspace(0.0, 1.0, FRAMES), 0.7)
    whole = posing.solve(plan, goals)
    for frame in (0, 7, FRAMES - 1):
        alone = posing.solve(plan, rows(goals, np.array([frame])))
        assert np.abs(alone.positions[0] - whole.positions[frame]).max() < EXACT * posed.size


@own
def test_turns_that_do_not_count_leave_limbs_to_come_from_rest(subject: Subject) -> None:
    posed = Posed(subject, 6)
    goals = posed.goals(np.full(FRAMES, 0.6), 0.0)
    places = [(body, position, False) for body, position, _ in posed.wanted if position]
    bodies = subject.bodies
    plain = posing.prepare(subject.character, bodies.positions, subject.root, places)
    at = [goals.bodies.tolist().index(body) for body, _, _ in places]
    alone = Goals(
        goals.bodies[at],
        goals.positions[:, at],
        goals.turns[:, at],
        goals.position_influence[:, at],
        goals.rotation_influence[:, at],
    )
    ours, theirs = posing.solve(posed.plan(), goals).positions, posing.solve(plain, alone).positions
    assert np.abs(ours[:, posed.ends] - theirs[:, posed.ends]).max() < EXACT * posed.size


def test_twist_bones_go_along_with_limbs_that_were_posed() -> None:
    subject = OWN["hanging arms and twist bones"]
    posed = Posed(subject, 7)
    places = posing.solve(posed.plan(), posed.goals(np.linspace(0.0, 1.0, FRAMES))).positions
    parents, rest = subject.tree.parents, subject.bodies.positions
    child = [b for b in subject.of_root.tolist() if b != subject.root]
    lengths = quat.length(places[:, child] - places[:, parents[child]])
    assert np.abs(lengths - quat.length(rest[child] - rest[parents[child]])).max() < EXACT * posed.size


@pytest.mark.parametrize("name", ["an adult", "spider"])
def test_limbs_that_were_posed_stretch_to_goals_out_of_reach(name: str) -> None:
    subject = OWN[name]
    posed = Posed(subject, 8)
    goals = posed.goals(np.ones(FRAMES))
    at = {end: goals.bodies.tolist().index(end) for end in posed.ends}
    firsts = [limb.first for limb in subject.limbs]
    starts = posed.base[0][:, firsts]
    lengths = [
        quat.length(
            np.diff(
                subject.bodies.positions[[m.first, *subject.tree.path_between(m.first, m.limb.end), m.limb.end]], axis=0
            )
        ).sum()
        for m in subject.limbs
    ]
    ways = quat.unit(goals.positions[:, list(at.values())] - starts)
    goals.positions[:, list(at.values())] = starts + 1.1 * np.array(lengths)[:, None] * ways
    settings = SolverSettings(allows_stretch=True)
    pose = posing.solve(posed.plan(settings), goals)
    missed = quat.length(pose.positions[:, posed.ends] - goals.positions[:, list(at.values())])
    assert missed.max() < 2e-3 * posed.size
    still = posing.solve(
        posed.plan(settings), replace(goals, position_influence=posed.goals(np.zeros(FRAMES)).position_influence)
    )
    _assert_as_posed(posed, still)
