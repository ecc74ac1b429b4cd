"""Flesh as plain data: bones that carry round lumps, and the shapes that their mesh can take.

Lumps lie in the figure's own space at rest, so that a figure can be mirrored, and read, as a whole.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum

import numpy as np

from .figure import Bone, Point

_LATITUDES = {12: (0.0, 30.0, 65.0), 8: (0.0, 55.0), 0: (25.0,)}
"""Of the rings that a round end has [deg], the last of which one face fills, by the sides that a lump has at least."""
_GRAIN = 2.0**-12
"""Places of vertices are multiples of this [m], so that files compress better."""


class Paint(StrEnum):
    """What a lump is made of."""

    SKIN = "skin"
    PALE = "pale"
    CLOTH = "cloth"
    DARK = "dark"
    WHITE = "white"
    MOUTH = "mouth"


@dataclass(frozen=True)
class Lump:
    """A tube with round ends."""

    start: Point
    end: Point
    radii: tuple[float, float]
    """At ``start`` and at ``end`` [m]."""
    paint: Paint = Paint.SKIN
    squash: Point = (1.0, 1.0, 1.0)
    """Factors of the radii along the figure's X, Y and Z."""
    sides: int = 8
    """Of the tube; those of thin lumps need not be many."""
    flush: bool = False
    """Whether it begins without a round end, where another lump has one."""


@dataclass(frozen=True)
class Part(Bone):
    """A bone and what it carries."""

    flesh: tuple[Lump, ...] = ()
    turns: Mapping[str, Point] = field(default_factory=dict[str, Point])
    """Name of a shape of the mesh to the turn about the bone's head in it, with all that hangs on the bone: a rotation
    vector [rad]."""


def mesh(lump: Lump) -> tuple[np.ndarray, list[tuple[int, ...]]]:
    """Return the vertices of a lump [m], shape (vertex, 3), and its faces, seen from outside counter-clockwise."""
    start, end = np.array(lump.start), np.array(lump.end)
    length = float(np.linalg.norm(end - start))
    axis = (end - start) / length if length > 0.0 else np.array([0.0, 0.0, 1.0])
    side = np.cross(axis, np.eye(3)[int(np.argmin(np.abs(axis)))])
    side /= np.linalg.norm(side)
    angles = 2.0 * np.pi * np.arange(lump.sides) / lump.sides
    ring = np.cos(angles)[:, None] * side + np.sin(angles)[:, None] * np.cross(axis, side)
    squash, (first, last) = np.array(lump.squash), lump.radii
    latitudes = np.radians(next(rings for least, rings in _LATITUDES.items() if lump.sides >= least))
    behind = latitudes[:1] if lump.flush else latitudes[::-1]
    rings = [start + squash * first * (np.cos(a) * ring - np.sin(a) * axis) for a in behind]
    rings += [end + squash * last * (np.cos(a) * ring + np.sin(a) * axis) for a in latitudes]
    return grained(np.concatenate(rings)), _faces(len(rings), lump.sides, lump.flush)


def grained(vertices: np.ndarray) -> np.ndarray:
    """Return places rounded as those of vertices are [m]."""
    return np.round(vertices / _GRAIN) * _GRAIN


def _faces(rings: int, sides: int, flush: bool) -> list[tuple[int, ...]]:
    """Return faces between rings and over the last; over the first too, unless it is ``flush``."""
    faces: list[tuple[int, ...]] = [tuple(range((rings - 1) * sides, rings * sides))]
    if not flush:
        faces.append(tuple(range(sides))[::-1])
    for i in range(rings - 1):
        here, above = i * sides, (i + 1) * sides
        for j in range(sides):
            k = (j + 1) % sides
            faces.append((here + j, here + k, above + k, above + j))
    return faces


def shapes(parts: Iterable[Part]) -> list[str]:
    """Return the names of all shapes that a figure can take."""
    return list(dict.fromkeys(name for part in parts for name in part.turns))


def shaped(parts: Sequence[Part], shape: str) -> dict[str, np.ndarray]:
    """Return how each bone's flesh moves for a shape: bone name to a matrix, shape (4, 4)."""
    moves: dict[str, np.ndarray] = {}
    for part in parts:
        above = np.eye(4) if part.parent is None else moves[part.parent]
        moves[part.name] = above @ _turn(part.turns.get(shape, (0.0, 0.0, 0.0)), part.head)
    return moves


def _turn(vector: Point, center: Point) -> np.ndarray:
    """Return a rotation about a point, shape (4, 4)."""
    angle = float(np.linalg.norm(vector))
    x, y, z = np.array(vector) / max(angle, 1e-9)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    out = np.eye(4)
    out[:3, :3] += np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross
    out[:3, 3] = np.array(center) - out[:3, :3] @ np.array(center)
    return out


def opposite(part: Part) -> Part:
    """Return the right bone to a left one, ``Hand.R`` to ``Hand.L``, with its flesh."""
    return replace(
        part,
        name=_right(part.name),
        parent=part.parent and _right(part.parent),
        head=_across(part.head),
        tail=_across(part.tail),
        flesh=tuple(replace(lump, start=_across(lump.start), end=_across(lump.end)) for lump in part.flesh),
        turns={name: (x, -y, -z) for name, (x, y, z) in part.turns.items()},
    )


def _right(name: str) -> str:
    return f"{name.removesuffix('.L')}.R" if name.endswith(".L") else name


def _across(point: Point) -> Point:
    return -point[0], point[1], point[2]
