"""Movement modes (Hecker 2008 §3.2): the laws of G and S, for any body of any character in any mode."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from morph_retarget.core import quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.morph import aim, movement
from morph_retarget.core.morph.bodies import FORWARD, LEFT, UP, Bodies
from morph_retarget.core.morph.movement import Frames, Movement, PositionMode, RotationMode, ScaleMode
from tests.morph_bodies import (
    MIRROR,
    MIRROR_TURN,
    Body,
    bodies_of,
    random_bodies,
    real_bodies,
    symmetric_bodies,
)

_FLAGS = (False, True)
MODES = [Movement(*settings) for settings in product(PositionMode, RotationMode, ScaleMode, *[_FLAGS] * 5)]
"""All combinations of movement modes."""
GROUND = Movement(ground_relative=True)
SAGITTAL = Movement(sagittal_relative=True)
SECONDARY = Movement(secondary_relative=True)
LOOK = Movement(look_at=True)
seeds = st.integers(0, 10_000)
few = settings(max_examples=30)


def _rng(seed: int) -> np.random.Generator:
    return np.random.default_rng(seed)


def _every_mode(bodies: Bodies, rng: np.random.Generator, count: int = 3) -> tuple[Frames, Array, list[Movement]]:
    """Return frames of random bodies in all modes, mirrored and not, with random targets; the bodies and the modes."""
    modes = [*MODES, *MODES]
    chosen = rng.integers(len(bodies), size=len(modes))
    mirrored = np.arange(len(modes)) >= len(MODES)
    targets = _places(bodies, rng, count, len(modes))
    return movement.frames(bodies, chosen, modes, mirrored).toward(targets), chosen, modes


def _places(bodies: Bodies, rng: np.random.Generator, *shape: int) -> Array:
    """Return random places in and around a character."""
    middle = 0.5 * (bodies.low + bodies.high)
    return middle + bodies.size * rng.uniform(-1.5, 1.5, (*shape, 3))


def _turns(rng: np.random.Generator, *shape: int) -> Array:
    return quat.normalize(rng.normal(size=(*shape, 4)))


def _assert_inverse(bodies: Bodies, found: Frames, rng: np.random.Generator) -> None:
    """Check that G undoes S and S undoes G, to a millionth of the character's size and of a turn."""
    count = (len(found), found.origin.shape[1])
    q, turns = rng.uniform(-2.0, 2.0, (*count, 3)), _turns(rng, *count)
    again, turns_again = movement.generalize(found, *movement.specialize(found, q, turns))
    assert np.abs(again - q).max() < 1e-6
    assert quat.angle_between(turns_again, turns).max() < 1e-6
    places, turned = _places(bodies, rng, *count), _turns(rng, *count)
    again, turned_again = movement.specialize(found, *movement.generalize(found, places, turned))
    assert np.abs(again - places).max() < 1e-6 * bodies.size
    assert quat.angle_between(turned_again, turned).max() < 1e-6


@few
@given(seed=seeds)
def test_g_and_s_are_inverse_in_every_mode(seed: int) -> None:
    rng = _rng(seed)
    bodies = random_bodies(rng)
    _assert_inverse(bodies, _every_mode(bodies, rng)[0], rng)


def test_g_and_s_are_inverse_on_real_rigs(data: Path) -> None:
    rng = _rng(1)
    for bodies in real_bodies(data).values():
        _assert_inverse(bodies, _every_mode(bodies, rng, 1)[0], rng)


def _assert_rest(bodies: Bodies, rng: np.random.Generator) -> None:
    """Check that each body at rest has the same generalized value, as far as its mode does not say otherwise."""
    found, chosen, modes = _every_mode(bodies, rng, 2)
    rest = np.broadcast_to(bodies.positions[chosen], (2, len(chosen), 3))
    axes = np.broadcast_to(bodies.axes[chosen], (2, len(chosen), 4))
    q, turns = movement.generalize(found, rest, axes)
    # Absolute mode is the identity: the paper's own exception. Axes that another mode takes over are none of it.
    absolute = np.array([m.position is PositionMode.ABSOLUTE and not m.secondary_relative for m in modes])
    taken = np.array([(m.sagittal_relative, False, m.ground_relative) for m in modes])
    assert np.abs(q[:, ~absolute[:, None] | taken]).max() < 1e-6
    # A rotation of identity in a look-at frame means to look at the target, not to rest.
    relative = np.array([m.rotation is RotationMode.REST_RELATIVE and not m.look_at for m in modes])
    assert quat.angle_between(turns[:, relative], quat.IDENTITY).max() < 1e-6
    places, turned = movement.specialize(found, np.zeros((2, len(modes), 3)), quat.identity(2, len(modes)))
    assert np.abs(places - rest)[:, ~absolute].max() < 1e-6 * bodies.size
    assert quat.angle_between(turned, axes)[:, relative].max() < 1e-6


