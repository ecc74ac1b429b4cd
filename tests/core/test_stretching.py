"""Allow Stretch: bones get longer and shorter for goals out of reach, and change nothing else."""

from collections.abc import Mapping
from functools import cache, lru_cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from morph_retarget.core import long_clip, play, quat, rotation
from morph_retarget.core.arrays import Array, Indices
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.character.frame import Placement
from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.morph.bind import GeneralizedAction, bind
from morph_retarget.core.morph.bodies import Bodies
from morph_retarget.core.morph.channels import Channel, Values
from morph_retarget.core.morph.context import Context
from morph_retarget.core.morph.movement import Movement, ScaleMode
from morph_retarget.core.play import Part, Played
from morph_retarget.core.skeleton import pose_from_basis
from morph_retarget.core.solve import limb_phase, posing, stretching
from morph_retarget.core.solve.goals import Goals
from morph_retarget.core.solve.limb_phase import Limbs
from morph_retarget.core.solve.limits import JointLimits
from morph_retarget.core.solve.plan import Plan
from morph_retarget.core.solve.posing import BodyPose
from morph_retarget.core.solve.settings import DEFAULT, SolverSettings
from morph_retarget.core.solve.stretching import Elastic
from tests import goal_sets, pose_measures
from tests.goal_sets import HUMAN, Subject, goals_of, rows
from tests.limited import limbed
from tests.skeletons import skeleton_of
from tools.figure import Build, humanoid, moved

seeds = st.integers(0, 10_000)
bends = st.sampled_from([0.0, 0.02, 0.3, 1.0, 2.0])
few = settings(max_examples=30)
EXACT = 1e-6
"""Goals that stretching reaches are met to this share of a limb's length, or of a character's size."""
FAR = 1.15
"""Share of a limb's length up to which goals are met."""
UNLIKE = ("hound", "beetle", "snake", "asura", "lopside")
"""Sample characters whose limbs differ in kind: the others have fewer of the same."""
SYMMETRIC = ("biped", "hound", "beetle", "bird", "asura")


# --- limbs ---


def _chain(rng: np.random.Generator, joints: int, bend: float) -> Elastic:
    """Return a limb of uneven bones in any direction that bends at rest, each joint its own way."""
    way, points = quat.unit(rng.normal(size=3)), [np.zeros(3)]
    size = 10.0 ** rng.uniform(-2.0, 2.0)
    for _ in range(joints):
        points.append(points[-1] + size * rng.uniform(0.1, 1.0) * way)
        way = quat.rotate(quat.from_axis_angle(quat.unit(rng.normal(size=3)), bend * rng.uniform(-1.0, 1.0)), way)
    limbs = Limbs.of([np.array(points)], [quat.unit(rng.normal(size=3))])
    found = Elastic.of(limbs, [range(joints)], [joints], (), DEFAULT)
    assert found is not None
    return found


def _reach(elastic: Elastic, goals: Array) -> tuple[Array, Array, Array]:
    """Return turns of a limb, (frame, joint, 3, 3), factors, (frame, joint), and where its longer bones lead."""
    turned, factors = stretching.solve(elastic, goals[:, None])
    bones = factors[..., None] * rotation.apply(turned, elastic.limbs.segments)
    return turned[:, 0], factors[:, 0], bones.sum(axis=2)[:, 0]


def _any_way(rng: np.random.Generator, distances: Array) -> Array:
    return distances[:, None] * quat.unit(rng.normal(size=(len(distances), 3)))


@few
@given(seed=seeds, joints=st.integers(1, 6), bend=bends)
def test_a_limb_comes_to_goals_beyond_its_length_and_nearer_than_it_folds(seed: int, joints: int, bend: float) -> None:
    rng = np.random.default_rng(seed)
    limb = _chain(rng, joints, bend)
    full, nearest = limb.limbs.full[0], limb.nearest[0]
    for least, most in ((full, FAR * full), (1.01 * DEFAULT.shrink * nearest, nearest)):
        goals = _any_way(rng, rng.uniform(least, most, 200))
        _, factors, ends = _reach(limb, goals)
        assert quat.length(ends - goals).max() < EXACT * full
        assert np.abs(factors - 1.0).max() > 0.01 * (most - least) / full


