"""Courses: where a body goes over time."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from morph_retarget.core.arrays import Array
from morph_retarget.core.errors import MotionError
from morph_retarget.core.locomotion import course
from morph_retarget.core.locomotion.course import Course

seeds = st.integers(0, 10_000)
few = settings(max_examples=30)
SQUARE = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]])
FPS = 24.0


def _seconds(count: int) -> Array:
    return np.arange(count) / FPS


def _wandering(seed: int, count: int = 20) -> Course:
    """Return any course: uneven times, places and headings that have nothing to do with each other."""
    rng = np.random.default_rng(seed)
    times = np.cumsum(rng.uniform(0.02, 0.3, count)) - 1.0
    return Course(times, rng.normal(size=(count, 3)), np.cumsum(rng.uniform(-3.0, 3.0, count)))


def _length(places: Array) -> float:
    return float(np.sqrt((np.diff(places, axis=0) ** 2).sum(axis=1)).sum())


def _integral(values: Array, times: Array) -> float:
    return float((0.5 * (values[1:] + values[:-1]) * np.diff(times)).sum())


def _moved(places: Array, headings: Array) -> Array:
    """Return frames as matrices, shape (frame, 4, 4)."""
    out = np.tile(np.eye(4), (len(places), 1, 1))
    out[:, 0, 0] = out[:, 1, 1] = np.cos(headings)
    out[:, 1, 0], out[:, 0, 1] = np.sin(headings), -np.sin(headings)
    out[:, :3, 3] = places
    return out


# --- between and beyond samples ---


@few
@given(seeds)
def test_at_its_samples_a_course_is_its_samples(seed: int) -> None:
    found = _wandering(seed)
    places, headings = found.at(found.times)
    assert (places == found.places).all()
    assert (headings == found.headings).all()


@few
@given(seeds)
def test_a_course_is_continuous(seed: int) -> None:
    found = _wandering(seed)
    before, after = found.at(found.times[1:] - 1e-9), found.at(found.times[1:])
    assert np.abs(before[0] - after[0]).max() < 1e-5
    assert np.abs(before[1] - after[1]).max() < 1e-5


@few
@given(seeds)
def test_velocity_is_how_places_and_headings_change(seed: int) -> None:
    found = _wandering(seed)
    times = np.random.default_rng(seed).uniform(found.times[0] - 1.0, found.times[-1] + 1.0, 50)
    times = times[np.abs(times[:, None] - found.times).min(axis=1) > 1e-4]
    step = 1e-6
    (after, turned), (before, straight) = found.at(times + step), found.at(times - step)
    velocity, rate = found.velocity(times)
    assert np.allclose((after - before) / (2.0 * step), velocity, atol=1e-3, rtol=1e-4)
    assert np.allclose((turned - straight) / (2.0 * step), rate, atol=1e-3)


@few
@given(seeds)
def test_a_time_alone_gives_what_it_gives_among_others_to_the_bit(seed: int) -> None:
    found = _wandering(seed)
    times = np.random.default_rng(seed).uniform(-2.0, 3.0, 37)
    places, headings = found.at(times)
    velocity, rate = found.velocity(times)
    for i in (0, 5, 17, 36):
        alone = times[i : i + 1]
        assert (found.at(alone)[0] == places[i]).all()
        assert found.at(alone)[1][0] == headings[i]
        assert (found.velocity(alone)[0] == velocity[i]).all()
        assert found.velocity(alone)[1][0] == rate[i]


def test_beyond_its_ends_a_course_goes_on_as_it_goes_there() -> None:
    found = course.from_speed(np.array([0.0, 1.0, 2.0]), np.array([1.0, 1.0, 3.0]), np.zeros(3))
    places, _ = found.at(np.array([-2.0, 5.0]))
    assert np.allclose(places[0], [0.0, 2.0, 0.0])
    last, _ = found.velocity(np.array([2.0]))
    assert np.allclose(places[1], found.places[-1] + 3.0 * last[0])


def test_a_course_of_one_sample_stands() -> None:
    found = Course(np.array([1.0]), np.array([[1.0, 2.0, 3.0]]), np.array([0.5]))
    places, headings = found.at(np.array([-5.0, 1.0, 9.0]))
    assert (places == [1.0, 2.0, 3.0]).all()
    assert (headings == 0.5).all()
    assert not found.velocity(np.array([1.0]))[0].any()


# --- from speeds ---


@pytest.mark.parametrize("times", [np.array([0.0, 10.0]), _seconds(241)], ids=["two times", "frames"])
def test_a_steady_speed_and_turn_rate_lead_round_an_exact_circle(times: Array) -> None:
    found = course.from_speed(times, np.full(len(times), 1.5), np.full(len(times), 0.5))
    places, headings = found.at(np.linspace(-3.0, 15.0, 500))
    # To the left of forward, which is -Y, is +X.
    assert np.allclose(np.hypot(places[:, 0] - 3.0, places[:, 1]), 3.0, atol=1e-12)
    assert np.allclose(headings, 0.5 * np.linspace(-3.0, 15.0, 500))
    assert np.allclose(found.velocity(np.linspace(0.0, 9.9, 77))[0][:, 2], 0.0)


@pytest.mark.parametrize(
    ("direction", "way"),
    [(0.0, [0.0, -2.0]), (np.pi / 2.0, [2.0, 0.0]), (np.pi, [0.0, 2.0]), (-np.pi / 2.0, [-2.0, 0.0])],
    ids=["ahead", "to the left", "backward", "to the right"],
)
def test_direction_leads_off_straight_ahead_while_the_body_looks_ahead(direction: float, way: list[float]) -> None:
    found = course.from_speed(np.array([0.0, 2.0]), np.ones(2), np.zeros(2), direction)
    places, headings = found.at(np.array([2.0]))
    assert np.allclose(places[0], [*way, 0.0])
    assert headings[0] == 0.0


def test_the_way_from_speeds_is_as_long_as_these_say() -> None:
    rng = np.random.default_rng(3)
    times = np.cumsum(rng.uniform(0.1, 1.0, 30))
    speed = rng.uniform(0.0, 3.0, 30)
    found = course.from_speed(times, speed, rng.normal(size=30), rng.normal(size=30))
    fine = np.linspace(times[0], times[-1], 200_001)
    assert _length(found.at(fine)[0]) == pytest.approx(_integral(speed, times), rel=1e-5)


def test_a_speed_of_zero_stands_and_may_turn() -> None:
    found = course.from_speed(_seconds(48), np.zeros(48), np.ones(48))
    assert not found.places.any()
    assert not found.velocity(_seconds(60))[0].any()
    assert found.headings[-1] == pytest.approx(47 / FPS)


def test_a_leap_of_the_speed_leaves_the_places_continuous() -> None:
    times = _seconds(48)
    found = course.from_speed(times, np.where(times < 1.0, 0.0, 5.0), np.where(times < 1.0, 3.0, -3.0))
    places, headings = found.at(np.linspace(0.0, 2.0, 10_001))
    assert np.sqrt((np.diff(places, axis=0) ** 2).sum(axis=1)).max() < 1.01 * 5.0 * 2e-4
    assert np.abs(np.diff(headings)).max() < 1.01 * 3.0 * 2e-4


# --- along a line ---


@pytest.mark.parametrize("closed", [False, True], ids=["open", "closed"])
@pytest.mark.parametrize("smoothing", [0.0, 0.4, 100.0])
def test_the_way_along_a_line_is_as_long_as_the_speed_says(closed: bool, smoothing: float) -> None:
    speed = 0.5 + 0.4 * np.sin(_seconds(120))
    found = course.along(SQUARE, _seconds(120), speed, closed, smoothing)
    wanted = _integral(speed, _seconds(120))
    assert _length(found.at(np.linspace(0.0, 119 / FPS, 20_001))[0]) == pytest.approx(wanted, rel=5e-3)


@pytest.mark.parametrize("smoothing", [0.0, 0.4])
def test_along_an_open_line_it_goes_from_end_to_end_and_stays(smoothing: float) -> None:
    found = course.along(SQUARE, _seconds(24 * 20), np.ones(24 * 20), smoothing=smoothing)
    assert np.allclose(found.places[0, :2], SQUARE[0])
    assert np.allclose(found.places[-1, :2], SQUARE[-1])
    assert not found.velocity(np.array([12.0, 30.0]))[0].any()
    assert np.allclose(np.degrees(found.headings[[0, -1]]), [90.0, 270.0])


@pytest.mark.parametrize("smoothing", [0.0, 0.4])
def test_along_a_closed_line_it_goes_round_and_round(smoothing: float) -> None:
    times = _seconds(24 * 40)
    once = course.along(SQUARE, times, np.ones(len(times)), True, smoothing)
    fine = np.linspace(0.0, 39.0, 40_001)
    places, headings = once.at(fine)
    assert np.abs(np.diff(places, axis=0)).max() < 1.2 * 39.0 / 40_000
    assert headings[-1] - headings[0] > 4 * 2.0 * np.pi
    # It looks where it goes.
    velocity, _ = once.velocity(fine)
    ahead = np.column_stack([np.sin(headings), -np.cos(headings)])
    along = (velocity[:, :2] * ahead).sum(axis=1) / np.hypot(velocity[:, 0], velocity[:, 1])
    assert np.median(along) > 1.0 - 1e-9
    if smoothing:
        assert along.min() > 0.99
        assert np.abs(np.diff(headings)).max() < 0.02


def test_it_turns_at_smoothed_corners_no_faster_than_their_length_allows() -> None:
    times, smoothing = _seconds(24 * 8), 0.5
    found = course.along(SQUARE, times, np.ones(len(times)), True, smoothing)
    _, rate = found.velocity(np.linspace(0.0, 7.9, 5_000))
    # The means of two sides are weighted by a raised cosine, which rises by 2 over its length.
    assert np.abs(rate).max() < 1.2 * np.pi / 2.0 * 2.0 * 2.0 / smoothing
    assert np.abs(found.at(times)[0][:, :2] - 1.0).max() <= 1.0 + 1e-9


def test_a_line_in_space_keeps_its_heights() -> None:
    climb = np.array([[0.0, 0.0, 0.0], [0.0, -3.0, 0.0], [0.0, -3.0, 2.0], [0.0, -6.0, 2.0]])
    found = course.along(climb, _seconds(24 * 9), np.ones(24 * 9), smoothing=0.0)
    assert found.places[-1] == pytest.approx([0.0, -6.0, 2.0])
    assert np.allclose(found.headings, 0.0)


def test_a_speed_below_zero_goes_back_along_the_line_and_looks_ahead() -> None:
    found = course.along(SQUARE, _seconds(49), np.full(49, -1.0), start=1.5, smoothing=0.0)
    assert np.allclose(found.at(np.array([1.0]))[0][0], [0.5, 0.0, 0.0])
    assert np.allclose(found.headings, np.pi / 2.0)
    assert np.allclose(found.places[-1], 0.0)


def test_few_times_follow_a_line_as_closely_as_many() -> None:
    few_times = course.along(SQUARE, np.array([0.0, 6.0]), np.ones(2))
    many_times = course.along(SQUARE, np.linspace(0.0, 6.0, 601), np.ones(601))
    fine = np.linspace(0.0, 6.0, 1_000)
    assert np.abs(few_times.at(fine)[0] - many_times.at(fine)[0]).max() < 0.02


# --- from what moves it ---


@few
@given(seeds)
def test_frames_are_read_back_as_they_are(seed: int) -> None:
    rng = np.random.default_rng(seed)
    wanted = course.from_speed(_seconds(60), rng.uniform(0.0, 2.0, 60), rng.uniform(-2.0, 2.0, 60))
    places, headings = wanted.at(_seconds(60))
    found = course.from_frames(_seconds(60), _moved(places, headings))
    assert np.allclose(found.places, places)
    assert np.allclose(found.headings, headings)
    assert found.cuts == ()


def test_the_heading_of_a_body_that_leans_is_its_turn_about_up() -> None:
    lean = np.array([[1.0, 0.0, 0.0], [0.0, np.cos(1.0), -np.sin(1.0)], [0.0, np.sin(1.0), np.cos(1.0)]])
    frames = _moved(np.zeros((3, 3)), np.array([0.0, 0.7, 1.4]))
    frames[:, :3, :3] = frames[:, :3, :3] @ lean
    assert np.allclose(course.from_frames(_seconds(3), frames).headings, [0.0, 0.7, 1.4])


@pytest.mark.parametrize("speed", [0.0, 1.4], ids=["standing", "walking"])
def test_a_teleport_is_a_cut_up_to_which_it_goes_on_as_before(speed: float) -> None:
    places = np.zeros((48, 3))
    places[:, 1] = -speed * _seconds(48)
    places[24:, 0] += 3.0
    found = course.from_frames(_seconds(48), _moved(places, np.zeros(48)))
    assert found.cuts == (24,)
    before, _ = found.at(np.array([24.0 / FPS - 1e-9]))
    assert np.allclose(before[0], [0.0, -speed, 0.0])
    assert np.allclose(found.at(np.array([1.0]))[0][0], places[24])
    velocity, _ = found.velocity(np.linspace(0.0, 1.9, 100))
    assert np.allclose(velocity, [0.0, -speed, 0.0])


def test_turning_round_within_a_frame_is_a_cut() -> None:
    headings = np.where(np.arange(48) < 24, 0.0, 2.5)
    assert course.from_frames(_seconds(48), _moved(np.zeros((48, 3)), headings)).cuts == (24,)


@pytest.mark.parametrize("held", [1, 2, 3], ids=["on ones", "on twos", "on threes"])
def test_setting_off_stopping_and_stepped_keys_are_no_cuts(held: int) -> None:
    ways = 8.0 * np.clip(np.arange(0, 96) // held * held / FPS - 1.0, 0.0, 1.5)
    places = np.column_stack([np.zeros(96), -ways, np.zeros(96)])
    assert course.from_frames(_seconds(96), _moved(places, np.zeros(96))).cuts == ()


# --- what is refused ---


@pytest.mark.parametrize(
    ("points", "message"),
    [
        (np.zeros((0, 3)), "no length"),
        (np.zeros((1, 3)), "no length"),
        (np.ones((5, 3)), "no length"),
        (np.array([[0.0, 0.0, 0.0], [np.nan, 0.0, 0.0]]), "finite"),
        (np.zeros((4, 5)), "shape"),
    ],
    ids=["none", "one point", "one place", "not finite", "odd shape"],
)
def test_what_is_no_line_is_refused(points: Array, message: str) -> None:
    with pytest.raises(MotionError, match=message):
        course.along(points, _seconds(10), np.ones(10))


@pytest.mark.parametrize(
    ("times", "message"),
    [
        (np.zeros(0), "no times"),
        (np.array([0.0, 1.0, 0.5]), "must rise, but 0.5 s follows 1 s"),
        (np.array([0.0, 0.0]), "must rise"),
        (np.array([0.0, np.nan]), "finite"),
    ],
    ids=["none", "falling", "twice", "not finite"],
)
def test_times_that_do_not_rise_are_refused(times: Array, message: str) -> None:
    ones = np.ones(len(times))
    with pytest.raises(MotionError, match=message):
        course.from_speed(times, ones, ones)
    with pytest.raises(MotionError, match=message):
        course.along(SQUARE, times, ones)
    with pytest.raises(MotionError, match=message):
        course.from_frames(times, np.tile(np.eye(4), (len(times), 1, 1)))


def test_speeds_that_are_not_finite_are_refused_with_their_sample() -> None:
    with pytest.raises(MotionError, match="speed at sample 2"):
        course.from_speed(_seconds(4), np.array([0.0, 1.0, np.inf, 0.0]), np.zeros(4))
    with pytest.raises(MotionError, match="turn rate at sample 0"):
        course.from_speed(_seconds(4), np.zeros(4), np.full(4, np.nan))


def test_samples_that_do_not_say_which_way_it_turned_are_refused() -> None:
    with pytest.raises(MotionError, match="half a turn"):
        Course(np.array([0.0, 1.0]), np.zeros((2, 3)), np.array([0.0, 4.0]))
    with pytest.raises(MotionError, match="shapes"):
        Course(np.array([0.0, 1.0]), np.zeros((2, 2)), np.zeros(2))
    with pytest.raises(MotionError, match="jumps"):
        Course(np.array([0.0, 1.0]), np.zeros((2, 3)), np.zeros(2), (2,))
