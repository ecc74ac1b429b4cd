"""Operators that change how a clip looks: filters, mirrors, additions, noise, and mixes of several."""

from collections.abc import Callable

import numpy as np
import pytest

from morph_retarget.core import quat
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.clips import posing
from morph_retarget.core.clips.character_model import CharacterModel
from morph_retarget.core.clips.clip import Clip, ClipPrimitive
from morph_retarget.core.clips.frames import Frames
from morph_retarget.core.clips.operators import coherent_noise
from morph_retarget.core.clips.operators.additive import Additive
from morph_retarget.core.clips.operators.filter import Filter
from morph_retarget.core.clips.operators.loop import Loop
from morph_retarget.core.clips.operators.mask import Mask
from morph_retarget.core.clips.operators.mirror import Mirror
from morph_retarget.core.clips.operators.mix import Mix
from morph_retarget.core.clips.operators.noise import Noise
from morph_retarget.core.clips.operators.partners import partners_of
from morph_retarget.core.clips.operators.section import Section
from morph_retarget.core.clips.operators.time_shift import TimeShift
from morph_retarget.core.clips.travel import Travel
from morph_retarget.core.morph.bodies import Bodies
from morph_retarget.core.play import root_of
from tests.legged import crawler
from tests.random_clips import apart, body, difference, times_of, wander
from tests.skeletons import skeleton_of, wild

A, B = wander(1), wander(2, 31, first=5.0)
ENDLESS = Loop(0, A, 6.0)
ARMS, ALL = body().part("arms"), body().part("all")
SMOOTH = (0.25, 0.5, 0.25)


def _still() -> ClipPrimitive:
    return ClipPrimitive("still", body(), A.data[np.full(20, 5)], Travel.still(20))


# --- Filter ---


@pytest.mark.parametrize("coefficients", [SMOOTH, (0.2, 0.3, 0.5), (-0.5, 2.0, -0.5), (1.0, 1.0, 1.0)])
@pytest.mark.parametrize("reflected", [True, False])
def test_a_filter_leaves_what_stands_still(coefficients: tuple[float, ...], reflected: bool) -> None:
    still = _still()
    for clip in (still, Loop(0, still)):
        out, times = Filter(coefficients, -1, clip, reflected), times_of(clip)
        assert difference(out.frame(times), clip.frame(times)) < 1e-12


def test_one_coefficient_of_one_frame_leaves_any_clip() -> None:
    times = times_of(A)
    assert difference(Filter((1.0,), 0, A).frame(times), A.frame(times)) == 0.0


def test_a_filter_that_only_takes_an_earlier_frame_is_a_delay() -> None:
    delayed, times = Filter((0.0, 0.0, 1.0), 0, A), times_of(A)
    frames, late = delayed.frame(times), A.frame(A.held(times - 2.0))
    assert quat.angle_between(frames.rotations, late.rotations).max() < 1e-7
    assert np.abs(frames.feet - late.feet).max() < 1e-12
    assert np.abs(frames.contacts - A.frame(times).contacts).max() == 0.0


def test_places_are_sums_over_neighbours() -> None:
    times = np.arange(3.0, 20.0)
    out = Filter((0.2, 0.5, 0.3), -1, A).frame(times)
    near = [A.frame(times - i) for i in (-1.0, 0.0, 1.0)]
    for name in ("translations", "feet"):
        wanted = sum(h * getattr(f, name) for h, f in zip((0.2, 0.5, 0.3), near, strict=True))
        assert np.abs(getattr(out, name) - wanted).max() < 1e-12


def test_a_filter_turns_with_the_frames_in_which_rotations_are_given() -> None:
    turn = quat.normalize(np.array([0.3, -0.5, 0.7, 0.2]))
    data = Frames(quat.multiply(turn, A.data.rotations), A.data.translations, A.data.feet, A.data.contacts)
    other = ClipPrimitive("turned", body(), data, A.way)
    times = times_of(A)
    first, second = (Filter(SMOOTH, -1, clip).frame(times).rotations for clip in (A, other))
    assert quat.angle_between(quat.multiply(turn, first), second).max() < 1e-7


