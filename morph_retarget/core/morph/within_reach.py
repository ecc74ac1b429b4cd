"""A place that a character can reach: where things are put for it to take, look at or strike."""

import numpy as np

from ..arrays import Array
from ..character.morphology import Capability
from .bodies import Bodies


def within_reach(bodies: Bodies) -> Array:
    """Return a place that the shortest grasper can reach: before the chest, or a little above and before a mouth.

    Args:
        bodies: Of the character.

    Returns:
        Place [m], character frame, shape (3,).
    """
    kinds = (Capability.GRASPER, Capability.MOUTH, Capability.HEAD, Capability.ROOT)
    found = next(own for kind in kinds if (own := bodies.with_capability(kind)))
    own = min(found, key=lambda body: bodies.limb_lengths[body])
    length, side = bodies.limb_lengths[own], bodies.sides[own]
    if side == 0 or bodies.has(own, Capability.MOUTH):
        return bodies.positions[own] + length * np.array([0.15, -0.25, 0.1])
    return bodies.positions[bodies.spine_segments[own]] + length * np.array([0.2, -0.5, 0.1])
