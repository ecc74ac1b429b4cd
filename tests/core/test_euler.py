"""Euler angles in all six orders."""

import numpy as np
import pytest

from morph_retarget.core import euler, quat

_AXES = {"X": [1.0, 0.0, 0.0], "Y": [0.0, 1.0, 0.0], "Z": [0.0, 0.0, 1.0]}


@pytest.mark.parametrize("order", euler.ORDERS)
def test_an_order_names_the_axes_in_which_turns_follow_each_other(order: str) -> None:
    angles = np.random.default_rng(3).uniform(-3.0, 3.0, size=(20, 3))
    expected = quat.identity(20)
    for letter in order:
        turn = quat.from_axis_angle(np.array(_AXES[letter]), angles[:, "XYZ".index(letter)])
        expected = quat.multiply(turn, expected)
    assert quat.angle_between(euler.to_quaternions(angles, order), expected).max() < 1e-9


@pytest.mark.parametrize("order", euler.ORDERS)
def test_angles_of_a_rotation_make_that_rotation(order: str) -> None:
    rng = np.random.default_rng(4)
    rotations = quat.normalize(rng.normal(size=(50, 3, 4)))
    angles = euler.from_quaternions(rotations, order)
    assert quat.angle_between(euler.to_quaternions(angles, order), rotations).max() < 1e-7


@pytest.mark.parametrize("order", euler.ORDERS)
def test_curves_run_on_through_full_turns_and_past_the_pole(order: str) -> None:
    middle = "XYZ".index(order[1])
    angles = np.zeros((400, 3))
    angles[:, middle] = np.linspace(0.0, 6.0 * np.pi, 400)
    angles[:, middle - 1] = 0.3
    found = euler.from_quaternions(euler.to_quaternions(angles, order), order)
    assert np.abs(np.diff(found, axis=0)).max() < 0.2


@pytest.mark.parametrize("order", euler.ORDERS)
@pytest.mark.parametrize("pole", [np.pi / 2, -np.pi / 2])
def test_the_pole_is_no_exception(order: str, pole: float) -> None:
    angles = np.array([[0.3, -0.7, 1.1]])
    angles[0, "XYZ".index(order[1])] = pole
    rotation = euler.to_quaternions(angles, order)
    assert quat.angle_between(euler.to_quaternions(euler.from_quaternions(rotation, order), order), rotation) < 1e-6
