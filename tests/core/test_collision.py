"""Self-collision: limbs swivel out of the trunk, the head and each other; ends and lengths stay as they are."""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache, lru_cache

import numpy as np
import pytest

from morph_retarget.core import quat, rotation
from morph_retarget.core.arrays import Array
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.solve import capsules, collision, posing
from morph_retarget.core.solve.capsules import Capsules
from morph_retarget.core.solve.goals import Goals
from morph_retarget.core.solve.limits import JointLimits, swing_and_twist
from morph_retarget.core.solve.plan import Plan
from morph_retarget.core.solve.posing import BodyPose
from morph_retarget.core.solve.settings import SolverSettings
from tests import goal_sets, pose_measures
from tests.goal_sets import Subject, rows
from tests.limited import limbed
from tests.skeletons import skeleton_of
from tools.figure import CHIBI, Build, humanoid

LESS = 0.9
"""Share of the frames with collisions in which these become less."""
LEFT = 0.7
"""Of the depth of all collisions, what may be left …"""
LEFT_OF_HUMANS = 0.45
"""… and what may be on bodies of human shape."""
HIT = 1e-3
"""What collides by less than this does not count, on a body of human size [m]."""
JUMP = 20.0
"""No joint turns further than without, while goals move by 1 % of a way [deg]."""
EXACT = 1e-9
CREATURES = ("biped", "hound", "beetle", "bird", "asura", "lopside")
HUMANS: Mapping[str, Build] = {"human": Build(arms_down=60.0), "t-pose": Build(twists=2, fingers=2)}


@cache
def _subjects() -> Mapping[str, Subject]:
    """Return the sample characters that have limbs, and humans."""
    found = {name: Subject(c) for name, c in goal_sets.creatures().items() if name in CREATURES}
    rng = np.random.default_rng(5)
    for name, build in HUMANS.items():
        found[name] = Subject(analyze(skeleton_of(humanoid(build=build), rng)))
    return found


@pytest.fixture(params=(*CREATURES[1:], *HUMANS))
def subject(request: pytest.FixtureRequest) -> Subject:
    """Return each of them but the biped, who is a human too."""
    return _subjects()[request.param]


@lru_cache(maxsize=64)
def _plan(subject: Subject, settings: SolverSettings | None = None, limits: JointLimits | None = None) -> Plan:
    """Return how goals for places and turns are met, without collisions unless told otherwise."""
    settings = settings or SolverSettings(avoids_collisions=True)
    wanted = [(int(body), True, True) for body in subject.goals]
    return posing.prepare(subject.character, subject.bodies.positions, subject.root, wanted, settings, limits)


def _plain(subject: Subject) -> Plan:
    return _plan(subject, SolverSettings())


def _goals(subject: Subject, seed: int, count: int = 200) -> Goals:
    return goal_sets.random_sets(subject, np.random.default_rng(seed), count).goals


def _depths(subject: Subject, plan: Plan, pose: BodyPose) -> Array:
    """Return how deep points of limbs lie in what they keep out of, on a body of human size [m], (frame, any)."""
    places, turns = pose.positions, quat.to_matrix(pose.turns)
    out = [np.zeros((len(places), 0))]
    for wave in plan.waves:
        own = wave.obstacles
        if own is None:
            continue
        limbs, most = own.segments.shape[:2]
        starts = np.zeros((len(places), limbs * most, 3))
        along = np.zeros_like(starts)
        for joint, limb, i in wave.joints:
            starts[:, limb * most + i] = places[:, joint]
            along[:, limb * most + i] = rotation.apply(turns[:, joint], own.segments[limb, i])
        ends = [
            places[:, own.around.bodies] + rotation.apply(turns[:, own.around.bodies], p - plan.rest[own.around.bodies])
            for p in (own.around.starts, own.around.ends)
        ]
        axes = [
            np.concatenate(pair, axis=1)[:, own.others] for pair in zip(ends, (starts, starts + along), strict=True)
        ]
        for i in range(collision.BEADS):
            bead = (starts + (i + 1) / collision.BEADS * along)[:, own.bones]
            out.append(np.maximum(own.clear[:, i] - capsules.distances(bead, bead, *axes), 0.0))
    return np.concatenate(out, axis=1) / subject.scale


