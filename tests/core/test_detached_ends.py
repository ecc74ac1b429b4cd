"""Feet and hands that do not hang on their limbs: limbs bring them to their goals all the same."""

from dataclasses import dataclass, replace
from functools import cache, cached_property
from pathlib import Path

import numpy as np
import pytest

from morph_retarget.core import long_clip, play, quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.character.character import Character
from morph_retarget.core.character.frame import Placement
from morph_retarget.core.character.morphology import Capability, Limb, LimbKind
from morph_retarget.core.layering import Layer
from morph_retarget.core.morph.bind import GeneralizedAction, bind
from morph_retarget.core.morph.bodies import Bodies
from morph_retarget.core.morph.channels import Values
from morph_retarget.core.play import Part, Played
from morph_retarget.core.solve import detached, posing
from morph_retarget.core.solve.goals import Goals
from morph_retarget.core.solve.limits import JointLimits, swing_and_twist
from morph_retarget.core.solve.settings import SolverSettings
from tests import goal_sets, pose_measures
from tests.goal_sets import HUMAN, Subject, goals_of, rows
from tests.skeletons import skeleton_of
from tools.figure import Bone, Build, humanoid, moved

RIGS = ("quaternius_cyberpunk_ikfeet", "quaternius_frog", "quaternius_trex")
"""Two feet that hang beside the body, the front feet of four, and two with knees and hocks."""
FIGURES = ("figure", "turned figure")
TURNED = Placement(
    quat.to_matrix(quat.from_rotation_vector(np.array([np.pi / 2, 0.0, 0.3]))), 0.01, np.array([2.0, 1.0, 0.0])
)
"""A turned object in centimetres."""
ENDS = ("leftFoot", "rightFoot", "leftHand", "rightHand")
EXACT = 1e-6
"""Goals in reach are met to this share of the character's size."""
APART = 1e-3
"""In reach, the end of a human's limb is as near to its foot as this [m]."""
LITTLE = 0.01
"""What a foot leaves the end of its limb by at most, as a share of the limb's length."""
NEAR, FAR = 0.3, 0.97
"""What is in reach of a limb, as shares of its length; beyond it slows down."""


# --- characters ---


def _figure(*detached: str, placement: Placement | None = None) -> Character:
    """Return a humanoid of which some bones hang on the one below the hips."""
    bones = humanoid(build=Build(fingers=2, root=True))
    bones = [replace(bone, parent="root") if bone.name in detached else bone for bone in bones]
    if placement is not None:
        inverse, back = placement.inverse(), np.eye(4)
        back[:3, :3], back[:3, 3] = inverse.scale * inverse.rotation, inverse.translation
        bones = moved(bones, back)
    return analyze(skeleton_of(bones, np.random.default_rng(0)), placement)


