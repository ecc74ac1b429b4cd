"""Contacts, planted feet, hands, terrain and root motion, on a walk made for the purpose."""

from dataclasses import replace

import numpy as np
import pytest

from morph_retarget.core import contacts, pipeline, quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.character.character import Character
from morph_retarget.core.contacts import ContactSettings, Plant
from morph_retarget.core.mocap.measure import measure
from morph_retarget.core.mocap.plan import Plan, RetargetSettings, prepare
from morph_retarget.core.mocap.root_motion import RootMotion
from morph_retarget.core.skeleton import Pose, pose_from_basis
from tests.skeletons import joints, play, skeleton_of
from tools import gait
from tools.figure import CHIBI, Build, Proportions, humanoid

FPS = 60.0
TARGETS = {
    "half as high": {"height": 0.875},
    "short legs": {"proportions": CHIBI, "height": 1.1},
    "long legs": {"proportions": Proportions(hips=0.58, knee=0.31)},
    "wide hips": {"proportions": Proportions(hip_width=0.09)},
    "no toes": {"build": Build(toes=False)},
}


def _body(seed: int, **options: object) -> Character:
    return analyze(skeleton_of(humanoid(**options), np.random.default_rng(seed)))


@pytest.fixture(scope="module")
def walk() -> tuple[Character, Pose, gait.Walk]:
    source = _body(1)
    made = gait.walk(seconds=3.0, fps=FPS)
    return source, gait.pose(source.skeleton, made), made


def _slide(body: Character, pose: Pose, standing: Array) -> float:
    """Return the most that an ankle moves along the ground from frame to frame while its foot is flat [m]."""
    ankles = joints(body, pose, "leftFoot", "rightFoot")
    steps = np.linalg.norm(np.diff(ankles[..., :2], axis=0), axis=-1)
    return float(steps[standing[1:] & standing[:-1]].max())


def test_plants_of_a_walk_are_found(walk: tuple[Character, Pose, gait.Walk]) -> None:
    source, pose, made = walk
    ankles = joints(source, pose, "leftFoot", "rightFoot")
    found = contacts.find_plants(ankles, 1 / FPS, 0.85, ContactSettings())
    assert found[made.flat].all()
    assert (found & made.on_ground).sum() > 0.95 * found.sum()
    assert len(contacts.plants(found)) == len(contacts.plants(made.flat))


def test_intervals_and_flags_are_two_forms_of_one_thing() -> None:
    flags = np.array([[1, 0], [1, 1], [0, 1], [0, 0], [1, 0]], dtype=bool)
    intervals = contacts.plants(flags)
    assert intervals == [Plant(0, 0, 1), Plant(0, 4, 4), Plant(1, 1, 2)]
    assert (contacts.from_plants(intervals, 5, 2) == flags).all()


@pytest.mark.parametrize("options", TARGETS.values(), ids=TARGETS)
def test_planted_feet_stay(walk: tuple[Character, Pose, gait.Walk], options: dict[str, object]) -> None:
    source, pose, _ = walk
    target = _body(2, **options)
    plan = prepare(source, target)
    result = pipeline.evaluate(plan, pose, 1 / FPS)
    out = play(target, result)
    standing = result.source.steps.ankle
    assert _slide(target, out, standing) < plan.scale * _slide(source, pose, standing) + 0.002
    measures = measure(plan, result.source, result.motion)
    assert measures.penetration < 0.01
    assert measures.jump_target < 1.5 * measures.jump_source
    assert measures.direction.median < 5.0
    # What was measured is what the keys show.
    ankles = joints(target, out, "leftFoot")[:, 0]
    link = plan.links.index("leftFoot")
    assert np.abs(ankles - result.motion.points[:, link]).max() < 1e-6


def test_feet_slide_without_planting_and_by_as_much_as_is_asked(walk: tuple[Character, Pose, gait.Walk]) -> None:
    source, pose, _ = walk
    target = _body(3, proportions=CHIBI, height=1.1)
    # A source that slides: its root drifts sideways under standing feet.
    drift = np.zeros((len(pose), 1, 3))
    drift[:, 0, 0] = np.linspace(0.0, 0.3, len(pose))
    slid = Pose(pose.rotations, pose.positions + drift)
    amounts = []
    for lock in (0.0, 0.5, 1.0):
        settings = RetargetSettings()
        settings = replace(settings, feet=replace(settings.feet, lock=lock))
        plan = prepare(source, target, settings)
        result = pipeline.evaluate(plan, slid, 1 / FPS)
        amounts.append(measure(plan, result.source, result.motion).slide_target)
    assert amounts[0] > amounts[1] > amounts[2]
    assert amounts[2] < 0.01