@few
@given(seed=seeds, joints=st.integers(1, 6), bend=bends)
def test_within_reach_a_limb_turns_as_without_to_the_bit(seed: int, joints: int, bend: float) -> None:
    rng = np.random.default_rng(seed)
    limb = _chain(rng, joints, bend)
    slow = max(DEFAULT.slow_down * limb.limbs.full[0], limb.limbs.chords[0])
    goals = _any_way(rng, rng.uniform(min(limb.nearest[0], slow), slow, 200))
    turned, factors, _ = _reach(limb, goals)
    assert (factors == 1.0).all()
    assert np.array_equal(turned, limb_phase.solve(limb.limbs, goals[:, None])[:, 0])


@few
@given(seed=seeds, joints=st.integers(1, 6), bend=bends)
def test_all_bones_stretch_alike_and_no_factor_is_beyond_its_bounds(seed: int, joints: int, bend: float) -> None:
    rng = np.random.default_rng(seed)
    limb = _chain(rng, joints, bend)
    full = limb.limbs.full[0]
    away = np.concatenate([[0.0], full * np.geomspace(1e-6, 1e6, 400)])
    _, factors, _ = _reach(limb, _any_way(rng, away))
    assert factors.min() >= DEFAULT.shrink * (1.0 - 1e-12)
    assert factors.max() <= DEFAULT.stretch
    assert np.abs(factors[-1] - DEFAULT.stretch).max() < 1e-3
    far = away > full
    assert np.ptp(factors[far], axis=1).max() == 0.0
    assert factors[~far & (away < limb.nearest[0])].max(initial=1.0) <= 1.0, "what is too near makes no bone longer"


@few
@given(seed=seeds, joints=st.integers(1, 6), bend=bends)
def test_lengths_change_without_jumps_where_a_goal_leaves_what_is_in_reach(seed: int, joints: int, bend: float) -> None:
    """By no more than the goal goes, over the limb's length, and 10 times as much where a limb folds up."""
    rng = np.random.default_rng(seed)
    limb = _chain(rng, joints, bend)
    full = limb.limbs.full[0]
    shares = np.linspace(0.0, 1.5, 6001)
    way = quat.unit(rng.normal(size=3))
    _, factors, ends = _reach(limb, full * shares[:, None] * way)
    steps = np.abs(np.diff(factors * limb.limbs.lengths[0] / full, axis=0)).max(axis=1) / (shares[1] - shares[0])
    far = shares[1:] > min(0.5 * DEFAULT.slow_down, limb.nearest[0] / full)
    assert steps[far].max() < 1.1
    assert steps.max() < 10.0
    outside = shares[1:] > 0.98
    assert quat.length(np.diff(ends, axis=0))[outside].max() < 1.1 * full * (shares[1] - shares[0])


def test_a_stretched_limb_slows_down_as_it_does_at_its_own_length() -> None:
    """The factor starts to grow without a kink, if the limb is bent at rest."""
    elbow = np.array([[0.0, 0.0, 0.0], [0.0, 0.06, -0.294], [0.0, 0.0, -0.588]])
    limb = Elastic.of(Limbs.of([elbow], [np.zeros(3)]), [(0, 1)], [2], (), DEFAULT)
    assert limb is not None
    shares = np.linspace(0.97, 1.4, 4301)
    _, factors, ends = _reach(limb, limb.limbs.full[0] * shares[:, None] * quat.unit(np.array([1.0, -2.0, 0.5])))
    slopes = np.diff(factors[:, 0]) / np.diff(shares)
    assert np.abs(np.diff(slopes)).max() < 0.02
    assert np.diff(quat.length(ends)).min() > -1e-9


# --- whole bodies ---


@cache
def _creatures() -> Mapping[str, Subject]:
    return {name: Subject(character) for name, character in goal_sets.creatures().items()}