def test_a_smoothing_filter_calms_what_trembles() -> None:
    rng = np.random.default_rng(1)
    tremble = quat.from_rotation_vector(0.05 * rng.normal(size=(24, len(body()), 3)))
    data = Frames(quat.multiply(A.data.rotations, tremble), A.data.translations, A.data.feet, A.data.contacts)
    shaken = ClipPrimitive("shaken", body(), data, A.way)
    times = np.arange(24.0)

    def off(clip: Clip) -> float:
        return float(quat.angle_between(clip.frame(times).rotations, A.data.rotations).mean())

    assert off(Filter((0.1, 0.2, 0.4, 0.2, 0.1), -2, shaken)) < 0.7 * off(shaken)


def test_the_ends_of_a_clip_are_held_or_reflected_by_a_filter() -> None:
    end = np.array([A.end])
    held, reflected = (Filter((0.5, 0.0, 0.5), -1, A, r).frame(end).feet for r in (False, True))
    last, before = A.frame(end).feet, A.frame(end - 1.0).feet
    assert np.abs(held - 0.5 * (last + before)).max() < 1e-12
    assert np.abs(reflected - before).max() < 1e-12


def test_a_filter_on_a_clip_without_end_is_the_same_in_each_round() -> None:
    out = Filter(SMOOTH, -1, ENDLESS)
    times = np.linspace(5.0, 28.0, 40)
    assert not out.is_finite
    assert difference(out.frame(times), out.frame(times + 7.0 * ENDLESS.cycle)) < 1e-7


# --- Mirror ---


def _crawler() -> CharacterModel:
    character = analyze(skeleton_of(crawler(6), np.random.default_rng(4)))
    return CharacterModel(character, root_of(Bodies.of(character)))


@pytest.mark.parametrize("make", [body, _crawler])
def test_mirrored_twice_is_the_clip_again(make: Callable[[], CharacterModel]) -> None:
    model = make()
    pose, count = wild(model.character.skeleton, 9, np.random.default_rng(5)), len(model.feet)
    way = Travel(np.random.default_rng(6).normal(size=(8, 2)), np.full(8, 0.2)).summed()
    clip = ClipPrimitive(
        "wild", model, posing.frames_of(model, pose, way, np.linspace(0, 1, 9 * count).reshape(9, -1)), way
    )
    times = times_of(clip)
    assert difference(Mirror(Mirror(clip)).frame(times), clip.frame(times)) < 1e-7
    assert apart(Mirror(Mirror(clip)).travel(times), clip.travel(times)) < 1e-12


@pytest.mark.parametrize("make", [body, _crawler])
def test_each_joint_is_where_its_partner_was_in_the_mirror(make: Callable[[], CharacterModel]) -> None:
    model = make()
    pose = wild(model.character.skeleton, 9, np.random.default_rng(7), 1.2)
    way = Travel(np.random.default_rng(6).normal(size=(8, 2)), np.full(8, 0.2)).summed()
    frames = posing.frames_of(model, pose, way, np.ones((9, len(model.feet))))
    clip = ClipPrimitive("wild", model, frames, way)
    times, there = np.arange(9.0), partners_of(model)
    place = model.character.local_to_character
    own, seen = (
        place.points(posing.pose_of(model, c.frame(times), c.travel(times)).positions) for c in (clip, Mirror(clip))
    )
    assert np.abs(seen - own[:, there.joints] * [-1.0, 1.0, 1.0]).max() < 1e-9
    # Where feet stand is told as well as made by the pose.
    mirrored, back = Mirror(clip).frame(times), Mirror(clip).travel(times)
    again = posing.frames_of(model, posing.pose_of(model, mirrored, back), back, mirrored.contacts)
    assert difference(mirrored, again) < 1e-7
    assert (there.feet != np.arange(len(model.feet))).all()


def test_the_mirror_of_the_left_arm_is_the_right_arm() -> None:
    left, right = body().part("left arm"), body().part("right arm")
    assert (Mirror(Mask(left, A)).active == right).all()


# --- Additive ---


def test_nothing_of_an_addition_is_nothing() -> None:
    times = times_of(A)
    assert difference(Additive(A, B, 0.0).frame(times), A.frame(times)) == 0.0
    assert difference(Additive(A, _still()).frame(times), A.frame(times)) < 1e-12


