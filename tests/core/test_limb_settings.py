"""Settings of single limbs: each tunes its own limb, swivels keep ends where they are, and both sides are alike."""

from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from functools import cache, lru_cache

import numpy as np
import pytest

from morph_retarget.core import quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.errors import RigError
from morph_retarget.core.solve import posing
from morph_retarget.core.solve.goals import Goals
from morph_retarget.core.solve.limb_settings import LimbSettings
from morph_retarget.core.solve.plan import Limb, Plan
from morph_retarget.core.solve.posing import BodyPose
from morph_retarget.core.solve.settings import DEFAULT, SolverSettings
from tests import goal_sets, pose_measures
from tests.goal_sets import Subject, goals_of
from tests.skeletons import skeleton_of
from tools.figure import Build, humanoid

CREATURES = ("biped", "hound", "beetle", "bird", "asura", "lopside")
UNLIKE = ("hound", "beetle", "asura", "lopside")
"""Those of them whose limbs differ in kind: the others have fewer of the same."""
EXACT = 1e-9
"""Share of the character's size by which places may differ."""


@cache
def _creatures() -> Mapping[str, Subject]:
    return {name: Subject(c) for name, c in goal_sets.creatures().items() if name in CREATURES}


@pytest.fixture(params=UNLIKE)
def body(request: pytest.FixtureRequest) -> Subject:
    """Return sample characters that have limbs."""
    return _creatures()[request.param]


def _names(body: Subject, bodies: Sequence[int]) -> list[str]:
    return [body.character.skeleton.names[b] for b in bodies]


def _ends(body: Subject) -> list[int]:
    return list(dict.fromkeys(hinged.limb.end for hinged in body.limbs))


def _plan(body: Subject, settings: SolverSettings, places: Sequence[int] | None = None) -> Plan:
    """Return how goals for the places of the limbs' ends are met, or others."""
    return _planned(body, settings, tuple(places or _ends(body)))


@lru_cache(maxsize=64)
def _planned(body: Subject, settings: SolverSettings, places: tuple[int, ...]) -> Plan:
    wanted = [(body.root, True, True), *((end, True, False) for end in places)]
    return posing.prepare(body.character, body.bodies.positions, body.root, wanted, settings)


def _goals(body: Subject, seed: int, count: int, places: Sequence[int] | None = None) -> Goals:
    """Return goals that the limbs' ends, or others, can meet together with the root's own."""
    bodies = np.array([body.root, *(places or _ends(body))], dtype=np.intp)
    at, turns = goal_sets.random_sets(body, np.random.default_rng(seed), count).pose
    return goals_of(bodies, at[:, bodies], turns[:, bodies])


def _limbs(plan: Plan) -> list[Limb]:
    return [limb for wave in plan.waves for limb in wave.limbs]


def _stretched(plan: Plan, limb: Limb) -> tuple[float, float]:
    """Return the length of a limb when it is stretched, and from its start to its end at rest [m]."""
    points = plan.rest[[*limb.joints, limb.body]]
    return float(quat.length(np.diff(points, axis=0)).sum()), float(quat.length(points[-1] - points[0]))


def _is_straight(plan: Plan, limb: Limb) -> bool:
    full, chord = _stretched(plan, limb)
    return chord > 0.85 * full


def _only(name: str, **options: float) -> SolverSettings:
    return SolverSettings(limbs={name: replace(LimbSettings(), **options)})


def _assert_same(pose: BodyPose, other: BodyPose) -> None:
    assert np.array_equal(pose.rotations, other.rotations)
    assert np.array_equal(pose.places, other.places)


# --- which limb ---


@pytest.mark.parametrize("bends_spine", [False, True])
def test_settings_of_limbs_that_are_those_of_all_change_nothing(body: Subject, bends_spine: bool) -> None:
    """Not one bit."""
    goals = _goals(body, 1, 30)
    common = replace(DEFAULT, bends_spine=bends_spine)
    assert all(getattr(common, part.name) == part.default for part in fields(LimbSettings))
    own = replace(common, limbs=dict.fromkeys(_names(body, _ends(body)), LimbSettings()))
    _assert_same(posing.solve(_plan(body, own), goals), posing.solve(_plan(body, common), goals))


