"""Motion models: what commands make of a motion, its parameters, and the spaces in which examples are mixed."""

import numpy as np
import pytest

from morph_retarget.core import quat
from morph_retarget.core.clips.character_model import RATE
from morph_retarget.core.clips.commands.command import Command, Value, Verb
from morph_retarget.core.clips.models.blend_space import BlendSpace
from morph_retarget.core.clips.models.cycles import Cycles, Way
from morph_retarget.core.clips.models.going import is_loop
from morph_retarget.core.clips.models.mirrored import with_mirrored
from morph_retarget.core.clips.models.models import models_of
from morph_retarget.core.clips.models.pace import Pace, Paced
from morph_retarget.core.clips.models.token import Token
from morph_retarget.core.clips.motions.library import Library
from morph_retarget.core.errors import MotionError
from tests.motion_kit import gait, gesture, library
from tests.random_clips import body

RNG = np.random.default_rng(11)


def told(verb: Verb, model: str, token: Token | None = None, frame: float = 0.0, **parameters: Value) -> Token | None:
    return models_of(library())[model].do_command(Command(frame / RATE, verb, model, parameters), frame, token)


def begun(model: str, frame: float = 0.0, **parameters: Value) -> Token:
    token = told(Verb.START, model, None, frame, **parameters)
    assert token is not None
    return token


# --- blend spaces ---


def test_weights_of_a_blend_space_are_shares_that_make_the_wanted_place() -> None:
    for dimensions in (1, 2, 3):
        space = BlendSpace(RNG.normal(size=(9, dimensions)))
        for _ in range(40):
            inside = RNG.dirichlet(np.ones(9)) @ space.places
            weights = space.weights(inside)
            assert weights.min() >= 0.0
            assert weights.sum() == pytest.approx(1.0)
            assert np.abs(space.place_of(weights) - inside).max() < 1e-6
            assert (weights > 0.0).sum() <= dimensions + 1


def test_an_example_counts_alone_at_its_own_place() -> None:
    space = BlendSpace(RNG.normal(size=(9, 2)))
    assert np.abs(np.array([space.weights(place) for place in space.places]) - np.eye(9)).max() < 1e-9


def test_what_lies_outside_a_blend_space_is_made_as_the_nearest_place_inside() -> None:
    space = BlendSpace(np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]))
    assert np.abs(space.place_of(space.weights(np.array([2.0, 2.0]))) - 0.5).max() < 1e-9
    assert np.abs(space.weights(np.array([-1.0, -3.0])) - np.array([1.0, 0.0, 0.0])).max() < 1e-9


def test_weights_change_continuously_with_the_parameters() -> None:
    space = BlendSpace(RNG.normal(size=(8, 2)))
    line = np.linspace(-2.0, 2.0, 801)[:, None] * np.array([0.8, 0.6]) + 0.1
    weights = np.array([space.weights(place) for place in line])
    assert np.abs(np.diff(weights, axis=0)).max() < 0.2


def test_dimensions_along_which_no_examples_differ_do_not_count() -> None:
    space = BlendSpace(np.array([[1.0, 5.0], [2.0, 5.0]]))
    assert np.abs(space.weights(np.array([1.25, -40.0])) - np.array([0.75, 0.25])).max() < 1e-9


def test_a_blend_space_without_examples_is_refused() -> None:
    with pytest.raises(MotionError, match="no examples"):
        BlendSpace(np.zeros((0, 2)))
    with pytest.raises(MotionError, match="no number"):
        BlendSpace(np.array([[np.nan]]))


# --- paces ---


def test_a_pace_goes_over_to_another_rate_without_a_jump_and_keeps_what_was_before() -> None:
    first = Pace.steady(10.0, 3.2, 0.05)
    pace = first.going_over(30.5, 0.02, 12.0).going_over(35.0, 0.09, 7.5)
    early, late = np.linspace(-20.0, 30.5, 60), np.linspace(42.5, 90.0, 60)
    assert np.abs(pace.at(early) - first.at(early)).max() < 1e-12
    assert np.abs(np.diff(pace.at(late)) / np.diff(late) - 0.09).max() < 1e-12
    steps = np.diff(pace.at(np.linspace(0.0, 90.0, 9001)))
    assert steps.min() > 0.0
    assert np.abs(np.diff(steps)).max() < 3e-4


def test_a_phase_is_reached_at_the_first_frame_at_which_the_pace_is_there() -> None:
    pace = Pace.steady(0.0, 0.3, 0.04).going_over(20.0, 0.07, 15.0)
    for frame in (-30.0, 5.0, 24.3, 100.0):
        for phase in (0.0, 0.25, 0.9):
            reached = pace.reached(phase, frame)
            at = float(pace.at(np.array([reached]))[0])
            assert reached >= frame
            assert abs((at - phase + 0.5) % 1.0 - 0.5) < 1e-9
            assert at - float(pace.at(np.array([frame]))[0]) < 1.0 + 1e-9


# --- going ---