@pytest.fixture(params=UNLIKE)
def subject(request: pytest.FixtureRequest) -> Subject:
    """Return sample characters."""
    return _creatures()[request.param]


@lru_cache(maxsize=64)
def _plan(subject: Subject, fixed: tuple[int, ...] = (), limits: JointLimits | None = None, **options: bool) -> Plan:
    wanted = [(int(body), True, True) for body in subject.goals]
    tuned = SolverSettings(**{"allows_stretch": True, **options})  # pyright: ignore[reportArgumentType]
    return posing.prepare(subject.character, subject.bodies.positions, subject.root, wanted, tuned, limits, fixed)


def _sets(subject: Subject, count: int, factor: float = 1.0, seed: int = 1) -> Goals:
    return goal_sets.beyond(goal_sets.random_sets(subject, np.random.default_rng(seed), count), factor)


def _at_full_stretch(subject: Subject, plan: Plan, rng: np.random.Generator, count: int) -> tuple[Goals, Indices]:
    """Return goals for the ends of limbs beyond their lengths, the rest where it is at rest; and which goals."""
    goals, own, character = goal_sets.at_rest(subject, count), list[int](), subject.character
    trunk = (*character.spine, *character.neck, character.head)
    for wave in plan.waves:
        for i, limb in enumerate(wave.limbs):
            if (
                wave.stem is None
                and limb.body not in trunk
                and subject.root in subject.bodies.tree.ancestors[limb.body]
            ):
                way = quat.unit(rng.normal(size=(count, 3))) * rng.uniform(1.0, FAR, (count, 1))
                goals.positions[:, limb.goal] = subject.bodies.positions[limb.joints[0]] + wave.chains.full[i] * way
                own.append(limb.goal)
    return goals, np.array(own, dtype=np.intp)


def _longer(plan: Plan, pose: BodyPose) -> list[Array]:
    """Return by what factors bones between joints are longer, each of shape (frame,), measured from places."""
    links = [(link.joint, link.end) for wave in plan.waves if wave.elastic for link in wave.elastic.links]
    if plan.trunk is not None:
        links += [(plan.trunk.joints[i], body) for body, i in plan.trunk.drawn.items()]
    rest = plan.rest
    return [
        quat.length(pose.positions[:, end] - pose.positions[:, joint]) / np.linalg.norm(rest[end] - rest[joint])
        for joint, end in links
        if plan.above[end] == joint and np.linalg.norm(rest[end] - rest[joint]) > 1e-3 * float(np.ptp(rest))
    ]


@pytest.mark.parametrize("bends_spine", [False, True])
def test_bodies_in_reach_are_posed_as_without_to_the_bit(subject: Subject, bends_spine: bool) -> None:
    """Goals from poses with trunks and tails at rest: all limbs reach theirs."""
    sets = goal_sets.random_sets(subject, np.random.default_rng(1), 60)
    limbs = {body for hinged in subject.limbs for body in (hinged.first, *hinged.hinges, hinged.limb.end)}
    sets.own[:, [body for body in range(len(subject.bodies)) if body not in limbs]] = quat.IDENTITY
    goals = sets.goals
    plain = posing.solve(_plan(subject, allows_stretch=False, bends_spine=bends_spine), goals)
    plan = _plan(subject, bends_spine=bends_spine)
    pose = posing.solve(plan, goals)
    assert pose.stretched is not None
    assert plain.stretched is None
    assert not pose.stretched.any()
    assert np.array_equal(pose.turns, plain.turns)
    assert np.abs(pose.positions - plain.positions).max() <= 1e-12 * subject.bodies.size


