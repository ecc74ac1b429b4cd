"""The starter library: motions of our own on any body."""

from functools import cache

import numpy as np
import pytest

from morph_retarget.core import quat
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.clips import posing, spots
from morph_retarget.core.clips.character_model import RATE, CharacterModel
from morph_retarget.core.clips.frames import Frames
from morph_retarget.core.clips.motions.annotations import Phase
from morph_retarget.core.clips.motions.base_motion import BaseMotion
from morph_retarget.core.clips.motions.library import Library
from morph_retarget.core.directing import performing
from morph_retarget.core.directing.outings import Manner, Outing
from morph_retarget.core.directing.recipes import recipe as recipe_files
from morph_retarget.core.directing.recipes.curves import curve
from morph_retarget.core.directing.recipes.shelf import recipes
from morph_retarget.core.directing.starter import completed, kinds_of_starter, starter
from morph_retarget.core.directing.takes import Take
from morph_retarget.core.errors import MotionError
from morph_retarget.core.morph.bodies import Bodies
from tests.skeletons import skeleton_of
from tools.creatures import CREATURES

WALKERS = ("biped", "hound", "beetle", "spider")
ALL = (*WALKERS, "snake")
ANGLE, SHARE = 1e-3, 1e-3
"""Poses that differ by less, in radians and in leg lengths, are the same."""


@cache
def _library(name: str) -> Library:
    return starter(analyze(skeleton_of(CREATURES[name]())), ("walk", "run", "idle"))


@cache
def _acts(name: str) -> Library:
    return starter(analyze(skeleton_of(CREATURES[name]())), ("idle", "wave", "jump", "beat", "clap"))


def _of_phase(library: Library, kind: str, phase: Phase) -> list[BaseMotion]:
    return [motion for motion in library.of_kind(kind) if motion.annotations.phase == phase]


def _apart(model: CharacterModel, first: Frames, second: Frames) -> tuple[float, float]:
    """Return how far two batches of poses are apart: angle [rad], and distance in leg lengths."""
    a, b = posing.pose_of(model, first), posing.pose_of(model, second)
    leg = 0.5 * model.character.frame.height
    away = model.character.local_to_character.scale * np.abs(a.positions - b.positions).max() / leg
    return float(quat.angle_between(a.rotations, b.rotations).max()), float(away)


def _same(model: CharacterModel, first: Frames, second: Frames) -> bool:
    angle, away = _apart(model, first, second)
    return angle < ANGLE and away < SHARE


@pytest.mark.parametrize("name", ALL)
@pytest.mark.parametrize("turn", [0.0, 0.4])
def test_a_loop_ends_where_it_begins(name: str, turn: float) -> None:
    model = _library(name).model
    speed = next(m.annotations.speed for m in _library(name).of_kind("walk") if m.annotations.cycle)
    outing = Outing.of(model, Manner("walk", speed, turn))
    loop = outing.loop("loop")
    after = Take("after", loop.moving, loop.course, loop.times[-1:] + outing.step[1])
    own, once_more = performing.performed(model, [loop, after])
    assert _same(model, own.data[:1], once_more.data)


@pytest.mark.parametrize("name", ALL)
@pytest.mark.parametrize("kind", ["walk", "run"])
def test_a_start_leads_from_standing_to_the_first_frame_of_the_loop(name: str, kind: str) -> None:
    library = _library(name)
    (start,), loop = _of_phase(library, kind, Phase.START), library.named(kind)
    assert _same(library.model, start.end_pose, loop.start_pose)
    assert _same(library.model, start.start_pose, library.named("idle").start_pose)
    assert start.annotations.speed == loop.annotations.speed


@pytest.mark.parametrize("name", ALL)
@pytest.mark.parametrize("kind", ["walk", "run"])
def test_stops_lead_from_the_loop_to_standing(name: str, kind: str) -> None:
    library = _library(name)
    model, loop, count = library.model, library.named(kind), library.named(kind).clip.length
    stops = _of_phase(library, kind, Phase.STOP)
    assert len(stops) == (2 if len(model.feet) else 1)
    for stop, share in zip(stops, (0.0, 0.5), strict=False):
        if share * count == int(share * count):  # a frame that the loop has
            assert _same(model, stop.start_pose, loop.clip.frame(np.array([share * count])))
        assert _same(model, stop.end_pose, library.named("idle").start_pose)


