"""Obstacles on the ground, as a body sees them whose middle keeps clear of them by its radius.

Each becomes a convex polygon that holds all places nearer to it than that: the hull of its corners, each with a regular
polygon about it. Corners are counter-clockwise.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...arrays import Array, Flags

CORNERS = 12
"""Of the polygon that stands for the disc about a corner."""
SPARE = 1.003
"""By how much larger than a body's own radius it is taken for, so that a way made of straight pieces keeps clear."""
EDGE = 1e-7
"""What is not deeper than this in a polygon is on its edge [m]."""


def disc(middle: Array, radius: float, corners: int = 16) -> Array:
    """Return a round obstacle, which lies within the polygon, shape (corner, 2)."""
    angles = 2.0 * np.pi * np.arange(corners) / corners
    return middle + radius / np.cos(np.pi / corners) * np.column_stack([np.cos(angles), np.sin(angles)])


@dataclass(frozen=True, eq=False)
class Obstacle:
    """A convex piece of the ground that the middle of a body keeps out of."""

    corners: Array
    """[m], counter-clockwise, shape (corner, 2)."""

    @classmethod
    def of(cls, covered: Array, radius: float) -> "Obstacle":
        """Return what a body of some radius [m] keeps out of, for what covers some corners' hull, shape (n, 2)."""
        around = disc(np.zeros(2), max(SPARE * radius, 1e-6), CORNERS)
        return cls(hull((covered[:, None] + around).reshape(-1, 2)))

    @cached_property
    def normals(self) -> Array:
        """Of its edges, outward, unit vectors, shape (corner, 2)."""
        along = np.roll(self.corners, -1, axis=0) - self.corners
        out = np.column_stack([along[:, 1], -along[:, 0]])
        return out / np.maximum(np.hypot(out[:, 0], out[:, 1]), 1e-12)[:, None]

    @cached_property
    def distances(self) -> Array:
        """Of its edges' lines from the origin along their normals [m], shape (corner,)."""
        return (self.normals * self.corners).sum(axis=1)

    def holds(self, points: Array) -> Flags:
        """Return which points are inside, shape (n, 2) to (n,)."""
        inside: Flags = points @ self.normals.T < self.distances - EDGE
        return np.asarray(inside.all(axis=1))

    def crossed(self, starts: Array, ends: Array) -> Flags:
        """Return which straight ways lead through it, shapes (n, 2) to (n,)."""
        first = starts @ self.normals.T - (self.distances - EDGE)
        slope = (ends - starts) @ self.normals.T
        still = np.abs(slope) < 1e-12
        at = -first / np.where(still, 1.0, slope)
        enters = np.where(still, np.where(first < 0.0, -np.inf, np.inf), np.where(slope < 0.0, at, -np.inf))
        leaves = np.where(still, np.inf, np.where(slope > 0.0, at, np.inf))
        return np.minimum(leaves.min(axis=1), 1.0) > np.maximum(enters.max(axis=1), 0.0)

    def edge_points(self, place: Array) -> Array:
        """Return the points of its edges that are nearest to a place, shape (2,) to (corner, 2)."""
        along = np.roll(self.corners, -1, axis=0) - self.corners
        share = ((place - self.corners) * along).sum(axis=1) / np.maximum((along**2).sum(axis=1), 1e-24)
        return self.corners + np.clip(share, 0.0, 1.0)[:, None] * along


def hull(points: Array) -> Array:
    """Return the corners of the convex hull of points, counter-clockwise, shape (n, 2) to (corner, 2)."""
    order = points[np.lexsort((points[:, 1], points[:, 0]))]
    halves: list[list[Array]] = []
    for run in (order, order[::-1]):
        half: list[Array] = []
        for point in run:
            while len(half) > 1 and _turn(half[-2], half[-1], point) <= 0.0:
                half.pop()
            half.append(point)
        halves.append(half)
    return np.array([*halves[0][:-1], *halves[1][:-1]])


def _turn(a: Array, b: Array, c: Array) -> float:
    return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))


def outside(obstacles: Sequence[Obstacle], points: Array) -> Flags:
    """Return which points are in none of the obstacles, shape (n, 2) to (n,)."""
    out = np.ones(len(points), dtype=np.bool_)
    for obstacle in obstacles:
        out &= ~obstacle.holds(points)
    return out


def nearest_free(obstacles: Sequence[Obstacle], place: Array) -> Array:
    """Return the place that is nearest to another one and in no obstacle, shape (2,)."""
    if outside(obstacles, place[None])[0]:
        return place
    found = [obstacle.edge_points(place) for obstacle in obstacles] + [obstacle.corners for obstacle in obstacles]
    found += [_meetings(a, b) for i, a in enumerate(obstacles) for b in obstacles[:i]]
    points = np.concatenate(found)
    free = points[outside(obstacles, points)]
    return free[int(np.argmin(((free - place) ** 2).sum(axis=1)))]


def _meetings(a: Obstacle, b: Obstacle) -> Array:
    """Return where edges of two obstacles meet, shape (n, 2)."""
    normals = np.stack(np.broadcast_arrays(a.normals[:, None], b.normals[None]), axis=2).reshape(-1, 2, 2)
    sides = np.stack(np.broadcast_arrays(a.distances[:, None], b.distances[None]), axis=2).reshape(-1, 2)
    area = normals[:, 0, 0] * normals[:, 1, 1] - normals[:, 0, 1] * normals[:, 1, 0]
    own = np.abs(area) > 1e-9
    normals, sides, area = normals[own], sides[own], area[own]
    x = (sides[:, 0] * normals[:, 1, 1] - sides[:, 1] * normals[:, 0, 1]) / area
    y = (sides[:, 1] * normals[:, 0, 0] - sides[:, 0] * normals[:, 1, 0]) / area
    return np.column_stack([x, y])
