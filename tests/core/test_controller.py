"""The motion controller: tokens, blocking, transitions, and performances as functions of time."""

from collections.abc import Sequence

import numpy as np
import pytest

from morph_retarget.core import quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.clips.character_model import RATE
from morph_retarget.core.clips.clip import Clip
from morph_retarget.core.clips.commands.command import Command, Value, Verb
from morph_retarget.core.clips.models.controller import Placing, perform
from morph_retarget.core.clips.models.performance import Performance
from morph_retarget.core.clips.models.transitions import depth
from morph_retarget.core.clips.motions.library import Library
from tests.command_lists import random_commands
from tests.motion_kit import library
from tests.random_clips import apart, body, difference
from tests.transition_measures import measured, slides

START, STOP, RESET = Verb.START, Verb.STOP, Verb.RESET


def do(time: float, verb: Verb, model: str, **parameters: Value) -> Command:
    return Command(time, verb, model, parameters, f"line {time:g}")


def played(*commands: Command, placings: Sequence[Placing] = ()) -> Performance:
    return perform(library(), commands, placings=placings)


def names(performance: Performance, second: float) -> list[str]:
    return [token.model for token in performance.tokens_at(second * RATE) if not token.waits]


def waiting(performance: Performance, second: float) -> list[str]:
    return [token.model for token in performance.tokens_at(second * RATE) if token.waits]


DANCE = (
    do(0.5, START, "walk"),
    do(1.2, START, "wave"),
    do(2.0, START, "walk", speed=1.7, turn=0.3),
    do(3.1, START, "run"),
    do(3.4, START, "wave", side="left"),
    do(4.6, START, "walk"),
    do(5.5, STOP, "walk"),
    do(6.0, START, "jump", height=0.5),
    do(9.0, START, "dance"),
    do(10.0, STOP, "dance"),
    do(12.0, START, "run"),
    do(13.0, RESET, "run"),
)


# --- functions of time ---


def test_any_frame_alone_is_what_it_is_among_all() -> None:
    performance = played(*DANCE)
    times = np.random.default_rng(3).uniform(-10.0, 480.0, 60)
    frames, way = performance.frame(times), performance.travel(times)
    again = played(*DANCE)
    for i, time in enumerate(times):
        assert difference(again.frame(np.array([time])), frames[i : i + 1]) < 1e-12
        assert apart(again.travel(np.array([time])), way[i : i + 1]) < 1e-12


def test_the_pose_and_the_way_over_the_ground_never_jump() -> None:
    performance = played(*DANCE)
    for segment in performance.segments[1:]:
        around = segment.start + np.array([-1e-7, 0.0])
        frames, way = performance.frame(around), performance.travel(around)
        assert quat.angle_between(frames.rotations[0], frames.rotations[1]).max() < 1e-5
        assert np.abs(frames.feet[0] - frames.feet[1]).max() < 1e-5
        assert np.abs(frames.translations[0] - frames.translations[1]).max() < 1e-5
        assert apart(way[:1], way[1:]) < 1e-5


def test_commands_are_obeyed_in_order_of_time_and_those_of_one_time_in_their_own() -> None:
    shuffled = [DANCE[i] for i in np.random.default_rng(1).permutation(len(DANCE))]
    times = np.arange(0.0, 450.0, 3.0)
    assert difference(played(*shuffled).frame(times), played(*DANCE).frame(times)) == 0.0
    assert names(played(do(1.0, START, "wave"), do(1.0, RESET, "wave")), 1.5) == ["idle"]
    assert names(played(do(1.0, RESET, "wave"), do(1.0, START, "wave")), 1.5) == ["idle", "wave"]


def test_without_commands_the_character_idles_and_without_that_it_rests() -> None:
    assert names(played(), 100.0) == ["idle"]
    nothing = perform(Library(body()), ())
    assert quat.angle_between(nothing.frame(np.arange(5.0)).rotations, quat.identity(1, 1)).max() == 0.0
    assert np.abs(nothing.travel(np.arange(5.0)).places).max() == 0.0