@pytest.mark.parametrize("name", ALL)
def test_annotated_speeds_and_turns_are_those_of_the_travel(name: str) -> None:
    for motion in _library(name).motions:
        own = motion.annotations
        if not own.cycle or motion.kind == "idle":
            continue
        steps, frames = motion.clip.way.steps(), motion.clip.length - 1.0
        if len(motion.clip.data) < 3:
            continue
        # Between frames the body goes along arcs, of which the steps are the chords.
        bent = np.sinc(steps.headings / (2.0 * np.pi))
        gone = (np.hypot(*steps.places.T) / bent).sum()
        assert abs(gone * RATE / frames - own.speed) < 1e-3 * max(own.speed, 0.1)
        turned = motion.clip.way.headings[-1]
        assert abs(turned * RATE / frames - own.turn_rate) < 1e-6


@pytest.mark.parametrize("name", WALKERS)
def test_each_foot_strikes_once_in_a_loop_and_stands_from_then_on(name: str) -> None:
    library = _library(name)
    for motion in _of_phase(library, "walk", Phase.LOOP):
        count = int(motion.clip.length)
        assert sorted(strike.foot for strike in motion.annotations.strikes) == list(range(len(library.model.feet)))
        for strike in motion.annotations.strikes:
            stands = motion.clip.data.contacts[:, strike.foot]
            before, after = np.floor(strike.frame - 1e-3), np.ceil(strike.frame + 1e-3)
            assert (stands[int(before) % count], stands[int(after) % count]) == (0.0, 1.0)


@pytest.mark.parametrize("name", WALKERS)
def test_feet_stand_still_on_the_ground_of_loops(name: str) -> None:
    library = _library(name)
    for motion in _of_phase(library, "walk", Phase.LOOP):
        places = spots.in_world(motion.clip.data.feet, motion.clip.way)
        both = np.minimum(motion.clip.data.contacts[1:], motion.clip.data.contacts[:-1]) > 0.5
        slid = np.linalg.norm(np.diff(places[..., :2], axis=0), axis=-1)
        assert slid[both].max() < 2e-3 * library.model.character.frame.height


@pytest.mark.parametrize("name", ALL)
def test_frames_rebuild_the_pose_that_was_played(name: str) -> None:
    model = _library(name).model
    outing = Outing.of(model, Manner("walk", _library(name).named("walk").annotations.speed, 0.3))
    loop = outing.loop("loop")
    clip = performing.performed(model, [loop])[0]
    goals = loop.moving.evaluate(loop.times)
    pose = posing.pose_of(model, clip.data, loop.way)
    root = model.character.local_to_character.points(pose.positions[:, model.root])
    assert np.abs(root - goals.positions[:, 0]).max() < 1e-6
    turns = quat.multiply(pose.rotations, quat.conjugate(model.character.skeleton.rest_rotations))
    seen = model.character.local_to_character.turns(turns[:, goals.bodies])
    free = goals.rotation_influence[0] == 1.0
    assert quat.angle_between(seen, goals.turns)[:, free].max() < 1e-6


@pytest.mark.parametrize("name", ALL)
def test_idling_is_a_seamless_cycle_of_small_movements(name: str) -> None:
    library = _library(name)
    (idle,) = library.of_kind("idle")
    assert idle.annotations.cycle
    data, count = idle.clip.data, len(idle.clip.data)
    steps = [quat.angle_between(data.rotations[i], data.rotations[(i + 1) % count]).max() for i in range(count)]
    assert max(steps) < np.radians(1.5)
    assert steps[-1] <= 1.5 * max(steps[:-1])
    assert (data.contacts == 1.0).all()


@pytest.mark.parametrize("name", ["biped", "hound", "snake"])
def test_acts_begin_and_end_as_the_body_stands(name: str) -> None:
    library = _acts(name)
    standing = library.named("idle").start_pose
    for motion in library.motions:
        if not motion.annotations.cycle:
            assert _same(library.model, motion.start_pose, standing), motion.name
            assert _same(library.model, motion.end_pose, standing), motion.name


