"""Annotations found from motions: of gaits of our own, whose annotations are known, and of what moves anyhow."""

from functools import cache

import numpy as np
import pytest

from morph_retarget.core import quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.character.character import Character
from morph_retarget.core.character.frame import Placement
from morph_retarget.core.clips import posing
from morph_retarget.core.clips.character_model import RATE
from morph_retarget.core.clips.clip import Clip
from morph_retarget.core.clips.motions import cutting, finding, strokes
from morph_retarget.core.clips.motions.annotations import Annotations, Phase
from morph_retarget.core.clips.motions.base_motion import BaseMotion
from morph_retarget.core.clips.motions.library import Library
from morph_retarget.core.clips.operators.loop import Loop
from morph_retarget.core.clips.travel import Travel
from morph_retarget.core.directing import starter
from morph_retarget.core.errors import MotionError
from morph_retarget.core.skeleton import Pose
from tests.legged import crawler
from tests.skeletons import skeleton_of, wild
from tools.figure import Bone, humanoid

ROUNDS = 3.4
"""Of a loop that is looked at."""
BODIES = {"humanoid": humanoid(), "four legs": crawler(4), "six legs": crawler(6)}


def _character(bones: list[Bone], place: Placement | None = None) -> Character:
    return analyze(skeleton_of(bones, np.random.default_rng(2)), place)


@cache
def _library(body: str) -> Library:
    kinds = ("walk", "run", "turn", "idle", "jump", "wave")
    return starter.starter(_character(BODIES[body]), kinds)


def _played(motion: BaseMotion, rate: float = RATE, spot: bool = False) -> Pose:
    """Return a base motion as it is seen, loops several times; on the spot without its travel."""
    clip: Clip = Loop(0, motion.clip) if motion.annotations.cycle else motion.clip
    length = ROUNDS * motion.clip.length if motion.annotations.cycle else motion.clip.length
    times = np.arange(0.0, length - 0.5, RATE / rate)
    travel = Travel.still(len(times)) if spot else clip.travel(times)
    return posing.pose_of(motion.clip.model, clip.frame(times), travel)


def _apart(frames: float, period: float) -> float:
    return abs((frames + 0.5 * period) % period - 0.5 * period)


def _worst(known: BaseMotion, found: Annotations) -> float:
    """Return how far strikes found are from those of a loop at the most [frames]."""
    period = known.clip.length
    return max(
        min(_apart(own.frame - strike.frame, period) for own in known.annotations.strikes if own.foot == strike.foot)
        for strike in found.strikes
    )


LOOPS = ("walk slow", "walk", "walk left", "walk fast right", "walk backward", "walk to the left", "run", "run left")


@pytest.mark.parametrize("body", BODIES)
@pytest.mark.parametrize("name", LOOPS)
def test_what_is_known_of_a_gait_is_found_from_its_motion(body: str, name: str) -> None:
    motion = _library(body).named(name)
    own = finding.find(motion.clip.model.character, _played(motion), 1.0 / RATE)
    found, known = own.annotations, motion.annotations
    assert found.kind == known.kind
    assert found.speed == pytest.approx(known.speed, rel=0.06)
    assert found.turn_rate == pytest.approx(known.turn_rate, abs=0.1)
    assert _apart(found.direction - known.direction, 2.0 * np.pi) < 0.1
    assert len(found.strikes) >= 3 * len(known.strikes) - 2
    assert _worst(motion, found) <= 2.0
    assert own.cycle is not None
    assert own.cycle.length == pytest.approx(motion.clip.length, abs=0.1)


@pytest.mark.parametrize("body", BODIES)
def test_turning_on_the_spot_is_found(body: str) -> None:
    motion = _library(body).named("turn left")
    found = finding.annotate(motion.clip.model.character, _played(motion), 1.0 / RATE)
    assert found.kind == "turn"
    assert found.turn_rate == pytest.approx(motion.annotations.turn_rate, rel=0.05)
    assert found.speed == 0.0


