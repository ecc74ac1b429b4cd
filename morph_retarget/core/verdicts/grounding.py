"""Whether a character stays above the ground."""

import numpy as np

from ..arrays import Array
from ..ground import OFF_GROUND, heights_on
from .performance import Performance
from .verdict import Found


def sunk(performance: Performance) -> Found:
    """Return how deep a joint, or the sole of a foot, gets below the ground [shares of the character's size].

    A character whose feet rest a little below the ground stands on its lowest point.
    """
    own = performance.flesh
    points = np.concatenate([performance.places[:, own], performance.soles.reshape(len(performance), -1, 3)], axis=1)
    soles = [rest for leg in performance.legs for rest in (leg.home + leg.heel, leg.home + leg.tip)]
    rests = np.concatenate([performance.rest[own], np.array(soles).reshape(-1, 3)])
    lowest = min(float(rests[:, 2].min()), 0.0)
    if lowest < -OFF_GROUND * performance.size:
        return Found(0.0)
    names = [performance.names[int(body)] for body in own] + _soles(performance)
    floor: Array = np.zeros(points.shape[:-1])
    if performance.ground is not None:
        floor = heights_on(performance.ground, points, -np.inf)
    depth = floor + lowest - points[..., 2]
    return Found.worst(np.maximum(depth, 0.0) / performance.size, names)


def _soles(performance: Performance) -> list[str]:
    return [f"{performance.names[leg.foot]} {end}" for leg in performance.legs for end in ("(heel)", "(tip)")]
