"""Which way limbs swivel: for the same angle, knees and elbows of both sides go outward."""

import numpy as np

from .. import quat
from ..arrays import Array, Indices

OUTWARD = np.array([1.0, -0.25, 0.5])
"""Where a limb on the left swivels, character frame: to its side; one that cannot, as it leads there, up or forward."""
FAINT = 1e-3
"""Share of a limb's length below which a bend does not tell where it is bent to."""


def outward(bones: Array, lines: Array, hints: Array, sides: Indices) -> Array:
    """Return +1 for limbs whose joints go outward as they turn to the left about their lines, else -1, shape (limb,).

    Args:
        bones: Bones of limbs that are bent [m], shape (limb, joint, 3).
        lines: From their starts to their ends, unit vectors, shape (limb, 3).
        hints: Where their joints are taken to be if they do not bend, unit vectors or 0, shape (limb, 3).
        sides: +1 left, -1 right, 0 in the middle, shape (limb,).
    """
    joints = np.cumsum(bones[:, :-1], axis=1).sum(axis=1)
    aside = joints - quat.dot(joints, lines)[:, None] * lines
    faint = quat.length(aside) < FAINT * quat.length(bones).sum(axis=-1)
    ways = quat.cross(lines, np.where(faint[:, None], hints, aside))
    wanted = np.where((sides < 0)[:, None], [-1.0, 1.0, 1.0], 1.0) * OUTWARD
    return np.where(quat.dot(ways, wanted) < 0.0, -1.0, 1.0)