def _inside(subject: Subject, goals: Goals) -> Array:
    """Return in which frames anything would collide, shape (frame,)."""
    return _depths(subject, _plan(subject), posing.solve(_plain(subject), goals)).max(axis=1)


# --- capsules ---


def test_distances_of_line_segments_are_those_of_their_nearest_points() -> None:
    rng = np.random.default_rng(1)
    a, b, c, d = rng.normal(size=(4, 500, 3))
    b[:50], d[50:100] = a[:50], c[50:100]  # points
    d[100:150] = c[100:150] + (b - a)[100:150] * rng.uniform(-2.0, 2.0, (50, 1))  # parallel ones
    found = capsules.distances(a, b, c, d)
    shares = np.linspace(0.0, 1.0, 201)[:, None]
    one = a[:, None] + shares * (b - a)[:, None]
    near = [quat.length(one - (c + s * (d - c))[:, None]).min(axis=1) for s in shares[:, 0]]
    assert (found <= np.min(near, axis=0) + 1e-9).all()
    assert (found >= np.min(near, axis=0) - 0.02).all()
    assert np.allclose(capsules.distances(c, d, b, a), found)


def test_capsules_grow_with_the_character() -> None:
    small, large = (Subject(analyze(skeleton_of(humanoid(height)))) for height in (0.5, 4.0))
    found = [Capsules.of(s.character, s.bodies.positions) for s in (small, large)]
    assert np.allclose(8.0 * found[0].radii, found[1].radii, rtol=1e-6)


def test_a_human_is_as_thick_as_humans_are() -> None:
    human = _subjects()["human"]
    found = Capsules.of(human.character, human.bodies.positions)
    for joint, least, most in (
        ("spine", 0.09, 0.15),
        ("neck", 0.04, 0.08),
        ("head", 0.07, 0.12),
        ("leftUpperArm", 0.035, 0.06),
        ("rightLowerArm", 0.025, 0.05),
        ("leftUpperLeg", 0.06, 0.1),
        ("rightLowerLeg", 0.04, 0.07),
    ):
        assert least < found.radius_of[human.character.bone(joint) or 0] < most, joint


def test_radii_that_are_known_are_taken() -> None:
    human = _subjects()["human"]
    found = Capsules.of(human.character, human.bodies.positions, {"leftUpperArm": 0.2})
    assert found.radius_of[human.character.bone("leftUpperArm") or 0] == 0.2
    wide = SolverSettings(avoids_collisions=True, radii={"leftUpperArm": 0.2})
    rest = goal_sets.at_rest(human)
    assert np.array_equal(
        posing.solve(_plan(human, wide), rest).rotations, posing.solve(_plain(human), rest).rotations
    ), "however thick, rest is free"


# --- what stays as it is ---


def test_without_it_there_is_nothing_to_be_done(subject: Subject) -> None:
    assert all(wave.obstacles is None for wave in _plain(subject).waves)
    assert any(wave.obstacles is not None for wave in _plan(subject).waves)


def test_rest_is_free_of_collisions(subject: Subject) -> None:
    """However thick limbs are: it stays as it is to the bit."""
    rest = goal_sets.at_rest(subject, 2)
    pose = posing.solve(_plain(subject), rest)
    for margin in (0.0, 0.05, 5.0):
        plan = _plan(subject, SolverSettings(avoids_collisions=True, margin=margin))
        assert _depths(subject, plan, pose).max() == 0.0
        assert np.array_equal(posing.solve(plan, rest).rotations, pose.rotations)


