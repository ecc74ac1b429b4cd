"""Directed characters: from commands to goals."""

from functools import cache

import numpy as np
import pytest

from morph_retarget.core import play, quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.character.character import Character
from morph_retarget.core.character.frame import Placement
from morph_retarget.core.clips import posing, spots
from morph_retarget.core.clips.commands.command import Command, Value, Verb
from morph_retarget.core.clips.motions.library import Library
from morph_retarget.core.clips.track import Track
from morph_retarget.core.directing import director, planting, starter, transferring
from morph_retarget.core.directing.director import Directed, Directions
from morph_retarget.core.directing.moved import Moved
from morph_retarget.core.layering import Layer
from morph_retarget.core.morph.bind import GeneralizedAction, bind
from morph_retarget.core.morph.bodies import Bodies
from morph_retarget.core.morph.channels import Values
from morph_retarget.core.play import Played
from morph_retarget.core.runs import runs
from tests.skeletons import skeleton_of
from tools import creatures

KINDS = ("idle", "walk", "run", "turn")
UP = np.array([0.0, 0.0, 1.0])


@cache
def _character(name: str) -> Character:
    return analyze(skeleton_of(creatures.CREATURES[name]()), Placement.identity())


@cache
def _library(name: str) -> Library:
    return starter.starter(_character(name), KINDS)


def _say(time: float, verb: str, model: str, **parameters: Value) -> Command:
    return Command(time, Verb(verb), model, parameters)


OUTING = (
    _say(0.5, "start", "walk"),
    _say(2.5, "start", "walk", turn=0.6),
    _say(4.0, "start", "run"),
    _say(5.5, "stop", "run"),
)


def _directed(name: str, *commands: Command, last: float = 8.0, library: str = "", **around: object) -> Directed:
    directions = Directions(commands, **around)  # type: ignore[arg-type]
    return director.prepare(_character(name), _library(library or name), directions, last)


def _played(directed: Directed, times: Array) -> Played:
    character = directed.model.character
    action = bind(GeneralizedAction("nothing", ()), Bodies.of(character))
    part = play.prepare(character, action, lower=directed.wanted)
    places, headings = directed.course.at(times)
    layer = Layer(directed.evaluate(times), places, quat.from_axis_angle(UP, headings))
    nothing = Values(np.zeros((len(times), 0, 3)), np.zeros((len(times), 0, 4)), np.zeros((len(times), 0)))
    return play.evaluate(part, nothing, {}, layer)


@pytest.mark.parametrize("name", ["biped", "hound", "beetle", "snake"])
def test_a_clip_that_nothing_is_blended_with_is_shown_as_it_is(name: str) -> None:
    library = _library(name)
    clip = next(motion for motion in library.motions if motion.annotations.cycle).clip
    moved = transferring.on(library.model, library.model, clip.data, clip.way, None)
    own = Moved.of(
        library.model.character, posing.pose_of(library.model, clip.data, clip.way), clip.way, moved.contacts
    )
    assert np.abs(moved.positions - own.positions).max() < 1e-6


@pytest.mark.parametrize("name", ["biped", "hound", "beetle", "snake"])
def test_a_frame_asked_for_alone_is_that_of_the_batch(name: str) -> None:
    directed = _directed(name, *OUTING)
    times = np.linspace(-1.0, 9.0, 41)
    together = directed.evaluate(times)
    for row in (0, 7, 20, 33, 40):
        alone = directed.evaluate(times[row : row + 1])
        assert np.array_equal(alone.positions[0], together.positions[row])
        assert np.array_equal(alone.turns[0], together.turns[row])


@pytest.mark.parametrize("name", ["biped", "hound", "beetle", "snake"])
def test_goals_are_for_the_same_bodies_whatever_a_character_is_told(name: str) -> None:
    assert _directed(name, *OUTING).wanted == director.standing(_character(name)).wanted