@pytest.mark.parametrize("name", ["walk", "run", "walk backward", "walk to the left"])
def test_who_walks_on_the_spot_goes_as_fast_as_the_ground_runs_under_the_feet(name: str) -> None:
    motion = _library("humanoid").named(name)
    found = finding.annotate(motion.clip.model.character, _played(motion, spot=True), 1.0 / RATE)
    assert found.kind == motion.annotations.kind
    assert found.speed == pytest.approx(motion.annotations.speed, rel=0.15)
    assert _apart(found.direction - motion.annotations.direction, 2.0 * np.pi) < 0.15
    assert _worst(motion, found) <= 4.0


@pytest.mark.parametrize("rate", [24.0, 60.0, 120.0])
def test_the_frame_rate_does_not_matter(rate: float) -> None:
    motion = _library("humanoid").named("walk")
    found = finding.annotate(motion.clip.model.character, _played(motion, rate), 1.0 / rate)
    assert found.kind == "walk"
    assert found.speed == pytest.approx(motion.annotations.speed, rel=0.05)
    assert len(found.strikes) >= 5
    assert _worst(motion, found) <= 2.0


def test_neither_the_size_of_a_body_nor_where_its_armature_stands_matters() -> None:
    turned = quat.to_matrix(quat.from_axis_angle(quat.unit(np.array([0.3, 0.9, 0.1])), 1.1))
    place = Placement(turned, 0.02, np.array([3.0, -2.0, 1.0]))
    motion = _library("humanoid").named("walk left")
    plain, pose = motion.clip.model.character, _played(motion)
    bones = [
        Bone(bone.name, bone.parent, *(tuple(((np.array(p) @ turned) * 50.0).tolist()) for p in (bone.head, bone.tail)))
        for bone in humanoid()
    ]
    odd = analyze(skeleton_of(bones, np.random.default_rng(2)), place)
    # Turns from rest as the other armature sees them, of bones with other axes.
    turns = quat.multiply(pose.rotations, quat.conjugate(plain.skeleton.rest_rotations))
    rotations = quat.multiply(place.inverse().turns(turns), odd.skeleton.rest_rotations)
    moved = Pose(rotations, (pose.positions @ turned) * 50.0)
    first, second = (finding.annotate(who, what, 1.0 / RATE) for who, what in ((plain, pose), (odd, moved)))
    assert second.speed == pytest.approx(first.speed, rel=1e-3)
    assert second.turn_rate == pytest.approx(first.turn_rate, abs=1e-3)
    assert [s.foot for s in second.strikes] == [s.foot for s in first.strikes]
    assert [s.frame for s in second.strikes] == pytest.approx([s.frame for s in first.strikes], abs=1e-2)


def test_a_lone_first_frame_is_left_out() -> None:
    motion = _library("humanoid").named("walk")
    character, pose = motion.clip.model.character, _played(motion)
    rest = character.skeleton
    away = rest.rest_positions[None] + np.array([3.0, 3.0, 0.0])
    late = Pose(np.concatenate([rest.rest_rotations[None], pose.rotations]), np.concatenate([away, pose.positions]))
    plain, found = (finding.annotate(character, own, 1.0 / RATE) for own in (pose, late))
    assert found.kind == "walk"
    assert [s.frame - 1.0 for s in found.strikes] == pytest.approx([s.frame for s in plain.strikes])


@pytest.mark.parametrize("body", BODIES)
def test_starting_and_stopping_are_told_apart(body: str) -> None:
    for name, phase in (("walk start", Phase.START), ("walk stop left", Phase.STOP), ("run start", Phase.START)):
        motion = _library(body).named(name)
        assert finding.annotate(motion.clip.model.character, _played(motion), 1.0 / RATE).phase == phase


def test_a_jump_is_known_by_its_flight() -> None:
    for body in BODIES:
        motion = _library(body).named("jump")
        character = motion.clip.model.character
        found = finding.annotate(character, _played(motion), 1.0 / RATE)
        assert found.kind == "jump"
        assert not found.cycle
        assert found.parameters["height"] > 0.05 * character.frame.height
        assert {strike.foot for strike in found.strikes} == set(range(len(motion.clip.model.feet)))


@pytest.mark.parametrize("side", ["left", "right"])
def test_a_wave_has_strokes_a_side_and_the_arm_that_waves(side: str) -> None:
    motion = _library("humanoid").named(f"wave {side}")
    found = finding.annotate(motion.clip.model.character, _played(motion), 1.0 / RATE, style="happy")
    assert (found.kind, found.style, found.side, found.parts) == ("gesture", "happy", side, (f"{side} arm",))
    assert found.strokes is not None
    assert found.strokes.ready < 0.1 * motion.clip.length
    assert found.strokes.relax > 0.9 * motion.clip.length
    assert found.strokes.stroke_end - found.strokes.stroke_start > 0.3 * motion.clip.length


