"""Capturing: a performer's motion as generalized values, which lead back to where its bodies were."""

import json
from collections.abc import Sequence
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from morph_retarget.core import play, quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.character.character import Character
from morph_retarget.core.character.frame import Placement
from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.errors import MotionError
from morph_retarget.core.morph import capture, channel_file, measure
from morph_retarget.core.morph.bind import GeneralizedAction, bind
from morph_retarget.core.morph.capture import Captured, CaptureSettings, Performance
from morph_retarget.core.morph.channels import Channel, MirrorRule, TargetKind
from morph_retarget.core.morph.context import Context, Extent, Side
from morph_retarget.core.morph.movement import Movement, PositionMode, RotationMode, ScaleMode
from morph_retarget.core.play import Part, Played
from morph_retarget.core.skeleton import Pose
from tests.morph_bodies import real_characters
from tests.skeletons import skeleton_of, wild
from tools import gait
from tools.figure import humanoid

ROOT = Path(__file__).resolve().parents[2]
BIPED = channel_file.parse(
    (ROOT / "morph_retarget/blender/morph/presets/Biped Mocap.json").read_text(encoding="utf-8"), "preset"
)
AS_IT_IS = CaptureSettings(in_place=False)
FPS = 30.0
UP = np.array([0.0, 0.0, 1.0])


@pytest.fixture(scope="module")
def performer() -> Character:
    return analyze(skeleton_of(humanoid()), Placement.identity())


@pytest.fixture(scope="module")
def walk(performer: Character) -> Pose:
    return gait.pose(performer.skeleton, gait.walk(3.0 * gait.CYCLE, FPS))


def _captured(
    character: Character, pose: Pose, channels: Sequence[Channel] = BIPED, settings: CaptureSettings = AS_IT_IS
) -> Captured:
    return capture.of_clip(character, pose, channels, 0, 1.0 / FPS, settings)


def _part(character: Character, found: Captured) -> Part:
    bodies = capture.Bodies.of(character)
    return play.prepare(character, bind(GeneralizedAction("Captured", found.channels), bodies))


def _grounded(character: Character, pose: Pose) -> Performance:
    return capture.grounded(capture.performance(character, pose))


def _moved(pose: Pose, turn: Array, shift: Array) -> Pose:
    return Pose(quat.multiply(turn, pose.rotations), quat.rotate(turn, pose.positions) + shift)


# --- G on the bodies of the performer ---

MODES = [
    Movement(position, rotation, scale, ground, sagittal)
    for position, rotation, scale, ground, sagittal in product(
        PositionMode, RotationMode, ScaleMode, (False, True), (False, True)
    )
]
TARGETS = [
    Movement(secondary_relative=True),
    Movement(secondary_relative=True, scale=ScaleMode.LIMB_LENGTH, ground_relative=True),
    Movement(secondary_relative=True, directional_only=True),
    Movement(look_at=True),
]


@pytest.mark.parametrize("side", [Side.LEFT, Side.RIGHT])
@pytest.mark.parametrize("mirror", [MirrorRule.NEVER, MirrorRule.LEFT])
def test_what_was_captured_leads_back_to_where_the_bodies_were_in_every_mode(
    performer: Character, side: Side, mirror: MirrorRule
) -> None:
    pose = wild(performer.skeleton, 20, np.random.default_rng(3), reach=0.4)
    found = _grounded(performer, pose)
    for movement in [*MODES, *TARGETS]:
        channel = Channel("Hand", Context(Capability.GRASPER, side=side), movement, mirror=mirror)
        if movement.has_target:
            channel = replace(channel, target=TargetKind.CONTEXT, secondary=Context(Capability.HEAD))
        values = _captured(performer, pose, [channel])
        binding = bind(GeneralizedAction("", values.channels), found.bodies)
        frames = capture.frames_of(binding, {}, found.positions)
        plan = binding.plan
        places, turns = capture.movement.specialize(
            frames, values.values.positions[:, plan.channel], values.values.rotations[:, plan.channel]
        )
        body = binding.entries[0].body
        assert np.abs(places[:, 0] - found.positions[:, body]).max() < 1e-9, movement
        axes = quat.multiply(turns[:, 0], found.bodies.axes[body])
        assert quat.angle_between(axes, found.axes[:, body]).max() < 1e-6, movement