@pytest.mark.parametrize("bends_spine", [False, True])
def test_frames_that_need_no_stretch_are_those_without(subject: Subject, bends_spine: bool) -> None:
    """A spine that gives way several times may want to stretch on the way to a pose that does not."""
    goals = _sets(subject, 120)
    plain = posing.solve(_plan(subject, allows_stretch=False, bends_spine=bends_spine), goals)
    pose = posing.solve(_plan(subject, bends_spine=bends_spine), goals)
    assert pose.stretched is not None
    met = np.linalg.norm(plain.positions[:, goals.bodies] - goals.positions, axis=-1) < 1e-4 * subject.bodies.size
    still = ~pose.stretched.any(axis=(1, 2)) & met.all(axis=1)
    if bends_spine:
        assert quat.angle_between(pose.turns[still], plain.turns[still]).max() < 1e-5
        same = (pose.turns == plain.turns).all(axis=(1, 2))
        assert same[still].mean() > 0.95
        assert still.mean() > 0.7, "these are goals that a body can meet"
    else:
        assert np.array_equal(pose.turns[still], plain.turns[still])


@pytest.mark.parametrize("bends_spine", [False, True])
def test_limbs_come_to_goals_beyond_their_lengths(subject: Subject, bends_spine: bool) -> None:
    """A spine that bends brings them nearer, or takes them further away for other goals: what is left counts."""
    plan = _plan(subject, bends_spine=bends_spine)
    goals, own = _at_full_stretch(subject, plan, np.random.default_rng(4), 100)
    pose = posing.solve(plan, goals)
    for wave in plan.waves:
        for limb, full in zip(wave.limbs, wave.chains.full, strict=True):
            goal = goals.positions[:, limb.goal]
            away = quat.length(goal - pose.positions[:, limb.joints[0]]) / full
            beyond = (away > 1.0) & (away < FAR)
            missed = quat.length(pose.positions[:, limb.body] - goal)[beyond]
            assert missed.max(initial=0.0) < EXACT * full
            assert bends_spine or limb.goal not in own or beyond.all()


def test_more_goals_are_met_than_without(subject: Subject) -> None:
    for factor in (1.05, 1.1, 1.2):
        goals = _sets(subject, 60, factor)
        met = [
            (quat.length(posing.solve(plan, goals).positions[:, goals.bodies] - goals.positions) < 1e-3).mean()
            for plan in (_plan(subject, bends_spine=True, allows_stretch=own) for own in (False, True))
        ]
        assert met[1] > met[0]


@pytest.mark.parametrize("bends_spine", [False, True])
def test_no_bone_is_longer_or_shorter_than_it_may(subject: Subject, bends_spine: bool) -> None:
    plan = _plan(subject, bends_spine=bends_spine)
    for what, goals in goal_sets.hard(subject, 20).items():
        pose = posing.solve(plan, goals)
        assert np.isfinite(pose.positions).all(), what
        for factors in _longer(plan, pose):
            assert factors.max() < DEFAULT.stretch + EXACT, what
            assert factors.min() > DEFAULT.shrink - EXACT, what


@pytest.mark.parametrize("bends_spine", [False, True])
def test_bodies_do_not_jump_where_goals_leave_what_is_in_reach(subject: Subject, bends_spine: bool) -> None:
    """In steps of 0.25 % no bone changes by more than 3 % of its length, nor turns further than without."""
    sets = goal_sets.random_sets(subject, np.random.default_rng(1), 4)
    plan = _plan(subject, bends_spine=bends_spine)
    ways = [goal_sets.beyond(sets, share) for share in np.linspace(0.8, 1.8, 401)]
    for i in range(4):
        places, turns = (np.array([getattr(way, name)[i] for way in ways]) for name in ("positions", "turns"))
        pose = posing.solve(plan, goals_of(subject.goals, places, turns))
        assert np.degrees(pose_measures.step_turns(pose.turns).max()) <= 25.0
        for factors in _longer(plan, pose):
            assert np.abs(np.diff(factors)).max() < 0.03


def test_a_moved_and_turned_body_stretches_the_same(subject: Subject) -> None:
    """Where the root has a goal of its own, it carries all that follows it."""
    plan, goals, rng = _plan(subject, bends_spine=True), _sets(subject, 40, 1.1), np.random.default_rng(9)
    turn, shift = quat.normalize(rng.normal(size=4)), rng.uniform(-3.0, 3.0, 3) * subject.scale
    pose = posing.solve(plan, goals)
    moved_goals = goals_of(goals.bodies, quat.rotate(turn, goals.positions) + shift, quat.multiply(turn, goals.turns))
    again, bodies = posing.solve(plan, moved_goals), subject.of_root
    apart = quat.length(again.positions[:, bodies] - quat.rotate(turn, pose.positions[:, bodies]) - shift).max()
    assert apart <= EXACT * HUMAN * subject.scale