@few
@given(seed=seeds)
def test_rest_is_zero_for_every_body_wherever_its_target_is(seed: int) -> None:
    rng = _rng(seed)
    _assert_rest(random_bodies(rng), rng)


def test_rest_is_zero_on_real_rigs(data: Path) -> None:
    for bodies in real_bodies(data).values():
        _assert_rest(bodies, _rng(2))


@few
@given(seed=seeds)
def test_a_look_at_frame_is_at_rest_while_its_target_is_straight_ahead(seed: int) -> None:
    bodies = random_bodies(_rng(seed))
    all_of_them = np.arange(len(bodies))
    ahead = bodies.positions + bodies.size * bodies.forwards
    found = movement.frames(bodies, all_of_them, [LOOK] * len(bodies), all_of_them < 0).toward(ahead[None])
    _, turned = movement.specialize(found, np.zeros((1, len(bodies), 3)), quat.identity(1, len(bodies)))
    assert quat.angle_between(turned, bodies.axes).max() < 1e-6


@few
@given(seed=seeds)
def test_ground_relative_1_is_on_the_ground(seed: int) -> None:
    rng = _rng(seed)
    bodies = random_bodies(rng)
    found, chosen, modes = _every_mode(bodies, rng)
    q = rng.uniform(-2.0, 2.0, (3, len(modes), 3))
    q[..., 2] = 1.0
    places, _ = movement.specialize(found, q, quat.identity(3, len(modes)))
    # A body that rests on the ground goes a thousandth of the character's size below it.
    above = bodies.positions[chosen, 2] >= movement.TINY * bodies.size
    of_mode = np.array([m.ground_relative for m in modes])
    assert np.abs(places[:, of_mode & above, 2]).max() < 1e-6 * bodies.size
    assert np.abs(places[:, of_mode, 2]).max() < 1.001 * movement.TINY * bodies.size


@few
@given(seed=seeds)
def test_secondary_relative_1_is_on_the_target_wherever_that_moves(seed: int) -> None:
    rng = _rng(seed)
    bodies = random_bodies(rng)
    _, chosen, modes = _every_mode(bodies, rng)
    targets = _places(bodies, rng, 5, len(modes))
    mirrored = np.arange(len(modes)) >= len(MODES)
    found = movement.frames(bodies, chosen, modes, mirrored).toward(targets)
    q = np.zeros((1, len(modes), 3))
    q[..., 0] = 1.0
    places, _ = movement.specialize(found, q, quat.identity(1, len(modes)))
    stretched = np.array([m.secondary_relative and not m.directional_only for m in modes])
    level = np.array([m.ground_relative for m in modes])
    apart = np.abs(places - targets)
    assert apart[:, stretched & ~level].max() < 1e-6 * bodies.size
    # Layered with ground-relative it is over or under its target, as high as at rest.
    assert apart[:, stretched & level, :2].max() < 1e-6 * bodies.size
    assert np.abs(places[..., 2] - bodies.positions[chosen, 2])[:, stretched & level].max() < 1e-6 * bodies.size


@few
@given(seed=seeds)
def test_sagittal_relative_1_is_on_the_plane_of_symmetry(seed: int) -> None:
    rng = _rng(seed)
    bodies = random_bodies(rng)
    found, chosen, modes = _every_mode(bodies, rng)
    q = rng.uniform(-2.0, 2.0, (3, len(modes), 3))
    q[..., 0] = 1.0
    places, _ = movement.specialize(found, q, quat.identity(3, len(modes)))
    of_mode = np.array([m.sagittal_relative and not m.secondary_relative for m in modes])
    beside = np.abs(bodies.positions[chosen, 0]) >= movement.TINY * bodies.size
    assert np.abs(places[:, of_mode & beside, 0]).max() < 1e-6 * bodies.size


