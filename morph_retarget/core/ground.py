"""The ground: how high it is under points."""

from collections.abc import Callable

from .arrays import Array

Ground = Callable[[Array], Array]
"""Height of the ground under points [m], shape (n, 3) to shape (n,), in the space of the points; NaN where there is none."""
