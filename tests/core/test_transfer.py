"""Transfer of rotations (Feng 2013 §4.1, §5.1): the equations, and what must hold for any pair of bodies."""

from dataclasses import replace

import numpy as np
import pytest

from morph_retarget.core import pipeline, quat
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.character.character import Character
from morph_retarget.core.character.frame import Placement
from morph_retarget.core.errors import MappingError, RigError
from morph_retarget.core.mocap import transfer
from morph_retarget.core.mocap.measure import measure
from morph_retarget.core.mocap.plan import Matching, ReferencePose, RetargetSettings, prepare
from morph_retarget.core.skeleton import Pose, pose_from_basis
from tests.skeletons import joints, play, skeleton_of, wild
from tools.figure import CHIBI, Bone, Build, humanoid, moved

FREE = RetargetSettings(plant_feet=False)
_SEGMENTS = [
    (f"{side}{a}", f"{side}{b}")
    for side in ("left", "right")
    for a, b in (("UpperArm", "LowerArm"), ("LowerArm", "Hand"), ("UpperLeg", "LowerLeg"), ("LowerLeg", "Foot"))
]


def _figure(seed: int, placement: Placement | None = None, **options: object) -> Character:
    """Return a figure whose bones have random axes."""
    build = options.pop("build", Build(fingers=2))
    bones = humanoid(build=build, **options)
    if placement is not None:
        back = np.eye(4)
        inverse = placement.inverse()
        back[:3, :3], back[:3, 3] = inverse.scale * inverse.rotation, inverse.translation
        bones = moved(bones, back)
    return analyze(skeleton_of(bones, np.random.default_rng(seed)), placement)


def _given(source: Character, target: Character, pose: Pose, settings: RetargetSettings = FREE) -> Pose:
    return play(target, pipeline.evaluate(prepare(source, target, settings), pose, 1 / 30))


def _directions(character: Character, pose: Pose) -> np.ndarray:
    ends = joints(character, pose, *(j for segment in _SEGMENTS for j in segment))
    return quat.unit(ends[:, 1::2] - ends[:, ::2])


def test_a_rig_given_its_own_motion_moves_as_before() -> None:
    body = _figure(1)
    pose = wild(body.skeleton, 40, np.random.default_rng(2))
    again = _given(body, body, pose)
    assert np.abs(again.positions - pose.positions).max() < 1e-6
    assert quat.angle_between(again.rotations, pose.rotations).max() < 1e-6


def test_feet_that_hang_on_bones_of_their_own_go_along_with_these() -> None:
    bones = humanoid(build=Build(fingers=2, root=True))
    feet = {bone.name: bone for bone in bones if bone.name in ("leftFoot", "rightFoot")}
    apart = [Bone(f"ik {name}", None, foot.head, foot.tail) for name, foot in feet.items()]
    bones = [replace(bone, parent=f"ik {bone.name}") if bone.name in feet else bone for bone in (*apart, *bones)]
    target = analyze(skeleton_of(bones, np.random.default_rng(7)))
    source = _figure(8)
    for settings in (FREE, RetargetSettings()):
        pose = _given(source, target, wild(source.skeleton, 40, np.random.default_rng(9)), settings)
        index = target.skeleton.index
        for name in feet:
            knee = index[name.replace("Foot", "LowerLeg")]
            shin = np.linalg.norm(pose.positions[:, index[name]] - pose.positions[:, knee], axis=-1)
            assert np.ptp(shin) < 1e-6, "the foot stays at its leg"
            gap = np.linalg.norm(pose.positions[:, index[name]] - pose.positions[:, index[f"ik {name}"]], axis=-1)
            assert gap.max() < 1e-6, "and what it hangs on, at the foot"


def test_from_a_to_b_and_back_is_the_same_motion() -> None:
    a, b = _figure(3), _figure(4, height=1.2, proportions=CHIBI, build=Build(fingers=2, arms_down=40.0))
    pose = wild(a.skeleton, 40, np.random.default_rng(5))
    back = _given(b, a, _given(a, b, pose))
    assert quat.angle_between(back.rotations, pose.rotations).max() < 1e-6
    assert np.abs(back.positions - pose.positions).max() < 1e-6


TURNED = Placement(
    quat.to_matrix(quat.from_rotation_vector(np.array([np.pi / 2, 0, 0]))), 0.01, np.array([2.0, 1.0, 0])
)
TARGETS = {
    "other proportions": {"proportions": CHIBI, "height": 1.1},
    "an A-pose": {"build": Build(arms_down=50.0)},
    "another spine": {"build": Build(spine=5, neck=2)},
    "hardly any spine": {"build": Build(spine=1, neck=0, clavicles=False, toes=False)},
    "twist bones": {"build": Build(twists=3)},
    "a turned object in centimetres": {"placement": TURNED},
}


@pytest.mark.parametrize("options", TARGETS.values(), ids=TARGETS)
def test_limbs_point_where_the_sources_point(options: dict[str, object]) -> None:
    source, target = _figure(6), _figure(7, **options)
    pose = wild(source.skeleton, 30, np.random.default_rng(8))
    apart = _directions(target, _given(source, target, pose)) - _directions(source, pose)
    assert np.degrees(np.linalg.norm(apart, axis=-1).max()) < 1e-4


@pytest.mark.parametrize("placement", [TURNED, Placement(np.diag([-1.0, 1.0, 1.0]), 2.0, np.zeros(3))])
def test_the_sources_object_may_be_turned_scaled_and_mirrored(placement: Placement) -> None:
    source, target = _figure(9, placement), _figure(10)
    pose = wild(source.skeleton, 20, np.random.default_rng(11))
    apart = _directions(target, _given(source, target, pose)) - _directions(source, pose)
    assert np.degrees(np.linalg.norm(apart, axis=-1).max()) < 1e-4