@pytest.mark.parametrize("arms_down", [0.0, 45.0, 80.0, 90.0])
def test_rest_is_free_wherever_arms_hang(arms_down: float) -> None:
    for proportions in (None, CHIBI):
        bones = humanoid(proportions=proportions, build=Build(arms_down=arms_down))
        human = Subject(analyze(skeleton_of(bones)))
        rest = goal_sets.at_rest(human)
        pose = posing.solve(_plain(human), rest)
        assert np.array_equal(posing.solve(_plan(human), rest).rotations, pose.rotations)


def test_poses_that_are_free_of_collisions_stay_as_they_are(subject: Subject) -> None:
    """To the bit."""
    goals = _goals(subject, 2, 300)
    free = _inside(subject, goals) == 0.0
    assert free.any()
    assert not free.all()
    poses = [posing.solve(plan, goals) for plan in (_plain(subject), _plan(subject))]
    assert np.array_equal(poses[0].rotations[free], poses[1].rotations[free])
    assert not np.array_equal(poses[0].rotations[~free], poses[1].rotations[~free])


def test_ends_stay_at_their_goals_and_bones_keep_their_lengths(subject: Subject) -> None:
    """Where a goal lies inside the body as well."""
    sets = goal_sets.random_sets(subject, np.random.default_rng(3), 200)
    for goals in (sets.goals, goal_sets.beyond(sets, 0.3)):
        free, pose = (posing.solve(plan, goals) for plan in (_plain(subject), _plan(subject)))
        ends = np.array([limb.body for wave in _plan(subject).waves for limb in wave.limbs], dtype=np.intp)
        assert not np.array_equal(free.rotations, pose.rotations)
        assert np.abs(free.positions[:, ends] - pose.positions[:, ends]).max() < EXACT
        assert pose_measures.length_errors(subject, pose.positions).max() < EXACT


# --- what becomes of collisions ---


@pytest.mark.parametrize("bends_spine", [False, True])
def test_collisions_become_less(subject: Subject, bends_spine: bool) -> None:
    goals = _goals(subject, 4, 200)
    plain, plan = (_plan(subject, SolverSettings(bends_spine, avoids_collisions=on)) for on in (False, True))
    before, after = (_depths(subject, plan, posing.solve(p, goals)) for p in (plain, plan))
    hit = before.max(axis=1) > HIT
    assert hit.sum() > 20
    before, after = before[hit].sum(axis=1), after[hit].sum(axis=1)
    assert (after < before).mean() >= LESS
    assert after.sum() <= (LEFT_OF_HUMANS if subject.character.humanoid else LEFT) * before.sum()


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_an_elbow_that_would_be_in_the_trunk_comes_out_of_it(side: float) -> None:
    """The hand is in front of the other side of the belly."""
    human, name = _subjects()["human"], "left" if side > 0.0 else "right"
    bone = {part: human.character.bone(name + part) or 0 for part in ("UpperArm", "LowerArm", "Hand")}
    wanted = [(bone["Hand"], True, False)]
    heights = np.linspace(1.05, 1.35, 9)
    places = np.stack([np.full(9, -0.1 * side), np.full(9, -0.22), heights], axis=-1)[:, None]
    goals = goal_sets.goals_of(np.array([bone["Hand"]]), places, quat.identity(9, 1))
    rest = human.bodies.positions
    plain, plan = (
        posing.prepare(human.character, rest, human.root, wanted, SolverSettings(avoids_collisions=on))
        for on in (False, True)
    )
    before, after = (_depths(human, plan, posing.solve(p, goals)).max(axis=1) for p in (plain, plan))
    assert before.min() > 0.1
    assert after.max() < 0.03
    assert np.median(after) < 0.01


def test_limbs_swivel_no_further_than_they_may(subject: Subject) -> None:
    goals = _goals(subject, 5)
    free = posing.solve(_plain(subject), goals)
    for most in (0.0, 20.0):
        pose = posing.solve(_plan(subject, SolverSettings(avoids_collisions=True, most_swivel=most)), goals)
        turned = quat.angle_between(pose.turns, free.turns).max()
        assert turned <= np.radians(most) + 1e-6
        assert (turned > 0.0) == (most > 0.0)


