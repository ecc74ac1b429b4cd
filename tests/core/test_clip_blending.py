"""Operators that put clips together: blends, embedded clips, masks, overlays, and clips one after the other."""

import numpy as np
import pytest

from morph_retarget.core import quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.clips.clip import Clip, ClipPrimitive
from morph_retarget.core.clips.frames import Frames
from morph_retarget.core.clips.operators import likeness
from morph_retarget.core.clips.operators.blend import Blend
from morph_retarget.core.clips.operators.concatenate import Concatenate
from morph_retarget.core.clips.operators.embed import Embed
from morph_retarget.core.clips.operators.loop import Loop
from morph_retarget.core.clips.operators.mask import Mask
from morph_retarget.core.clips.operators.overlay import Overlay
from morph_retarget.core.clips.operators.section import Section
from morph_retarget.core.clips.operators.time_shift import TimeShift
from morph_retarget.core.clips.travel import Travel
from tests.random_clips import apart, body, difference, times_of, wander

A, B = wander(1), wander(2, 31, first=5.0)
ENDLESS = Loop(0, A, 6.0)
ARMS, LEGS, ALL = body().part("arms"), body().part("legs"), body().part("all")
WAVE = wander(3, 30, ARMS, 6.0)


def _steps(clip: Clip, times: Array) -> Travel:
    return clip.travel(times).steps()


# --- Blend ---


def test_a_blend_begins_as_the_first_clip_and_ends_as_the_second() -> None:
    blend = Blend(2.0, 17.0, 14.0, 25.0, A, B)
    before, after = np.linspace(2.0, 14.0, 40), np.linspace(25.0, blend.end, 40)
    assert difference(blend.frame(before), A.frame(before - 2.0)) < 1e-12
    assert difference(blend.frame(after), B.frame(after - 12.0)) < 1e-12
    assert apart(blend.travel(before), A.travel(before - 2.0)) < 1e-12
    assert apart(_steps(blend, after), _steps(B, after - 12.0)) < 1e-9


def test_a_blend_has_no_end_exactly_when_its_second_clip_has_none() -> None:
    assert Blend(0.0, 10.0, 12.0, 20.0, A, B).length == 41.0
    assert Blend(0.0, 10.0, 12.0, 20.0, ENDLESS, B).length == 41.0
    assert not Blend(0.0, 10.0, 12.0, 20.0, A, ENDLESS).is_finite


def test_a_second_clip_that_ends_before_the_blend_is_prolonged() -> None:
    blend = Blend(0.0, 0.0, 30.0, 50.0, ENDLESS, B)
    assert blend.end == 50.0
    assert difference(blend.frame(np.array([50.0])), B.frame(np.array([B.end]))) < 1e-12


def test_a_clip_blended_into_itself_in_step_is_the_clip() -> None:
    blend = Blend(0.0, 0.0, 5.0, 15.0, A, A)
    times = times_of(blend)
    assert difference(blend.frame(times), A.frame(times)) < 1e-7
    assert apart(blend.travel(np.arange(24.0)), A.way) < 1e-9


@pytest.mark.parametrize("smooth", [True, False])
def test_shares_go_from_one_clip_to_the_other_and_never_back(smooth: bool) -> None:
    blend = Blend(0.0, 5.0, 8.0, 18.0, A, B, smooth)
    share = blend.share(np.linspace(0.0, 30.0, 301))
    assert (np.diff(share) >= 0.0).all()
    assert (share.min(), share.max()) == (0.0, 1.0)
    assert share[130] == pytest.approx(0.5)
    assert (np.abs(np.diff(share, 2)).max() < 0.002) == smooth  # no kink


def test_the_way_of_a_blend_is_the_sum_of_mixed_steps() -> None:
    blend = Blend(0.0, 5.0, 8.0, 18.0, A, B)
    fine = np.linspace(8.0, 18.0, 4001)
    middle = 0.5 * (fine[1:] + fine[:-1])
    mixed = _steps(A, fine).mixed(_steps(B, fine), blend.share(middle)).summed()
    assert apart(blend.travel(fine[::40]).since(blend.travel(fine[:1])), mixed[::40]) < 1e-4