def test_a_captured_walk_plays_on_its_performer_as_it_was(performer: Character, walk: Pose) -> None:
    found, captured = _grounded(performer, walk), _captured(performer, walk)
    part = _part(performer, captured)
    played = play.evaluate(part, captured.values, {})
    height = performer.frame.height
    for channel, body in zip(captured.channels, captured.bodies, strict=True):
        away = played.pose.positions[:, body] - found.positions[:, body]
        assert np.linalg.norm(away, axis=-1).max() < 0.02 * height, channel.name
    for fit in measure.fits(part.binding, played):
        assert fit.largest < 0.01 * height
    assert measure.penetration(part.bodies, played.pose.positions) < 0.01 * height


def test_a_captured_walk_plays_on_unlike_bodies(performer: Character, walk: Pose, data: Path) -> None:
    captured = _captured(performer, walk, settings=CaptureSettings())
    for name in ("m2m_spider", "quaternius_wolf", "m2m_bird", "m2m_snake", "m2m_kaiju"):
        character = real_characters(data)[name]
        part = _part(character, captured)
        played = play.evaluate(part, captured.values, {})
        assert np.isfinite(played.basis).all(), name
        assert part.binding.entries, name
        feet = part.bodies.with_capability(Capability.FOOT)
        if feet:
            assert _swing(played, feet) > 0.01 * part.bodies.size, f"{name} does not step"
        # Nobody flies apart, and nobody leaves.
        away = played.pose.positions - part.bodies.positions
        assert np.linalg.norm(away, axis=-1).max() < part.bodies.size, name


def _swing(played: Played, bodies: Sequence[int]) -> float:
    places = played.pose.positions[:, list(bodies)]
    return float(np.linalg.norm(np.ptp(places, axis=0), axis=-1).min())


# --- in place ---


def test_it_does_not_matter_where_the_performer_starts_which_way_it_faces_and_how_high_its_floor_is(
    performer: Character, walk: Pose
) -> None:
    here = _captured(performer, walk, settings=CaptureSettings())
    turn = quat.from_axis_angle(UP, np.radians(130.0))
    there = _captured(performer, _moved(walk, turn, np.array([5.0, -3.0, 0.7])), settings=CaptureSettings())
    assert np.abs(here.values.positions - there.values.positions).max() < 1e-9
    assert quat.angle_between(here.values.rotations, there.values.rotations).max() < 1e-6
    assert there.travel == pytest.approx(here.travel)


def test_way_and_turning_are_left_out_and_told(performer: Character, walk: Pose) -> None:
    captured = _captured(performer, walk, settings=CaptureSettings())
    assert captured.travel == pytest.approx(3.0 * gait.CYCLE * gait.SPEED, rel=0.1)
    root = captured.values.positions[:, 0]
    assert np.abs(root[:, :2]).max() * 0.05 * performer.frame.height < 0.1, "the hips sway about where they rest"
    around = quat.from_axis_angle(UP, np.linspace(0.0, np.pi, len(walk)))
    turning = Pose(
        quat.multiply(around[:, None], walk.rotations),
        quat.rotate(np.broadcast_to(around[:, None], walk.rotations.shape), walk.positions),
    )
    assert _captured(performer, turning, settings=CaptureSettings()).turning == pytest.approx(np.pi, rel=0.05)


def test_one_frame_can_be_captured(performer: Character, walk: Pose) -> None:
    one = Pose(walk.rotations[5:6], walk.positions[5:6])
    captured = _captured(performer, one, settings=CaptureSettings())
    assert len(captured.values) == 1
    assert np.isfinite(captured.values.positions).all()