def test_a_kind_that_somebody_knows_better_stays() -> None:
    motion = _library("humanoid").named("wave left")
    assert finding.annotate(motion.clip.model.character, _played(motion), 1.0 / RATE, kind="wave").kind == "wave"


def test_who_stands_and_breathes_idles() -> None:
    for body in BODIES:
        motion = _library(body).named("idle")
        found = finding.annotate(motion.clip.model.character, _played(motion), 1.0 / RATE)
        assert (found.kind, found.strikes, found.speed) == ("idle", (), 0.0)


# --- strokes ---


def _hand(times: Array, way: Array) -> Array:
    """Return the places of a hand that goes up and down a metre as a share says, shape (frame, 1, 3)."""
    return np.column_stack([np.zeros_like(times), np.zeros_like(times), way])[:, None]


def test_the_stroke_lies_between_preparation_and_retraction() -> None:
    times = np.linspace(0.0, 4.0, 241)
    rise, fall = np.clip(times - 0.5, 0.0, 1.0), np.clip(times - 2.5, 0.0, 1.0)
    up = rise * rise * (3.0 - 2.0 * rise) - fall * fall * (3.0 - 2.0 * fall)
    shaken = up + 0.1 * np.sin(2.0 * np.pi * 2.0 * times) * ((times > 1.5) & (times < 2.5))
    found = strokes.find(_hand(times, shaken), times[1])
    assert found is not None
    ready, start, stroke, end, relax = (row * times[1] for row in vars(found).values())
    assert ready == pytest.approx(0.5, abs=0.1)
    assert start == pytest.approx(1.5, abs=0.2)
    assert end == pytest.approx(2.5, abs=0.2)
    assert relax == pytest.approx(3.5, abs=0.1)
    assert start < stroke < end


def test_a_hand_that_holds_still_has_its_stroke_while_it_does() -> None:
    times = np.linspace(0.0, 4.0, 241)
    rise, fall = np.clip(times - 0.5, 0.0, 1.0), np.clip(times - 2.5, 0.0, 1.0)
    found = strokes.find(_hand(times, rise * rise * (3.0 - 2.0 * rise) - fall * fall * (3.0 - 2.0 * fall)), times[1])
    assert found is not None
    assert 1.3 < found.stroke * times[1] < 2.7


def test_hands_that_do_not_move_have_no_strokes() -> None:
    assert strokes.find(np.zeros((50, 2, 3)), 0.02) is None
    assert strokes.find(np.zeros((2, 1, 3)), 0.02) is None


# --- cutting ---


@pytest.mark.parametrize("body", BODIES)
@pytest.mark.parametrize("name", ["walk", "walk left", "run", "walk to the left"])
@pytest.mark.parametrize("rate", [30.0, 50.0])
def test_a_cycle_that_is_cut_leads_to_itself_again_and_goes_as_the_motion_does(
    body: str, name: str, rate: float
) -> None:
    motion = _library(body).named(name)
    model = motion.clip.model
    made = cutting.cut(name, model, _played(motion, rate), 1.0 / rate)
    assert made.annotations.cycle
    assert made.annotations.phase == Phase.LOOP
    assert made.annotations.kind == motion.kind
    assert made.clip.length == motion.clip.length
    assert made.annotations.speed == pytest.approx(motion.annotations.speed, rel=0.05)
    assert made.annotations.turn_rate == pytest.approx(motion.annotations.turn_rate, abs=0.03)
    assert len(made.annotations.strikes) == len(motion.annotations.strikes)
    turns = made.clip.data.rotations
    steps = quat.angle_between(np.roll(turns, -1, axis=0), turns).max(axis=1)
    assert steps[-1] < 1.5 * steps[:-1].max()
    once = Loop(0, made.clip).travel(np.array([made.clip.length]))
    arc = made.annotations.speed * made.clip.length / RATE
    bend = np.sinc(0.5 * float(once.headings[0]) / np.pi)
    assert float(np.hypot(*once.places[0])) == pytest.approx(arc * bend, rel=0.02)