@pytest.mark.parametrize("name", SYMMETRIC)
def test_mirrored_goals_stretch_the_mirrored_bones(name: str) -> None:
    subject = _creatures()[name]
    partner = pose_measures.partners(subject)
    assert partner is not None
    plan, goals = _plan(subject, bends_spine=True), _sets(subject, 60, 1.1)
    pose, again = posing.solve(plan, goals), posing.solve(plan, pose_measures.mirrored(goals, partner))
    places = pose.positions[:, partner] * pose_measures.MIRROR
    assert quat.length(again.positions - places).max() <= EXACT * HUMAN * subject.scale


def test_frames_have_the_same_poses_in_any_order_and_one_by_one(subject: Subject) -> None:
    plan, goals = _plan(subject, bends_spine=True), _sets(subject, 40, 1.08)
    pose, order = posing.solve(plan, goals), np.random.default_rng(8).permutation(40)
    again = posing.solve(plan, rows(goals, order))
    assert np.array_equal(again.positions, pose.positions[order])
    for frame in range(0, 40, 4):
        one = slice(frame, frame + 1)
        alone = posing.solve(plan, rows(goals, one))
        assert np.abs(alone.positions - pose.positions[one]).max() <= 1e-9 * subject.bodies.size


def test_a_limb_with_a_joint_that_cannot_move_keeps_its_lengths_and_is_told() -> None:
    subject = _creatures()["biped"]
    names = subject.character.skeleton.index
    elbow, hand, other = names["LowerArm.L"], names["Hand.L"], names["Hand.R"]
    for fixed in ((elbow,), (hand,)):
        plan = _plan(subject, fixed)
        assert plan.stiff == fixed
        goals, _ = _at_full_stretch(subject, plan, np.random.default_rng(4), 30)
        pose = posing.solve(plan, goals)
        plain = posing.solve(_plan(subject, allows_stretch=False), goals)
        left = [names["UpperArm.L"], elbow, hand]
        assert quat.length(pose.positions[:, left] - plain.positions[:, left]).max() < 1e-12
        assert quat.length(pose.positions[:, other] - plain.positions[:, other]).max() > 0.01
    assert _plan(subject, (elbow,), allows_stretch=False).stiff == ()


def test_a_neck_that_bends_stretches_to_where_the_head_shall_be() -> None:
    """The pieces of a spine are as long as it takes, 120 % at most; one with a bone that cannot move is not."""
    subject = _creatures()["biped"]
    head, names = subject.character.head, subject.character.skeleton.index
    assert head is not None
    for fixed in ((), (names["Neck"],)):
        wanted = [(head, True, False)]
        tuned = SolverSettings(bends_spine=True, allows_stretch=True)
        plan = posing.prepare(subject.character, subject.bodies.positions, subject.root, wanted, tuned, fixed=fixed)
        assert plan.trunk is not None
        assert plan.stiff == fixed
        start, spine = subject.bodies.positions[plan.trunk.joints[0]], plan.trunk.spine
        shares = np.linspace(0.9, FAR, 101)
        ways = spine.most.sum() * shares[:, None] * quat.unit(np.array([0.3, -0.5, 1.0]))
        goals = goals_of(np.array([head]), (start + ways)[:, None], quat.identity(101, 1))
        pose = posing.solve(plan, goals)
        missed = quat.length(pose.positions[:, head] - goals.positions[:, 0])
        if fixed:
            assert missed[-1] > 0.1 * spine.size
        else:
            assert missed.max() < EXACT * spine.size
            assert max(factors.max() for factors in _longer(plan, pose)) > 1.1


