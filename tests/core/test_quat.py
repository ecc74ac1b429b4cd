"""The algebra of rotations: group laws, maps to and from other forms, and the awkward angles."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from morph_retarget.core import quat

_numbers = st.floats(-1.0, 1.0, allow_subnormal=False)
_vectors = arrays(np.float64, 3, elements=_numbers)


@st.composite
def _rotations(draw: st.DrawFn) -> np.ndarray:
    return quat.from_rotation_vector(np.pi * draw(_vectors))


def _close(a: np.ndarray, b: np.ndarray, tolerance: float = 1e-9) -> bool:
    return bool(np.abs(a - b).max() < tolerance)


@given(_rotations(), _rotations(), _rotations())
def test_multiplication_is_associative(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> None:
    assert _close(quat.multiply(quat.multiply(a, b), c), quat.multiply(a, quat.multiply(b, c)))


@given(_rotations())
def test_the_conjugate_is_the_inverse(q: np.ndarray) -> None:
    assert _close(quat.multiply(q, quat.conjugate(q)), quat.IDENTITY)


@given(_rotations(), _rotations(), _vectors)
def test_a_product_turns_like_its_factors_one_after_the_other(a: np.ndarray, b: np.ndarray, v: np.ndarray) -> None:
    assert _close(quat.rotate(quat.multiply(a, b), v), quat.rotate(a, quat.rotate(b, v)))


@given(_rotations(), _vectors)
def test_rotating_is_multiplying_by_the_matrix(q: np.ndarray, v: np.ndarray) -> None:
    assert _close(quat.rotate(q, v), quat.to_matrix(q) @ v)


@given(_rotations())
def test_matrix_round_trip(q: np.ndarray) -> None:
    assert quat.angle_between(quat.from_matrix(quat.to_matrix(q)), q) < 1e-9


@given(arrays(np.float64, 3, elements=st.floats(-1.7, 1.7, allow_subnormal=False)))
def test_rotation_vector_round_trip(r: np.ndarray) -> None:
    assert _close(quat.to_rotation_vector(quat.from_rotation_vector(r)), r)


@pytest.mark.parametrize("angle", [0.0, 1e-12, 1e-7, 1e-5, np.pi - 1e-9, np.pi])
def test_rotation_vectors_are_exact_at_awkward_angles(angle: float) -> None:
    axis = np.array([2.0, -1.0, 2.0]) / 3.0
    q = quat.from_rotation_vector(angle * axis)
    assert abs(np.linalg.norm(q) - 1.0) < 1e-12
    assert abs(np.linalg.norm(quat.to_rotation_vector(q)) - angle) < 1e-9
    assert abs(quat.angle_between(q, quat.IDENTITY) - angle) < 1e-9


@given(_vectors, _vectors)
def test_between_turns_one_direction_onto_the_other_the_shortest_way(a: np.ndarray, b: np.ndarray) -> None:
    a, b = quat.unit(a), quat.unit(b)
    if not a.any() or not b.any():
        assert _close(quat.between(a, b), quat.IDENTITY)
        return
    q = quat.between(a, b)
    assert _close(quat.rotate(q, a), b, 1e-6)
    assert abs(quat.angle_between(q, quat.IDENTITY) - np.arccos(np.clip(a @ b, -1.0, 1.0))) < 1e-6


@pytest.mark.parametrize("axis", np.eye(3))
def test_between_opposite_directions_is_half_a_turn(axis: np.ndarray) -> None:
    q = quat.between(axis, -axis)
    assert _close(quat.rotate(q, axis), -axis)
    assert abs(quat.angle_between(q, quat.IDENTITY) - np.pi) < 1e-9


@given(_rotations(), _rotations(), st.floats(0.0, 1.0))
def test_slerp_shares_the_angle(a: np.ndarray, b: np.ndarray, t: float) -> None:
    whole = quat.angle_between(a, b)
    part = quat.slerp(a, b, t)
    assert abs(quat.angle_between(a, part) - t * whole) < 1e-6
    assert abs(quat.angle_between(part, b) - (1.0 - t) * whole) < 1e-6


@pytest.mark.parametrize("angle", [0.0, 1e-12, 1e-8, 1e-7, 1e-5, 0.3, 3.0, np.pi - 1e-9])
def test_slerp_is_the_exponential_of_a_share_at_any_angle_and_in_any_batch(angle: float) -> None:
    rng = np.random.default_rng(4)
    a = quat.normalize(rng.normal(size=(300, 70, 4)))
    way = angle * quat.unit(rng.normal(size=(300, 70, 3)))
    b = quat.multiply(a, quat.from_rotation_vector(way)) * rng.choice([-1.0, 1.0], size=(300, 70, 1))
    share = rng.uniform(size=(300, 1))
    out = quat.slerp(a, b, share)
    assert np.abs(out - quat.multiply(a, quat.from_rotation_vector(share[..., None] * way))).max() < 1e-8
    assert np.abs(np.linalg.norm(out, axis=-1) - 1.0).max() < 1e-12
    assert np.array_equal(out[7:9], quat.slerp(a[7:9], b[7:9], share[7:9]))
    assert _close(quat.slerp(a[:1], b, 0.25), quat.slerp(np.broadcast_to(a[:1], a.shape), b, 0.25), 1e-15)


@given(_rotations(), _vectors)
def test_twist_leaves_a_swing_square_to_the_axis(q: np.ndarray, axis: np.ndarray) -> None:
    axis = quat.unit(axis)
    if not axis.any():
        return
    swing = quat.multiply(q, quat.conjugate(quat.twist_about(q, axis)))
    if abs(quat.angle_between(q, quat.twist_about(q, axis)) - np.pi) > 1e-3:
        assert abs(swing[1:] @ axis) < 1e-9


def test_continuous_quaternions_never_jump_to_the_antipode() -> None:
    rng = np.random.default_rng(1)
    smooth = quat.from_rotation_vector(np.cumsum(0.1 * rng.normal(size=(200, 5, 3)), axis=0))
    flipped = smooth * rng.choice([-1.0, 1.0], size=(200, 5, 1))
    out = quat.continuous(flipped)
    assert (np.sum(out[1:] * out[:-1], axis=-1) > 0.0).all()
    assert quat.angle_between(out, smooth).max() < 1e-9


def test_cross_is_the_cross_product() -> None:
    a, b = np.random.default_rng(2).normal(size=(2, 7, 3))
    assert _close(quat.cross(a, b), np.cross(a, b))


def test_directions_are_the_same_to_the_bit_wherever_vectors_lie_in_memory() -> None:
    rng = np.random.default_rng(3)
    for _ in range(3000):
        vectors = rng.normal(size=(int(rng.integers(2, 40)), 3))
        expected = np.arctan2(vectors[:, 2].copy(), vectors[:, 0].copy())
        end = vectors.ctypes.data + vectors.nbytes
        behind = [np.empty(len(vectors)) for _ in range(20)]
        behind.sort(key=lambda block: not 0 <= block.ctypes.data - end <= 16)
        behind[0] = vectors  # the next result takes the place of what is let go: next to the vectors, now and then
        assert (quat.direction(vectors[:, 2], vectors[:, 0]) == expected).all()


def test_zero_vectors_and_zero_quaternions_stay_harmless() -> None:
    assert _close(quat.unit(np.zeros(3)), np.zeros(3))
    assert _close(quat.normalize(np.zeros(4)), quat.IDENTITY)
    assert _close(quat.from_rotation_vector(np.zeros(3)), quat.IDENTITY)