def test_a_joint_that_only_the_first_clip_has_goes_on_and_holds_its_last_value() -> None:
    blend = Blend(0.0, 10.0, 12.0, 20.0, A, WAVE)
    assert blend.active.all()
    times = times_of(blend)
    own, frames = A.frame(times), blend.frame(times)
    assert quat.angle_between(frames.rotations[:, ~ARMS], own.rotations[:, ~ARMS]).max() < 1e-12
    assert np.abs(frames.feet - own.feet).max() < 1e-12
    assert apart(blend.travel(times), A.travel(times)) < 1e-12
    late = np.array([39.0])
    assert quat.angle_between(blend.frame(late).rotations, WAVE.frame(late - 4.0).rotations)[:, ARMS].max() < 1e-12


def test_a_joint_that_only_the_second_clip_has_shows_its_first_value_until_that_begins() -> None:
    blend = Blend(0.0, 15.0, 12.0, 20.0, WAVE, A)
    early = np.array([0.0, 5.0, 13.0])
    frames, first = blend.frame(early), A.frame(np.zeros(3))
    assert quat.angle_between(frames.rotations[:, ~ARMS], first.rotations[:, ~ARMS]).max() < 1e-12
    assert apart(blend.travel(early), Travel.still(3)) < 1e-12


def test_a_cut_takes_no_time() -> None:
    cut = Blend(0.0, 12.0, 12.0, 12.0, A, B)
    assert difference(cut.frame(np.array([11.999])), A.frame(np.array([11.999]))) < 1e-12
    assert difference(cut.frame(np.array([12.0])), B.frame(np.array([5.0]))) < 1e-12
    whole = A.travel(np.array([12.0])).then(B.travel(np.array([B.end])))
    assert apart(cut.travel(np.array([cut.end])), whole) < 1e-9


# --- Embed ---


def test_an_embedded_clip_leaves_the_outer_one_and_comes_back_to_it() -> None:
    embed = Embed(0.0, 20.0, 15.0, 25.0, 40.0, 50.0, ENDLESS, B)
    for times, clip, shift in (
        (np.linspace(0.0, 15.0, 30), ENDLESS, 0.0),
        (np.linspace(25.0, 40.0, 30), B, 15.0),
        (np.linspace(50.0, 120.0, 60), ENDLESS, 0.0),
    ):
        assert difference(embed.frame(times), clip.frame(times - shift)) < 1e-12
        assert apart(_steps(embed, times), _steps(clip, times - shift)) < 1e-9
    assert not embed.is_finite


def test_an_embedded_clip_that_ends_early_is_prolonged() -> None:
    embed = Embed(0.0, 0.0, 2.0, 6.0, 60.0, 70.0, ENDLESS, B)
    held = embed.frame(np.array([35.0, 59.0]))
    assert difference(held, B.frame(np.full(2, B.end))) < 1e-12
    still = embed.travel(np.array([35.0, 59.0]))
    assert apart(still[:1], still[1:]) < 1e-9


def test_an_embedded_clip_is_two_blends() -> None:
    embed = Embed(1.0, 20.0, 15.0, 25.0, 40.0, 50.0, A, B)
    there = Blend(1.0, 20.0, 15.0, 25.0, A, B)
    back = Blend(1.0, 1.0, 40.0, 50.0, there, A)
    assert embed.length == back.length
    times = times_of(embed)
    assert difference(embed.frame(times), back.frame(times)) == 0.0


# --- Mask and Overlay ---


@pytest.mark.parametrize("part", ["arms", "legs", "upper", "trunk"])
def test_a_mask_and_its_complement_make_the_clip_again(part: str) -> None:
    joints = body().part(part)
    whole = Blend(0.0, 0.0, 0.0, 0.0, Mask(joints, A), Mask(~joints, A))
    laid = Overlay(Mask(~joints, A), Mask(joints, A), joints)
    times = times_of(A)
    for clip in (whole, laid):
        assert clip.active.all()
        assert difference(clip.frame(times), A.frame(times)) < 1e-12
        assert apart(clip.travel(times), A.travel(times)) < 1e-12


def test_a_masked_body_rests_beside_its_joints() -> None:
    mask, times = Mask(ARMS, A), times_of(A)
    frames, rest = mask.frame(times), Frames.at_rest(body(), len(times))
    assert (mask.active == ARMS).all()
    assert quat.angle_between(frames.rotations, rest.rotations)[:, ~ARMS].max() == 0.0
    assert np.abs(frames.feet - rest.feet).max() == 0.0
    assert apart(mask.travel(times), Travel.still(len(times))) == 0.0