def test_a_stem_stretches_for_what_its_branches_cannot_reach() -> None:
    """An arm with goals for two fingers."""
    character = analyze(skeleton_of(humanoid(1.75, build=Build(fingers=5)), np.random.default_rng(0)))
    bodies = Bodies.of(character)
    ends = [character.skeleton.index[name] for name in ("leftIndexDistal", "leftMiddleDistal")]
    plan = posing.prepare(
        character, bodies.positions, bodies.with_capability(Capability.ROOT)[0], [(end, True, False) for end in ends],
        SolverSettings(allows_stretch=True),
    )  # fmt: skip
    stem = next(wave for wave in plan.waves if wave.stem is not None)
    start = bodies.positions[stem.limbs[0].joints[0]]
    assert stem.stem is not None
    lengths = stem.chains.full[0] + stem.stem.full.max()
    ways = quat.unit(np.random.default_rng(5).normal(size=(200, 1, 3)))
    around = bodies.positions[ends] - bodies.positions[ends].mean(axis=0)
    goals = start + 1.05 * lengths * ways + 0.2 * around
    pose = posing.solve(plan, goals_of(np.array(ends), goals, quat.identity(200, 2)))
    missed = quat.length(pose.positions[:, ends] - goals)
    assert (missed < 1e-3).mean() > 0.95
    for factors in _longer(plan, pose):
        assert factors.max() < DEFAULT.stretch + 1e-9


def test_stretched_limbs_that_swivel_out_of_a_body_keep_their_ends_at_their_goals() -> None:
    subject = _creatures()["biped"]
    plan = _plan(subject, avoids_collisions=True)
    goals, own = _at_full_stretch(subject, plan, np.random.default_rng(4), 200)
    near = goals.positions.copy()
    near[::2, own] = subject.bodies.positions[subject.goals[own]] * [0.2, 1.0, 1.0]
    goals = goals_of(goals.bodies, near, goals.turns)
    pose, plain = posing.solve(plan, goals), posing.solve(_plan(subject), goals)
    turned = quat.angle_between(pose.turns, plain.turns).max(axis=1)
    assert (turned > 0.05).any()
    missed = quat.length(pose.positions[:, goals.bodies] - goals.positions)[1::2, own]
    assert missed.max() < EXACT * subject.bodies.size


def test_stretched_limbs_keep_within_their_limits() -> None:
    """Hinges, and limited hips and shoulders; most goals are ahead of what the first bones may point to."""
    body = limbed(_creatures()["biped"])
    subject, sets = body.subject, body.reachable(np.random.default_rng(4), 200)
    goals, places, rest = body.goals(sets), sets.pose[0], body.subject.bodies.positions
    for hinged in subject.limbs:
        line = subject.bodies.tree.path(hinged.first, hinged.limb.end)
        start, elbow, end = (places[:, joint] for joint in (hinged.first, hinged.hinges[0], hinged.limb.end))
        way = quat.unit(0.8 * quat.unit(elbow - start) + 0.2 * quat.unit(end - start))
        full = quat.length(np.diff(rest[line], axis=0)).sum()
        goals.positions[:, body.ends.tolist().index(hinged.limb.end)] = start + 1.1 * full * way
    wanted = [(end, True, end == subject.root) for end in body.ends.tolist()]
    tuned = SolverSettings(allows_stretch=True)
    free, plan = (
        posing.prepare(subject.character, rest, subject.root, wanted, tuned, limits) for limits in (None, body.limits)
    )
    pose, plain = posing.solve(plan, goals), posing.solve(free, goals)
    joints = [joint for wave in plan.waves for limb in wave.limbs for joint in limb.joints]
    for found, keeps in ((pose, True), (plain, False)):
        told = body.told(found)
        over = np.abs(body.limits.nearest(told) - told)[:, joints]
        assert (over.max() < 1e-6) == keeps
    missed = quat.length(pose.positions[:, body.ends] - goals.positions)[:, 1:]
    assert (missed < 1e-4).mean() > 0.9


# --- what is written ---