@few
@given(seed=seeds)
def test_mirrored_is_the_mirror_image_of_the_partner_unmirrored(seed: int) -> None:
    rng = _rng(seed)
    bodies, partner = symmetric_bodies(rng)
    chosen = rng.integers(1, len(bodies), size=len(MODES))
    targets, q = _places(bodies, rng, 3, len(MODES)), rng.uniform(-2.0, 2.0, (3, len(MODES), 3))
    turns, never, always = _turns(rng, 3, len(MODES)), np.zeros(len(MODES), bool), np.ones(len(MODES), bool)
    plain = movement.frames(bodies, chosen, MODES, never).toward(targets)
    image = movement.frames(bodies, partner[chosen], MODES, always).toward(targets * MIRROR)
    places, turned = movement.specialize(plain, q, turns)
    image_places, image_turned = movement.specialize(image, q, turns)
    # Straight behind, a target may be turned to either way round; random ones never are.
    assert np.abs(image_places - places * MIRROR).max() < 1e-6 * bodies.size
    # In absolute mode all bodies take one orientation, of which the mirror image is the mirrored one.
    assert quat.angle_between(image_turned, turned * MIRROR_TURN).max() < 1e-6


def _moved(bodies: Bodies, body: int, mode: Movement, q: Sequence[float], target: Array | None = None) -> Array:
    """Return how far from rest one body is for one generalized position."""
    found = movement.frames(bodies, np.array([body]), [mode], np.zeros(1, bool))
    if target is not None:
        found = found.toward(np.asarray(target, dtype=np.float64).reshape(-1, 1, 3))
    places, _ = movement.specialize(found, np.array(q, dtype=np.float64)[None, None], quat.identity(1, 1))
    return places[:, 0] - bodies.positions[body]


def _walker() -> Bodies:
    """Return a body 1 m wide, 2 m long and 3 m high, with one long arm and one short one."""
    return bodies_of(
        [
            Body("hips", (0, 0, 1.5), (Capability.ROOT, Capability.SPINE)),
            Body("long elbow", (0.3, 0, 1.5), (), "hips"),
            Body("long hand", (0.3, -0.8, 1.5), (Capability.GRASPER,), "long elbow"),
            Body("short hand", (-0.3, 0, 1.5), (Capability.GRASPER,), "hips"),
        ],
        low=(-0.5, -1.0, 0.0),
        high=(0.5, 1.0, 3.0),
    )


def test_without_a_scale_mode_one_unit_is_one_metre_along_each_axis() -> None:
    assert np.allclose(_moved(_walker(), 2, Movement(), (1, 2, 3)), [1, 2, 3])


def test_creature_size_scales_each_axis_by_the_bounding_box() -> None:
    mode = Movement(scale=ScaleMode.CREATURE_SIZE)
    assert np.allclose(_moved(_walker(), 2, mode, (1, 1, 1)), [1, 2, 3])
    assert np.allclose(_moved(_walker(), 3, mode, (1, 1, 1)), [1, 2, 3])


def test_limb_length_scales_by_the_path_to_the_spine() -> None:
    mode = Movement(scale=ScaleMode.LIMB_LENGTH)
    assert np.allclose(_moved(_walker(), 2, mode, (1, -1, 2)), 1.1 * np.array([1, -1, 2]))
    assert np.allclose(_moved(_walker(), 3, mode, (1, -1, 2)), 0.3 * np.array([1, -1, 2]))


@few
@given(seed=seeds, factor=st.floats(0.01, 100.0))
def test_scaled_characters_make_scaled_movements(seed: int, factor: float) -> None:
    rng = _rng(seed)
    bodies = random_bodies(rng)
    scaled = replace(bodies, **{name: factor * getattr(bodies, name) for name in ("positions", "low", "high")})
    chosen, targets = rng.integers(len(bodies), size=len(MODES)), _places(bodies, rng, 1, len(MODES))
    never, q = np.zeros(len(MODES), bool), rng.uniform(-2.0, 2.0, (1, len(MODES), 3))
    places, _ = movement.specialize(movement.frames(bodies, chosen, MODES, never).toward(targets), q, _turns(rng, 1, 1))
    found = movement.frames(scaled, chosen, MODES, never).toward(factor * targets)
    larger, _ = movement.specialize(found, q, _turns(rng, 1, 1))
    rests = np.array([m.position is PositionMode.REST_RELATIVE or m.secondary_relative for m in MODES])
    scales = np.array([m.scale is not ScaleMode.NONE for m in MODES])
    assert np.abs(larger - factor * places)[:, rests & scales].max() < 1e-6 * scaled.size