_OPTIONS: Sequence[dict[str, float]] = (
    {"swivel": 40.0},
    {"slow_down": 0.6},
    {"slow_down": 0.6, "full_reach": 0.8},
    {"outer_iterations": 0},
    {"softness": 3.0},
)


@pytest.mark.parametrize("options", _OPTIONS, ids="-".join)
def test_what_is_set_for_a_limb_changes_that_limb_alone(body: Subject, options: dict[str, float]) -> None:
    """To the bit. Limbs of two bones have but one shape, and those that are straight at rest do not slow down."""
    goals = _goals(body, 2, 30)
    plain = posing.solve(_plan(body, DEFAULT), goals)
    ancestors = body.bodies.tree.ancestors
    for limb in _limbs(_plan(body, DEFAULT)):
        plan = _plan(body, _only(_names(body, [limb.body])[0], **options))
        pose = posing.solve(plan, goals)
        moved = {i for i, b in enumerate(plan.order) if not np.array_equal(pose.rotations[:, i], plain.rotations[:, i])}
        own = {i for i, b in enumerate(plan.order) if not {*limb.joints}.isdisjoint((b, *ancestors[b]))}
        assert moved <= own
        counts = (
            len(limb.joints) > 2 if options.keys() <= {"outer_iterations", "softness"} else not _is_straight(plan, limb)
        )
        assert moved or not ("swivel" in options or counts)


def test_the_settings_of_the_character_are_for_limbs_without_their_own() -> None:
    body = _creatures()["biped"]
    goals, ends = _goals(body, 3, 20), _names(body, _ends(body))
    common = posing.solve(_plan(body, SolverSettings(swivel=30.0)), goals)
    each = SolverSettings(limbs={name: LimbSettings(swivel=30.0) for name in ends})
    _assert_same(posing.solve(_plan(body, each), goals), common)
    one = replace(each, swivel=-80.0)
    _assert_same(posing.solve(_plan(body, one), goals), common)


def test_what_is_set_for_a_limb_that_has_no_goal_waits_for_one(body: Subject) -> None:
    ends = _ends(body)
    goals = _goals(body, 4, 10, ends[:1])
    settings = SolverSettings(limbs=dict.fromkeys(_names(body, ends[1:]), LimbSettings(swivel=50.0)))
    again = posing.solve(_plan(body, settings, ends[:1]), goals)
    _assert_same(again, posing.solve(_plan(body, DEFAULT, ends[:1]), goals))


def test_a_limb_that_is_none_of_the_character_is_named() -> None:
    with pytest.raises(RigError, match=r"'Tentakel'.*choose the end of a limb, as .*Hand\.L"):
        _plan(_creatures()["biped"], _only("Tentakel", swivel=1.0))


# --- swivels ---


def _hinge(plan: Plan, limb: Limb) -> int:
    """Return the joint of a limb that is farthest off the line from its start to its end at rest."""
    start, end = plan.rest[limb.joints[0]], plan.rest[limb.body]
    away = plan.rest[list(limb.joints)] - start
    return limb.joints[int(quat.length(quat.cross(away, end - start)).argmax())]


def _about(axis: Array, a: Array, b: Array) -> Array:
    """Return the angle about axes from vectors to others [degrees], shape (frame,)."""
    axis = quat.unit(axis)
    a, b = (v - quat.dot(v, axis)[:, None] * axis for v in (a, b))
    return np.degrees(np.arctan2(quat.dot(axis, quat.cross(a, b)), quat.dot(a, b)))