SIZED = Movement(scale=ScaleMode.LIMB_LENGTH)
TURNED = Placement(
    quat.to_matrix(quat.from_rotation_vector(np.array([np.pi / 2, 0.0, 0.3]))), 0.01, np.array([2.0, 1.0, 0.0])
)
MIRRORED = Placement(np.diag([-1.0, 1.0, 1.0]), 2.0, np.array([0.5, 0.0, 0.0]))
_PLACED = (Capability.ROOT, Capability.FOOT, Capability.GRASPER, Capability.HEAD, Capability.TAIL)
CHANNELS = [Channel(c.value, Context(c), SIZED) for c in _PLACED]
FIGURES: Mapping[str, tuple[Build, Placement | None]] = {
    "an adult": (Build(fingers=2), None),
    "twist bones": (Build(spine=5, neck=2, twists=2, root=True), None),
    "a turned object in centimetres": (Build(fingers=1), TURNED),
    "a mirrored object": (Build(fingers=1), MIRRORED),
}


def _part(build: Build, placement: Placement | None, bends_spine: bool) -> Part:
    bones = humanoid(build=build)
    if placement is not None:
        inverse, back = placement.inverse(), np.eye(4)
        back[:3, :3], back[:3, 3] = inverse.scale * inverse.rotation, inverse.translation
        bones = moved(bones, back)
    character = analyze(skeleton_of(bones, np.random.default_rng(0)), placement)
    binding = bind(GeneralizedAction("Reach", tuple(CHANNELS)), Bodies.of(character))
    return play.prepare(character, binding, SolverSettings(allows_stretch=True, bends_spine=bends_spine))


def _wild(frames: int) -> Values:
    rng, count = np.random.default_rng(6), len(CHANNELS)
    turns = quat.from_rotation_vector(rng.uniform(-0.5, 0.5, (frames, count, 3)))
    return Values(rng.uniform(-0.9, 0.9, (frames, count, 3)), turns, rng.uniform(0.3, 1.0, (frames, count)))


def _rebuilt(part: Part, played: Played) -> Array:
    """Return the places of all bones that rotations and locations make, by forward kinematics, character frame."""
    skeleton, frames = part.character.skeleton, len(played.basis)
    rotations, locations = quat.identity(frames, len(skeleton)), np.zeros((frames, len(skeleton), 3))
    rotations[:, played.bones] = played.basis
    locations[:, played.root] = quat.rotate(quat.conjugate(skeleton.rest_rotations[played.root]), played.shift)
    assert played.stretched is not None
    own = played.stretched.bones
    locations[:, own] = quat.rotate(quat.conjugate(skeleton.rest_rotations[own]), played.stretched.shifts)
    assert set(own.tolist()) <= set(played.bones.tolist()), "what is written live is put back to rest by the same list"
    return part.character.local_to_character.points(pose_from_basis(skeleton, rotations, locations).positions)


@pytest.mark.parametrize("bends_spine", [False, True])
@pytest.mark.parametrize("figure", FIGURES)
def test_rotations_and_locations_that_are_written_make_the_pose(figure: str, bends_spine: bool) -> None:
    part = _part(*FIGURES[figure], bends_spine)
    played = play.evaluate(part, _wild(40), {})
    assert played.stretched is not None
    assert np.abs(played.stretched.shifts).max() > 0.0
    places = played.pose.positions
    assert np.abs(_rebuilt(part, played) - places).max() < 1e-6 * part.bodies.size


def test_a_long_clip_is_stretched_as_its_frames_are() -> None:
    part, values = _part(*FIGURES["an adult"], bends_spine=False), _wild(long_clip.BLOCK + 40)
    steps = long_clip.evaluate(part, values, {})
    try:
        while True:
            next(steps)
    except StopIteration as done:
        found: Played = done.value
    whole = play.evaluate(part, values, {})
    assert found.stretched is not None
    assert whole.stretched is not None
    assert np.array_equal(found.stretched.shifts, whole.stretched.shifts)
    assert np.array_equal(found.pose.positions, whole.pose.positions)