def test_a_wave_over_a_walk_moves_the_arms_alone_and_for_as_long_as_it_lasts() -> None:
    overlay = Overlay(ENDLESS, WAVE, ARMS, 4.0, 5.0)
    times = times_of(overlay)
    frames, walk, wave = overlay.frame(times), ENDLESS.frame(times), WAVE.frame(times)
    assert quat.angle_between(frames.rotations, walk.rotations)[:, ~ARMS].max() == 0.0
    assert np.abs(frames.feet - walk.feet).max() == 0.0
    assert apart(overlay.travel(times), ENDLESS.travel(times)) == 0.0
    inside, outside = (times >= 10.0) & (times <= 30.0), (times <= 6.0) | (times >= WAVE.end)
    assert quat.angle_between(frames.rotations, wave.rotations)[inside][:, ARMS].max() < 1e-12
    assert quat.angle_between(frames.rotations, walk.rotations)[outside][:, ARMS].max() < 1e-12


def test_an_overlay_of_the_whole_body_is_an_embedded_clip() -> None:
    overlay = Overlay(ENDLESS, B, ALL, 6.0, 7.0)
    embed = Embed(0.0, 5.0, 5.0, 11.0, B.end - 7.0, B.end, ENDLESS, B)
    times = times_of(overlay)
    assert difference(overlay.frame(times), embed.frame(times)) < 1e-12
    assert apart(overlay.travel(times), embed.travel(times)) < 1e-12


def test_what_is_laid_on_legs_brings_its_feet() -> None:
    overlay = Overlay(ENDLESS, B, LEGS)
    times = np.linspace(B.start, B.end, 40)
    assert np.abs(overlay.frame(times).feet - B.frame(times).feet).max() < 1e-12
    assert apart(overlay.travel(times), ENDLESS.travel(times)) == 0.0


def test_a_wave_that_began_before_the_walk_can_be_laid_over_it() -> None:
    early = TimeShift(-20.0, B)
    overlay = Overlay(A, early, ALL, 4.0, 4.0)
    times = times_of(overlay)
    assert difference(overlay.frame(times[times < 11.0]), early.frame(times[times < 11.0])) < 1e-12
    assert apart(overlay.travel(np.zeros(1)), Travel.still()) < 1e-12


def test_a_wave_without_end_is_ended_by_a_section() -> None:
    waving = Section(6.0, 80.0, Loop(0, WAVE, 5.0))
    overlay = Overlay(ENDLESS, waving, ARMS, 4.0, 5.0)
    late = np.array([80.0, 90.0])
    assert difference(overlay.frame(late), ENDLESS.frame(late)) < 1e-9


# --- Concatenate ---


def _cut(clip: ClipPrimitive, first: int, last: int) -> ClipPrimitive:
    return ClipPrimitive(
        "cut", clip.model, clip.data[first : last + 1], clip.way[first : last + 1].since(clip.way[first : first + 1])
    )


def test_what_was_cut_apart_with_an_overlap_is_joined_where_it_was() -> None:
    whole = wander(9, 60)
    first, second = _cut(whole, 0, 34), _cut(whole, 25, 59)
    joined = Concatenate(first, second, 12.0, 6.0)
    here, there = joined.match
    assert here == there + 25.0
    assert joined.length == whole.length
    times = np.arange(60.0)
    assert difference(joined.frame(times), whole.frame(times)) < 1e-6
    assert apart(joined.travel(times), whole.travel(times)) < 1e-9


def test_clips_are_joined_while_the_same_feet_stand() -> None:
    for seed in range(5):
        first, second = wander(20 + seed, 40), wander(40 + seed, 40)
        here, there = Concatenate(first, second, 20.0).match
        tail, head = first.end - np.arange(21.0), np.arange(21.0)
        least = likeness.standing_otherwise(first, tail, second, head).min()
        assert likeness.standing_otherwise(first, np.array([here]), second, np.array([there])) == least
        assert first.end - 20.0 <= here <= first.end
        assert 0.0 <= there <= 20.0
        away = likeness.unlikeness(first, tail, second, head)
        away[likeness.standing_otherwise(first, tail, second, head) > least] = np.inf
        own = likeness.unlikeness(first, np.array([here]), second, np.array([there]))
        assert own == pytest.approx(away.min())


def test_without_frames_to_search_the_last_meets_the_first() -> None:
    joined = Concatenate(A, B, 0.0, 6.0)
    assert joined.match == (A.end, B.start)
    assert difference(joined.frame(np.array([A.end])), A.frame(np.array([A.end]))) < 1e-12
    assert not Concatenate(A, ENDLESS, 5.0).is_finite