def test_a_cycle_that_is_cut_shows_what_was_seen() -> None:
    motion = _library("humanoid").named("walk left")
    made = cutting.cut("walk", motion.clip.model, _played(motion), 1.0 / RATE)
    # Joints stand to each other as they do at some time of the loop, whenever the cycle begins.
    often = np.arange(0.0, motion.clip.length, 0.1)
    places = posing.pose_of(motion.clip.model, made.clip.data).positions
    known = posing.pose_of(motion.clip.model, Loop(0, motion.clip).frame(often)).positions
    lengths, seen = (quat.length(own[:, 1:] - own[:, :1]) for own in (places, known))
    away = np.abs(lengths[:, None] - seen[None]).max(axis=-1).min(axis=1)
    assert away.max() < 1e-6


def test_all_of_a_motion_is_what_it_was() -> None:
    motion = _library("humanoid").named("jump ahead")
    model, pose = motion.clip.model, _played(motion)
    made = cutting.whole("jump", model, pose, 1.0 / RATE)
    again = posing.pose_of(model, made.clip.data, made.clip.way)
    assert len(again) == len(pose)
    first, second = (quat.length(own.positions - own.positions[:, :1]) for own in (pose, again))
    assert np.abs(first - second).max() < 1e-6
    way, known = made.clip.way, motion.clip.way
    assert np.hypot(*(way.places[-1] - known.places[-1])) < 0.1
    assert not made.annotations.cycle


def test_what_never_comes_back_cannot_be_cut() -> None:
    motion = _library("humanoid").named("jump ahead")
    with pytest.raises(MotionError, match="never comes back"):
        cutting.cut("leap", motion.clip.model, _played(motion), 1.0 / RATE)
    empty = Pose(np.zeros((0, len(motion.clip.model), 4)), np.zeros((0, len(motion.clip.model), 3)))
    with pytest.raises(MotionError, match="no frames"):
        cutting.motion_of("leap", motion.clip.model, empty, 1.0 / RATE)


def test_a_motion_becomes_its_cycle_or_stays_whole() -> None:
    library = _library("humanoid")
    for name, cycle in (("walk", True), ("jump", False), ("wave left", False)):
        motion = library.named(name)
        made = cutting.motion_of(name, library.model, _played(motion), 1.0 / RATE, kind="any", style="usual")
        assert (made.annotations.cycle, made.kind, made.annotations.style) == (cycle, "any", "usual")


# --- anything ---


@pytest.mark.parametrize("frames", [1, 2, 3, 4, 7, 40])
@pytest.mark.parametrize("body", BODIES)
def test_any_motion_has_annotations(body: str, frames: int) -> None:
    model = _library(body).model
    rng = np.random.default_rng(frames)
    for pose in (wild(model.character.skeleton, frames, rng), _still(model.character, frames)):
        made = cutting.motion_of("any", model, pose, 1.0 / 25.0)
        assert np.isfinite(made.clip.data.rotations).all()
        assert np.isfinite(made.clip.way.places).all()


def _still(character: Character, frames: int) -> Pose:
    own = character.skeleton
    return Pose(
        np.repeat(own.rest_rotations[None], frames, axis=0), np.repeat(own.rest_positions[None], frames, axis=0)
    )


def test_a_body_that_does_not_move_idles() -> None:
    for bones in BODIES.values():
        character = _character(bones)
        found = finding.annotate(character, _still(character, 50), 0.04)
        assert (found.kind, found.strikes, found.speed, found.turn_rate) == ("idle", (), 0.0, 0.0)


def test_a_body_without_legs_has_annotations_too() -> None:
    bones = [Bone("b0", None, (0.0, 0.0, 0.1), (0.0, -0.2, 0.1))]
    bones += [Bone(f"b{i}", f"b{i - 1}", (0.0, -0.2 * i, 0.1), (0.0, -0.2 * (i + 1), 0.1)) for i in range(1, 8)]
    character = _character(bones)
    found = finding.annotate(character, wild(character.skeleton, 60, np.random.default_rng(1)), 0.04)
    assert found.strikes == ()
    assert finding.annotate(character, _still(character, 60), 0.04).kind == "idle"
