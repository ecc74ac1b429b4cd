"""Gait styles and the patterns that are made of them, for any number of feet at any speed."""

from dataclasses import fields, replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from morph_retarget.core.arrays import Array, Flags
from morph_retarget.core.errors import MotionError
from morph_retarget.core.locomotion.patterns import manner, styles
from morph_retarget.core.locomotion.patterns.manner import MOST_BEATS, Manner
from morph_retarget.core.locomotion.patterns.pattern import Pattern, pattern, slots_of
from morph_retarget.core.locomotion.patterns.styles import STYLES, Style

few = settings(max_examples=40)
SPEEDS = np.linspace(0.0, 4.0, 801)
COUNTS = range(1, 25)
OWN = [name for name, style in STYLES.items() if style.change is None]
CHANGES = [name for name, style in STYLES.items() if style.change is not None]
REACH = 1.15
"""A leg can be over its foot for this way while it stands [hip heights]."""

sides = st.lists(st.sampled_from((1, -1, 0)), min_size=1, max_size=24)
layers = st.lists(st.tuples(st.sampled_from(sorted(STYLES)), st.floats(0.0, 2.0)), min_size=1, max_size=4)


def _sides(feet: int) -> tuple[int, ...]:
    return (*((1, -1) * (feet // 2)), *((0,) * (feet % 2)))


def _at(name: str, feet: int, *speeds: float) -> Pattern:
    return pattern([(STYLES[name], 1.0)], _sides(feet), np.array(speeds))


def _standing(made: Pattern, sample: int, phases: Array) -> Flags:
    """Return which feet stand at phases of the cycle, shape (phase, foot)."""
    own = (phases[:, None] - made.triggers[sample]) % 1.0
    return own < made.duty[sample]


def _apart(a: Array | float, b: Array | float) -> Array:
    """Return how far phases are apart, 0 … 0.5."""
    way = np.asarray(a) - np.asarray(b)
    return np.abs(way - np.round(way))


def _assert_same(a: Pattern, b: Pattern) -> None:
    for item in fields(Pattern):
        own, other = getattr(a, item.name), getattr(b, item.name)
        away = _apart(own, other) if item.name == "triggers" else np.abs(own - other)
        assert away.max(initial=0.0) < 1e-9, item.name


# --- all styles ---


@pytest.mark.parametrize("name", STYLES)
def test_every_style_gives_any_number_of_feet_a_pattern_at_any_speed(name: str) -> None:
    for feet in COUNTS:
        made = pattern([(STYLES[name], 1.0)], _sides(feet), np.array([0.0, 1e-6, 0.3, 1.0, 2.2, 4.0, 1e3]))
        assert made.duty.shape == made.triggers.shape == (7, feet)
        assert (made.duty > 0.0).all()
        assert (made.duty < 1.0).all()
        assert (made.triggers >= 0.0).all()
        assert (made.triggers < 1.0).all()
        assert (made.stride > 0.0).all()
        assert all(np.isfinite(getattr(made, item.name)).all() for item in fields(made))


@pytest.mark.parametrize("name", STYLES)
def test_patterns_have_no_jumps_over_speed(name: str) -> None:
    for feet in COUNTS:
        made = pattern([(STYLES[name], 1.0)], _sides(feet), SPEEDS)
        step = SPEEDS[1]
        for item in fields(made):
            values = getattr(made, item.name)
            way = _apart(values[1:], values[:-1]) if item.name == "triggers" else np.abs(np.diff(values, axis=0))
            assert way.max(initial=0.0) < 8.0 * step, (feet, item.name)


@few
@given(layers, sides)
def test_layered_patterns_have_no_jumps_over_speed_either(chosen: list[tuple[str, float]], sides: list[int]) -> None:
    made = pattern(styles.named(chosen), sides, SPEEDS)
    assert _apart(made.triggers[1:], made.triggers[:-1]).max() < 8.0 * SPEEDS[1]
    assert np.abs(np.diff(made.duty, axis=0)).max() < 8.0 * SPEEDS[1]


@pytest.mark.parametrize("name", OWN)
def test_rows_of_a_style_are_in_order(name: str) -> None:
    for feet in COUNTS:
        rows = STYLES[name].manners(feet)
        assert rows[0].speed == 0.0
        assert len(rows) > 1
        for slow, fast in pairwise(rows):
            assert slow.speed < fast.speed
            assert slow.duty >= fast.duty
            assert slow.stride < fast.stride
        for row in rows:
            assert len(row.triggers) == feet
            assert 1 <= row.bob_beats <= MOST_BEATS
            assert row.duty * row.stride < REACH
            body = replace(row, triggers=(), speed=0.0)
            assert all(getattr(body, item.name) >= 0.0 for item in fields(Manner) if item.name != "triggers")


@pytest.mark.parametrize("name", OWN)
def test_who_goes_faster_steps_quicker_and_longer_and_stands_for_less_of_the_time(name: str) -> None:
    for feet in COUNTS:
        made = pattern([(STYLES[name], 1.0)], _sides(feet), SPEEDS)
        assert (np.diff(made.duty, axis=0) <= 1e-12).all()
        assert (np.diff(made.stride) >= -1e-12).all()
        assert (np.diff(SPEEDS / made.stride) > 0.0).all()


@pytest.mark.parametrize("feet", COUNTS)
def test_the_natural_gait_changes_all_the_way_to_a_gallop(feet: int) -> None:
    made = pattern([(STYLES["auto"], 1.0)], _sides(feet), SPEEDS)
    assert (np.diff(made.duty, axis=0) < 0.0).all()
    assert (np.diff(made.stride) > 0.0).all()


@pytest.mark.parametrize(("speed", "feet"), [(0.45, 2), (0.5, 4), (1.2, 2), (1.2, 4), (3.0, 2), (3.0, 4)])
def test_strides_of_vertebrates_are_near_those_of_alexander_and_jayes(speed: float, feet: int) -> None:
    assert np.isclose(_at("auto", feet, speed).stride[0], 2.3 * speed**0.6, rtol=0.15)


def test_no_style_leaves_a_number_of_feet_to_nothing_and_says_for_which_it_was_made() -> None:
    for style in STYLES.values():
        assert style.fallback in STYLES
        assert style.name in STYLES
        assert any(style.suits(feet) for feet in COUNTS)
    assert [feet for feet in COUNTS if STYLES["trot"].suits(feet)] == [4]
    assert all(STYLES["wave"].suits(feet) and STYLES["auto"].suits(feet) for feet in COUNTS)
    assert STYLES["gallop"].manners(2) == STYLES["run"].manners(2)
    assert STYLES["ripple"].manners(9) == STYLES["wave"].manners(9)


def test_an_unknown_style_is_named_with_all_that_there_are() -> None:
    with pytest.raises(MotionError, match=r"'stroll'.*auto, walk.*prance"):
        styles.named([("auto", 1.0), ("stroll", 0.5)])


# --- single gaits ---


@pytest.mark.parametrize("name", ["auto", "walk", "run"])
def test_two_feet_go_half_a_cycle_apart(name: str) -> None:
    made = pattern([(STYLES[name], 1.0)], (1, -1), SPEEDS)
    assert np.allclose(_apart(made.triggers[:, 0], made.triggers[:, 1]), 0.5)


def test_four_feet_walk_a_quarter_apart_each_fore_foot_after_the_hind_foot_of_its_side() -> None:
    left_hind, right_hind, left_fore, right_fore = _at("walk", 4, 0.4).triggers[0]
    order = (np.array([left_fore, right_hind, right_fore]) - left_hind) % 1.0
    assert np.allclose(order, [0.25, 0.5, 0.75])


@pytest.mark.parametrize(
    ("name", "speed", "pairs"), [("trot", 1.2, ((0, 3), (1, 2))), ("bound", 2.0, ((0, 1), (2, 3)))]
)
def test_trotting_and_bounding_feet_land_in_pairs(name: str, speed: float, pairs: tuple[tuple[int, int], ...]) -> None:
    made = _at(name, 4, speed)
    for a, b in pairs:
        assert _apart(made.triggers[0, a], made.triggers[0, b]) < 0.01
    assert _apart(made.triggers[0, pairs[0][0]], made.triggers[0, pairs[1][0]]) > 0.4


def test_pacing_feet_of_one_side_go_together() -> None:
    left_hind, right_hind, left_fore, right_fore = _at("pace", 4, 1.5).triggers[0]
    assert max(_apart(left_hind, left_fore), _apart(right_hind, right_fore)) < 0.05
    assert _apart(left_hind, right_hind) > 0.4


@pytest.mark.parametrize(("name", "beats"), [("canter", 3), ("gallop", 4)])
def test_canters_have_three_beats_and_gallops_four_before_the_flight(name: str, beats: int) -> None:
    made = _at(name, 4, 2.5)
    landings = np.sort((made.triggers[0] - made.triggers[0, 0]) % 1.0)
    assert 1 + (np.diff(landings) > 0.05).sum() == beats
    in_air = ~_standing(made, 0, np.linspace(0.0, 1.0, 200, endpoint=False)).any(axis=1)
    assert 0.02 < in_air.mean() < 0.4
    assert (np.diff(in_air.astype(int), append=int(in_air[0])) > 0).sum() == 1


@pytest.mark.parametrize("feet", [2, 4])
def test_walkers_always_stand_and_runners_fly(feet: int) -> None:
    phases = np.linspace(0.0, 1.0, 200, endpoint=False)
    walking, running = _at("walk", feet, *SPEEDS[::50]), _at("run", feet, *SPEEDS[200::50])
    for sample in range(len(walking)):
        assert _standing(walking, sample, phases).any(axis=1).all()
    for sample in range(len(running)):
        assert not _standing(running, sample, phases).any(axis=1).all()


def test_hurrying_insects_stand_on_one_tripod_while_the_other_flies() -> None:
    for name, speed in (("tripod", 0.3), ("auto", 1.0)):
        triggers = _at(name, 6, speed).triggers[0]
        first, second = triggers[[0, 3, 4]], triggers[[1, 2, 5]]
        assert _apart(first, first[0]).max() < 1e-9
        assert _apart(second, first).min() > 0.5 - 1e-9


@pytest.mark.parametrize("feet", range(2, 25))
def test_waves_run_forward_with_left_and_right_half_a_cycle_apart(feet: int) -> None:
    made = _at("wave", feet, 0.0, 0.5, 2.0)
    assert (made.duty >= 0.5).all()
    pairs = made.triggers[:, : 2 * (feet // 2)]
    assert np.allclose(_apart(pairs[:, ::2], pairs[:, 1::2]), 0.5)
    lags = np.diff(pairs[:, ::2], axis=1) % 1.0
    assert (lags > 0.1).all()
    assert (lags <= 0.5).all()
    assert np.allclose(lags, lags[:, :1])


@pytest.mark.parametrize("feet", [4, 6])
def test_in_a_wave_gait_a_foot_lands_when_the_next_one_of_its_side_leaves(feet: int) -> None:
    duty = 0.75
    triggers = np.array(manner.wave(feet, manner.lag(feet, duty)))
    for side in (triggers[::2], triggers[1::2]):
        for behind, ahead in pairwise(side):
            assert _apart(behind, ahead + duty) < 1e-9


@pytest.mark.parametrize("feet", [1, 2, 3, 4, 5, 6, 8, 12])
def test_slow_bodies_of_several_feet_stand_on_most_of_them(feet: int) -> None:
    made = _at("auto", feet, 0.05)
    stand = _standing(made, 0, np.linspace(0.0, 1.0, 200, endpoint=False)).sum(axis=1)
    assert stand.min() >= feet // 2


# --- the body ---


@few
@given(st.floats(0.0, 1.0), st.integers(1, MOST_BEATS), st.floats(0.0, 0.1))
def test_the_body_is_highest_at_the_phase_that_was_authored(phase: float, beats: int, bob: float) -> None:
    own = Manner(0.0, 0.5, (0.0, 0.5), 1.0, bob=bob, bob_beats=beats, bob_phase=phase)
    style = Style("own", "Own", "", {2: (own, replace(own, speed=1.0, stride=2.0))})
    phases = np.linspace(0.0, 1.0, 400)
    made = pattern([(style, 1.0)], (1, -1), np.full(len(phases), 0.3))
    height = made.bob(phases)
    assert np.isclose(made.bob(np.full(400, phase)), bob).all()
    assert height.max() <= bob + 1e-12
    assert np.isclose(height.min(), -bob, atol=1e-3 * (bob + 1e-9))


def test_a_walking_body_is_highest_over_its_foot_and_a_running_one_in_the_air() -> None:
    phases = np.linspace(0.0, 1.0, 400, endpoint=False)
    for speed, flies in ((0.45, False), (1.2, True), (1.7, True)):
        made = pattern([(STYLES["auto"], 1.0)], (1, -1), np.full(400, speed))
        highest = phases[np.argmax(made.bob(phases))]
        standing = _standing(made, 0, np.array([highest])).sum()
        assert standing == (0 if flies else 1)


# --- interpolation and layers ---


@pytest.mark.parametrize("name", OWN)
@pytest.mark.parametrize("feet", [1, 2, 3, 4, 5, 6, 7, 16])
def test_at_the_speed_of_a_manner_the_pattern_is_that_manner(name: str, feet: int) -> None:
    rows = STYLES[name].manners(feet)
    made = _at(name, feet, *(row.speed for row in rows))
    for i, row in enumerate(rows):
        assert np.allclose(made.duty[i], row.duty)
        assert np.isclose(made.stride[i], row.stride)
        assert _apart(made.triggers[i], row.triggers).max() < 1e-9


def test_beyond_the_fastest_manner_a_pattern_stays_as_it_is() -> None:
    top = STYLES["walk"].manners(2)[-1].speed
    _assert_same(_at("walk", 2, top), _at("walk", 2, 3.0 * top))


def test_only_the_shares_of_layers_count() -> None:
    for a, b in ((1.0, 1.0), (0.3, 1.2)):
        one = pattern(styles.named([("walk", a), ("trot", b)]), _sides(4), SPEEDS)
        other = pattern(styles.named([("walk", 3.0 * a), ("trot", 3.0 * b)]), _sides(4), SPEEDS)
        _assert_same(one, other)


@pytest.mark.parametrize("name", OWN)
def test_a_layer_alone_is_its_style_and_one_without_weight_is_nothing(name: str) -> None:
    alone = pattern(styles.named([(name, 1.0)]), _sides(4), SPEEDS)
    _assert_same(alone, pattern(styles.named([(name, 0.2)]), _sides(4), SPEEDS))
    _assert_same(alone, pattern(styles.named([("gallop", 0.0), (name, 1.0), ("limp", 0.0)]), _sides(4), SPEEDS))
    _assert_same(alone, pattern(styles.named([(name, 0.5), (name, 2.0)]), _sides(4), SPEEDS))


def test_without_any_weight_the_gait_is_the_natural_one() -> None:
    natural = pattern(styles.named([("auto", 1.0)]), _sides(4), SPEEDS)
    _assert_same(natural, pattern([], _sides(4), SPEEDS))
    _assert_same(natural, pattern(styles.named([("trot", 0.0)]), _sides(4), SPEEDS))


@few
@given(st.sampled_from(OWN), st.sampled_from(OWN), st.floats(0.0, 1.0), st.integers(1, 12))
def test_a_blend_is_between_its_layers(a: str, b: str, share: float, feet: int) -> None:
    first, second = (_at(name, feet, *SPEEDS[::40]) for name in (a, b))
    both = pattern(styles.named([(a, 1.0 - share), (b, share)]), _sides(feet), SPEEDS[::40])
    for name in ("duty", "stride", "lift", "crouch"):
        low, high = (f(getattr(first, name), getattr(second, name)) for f in (np.minimum, np.maximum))
        assert (getattr(both, name) >= low - 1e-9).all()
        assert (getattr(both, name) <= high + 1e-9).all()


@few
@given(layers, st.integers(1, 12), st.floats(0.0, 1.0))
def test_patterns_have_no_jumps_over_weights(chosen: list[tuple[str, float]], feet: int, weight: float) -> None:
    near, nearer = (
        pattern(styles.named([("auto", 1.0), *chosen, ("canter", weight + more)]), _sides(feet), SPEEDS[::80])
        for more in (1e-3, 1e-3 + 1e-6)
    )
    assert _apart(near.triggers, nearer.triggers).max() < 1e-4
    assert np.abs(near.duty - nearer.duty).max() < 1e-4


@pytest.mark.parametrize("name", CHANGES)
def test_half_a_change_is_less_of_it(name: str) -> None:
    none, half, full = (pattern(styles.named([("auto", 1.0), (name, w)]), _sides(4), SPEEDS) for w in (0.0, 0.5, 1.0))
    for item in ("duty", "stride", "lift", "crouch", "lean", "sway"):
        a, b, c = (getattr(made, item) for made in (none, half, full))
        assert (np.abs(b - a) <= np.abs(c - a) + 1e-9).all(), item
        assert (np.abs(c - b) <= np.abs(c - a) + 1e-9).all(), item


@pytest.mark.parametrize("feet", [2, 3, 4, 5, 6, 8])
def test_a_limping_body_stands_for_less_time_on_the_right_front_foot_and_hurries_off_it(feet: int) -> None:
    own = [1, -1] * (feet // 2) + [-1] * (feet % 2)
    sound, limping = (pattern(styles.named(chosen), own, np.array([0.4])) for chosen in ([], [("limp", 1.0)]))
    hurt = feet - 1
    assert (limping.duty[0, hurt] < limping.duty[0, :hurt]).all()
    assert np.isclose((limping.triggers[0, hurt] - sound.triggers[0, hurt]) % 1.0, STYLES["limp"].change.late)
    middle = limping.triggers[0, hurt] + 0.5 * limping.duty[0, hurt]
    assert limping.bob(np.array([middle])) - sound.bob(np.array([middle])) > 0.0


def test_changes_do_what_they_are_called_for() -> None:
    plain = _at("auto", 2, 0.4)
    sneaking, lumbering, prancing = (_at(name, 2, 0.4) for name in ("sneak", "lumber", "prance"))
    assert sneaking.crouch > plain.crouch + 0.1
    assert sneaking.duty[0, 0] > plain.duty[0, 0]
    assert lumbering.sway > plain.sway + 0.2
    assert prancing.lift > 1.5 * plain.lift


# --- feet ---


@few
@given(sides)
def test_every_foot_takes_one_place_of_the_authored_order(sides: list[int]) -> None:
    assert sorted(slots_of(sides)) == list(range(len(sides)))


@pytest.mark.parametrize("feet", COUNTS)
def test_pairs_of_feet_are_in_the_authored_order(feet: int) -> None:
    assert slots_of(_sides(feet)) == tuple(range(feet))


@pytest.mark.parametrize(
    ("sides", "slots"),
    [
        ((0, 1, -1), (2, 0, 1)),
        ((1, -1, -1), (0, 1, 2)),
        ((-1, -1, -1), (1, 0, 2)),
        ((0, 1, -1, 0), (2, 0, 1, 3)),
        ((-1, 1, -1, 1), (1, 0, 3, 2)),
        ((1, -1, 0, 1, -1), (0, 1, 4, 2, 3)),
    ],
)
def test_feet_in_odd_places_take_those_that_are_left(sides: tuple[int, ...], slots: tuple[int, ...]) -> None:
    assert slots_of(sides) == slots


@few
@given(st.integers(2, 12), st.floats(0.0, 4.0))
def test_feet_of_one_side_never_all_fly_in_slow_waves(pairs: int, speed: float) -> None:
    made = pattern(styles.named([("wave", 1.0)]), _sides(2 * pairs), np.array([speed]))
    stand = _standing(made, 0, np.linspace(0.0, 1.0, 100, endpoint=False))
    assert stand[:, ::2].any(axis=1).all()
    assert stand[:, 1::2].any(axis=1).all()


# --- samples ---


def test_between_samples_a_pattern_goes_the_shorter_way_round_the_cycle() -> None:
    made = _at("auto", 4, *np.linspace(0.0, 4.0, 200))
    _assert_same(made, made.between(np.arange(200.0)))
    fine = made.between(np.linspace(0.0, 199.0, 4000))
    assert _apart(fine.triggers[1:], fine.triggers[:-1]).max() < 0.01
    assert (fine.triggers >= 0.0).all()
    assert (fine.triggers < 1.0).all()


def test_outside_its_samples_a_pattern_is_held() -> None:
    made = _at("auto", 4, 0.2, 0.8)
    _assert_same(made.between(np.array([-3.0, 7.0])), made)
    one = _at("auto", 4, 0.2)
    _assert_same(one.between(np.array([0.0, 0.7])), _at("auto", 4, 0.2, 0.2))