@pytest.mark.parametrize("angle", [25.0, -70.0, 180.0])
def test_a_swivel_turns_the_elbow_about_a_line_whose_ends_stay(body: Subject, angle: float) -> None:
    goals, size = _goals(body, 5, 40), body.bodies.size
    plain = posing.solve(_plan(body, DEFAULT), goals)
    for limb in _limbs(_plan(body, DEFAULT)):
        if len(limb.joints) < 2:
            continue
        plan = _plan(body, _only(_names(body, [limb.body])[0], swivel=angle))
        pose = posing.solve(plan, goals)
        start, hinge, end = limb.joints[0], _hinge(plan, limb), limb.body
        before, after = plain.positions, pose.positions
        assert np.abs(after[:, [start, end]] - before[:, [start, end]]).max() < EXACT * size
        assert pose_measures.length_errors(body, after).max() < EXACT
        line = before[:, end] - before[:, start]
        turned = _about(line, before[:, hinge] - before[:, start], after[:, hinge] - after[:, start])
        bent = quat.length(quat.cross(quat.unit(line), before[:, hinge] - before[:, start])) > 1e-3 * size
        assert bent.any()
        assert np.abs(np.abs(turned[bent]) - abs(angle)).max() < 1e-5
        assert len(np.unique(np.sign(turned[bent]))) == 1 or abs(angle) == 180.0


def test_knees_and_elbows_swivel_outward() -> None:
    """Whichever way they bend: knees forward, elbows and a hound's front legs back. Arms that lead aside go up."""
    for name, upward in (("biped", {"Hand.L", "Hand.R"}), ("hound", set[str]())):
        body = _creatures()[name]
        bodies = np.array([body.root, *_ends(body)], dtype=np.intp)
        goals = goals_of(bodies, body.bodies.positions[bodies][None].copy(), quat.identity(1, len(bodies)))
        for limb in _limbs(_plan(body, DEFAULT)):  # all come half the way to where they hang
            here = bodies.tolist().index(limb.body)
            goals.positions[0, here] += 0.3 * (body.bodies.positions[limb.joints[0]] - goals.positions[0, here])
        plan = _plan(body, replace(DEFAULT, swivel=30.0))
        before, after = (posing.solve(p, goals).positions[0] for p in (_plan(body, DEFAULT), plan))
        for limb in _limbs(plan):
            hinge = _hinge(plan, limb)
            moved, end = quat.unit(after[hinge] - before[hinge]), _names(body, [limb.body])[0]
            side = 1.0 if end.endswith(".L") else -1.0
            assert (moved[2] if end in upward else side * moved[0]) > 0.7


def test_swivelling_further_goes_around_without_jumps(body: Subject) -> None:
    goals = _goals(body, 6, 10)
    step = 15.0
    angles = np.arange(-180.0, 181.0, step)
    turns = np.array([posing.solve(_plan(body, SolverSettings(swivel=a)), goals).turns for a in angles])
    assert quat.angle_between(turns[0], turns[-1]).max() < 1e-6
    assert np.degrees(quat.angle_between(turns[1:], turns[:-1]).max()) < step + 1e-3


def test_swivelled_limbs_turn_in_small_steps_as_their_goals_move(body: Subject) -> None:
    sets = goal_sets.random_sets(body, np.random.default_rng(3), 12)
    plan, bodies = _plan(body, SolverSettings(swivel=60.0)), np.array([body.root, *_ends(body)])
    places, turns = sets.ways(range(0, 12, 2), range(1, 12, 2), 100).pose
    pose = posing.solve(plan, goals_of(bodies, places[:, bodies], turns[:, bodies]))
    assert np.degrees(pose_measures.step_turns(pose.turns, 6).max()) < 15.0


def test_a_limb_swivels_as_far_as_its_goal_counts(body: Subject) -> None:
    """So it is where it is carried when its channel has no weight."""
    goals = _goals(body, 7, 10)
    none = Goals(goals.bodies, goals.positions, goals.turns, goals.position_influence.copy(), goals.rotation_influence)
    none.position_influence[:, 1:] = 0.0
    pose, plain = (posing.solve(_plan(body, s), none) for s in (SolverSettings(swivel=60.0), DEFAULT))
    assert quat.angle_between(pose.turns, plain.turns).max() < 1e-9


