"""Placements of armatures in the world, and the character frame."""

import numpy as np
import pytest

from morph_retarget.core import quat
from morph_retarget.core.character.frame import CharacterFrame, Placement, axis
from morph_retarget.core.errors import RigError

_TURN = quat.to_matrix(quat.from_rotation_vector(np.array([0.4, -1.1, 0.7])))
_MIRROR = np.diag([-1.0, 1.0, 1.0])


@pytest.mark.parametrize("linear", [0.01 * _TURN, 100.0 * _TURN, 2.0 * _TURN @ _MIRROR])
def test_a_placement_is_the_matrix_that_it_came_from(linear: np.ndarray) -> None:
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = linear, [1.0, 2.0, 3.0]
    placement, uneven = Placement.from_matrix(matrix)
    points = np.random.default_rng(7).normal(size=(5, 3))
    assert np.abs(placement.points(points) - (points @ linear.T + matrix[:3, 3])).max() < 1e-9 * np.abs(linear).max()
    assert np.abs(placement.inverse().points(placement.points(points)) - points).max() < 1e-9
    assert uneven < 1e-9


def test_rotations_follow_points_through_a_mirror() -> None:
    placement = Placement(_TURN @ _MIRROR, 3.0, np.array([1.0, 0.0, 0.0]))
    turn, point = quat.from_rotation_vector(np.array([0.3, 0.5, -0.2])), np.array([0.2, 0.7, -0.4])
    assert placement.mirrored
    assert np.allclose(
        placement.directions(quat.rotate(turn, point)), quat.rotate(placement.turns(turn), placement.directions(point))
    )


def test_then_is_one_after_the_other() -> None:
    a, b = Placement(_TURN, 2.0, np.ones(3)), Placement(_TURN.T, 0.5, np.array([0.0, 1.0, 0.0]))
    point = np.array([0.3, 0.2, 0.1])
    assert np.allclose(a.then(b).points(point), b.points(a.points(point)))


def test_uneven_scale_is_told_and_zero_scale_refused() -> None:
    assert Placement.from_matrix(np.diag([1.0, 1.0, 1.5, 1.0]))[1] == pytest.approx(0.5)
    with pytest.raises(RigError, match="scaled to zero: give it a scale"):
        Placement.from_matrix(np.diag([1.0, 0.0, 1.0, 1.0]))


@pytest.mark.parametrize("value", [np.nan, np.inf])
@pytest.mark.parametrize("entry", [(0, 1), (2, 3)])
def test_an_object_is_placed_by_numbers(value: float, entry: tuple[int, int]) -> None:
    matrix = np.eye(4)
    matrix[entry] = value
    with pytest.raises(RigError, match="no numbers: clear its transform"):
        Placement.from_matrix(matrix)


def test_the_character_frame_has_left_on_x_and_front_on_minus_y() -> None:
    frame = CharacterFrame(np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0]), np.array([5.0, 0.0, 0.0]), 1.8)
    to_character = frame.world_to_character
    assert np.allclose(to_character.directions(frame.left), [1.0, 0.0, 0.0])
    assert np.allclose(to_character.directions(frame.forward), [0.0, -1.0, 0.0])
    assert np.allclose(to_character.points(np.array([5.0, 1.0, 0.0])), [0.0, 0.0, 1.0])


def test_axes_are_named() -> None:
    assert np.allclose(axis("-Y"), [0.0, -1.0, 0.0])
    assert np.allclose(axis("z"), [0.0, 0.0, 1.0])
    with pytest.raises(RigError, match=r"unknown axis 'up': choose one of \+X"):
        axis("up")