@pytest.mark.parametrize("speed", [0.5, 1.0, 1.3, 1.8, 2.5])
@pytest.mark.parametrize("turn", [0.0, 0.25])
def test_a_mixed_cycle_goes_exactly_as_fast_as_it_is_told_to_and_turns_so(speed: float, turn: float) -> None:
    loops = tuple(m for m in library().of_kind("walk") if is_loop(m) and not m.annotations.style)
    cycle, _ = Cycles(loops).at(Way(speed, turn * min(speed, 1.0)))
    paced = Paced(Pace.steady(0.0, 0.0, cycle.rate), cycle.clip, cycle.period, cycle.zero, 0.0)
    way = paced.travel(np.linspace(0.0, 10.0 / cycle.rate, 4001))
    length = np.hypot(*np.diff(way.places, axis=0).T).sum() * cycle.rate / 10.0
    assert length * RATE == pytest.approx(speed, rel=2e-3)
    if speed <= 1.0:  # the turning loops are as slow
        assert way.headings[-1] * cycle.rate / 10.0 * RATE == pytest.approx(turn * min(speed, 1.0), abs=5e-3)


def test_cycles_in_step_strike_at_the_same_phases() -> None:
    models = models_of(library())
    walk, run = (Cycles(tuple(m for m in models[k].motions if is_loop(m))) for k in ("walk", "run"))
    for cycles, way in ((walk, Way(1.4)), (run, Way(4.0)), (walk, Way(0.7, 0.2))):
        assert np.abs(np.array(cycles.at(way)[0].strikes) - np.array([0.0, 0.5])).max() < 1e-9


def test_what_loops_cannot_do_is_told_in_words() -> None:
    loops = Cycles(tuple(m for m in library().of_kind("run") if is_loop(m)))
    assert "instead of 40" in loops.at(Way(40.0))[1]
    assert "turns" in loops.at(Way(3.0, 1.0))[1]
    assert not loops.at(Way(3.5))[1]


def test_starting_twice_with_the_same_parameters_changes_nothing() -> None:
    for model in ("walk", "dance", "wave", "sit"):
        token = begun(model)
        assert told(Verb.START, model, token, 7.0) is token
        assert told(Verb.START, model, token, 7.0, **dict(token.command.parameters)) is token


def test_stopping_what_was_not_started_makes_no_token() -> None:
    for model in ("walk", "run", "idle", "wave", "jump"):
        assert told(Verb.STOP, model) is None
        assert told(Verb.RESET, model) is None


def test_resetting_ends_at_once() -> None:
    for model in ("walk", "wave", "dance"):
        assert told(Verb.RESET, model, begun(model), 4.0) is None


def test_a_walk_that_is_stopped_ends_standing_and_stopping_it_again_changes_nothing() -> None:
    for frame in (15.0, 33.3, 61.0, 80.0):
        stopped = told(Verb.STOP, "walk", begun("walk"), frame)
        assert stopped is not None
        assert stopped.is_finite
        assert frame < stopped.last < frame + 80.0
        assert told(Verb.STOP, "walk", stopped, frame + 1.0) is stopped
        assert stopped.tree is not None
        last = stopped.tree.frame(np.array([stopped.last]))
        assert last.contacts.min() == 1.0
        assert quat.angle_between(last.rotations, quat.identity(1, 1)).max() < 1e-6


def test_a_run_without_a_stop_clip_ends_as_a_foot_strikes() -> None:
    stopped = told(Verb.STOP, "run", begun("run"), 33.0)
    assert stopped is not None
    assert stopped.tree is not None
    around = stopped.tree.frame(stopped.last + np.array([-1.0, 0.0])).contacts
    assert (around[1] - around[0]).max() > 0.5


def test_a_walk_stopped_before_a_foot_has_left_the_ground_ends_there() -> None:
    kit = library()
    slow = gesture("walk", 30, ("legs",), 0.0, phase="start")  # stands all the time
    models = models_of(Library(body(), (*(m for m in kit.motions if m.name != "walk start"), slow)))
    token = models["walk"].do_command(Command(0.0, Verb.START, "walk"), 0.0, None)
    stopped = models["walk"].do_command(Command(0.2, Verb.STOP, "walk"), 6.0, token)
    assert stopped is not None
    assert stopped.last == 6.0


@pytest.mark.parametrize("change", [{"speed": 1.7}, {"turn": 0.5}, {"style": "happy"}, {"speed": 0.6, "turn": -0.2}])
def test_a_change_of_parameters_is_a_blend_in_step(change: dict[str, Value]) -> None:
    token = begun("walk")
    changed = told(Verb.START, "walk", token, 70.4, **change)
    assert changed is not None
    assert token.tree is not None
    assert changed.tree is not None
    early = np.linspace(60.0, 70.4, 30)
    assert quat.angle_between(token.tree.frame(early).rotations, changed.tree.frame(early).rotations).max() < 1e-6
    times = np.linspace(60.0, 120.0, 601)
    frames, way = changed.tree.frame(times), changed.tree.travel(times)
    assert quat.angle_between(frames.rotations[1:], frames.rotations[:-1]).max() < 0.05
    assert np.hypot(*np.diff(way.places, axis=0).T).max() * RATE * 10.0 < 2.2