def test_bone_axes_do_not_matter() -> None:
    source = _figure(12)
    pose = wild(source.skeleton, 20, np.random.default_rng(13))
    a, b = _figure(14), _figure(15)
    assert np.abs(_given(source, a, pose).positions - _given(source, b, pose).positions).max() < 1e-9


def test_the_rotations_before_and_after_are_the_papers() -> None:
    """Eq 1 gives the parent's alignment times the joint's local rotation, eq 2 takes it into the target's own frame."""
    source, target = _figure(16), _figure(17, build=Build(arms_down=35.0, fingers=2))
    plan = prepare(source, target, FREE)
    pose = wild(source.skeleton, 5, np.random.default_rng(18))
    motion = pipeline.SourceMotion.read(plan, pose, 1 / 30, None)
    links = np.arange(len(plan.links))
    local = transfer.relative(motion.turns, plan.transfer.carrier, links)
    expected = quat.multiply(quat.multiply(plan.transfer.q_pre, local), plan.transfer.q_post)
    assert np.array_equal(transfer.apply(plan.transfer, motion.turns, links), expected)
    # At the source's rest all local rotations are the identity, and the target stands in the aligned pose.
    at_rest = quat.multiply(plan.transfer.q_pre, plan.transfer.q_post)
    rest = Pose(source.skeleton.rest_rotations[None], source.skeleton.rest_positions[None])
    aligned = pipeline.evaluate(plan, rest, 1 / 30)
    assert quat.angle_between(aligned.basis[0], at_rest).max() < 1e-9


def test_twist_is_relative_to_each_rest() -> None:
    source, target = _figure(19), _figure(20, build=Build(arms_down=50.0, fingers=2))
    skeleton = source.skeleton
    turns = quat.identity(9, len(skeleton))
    arm = source.bone("leftLowerArm")
    axis = quat.unit(skeleton.rest_positions[source.bone("leftHand")] - skeleton.rest_positions[arm])
    own = quat.rotate(quat.conjugate(skeleton.rest_rotations[arm]), axis)
    turns[:, arm] = quat.from_axis_angle(own, np.linspace(0.0, 2.0, 9))
    pose = pose_from_basis(skeleton, turns, np.zeros((9, len(skeleton), 3)))
    out = _given(source, target, pose)
    lower = target.bone("leftLowerArm")
    turned = quat.angle_between(out.rotations[:, lower], out.rotations[:1, lower])
    assert np.abs(turned - np.linspace(0.0, 2.0, 9)).max() < 1e-6


def test_the_hips_travel_by_the_ratio_of_leg_lengths() -> None:
    source, target = _figure(21), _figure(22, height=0.5 * 1.75)
    pose = wild(source.skeleton, 20, np.random.default_rng(23))
    out = _given(source, target, pose)
    theirs, ours = joints(source, pose, "hips")[:, 0], joints(target, out, "hips")[:, 0]
    assert np.abs(0.5 * (theirs - theirs[0]) - (ours - ours[0])).max() < 1e-6


def test_a_pose_that_the_user_chose_stands_for_the_rest() -> None:
    source, target = _figure(24), _figure(25)
    pose = wild(source.skeleton, 10, np.random.default_rng(26))
    reference = ReferencePose("frame 4", pose.rotations[4], pose.positions[4])
    alike = replace(FREE, matching=Matching.AS_THEY_STAND)
    plan = prepare(source, target, alike, reference)
    assert plan.reference == "frame 4"
    out = play(target, pipeline.evaluate(plan, pose, 1 / 30))
    rest = quat.rotate(
        quat.identity(1), target.skeleton.rest_positions - target.skeleton.rest_positions[target.bone("hips")]
    )
    facing = quat.multiply(out.rotations[4, 0], quat.conjugate(target.skeleton.rest_rotations[0]))
    stood = quat.rotate(quat.conjugate(facing), out.positions[4] - out.positions[4, 0])
    assert np.abs(stood - rest).max() < 1e-6


def test_what_constraints_change_is_measured() -> None:
    source, target = _figure(27), _figure(28, proportions=CHIBI)
    pose = wild(source.skeleton, 40, np.random.default_rng(29), reach=0.2)
    free = pipeline.evaluate(prepare(source, target, FREE), pose, 1 / 30)
    planted_plan = prepare(source, target)
    planted = pipeline.evaluate(planted_plan, pose, 1 / 30)
    before = measure(prepare(source, target, FREE), free.source, free.motion)
    after = measure(planted_plan, planted.source, planted.motion)
    assert before.direction.max < 1e-4
    assert before.twist.max < 1e-4
    assert after.direction.max > 0.0


def _without(bones: list[Bone], *stems: str) -> list[Bone]:
    gone: set[str] = set()
    for bone in bones:
        if bone.parent in gone or any(stem in bone.name for stem in stems):
            gone.add(bone.name)
    return [b for b in bones if b.name not in gone]


def test_a_body_without_legs_cannot_walk() -> None:
    legless = analyze(skeleton_of(_without(humanoid(build=Build(fingers=3)), "UpperLeg")))
    with pytest.raises(RigError, match="the target armature has no legs that could be found: map its legs by hand"):
        prepare(_figure(30), legless)


def test_bodies_must_share_something() -> None:
    snake = [Bone(f"b{i}", f"b{i - 1}" if i else None, (0, 0.1 * i, 0.02), (0, 0.1 * i + 0.1, 0.02)) for i in range(12)]
    with pytest.raises((RigError, MappingError), match=r"map|choose"):
        prepare(_figure(31), analyze(skeleton_of(snake)))
