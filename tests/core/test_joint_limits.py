"""Joint limits: what Blender's inverse kinematics would allow is kept, and goals within it are met."""

from collections.abc import Mapping
from functools import cache

import numpy as np
import pytest

from morph_retarget.core import play, quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.character.frame import Placement
from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.morph.bind import GeneralizedAction, bind
from morph_retarget.core.morph.bodies import Bodies
from morph_retarget.core.morph.channels import Channel, Values
from morph_retarget.core.morph.context import Context
from morph_retarget.core.morph.movement import Movement, ScaleMode
from morph_retarget.core.solve import limits as limiting
from morph_retarget.core.solve import posing
from morph_retarget.core.solve.goals import Goals
from morph_retarget.core.solve.limits import JointLimits
from morph_retarget.core.solve.settings import SolverSettings
from tests import goal_sets, pose_measures
from tests.goal_sets import Subject, rows
from tests.limited import Limbed, limbed
from tests.pose_measures import MEET
from tests.skeletons import skeleton_of
from tools.figure import Build, humanoid, moved

SHARE = 0.99
"""Of goals within the limits that are met."""
JUMP = 20.0
"""Nothing turns further while goals move by 1 % of a way [deg]."""
WITHIN = 1e-6
CREATURES = ("biped", "hound", "beetle", "bird", "asura", "lopside")
UNLIKE = ("hound", "beetle", "asura", "lopside")
"""Those of them whose limbs differ in kind: the others have fewer of the same."""


@cache
def _creatures() -> Mapping[str, Limbed]:
    return {name: limbed(Subject(c)) for name, c in goal_sets.creatures().items() if name in CREATURES}


@pytest.fixture(params=UNLIKE)
def body(request: pytest.FixtureRequest) -> Limbed:
    """Return sample characters that have limbs, with limits."""
    return _creatures()[request.param]


def _limits(rng: np.random.Generator, *shape: int) -> JointLimits:
    """Return limits of all kinds: some axes free, some locked, ranges from nothing to half a turn on one side."""
    limited, locked = rng.random((*shape, 3)) < 0.6, rng.random((*shape, 3)) < 0.15
    ranges = np.pi * rng.random((2, *shape, 3)) ** 2 * (rng.random((2, *shape, 3)) < 0.9)
    return JointLimits.of(limited, locked, -ranges[0], ranges[1])


def _turns(rng: np.random.Generator, *shape: int) -> Array:
    return quat.normalize(rng.normal(size=(*shape, 4)))


def _over(limits: JointLimits, turns: Array) -> float:
    told = limiting.swing_and_twist(turns)
    return float(np.abs(limits.nearest(told) - told).max(initial=0.0))


# --- the limits of a joint ---


def test_a_rotation_is_a_twist_and_then_a_swing() -> None:
    turns = _turns(np.random.default_rng(1), 1000)
    assert quat.angle_between(limiting.turned(limiting.swing_and_twist(turns)), turns).max() < 1e-7
    swing = limiting.turned(np.array([0.3, 0.0, -0.2]))
    twist = quat.from_axis_angle(np.array([0.0, 1.0, 0.0]), 0.7)
    assert np.allclose(limiting.swing_and_twist(quat.multiply(swing, twist)), [0.3, 0.7, -0.2])


@pytest.mark.parametrize("axis", range(3))
def test_turns_about_one_axis_stop_at_the_limits_of_it(axis: int) -> None:
    """Whatever the other axes allow."""
    rng = np.random.default_rng(2)
    least, most = -rng.uniform(0.0, 2.0, (50, 3)), rng.uniform(0.0, 2.0, (50, 3))
    limits = JointLimits.of(np.ones((50, 3), dtype=bool), np.zeros((50, 3), dtype=bool), least, most)
    angles = rng.uniform(-3.0, 3.0, 50)
    found = limits.clamped(quat.from_axis_angle(np.eye(3)[axis], angles))
    wanted = quat.from_axis_angle(np.eye(3)[axis], np.clip(angles, least[:, axis], most[:, axis]))
    assert quat.angle_between(found, wanted).max() < 1e-6


def test_swings_about_both_axes_stop_at_an_oval() -> None:
    """Half the angle's sine, as Blender's own inverse kinematics have it."""
    degrees = np.radians([-40.0, 0.0, -20.0]), np.radians([70.0, 0.0, 90.0])
    limits = JointLimits.of(np.array([True, False, True]), np.zeros(3, dtype=bool), *degrees)
    ways = np.linspace(0.0, 2.0 * np.pi, 73)
    told = np.stack([0.95 * np.cos(ways), 0.4 * np.sin(3.0 * ways), 0.95 * np.sin(ways)], axis=-1)
    x, twist, z = limiting.swing_and_twist(limits.clamped(limiting.turned(told))).T
    axes = np.where(x > 0.0, np.sin(degrees[1][0] / 2), np.sin(-degrees[0][0] / 2))
    others = np.where(z > 0.0, np.sin(degrees[1][2] / 2), np.sin(-degrees[0][2] / 2))
    assert np.abs((x / axes) ** 2 + (z / others) ** 2 - 1.0).max() < 1e-6
    assert np.abs(twist - told[:, 1]).max() < 1e-9


