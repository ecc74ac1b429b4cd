"""Whether feet that stand stay where they are.

Who knows when feet shall stand says so (a gait, a clip's contacts). Else a foot stands while its goal does, and one
without a goal while it is slow and low. A foot that rolls from heel to toe slides no more than the one of both does
that slides less.
"""

import numpy as np

from .. import quat
from ..arrays import Array, Flags
from ..contacts import ContactSettings, find_plants, floor_height, speeds
from .goals import COUNTS
from .performance import Performance
from .verdict import Found

STILL = 1e-3
"""A goal that is slower than this stands [leg lengths a second]."""
LOW = 0.07
"""A foot without a goal stands only below this height over where it usually stands [leg lengths]."""


def slid(performance: Performance) -> Found:
    """Return the largest speed along the ground of a foot that stands [leg lengths a second]."""
    legs = performance.legs
    if not legs or len(performance) < 2:
        return Found(0.0)
    lengths = np.array([leg.length for leg in legs])
    ways = quat.length(np.diff(performance.soles[..., :2], axis=0)).min(axis=-1)
    standing = _standing(performance)
    both = standing[1:] & standing[:-1]
    speed = np.where(both, ways / (lengths * performance.seconds_per_frame), 0.0)
    return Found.worst(speed, [performance.names[leg.foot] for leg in legs])


def _standing(performance: Performance) -> Flags:
    """Return when feet stand, shape (frame, leg)."""
    if performance.standing is not None:
        return performance.standing
    aims = {aim.body: aim for aim in performance.aims}
    out = np.zeros((len(performance), len(performance.legs)), dtype=bool)
    for i, leg in enumerate(performance.legs):
        aim = aims.get(leg.foot)
        if aim is None:
            out[:, i] = _slow_and_low(performance, i)
        else:
            moved = quat.length(np.diff(aim.places, axis=0)) < STILL * leg.length * performance.seconds_per_frame
            counts = aim.influence >= COUNTS
            still = np.zeros(len(counts), dtype=bool)
            still[1:] |= moved
            still[:-1] |= moved
            out[:, i] = still & counts
    return out


def _slow_and_low(performance: Performance, leg: int) -> Flags:
    own, settings = performance.legs[leg], ContactSettings()
    points: Array = performance.places[:, [own.foot]]
    slow = find_plants(points, performance.seconds_per_frame, own.length, settings)[:, 0]
    height = points[..., 2] / own.length
    speed = speeds(points, performance.seconds_per_frame) / own.length
    low = height[:, 0] < floor_height(height, speed, settings)[0] + LOW
    standing = slow & low
    # The frames in which it lands and leaves are no slide.
    inner = standing.copy()
    inner[1:] &= standing[:-1]
    inner[:-1] &= standing[1:]
    return inner