@pytest.mark.parametrize("name", ["biped", "hound", "beetle", "bird"])
def test_standing_feet_keep_their_spots_through_all_transitions(name: str) -> None:
    directed = _directed(name, *OUTING)
    model, moved, performed = directed.model, directed.moved, directed.performance
    assert performed is not None
    times = directed.first + np.arange(len(moved.turns), dtype=np.float64)
    frames = performed.frame(times)
    blended = Moved.of(
        model.character, posing.pose_of(model, frames, moved.travel), moved.travel, frames.contacts
    ).positions
    wandering, wanted = spots.in_world(frames.feet, moved.travel), planting.places(model, frames, moved.travel, blended)
    size = model.character.frame.height
    for foot, joint in enumerate(model.feet.tolist()):
        # A foot rolls about its spot as its clips have it; with what is taken out, the spot stays.
        kept = (wanted[:, foot] - blended[:, joint] + wandering[:, foot])[:, :2]
        for first, last in runs(frames.contacts[:, foot] > spots.STANDS):
            assert np.ptp(kept[first : last + 1], axis=0).max() < 1e-9
        missed = np.linalg.norm(moved.positions[:, joint] - wanted[:, foot], axis=-1)
        assert np.quantile(missed, 0.99) < 0.005 * size


@pytest.mark.parametrize(("library", "target"), [("biped", "asura"), ("biped", "lopside"), ("hound", "beetle")])
def test_a_library_of_another_body_is_transferred_once(library: str, target: str) -> None:
    directed = _directed(target, *OUTING, library=library)
    played = _played(directed, directed.course.times)
    assert np.isfinite(played.pose.positions).all()
    bodies = directed.bodies[directed.placed]
    assert np.abs(played.pose.positions[:, bodies] - directed.moved.positions[:, bodies]).max() < 1e-6
    assert float(np.hypot(*directed.moved.travel.places[-1])) > _character(target).frame.height


def test_a_hand_comes_to_what_it_reaches_for_while_the_body_walks_on() -> None:
    size = _character("biped").frame.height
    cup = np.array([-0.15, -0.25, 0.65]) * size
    directed = _directed(
        "biped", _say(0.5, "start", "reach", target="cup"), last=3.0, targets={"cup": Track.at_place(cup)}
    )
    played = _played(directed, np.array([2.5]))
    away = np.linalg.norm(played.pose.positions[0] - cup, axis=-1)
    hands = [
        b for b, n in enumerate(_character("biped").skeleton.names) if "Hand" in n or "Finger" in n or "Thumb" in n
    ]
    assert away[hands].min() < 0.08 * size


def test_who_goes_to_a_place_comes_there_and_keeps_clear_of_what_stands_in_the_way() -> None:
    size = _character("biped").frame.height
    goal, box = (
        np.array([0.5, -4.0, 0.0]) * size,
        np.array([[-0.4, -2.4], [0.6, -2.4], [0.6, -1.6], [-0.4, -1.6]]) * size,
    )
    directed = _directed(
        "biped",
        _say(0.5, "start", "go", target="door", speed=1.2),
        last=12.0,
        targets={"door": Track.at_place(goal)},
        obstacles=(box,),
    )
    places = directed.moved.travel.places
    assert np.hypot(*(places[-1] - goal[:2])) < 0.05 * size
    inside = (np.abs(places - box.mean(axis=0)) < 0.5 * np.ptp(box, axis=0)).all(axis=1)
    assert not inside.any()


def test_what_cannot_be_obeyed_is_told_and_the_rest_plays() -> None:
    directed = _directed(
        "biped",
        _say(0.5, "start", "fly"),
        _say(0.6, "start", "gaze", target="nobody"),
        _say(0.7, "start", "go", place=(0.0, 0.0)),
        _say(0.8, "start", "walk", speed="fast", colour=3.0),
    )
    said = " / ".join(directed.warnings)
    for words in ("fly", "nobody", "it is there already", "speed is 'fast'", "no parameter 'colour'"):
        assert words in said, said
    assert float(np.hypot(*directed.moved.travel.places[-1])) > 1.0