def test_clamped_rotations_are_within_the_limits() -> None:
    rng = np.random.default_rng(3)
    limits = _limits(rng, 2000)
    assert _over(limits, limits.clamped(_turns(rng, 2000))) < WITHIN


def test_rotations_within_the_limits_stay_as_they_are() -> None:
    """To the bit, and so does rest, whatever the limits."""
    rng = np.random.default_rng(4)
    limits, rest = _limits(rng, 2000), quat.identity(2000)
    clamped = limits.clamped(_turns(rng, 2000))
    inside = limiting.turned(limiting.swing_and_twist(clamped) * rng.uniform(0.0, 0.999, (2000, 1)))
    assert np.array_equal(limits.clamped(inside), inside)
    assert np.array_equal(limits.clamped(rest), rest)
    wrong = JointLimits.of(np.ones((1, 3), dtype=bool), np.zeros((1, 3), dtype=bool), np.ones((1, 3)), -np.ones((1, 3)))
    assert np.array_equal(wrong.clamped(rest[:1]), rest[:1])


def test_clamped_swings_and_twists_are_the_nearest_and_never_further_apart_than_before() -> None:
    rng = np.random.default_rng(5)
    limits = _limits(rng, 500)
    told = limiting.swing_and_twist(_turns(rng, 40, 500))
    near = limits.nearest(told)
    apart, before = (quat.length(v[1:] - v[:-1]) for v in (near, told))
    assert (apart <= before * (1.0 + 1e-6) + 1e-9).all()
    others = limits.nearest(limiting.swing_and_twist(_turns(rng, 40, 500)))
    assert (quat.length(near - told) <= quat.length(others - told) + 1e-6).all()


# --- limbs ---


def test_limbs_keep_within_their_limits(body: Limbed) -> None:
    rng = np.random.default_rng(6)
    goals = body.goals(goal_sets.random_sets(body.subject, rng, 100))
    pose = posing.solve(body.plan(body.limits), _far(goals, 1.0, 3.0, 0.1, 1e6))
    over = body.limits.nearest(body.told(pose)) - body.told(pose)
    assert np.abs(over).max() < WITHIN
    free = posing.solve(body.plan(None), goals)
    assert body.limits.beyond(body.told(free)).any(), "without limits, they would not"


def _far(goals: Goals, *shares: float) -> Goals:
    """Return goals at shares of their distances from the root, one batch after the other."""
    root = goals.positions[:, :1]
    places = [root + share * (goals.positions - root) for share in shares]
    return goal_sets.goals_of(goals.bodies, np.concatenate(places), np.tile(goals.turns, (len(shares), 1, 1)))


def test_goals_within_the_limits_are_met(body: Limbed) -> None:
    goals = body.goals(body.reachable(np.random.default_rng(1), 250))
    pose = posing.solve(body.plan(body.limits), goals)
    missed = pose_measures.misses(body.subject, goals, pose_measures.rebuilt(body.subject, pose))
    assert (missed[:, 1:] <= MEET).mean() >= SHARE
    assert missed[:, 0].max() < WITHIN


def test_limits_that_nothing_exceeds_change_nothing(body: Limbed) -> None:
    """Not one bit; and without limits there is nothing to be done."""
    goals = body.goals(body.reachable(np.random.default_rng(7), 50))
    plain = body.plan(None)
    assert plain.limited is None
    assert all(wave.limited is None for wave in plain.waves)
    pose, free = posing.solve(plain, goals), JointLimits.free(len(body.axes))
    wide = JointLimits(np.where(np.eye(3)[1] > 0.0, -np.pi, free.least), free.most)
    assert body.plan(free).limited is None
    assert body.plan(wide).limited is not None
    for limits in (free, wide):
        again = posing.solve(body.plan(limits), goals)
        assert np.array_equal(again.rotations, pose.rotations)
        assert np.array_equal(again.places, pose.places)


def test_limbs_within_their_limits_are_left_alone_where_others_are_not(body: Limbed) -> None:
    goals = body.goals(goal_sets.random_sets(body.subject, np.random.default_rng(8), 200))
    free, held = (posing.solve(body.plan(limits), goals) for limits in (None, body.limits))
    beyond = body.limits.beyond(body.told(free))
    for hinged in body.subject.limbs:
        joints = [hinged.first, *hinged.hinges]
        inside = ~beyond[:, joints].any(axis=1)
        assert np.array_equal(held.turns[inside][:, joints], free.turns[inside][:, joints])