# --- the list of tokens ---


def test_motions_have_influence_from_their_command_until_their_transition_is_over() -> None:
    performance = played(do(1.0, START, "dance", repeat=1.0))
    assert names(performance, 0.9) == ["idle"]
    token = next(token for token in performance.tokens_at(40.0) if token.model == "dance")
    assert token.last == pytest.approx(59.0)
    ended = next(token for token in performance.tokens_at(60.0) if token.model == "dance")
    assert ended.influence > ended.last
    assert names(performance, ended.influence / RATE + 0.01) == ["idle"]


def test_starting_again_with_the_same_parameters_leaves_the_performance_as_it_is() -> None:
    once = played(do(1.0, START, "walk", speed=1.2))
    twice = played(do(1.0, START, "walk", speed=1.2), do(2.0, START, "walk", speed=1.2), do(3.0, START, "walk"))
    assert [segment.start for segment in once.segments] == [segment.start for segment in twice.segments]


def test_stopping_or_resetting_what_was_not_started_does_nothing() -> None:
    performance = played(do(1.0, STOP, "walk"), do(1.5, RESET, "wave"), do(2.0, STOP, "jump"))
    assert len(performance.segments) == 1
    assert not performance.warnings


def test_a_motion_that_was_reset_is_gone_at_once() -> None:
    performance = played(do(1.0, START, "walk"), do(3.0, RESET, "walk"))
    assert names(performance, 2.9) == ["idle", "walk"]
    assert names(performance, 3.0) == ["idle"]


def test_a_wave_over_a_walk_leaves_the_legs_to_the_walk() -> None:
    walk, both = played(do(0.0, START, "walk")), played(do(0.0, START, "walk"), do(2.0, START, "wave"))
    times = np.arange(0.0, 120.0)
    arm = body().part("right arm")
    a, b = walk.frame(times), both.frame(times)
    assert quat.angle_between(a.rotations, b.rotations)[:, ~arm].max() < 1e-6
    assert quat.angle_between(a.rotations, b.rotations)[72][arm].max() > 0.5
    assert np.abs(a.feet - b.feet).max() < 1e-9
    assert apart(walk.travel(times), both.travel(times)) < 1e-9


def test_a_wave_goes_on_when_a_walk_begins_under_it() -> None:
    both = played(do(0.0, START, "wave", repeat=0.0), do(1.0, START, "walk"))
    arm = body().part("right arm")
    alone = played(do(0.0, START, "wave", repeat=0.0))
    times = np.arange(70.0, 120.0)
    assert quat.angle_between(both.frame(times).rotations, alone.frame(times).rotations)[:, arm].max() < 1e-6
    assert np.hypot(*both.travel(times).places[-1]) > 1.0


def test_a_motion_that_needs_joints_of_a_finite_one_is_played_after_it() -> None:
    performance = played(do(1.0, START, "jump"), do(1.2, START, "dance"))
    jump = next(token for token in performance.tokens_at(35.0) if token.model == "jump")
    assert waiting(performance, 1.3) == ["dance"]
    dance = next(token for token in performance.tokens_at(jump.last + 1.0) if token.model == "dance")
    assert dance.start == jump.last


def test_a_motion_that_needs_joints_of_one_without_end_waits_until_that_is_stopped() -> None:
    performance = played(do(0.0, START, "walk"), do(1.0, START, "jump"), do(4.0, STOP, "walk"))
    assert waiting(performance, 3.9) == ["jump"]
    walk = next(token for token in performance.tokens_at(4.1 * RATE) if token.model == "walk")
    jump = next(token for token in performance.tokens_at(walk.last + 1.0) if token.model == "jump")
    assert jump.start == walk.last
    assert performance.settled > jump.last
    waited = walk.last / RATE - 1.0
    assert performance.warnings == (f"line 1: start jump: it waits {waited:.1f} s for walk to end",)


