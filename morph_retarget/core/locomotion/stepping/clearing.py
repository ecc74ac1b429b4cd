"""How feet clear what stands between their plants: edges of steps, stones, the top of a ridge."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from ... import quat
from ...arrays import Array
from ...ground import Ground
from ..foot_path import FootPath
from ..moving import eased
from .sizes import Sizes

CLEARANCE = 0.04
"""Height over what lies between two plants that a foot keeps at least [leg lengths]."""
FLAT = 0.005
"""What stands over their way by less than this needs no clearance [leg lengths]."""
PROBES: Array = np.linspace(0.04, 0.96, 16)
"""Times of a flight at which the ground under the foot is looked at."""
HIGHEST = 0.6
"""Feet are never lifted higher than this over what lies between their plants [leg lengths]."""
LEAST_ARC = 0.25
"""A foot is not lifted for what stands so near to its plants that its arc is lower than this share of its height."""
STEEP = 0.08
"""A foot goes up before it goes forward for what stands this high over the straight way [leg lengths]."""


@dataclass(frozen=True, eq=False)
class Clearance:
    """What flying feet do beyond their usual arcs, after each stance; shapes (leg, cycle)."""

    lift: Array
    """Least height of the flight over the straight way [m]."""
    early: Array
    """How much a foot goes up before it goes forward, 0 … 1."""
    late: Array
    """How much it has come forward before it goes down, 0 … 1."""

    @classmethod
    def none(cls, shape: tuple[int, ...]) -> Self:
        """Return that of level ground."""
        return cls(np.zeros(shape), np.zeros(shape), np.zeros(shape))


def find(ground: Ground, places: Array, turns: Array, sizes: Sizes, path: FootPath) -> Clearance:
    """Return how feet clear the ground.

    Args:
        ground: What they go over.
        places: Of the feet's joints as they stand [m], shape (leg, cycle, 3).
        turns: Of the feet, shape (leg, cycle, 4).
        sizes: Of the feet.
        path: Of their flight.
    """
    length, out = sizes.lengths[:, None], Clearance.none(places.shape[:2])
    early, late, lift = out.early, out.late, out.lift
    ways = list[tuple[Array, Array]]()
    for offset in (sizes.tips, sizes.heels):
        here = places + quat.rotate(turns, np.broadcast_to(offset[:, None], places.shape))
        step = np.concatenate([here[:, 1:], here[:, -1:]], axis=1) - here
        straight = here[:, :, None] + PROBES[:, None] * step[:, :, None]
        over = eased((_heights(ground, straight) - straight[..., 2]) / (STEEP * length[..., None]))
        early = np.maximum(early, over[..., : len(PROBES) // 2].max(axis=-1))
        late = np.maximum(late, over[..., len(PROBES) // 2 :].max(axis=-1))
        ways.append((here, step))
    flight = np.broadcast_to(PROBES, (*lift.shape, len(PROBES)))
    way = path.over(flight, early[..., None], late[..., None])
    for here, step in ways:
        rise = step[..., None, 2]
        points = here[:, :, None] + way[..., :1] * step[:, :, None]
        points[..., 2] = here[..., None, 2] + np.where(rise > 0.0, way[..., 4], way[..., 5]) * rise
        over = _heights(ground, points) - points[..., 2]
        over = np.where(over > FLAT * length[..., None], over + CLEARANCE * length[..., None], -np.inf)
        lift = np.maximum(lift, (over / np.maximum(way[..., 1], LEAST_ARC)).max(axis=-1))
    return Clearance(np.clip(lift, 0.0, HIGHEST * length), early, late)


def _heights(ground: Ground, points: Array) -> Array:
    """Return the height of the ground under points [m], below all where there is none, shape (..., 3) to (...)."""
    found = ground(points.reshape(-1, 3)).reshape(points.shape[:-1])
    return np.where(np.isfinite(found), found, -np.inf)
