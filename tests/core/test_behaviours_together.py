"""All behaviours of a body together, on humanoids and creatures; commands that make no sense; gestures in time."""

from dataclasses import astuple
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from morph_retarget.core import quat
from morph_retarget.core.clips.behaviours import stroke_timing
from morph_retarget.core.clips.behaviours.registry import BEHAVIOURS, is_behaviour
from morph_retarget.core.clips.commands.command import Command, Verb
from morph_retarget.core.clips.motions.annotations import Strokes
from morph_retarget.core.clips.track import Track
from morph_retarget.core.errors import MotionError
from tests.behaving import RATE, Subject, creature, figure, start, stop
from tests.morph_bodies import unlike_characters
from tools.creatures import CREATURES

ALL = ("gaze", "nod", "shake", "tilt", "saccade", "reach", "touch", "point", "grasp")
few = settings(max_examples=40, deadline=None)


def _busy(rng: np.random.Generator, count: int = 12) -> list[Command]:
    """Return commands of all kinds at any times."""
    out: list[Command] = []
    for _ in range(count):
        model, time = str(rng.choice(ALL)), float(rng.uniform(0.0, 3.0))
        verb = Verb.START if rng.random() < 0.7 else Verb.STOP if rng.random() < 0.7 else Verb.RESET
        parameters = (
            {"target": str(rng.choice(["still", "moving"]))} if "target" in BEHAVIOURS[model].parameters else {}
        )
        out.append(Command(time, verb, model, parameters))
    return out


def _targets(subject: Subject, rng: np.random.Generator) -> dict[str, Track]:
    size = subject.actor.bodies.size
    times = np.arange(121) / RATE
    path = np.cumsum(rng.normal(size=(121, 3)), axis=0) * 0.02 * size
    still = Track.at_place(rng.uniform([-0.5, -0.8, 0.0], [0.5, 0.3, 0.8]) * size)
    return {"still": still, "moving": Track(times, path + size * np.array([0.0, -0.3, 0.3]))}


@pytest.mark.parametrize("name", CREATURES)
def test_all_that_a_character_is_told_at_once_leaves_finite_poses(name: str) -> None:
    subject = creature(name)
    rng = np.random.default_rng(list(CREATURES).index(name))
    shown = subject.act(_busy(rng, 16), _targets(subject, rng), 4.0)
    turns = shown.posture.turns
    assert np.isfinite(turns).all()
    assert np.isfinite(shown.posture.positions).all()
    assert np.abs(quat.length(turns) - 1.0).max() < 1e-6


def test_real_characters_look_nod_and_reach(data: Path) -> None:
    for name, character in unlike_characters(data).items():
        subject = Subject(character)
        target = np.array([0.15, -0.35, 0.75]) * subject.actor.height
        commands = [start(0.1, "gaze", target="it"), start(0.2, "nod"), start(0.2, "reach", target="it", lean=False)]
        shown = subject.act(commands, {"it": Track.at_place(target)}, 2.5)
        assert np.isfinite(shown.posture.turns).all(), name
        for hand in subject.hands:
            if hand.body in shown.acted.bodies and hand.is_arm:
                palm = shown.point(hand, hand.middle + hand.thickness * hand.palm)[-1]
                arm = subject.arm(hand)
                far = np.linalg.norm(target - arm.shoulder(shown.posture)[-1])
                is_near = 0.35 * arm.length < far < 0.9 * arm.length
                assert not is_near or np.linalg.norm(palm - target) < 2e-3 * subject.actor.height, name


def test_feet_and_root_stay_where_the_motion_has_them() -> None:
    subject = creature("biped")
    rng = np.random.default_rng(4)
    shown = subject.act(_busy(rng, 20), _targets(subject, rng), 4.0)
    own = [subject.actor.root, *(bone for leg in subject.character.legs for bone in leg.bones)]
    assert np.abs(shown.posture.positions[:, own] - shown.base.positions[:, own]).max() < 1e-9