def test_a_rig_whose_rest_is_no_pose_rests_in_a_frame_of_its_clip(performer: Character, walk: Pose) -> None:
    line = np.arange(len(performer.skeleton), dtype=np.float64)[:, None] * [0.1, 0.0, 0.0]
    laid = replace(performer.skeleton, rest_positions=line, rest_tails=line + np.array([0.1, 0.0, 0.0]))
    lying = replace(performer, skeleton=laid, rest_is_pose=False)
    # The same bones, straightened out along a line: orientations are those of the walk.
    captured = capture.of_clip(lying, walk, BIPED, 0, 1.0 / FPS, AS_IT_IS)
    feet = [i for i, channel in enumerate(captured.channels) if "feet" in channel.name]
    assert np.abs(captured.values.positions[0, feet, :2]).max() < 1e-9
    assert np.abs(captured.values.rotations[0, feet] - quat.IDENTITY).max() < 1e-9


# --- which channels ---


def test_hands_stand_in_for_wings_measured_from_where_they_hang_down(performer: Character, walk: Pose) -> None:
    wing = Channel("Wing", Context(Capability.WING, extent=Extent.LEFT_MOST), Movement(scale=ScaleMode.LIMB_LENGTH))
    captured = _captured(performer, walk, [wing])
    assert captured.bodies == (performer.bone("leftHand"),)
    assert captured.channels == (wing,), "on others it is still the wing"
    away = np.abs(captured.values.positions).max(axis=(1, 2))
    assert away.min() < 1e-9, "in one frame the arm hangs down farthest"
    assert away.max() > 0.1, "the arms swing"


def test_what_selects_nothing_is_left_out_unless_it_only_guards_its_bodies(performer: Character, walk: Pose) -> None:
    tail = Channel("Tail", Context(Capability.TAIL))
    guard = replace(tail, name="Guard", position_weight=0.0, rotation_weight=0.0)
    captured = _captured(performer, walk, [BIPED[0], tail, guard])
    assert [channel.name for channel in captured.channels] == ["Root", "Guard"]
    (warning,) = captured.warnings
    assert "'Tail'" in warning
    with pytest.raises(MotionError, match="choose other channels"):
        _captured(performer, walk, [tail, guard])


def test_a_channel_with_an_external_target_cannot_be_captured(performer: Character, walk: Pose) -> None:
    reach = Channel("Reach", Context(Capability.GRASPER), Movement(secondary_relative=True), target=TargetKind.EXTERNAL)
    captured = _captured(performer, walk, [BIPED[0], reach])
    assert [channel.name for channel in captured.channels] == ["Root"]


# --- presets ---


def test_channels_are_the_same_after_being_written_and_read() -> None:
    every = [
        replace(channel, movement=movement, target=TargetKind.CONTEXT, secondary=Context(Capability.MOUTH), varies=True)
        for channel, movement in zip(BIPED * 5, MODES, strict=False)
    ]
    assert channel_file.parse(channel_file.to_text(every), "x") == tuple(every)


def test_settings_that_are_left_out_are_the_usual_ones() -> None:
    text = json.dumps({"channels": [{"name": "Feet", "context": {"capability": "foot"}, "position_weight": 1}]})
    assert channel_file.parse(text, "x") == (Channel("Feet", Context(Capability.FOOT)),)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("{", "no JSON"),
        ("[]", "no preset"),
        ('{"channels": []}', "no preset"),
        ('{"format": 2, "channels": [{}]}', "newer"),
        ('{"channels": [3]}', "table of settings"),
        ('{"channels": [{"name": "Feet"}]}', "lacks"),
        ('{"channels": [{"name": "Feet", "context": {"capability": "hoof"}}]}', "'hoof' is unknown: use one of root"),
        ('{"channels": [{"name": "Feet", "context": {"capability": "foot", "zone": 1}}]}', "unknown setting 'zone'"),
        ('{"channels": [{"name": "Feet", "context": {"capability": "foot"}, "varies": "no"}]}', "should be a bool"),
        ('{"channels": [{"name": "Feet", "context": {"capability": "foot"}, "priority": 1.5}]}', "should be a int"),
    ],
)
def test_a_preset_that_cannot_be_meant_is_refused(text: str, words: str) -> None:
    with pytest.raises(MotionError, match=words) as told:
        channel_file.parse(text, "mine.json")
    assert str(told.value).startswith("mine.json")
    assert "\n" not in str(told.value)