@dataclass(frozen=True, eq=False)
class Loose:
    """A character with feet or hands that do not hang on their limbs."""

    subject: Subject

    @property
    def character(self) -> Character:
        """What the rig is."""
        return self.subject.character

    @property
    def rest(self) -> Array:
        """Places of all bodies at rest [m], shape (body, 3)."""
        return self.subject.bodies.positions

    @cached_property
    def limbs(self) -> list[Limb]:
        """Those whose ends do not hang on them."""
        tree = self.character.skeleton.tree
        return [limb for limb in self.character.limbs if not tree.is_below(limb.bones[-2], limb.end)]

    @cached_property
    def root(self) -> int:
        """What carries all of these limbs: of one rig, they hang beside the hips."""
        found = self.character.skeleton.tree.meeting([self.subject.root, *(limb.bones[0] for limb in self.limbs)])
        assert found is not None
        return found

    @cached_property
    def wanted(self) -> list[tuple[int, bool, bool]]:
        """Goals for the root and for these ends."""
        return [(self.root, True, True), *((limb.end, True, True) for limb in self.limbs)]

    @cached_property
    def plan(self) -> posing.Plan:
        """How these are met."""
        return posing.prepare(self.character, self.rest, self.root, self.wanted)

    def part(self, settings: SolverSettings | None = None, limits: JointLimits | None = None) -> Part:
        """Return the same, to be played under an action that does nothing."""
        binding = bind(GeneralizedAction("Nothing", ()), self.subject.bodies)
        return play.prepare(self.character, binding, settings or SolverSettings(), limits, lower=self.wanted)

    def length(self, limb: Limb) -> float:
        """Return the length of a limb's joints that bend [m]."""
        joints = next(own.joints for wave in self.plan.waves for own in wave.limbs if own.body == limb.end)
        return float(quat.length(np.diff(self.rest[[*joints, limb.end]], axis=0)).sum())

    def goals(self, count: int = 200, near: float = NEAR, far: float = FAR, seed: int = 0) -> Goals:
        """Return goals for the root and, all around where limbs start then, for their ends."""
        rng, rest = np.random.default_rng(seed), self.rest
        places = np.empty((count, len(self.wanted), 3))
        turns = quat.from_rotation_vector(rng.uniform(-0.5, 0.5, (count, len(self.wanted), 3)))
        places[:, 0] = rest[self.root] + rng.uniform(-0.3, 0.3, (count, 3)) * self.subject.bodies.size
        for i, limb in enumerate(self.limbs, 1):
            first = self.plan.joints_of(limb.end)[0]
            start = places[:, 0] + quat.rotate(turns[:, 0], rest[first] - rest[self.root])
            ways = quat.unit(rng.normal(size=(count, 3)))
            places[:, i] = start + self.length(limb) * rng.uniform(near, far, (count, 1)) * ways
        return goals_of(np.array([body for body, _, _ in self.wanted]), places, turns)

    def apart(self, limb: Limb, places: Array, turns: Array) -> Array:
        """Return how far an end is from where its limb would carry it, as if it were a human's [m], shape (frame,)."""
        above = limb.bones[-2]
        carried = places[:, above] + quat.rotate(turns[:, above], self.rest[limb.end] - self.rest[above])
        return quat.length(places[:, limb.end] - carried) * HUMAN / self.character.frame.height


@cache
def _figures(name: str) -> Loose:
    return Loose(Subject(_figure(*ENDS, placement=TURNED if name == "turned figure" else None)))


@cache
def _rigs(data: Path) -> dict[str, Loose]:
    return {name: Loose(Subject(character)) for name, character in goal_sets.real(data, RIGS).items()}


@pytest.fixture(params=(*RIGS, *FIGURES))
def loose(request: pytest.FixtureRequest) -> Loose:
    """Return each of the characters."""
    name: str = request.param
    return _figures(name) if name in FIGURES else _rigs(request.getfixturevalue("data"))[name]


def _played(part: Part, goals: Goals) -> Played:
    return play.evaluate(part, _nothing(len(goals)), {}, _layer(goals))


def _nothing(frames: int) -> Values:
    """Return values of no channels."""
    return Values(np.zeros((frames, 0, 3)), quat.identity(frames, 0), np.zeros((frames, 0)))


def _layer(goals: Goals) -> Layer:
    return Layer(goals, np.zeros((len(goals), 3)), quat.identity(len(goals)))


# --- what is written ---


def test_the_characters_are_what_they_are_meant_to_be(loose: Loose) -> None:
    assert loose.limbs
    assert set(loose.plan.detached) == {limb.end for limb in loose.limbs}
    assert not loose.plan.unreachable


def test_feet_come_to_their_goals_and_limbs_to_their_feet(loose: Loose) -> None:
    """By forward kinematics from the rotations and locations that are written."""
    goals = loose.goals()
    played = _played(loose.part(), goals)
    places, turns = pose_measures.written(loose.character, played)
    size = loose.subject.bodies.size
    assert quat.length(places[:, goals.bodies] - goals.positions).max() < EXACT * size
    assert quat.angle_between(turns[:, goals.bodies], goals.turns).max() < 1e-6
    for limb in loose.limbs:
        assert loose.apart(limb, places, turns).max() < APART
    assert np.abs(places - played.pose.positions).max() < EXACT * size


