"""Steering: the shortest way over the ground around what stands there, and how fast a body goes along it.

The way leads over corners of the obstacles that can be seen from each other (a visibility graph), and is rounded there
as the body's own radius is.
"""

import heapq
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import cast

import numpy as np

from ...arrays import Array, Flags, Indices
from ...errors import MotionError
from ...locomotion.moving import eased
from ..character_model import RATE
from ..travel import Travel
from .obstacles import CORNERS, Obstacle, nearest_free, outside
from .timing import BELL

ROUND = 6
"""Points of a rounded corner."""
STEP = 0.04
"""Distance at which speeds along a way are found [m]."""
TURN = 2.2
"""Most that a body turns on its way [rad/s] …"""
ON_THE_SPOT = 3.0
"""… and where it stands."""
GAINS = 0.9
"""How long a body takes to come to its speed, and to stop [s]."""
SIGHT = 0.35
"""A body turns to where its way leads as long before and after it gets there [s]."""


@dataclass(frozen=True, eq=False)
class Way:
    """A way over the ground."""

    points: Array
    """[m], at least one, shape (n, 2)."""
    warnings: tuple[str, ...] = ()

    @cached_property
    def along(self) -> Array:
        """How far it is to each point [m], shape (n,)."""
        steps = np.diff(self.points, axis=0)
        return np.concatenate([[0.0], np.cumsum(np.hypot(steps[:, 0], steps[:, 1]))])

    @property
    def length(self) -> float:
        """[m]."""
        return float(self.along[-1])

    def at(self, distances: Array) -> Array:
        """Return points some way along it [m], held beyond its ends, shape (n,) to (n, 2)."""
        return np.column_stack([np.interp(distances, self.along, self.points[:, i]) for i in range(2)])


def path_around(start: Array, goal: Array, obstacles: Sequence[Array], radius: float) -> Way:
    """Return the shortest way from one place to another whose distance from all obstacles is a radius or more.

    A goal that is too near to an obstacle becomes the nearest place that is not; likewise a start is left that way.

    Args:
        start: [m], shape (2,).
        goal: [m], shape (2,).
        obstacles: What they cover of the ground: corners of their convex hulls [m], shapes (corner, 2).
        radius: Of the body [m].

    Raises:
        MotionError: There is no way; or a place is not finite.
    """
    if not all(np.isfinite(own).all() for own in (start, goal, *obstacles)):
        raise MotionError("a place to go from, to or around is no number: give places in metres")
    grown = [Obstacle.of(own, radius) for own in obstacles if len(own)]
    first, last = nearest_free(grown, start), nearest_free(grown, goal)
    warnings: list[str] = []
    if not np.array_equal(first, start):
        warnings.append("it stands in an obstacle, and leaves that the nearest way")
    if not np.array_equal(last, goal):
        warnings.append("the place to go to is in an obstacle: it stops beside that")
    nodes = _Nodes.of(first, last, grown)
    found = _shortest(nodes.places, nodes.seen(grown))
    if found is None:
        raise MotionError("there is no way to the place to go to: obstacles close it off, move or shrink one")
    points = _rounded(nodes.places[found], grown, radius)
    if not np.array_equal(first, start):
        points = np.vstack([start, points])
    keep = np.concatenate([[True], np.abs(np.diff(points, axis=0)).max(axis=1) > 1e-9])
    return Way(points[keep], tuple(warnings))


@dataclass(frozen=True, eq=False)
class _Nodes:
    """Places between which a way may lead: its start, its end, and corners of obstacles."""

    places: Array
    """[m], shape (node, 2)."""
    beside: Array
    """The corners before and after each one [m]; for start and end these themselves; shape (2, node, 2)."""

    @classmethod
    def of(cls, start: Array, end: Array, obstacles: Sequence[Obstacle]) -> "_Nodes":
        """Return those that are in none of the obstacles."""
        ends = np.vstack([start, end])
        corners = np.vstack([ends, *(own.corners for own in obstacles)])
        before = np.vstack([ends, *(np.roll(own.corners, 1, axis=0) for own in obstacles)])
        after = np.vstack([ends, *(np.roll(own.corners, -1, axis=0) for own in obstacles)])
        free = outside(obstacles, corners)
        free[:2] = True
        return cls(corners[free], np.stack([before[free], after[free]]))

    def seen(self, obstacles: Sequence[Obstacle]) -> Flags:
        """Return which nodes see each other, as far as a shortest way may lead from one to the other, (node, node)."""
        count = len(self.places)
        one, other = np.triu_indices(count, 1)
        free = self._touches(one, other) & self._touches(other, one)
        for obstacle in obstacles:
            left = np.flatnonzero(free)
            free[left[obstacle.crossed(self.places[one[left]], self.places[other[left]])]] = False
        out = np.zeros((count, count), dtype=np.bool_)
        out[one, other] = free
        return out | out.T

    def _touches(self, start: Indices, end: Indices) -> Flags:
        """Return whether ways touch the obstacles at whose corners they end, and lead into none: others are longer."""
        way, corner = self.places[end] - self.places[start], self.places[end]
        sides = [way[:, 0] * (own[end] - corner)[:, 1] - way[:, 1] * (own[end] - corner)[:, 0] for own in self.beside]
        return sides[0] * sides[1] >= -1e-12


