"""The three kinds of arrays that the core works with."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
"""Positions, rotations and other numbers."""
Indices = NDArray[np.intp]
"""Places in a list of bones, links or frames."""
Flags = NDArray[np.bool_]
"""Yes or no for each frame, bone or foot."""