def test_no_bone_of_a_limb_changes_its_length(loose: Loose) -> None:
    for far in (FAR, 3.0):
        places, _ = pose_measures.written(loose.character, _played(loose.part(), loose.goals(far=far)))
        for limb in loose.limbs:
            line = list(limb.bones[:-1])
            lengths = quat.length(np.diff(places[:, line], axis=1))
            assert np.abs(lengths - quat.length(np.diff(loose.rest[line], axis=0))).max() < 1e-9 * loose.length(limb)


def test_a_limb_that_cannot_reach_keeps_its_foot(loose: Loose) -> None:
    """But for what it slows down by: the foot has its goal up to the limb's own length."""
    goals = loose.goals(near=FAR, far=1.0)
    pose = posing.solve(loose.plan, goals)
    assert quat.length(pose.positions[:, goals.bodies] - goals.positions).max() < EXACT * loose.subject.bodies.size
    pose = posing.solve(loose.plan, loose.goals(near=1.0, far=30.0))
    for limb in loose.limbs:
        most = (1.0 + 1e-6) * LITTLE * loose.length(limb) * HUMAN / loose.character.frame.height
        assert loose.apart(limb, pose.positions, pose.turns).max() <= most


def test_limbs_stretch_to_goals_beyond_their_lengths_if_they_may(loose: Loose) -> None:
    goals = loose.goals(near=1.02, far=1.15)
    played = _played(loose.part(SolverSettings(allows_stretch=True)), goals)
    places, _ = pose_measures.written(loose.character, played)
    assert quat.length(places[:, goals.bodies] - goals.positions).max() < EXACT * loose.subject.bodies.size
    for limb in loose.limbs:
        shin = list(limb.bones[-2:])
        lengths = quat.length(np.diff(places[:, shin], axis=1)[:, 0])
        assert (lengths / quat.length(np.diff(loose.rest[shin], axis=0)[0])).min() > 1.01


def test_rest_stays_rest(loose: Loose) -> None:
    bodies, part, size = np.array([body for body, _, _ in loose.wanted]), loose.part(), loose.subject.bodies.size
    rest = loose.rest[None, bodies].repeat(2, axis=0)
    for influence in (0.0, 1.0):
        shares = np.full(rest.shape[:2], influence)
        played = _played(part, Goals(bodies, rest, quat.identity(*rest.shape[:2]), shares, shares))
        assert played.stretched is not None
        assert set(played.stretched.bones.tolist()) <= set(played.bones.tolist())
        assert np.abs(played.stretched.shifts).max() < 1e-9 * size / loose.character.placement.scale
        assert quat.angle_between(played.basis, quat.IDENTITY).max() < 1e-6
        assert np.abs(pose_measures.written(loose.character, played)[0] - loose.rest).max() < 1e-9 * size