def test_waves_are_for_each_hand_and_need_that_arm_alone() -> None:
    left, right = _acts("biped").of_kind("wave")
    assert (left.annotations.side, right.annotations.side) == ("left", "right")
    assert left.annotations.parts == ("left arm",)
    model, character = left.clip.model, left.clip.model.character
    hand = character.bone("leftHand")
    assert hand is not None
    strokes = left.annotations.strokes
    assert strokes is not None
    for motion, is_high in ((left, True), (right, False)):
        pose = posing.pose_of(model, motion.clip.data)
        places = character.local_to_character.points(pose.positions[:, hand])
        assert (places[round(strokes.stroke), 2] > 0.9 * places[0, 2] + 0.3) == is_high


def test_nobody_is_given_what_it_cannot_do() -> None:
    assert not _acts("snake").of_kind("wave")
    assert not _acts("hound").of_kind("beat")
    assert _acts("hound").of_kind("wave")


def test_feet_leave_the_ground_in_a_jump_and_the_body_flies_ahead_only_then() -> None:
    spot, ahead = _acts("biped").of_kind("jump")
    strokes = ahead.annotations.strokes
    assert strokes is not None
    air = spot.clip.data.contacts.max(axis=1) == 0.0
    assert air[round(0.5 * (strokes.stroke_start + strokes.stroke_end))]
    moves = np.hypot(*ahead.clip.way.steps().places.T) > 1e-9
    assert moves.any()
    assert (air[1:] | air[:-1])[moves].mean() > 0.8
    assert abs(np.hypot(*ahead.clip.way.places[-1]) - ahead.annotations.parameters["distance"]) < 1e-9


def test_only_the_kinds_that_are_asked_for_are_made() -> None:
    assert _library("biped").kinds == ("walk", "run", "idle")


def test_a_library_is_completed_with_what_it_lacks_and_keeps_what_it_has() -> None:
    library = _library("snake")
    more = completed(library, ("walk", "bow"))
    assert more.motions[: len(library)] == library.motions
    assert more.kinds == (*library.kinds, "bow")


def test_a_kind_that_there_is_not_is_named() -> None:
    with pytest.raises(MotionError, match="no 'flight': choose from walk"):
        starter(_library("biped").model.character, ("flight",))


# --- recipes ---


def test_recipes_come_back_from_their_files_as_they_were() -> None:
    assert {recipe.kind for recipe in recipes()} <= set(kinds_of_starter())
    for recipe in recipes():
        again = recipe_files.parse(recipe_files.to_text(recipe), "there")
        assert recipe_files.to_text(again) == recipe_files.to_text(recipe)
        assert again.channels == recipe.channels
        assert set(recipe.crucial) <= {channel.name for channel in recipe.channels}


def test_recipes_are_for_every_body_at_most_once_a_kind() -> None:
    bodies = Bodies.of(_library("biped").model.character)
    fitting = [recipe.kind for recipe in recipes() if not recipe.branch.refusals(bodies)]
    assert fitting.count("idle") == 1


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "there: is no recipe of a motion"),
        ('{"format": 2}', "newer version"),
        ('{"format": 1, "name": "x"}', "there: is no recipe of a motion"),
        ('{"format": 1, "name": "x", "kind": "x", "frames": 3, "channels": [], "keys": []}', "no preset of channels"),
    ],
)
def test_files_that_are_no_recipes_are_refused(text: str, message: str) -> None:
    with pytest.raises(MotionError, match=message):
        recipe_files.parse(text, "there")


def test_curves_go_through_their_keys_and_never_beyond_them() -> None:
    rng = np.random.default_rng(3)
    frames = np.cumsum(rng.uniform(0.5, 6.0, 12))
    values = rng.normal(size=(12, 2))
    assert np.abs(curve(frames, values, frames) - values).max() < 1e-12
    fine = curve(frames, values, np.linspace(frames[0] - 3.0, frames[-1] + 3.0, 500))
    assert (fine >= values.min(axis=0) - 1e-12).all()
    assert (fine <= values.max(axis=0) + 1e-12).all()


def test_repeated_curves_have_no_seam() -> None:
    rng = np.random.default_rng(4)
    frames, period = np.array([5.0, 11.0, 20.0, 29.0]), 24.0
    values = rng.normal(size=(4, 1))
    values[-1] = values[0]
    at = np.linspace(-30.0, 80.0, 700)
    assert np.abs(curve(frames, values, at, period) - curve(frames, values, at + period, period)).max() < 1e-9
    both = curve(frames, values, np.array([5.0 - 1e-5, 5.0, 5.0 + 1e-5]), period)[:, 0]
    assert abs((both[2] - both[1]) - (both[1] - both[0])) < 1e-8