def test_a_motion_that_never_gets_its_joints_is_told_of() -> None:
    performance = played(do(0.0, START, "walk"), do(1.0, START, "jump"))
    assert waiting(performance, 1000.0) == ["jump"]
    assert len(performance.warnings) == 1
    assert "line 1: start jump" in performance.warnings[0]
    assert "walk" in performance.warnings[0]


def test_motions_that_wait_begin_in_their_order() -> None:
    performance = played(do(0.0, START, "jump"), do(0.1, START, "dance", repeat=1.0), do(0.2, START, "walk"))
    starts = {token.model: token.start for segment in performance.segments for token in segment.tokens if token.tree}
    assert starts["jump"] < starts["dance"] < starts["walk"]


def test_what_waits_can_be_changed_and_given_up() -> None:
    blocked = (do(0.0, START, "walk"), do(1.0, START, "jump", height=0.3))
    end = do(4.0, STOP, "walk")
    changed = played(*blocked, do(2.0, START, "jump", height=0.7), end)
    plain = played(do(0.0, START, "walk"), do(1.0, START, "jump", height=0.7), end)
    times = np.arange(0.0, 300.0, 2.0)
    assert difference(changed.frame(times), plain.frame(times)) == 0.0
    for verb in (STOP, RESET):
        given_up = played(*blocked, do(2.0, verb, "jump"), end)
        assert "jump" not in {name for second in range(12) for name in names(given_up, second)}


def test_a_run_replaces_a_walk_and_takes_its_place_before_what_waits() -> None:
    performance = played(do(0.0, START, "walk"), do(1.0, START, "jump"), do(2.0, START, "run"), do(5.0, STOP, "run"))
    assert names(performance, 2.1) == ["idle", "run"]
    assert waiting(performance, 2.1) == ["jump"]
    assert "jump" in names(performance, 5.6)


def test_a_motion_stays_as_it_is_if_what_it_is_told_to_be_needs_joints_of_another() -> None:
    commands = (do(0.0, START, "wave", side="left", repeat=0.0), do(0.1, START, "wave", side="right"))
    assert not played(*commands).warnings
    held = played(do(0.0, START, "walk"), do(0.5, START, "walk", speed=1.5), do(0.6, START, "wave"))
    assert not held.warnings


def test_a_motion_that_is_over_can_be_started_again_while_it_still_has_influence() -> None:
    performance = played(do(0.0, START, "dance", repeat=1.0), do(30.0 / RATE, START, "dance"))
    found = [token for token in performance.tokens_at(31.0) if token.model == "dance"]
    assert sorted(token.start for token in found) == [0.0, 30.0]


# --- bad input ---


def test_an_unknown_model_is_told_of_and_the_rest_plays() -> None:
    performance = played(do(1.0, START, "fly"), do(2.0, START, "walk"))
    assert performance.warnings[0].startswith("line 1: start fly: there is no motion model of this name")
    assert "walk" in performance.warnings[0]
    assert names(performance, 3.0) == ["idle", "walk"]


def test_parameters_of_the_wrong_type_are_ignored_with_a_warning() -> None:
    odd = played(do(1.0, START, "walk", speed="fast", turn=0.2), do(2.0, START, "wave", mood=3.0))
    plain = played(do(1.0, START, "walk", turn=0.2), do(2.0, START, "wave"))
    times = np.arange(0.0, 120.0, 2.0)
    assert difference(odd.frame(times), plain.frame(times)) == 0.0
    assert len(odd.warnings) == 2
    assert "speed" in odd.warnings[0]
    assert "mood" in odd.warnings[1]


# --- places ---