def test_an_addition_to_rest_is_the_clip_itself() -> None:
    rest = Section(0.0, 40.0, ClipPrimitive("rest", body(), Frames.at_rest(body()), Travel.still()))
    out, times = Additive(rest, B, from_rest=True), times_of(B)
    assert quat.angle_between(out.frame(times).rotations, B.frame(times).rotations).max() < 1e-7
    assert np.abs(out.frame(times).feet - B.frame(times).feet).max() < 1e-12


def test_half_an_addition_twice_is_all_of_it_where_joints_turn_about_one_axis() -> None:
    model = body()
    turns = np.zeros((20, len(model), 3))
    turns[:, :, 1] = np.linspace(0.0, 1.0, 20)[:, None]
    rest = Frames.at_rest(model, 20)
    lean = ClipPrimitive(
        "lean",
        model,
        Frames(quat.from_rotation_vector(turns), rest.translations, rest.feet, rest.contacts),
        Travel.still(20),
    )
    times = times_of(lean)
    twice = Additive(Additive(A, lean, 0.5), lean, 0.5)
    assert difference(twice.frame(times), Additive(A, lean).frame(times)) < 1e-7


def test_an_addition_moves_only_what_it_has() -> None:
    wave = wander(3, 30, ARMS)
    out, times = Additive(ENDLESS, wave), times_of(ENDLESS)
    frames, own = out.frame(times), ENDLESS.frame(times)
    assert quat.angle_between(frames.rotations, own.rotations)[:, ~ARMS].max() == 0.0
    assert np.abs(frames.feet - own.feet).max() == 0.0
    assert apart(out.travel(times), ENDLESS.travel(times)) == 0.0


# --- Noise ---


def test_noise_is_smooth_bounded_and_nothing_on_average() -> None:
    times = np.arange(0.0, 400.0, 0.01)
    values = coherent_noise.noise(times, 7, np.arange(12))
    assert np.abs(values).max() <= 1.0
    assert np.abs(np.diff(values, 2, axis=0)).max() < 0.01
    # It swings, but what it adds up to stays within two units however long it goes on.
    assert values.std() > 0.15
    assert np.abs(np.cumsum(values, axis=0) * 0.01).max() < 1.0
    assert np.abs(values.mean(axis=0)).max() < 0.002


def test_noises_are_independent_and_always_the_same() -> None:
    times = np.random.default_rng(0).uniform(-1000.0, 1000.0, 4000)
    values = coherent_noise.noise(times, 7, np.arange(8))
    assert np.abs(np.corrcoef(values.T) - np.eye(8)).max() < 0.1
    assert np.array_equal(coherent_noise.noise(times[100:120], 7, np.array([3])), values[100:120, 3:4])
    assert np.abs(coherent_noise.noise(times, 8, np.arange(8)) - values).max() > 0.5


def test_noise_turns_its_joints_about_the_pose_that_they_have() -> None:
    out, times = Noise(ENDLESS, ARMS, 0.2, 2.0, 3), np.arange(0.0, 6000.0)
    frames, own = out.frame(times), ENDLESS.frame(times)
    off = quat.to_rotation_vector(quat.multiply(quat.conjugate(own.rotations), frames.rotations))
    assert np.abs(off[:, ~ARMS]).max() < 1e-12
    assert np.abs(off).max() <= 0.2 + 1e-9
    assert np.abs(off[:, ARMS].mean(axis=0)).max() < 0.01
    assert off[:, ARMS].std() > 0.03
    assert np.abs(frames.feet - own.feet).max() == 0.0


def test_the_noise_of_a_joint_does_not_depend_on_the_others() -> None:
    times = times_of(ENDLESS)
    some, every = (Noise(ENDLESS, joints, 0.2, 2.0, 3).frame(times).rotations for joints in (ARMS, ALL))
    assert quat.angle_between(some, every)[:, ARMS].max() == 0.0


# --- Mix ---


@pytest.mark.parametrize("cyclic", [True, False])
def test_a_mix_in_which_one_clip_counts_is_that_clip(cyclic: bool) -> None:
    mix = Mix((A, B), (0.0, 3.0), cyclic, ((3.0, 9.0), (9.0, 25.0)))
    one: Clip = TimeShift(-5.0, Loop(0, B) if cyclic else B)
    assert mix.cycle == (31.0 if cyclic else 30.0)
    assert mix.length == one.length
    times = times_of(one)
    assert difference(mix.frame(times), one.frame(times)) < 1e-7
    assert (
        apart(mix.travel(np.arange(90.0 if cyclic else 31.0)), one.travel(np.arange(90.0 if cyclic else 31.0))) < 1e-3
    )