def test_a_run_takes_over_from_a_walk_at_the_same_phase() -> None:
    walk = begun("walk")
    run = models_of(library())["run"].do_command(Command(2.0, Verb.START, "run"), 60.0, walk)
    assert run is not None
    assert run.model == "run"
    assert run.tree is not None
    assert walk.tree is not None
    at = np.array([60.0])
    assert quat.angle_between(run.tree.frame(at).rotations, walk.tree.frame(at).rotations).max() < 1e-6
    late = run.tree.travel(np.array([200.0, 230.0]))
    assert float(np.hypot(*np.diff(late.places, axis=0)[0])) == pytest.approx(3.0, rel=1e-3)


def test_speeds_are_those_of_the_body_that_shows_the_motion() -> None:
    models = models_of(library(), 2.0)
    token = models["walk"].do_command(Command(0.0, Verb.START, "walk", {"speed": 2.4}), 0.0, None)
    assert token is not None
    assert token.tree is not None
    way = token.tree.travel(np.array([100.0, 130.0]))
    assert float(np.hypot(*np.diff(way.places, axis=0)[0])) == pytest.approx(1.2, rel=1e-3)


# --- performing ---


def test_a_motion_lasts_as_its_tempo_and_its_repetitions_say() -> None:
    assert begun("wave").last == pytest.approx(24.0)
    assert begun("wave", tempo=2.0).last == pytest.approx(12.0)
    assert begun("wave", 10.0, repeat=3.0).last == pytest.approx(10.0 + 3 * 25 - 1)
    assert not begun("wave", repeat=0.0).is_finite
    assert not begun("dance").is_finite
    assert begun("dance", repeat=2.0).last == pytest.approx(59.0)


def test_a_motion_that_is_stopped_ends_with_the_repetition_that_is_under_way() -> None:
    stopped = told(Verb.STOP, "dance", begun("dance"), 40.0)
    assert stopped is not None
    assert stopped.last == pytest.approx(59.0)
    stopped = told(Verb.STOP, "wave", begun("wave", repeat=4.0), 30.0)
    assert stopped is not None
    assert stopped.last == pytest.approx(49.0)


def test_a_motion_with_a_start_and_a_stop_plays_them_around_its_loop() -> None:
    token = begun("sit")
    assert not token.is_finite
    stopped = told(Verb.STOP, "sit", token, 40.0)
    assert stopped is not None
    assert stopped.tree is not None
    assert stopped.last == pytest.approx(14.0 + 2 * 20.0 - 1.0 + 14.0, abs=1.1)
    times = np.arange(0.0, stopped.last + 1.0)
    turned = quat.angle_between(stopped.tree.frame(times).rotations, quat.identity(1, 1)).max(axis=1)
    assert turned[:14].max() > 0.6
    assert turned[-14:].max() > 0.6


def test_an_amplitude_scales_what_a_motion_does_beyond_its_first_frame() -> None:
    times = np.arange(25.0)
    trees = [begun("wave", amplitude=size).tree for size in (0.0, 0.5, 1.0)]
    turned = [quat.angle_between(tree.frame(times).rotations, quat.identity(1, 1)) for tree in trees if tree]
    assert turned[0].max() < 1e-9
    assert np.abs(turned[1] - 0.5 * turned[2]).max() < 1e-6


def test_jumps_of_two_heights_make_those_between() -> None:
    low, middle, high = (begun("jump", height=height) for height in (0.3, 0.5, 0.7))
    assert middle.last == pytest.approx(0.5 * (low.last + high.last))
    assert models_of(library())["jump"].parameters["height"].default in {0.3, 0.7}


def test_what_is_there_for_one_side_is_done_with_the_other_as_well() -> None:
    model = body()
    left, right = (begun("wave", side=side) for side in ("left", "right"))
    assert (left.crucial == model.part("left arm")).all()
    assert (right.crucial == model.part("right arm")).all()
    assert left.tree is not None
    turned = quat.angle_between(left.tree.frame(np.array([12.0])).rotations, quat.identity(1, 1))[0]
    assert turned[model.part("left arm")].max() > 0.8
    assert turned[~model.part("left arm")].max() < 1e-9


def test_mirror_images_are_added_only_for_what_has_no_counterpart() -> None:
    turning = (gait("walk", 1.0, 30, 0.6),)
    both = with_mirrored(turning)
    assert [motion.annotations.turn_rate for motion in both] == [0.6, -0.6]
    assert with_mirrored(both) == both
    assert with_mirrored((gait("walk", 1.0, 30),))[1:] == ()


def test_motions_block_what_their_annotations_say() -> None:
    model, models = body(), models_of(library())
    legs = models["walk"].crucial(Command(0.0, Verb.START, "walk"))
    assert (legs >= model.part("legs")).all()
    assert legs[model.root]
    assert not (legs & model.part("arms")).any()
    assert models["jump"].crucial(Command(0.0, Verb.START, "jump")).all()
    assert not models["idle"].crucial(Command(0.0, Verb.START, "idle")).any()