@pytest.mark.parametrize("scale", ScaleMode)
def test_a_punch_keeps_its_shape_as_its_target_moves_nearer(scale: ScaleMode) -> None:
    bodies, way = _walker(), quat.unit(np.array([0.5, -1.0, 0.3]))
    targets = bodies.positions[2] + np.linspace(0.01, 3.0, 20)[:, None] * way
    punch = _moved(bodies, 2, Movement(scale=scale, secondary_relative=True, directional_only=True), (1, 0, 0), targets)
    assert np.abs(punch - punch[0]).max() < 1e-9
    assert np.allclose(quat.unit(punch[0]), way)
    stretched = _moved(bodies, 2, Movement(scale=scale, secondary_relative=True), (1, 0, 0), targets)
    assert np.allclose(stretched, targets - bodies.positions[2])


def test_to_the_left_of_a_target_and_above_it_are_square_to_the_way_there() -> None:
    bodies = _walker()
    assert np.allclose(_moved(bodies, 2, SECONDARY, (0, 1, 0), bodies.positions[2] + FORWARD), LEFT)
    assert np.allclose(_moved(bodies, 2, SECONDARY, (0, 0, 1), bodies.positions[2] + 2.0 * FORWARD), UP)
    targets = bodies.positions[2] + _rng(3).normal(size=(50, 3))
    along, aside, up = (_moved(bodies, 2, SECONDARY, q, targets) for q in np.eye(3))
    for a, b in ((along, aside), (aside, up), (up, along)):
        assert np.abs(quat.dot(a, b)).max() < 1e-9


# --- where frames would degenerate ---


def _steps(values: Array) -> float:
    return float(np.linalg.norm(np.diff(values, axis=0), axis=-1).max())


@pytest.mark.parametrize("way", [LEFT, UP, FORWARD + LEFT, -0.9 * FORWARD + 0.3 * UP + 0.3 * LEFT])
@pytest.mark.parametrize("settings", [{}, {"directional_only": True}, {"ground_relative": True}])
def test_a_target_may_pass_through_the_rest_position(way: Array, settings: dict[str, bool]) -> None:
    """Not along the line that leads straight behind: no frame can turn smoothly all around (see `aim.Aims.turned`)."""
    bodies = _walker()
    mode = Movement(secondary_relative=True, **settings)
    along = np.linspace(-3e-3, 3e-3, 20001)[:, None] * bodies.size
    targets = bodies.positions[2] + along * quat.unit(way)
    for q in ((1, 0, 0), (0.5, 1, -1), (0, 0, 1)):
        moved = _moved(bodies, 2, mode, q, targets)
        assert np.isfinite(moved).all()
        assert _steps(moved) < 5e-3 * bodies.size


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_a_body_may_rest_on_the_ground(sign: float) -> None:
    bodies = _walker()
    heights = np.linspace(-3e-3, 3e-3, 201) * bodies.size
    moved = []
    for height in heights:
        places = bodies.positions.copy()
        places[2, 2] = height
        moved.append(_moved(replace(bodies, positions=places), 2, GROUND, (0.3, 0.2, sign))[0])
    assert _steps(np.array(moved)) < 1e-3 * bodies.size
    # There is room to lift it, and next to none to lower it.
    at_rest = np.array(moved)[100]
    assert at_rest[2] == pytest.approx(-movement.TINY * bodies.size) if sign > 0.0 else at_rest[2] > 0.2


def test_a_body_may_rest_on_the_plane_of_symmetry() -> None:
    bodies = _walker()
    moved = []
    for x in np.linspace(-3e-3, 3e-3, 201) * bodies.size:
        places = bodies.positions.copy()
        places[2, 0] = x
        moved.append(_moved(replace(bodies, positions=places), 2, SAGITTAL, (1, 0.2, 0.3))[0])
    # It crosses to the other side in the middle: by twice a thousandth of the size, too little to be seen.
    assert _steps(np.array(moved)) < 2.1 * movement.TINY * bodies.size


