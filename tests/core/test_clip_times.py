"""Operators that change when a clip shows what: shifts, sections, loops, reversals and warps."""

import numpy as np
import pytest

from morph_retarget.core import quat
from morph_retarget.core.clips.character_model import CharacterModel
from morph_retarget.core.clips.clip import Clip, ClipPrimitive
from morph_retarget.core.clips.frames import Frames
from morph_retarget.core.clips.operators import ways
from morph_retarget.core.clips.operators.loop import Loop
from morph_retarget.core.clips.operators.revert import Revert
from morph_retarget.core.clips.operators.section import Section
from morph_retarget.core.clips.operators.time_shift import TimeShift, started_at
from morph_retarget.core.clips.operators.time_warp import TimeWarp
from morph_retarget.core.clips.travel import Travel
from tests.random_clips import apart, body, difference, times_of, wander

A = wander(1)
LATE = wander(4, 15, first=7.0)


def _same(first: Clip, second: Clip, until: float = 150.0) -> None:
    assert first.start == pytest.approx(second.start)
    assert first.length == pytest.approx(second.length)
    assert (first.active == second.active).all()
    times = times_of(first, until=until)
    assert difference(first.frame(times), second.frame(times)) < 1e-7
    assert apart(first.travel(times), second.travel(times)) < 1e-9


def _ring(frames: int = 20, turning: float = 0.03) -> ClipPrimitive:
    """Return a cycle whose last frame leads on to its first, evenly."""
    model: CharacterModel = body()
    phase = np.arange(frames) / frames * 2.0 * np.pi
    waves = np.sin(phase[:, None, None] + np.arange(len(model) * 3).reshape(-1, 3))
    rest = Frames.at_rest(model, frames)
    data = Frames(quat.from_rotation_vector(0.4 * waves), rest.translations, rest.feet, rest.contacts)
    steps = Travel(np.tile([0.01, -0.04], (frames - 1, 1)), np.full(frames - 1, turning))
    return ClipPrimitive("ring", model, data, steps.summed())


# --- TimeShift and Section ---


def test_a_shift_shows_at_t_what_was_shown_before() -> None:
    shifted, times = TimeShift(3.5, LATE), times_of(LATE)
    assert shifted.start == LATE.start + 3.5
    assert difference(shifted.frame(times + 3.5), LATE.frame(times)) < 1e-12


def test_a_shift_back_undoes_a_shift() -> None:
    _same(TimeShift(-3.25, TimeShift(3.25, A)), A)


def test_what_starts_at_a_frame_already_is_not_shifted() -> None:
    assert started_at(7.0, LATE) is LATE
    assert started_at(2.0, LATE).start == 2.0


def test_a_section_shows_the_same_as_the_clip_and_sets_out_anew() -> None:
    section = Section(4.0, 12.0, A)
    times = times_of(section)
    assert (section.start, section.length) == (4.0, 9.0)
    assert difference(section.frame(times), A.frame(times)) == 0.0
    assert apart(A.travel(np.array([4.0])).then(section.travel(times)), A.travel(times)) < 1e-12


def test_a_section_beyond_the_end_holds_the_last_frame() -> None:
    section = Section(10.0, np.inf, A)
    assert not section.is_finite
    assert difference(section.frame(np.array([900.0])), A.frame(np.array([A.end]))) == 0.0


# --- Loop ---


@pytest.mark.parametrize(("outer", "inner"), [(3, 2), (0, 2), (2, 0), (1, 1), (-1, 4)])
def test_a_loop_of_a_loop_is_one_loop(outer: int, inner: int) -> None:
    count = max(outer, 0) * max(inner, 0)
    _same(Loop(outer, Loop(inner, A)), Loop(count, A))
    _same(Loop(outer, Loop(inner, A, 5.0)), Loop(count, A, 5.0))


def test_a_clip_without_end_is_not_looped() -> None:
    endless = Loop(0, A)
    _same(Loop(3, endless), endless)