def test_a_longer_clip_begins_as_a_shorter_one() -> None:
    subject = creature("biped")
    target = {"it": np.array([0.3, -0.5, 1.2])}
    commands = [start(0.2, "gaze", target="it"), start(0.4, "reach", target="it"), start(0.5, "saccade")]
    short, long = (subject.act(commands, target, seconds).posture for seconds in (2.0, 6.0))
    assert np.abs(short.turns - long.turns[: len(short)]).max() < 1e-6


# --- commands ---


@pytest.mark.parametrize(
    ("command", "problem"),
    [
        (start(0.0, "gaze"), "no target"),
        (start(0.0, "reach", target="nothing"), "no target 'nothing'"),
        (start(0.0, "nod", height=3.0), "no parameter 'height'"),
        (start(0.0, "nod", repeats="often"), "not a number"),
        (start(0.0, "touch", target="it", side="up"), "choose one of left, right"),
    ],
)
def test_commands_that_make_no_sense_are_told(command: Command, problem: str) -> None:
    shown = figure().act([command], {"it": np.array([0.3, -0.5, 1.2])}, 1.0)
    assert any(problem in warning for warning in shown.acted.warnings)


def test_what_a_body_cannot_do_is_told() -> None:
    warnings = figure().act([start(0.0, "saccade")], seconds=1.0).acted.warnings
    assert any("no eyes" in warning for warning in warnings)


def test_stopping_what_does_not_run_does_nothing() -> None:
    subject = figure()
    shown = subject.act([stop(0.5, name) for name in ALL], seconds=1.0)
    assert np.abs(shown.posture.turns - shown.base.turns).max() < 1e-9
    assert not shown.acted.warnings


def test_starting_again_keeps_what_is_not_told() -> None:
    """The second command changes the speed of a gaze alone, so it goes on to the same target."""
    subject, target = figure(), {"it": np.array([0.8, -1.0, 1.5])}
    once = subject.act([start(0.0, "gaze", target="it")], target)
    twice = subject.act([start(0.0, "gaze", target="it"), start(1.5, "gaze", speed=90.0)], target)
    assert np.abs(once.posture.turns[-1] - twice.posture.turns[-1]).max() < 1e-9
    assert not twice.acted.warnings


def test_a_place_may_be_given_instead_of_a_name() -> None:
    subject = figure()
    named = subject.act([start(0.0, "gaze", target="it")], {"it": np.array([0.8, -1.0, 1.5])})
    placed = subject.act([start(0.0, "gaze", place=(0.8, -1.0, 1.5))])
    assert np.array_equal(named.posture.turns, placed.posture.turns)


def test_behaviours_are_known_by_their_names() -> None:
    assert {*ALL, "go"} <= set(BEHAVIOURS)
    assert is_behaviour("gaze")
    assert not is_behaviour("walk")


# --- gestures in time ---

STROKES = Strokes(2.0, 10.0, 14.0, 20.0, 30.0)


def test_a_gesture_without_wishes_keeps_its_time() -> None:
    own, shown, missed = stroke_timing.keys(STROKES, {})
    assert np.array_equal(own, shown)
    assert not missed


@few
@given(stroke=st.floats(0.0, 200.0), length=st.floats(-5.0, 60.0))
def test_strokes_fall_on_the_moments_that_were_asked_for(stroke: float, length: float) -> None:
    wanted = {"stroke": stroke, "stroke_end": stroke + length}
    own, shown, missed = stroke_timing.keys(STROKES, wanted)
    assert (np.diff(shown) > 0.0).all()
    assert (np.diff(own) > 0.0).all()
    assert shown[0] >= 0.0
    rates = np.diff(own) / np.diff(shown)
    assert rates.max() < stroke_timing.FASTEST + 1e-9
    assert rates.min() > stroke_timing.SLOWEST - 1e-9
    for name, time in wanted.items():
        place = stroke_timing.NAMES.index(name)
        assert name in missed or abs(shown[place] - time) < 1e-9
    if stroke > 12.0 / stroke_timing.FASTEST and 6.0 / 3.0 <= length <= 6.0 * 4.0:
        assert not missed


def test_times_that_a_gesture_does_not_have_are_told() -> None:
    with pytest.raises(MotionError, match="choose one of ready"):
        stroke_timing.keys(STROKES, {"climax": 3.0})
    assert len(stroke_timing.NAMES) == len(astuple(STROKES))