@pytest.mark.parametrize("angle", [-30.0, 45.0])
def test_an_arm_whose_fingers_have_the_goals_swivels_by_its_hand(angle: float) -> None:
    """The fingers still meet what they met without, to 1 mm."""
    character = analyze(skeleton_of(humanoid(build=Build(fingers=5)), np.random.default_rng(0)))
    body = Subject(character)
    fingers = [character.skeleton.index[name] for name in ("leftIndexDistal", "leftMiddleDistal")]
    elbow = character.skeleton.index["leftLowerArm"]
    goals = _goals(body, 14, 60, fingers)
    plans = [_plan(body, s, fingers) for s in (DEFAULT, _only("leftHand", swivel=angle))]
    assert _names(body, plans[0].ends) == ["leftHand", "leftIndexDistal", "leftMiddleDistal"]
    before, after = (posing.solve(plan, goals).positions for plan in plans)
    assert quat.length(after[:, elbow] - before[:, elbow]).max() > 0.02
    met, still = (quat.length(p[:, fingers] - goals.positions[:, 1:]) < pose_measures.MEET for p in (before, after))
    assert met.mean() > 0.7
    assert still[met].mean() > 0.98


@pytest.mark.parametrize("switch", ["allows_stretch", "avoids_collisions"])
def test_swivelled_limbs_keep_their_ends_whatever_else_is_switched_on(body: Subject, switch: str) -> None:
    goals = _goals(body, 15, 30)
    settings = SolverSettings(swivel=35.0, **{switch: True})
    plain, pose = (posing.solve(_plan(body, s), goals) for s in (replace(settings, swivel=0.0), settings))
    ends = _ends(body)
    assert np.abs(pose.positions[:, ends] - plain.positions[:, ends]).max() < 1e-6 * body.bodies.size


# --- both sides ---


@pytest.mark.parametrize("bends_spine", [False, True])
@pytest.mark.parametrize("name", ["biped", "hound", "beetle", "bird", "asura"])
def test_mirrored_settings_make_the_mirrored_pose(name: str, bends_spine: bool) -> None:
    body = _creatures()[name]
    partner = pose_measures.partners(body)
    assert partner is not None
    rng, goals, ends = np.random.default_rng(8), _goals(body, 8, 30), _ends(body)
    own = {
        end: LimbSettings(
            swivel=rng.uniform(-90.0, 90.0),
            pull=rng.uniform(),
            spine_start=rng.uniform(0.5, 1.0),
            slow_down=rng.uniform(0.6, 0.95),
            full_reach=rng.uniform(0.95, 0.999),
            softness=rng.uniform(0.01, 1.0),
            outer_iterations=i,
        )
        for i, end in enumerate(ends)
    }
    middle = [end for end in ends if partner[end] == end]
    other = {int(partner[end]): replace(s, swivel=-s.swivel) if end in middle else s for end, s in own.items()}
    first, second = (
        SolverSettings(bends_spine=bends_spine, limbs=dict(zip(_names(body, list(s)), s.values(), strict=True)))
        for s in (own, other)
    )
    pose = posing.solve(_plan(body, first), goals)
    again = posing.solve(_plan(body, second), pose_measures.mirrored(goals, partner))
    turns = pose.turns[:, partner] * pose_measures.MIRROR_TURN
    assert quat.angle_between(again.turns, turns).max() < 1e-5


# --- pulling at the spine ---


def _far(body: Subject, seed: int, hands: Sequence[int]) -> Goals:
    """Return goals that hands cannot reach by themselves."""
    goals = _goals(body, seed, 20, hands)
    root = goals.positions[:, :1]
    return goals_of(goals.bodies, root + 1.5 * (goals.positions - root), goals.turns)


def _bend(body: Subject, pose: BodyPose) -> Array:
    """Return how far bodies of the spine turn against the root [degrees], shape (frame,)."""
    spine = [b for b in body.character.spine if b != body.root]
    turns = quat.multiply(quat.conjugate(pose.turns[:, [body.root]]), pose.turns[:, spine])
    return np.degrees(quat.angle_between(turns, quat.IDENTITY)).max(axis=1)