def test_a_limb_may_have_no_length() -> None:
    bodies = _walker()
    mode = Movement(scale=ScaleMode.LIMB_LENGTH)
    moved = []
    for length in np.linspace(0.0, 0.4, 401):
        places = bodies.positions.copy()
        places[3] = places[0] - length * LEFT
        moved.append(_moved(replace(bodies, positions=places), 3, mode, (0, 0, 1))[0])
    assert _steps(np.array(moved)) < 2e-3
    assert moved[0][2] == pytest.approx(0.05 * bodies.size)
    # A segment of the spine has no limb either.
    assert _moved(bodies, 0, mode, (0, 0, 1))[0, 2] == pytest.approx(0.05 * bodies.size)


def test_g_and_s_are_inverse_where_frames_would_degenerate() -> None:
    rows = [
        Body("root", (0, 0, 0), (Capability.ROOT, Capability.SPINE)),
        Body("on the root", (0, 0, 0), (), "root"),
        Body("buried", (0, 0.5, -0.3), (), "root"),
        Body("high", (0.4, 0, 2.0), (), "root"),
    ]
    # The last character is flat: all of it lies on the plane of symmetry.
    for bodies in (bodies_of(rows), bodies_of([replace(row, place=(0, *row.place[1:])) for row in rows])):
        rng = _rng(4)
        chosen, modes = np.repeat(np.arange(4), len(MODES)), MODES * 4
        for mirrored in (np.zeros(len(modes), bool), np.ones(len(modes), bool)):
            rest = bodies.positions[chosen]
            near = rest + 1e-4 * bodies.size * rng.normal(size=rest.shape)
            behind, below = (rest - way * bodies.size for way in (FORWARD, UP))
            targets = np.stack([rest, near, behind, below, rest - 0.5e-3 * bodies.size * FORWARD])
            found = movement.frames(bodies, chosen, modes, mirrored).toward(targets)
            assert found.lead is not None
            assert all(np.isfinite(v).all() for v in (found.lead.axes, found.lead.lengths, found.scale))
            _assert_inverse(bodies, found, rng)


# --- look-at ---


def _look(forward: Array, targets: Array, body: int = 1) -> Array:
    """Return where a head looks that looked ahead at rest, unit vectors, for targets around it."""
    bodies = bodies_of([Body("hips", (0, 0, 1)), Body("head", (0, 0, 2), (), "hips")])
    axes = bodies.axes.copy()
    axes[body] = quat.between(FORWARD, forward)
    bodies = replace(bodies, axes=axes)
    found = movement.frames(bodies, np.array([body]), [LOOK], np.zeros(1, bool))
    found = found.toward((bodies.positions[body] + targets)[:, None])
    _, turned = movement.specialize(found, np.zeros((1, 1, 3)), quat.identity(1, 1))
    return quat.rotate(turned[:, 0], FORWARD)


def _around(forward: Array, angles: Array, rng: np.random.Generator) -> Array:
    """Return directions at angles from forward, all in one random plane through it."""
    side = quat.unit(quat.cross(forward, rng.normal(size=3)))
    return np.cos(angles)[:, None] * forward + np.sin(angles)[:, None] * side


@few
@given(seed=seeds)
def test_a_gaze_is_on_its_target_up_to_45_degrees_and_never_turns_beyond_80(seed: int) -> None:
    rng = _rng(seed)
    forward = quat.unit(rng.normal(size=3))
    angles = np.radians(np.linspace(0.0, 180.0, 721))
    ways = _around(forward, angles, rng)
    looked = _look(forward, ways * rng.uniform(0.2, 3.0))
    turned = np.arccos(np.clip(looked @ forward, -1.0, 1.0))
    near = angles <= np.radians(45.0)
    assert np.abs(looked - ways)[near].max() < 1e-6
    assert turned.max() < np.radians(80.0)
    # It lags behind a target farther round, on the same way, and comes back to straight ahead behind.
    assert (turned <= angles + 1e-6).all()
    assert np.abs(quat.dot(quat.cross(forward, ways[1]), looked)).max() < 1e-6
    assert turned[-1] < 1e-4
    assert (np.diff(turned)[angles[1:] <= np.radians(90.0)] > 0.0).all()
    assert np.degrees(np.abs(np.diff(turned)).max()) < 0.6


