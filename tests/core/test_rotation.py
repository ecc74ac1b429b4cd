"""Rotations as matrices: the same as quaternions, and rotations still after many steps."""

import numpy as np
import pytest

from morph_retarget.core import quat, rotation
from morph_retarget.core.arrays import Array
from morph_retarget.core.solve import spine_lines

COUNT = 200


def _units(seed: int, *shape: int) -> Array:
    return quat.unit(np.random.default_rng(seed).normal(size=(*shape, 3)))


def test_about_an_axis_matrices_and_quaternions_turn_alike() -> None:
    axes, angles = _units(0, COUNT), np.random.default_rng(1).uniform(-7.0, 7.0, COUNT)
    angles[:3] = 0.0, np.pi, -np.pi
    expected = quat.to_matrix(quat.from_axis_angle(axes, angles))
    np.testing.assert_allclose(rotation.about(axes, angles), expected, atol=1e-14)
    np.testing.assert_array_equal(rotation.about(axes[:1], angles[:1])[0], np.eye(3))


def test_what_a_rotation_turns_about_is_twice_the_sine_long() -> None:
    axes, angles = _units(2, COUNT), np.random.default_rng(3).uniform(-np.pi, np.pi, COUNT)
    found = rotation.axes_of(rotation.about(axes, angles))
    np.testing.assert_allclose(found, 2.0 * np.sin(angles)[:, None] * axes, atol=1e-14)


def test_cross_products_are_those_of_numpy() -> None:
    a, b = _units(4, COUNT, 1), _units(5, 4)
    np.testing.assert_allclose(rotation.cross(a, b), np.cross(a, b), atol=1e-15)


@pytest.mark.parametrize("near", [0.0, 1e-13, 1e-5, 0.1])
def test_the_smallest_rotation_leads_from_one_direction_to_the_other(near: float) -> None:
    """However near to each other these are, or to opposite each other."""
    a = _units(6, COUNT)
    for b in (_units(7, COUNT), quat.unit(a + near * _units(8, COUNT)), quat.unit(near * _units(9, COUNT) - a)):
        found = rotation.between(a, b)
        identity = np.broadcast_to(np.eye(3), found.shape)
        np.testing.assert_allclose(found @ rotation.transposed(found), identity, atol=1e-14)
        np.testing.assert_allclose(rotation.apply(found, a), b, atol=2e-6)
        turned = np.arccos(np.clip(0.5 * (np.trace(found, axis1=-2, axis2=-1) - 1.0), -1.0, 1.0))
        np.testing.assert_allclose(turned, np.arccos(np.clip(quat.dot(a, b), -1.0, 1.0)), atol=2e-6)


def test_a_frame_that_is_carried_along_a_long_line_stays_a_rotation() -> None:
    """No error of one step may grow in the next ones."""
    rest = quat.unit(np.array([0.0, 0.0, 1.0]) + 0.1 * _units(10, 1, COUNT))
    posed = quat.unit(np.array([0.0, 0.0, 1.0]) + 0.3 * _units(11, 3, COUNT))
    found = spine_lines.carried(rest, posed)
    identity = np.broadcast_to(np.eye(3), found.shape)
    np.testing.assert_allclose(found @ rotation.transposed(found), identity, atol=1e-12)
    np.testing.assert_allclose(rotation.apply(found, rest), posed, atol=1e-12)