def test_a_character_that_is_put_somewhere_goes_on_from_there() -> None:
    plain = played(do(0.0, START, "walk"))
    put = played(do(0.0, START, "walk"), placings=[Placing(60.0, (3.0, -4.0), 1.0)])
    before, after = np.arange(0.0, 60.0), np.arange(60.0, 120.0)
    assert apart(put.travel(before), plain.travel(before)) < 1e-12
    assert difference(put.frame(np.arange(120.0)), plain.frame(np.arange(120.0))) == 0.0
    way = put.travel(after)
    assert np.abs(way.places[0] - np.array([3.0, -4.0])).max() < 1e-12
    assert way.headings[0] == pytest.approx(1.0)
    own = plain.travel(after)
    assert apart(way.since(way[:1]), own.since(own[:1])) < 1e-9


def test_commands_before_the_first_second_are_obeyed_too() -> None:
    performance = played(do(-2.0, START, "walk"))
    assert np.hypot(*performance.travel(np.array([0.0])).places[0]) > 0.5


# --- transitions ---


def test_in_no_transition_a_joint_turns_much_faster_than_in_what_is_blended() -> None:
    for own in measured(library(), (2.3,)):
        assert own.whole
        assert own.faster < 1.5, own


def test_feet_that_stand_hardly_slide_where_a_walk_changes_its_speed_and_its_turn() -> None:
    performance = played(
        do(0.0, START, "walk"), do(2.0, START, "walk", speed=1.5), do(4.0, START, "walk", speed=0.9, turn=0.4)
    )
    times = np.arange(50.0, 200.0)
    assert np.quantile(slides(performance, times), 0.98) < 2.0
    assert slides(performance, times).max() < 8.0


def test_feet_take_steps_where_a_walk_that_is_reset_stands_otherwise() -> None:
    performance = played(do(0.0, START, "walk"), do(3.0, RESET, "walk"))
    times = np.arange(88.0, 130.0, 0.5)
    assert slides(performance, times).max() < 2.0
    contacts = performance.frame(times).contacts
    assert contacts.max(axis=1).min() > 0.5
    assert contacts[-1].min() == 1.0


# --- many commands ---


def test_many_changes_in_a_short_time_keep_the_tree_small_and_the_pose_smooth() -> None:
    commands = [do(1.0 + 0.06 * i, START, "walk", speed=0.6 + 0.1 * (i % 9)) for i in range(16)]
    commands += [do(3.0 + 0.05 * i, (START, RESET)[i % 2], "wave") for i in range(16)]
    performance = played(*commands)
    assert max(depth(segment.tree) for segment in performance.segments) < 45
    times = np.arange(0.0, 200.0, 0.5)
    assert quat.angle_between(*_neighbours(performance, times)).max() < 0.2


@pytest.mark.parametrize("block", range(6))
def test_random_commands_end_without_an_error_a_number_that_is_none_or_a_token_left(block: int) -> None:
    for seed in range(10 * block, 10 * (block + 1)):
        commands = random_commands(seed)
        performance = perform(library(), commands)
        end = performance.segments[-1].start
        times = np.random.default_rng(seed).uniform(-30.0, end + 60.0, 12)
        frames, way = performance.frame(times), performance.travel(times)
        for values in (frames.rotations, frames.translations, frames.feet, frames.contacts, way.places, way.headings):
            assert np.isfinite(values).all(), seed
        assert np.abs(quat.length(frames.rotations) - 1.0).max() < 1e-9, seed
        tokens = performance.tokens_at(end + 1e6)
        assert not any(token.is_finite for token in tokens), seed
        assert len({token.model for token in tokens}) == len(tokens), seed


def _neighbours(performance: Performance, times: Array) -> tuple[Array, Array]:
    rotations = performance.frame(times).rotations
    return rotations[1:], rotations[:-1]


def _all(tree: Clip) -> list[Clip]:
    return [tree, *(below for part in tree.parts for below in _all(part))]


def test_no_clip_of_a_tree_is_made_for_another_body() -> None:
    for segment in played(*DANCE).segments:
        assert {clip.model for clip in _all(segment.tree)} == {body()}