def _run_on_the_spot(body: Character, fps: float, begins: float) -> Pose:
    """Return strides with hips that keep their place: feet are slow only where they turn back, high in the air.

    Args:
        body: A figure whose bones have the world's axes.
        fps: Frames a second.
        begins: Where in a stride the clip begins, 0 to 1.
    """
    phase = 2.0 * np.pi * (begins + np.arange(round(2.0 * fps)) / (1.2 * fps))
    bends = np.zeros((len(phase), len(body.skeleton), 3))
    for side, shift in (("left", 0.0), ("right", np.pi)):
        bends[:, body.skeleton.index[f"{side}UpperLeg"], 0] = -np.sin(phase + shift)
        bends[:, body.skeleton.index[f"{side}LowerLeg"], 0] = 0.6
    return pose_from_basis(body.skeleton, quat.from_rotation_vector(bends), np.zeros_like(bends))


@pytest.mark.parametrize("fps", [24.0, 30.0, 60.0])
@pytest.mark.parametrize("begins", [0.0, 0.25, 0.4, 0.75])
def test_a_run_on_the_spot_comes_down_to_the_floor(fps: float, begins: float) -> None:
    body = analyze(skeleton_of(humanoid()))
    pose = _run_on_the_spot(body, fps, begins)
    out = play(body, pipeline.evaluate(prepare(body, body), pose, 1 / fps))
    lowest = joints(body, out, "leftFoot", "rightFoot")[..., 2].min(axis=0)
    at_rest = body.skeleton.rest_positions[[body.skeleton.index["leftFoot"], body.skeleton.index["rightFoot"]], 2]
    np.testing.assert_allclose(lowest, at_rest, atol=0.03 * body.frame.height)


def test_users_plants_replace_those_found(walk: tuple[Character, Pose, gait.Walk]) -> None:
    source, pose, _ = walk
    plan = prepare(source, _body(4))
    none = pipeline.evaluate(plan, pose, 1 / FPS, standing=np.zeros((len(pose), 2), dtype=bool))
    assert not none.source.steps.standing.any()
    own = contacts.from_plants([Plant(0, 10, 40)], len(pose), 2)
    given = pipeline.evaluate(plan, pose, 1 / FPS, standing=own)
    assert (given.source.steps.standing == own).all()


def test_the_worst_jump_is_not_made_by_planting(walk: tuple[Character, Pose, gait.Walk]) -> None:
    source, pose, _ = walk
    target = _body(5, proportions=CHIBI)
    plan = prepare(source, target)
    result = pipeline.evaluate(plan, pose, 1 / FPS)
    turns = result.basis
    step = np.degrees(quat.angle_between(turns[1:], turns[:-1]))
    assert step.max() < 25.0


def _slope(points: Array) -> Array:
    return 0.1 * points[:, 1]


def _stairs(points: Array) -> Array:
    return 0.08 * np.floor(-points[:, 1] / 0.35)


@pytest.mark.parametrize("ground", [_slope, _stairs])
def test_feet_follow_the_terrain(walk: tuple[Character, Pose, gait.Walk], ground: object) -> None:
    source, pose, _ = walk
    target = _body(6)
    plan = prepare(source, target)
    result = pipeline.evaluate(plan, pose, 1 / FPS, ground=ground)
    out = play(target, result)
    ankles = joints(target, out, "leftFoot", "rightFoot")
    flat = joints(target, play(target, pipeline.evaluate(plan, pose, 1 / FPS)), "leftFoot", "rightFoot")
    for foot in (0, 1):
        for first, last in contacts.runs(result.source.steps.ankle[:, foot]):
            middle = slice(first + 2, last - 1)
            if last - first < 6:
                continue
            rise = ankles[middle, foot, 2] - flat[middle, foot, 2]
            assert np.abs(rise - ground(ankles[middle, foot])).max() < 0.02
            assert np.ptp(ankles[middle, foot, :2], axis=0).max() < 0.01
    # In flight the foot does not fall from one step to the next.
    assert np.abs(np.diff(ankles[..., 2], axis=0)).max() < 0.1


