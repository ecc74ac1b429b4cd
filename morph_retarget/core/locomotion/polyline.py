"""A line over the ground, measured by its length: where it is and which way it leads at any way along it."""

from dataclasses import dataclass
from typing import cast

import numpy as np

from ..arrays import Array, Flags, Indices
from ..errors import MotionError

FINE = 12
"""Points of the line within the length over which its corners are smoothed."""
MOST_POINTS = 200_000
"""No line is cut into more points than this, however long it is against its corners."""


@dataclass(frozen=True, eq=False)
class Polyline:
    """Straight pieces between points, with corners rounded off."""

    ways: Array
    """Length of the line up to each point [m], rising, shape (point,)."""
    points: Array
    """[m], shape (point, 3)."""
    headings: Array
    """Which way the line leads at each point, turn about up from -Y [rad], unwrapped, shape (point,)."""
    closed: bool

    @property
    def length(self) -> float:
        """Of the whole line [m]."""
        return float(self.ways[-1])

    def at(self, ways: Array) -> tuple[Array, Array]:
        """Return points, shape (n, 3), and headings [rad], shape (n,), at ways along the line [m], shape (n,).

        A closed line goes round and round, its heading with it; an open one ends where it ends.
        """
        if self.closed:
            rounds = np.floor(ways / self.length)
            within = ways - rounds * self.length
        else:
            rounds, within = np.zeros(len(ways)), np.clip(ways, 0.0, self.length)
        points = np.column_stack([np.interp(within, self.ways, self.points[:, i]) for i in range(3)])
        around = _full_turns(float(self.headings[0]), float(self.headings[-1]))
        return points, np.interp(within, self.ways, self.headings) + rounds * around


def smoothed(points: Array, closed: bool, smoothing: float) -> Polyline:
    """Return a line through points with its corners rounded off.

    Args:
        points: [m], shape (point, 3) or (point, 2), those on the ground.
        closed: Whether the last point leads back to the first.
        smoothing: Length of the line over which a corner is spread [m]; 0 keeps it sharp. Open lines keep their ends.

    Raises:
        MotionError: These points make no line.
    """
    corners = _distinct(points, closed)
    steps = np.sqrt((np.diff(corners, axis=0) ** 2).sum(axis=1))
    ways = np.concatenate([[0.0], np.cumsum(steps)])
    span = min(smoothing, 0.5 * float(ways[-1]))
    if span > 0.0:
        corners = _rounded(ways, corners, closed, span)
        steps = np.sqrt((np.diff(corners, axis=0) ** 2).sum(axis=1))
        ways = np.concatenate([[0.0], np.cumsum(steps)])
        return Polyline(ways, corners, _headings(corners, closed), closed)
    # Along sharp corners the heading jumps: each piece has two ends of its own.
    piece = _piece_headings(corners)
    twice = np.repeat(np.arange(len(corners)), 2)[1:-1]
    return Polyline(ways[twice], corners[twice], np.repeat(piece, 2), closed)


def _distinct(points: Array, closed: bool) -> Array:
    """Return the points in space, without those that stand on the one before them."""
    points = np.asarray(points, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] not in (2, 3):
        raise MotionError(f"the path has points of shape {points.shape}: give them as (point, 2) or (point, 3)")
    if not np.isfinite(points).all():
        raise MotionError("the path has points that are not finite numbers: mend the curve")
    if points.shape[1] == 2:
        points = np.column_stack([points, np.zeros(len(points))])
    if closed:
        points = np.concatenate([points, points[:1]])
    size = float(np.ptp(points, axis=0).max(initial=0.0)) if len(points) else 0.0
    if len(points) < 2 or size <= 0.0:
        raise MotionError("the path has no length: give it at least two points in different places")
    moved = np.abs(np.diff(points, axis=0)).max(axis=1) > 1e-9 * size
    return points[np.concatenate([[True], moved])]


def _rounded(ways: Array, corners: Array, closed: bool, span: float) -> Array:
    """Return the line in fine steps, each point the mean of the line around it, weighted by a raised cosine."""
    length = float(ways[-1])
    count = min(int(np.ceil(FINE * length / span)), MOST_POINTS)
    half = max(round(0.5 * span * count / length), 1)
    fine = np.linspace(0.0, length, count + 1)
    line = np.column_stack([np.interp(fine, ways, corners[:, i]) for i in range(3)])
    if closed:
        around = np.concatenate([line[-half - 1 : -1], line, line[1 : half + 1]])
    else:
        # Mirrored about each end, so that the line starts and ends where it did.
        before, after = 2.0 * line[0] - line[half:0:-1], 2.0 * line[-1] - line[-2 : -half - 2 : -1]
        around = np.concatenate([before, line, after])
    window = np.hanning(2 * half + 3)[1:-1]
    window /= window.sum()
    return np.column_stack([cast("Array", np.convolve(around[:, i], window, mode="valid")) for i in range(3)])


def _piece_headings(corners: Array) -> Array:
    """Return the heading of each piece [rad], unwrapped; one that goes straight up keeps that of those before it."""
    along = np.diff(corners, axis=0)
    level = np.hypot(along[:, 0], along[:, 1]) > 1e-6 * np.sqrt((along**2).sum(axis=1))
    if not level.any():
        return np.zeros(len(along))
    known = last_known(level)
    return np.unwrap(np.arctan2(along[known, 0], -along[known, 1]))


def _headings(corners: Array, closed: bool) -> Array:
    """Return the heading at each point [rad]: halfway between those of the pieces that meet there."""
    pieces = _piece_headings(corners)
    middle = 0.5 * (pieces[1:] + pieces[:-1])
    if not closed:
        return np.concatenate([pieces[:1], middle, pieces[-1:]])
    around = _full_turns(float(pieces[0]), float(pieces[-1]))
    start = 0.5 * (pieces[0] + pieces[-1] - around)
    return np.concatenate([np.array([start]), middle, np.array([start + around])])


def _full_turns(first: float, last: float) -> float:
    """Return the nearest to the angle between two headings that leads back to the first of them [rad]."""
    return 2.0 * np.pi * round((last - first) / (2.0 * np.pi))


def last_known(known: Flags) -> Indices:
    """Return for each entry the last one up to it that is known; before the first of these, the first, shape (n,)."""
    found = np.maximum.accumulate(np.where(known, np.arange(len(known)), -1))
    return np.where(found < 0, int(np.argmax(known)), found)