@pytest.mark.parametrize("name", ["biped", "asura"])
def test_the_less_hands_pull_the_less_the_spine_bends(name: str) -> None:
    """At 0 not at all."""
    body = _creatures()[name]
    hands = [hinged.limb.end for hinged in body.limbs if hinged.limb.kind.value == "arm"]
    goals, bends = _far(body, 9, hands), []
    for pull in (0.0, 0.25, 0.5, 0.75, 1.0):
        own = dict.fromkeys(_names(body, hands), LimbSettings(pull=pull))
        settings = SolverSettings(bends_spine=True, limbs=own)
        bends.append(_bend(body, posing.solve(_plan(body, settings, hands), goals)).mean())
    assert bends[0] == pytest.approx(0.0, abs=1e-6)
    assert (np.diff(bends) > 0.02 * bends[-1]).all()


def test_a_hand_that_does_not_pull_leaves_the_spine_to_the_other() -> None:
    """To the bit as if its goal were within its reach, though the hand goes for it."""
    body = _creatures()["biped"]
    hands = [hinged.limb.end for hinged in body.limbs if hinged.limb.kind.value == "arm"]
    goals = _far(body, 10, hands)
    settings = SolverSettings(bends_spine=True, limbs={_names(body, hands[1:])[0]: LimbSettings(pull=0.0)})
    plan = _plan(body, settings, hands)
    near = goals_of(goals.bodies, goals.positions.copy(), goals.turns)
    near.positions[:, 2] = body.bodies.positions[hands[1]]
    pose, other = posing.solve(plan, goals), posing.solve(plan, near)
    spine = [plan.order.index(b) for b in body.character.spine if b in plan.order]
    assert np.array_equal(pose.rotations[:, spine], other.rotations[:, spine])
    assert _bend(body, pose).max() > 5.0


def test_a_limb_that_pulls_later_bends_the_spine_less() -> None:
    body = _creatures()["beetle"]
    goals = _goals(body, 11, 40)
    bends = [
        _bend(body, posing.solve(_plan(body, SolverSettings(bends_spine=True, spine_start=start)), goals)).mean()
        for start in (0.0, 0.8, 0.95)
    ]
    assert (np.diff(bends) < 0.0).all()


# --- how far and how softly ---


def test_a_limb_slows_down_where_it_is_told_and_stretches_as_far_as_it_is_told(body: Subject) -> None:
    goals = _goals(body, 12, 20)
    root = goals.positions[:, :1]
    far = goals_of(goals.bodies, root + 100.0 * (goals.positions - root), goals.turns)
    for reach in (0.9, 0.95, 0.99):
        settings = SolverSettings(slow_down=0.85, full_reach=reach)
        plan = _plan(body, settings)
        pose = posing.solve(plan, far)
        for limb in _limbs(plan):
            if not _is_straight(plan, limb):
                full, _ = _stretched(plan, limb)
                span = quat.length(pose.positions[:, limb.body] - pose.positions[:, limb.joints[0]])
                assert span == pytest.approx(reach * full, rel=2e-3)


def test_extreme_settings_make_poses_without_nan(body: Subject) -> None:
    goals = _goals(body, 13, 20)
    extreme = (
        LimbSettings(180.0, 0.0, 0.0, 0.0, 0.0, 1e-6, 0),
        LimbSettings(-180.0, 1.0, 2.0, 0.5, 0.2, 100.0, 50),
        LimbSettings(1e-12, 1e-12, 1.0, 1.0, 0.999999, 1e-9, 1),
    )
    for own in extreme:
        for bends in (False, True):
            limbs = dict.fromkeys(_names(body, _ends(body)), own)
            pose = posing.solve(_plan(body, SolverSettings(bends_spine=bends, limbs=limbs)), goals)
            assert np.isfinite(pose.positions).all()
            assert np.abs(quat.length(pose.turns) - 1.0).max() < 1e-9