def test_feet_that_nobody_poses_go_with_their_limbs(loose: Loose) -> None:
    """Where the body goes, and with half a goal half the way."""
    goals = loose.goals()
    shares = np.zeros(goals.positions.shape[:2])
    shares[:, 0] = 1.0
    left = Goals(goals.bodies, goals.positions, goals.turns, shares, shares)
    root_alone = goals_of(goals.bodies[:1], goals.positions[:, :1], goals.turns[:, :1])
    plan = posing.prepare(loose.character, loose.rest, loose.root, [(loose.root, True, True)])
    for pose in (posing.solve(loose.plan, left), posing.solve(plan, root_alone)):
        for limb in loose.limbs:
            away = loose.rest[limb.end] - loose.rest[loose.root]
            carried = goals.positions[:, 0] + quat.rotate(goals.turns[:, 0], away)
            assert quat.length(pose.positions[:, limb.end] - carried).max() < EXACT * loose.subject.bodies.size
            assert quat.angle_between(pose.turns[:, limb.end], goals.turns[:, 0]).max() < 1e-6
    shares[:, 1:] = 0.5
    pose = posing.solve(loose.plan, left)
    for i, limb in enumerate(loose.limbs, 1):
        away = loose.rest[limb.end] - loose.rest[loose.root]
        carried = goals.positions[:, 0] + quat.rotate(goals.turns[:, 0], away)
        half = 0.5 * (carried + goals.positions[:, i])
        within = quat.length(half - pose.positions[:, limb.bones[0]]) > NEAR * loose.length(limb)
        missed = quat.length(pose.positions[:, limb.end] - half)[within]
        assert missed.max() < EXACT * loose.subject.bodies.size


def test_a_moved_and_turned_body_has_the_same_pose(loose: Loose) -> None:
    goals, rng = loose.goals(40), np.random.default_rng(9)
    turn, shift = quat.normalize(rng.normal(size=4)), rng.uniform(-3.0, 3.0, 3) * loose.subject.scale
    there = goals_of(goals.bodies, quat.rotate(turn, goals.positions) + shift, quat.multiply(turn, goals.turns))
    pose, again = posing.solve(loose.plan, goals), posing.solve(loose.plan, there)
    own = [bone for limb in loose.limbs for bone in limb.bones]
    away = quat.length(again.positions[:, own] - quat.rotate(turn, pose.positions[:, own]) - shift)
    assert away.max() < EXACT * loose.subject.bodies.size
    assert quat.angle_between(again.turns[:, own], quat.multiply(turn, pose.turns[:, own])).max() < 1e-6


def test_frames_are_the_same_alone_and_in_a_clip_of_any_length(loose: Loose) -> None:
    goals, part = loose.goals(long_clip.BLOCK + 20), loose.part()
    whole = _played(part, goals)
    assert whole.stretched is not None
    size = loose.subject.bodies.size / loose.character.placement.scale
    for frame in range(0, len(goals), 60):
        alone = _played(part, rows(goals, slice(frame, frame + 1)))
        assert alone.stretched is not None
        assert quat.angle_between(alone.basis, whole.basis[[frame]]).max() < 1e-6
        assert np.abs(alone.stretched.shifts - whole.stretched.shifts[[frame]]).max() < 1e-9 * size
    steps = long_clip.evaluate(part, _nothing(len(goals)), {}, _layer(goals))
    try:
        while True:
            next(steps)
    except StopIteration as done:
        long: Played = done.value
    assert long.stretched is not None
    assert np.array_equal(long.stretched.shifts, whole.stretched.shifts)


# --- against one whose feet and hands hang on its limbs ---


@pytest.mark.parametrize(
    "settings",
    [
        SolverSettings(),
        SolverSettings(bends_spine=True),
        SolverSettings(bends_spine=True, nudge=0.1, avoids_collisions=True),
        SolverSettings(allows_stretch=True),
    ],
    ids=["plain", "spine", "all", "stretch"],
)
@pytest.mark.parametrize("fingers", [False, True])
def test_the_pose_is_that_of_a_body_whose_hands_hang_on_its_arms(settings: SolverSettings, fingers: bool) -> None:
    """But for the little by which hands and feet come nearer to their goals."""
    whole, loose = Subject(_figure()), Subject(_figure(*ENDS))
    goals = goal_sets.random_sets(whole, np.random.default_rng(1), 100).goals
    if fingers:  # branches of stems that end with hands
        index = whole.character.skeleton.index
        tips = [index[side + tip] for side in ("left", "right") for tip in ("ThumbDistal", "IndexDistal")]
        places = goal_sets.random_sets(whole, np.random.default_rng(1), 100).pose[0][:, tips]
        goals = goals_of(np.array(tips), places, quat.identity(*places.shape[:2]))
    wanted = [(body, True, not fingers) for body in goals.bodies.tolist()]
    pose, other = (
        posing.solve(posing.prepare(own.character, own.bodies.positions, own.root, wanted, settings), goals)
        for own in (loose, whole)
    )
    away = quat.length(pose.positions - other.positions).max(axis=0)
    ends = {loose.character.skeleton.index[name] for name in ENDS}
    beyond = [b for b in range(len(away)) if ends.intersection((b, *whole.bodies.tree.ancestors[b]))]
    rest = [body for body in range(len(away)) if body not in beyond]
    assert away[rest].max() < 1e-9
    assert away[beyond].max() < (1e-9 if fingers else LITTLE)
    assert quat.angle_between(pose.turns, other.turns).max() < 1e-6