def test_where_there_is_no_terrain_feet_stand_on_the_floor(walk: tuple[Character, Pose, gait.Walk]) -> None:
    source, pose, _ = walk
    plan = prepare(source, _body(6))
    flat = pipeline.evaluate(plan, pose, 1 / FPS, ground=lambda points: np.zeros(len(points)))
    nowhere = pipeline.evaluate(plan, pose, 1 / FPS, ground=lambda points: np.full(len(points), np.nan))
    assert (nowhere.basis == flat.basis).all()
    assert (nowhere.shifts == flat.shifts).all()
    # A hole under a part of the way is as deep as the floor, and leaves no hole in the motion.
    holed = pipeline.evaluate(plan, pose, 1 / FPS, ground=lambda at: np.where(at[:, 0] > 0.0, 0.05, np.nan))
    filled = pipeline.evaluate(plan, pose, 1 / FPS, ground=lambda at: np.where(at[:, 0] > 0.0, 0.05, 0.0))
    assert np.isfinite(holed.basis).all()
    assert (holed.basis == filled.basis).all()


def test_hands_reach_the_sources_places(walk: tuple[Character, Pose, gait.Walk]) -> None:
    source, pose, _ = walk
    target = _body(7, proportions=Proportions(upper_arm=0.2, lower_arm=0.18))
    plan = prepare(source, target, RetargetSettings(reach_hands=True))
    out = play(target, pipeline.evaluate(plan, pose, 1 / FPS))
    apart = joints(target, out, "leftHand", "rightHand") - plan.scale * joints(source, pose, "leftHand", "rightHand")
    assert np.linalg.norm(apart, axis=-1).max() < 0.03
    free = play(target, pipeline.evaluate(prepare(source, target), pose, 1 / FPS))
    apart = joints(target, free, "leftHand", "rightHand") - plan.scale * joints(source, pose, "leftHand", "rightHand")
    assert np.linalg.norm(apart, axis=-1).max() > 0.05


@pytest.mark.parametrize("kind", [RootMotion.ROOT_BONE, RootMotion.OBJECT])
def test_travel_and_what_is_left_make_the_whole_motion(
    walk: tuple[Character, Pose, gait.Walk], kind: RootMotion
) -> None:
    source, pose, _ = walk
    target = _body(8)
    whole = pipeline.evaluate(prepare(source, target), pose, 1 / FPS)
    split = pipeline.evaluate(prepare(source, target, RetargetSettings(root_motion=kind)), pose, 1 / FPS)
    assert split.travel is not None
    hips = joints(target, play(target, split), "hips")[:, 0]
    pivot = target.local_to_character.points(target.skeleton.rest_positions[target.bone("hips")]) * [1, 1, 0]
    again = pivot + split.travel.points + quat.rotate(split.travel.turns, hips - pivot)
    assert np.abs(again - joints(target, play(target, whole), "hips")[:, 0]).max() < 1e-6
    assert np.abs(np.ptp(hips[:, :2], axis=0)).max() < 0.1


def test_in_place_takes_the_travel_out(walk: tuple[Character, Pose, gait.Walk]) -> None:
    source, pose, made = walk
    target = _body(9)
    out = pipeline.evaluate(prepare(source, target, RetargetSettings(root_motion=RootMotion.IN_PLACE)), pose, 1 / FPS)
    hips = joints(target, play(target, out), "hips")[:, 0]
    assert np.abs(np.ptp(hips[:, 1])) < 0.1 < made.distance


def test_a_loop_keeps_its_offset(walk: tuple[Character, Pose, gait.Walk]) -> None:
    """The last pose is the first one moved on: so it must be on the target, travel included."""
    source, pose, made = walk
    cycle = round(made.cycle_seconds * FPS)
    looped = Pose(pose.rotations[: cycle + 1], pose.positions[: cycle + 1])
    target = _body(10, height=0.875)
    plan = prepare(source, target, RetargetSettings(plant_feet=False))
    out = play(target, pipeline.evaluate(plan, looped, 1 / FPS))
    assert quat.angle_between(out.rotations[0], out.rotations[-1]).max() < 1e-6
    theirs = looped.positions[-1, 0] - looped.positions[0, 0]
    ours = joints(target, out, "hips")[:, 0]
    assert np.abs(ours[-1] - ours[0] - plan.scale * source.local_to_character.directions(theirs)).max() < 1e-6


def test_a_clip_of_one_frame_is_a_pose(walk: tuple[Character, Pose, gait.Walk]) -> None:
    source, pose, _ = walk
    plan: Plan = prepare(source, _body(11))
    single = pipeline.evaluate(plan, Pose(pose.rotations[:1], pose.positions[:1]), 1 / FPS)
    assert len(single.basis) == 1
    assert measure(plan, single.source, single.motion).jump_target == 0.0