def test_a_mix_of_one_clip_with_itself_is_that_clip() -> None:
    times = times_of(A)
    mix = Mix((A, A, A), (1.0, 2.0, 0.5), cyclic=False)
    assert difference(mix.frame(times), A.frame(times)) < 1e-7
    assert apart(mix.travel(np.arange(24.0)), A.way) < 1e-9


@pytest.mark.parametrize("cyclic", [True, False])
def test_marks_meet(cyclic: bool) -> None:
    mix = Mix((A, B), (1.0, 2.0), cyclic, ((3.0, 12.0), (15.0, 28.0)))
    frames = mix.frame(mix.met)
    near = [A.frame(np.array([3.0, 12.0])), B.frame(np.array([15.0, 28.0]))]
    assert np.abs(frames.feet - (near[0].feet + 2.0 * near[1].feet) / 3.0).max() < 1e-12
    assert np.abs(frames.contacts - (near[0].contacts + 2.0 * near[1].contacts) / 3.0).max() < 1e-12


def test_marks_of_cycles_may_begin_anywhere() -> None:
    # The second clip's first mark lies at the end of its cycle, the next at the beginning.
    for marks in (((1.0, 13.0), (34.0, 20.0)), ((1.0, 13.0), (34.0, 51.0)), ((25.0, 13.0), (3.0, 20.0))):
        mix = Mix((A, B), (1.0, 1.0), marks=marks)
        frames = mix.frame(mix.met)
        own = [
            Loop(0, c).frame(c.start + (np.array(m) - c.start) % c.length) for c, m in zip((A, B), marks, strict=True)
        ]
        assert np.abs(frames.feet - 0.5 * (own[0].feet + own[1].feet)).max() < 1e-9


def test_the_cycle_of_a_mix_leads_as_far_as_those_of_its_clips_on_average() -> None:
    straight: list[Clip] = []
    for seed, length in ((1, 24), (2, 31)):
        clip = wander(seed, length)
        straight.append(ClipPrimitive("way", body(), clip.data, Travel(clip.way.places * [0.0, 1.0], np.zeros(length))))
    mix = Mix(straight, (1.0, 3.0))
    rounds = [Loop(0, clip).travel(np.array([clip.length])).places[0, 1] for clip in straight]
    assert mix.cycle == 0.25 * 24.0 + 0.75 * 31.0
    assert mix.travel(np.array([mix.cycle])).places[0, 1] == pytest.approx(0.25 * rounds[0] + 0.75 * rounds[1])


def test_rounds_of_a_mix_are_alike() -> None:
    mix = Mix((ENDLESS, Loop(0, B, 7.0)), (1.0, 2.0), marks=((3.0, 12.0), (15.0, 28.0)))
    times = np.linspace(0.0, mix.cycle, 30)
    later = times + 5.0 * mix.cycle
    assert difference(mix.frame(times), mix.frame(later)) < 1e-7
    assert apart(mix.travel(times).steps(), mix.travel(later).steps()) < 1e-9


def test_a_mix_of_mixes_is_a_mix() -> None:
    inner = Mix((ENDLESS, Loop(0, B, 7.0)), (1.0, 1.0))
    mix = Mix((inner, Loop(0, B, 7.0)), (1.0, 0.0))
    times = times_of(inner)
    assert difference(mix.frame(times), inner.frame(times)) < 1e-7


def test_a_joint_of_a_mix_is_that_of_the_clips_that_have_it() -> None:
    mix = Mix((A, Mask(ARMS, B)), (1.0, 5.0), cyclic=False)
    times = times_of(mix)
    phases = (times - mix.start) / mix.cycle
    own, frames = A.frame(23.0 * phases), mix.frame(times)
    assert quat.angle_between(frames.rotations, own.rotations)[:, ~ARMS].max() < 1e-7
    assert np.abs(frames.feet - own.feet).max() < 1e-12
    assert apart(mix.travel(np.array([mix.end])), A.way[-1:]) < 1e-9