def test_a_foot_keeps_within_the_limits_that_it_has_against_what_it_hangs_on() -> None:
    """That is what Blender counts them from."""
    loose = _figures("figure")
    count = len(loose.character.skeleton)
    free, feet = JointLimits.free(count), [limb.end for limb in loose.limbs]
    least, most = free.least.copy(), free.most.copy()
    least[feet], most[feet] = -0.2, 0.2
    limits, goals = JointLimits(least, most), loose.goals()
    played = _played(loose.part(limits=limits), goals)
    places = [played.bones.tolist().index(foot) for foot in feet]
    told = swing_and_twist(played.basis[:, places])
    assert np.abs(limits[np.array(feet)].nearest(told) - told).max() < 1e-6
    found, _ = pose_measures.written(loose.character, played)
    assert quat.length(found[:, goals.bodies] - goals.positions).max() < EXACT * loose.subject.bodies.size


# --- what stays where it hangs ---


def test_a_foot_that_cannot_move_stays_where_it_hangs() -> None:
    loose = _figures("figure")
    foot = loose.character.skeleton.index["leftFoot"]
    plan = posing.prepare(loose.character, loose.rest, loose.root, loose.wanted, fixed=(foot,))
    assert foot not in plan.detached
    assert plan.unreachable == (foot,)
    pose = posing.solve(plan, loose.goals(10))
    assert quat.length(pose.positions[:, foot] - loose.rest[foot]).max() < 1e-9


def test_thighs_that_cannot_move_and_legs_without_knees_stay_where_they_hang() -> None:
    """Nothing could make up for what the hips do."""
    whole = _figure("leftUpperLeg", "rightUpperLeg")
    hips, thigh = whole.skeleton.index["hips"], whole.skeleton.index["leftUpperLeg"]
    assert detached.carried(whole, hips).parents[thigh] == hips
    assert detached.carried(whole, hips, fixed=(thigh,)).parents[thigh] == whole.skeleton.index["root"]
    stiff = replace(whole, limbs=tuple(replace(limb, bones=limb.bones[-2:]) for limb in whole.legs))
    assert detached.carried(stiff, hips) is whole.skeleton.tree


def test_feet_without_a_parent_are_brought_to_their_goals() -> None:
    whole = _figure(*ENDS)
    index, parents = whole.skeleton.index, whole.skeleton.parents.copy()
    parents[[index["leftFoot"], index["rightFoot"]]] = -1
    character = replace(whole, skeleton=replace(whole.skeleton, parents=parents))
    loose = Loose(Subject(character))
    goals = loose.goals()
    places, _ = pose_measures.written(character, _played(loose.part(), goals))
    assert quat.length(places[:, goals.bodies] - goals.positions).max() < EXACT * loose.subject.bodies.size


