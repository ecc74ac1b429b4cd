"""Jiggles: passive, damped, the same at any frame rate, scale and order of frames, and never out of bounds."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from morph_retarget.core import jiggling, quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.character.character import Character
from morph_retarget.core.skeleton import Pose, Skeleton, pose_from_basis
from morph_retarget.core.solve import jiggle, jiggle_chains
from morph_retarget.core.solve.jiggle import Surroundings
from morph_retarget.core.solve.jiggle_chains import Chains
from morph_retarget.core.solve.jiggle_kinds import JiggleKind, JiggleSettings, Override
from tests import morph_bodies, truth
from tests.skeletons import skeleton_of
from tools import creatures
from tools.figure import Bone, humanoid

STEP = 1 / 24
UP = np.array([0.0, 0.0, 1.0])
PLAIN = JiggleSettings(gravity=0.0)
HEAVY = JiggleSettings(gravity=0.5, ground=True)


def _creature(kind: str) -> Character:
    return analyze(skeleton_of(creatures.CREATURES[kind](), np.random.default_rng(3)))


def _hound(settings: JiggleSettings = PLAIN) -> jiggling.Jiggling:
    return jiggling.prepare(_creature("hound"), (), settings)


def _carried(what: jiggling.Jiggling, turns: Array, places: Array) -> Pose:
    """Return the jiggling bones on a body that moves as a whole, turns (frame, 4) and places (frame, 3)."""
    rest = what.character.skeleton.rest_positions[what.chains.bones]
    rotations = quat.multiply(turns[:, None], what.chains.rest)
    return Pose(rotations, places[:, None] + quat.rotate(turns[:, None], rest))


def _trip(frames: int = 72, step: float = STEP, size: float = 1.0) -> tuple[Array, Array]:
    """Return how a body turns, runs, jumps and stops within 3 s."""
    time = np.minimum(np.arange(frames) * step, 2.0)
    eased = 0.5 - 0.5 * np.cos(0.5 * np.pi * time)
    turns = quat.from_rotation_vector(np.stack([0.3 * np.sin(4.0 * time), 0.0 * time, 2.0 * eased], axis=-1))
    places = np.stack([eased, 2.0 * eased, 0.2 * np.abs(np.sin(2.0 * np.pi * eased))], axis=-1)
    return turns, size * places


def _simulated(what: jiggling.Jiggling, pose: Pose, step: float = STEP, period: int | None = None) -> Array:
    return jiggle.simulate(what.chains, what.settings.gravity, pose, step, what.around, period)


def _angles(turns: Array) -> Array:
    return quat.angle_between(turns, quat.IDENTITY)


# --- what jiggles ---


@pytest.mark.parametrize(
    ("kind", "expected"),
    [
        ("hound", {"Tail.001", "Tail.002", "Tail.003", "Tail.004", "Tail.005", "Ear.L", "Ear.R"}),
        ("beetle", {"Antenna1.L", "Antenna2.L", "Antenna1.R", "Antenna2.R"}),
        ("biped", set()),
        ("asura", set()),
    ],
)
def test_tails_ears_and_antennae_jiggle_and_bodies_limbs_and_faces_do_not(kind: str, expected: set[str]) -> None:
    character = _creature(kind)
    chains = jiggle_chains.find(character, (), PLAIN)
    assert {character.skeleton.names[b] for b in chains.bones} == expected


def test_wings_that_nothing_moves_jiggle_less_than_tails() -> None:
    chains = jiggle_chains.find(_creature("bird"), (), PLAIN)
    amounts = dict(zip(chains.kinds, chains.amount, strict=True))
    assert set(amounts) == {JiggleKind.TAIL, JiggleKind.WING}
    assert amounts[JiggleKind.WING] < 0.5 * amounts[JiggleKind.TAIL]


def test_a_sub_tree_that_the_action_poses_is_left_to_the_action() -> None:
    character = _creature("hound")
    index = character.skeleton.index

    def found(*posed: str) -> set[str]:
        chains = jiggle_chains.find(character, [index[name] for name in posed], PLAIN)
        return {character.skeleton.names[b] for b in chains.bones}

    assert found("Tail.005") == {"Ear.L", "Ear.R"}, "what carries a posed body has IK"
    assert found("Tail.002", "Ear.L") == {"Tail.003", "Tail.004", "Tail.005", "Ear.R"}


def _dressed(*extra: Bone) -> tuple[Character, set[str]]:
    character = analyze(skeleton_of([*humanoid(1.75), *extra], np.random.default_rng(1)))
    chains = jiggle_chains.find(character, (), PLAIN)
    return character, {character.skeleton.names[b] for b in chains.bones}


def _line(stem: str, parent: str, count: int, start: float = 1.6, away: float = 0.15) -> list[Bone]:
    places = [(0.0, away, start - 0.08 * i) for i in range(count + 1)]
    parents = [parent, *(f"{stem}{i}" for i in range(1, count))]
    return [Bone(f"{stem}{i + 1}", parents[i], places[i], places[i + 1]) for i in range(count)]


@pytest.mark.parametrize(
    ("stem", "count", "jiggles"),
    [
        ("hair_", 3, True),
        ("hair_", 1, False),
        ("cape_", 4, True),
        ("hat_", 3, False),
        ("horn_", 2, False),
        ("bone_", 4, True),
        ("bone_", 2, False),
        ("ik_ctrl_", 4, False),
        ("sword_", 3, False),
        ("tongue_", 3, False),
        ("head_twist_", 3, False),
    ],
)
def test_what_hangs_on_a_human_jiggles_by_type_and_flexibility(stem: str, count: int, jiggles: bool) -> None:
    _, found = _dressed(*_line(stem, "head", count))
    assert found == ({f"{stem}{i + 1}" for i in range(count)} if jiggles else set())


def test_no_joint_of_any_real_rig_jiggles(data) -> None:  # type: ignore[no-untyped-def]
    for name, character in morph_bodies.real_characters(data).items():
        chains = jiggle_chains.find(character, (), PLAIN)
        moved = {character.skeleton.names[b] for b in chains.bones}
        limbs = ("Arm", "Hand", "Leg", "Foot", "Toes", "head", "neck", "Eye", "jaw", "Thumb", "Index", "hips")
        kept = {m.bone for joint, m in character.joints.items() if any(part in joint for part in limbs)}
        if character.humanoid:
            kept |= {m.bone for m in character.joints.values()}
        assert not moved & kept, name


def test_limbs_of_real_rigs_whose_bones_say_nothing_do_not_jiggle(data) -> None:  # type: ignore[no-untyped-def]
    for table in truth.tables(data):
        if table["id"] == "rokoko_mixamo_preset_bvh":
            continue  # it is taken for another body
        rig = truth.nameless(truth.rig(data, table))
        character = truth.find(rig)
        chains = jiggle_chains.find(character, (), PLAIN)
        moved = {rig.original[character.skeleton.names[b]] for b in chains.bones}
        limbs = {b for j, b in table["ground_truth"]["canonical"].items() if j.startswith(("left", "right"))}
        assert not moved & limbs, table["id"]


@pytest.mark.parametrize(
    ("rig", "bones"),
    [("khronos_fox", 3), ("quaternius_wolf", 16), ("m2m_fox", 5), ("m2m_kaiju", 5), ("mixamo_mpfb", 0), ("smplx", 0)],
)
def test_tails_and_ears_of_real_rigs_are_found(data, rig: str, bones: int) -> None:  # type: ignore[no-untyped-def]
    assert len(jiggle_chains.find(morph_bodies.real_characters(data)[rig], (), PLAIN)) == bones


def test_settings_of_a_bone_go_before_those_of_its_kind_and_these_before_the_characters() -> None:
    tail, third = Override(0.3, 5.0, 0.5), Override(0.7, 9.0, 0.25)
    settings = replace(PLAIN, kinds={JiggleKind.TAIL: tail}, bones={"Tail.003": third})
    character = _creature("hound")
    chains = jiggle_chains.find(character, (), settings)
    got = {character.skeleton.names[b]: i for i, b in enumerate(chains.bones)}
    assert chains.half_life[got["Tail.002"]] == 0.3
    assert chains.stiffness[got["Tail.002"]] == 5.0
    assert chains.half_life[got["Tail.003"]] == 0.7
    assert chains.amount[got["Tail.003"]] == 0.25
    assert chains.half_life[got["Ear.L"]] == pytest.approx(0.5 * PLAIN.half_life)


# --- laws ---


@pytest.mark.parametrize("settings", [PLAIN, HEAVY])
def test_at_rest_nothing_moves(settings: JiggleSettings) -> None:
    what = _hound(settings)
    still = _carried(what, quat.identity(30), np.zeros((30, 3)))
    turns = _simulated(what, still)
    assert np.array_equal(turns, quat.identity(30, len(what.chains))) or settings is HEAVY
    assert _angles(turns).max() < 1e-12
    assert _angles(jiggle.basis_changes(what.chains, still, turns)).max() < 1e-12


def test_a_turned_body_that_stands_still_does_not_jiggle() -> None:
    what = _hound()
    turned = np.broadcast_to(quat.from_rotation_vector(np.array([0.4, 1.0, -2.0])), (30, 4))
    assert np.array_equal(_simulated(what, _carried(what, turned, np.ones((30, 3))))[..., 1:], np.zeros((30, 7, 3)))


def test_even_movement_drags_nothing_behind() -> None:
    what = _hound()
    places = np.arange(40)[:, None] * np.array([0.05, -0.2, 0.01])
    assert _angles(_simulated(what, _carried(what, quat.identity(40), places))).max() < 1e-9


def test_what_is_carried_lags_behind_and_then_follows_through() -> None:
    what = _hound()
    time = np.clip(np.arange(60) * STEP / 0.5, 0.0, 1.0)
    heading = 0.5 * np.pi * (0.5 - 0.5 * np.cos(np.pi * time))
    turns = quat.from_axis_angle(UP, heading)
    lag = quat.to_rotation_vector(_simulated(what, _carried(what, turns, np.zeros((60, 3)))))[..., 2]
    tip = what.chains.bones.tolist().index(what.character.skeleton.index["Tail.003"])
    assert lag[:9, tip].min() < -0.15, "it stays behind as the turn begins"
    assert lag[9:, tip].max() > 0.1, "and swings beyond as it ends"
    assert np.abs(lag[-1, tip]) < 0.01
    assert np.abs(lag[:, tip - 2]).max() < 0.5 * np.abs(lag[:, tip]).max(), "the base bends least"


@pytest.mark.parametrize("half_life", [0.05, 0.12, 0.4])
def test_the_half_life_is_the_time_in_which_the_lag_halves(half_life: float) -> None:
    ear = {JiggleKind.EAR: Override(half_life, 4.0, 1.0)}
    what = _hound(replace(PLAIN, kinds=ear))
    step, frames = half_life / 10.0, 100
    places = np.zeros((frames, 3))
    places[5:] = (0.005, 0.0, 0.0)
    angles = _angles(_simulated(what, _carried(what, quat.identity(frames), places), step))
    tip = what.chains.bones.tolist().index(what.character.skeleton.index["Ear.L"])
    assert angles[50, tip] / angles[40, tip] == pytest.approx(0.5, abs=0.01)


def test_it_looks_the_same_at_any_frame_rate() -> None:
    what = _hound(replace(PLAIN, gravity=0.3))
    fine = _simulated(what, _carried(what, *_trip(3 * 240, 1 / 240)), 1 / 240)
    assert np.degrees(_angles(fine).max()) > 20.0
    for rate, near in ((12, 6.0), (24, 2.0), (30, 1.5), (60, 0.5), (120, 0.2)):
        turns = _simulated(what, _carried(what, *_trip(3 * rate, 1 / rate)), 1 / rate)
        assert np.degrees(quat.angle_between(turns, fine[:: 240 // rate]).max()) < near, rate


@pytest.mark.parametrize("settings", [PLAIN, HEAVY])
def test_a_frame_depends_on_those_before_it_alone_bit_for_bit(settings: JiggleSettings) -> None:
    what = _hound(settings)
    pose = _carried(what, *_trip())
    whole = _simulated(what, pose)
    for end in (1, 2, 3, 7, 20, 41, 71):
        part = _simulated(what, Pose(pose.rotations[:end], pose.positions[:end]))
        assert np.array_equal(part, whole[:end]), end


@pytest.mark.parametrize("scale", [1e-3, 100.0])
@pytest.mark.parametrize("settings", [PLAIN, HEAVY])
def test_size_does_not_matter(scale: float, settings: JiggleSettings) -> None:
    small, skeleton = _hound(settings), _creature("hound").skeleton
    large_skeleton = replace(
        skeleton, rest_positions=scale * skeleton.rest_positions, rest_tails=scale * skeleton.rest_tails
    )
    large = jiggling.prepare(analyze(large_skeleton), (), settings)
    assert np.array_equal(large.chains.bones, small.chains.bones)
    one = _simulated(small, _carried(small, *_trip()))
    other = _simulated(large, _carried(large, *_trip(size=scale)))
    assert quat.angle_between(one, other).max() < 1e-6


def test_the_place_and_heading_of_a_character_do_not_matter() -> None:
    what = _hound(replace(PLAIN, gravity=0.4))
    turns, places = _trip()
    about = quat.from_axis_angle(UP, 2.2)
    there = _carried(what, quat.multiply(about, turns), quat.rotate(about, places) + np.array([50.0, -80.0, 3.0]))
    here = _carried(what, turns, places)
    changes = [jiggle.basis_changes(what.chains, pose, _simulated(what, pose)) for pose in (here, there)]
    assert quat.angle_between(*changes).max() < 1e-6


def test_after_a_jump_it_begins_anew() -> None:
    what = _hound()
    turns, places = _trip()
    far = places.copy()
    far[30:] += np.array([40.0, 0.0, 0.0])
    jumped = _simulated(what, _carried(what, turns, far))
    anew = _simulated(what, _carried(what, turns[30:], far[30:]))
    assert np.array_equal(jumped[:30], _simulated(what, _carried(what, turns, places))[:30])
    assert _angles(jumped[30]).max() == 0.0
    assert quat.angle_between(jumped[33:], anew[3:]).max() < 0.05


def test_a_flip_within_a_frame_is_a_jump_and_a_steady_spin_is_none() -> None:
    what = _hound()
    heading = np.where(np.arange(20) < 10, 0.0, 3.0)
    flipped = _simulated(what, _carried(what, quat.from_axis_angle(UP, heading), np.zeros((20, 3))))
    assert _angles(flipped).max() == 0.0
    spin = _simulated(what, _carried(what, quat.from_axis_angle(UP, 0.8 * np.arange(60.0)), np.zeros((60, 3))))
    assert _angles(spin[-1]).max() > 0.05


def test_energy_never_grows_while_the_carrier_is_still() -> None:
    slow, quick, step = 5.0, 15.0, 0.01
    start = {rate: np.array([[0.3, -0.2, 0.5]]) * weight for rate, weight in ((slow, 1.0), (quick, -0.7))}
    still = np.zeros((300, 1, 3))
    lag = {
        rate: jiggle.damped(still, np.array([[np.exp(-rate * step)]]), np.ones((1, 1)), start[rate])
        for rate in (slow, quick)
    }
    place = (quick * lag[quick] - slow * lag[slow]) / (quick - slow)
    speed = (slow**2 * lag[slow] - quick**2 * lag[quick]) / (quick - slow)
    energy = (speed**2 + slow * quick * place**2).sum(axis=(1, 2))
    assert (np.diff(energy) <= 0.0).all()
    assert energy[-1] < 1e-9 * energy[0]


def test_the_dampers_are_exact_for_movement_that_is_even_between_frames() -> None:
    rng = np.random.default_rng(0)
    coarse = np.cumsum(rng.normal(size=(20, 1, 3)), axis=0)
    fine = np.concatenate(
        [coarse[:1], (coarse[:-1, None] + np.diff(coarse, axis=0)[:, None] * _EIGHTHS).reshape(-1, 1, 3)]
    )
    results = []
    for places, step in ((coarse, 0.1), (fine, 0.1 / 8)):
        rate = np.array([[4.0]])
        keep, gain = np.exp(-rate * step), (1.0 - np.exp(-rate * step)) / (rate * step)
        results.append(jiggle.damped(np.diff(places, axis=0), keep, gain, np.zeros((1, 3))))
    assert np.abs(results[0] - results[1][::8]).max() < 1e-12


_EIGHTHS = (np.arange(1, 9) / 8.0)[None, :, None, None]


def test_a_cycle_goes_over_its_seam_without_a_jump() -> None:
    what = _hound(replace(PLAIN, gravity=0.3))
    phase = 2.0 * np.pi * np.arange(25) / 24
    turns = quat.from_rotation_vector(np.stack([0.2 * np.sin(phase), 0.0 * phase, 0.4 * np.cos(phase)], axis=-1))
    walk = np.stack([0.05 * np.sin(phase), -0.06 * np.arange(25), 0.03 * np.sin(2.0 * phase)], axis=-1)
    pose = _carried(what, turns, walk)
    once = jiggling.changes(what, pose, STEP)
    assert quat.angle_between(once[0], once[-1]).max() < 1e-6
    rounds = np.concatenate([pose.positions[:-1] + i * (pose.positions[-1] - pose.positions[0]) for i in range(8)])
    long = Pose(np.concatenate([pose.rotations[:-1]] * 8), rounds)
    many = jiggle.basis_changes(what.chains, long, _simulated(what, long))
    assert quat.angle_between(many[-24:], once[:-1]).max() < 1e-6
    assert quat.angle_between(once[0], quat.IDENTITY).max() > 0.02
    apart = jiggling.changes(replace(what, settings=replace(what.settings, loop=False)), pose, STEP)
    assert _angles(apart[0]).max() < 0.02


# --- gravity and ground ---


def test_parts_hang_down_when_the_body_is_tilted() -> None:
    what = _hound(replace(PLAIN, gravity=0.5))
    side = np.broadcast_to(quat.from_rotation_vector(np.array([0.0, 0.5 * np.pi, 0.0])), (10, 4))
    pose = _carried(what, side, np.zeros((10, 3)))
    ways = quat.rotate(pose.rotations, what.chains.tips)
    hanging = quat.rotate(_simulated(what, pose), ways)
    tail = [i for i, kind in enumerate(what.chains.kinds) if kind is JiggleKind.TAIL]
    assert (hanging[:, tail, 2] < ways[:, tail, 2]).all()


def _tips(what: jiggling.Jiggling, pose: Pose, turns: Array) -> Array:
    """Return where the tips are with the jiggles, shape (frame, n, 3)."""
    heads, out = pose.positions.copy(), np.empty_like(pose.positions)
    for i, above in enumerate(what.chains.above):
        if above >= 0:
            away = pose.positions[:, i] - pose.positions[:, above]
            heads[:, i] = heads[:, above] + quat.rotate(turns[:, above], away)
        out[:, i] = heads[:, i] + quat.rotate(turns[:, i], quat.rotate(pose.rotations[:, i], what.chains.tips[i]))
    return out


def test_nothing_sinks_below_the_ground() -> None:
    free, kept = (_hound(JiggleSettings(gravity=0.0, ground=ground)) for ground in (False, True))
    tilted = np.broadcast_to(quat.from_rotation_vector(np.array([-0.9, 0.0, 0.0])), (40, 4))
    height = np.concatenate([np.full(10, 1.0), np.linspace(1.0, 0.0, 6), np.zeros(24)])
    pose = _carried(kept, tilted, height[:, None] * UP)
    sunk, lying = (_tips(what, pose, _simulated(what, pose)) for what in (free, kept))
    carried = pose.positions + quat.rotate(pose.rotations, kept.chains.tips)
    bound = np.minimum(carried[..., 2], 0.0)
    assert (sunk[..., 2] < bound - 0.01).any()
    assert (lying[..., 2] > bound - 1e-9).all()


# --- bad input ---


@pytest.mark.parametrize("step", [1e-9, 1 / 240, 1.0, 1e6])
@pytest.mark.parametrize("settings", [PLAIN, HEAVY, JiggleSettings(half_life=0.0, stiffness=0.0, amount=1e6)])
def test_nothing_explodes_at_any_step(step: float, settings: JiggleSettings) -> None:
    what = _hound(settings)
    rng = np.random.default_rng(0)
    turns = quat.normalize(rng.normal(size=(50, 4)))
    places = rng.normal(size=(50, 3)) * 10.0 ** rng.uniform(-9, 9, (50, 1))
    found = _simulated(what, _carried(what, turns, places), step)
    assert np.isfinite(found).all()
    assert np.abs(quat.length(found) - 1.0).max() < 1e-9
    if settings.gravity == 0.0:
        assert (_angles(found) <= what.chains.limit + 1e-9).all()


@given(st.integers(0, 10**6), st.integers(1, 40))
def test_nothing_turns_beyond_its_limit(seed: int, frames: int) -> None:
    rng = np.random.default_rng(seed)
    what = _HOUND
    turns = quat.from_rotation_vector(np.cumsum(rng.normal(size=(frames, 3)), axis=0))
    found = _simulated(what, _carried(what, turns, rng.normal(size=(frames, 3)) * 10.0 ** rng.uniform(-3, 3)))
    assert np.isfinite(found).all()
    assert (_angles(found) <= what.chains.limit + 1e-9).all()


_HOUND = _hound()


def test_bones_without_length_are_carried_along() -> None:
    skeleton = _creature("hound").skeleton
    places, tails = skeleton.rest_positions.copy(), skeleton.rest_tails.copy()
    third, fourth = skeleton.index["Tail.003"], skeleton.index["Tail.004"]
    places[fourth] = tails[third] = places[third]
    tails[skeleton.index["Ear.L"]] = places[skeleton.index["Ear.L"]]
    what = jiggling.prepare(analyze(replace(skeleton, rest_positions=places, rest_tails=tails)), (), PLAIN)
    names = {skeleton.names[b] for b in what.chains.bones}
    assert names == {"Tail.001", "Tail.002", "Tail.004", "Tail.005", "Ear.R"}
    assert np.isfinite(_simulated(what, _carried(what, *_trip()))).all()


def test_a_bone_that_takes_over_no_rotation_parts_a_tail() -> None:
    skeleton = _creature("hound").skeleton
    inherits = np.ones(len(skeleton), dtype=bool)
    inherits[skeleton.index["Tail.002"]] = False
    what = jiggling.prepare(analyze(replace(skeleton, inherits=inherits)), (), PLAIN)
    bones = [skeleton.names[b] for b in what.chains.bones]
    assert sorted(bones) == ["Ear.L", "Ear.R", "Tail.001", "Tail.003", "Tail.004", "Tail.005"]
    assert what.chains.above[bones.index("Tail.003")] == jiggle_chains.NONE
    assert bones[what.chains.above[bones.index("Tail.004")]] == "Tail.003"
    assert np.isfinite(_simulated(what, _carried(what, *_trip()))).all()


def test_a_twist_bone_within_a_tail_is_carried_and_does_not_part_it() -> None:
    skeleton = _creature("hound").skeleton
    names = tuple("Tail_twist" if name == "Tail.003" else name for name in skeleton.names)
    what = jiggling.prepare(analyze(replace(skeleton, names=names)), (), PLAIN)
    bones = [names[b] for b in what.chains.bones]
    assert "Tail_twist" not in bones
    assert bones[what.chains.above[bones.index("Tail.004")]] == "Tail.002"


def test_odd_bodies_have_nothing_or_something_that_jiggles_and_never_fail() -> None:
    flat = Skeleton(
        ("a", "b", "tail", "tail2"), np.array([-1, 0, 1, 2]), np.zeros((4, 3)), quat.identity(4), np.zeros((4, 3))
    )
    assert not jiggling.prepare(analyze(flat), (), HEAVY)


@pytest.mark.parametrize("frames", [1, 2])
def test_the_shortest_clips_play(frames: int) -> None:
    what = _hound(HEAVY)
    found = jiggling.changes(what, _carried(what, *_trip(frames)), STEP)
    assert found.shape == (frames, len(what.chains), 4)
    assert _angles(found).max() < 0.01


# --- with what it hangs on ---


def test_changes_turn_bones_as_simulated_and_nothing_else_moves() -> None:
    what = _hound()
    skeleton = what.character.skeleton
    rng = np.random.default_rng(4)
    frames = 40
    waves = np.sin(np.linspace(0.0, 9.0, frames)[:, None, None] + rng.uniform(0.0, 6.0, (len(skeleton), 3)))
    basis = quat.from_rotation_vector(0.2 * waves)
    pose = pose_from_basis(skeleton, basis, np.zeros((frames, len(skeleton), 3)))
    own = Pose(pose.rotations[:, what.chains.bones], pose.positions[:, what.chains.bones])
    turns = _simulated(what, own)
    moved = basis.copy()
    moved[:, what.chains.bones] = quat.multiply(
        basis[:, what.chains.bones], jiggle.basis_changes(what.chains, own, turns)
    )
    after = pose_from_basis(skeleton, moved, np.zeros((frames, len(skeleton), 3)))
    wanted = quat.multiply(turns, own.rotations)
    assert quat.angle_between(after.rotations[:, what.chains.bones], wanted).max() < 1e-6
    others = np.setdiff1d(np.arange(len(skeleton)), what.chains.bones)
    assert np.array_equal(moved[:, others], basis[:, others])
    assert np.abs(after.positions[:, others] - pose.positions[:, others]).max() == 0.0


def test_many_short_chains_are_as_good_as_each_alone() -> None:
    what = _hound()
    pose = _carried(what, *_trip())
    whole = _simulated(what, pose)
    tail = np.flatnonzero([kind is JiggleKind.TAIL for kind in what.chains.kinds])
    c = what.chains
    alone = Chains(
        c.bones[tail],
        np.arange(-1, len(tail) - 1),
        np.zeros(len(tail), dtype=np.intp),
        c.rest[tail],
        c.tips[tail],
        c.share[tail],
        c.length[tail],
        tuple(c.kinds[i] for i in tail),
        c.half_life[tail],
        c.stiffness[tail],
        c.amount[tail],
        c.limit[tail],
    )
    found = jiggle.simulate(
        alone, 0.0, Pose(pose.rotations[:, tail], pose.positions[:, tail]), STEP, Surroundings(what.around.size, UP)
    )
    assert quat.angle_between(found, whole[:, tail]).max() < 1e-12