def test_a_loop_shows_the_clip_again_and_again() -> None:
    times = times_of(LATE)
    for count, around in ((0, 6), (4, 3)):
        for k in range(around):
            shown = Loop(count, LATE).frame(times + k * LATE.length)
            assert difference(shown, LATE.frame(times)) < 1e-9
    assert Loop(4, LATE).length == 4 * LATE.length
    assert not Loop(0, LATE).is_finite


def test_a_round_leads_as_far_as_each_other() -> None:
    loop = Loop(0, A)
    way = loop.travel(loop.start + loop.cycle * np.arange(6))
    assert apart(way.steps(), way.steps()[np.zeros(5, dtype=int)]) < 1e-9


@pytest.mark.parametrize("turning", [0.0, 1e-9, 0.03, 2.0 * np.pi / 20.0, -np.pi / 20.0])
def test_a_loop_of_even_steps_goes_on_evenly(turning: float) -> None:
    loop, step = Loop(0, _ring(turning=turning)), _ring(turning=turning).way.steps()[:1]
    way = loop.travel(np.arange(0.0, 200.0))
    assert apart(way.steps(), step[np.zeros(199, dtype=int)]) < 1e-9


def test_rounds_of_a_way_are_its_steps_one_after_the_other() -> None:
    rng = np.random.default_rng(3)
    for heading in (0.0, 1e-8, 0.7, np.pi, 2.0 * np.pi, 7.0, -9.0):
        cycle = Travel(rng.normal(size=(1, 2)), np.array([heading]))
        slow = Travel(np.repeat(cycle.places, 30, axis=0), np.repeat(cycle.headings, 30)).summed()
        assert apart(ways.repeated(cycle, np.arange(31.0)), slow) < 1e-7


def test_a_clip_of_one_frame_is_looped_where_it_stands() -> None:
    still = ClipPrimitive("one", body(), A.data[:1], A.way[:1])
    loop = Loop(0, still, blend=0.5)
    assert difference(loop.frame(np.array([0.0, 7.3])), still.frame(np.zeros(2))) < 1e-12
    assert apart(loop.travel(np.array([7.3])), Travel.still()) < 1e-12


def test_blended_ends_make_the_seam_as_smooth_as_the_rest() -> None:
    times = np.arange(0.0, 3.0 * A.length, 1.0)

    def sharpest(clip: Clip) -> tuple[float, float]:
        turns = clip.frame(times).rotations
        steps = quat.to_rotation_vector(quat.multiply(quat.conjugate(turns[:-1]), turns[1:]))
        return float(np.abs(np.diff(steps, axis=0)).max()), float(quat.length(steps).max())

    bare, blended = sharpest(Loop(0, A)), sharpest(Loop(0, A, 8.0))
    assert blended[0] < 0.15 * bare[0]
    assert blended[1] < 0.25 * bare[1]


def test_ends_are_bent_nowhere_but_near_the_seam_and_meet_there() -> None:
    loop, times = Loop(0, A, 6.0), np.arange(6.0, 18.01, 0.5)
    assert difference(loop.frame(times), A.frame(times)) < 1e-12
    seam = loop.frame(np.array([loop.cycle - 1.0, loop.cycle, loop.cycle + 1.0])).feet
    own = np.diff(A.data.feet, axis=0)
    assert np.abs(np.diff(seam, axis=0)).max() < 3.0 * np.abs(own).max()


def test_a_cycle_whose_ends_fit_is_not_bent() -> None:
    ring = _ring()
    times = times_of(Loop(0, ring))
    assert difference(Loop(0, ring, 8.0).frame(times), Loop(0, ring).frame(times)) < 0.03 * 0.4
    assert difference(Loop(0, ring, 8.0).frame(np.arange(20.0)), ring.frame(np.arange(20.0))) < 0.03 * 0.4


def test_a_warped_cycle_closes_as_slowly_as_it_goes() -> None:
    ring = _ring(turning=0.0)
    warp = TimeWarp(((0.0, 0.0), (19.0, 38.0)), ring)  # eqs. 15 and 16, at half the speed
    slow = Loop(0, warp, closing=2.0)
    assert slow.cycle == 40.0
    times = np.arange(0.0, 200.0, 0.5)
    assert difference(slow.frame(2.0 * times), Loop(0, ring).frame(times)) < 1e-9
    assert apart(slow.travel(2.0 * times), Loop(0, ring).travel(times)) < 1e-9


