"""Smoothing windows."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from morph_retarget.core import smoothing

_curves = arrays(np.float64, st.integers(2, 60), elements=st.floats(-10.0, 10.0))


@given(_curves, st.integers(1, 20))
def test_an_upper_envelope_is_nowhere_below(curve: np.ndarray, width: int) -> None:
    assert (smoothing.upper_envelope(curve, width) >= curve).all()


@given(_curves, st.integers(1, 20))
def test_an_average_stays_within_the_curve(curve: np.ndarray, width: int) -> None:
    smooth = smoothing.moving_average(curve, width)
    assert smooth.shape == curve.shape
    assert smooth.min() >= curve.min() - 1e-9
    assert smooth.max() <= curve.max() + 1e-9


@given(_curves, st.integers(1, 20))
def test_ends_are_exact_where_they_must_be(curve: np.ndarray, width: int) -> None:
    slow = smoothing.between_ends(curve[:, None], width)[:, 0]
    assert abs(slow[0] - curve[0]) < 1e-9
    assert abs(slow[-1] - curve[-1]) < 1e-9


def test_a_straight_line_is_left_alone() -> None:
    line = np.linspace(1.0, 5.0, 30)
    assert np.abs(smoothing.between_ends(line[:, None], 8)[:, 0] - line).max() < 1e-12