def test_limits_of_joints_are_kept_all_the_same() -> None:
    """What they allow counts more than what is in the way."""
    body = limbed(_subjects()["biped"])
    goals = body.goals(goal_sets.random_sets(body.subject, np.random.default_rng(6), 200))
    wanted = [(int(b), True, int(b) == body.subject.root) for b in goals.bodies]
    settings = SolverSettings(avoids_collisions=True)
    rest = body.subject.bodies.positions
    plan = posing.prepare(body.subject.character, rest, body.subject.root, wanted, settings, body.limits)
    told = swing_and_twist(body.own(posing.solve(plan, goals).turns))
    assert np.abs(body.limits.nearest(told) - told).max() < 1e-6


# --- what the pose depends on ---


def test_a_pose_does_not_depend_on_other_frames(subject: Subject) -> None:
    goals, plan, rng = _goals(subject, 7, 90), _plan(subject), np.random.default_rng(7)
    pose = posing.solve(plan, goals)
    for order in (np.arange(90)[::-1], rng.permutation(90)):
        assert np.array_equal(posing.solve(plan, rows(goals, order)).rotations, pose.rotations[order])
    for frame in range(0, 90, 9):
        one = slice(frame, frame + 1)
        assert quat.angle_between(posing.solve(plan, rows(goals, one)).turns, pose.turns[one]).max() < 1e-6


def test_small_steps_of_goals_are_small_steps_of_joints(subject: Subject) -> None:
    sets, plain, plan = goal_sets.random_sets(subject, np.random.default_rng(8), 21), _plain(subject), _plan(subject)
    goals = sets.ways(range(8), range(1, 9), 100).goals
    free, pose = (posing.solve(p, goals).turns.reshape(8, 101, -1, 4) for p in (plain, plan))
    more = quat.angle_between(pose[:, 1:], pose[:, :-1]) - quat.angle_between(free[:, 1:], free[:, :-1])
    assert np.degrees(more.max()) <= JUMP


@pytest.mark.parametrize("name", ["biped", "hound", "beetle", "bird", "asura", "human"])
def test_mirrored_goals_make_the_mirrored_pose(name: str) -> None:
    subject = _subjects()[name]
    partner, goals, plan = pose_measures.partners(subject), _goals(subject, 9, 100), _plan(subject)
    assert partner is not None
    pose, again = posing.solve(plan, goals), posing.solve(plan, pose_measures.mirrored(goals, partner))
    turns = pose.turns[:, partner] * pose_measures.MIRROR_TURN
    assert quat.angle_between(again.turns, turns).max() < 1e-5


def test_size_does_not_matter() -> None:
    small, large = (Subject(analyze(skeleton_of(humanoid(height)))) for height in (0.5, 4.0))
    goals = _goals(small, 10, 60)
    scaled = replace(goals, positions=8.0 * goals.positions)
    poses = posing.solve(_plan(small), goals), posing.solve(_plan(large), scaled)
    assert quat.angle_between(poses[0].turns, poses[1].turns).max() < 1e-5


def test_absurd_goals_make_poses_without_nan(subject: Subject) -> None:
    rng = np.random.default_rng(11)
    sets = goal_sets.random_sets(subject, rng, 20)
    absurd = (
        goal_sets.beyond(sets, 0.0),
        goal_sets.beyond(sets, 1e6),
        goal_sets.coincident(sets),
        goal_sets.at_the_joint(subject),
        goal_sets.at_infinity(subject, rng, 10),
    )
    for goals in absurd:
        pose = posing.solve(_plan(subject), goals)
        assert np.isfinite(pose.positions).all()
        assert np.abs(quat.length(pose.turns) - 1.0).max() < EXACT