# --- Revert ---


def test_a_clip_reverted_goes_back_from_where_it_is_turned() -> None:
    back = Revert(15.0, LATE)
    assert (back.start, back.length) == (15.0, 9.0)
    times = times_of(back)
    assert difference(back.frame(times), LATE.frame(30.0 - times)) < 1e-12
    end = back.travel(np.array([back.end]))
    assert apart(end, LATE.travel(np.array([15.0])).inverse()) < 1e-12


def test_reverted_twice_it_is_the_clip_again_later() -> None:
    once = Revert(LATE.end, LATE)
    _same(Revert(once.end, once), TimeShift(2.0 * (LATE.end - LATE.start), LATE))


@pytest.mark.parametrize("turning", [6.0, 21.5, -3.0])
def test_a_clip_turned_outside_of_its_frames_stays_as_it_is(turning: float) -> None:
    _same(Revert(turning, LATE), LATE)
    if turning < 7.0:
        _same(Revert(turning, Loop(0, LATE)), Loop(0, LATE))


def test_a_clip_without_end_reverted_has_one() -> None:
    back = Revert(100.0, Loop(0, LATE))
    assert back.length == 94.0
    assert difference(back.frame(np.array([193.0])), LATE.frame(np.array([7.0]))) < 1e-12


# --- TimeWarp ---


def test_keys_that_stay_leave_the_clip_as_it_is() -> None:
    for keys in ((), ((7.0, 7.0), (21.0, 21.0)), ((9.0, 9.0),), ((-5.0, 90.0), (30.0, 91.0))):
        _same(TimeWarp(keys, LATE), LATE)


def test_one_key_is_a_shift() -> None:
    _same(TimeWarp(((10.0, 14.5),), LATE), TimeShift(4.5, LATE))
    _same(TimeWarp(((10.0, 14.5),), Loop(0, LATE)), TimeShift(4.5, Loop(0, LATE)))


def test_keys_show_their_frames_at_their_places_and_time_is_linear_between() -> None:
    keys = ((8.0, 0.0), (12.0, 10.0), (20.0, 14.0))
    warp = TimeWarp(keys, LATE)
    assert difference(warp.frame(np.array([0.0, 10.0, 14.0])), LATE.frame(np.array([8.0, 12.0, 20.0]))) < 1e-12
    assert difference(warp.frame(np.array([5.0, 12.0])), LATE.frame(np.array([10.0, 16.0]))) < 1e-12
    # Beyond the keys it runs on as it did.
    assert (warp.start, warp.end) == (-1.0, 15.0)


def test_keys_outside_of_the_clip_are_ignored() -> None:
    inside = ((8.0, 0.0), (12.0, 10.0))
    _same(TimeWarp(((6.0, -50.0), *inside, (22.0, 11.0)), LATE), TimeWarp(inside, LATE))
    _same(TimeWarp(((6.0, -50.0), *inside), Loop(0, LATE)), TimeWarp(inside, Loop(0, LATE)))


def test_keys_on_both_ends_decide_the_length() -> None:
    warp = TimeWarp(((7.0, 0.0), (21.0, 14.0 * 1.3)), LATE)  # eq. 17
    assert (warp.start, warp.length) == (0.0, pytest.approx(14.0 * 1.3 + 1.0))


def test_a_key_that_stays_is_a_pause() -> None:
    warp = TimeWarp(((10.0, 10.0), (10.0, 16.0)), LATE)
    rest = warp.frame(np.linspace(10.0, 16.0, 9))
    assert difference(rest, LATE.frame(np.full(9, 10.0))) < 1e-12
    assert warp.length == LATE.length + 6.0


def test_a_warp_leads_where_the_clip_does() -> None:
    warp = TimeWarp(((7.0, 0.0), (10.0, 9.0), (21.0, 12.0)), LATE)
    assert apart(warp.travel(np.array([warp.end])), LATE.travel(np.array([LATE.end]))) < 1e-12