def test_a_gaze_changes_little_when_its_target_changes_little() -> None:
    rng = _rng(5)
    targets = 3.0 * quat.unit(rng.normal(size=(5000, 3)))
    targets[0] = -3.0 * FORWARD
    nudged = targets + 1e-5 * rng.normal(size=targets.shape)
    assert np.abs(_look(FORWARD, nudged) - _look(FORWARD, targets)).max() < 1e-4


def test_a_target_inside_the_head_is_not_looked_at() -> None:
    along = np.linspace(-2e-3, 2e-3, 4001)[:, None]
    looked = _look(FORWARD, along * LEFT)
    assert np.allclose(looked[2000], FORWARD)
    assert _steps(looked) < 5e-3


def test_a_head_nods_while_it_looks() -> None:
    bodies = bodies_of([Body("hips", (0, 0, 1)), Body("head", (0, 0, 2), (), "hips")])
    found = movement.frames(bodies, np.array([1]), [LOOK], np.zeros(1, bool))
    found = found.toward(np.array([[[2.0, -3.0, 2.0]]]))
    nod = quat.from_rotation_vector(0.3 * LEFT)[None, None]
    _, still = movement.specialize(found, np.zeros((1, 1, 3)), quat.identity(1, 1))
    _, nodded = movement.specialize(found, np.zeros((1, 1, 3)), nod)
    assert np.allclose(nodded, quat.multiply(still, nod))


def test_of_heads_that_face_apart_the_one_that_can_see_a_target_follows_it() -> None:
    target = np.array([[1.0, 2.0, 0.0]])
    forwards = [FORWARD, -FORWARD]
    looked = [_look(forward, target)[0] for forward in forwards]
    off = [float(np.degrees(np.arccos(way @ quat.unit(target[0])))) for way in looked]
    assert off[1] < 1e-4
    assert np.degrees(np.arccos(looked[0] @ forwards[0])) < 80.0
    assert off[0] > 50.0


def test_gazes_straight_ahead_and_behind_do_not_turn() -> None:
    for way in (FORWARD, -FORWARD):
        away = way + 1e-9 * LEFT
        assert quat.angle_between(aim.toward(FORWARD, away[None], 1e-3), quat.IDENTITY).max() < 1e-8


# --- batches ---


def test_a_batch_is_its_frames_one_by_one() -> None:
    rng = _rng(6)
    bodies = random_bodies(rng)
    targets = _places(bodies, rng, 4, 2 * len(MODES))
    modes, chosen = [*MODES, *MODES], rng.integers(len(bodies), size=2 * len(MODES))
    mirrored = np.arange(len(modes)) >= len(MODES)
    frames = movement.frames(bodies, chosen, modes, mirrored)
    q, turns = rng.normal(size=(4, len(modes), 3)), _turns(rng, 4, len(modes))
    batch = movement.specialize(frames.toward(targets), q, turns)
    for i in range(4):
        one = slice(i, i + 1)
        alone = movement.specialize(frames.toward(targets[one]), q[one], turns[one])
        assert np.abs(alone[0] - batch[0][one]).max() < 1e-12 * bodies.size
        assert quat.angle_between(alone[1], batch[1][one]).max() < 1e-12
    for body in range(0, len(modes), 50):
        one = slice(body, body + 1)
        single = movement.frames(bodies, chosen[one], modes[one], mirrored[one]).toward(targets[:, one])
        alone = movement.specialize(single, q[:, one], turns[:, one])
        assert np.abs(alone[0] - batch[0][:, one]).max() < 1e-12 * bodies.size


def test_still_values_follow_a_moving_target() -> None:
    """One frame of values and many of targets, or the other way round, broadcast."""
    bodies, targets = _walker(), _rng(7).normal(size=(6, 1, 3))
    mode = replace(SECONDARY, look_at=True)
    frames = movement.frames(bodies, np.array([2]), [mode], np.zeros(1, bool))
    for count, values in ((6, 1), (1, 6), (6, 6)):
        found = frames.toward(targets[:count])
        places, turned = movement.specialize(found, np.ones((values, 1, 3)), quat.identity(values, 1))
        assert places.shape == (6, 1, 3)
        assert turned.shape == (6, 1, 4)