def test_a_pose_within_limits_does_not_depend_on_other_frames(body: Limbed) -> None:
    rng = np.random.default_rng(9)
    goals, plan = body.goals(goal_sets.random_sets(body.subject, rng, 60)), body.plan(body.limits)
    pose = posing.solve(plan, goals)
    for order in (np.arange(60)[::-1], rng.permutation(60)):
        again = posing.solve(plan, rows(goals, order))
        assert np.array_equal(again.rotations, pose.rotations[order])
    for frame in range(0, 60, 12):
        one = slice(frame, frame + 1)
        alone = posing.solve(plan, rows(goals, one))
        assert quat.angle_between(alone.turns, pose.turns[one]).max() < 1e-6


def test_small_steps_of_goals_are_small_steps_of_joints_within_limits(body: Limbed) -> None:
    sets, plan = body.reachable(np.random.default_rng(3), 20), body.plan(body.limits)
    pose = posing.solve(plan, body.goals(sets.ways(range(0, 20, 2), range(1, 20, 2), 100)))
    assert np.degrees(pose_measures.step_turns(pose.turns, 10).max()) <= JUMP


@pytest.mark.parametrize("name", ["biped", "hound", "beetle", "bird", "asura"])
def test_mirrored_goals_make_the_mirrored_pose_within_limits(name: str) -> None:
    body = _creatures()[name]
    partner = pose_measures.partners(body.subject)
    assert partner is not None
    goals, plan = body.goals(body.reachable(np.random.default_rng(10), 60)), body.plan(body.limits)
    pose, again = posing.solve(plan, goals), posing.solve(plan, pose_measures.mirrored(goals, partner))
    turns = pose.turns[:, partner] * pose_measures.MIRROR_TURN
    assert quat.angle_between(again.turns, turns).max() < 1e-5


# --- whole bodies ---

TURNED = Placement(
    quat.to_matrix(quat.from_rotation_vector(np.array([np.pi / 2, 0.0, 0.3]))), 0.01, np.array([2.0, 1.0, 0.0])
)
MIRRORED = Placement(np.diag([-1.0, 1.0, 1.0]), 1.0, np.zeros(3))
SIZED = Movement(scale=ScaleMode.LIMB_LENGTH)


@pytest.mark.parametrize("bends_spine", [False, True])
@pytest.mark.parametrize("placement", [None, TURNED, MIRRORED], ids=["plain", "turned", "mirrored"])
def test_keys_keep_within_limits_of_any_kind(placement: Placement | None, bends_spine: bool) -> None:
    """All that is turned: the spine, hands with turns of their own, twist bones between the joints of a limb."""
    bones, rng = humanoid(build=Build(spine=4, neck=2, twists=2, fingers=2)), np.random.default_rng(11)
    if placement is not None:
        inverse, back = placement.inverse(), np.eye(4)
        back[:3, :3], back[:3, 3] = inverse.scale * inverse.rotation, inverse.translation
        bones = moved(bones, back)
    character = analyze(skeleton_of(bones, rng), placement)
    places = [Capability.ROOT, Capability.FOOT, Capability.GRASPER, Capability.HEAD]
    turned = [Capability.SPINE, Capability.NECK, Capability.LIMB, Capability.FINGER]
    channels = [Channel(c.value, Context(c), SIZED) for c in places]
    channels += [Channel(c.value, Context(c), poses_position=False) for c in turned]
    binding = bind(GeneralizedAction("action", tuple(channels)), Bodies.of(character))
    limits, count = _limits(rng, len(character.skeleton)), len(channels)
    part = play.prepare(character, binding, SolverSettings(bends_spine=bends_spine), limits)
    turns = quat.from_rotation_vector(rng.uniform(-1.0, 1.0, (40, count, 3)))
    values = Values(rng.uniform(-0.6, 0.6, (40, count, 3)), turns, rng.uniform(0.0, 1.0, (40, count)))
    played = play.evaluate(part, values, {})
    # The root is where the action brings it.
    own = played.bones != played.root
    assert _over(limits[played.bones[own]], played.basis[:, own]) < WITHIN


def test_absurd_limits_and_goals_make_poses_without_nan(body: Limbed) -> None:
    count, rng = len(body.axes), np.random.default_rng(12)
    yes, no = np.ones((count, 3), dtype=bool), np.zeros((count, 3), dtype=bool)
    tiny = np.full((count, 3), 1e-300)
    absurd = (
        JointLimits.of(no, yes, tiny, tiny),
        JointLimits.of(yes, no, -tiny, tiny),
        JointLimits.of(yes, no, np.full((count, 3), -1e300), np.full((count, 3), np.inf)),
        JointLimits.of(yes, no, np.full((count, 3), 3.0), np.full((count, 3), -3.0)),
        _limits(rng, count),
    )
    goals = _far(body.goals(body.reachable(rng, 20)), 1.0, 0.0, 1e9)
    for limits in absurd:
        pose = posing.solve(body.plan(limits), goals)
        assert np.isfinite(pose.positions).all()
        assert np.abs(quat.length(pose.turns) - 1.0).max() < 1e-9