def _shortest(nodes: Array, seen: Flags) -> list[int] | None:
    """Return the nodes of the shortest way from the first to the second, None when there is none (Dijkstra 1959)."""
    best, before = np.full(len(nodes), np.inf), np.full(len(nodes), -1)
    best[0], left = 0.0, [(0.0, 0)]
    while left:
        far, node = heapq.heappop(left)
        if node == 1:
            break
        if far > best[node]:
            continue
        steps = far + np.hypot(*(nodes - nodes[node]).T)
        for other in np.flatnonzero(seen[node] & (steps < best)).tolist():
            best[other], before[other] = steps[other], node
            heapq.heappush(left, (float(steps[other]), other))
    if not np.isfinite(best[1]):
        return None
    line = [1]
    while line[-1] != 0:
        line.append(int(before[line[-1]]))
    return line[::-1]


def _rounded(points: Array, obstacles: Sequence[Obstacle], radius: float) -> Array:
    """Return a way whose corners are round.

    The polygon about an obstacle's corner touches the disc that it stands for in the middle of its edges; a parabola
    from one of these to the next stays outside of it.
    """
    out, reach = [points[:1]], radius * np.tan(np.pi / CORNERS)
    share = np.linspace(0.0, 1.0, ROUND)[:, None]
    for before, corner, after in zip(points, points[1:], points[2:], strict=False):
        ends = np.array([before, after]) - corner
        sizes = np.hypot(ends[:, 0], ends[:, 1])
        tangents = corner + ends * (np.minimum(reach, 0.5 * sizes) / np.maximum(sizes, 1e-12))[:, None]
        bend = (1.0 - share) ** 2 * tangents[0] + 2.0 * share * (1.0 - share) * corner + share**2 * tangents[1]
        own = [obstacle for obstacle in obstacles if np.abs(obstacle.corners - corner).max(axis=1).min() < 1e-9]
        others = [obstacle for obstacle in obstacles if not any(obstacle is one for one in own)]
        out.append(bend if outside(others, bend).all() else corner[None])
    return np.vstack([*out, points[-1:]])


# --- how fast ---


def paced(way: Way, speed: float, heading: float = 0.0, facing: float | None = None) -> Travel:
    """Return where a body is as it goes along a way, a frame for each `RATE`th of a second from when it sets out.

    It turns to the way first where that leads to behind it, slows down where it winds, and stops at the end.

    Args:
        way: Over the ground.
        speed: As fast as it may [m/s].
        heading: Where it looks at first, to the left of -Y [rad].
        facing: Where it looks at last [rad]; None for where the way has led it.
    """
    if way.length < 1e-6:
        end = heading if facing is None else facing
        return _joined([_turning(way.points[0], heading, heading + _short(end - heading))])
    count = max(int(np.ceil(way.length / STEP)), 2) + 1
    distances = np.linspace(0.0, way.length, count)
    places = way.at(distances)
    widths = SIGHT * speed
    ahead = way.at(np.minimum(distances + widths, way.length)) - way.at(np.maximum(distances - widths, 0.0))
    ends = cast("Array", np.unwrap(np.arctan2(ahead[:, 0], -ahead[:, 1])))
    ends = ends + 2.0 * np.pi * round((heading - float(ends[0])) / (2.0 * np.pi))
    space = distances[1]
    rates = cast("Array", np.gradient(ends, space))
    most = np.minimum(speed, TURN / np.maximum(np.abs(rates), 1e-9))
    squares, gain = most**2, 2.0 * (speed / GAINS) * space
    squares[[0, -1]] = 0.0
    for i in range(1, count):
        squares[i] = min(squares[i], squares[i - 1] + gain)
        squares[-i - 1] = min(squares[-i - 1], squares[-i] + gain)
    speeds = np.sqrt(squares)
    times = np.concatenate([[0.0], np.cumsum(2.0 * space / (speeds[1:] + speeds[:-1]))])
    frames = np.arange(int(np.ceil(times[-1] * RATE)) + 1) / RATE
    going = Travel(
        np.column_stack([np.interp(frames, times, places[:, i]) for i in range(2)]), np.interp(frames, times, ends)
    )
    parts = [_turning(way.points[0], heading, float(ends[0])), going]
    if facing is not None:
        last = float(ends[-1])
        parts.append(_turning(way.points[-1], last, last + _short(facing - last)))
    return _joined(parts)


def _short(angle: float) -> float:
    """Return an angle as the shorter turn [rad]."""
    return float((angle + np.pi) % (2.0 * np.pi) - np.pi)


def _turning(place: Array, start: float, end: float) -> Travel:
    """Return a body that turns where it stands."""
    lasts = BELL * abs(end - start) / ON_THE_SPOT
    share = np.linspace(0.0, 1.0, int(np.ceil(lasts * RATE)) + 1)
    return Travel(np.broadcast_to(place, (len(share), 2)).copy(), start + eased(share) * (end - start))


def _joined(parts: Sequence[Travel]) -> Travel:
    """Return what follows one after the other; each begins where the one before it has ended."""
    places = [parts[0].places, *(own.places[1:] for own in parts[1:])]
    return Travel(np.concatenate(places), np.concatenate([parts[0].headings, *(own.headings[1:] for own in parts[1:])]))
