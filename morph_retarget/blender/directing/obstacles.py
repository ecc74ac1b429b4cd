"""Obstacles: what stands on the ground and is walked around."""

import bpy
import numpy as np

from ...core.arrays import Array
from .. import ways


def outlines(
    found: bpy.types.Collection, frame: float, graph: bpy.types.Depsgraph, from_world: Array, height: float
) -> tuple[Array, ...]:
    """Return what the objects of a collection cover of the ground, each shape (corner, 2) [m], counter-clockwise.

    An object counts with its bounding box, where keys put it at a frame, else where it stands now. What hangs above
    the character does not count, nor what is disabled in viewports.

    Args:
        found: The collection, with those inside it.
        frame: Of the scene.
        graph: Where the objects are evaluated.
        from_world: Leads from the world to the ground frame, in which the outlines are, shape (4, 4).
        height: Of the character [m].
    """
    out: list[Array] = []
    for ob in found.all_objects:
        seen = ob.evaluated_get(graph)
        box = np.array(seen.bound_box, dtype=np.float64)
        if ob.hide_viewport or np.ptp(box, axis=0).max() <= 0.0:
            continue
        keyed = ways.keyed(ob)
        place = ways.world(ob, np.array([frame]))[0] if keyed else np.array(seen.matrix_world, dtype=np.float64)
        place = from_world @ place
        corners = box @ place[:3, :3].T + place[:3, 3]
        if corners[:, 2].min() < height:
            out.append(hull(corners[:, :2]))
    return tuple(out)


def hull(points: Array) -> Array:
    """Return the corners of the convex hull of points of the plane, counter-clockwise, shape (n, 2) to (corner, 2)."""
    rows = sorted({(x, y) for x, y in points.tolist()})
    if len(rows) < 3:
        return np.array(rows)
    return np.array(_half(rows) + _half(rows[::-1]))


_Point = tuple[float, float]


def _half(rows: list[_Point]) -> list[_Point]:
    """Return one side of a hull, without its last corner, of points in order."""
    line: list[_Point] = []
    for point in rows:
        while len(line) > 1 and _side(line[-2], line[-1], point) <= 0.0:
            line.pop()
        line.append(point)
    return line[:-1]


def _side(a: _Point, b: _Point, c: _Point) -> float:
    """Return more than 0 where ``c`` is to the left of the way from ``a`` to ``b``."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
