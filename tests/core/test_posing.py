"""Posing: whole bodies that meet their goals. Poses are rebuilt from bones and measured."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from hypothesis import settings
from hypothesis import strategies as st

from morph_retarget.core import play, quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.character.character import Character
from morph_retarget.core.character.frame import Placement
from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.morph.bind import GeneralizedAction, bind
from morph_retarget.core.morph.bodies import Bodies
from morph_retarget.core.morph.channels import Channel, TargetKind, Values
from morph_retarget.core.morph.context import Context
from morph_retarget.core.morph.movement import Movement, ScaleMode
from morph_retarget.core.play import Part
from morph_retarget.core.solve.settings import SolverSettings
from tests import pose_measures
from tests.morph_bodies import unlike_characters
from tests.skeletons import skeleton_of
from tools.figure import CHIBI, Bone, Build, humanoid, moved

seeds = st.integers(0, 10_000)
few = settings(max_examples=30)
UP = np.array([0.0, 0.0, 1.0])
ELBOW_BACK = np.array([0.0, 1.0, 0.0])


def _figure(seed: int = 0, placement: Placement | None = None, **options: object) -> Character:
    bones = humanoid(build=options.pop("build", Build(fingers=2)), **options)
    if placement is not None:
        inverse, back = placement.inverse(), np.eye(4)
        back[:3, :3], back[:3, 3] = inverse.scale * inverse.rotation, inverse.translation
        bones = moved(bones, back)
    return analyze(skeleton_of(bones, np.random.default_rng(seed)), placement)


TURNED = Placement(
    quat.to_matrix(quat.from_rotation_vector(np.array([np.pi / 2, 0.0, 0.3]))), 0.01, np.array([2.0, 1.0, 0.0])
)
FIGURES: Mapping[str, dict[str, object]] = {
    "an adult": {},
    "a big head and short legs": {"proportions": CHIBI, "height": 1.1, "build": Build(fingers=1, arms_down=50.0)},
    "a long spine and twist bones": {"build": Build(spine=5, neck=2, twists=2, root=True)},
    "hardly any spine": {"build": Build(spine=1, neck=0, clavicles=False, toes=False, arms_down=80.0)},
    "a turned object in centimetres": {"placement": TURNED},
}
SIZED = Movement(scale=ScaleMode.LIMB_LENGTH)
ROOT, FOOT, GRASPER, HEAD = Capability.ROOT, Capability.FOOT, Capability.GRASPER, Capability.HEAD


def _part(character: Character, *channels: Channel) -> Part:
    binding = bind(GeneralizedAction("action", channels), Bodies.of(character))
    return play.prepare(character, binding)


def _all_channels() -> list[Channel]:
    """Return channels for everything that can be posed."""
    places = [Channel(c.value, Context(c), SIZED) for c in (ROOT, FOOT, GRASPER, HEAD, Capability.TAIL)]
    turns = (Capability.SPINE, Capability.NECK, Capability.LIMB, Capability.MOUTH, Capability.WING, Capability.FINGER)
    return [*places, *(Channel(c.value, Context(c), poses_position=False) for c in turns)]


def _still(frames: int, channels: int) -> Values:
    return Values(np.zeros((frames, channels, 3)), quat.identity(frames, channels), np.ones((frames, channels)))


def _wild(rng: np.random.Generator, frames: int, channels: int) -> Values:
    turns = quat.from_rotation_vector(rng.uniform(-0.5, 0.5, (frames, channels, 3)))
    return Values(rng.uniform(-0.6, 0.6, (frames, channels, 3)), turns, rng.uniform(0.0, 1.0, (frames, channels)))


def _assert_at_rest(character: Character) -> None:
    channels = _all_channels()
    played = play.evaluate(_part(character, *channels), _still(2, len(channels)), {})
    bodies = Bodies.of(character)
    assert quat.angle_between(played.basis, quat.IDENTITY).max() < 1e-6
    assert np.abs(played.shift).max() < 1e-6 * bodies.size / character.placement.scale
    assert np.abs(played.pose.positions - bodies.positions).max() < 1e-6 * bodies.size


def _assert_rebuilt(character: Character, rng: np.random.Generator) -> None:
    channels = _all_channels()
    played = play.evaluate(_part(character, *channels), _wild(rng, 4, len(channels)), {})
    size = Bodies.of(character).size
    assert np.isfinite(played.pose.positions).all()
    assert np.abs(pose_measures.written(character, played)[0] - played.pose.positions).max() < 1e-6 * size


@pytest.mark.parametrize("options", FIGURES.values(), ids=FIGURES)
def test_zero_values_leave_the_rest_pose(options: dict[str, object]) -> None:
    _assert_at_rest(_figure(1, **options))


def test_zero_values_leave_the_rest_pose_of_real_rigs(data: Path) -> None:
    for character in unlike_characters(data).values():
        _assert_at_rest(character)


def test_what_wants_the_same_of_a_character_is_planned_once() -> None:
    """Tables of limbs take longer than all else that is prepared: an edit that changes no goal leaves them."""
    character, hands = _figure(5), Channel("hands", Context(GRASPER))
    plan = _part(character, hands).pose
    assert (
        _part(character, hands, Channel("face", Context(GRASPER), position_weight=0.0, rotation_weight=0.0)).pose
        is plan
    )
    assert _part(character, hands, Channel("feet", Context(FOOT))).pose is not plan
    assert _part(_figure(5), hands).pose is not plan


@pytest.mark.parametrize("options", FIGURES.values(), ids=FIGURES)
def test_keys_make_the_pose_that_was_solved(options: dict[str, object]) -> None:
    _assert_rebuilt(_figure(2, **options), np.random.default_rng(6))


def test_keys_make_the_pose_that_was_solved_on_real_rigs(data: Path) -> None:
    for character in unlike_characters(data).values():
        _assert_rebuilt(character, np.random.default_rng(7))


def _assert_lengths(character: Character, positions: Array) -> None:
    child = np.flatnonzero(character.skeleton.parents >= 0)
    child = child[[int(character.skeleton.parents[c]) in character.spine + character.limbs[0].bones for c in child]]
    rest = Bodies.of(character).positions
    parents = character.skeleton.parents[child]
    lengths = quat.length(positions[:, child] - positions[:, parents])
    assert np.abs(lengths - quat.length(rest[child] - rest[parents])).max() < 1e-9


def test_bones_of_a_body_keep_their_lengths() -> None:
    character, channels = _figure(3), _all_channels()
    played = play.evaluate(_part(character, *channels), _wild(np.random.default_rng(8), 20, len(channels)), {})
    _assert_lengths(character, played.pose.positions)


@pytest.mark.parametrize("options", FIGURES.values(), ids=FIGURES)
def test_bodies_come_to_their_goals(options: dict[str, object]) -> None:
    """Hands and feet in reach of straight limbs, wherever the root has gone."""
    character = _figure(4, **options)
    part = _part(character, Channel("root", Context(ROOT)), *(Channel(c, Context(c), SIZED) for c in (FOOT, GRASPER)))
    rng, frames = np.random.default_rng(9), 50
    values = _still(frames, 3)
    size = Bodies.of(character).size
    values.positions[:, 0] = 0.02 * size * rng.uniform([-1, -1, -1], [1, 1, 0], (frames, 3))
    values.rotations[:, 0] = quat.from_rotation_vector(rng.uniform(-0.15, 0.15, (frames, 3)))
    values.positions[:, 1] = rng.uniform([-0.1, -0.1, 0.05], [0.1, 0.1, 0.3], (frames, 3))
    values.positions[:, 2] = rng.uniform([-0.2, -0.4, -0.1], [0.2, -0.2, 0.1], (frames, 3))
    played = play.evaluate(part, values, {})
    apart = quat.length(played.pose.positions[:, played.goals.bodies] - played.goals.positions)
    root = played.goals.bodies.tolist().index(played.root)
    assert apart[:, root].max() < 1e-9 * size
    feet = [played.goals.bodies.tolist().index(leg.end) for leg in character.legs]
    assert apart[:, feet].max() < 2e-3 * size


@pytest.mark.parametrize("options", FIGURES.values(), ids=FIGURES)
def test_feet_stay_where_they_are_and_level_while_a_body_sits_down(options: dict[str, object]) -> None:
    character = _figure(5, **options)
    part = _part(
        character,
        Channel("root", Context(ROOT), SIZED, poses_rotation=False),
        Channel("feet", Context(FOOT), poses_rotation=False),
    )
    frames, bodies = 41, Bodies.of(character)
    feet = [leg.end for leg in character.legs]
    leg = bodies.positions[character.legs[0].bones[0], 2]
    down = np.linspace(0.0, 0.6, frames) * leg
    values = _still(frames, 2)
    values.positions[:, 0, 2] = -down / bodies.limb_lengths[part.pose.root]
    played = play.evaluate(part, values, {})
    assert np.abs(played.pose.positions[:, feet] - bodies.positions[feet]).max() < 2e-3 * bodies.size
    sunk = played.pose.positions[:, played.root, 2] - bodies.positions[played.root, 2]
    assert np.abs(sunk + down).max() < 1e-9 * bodies.size
    assert quat.angle_between(played.pose.turns[:, feet], quat.IDENTITY).max() < 1e-6
    # Knees bend forward.
    knees = [leg.bones[-2] for leg in character.legs if len(leg.bones) == 3]
    ahead = played.pose.positions[:, knees, 1] - bodies.positions[knees, 1]
    assert (ahead[1:] < 0.0).all()
    assert np.linalg.norm(np.diff(played.pose.positions, axis=0), axis=-1).max() < 0.1 * bodies.size


def test_influence_leads_from_where_a_body_is_carried_to_its_goal() -> None:
    character = _figure(6)
    part = _part(character, Channel("root", Context(ROOT)), Channel("feet", Context(FOOT)))
    values = _still(11, 2)
    values.positions[:, 0, 2] = -0.2
    values.weights[:, 1] = np.linspace(0.0, 1.0, 11)
    feet = [leg.end for leg in character.legs]
    rest = Bodies.of(character).positions[feet]
    sunk = play.evaluate(part, values, {}).pose.positions[:, feet] - rest
    assert np.abs(sunk[..., 2] + 0.2 * (1.0 - values.weights[:, 1:])).max() < 2e-3


def test_a_pose_does_not_depend_on_the_frames_before_it() -> None:
    """Not by one bit: played backward, or at random, the same time gives the same pose."""
    character, channels = _figure(7), _all_channels()
    channels.insert(0, Channel("reach", Context(GRASPER), Movement(secondary_relative=True), TargetKind.EXTERNAL))
    channels.append(Channel("gaze", Context(HEAD), Movement(look_at=True), TargetKind.EXTERNAL))
    rng, frames = np.random.default_rng(10), 200
    values, part = _wild(rng, frames, len(channels)), _part(character, *channels)
    targets = {0: rng.normal(size=(frames, 3)), len(channels) - 1: rng.normal(size=(frames, 3))}
    played = play.evaluate(part, values, targets)
    for order in (np.arange(frames)[::-1], rng.permutation(frames)):
        mixed = Values(values.positions[order], values.rotations[order], values.weights[order])
        again = play.evaluate(part, mixed, {channel: target[order] for channel, target in targets.items()})
        assert np.array_equal(again.basis, played.basis[order])
        assert np.array_equal(again.shift, played.shift[order])
    one = slice(50, 51)
    alone = Values(values.positions[one], values.rotations[one], values.weights[one])
    single = play.evaluate(part, alone, {channel: target[one] for channel, target in targets.items()})
    assert quat.angle_between(single.basis, played.basis[one]).max() < 1e-9


def test_small_changes_of_goals_are_small_changes_of_poses() -> None:
    character = _figure(8, build=Build(fingers=2, arms_down=50.0))
    part = _part(character, Channel("hands", Context(GRASPER), SIZED, poses_rotation=False))
    values = _still(4001, 1)
    t = np.linspace(0.0, 1.0, 4001)
    # From the rest, past the reach of the arm, and back to the chest.
    values.positions[:, 0] = np.stack([0.3 * np.sin(3 * t), -3.0 * t * (1 - t), 0.8 * t], axis=-1)
    played = play.evaluate(part, values, {})
    assert quat.angle_between(played.basis[1:], played.basis[:-1]).max() < 0.05


def test_bones_that_do_not_inherit_rotation_are_carried_along() -> None:
    bones = humanoid(build=Build(fingers=2))
    plain = skeleton_of(bones, np.random.default_rng(11))
    inherits = np.array([b.name not in ("leftLowerArm", "head") for b in bones])
    loose = type(plain)(
        plain.names, plain.parents, plain.rest_positions, plain.rest_rotations, plain.rest_tails, inherits=inherits
    )
    channel = Channel("spine", Context(Capability.SPINE), poses_position=False)
    values = _still(3, 1)
    values.rotations[:] = quat.from_rotation_vector(np.array([0.2, 0.1, 0.3]))
    poses = [play.evaluate(_part(analyze(s), channel), values, {}).pose for s in (plain, loose)]
    assert np.abs(poses[1].positions - poses[0].positions).max() < 1e-9


def test_what_a_rig_cannot_reach_is_left_as_it_is() -> None:
    """A goal for a bone fixed to what carries it moves nothing, and the plan tells it."""
    bones: list[Bone] = [*humanoid(), Bone("mouth", "head", (0.0, -0.1, 1.6), (0.0, -0.15, 1.6))]
    character = analyze(skeleton_of(bones))
    part = _part(character, Channel("head", Context(HEAD)), Channel("mouth", Context(Capability.MOUTH)))
    values = _still(2, 2)
    values.positions[:, 1] = 0.1
    played = play.evaluate(part, values, {})
    assert [character.skeleton.names[b] for b in part.pose.unreachable] == ["mouth"]
    assert np.abs(played.pose.positions - Bodies.of(character).positions).max() < 1e-6


@pytest.mark.parametrize("nudge", [0.0, 0.05])
def test_limbs_that_fall_short_nudge_the_root_a_little(nudge: float) -> None:
    character = _figure(3)
    channels = (Channel("root", Context(ROOT), SIZED), Channel("feet", Context(FOOT), SIZED, poses_rotation=False))
    binding = bind(GeneralizedAction("action", channels), Bodies.of(character))
    part = play.prepare(character, binding, SolverSettings(nudge=nudge))
    values = _still(3, 2)
    values.positions[1:, 0, 2] = [0.05, 0.5]  # up and away from feet that stay
    played = play.evaluate(part, values, {})
    pose = played.pose
    fallen = played.goals.positions[:, 0, 2] - pose.positions[:, part.pose.root, 2]
    assert fallen[0] == 0.0
    if nudge == 0.0:
        assert np.abs(fallen).max() < 1e-12
        return
    length = 1.75 * 0.6
    assert 0.0 < fallen[1] < fallen[2] < nudge * length
    feet = [character.skeleton.index[name] for name in ("leftFoot", "rightFoot")]
    still = play.evaluate(play.prepare(character, binding), values, {}).pose
    for frame in (1, 2):
        assert pose.positions[frame, feet, 2].max() < still.positions[frame, feet, 2].min()