@pytest.mark.parametrize("parts", [("LowerLeg", "LowerArm"), ("UpperLeg",)])
def test_shins_and_thighs_that_hang_on_the_root_are_brought_along(parts: tuple[str, ...]) -> None:
    """With the feet that hang on them: some rigs have an ankle for their inverse kinematics, and a foot beyond it.

    Thighs hang beside the hips there, and yet the hips take them along.
    """
    whole, rng = Subject(_figure()), np.random.default_rng(1)
    index, parents = whole.character.skeleton.index, whole.character.skeleton.parents.copy()
    loose = [index[side + part] for side in ("left", "right") for part in parts]
    parents[loose] = index["root"]
    character = replace(whole.character, skeleton=replace(whole.character.skeleton, parents=parents))
    goals = goal_sets.random_sets(whole, rng, 60).goals
    wanted = [(body, True, True) for body in goals.bodies.tolist()]
    part = play.prepare(character, bind(GeneralizedAction("Nothing", ()), whole.bodies), lower=wanted)
    assert set(part.pose.detached) == set(loose)
    places, turns = pose_measures.written(character, _played(part, goals))
    pose = posing.solve(posing.prepare(whole.character, whole.bodies.positions, whole.root, wanted), goals)
    assert np.abs(places - pose.positions).max() < 1e-9
    assert quat.angle_between(turns, pose.turns).max() < 1e-6


def test_shins_that_hang_on_their_feet_and_hands_that_hang_on_feet_are_left_alone() -> None:
    """A foot cannot be carried by what it carries, and what hangs on a limb is carried by that."""
    names = ["root", "hips", "thigh", "foot", "shin", "arm", "hand"]
    parents = [None, "root", "hips", "root", "foot", "hips", "foot"]
    places = [(0, 0, 0), (0, 0, 1), (0, 0, 0.9), (0, 0, 0.1), (0, 0, 0.5), (0.2, 0, 1.4), (0.7, 0, 1.4)]
    bones = [Bone(name, above, at, at) for name, above, at in zip(names, parents, places, strict=True)]
    skeleton = skeleton_of(bones)
    leg = Limb(LimbKind.LEG, 0, 0, tuple(skeleton.index[name] for name in ("thigh", "shin", "foot")))
    arm = Limb(LimbKind.ARM, 1, 0, tuple(skeleton.index[name] for name in ("arm", "hand")))
    character = replace(_figure(), skeleton=skeleton, limbs=(arm, leg))
    assert detached.carried(character, skeleton.index["hips"]) is skeleton.tree


def test_an_arm_whose_halves_hang_on_one_control_makes_no_ring() -> None:
    names, parents = ["hips", "torso", "arm", "grip", "forearm"], [None, None, "torso", "torso", "grip"]
    places = [(0, 0, 1), (0, 0, 1.2), (0.2, 0, 1.4), (0.5, 0, 1.4), (0.5, 0, 1.4)]
    bones = [Bone(name, above, at, at) for name, above, at in zip(names, parents, places, strict=True)]
    skeleton = skeleton_of(bones)
    arm = Limb(LimbKind.ARM, 1, 0, (skeleton.index["arm"], skeleton.index["forearm"]))
    body = replace(_figure(), skeleton=skeleton, limbs=(arm,), spine=(skeleton.index["hips"],), neck=(), head=None)
    own = detached.carried(body, skeleton.index["hips"])
    assert sorted(own.order) == list(range(len(bones)))
    assert own.path(skeleton.index["arm"], skeleton.index["forearm"]) == [
        skeleton.index[n] for n in ("arm", "grip", "forearm")
    ]


def test_bodies_above_the_root_stay_where_they_hang() -> None:
    whole = _figure(*ENDS)
    foot = whole.skeleton.index["leftFoot"]
    assert detached.carried(whole, foot).parents[foot] == whole.skeleton.parents[foot]


def test_other_rigs_are_solved_as_they_hang(data: Path) -> None:
    for name, character in goal_sets.real(data, ("m2m_human", "m2m_fox", "sketchbook_boxman")).items():
        root = Bodies.of(character).with_capability(Capability.ROOT)[0]
        assert detached.carried(character, root) is character.skeleton.tree, name
