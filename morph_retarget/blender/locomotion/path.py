"""Paths: curve objects as lines of points."""

from dataclasses import dataclass

import bpy
import numpy as np
from mathutils.geometry import interpolate_bezier

from ...core.arrays import Array
from ...core.errors import MotionError


@dataclass(frozen=True, eq=False)
class Line:
    """Points one after the other."""

    points: Array
    """[m], world space, shape (point, 3)."""
    closed: bool
    """Whether the last leads back to the first."""

    @property
    def key(self) -> tuple[object, ...]:
        """Equal for the same line."""
        return self.points.tobytes(), self.closed


def line_of(ob: bpy.types.Object, graph: bpy.types.Depsgraph, matrix: Array) -> Line:
    """Return the first spline of a curve object as Blender draws it.

    Args:
        ob: The object.
        graph: Where it is evaluated.
        matrix: Where it is in the world, shape (4, 4).

    Raises:
        MotionError: The object is no curve, or one without a spline that leads anywhere.
    """
    curve = ob.data
    if not isinstance(curve, bpy.types.Curve) or ob.type != "CURVE":
        raise MotionError(f"object {ob.name!r} cannot be a path: choose a curve")
    if not len(curve.splines):
        raise MotionError(f"path {ob.name!r} has no spline: draw one, or choose another curve")
    local = _of_splines(curve, ob.name) if _is_solid(curve) else _of_mesh(ob.evaluated_get(graph))
    if len(local) < 2 or np.ptp(local, axis=0).max() < 1e-9:
        raise MotionError(f"path {ob.name!r} leads nowhere: give its spline two points apart from each other")
    return Line(local @ matrix[:3, :3].T + matrix[:3, 3], curve.splines[0].use_cyclic_u)


def _is_solid(curve: bpy.types.Curve) -> bool:
    """Return whether a curve is drawn as a tube or a band, of which the line cannot be told any more."""
    return curve.bevel_depth != 0.0 or curve.extrude != 0.0 or curve.bevel_object is not None


def _of_mesh(seen: bpy.types.Object) -> Array:
    """Return the first spline's points, modifiers and all, local space, shape (point, 3)."""
    mesh = seen.to_mesh()
    assert mesh is not None, "curves can be made into meshes"
    points, edges = np.empty(len(mesh.vertices) * 3), np.empty(len(mesh.edges) * 2, dtype=np.int32)
    mesh.vertices.foreach_get("co", points)
    mesh.edges.foreach_get("vertices", edges)
    seen.to_mesh_clear()
    # Points lie in their order, with an edge from each to the next as long as the spline goes on.
    follows = np.zeros(max(len(points) // 3 - 1, 0), dtype=np.bool_)
    first, second = np.sort(edges.reshape(-1, 2), axis=1).T
    follows[first[second == first + 1]] = True
    count = int(np.argmin(np.append(follows, False))) + 1
    return points.reshape(-1, 3)[:count]


def _of_splines(curve: bpy.types.Curve, name: str) -> Array:
    """Return the first spline's points, local space, shape (point, 3)."""
    spline = curve.splines[0]
    if spline.type == "POLY":
        return np.array([point.co[:3] for point in spline.points], dtype=np.float64)
    if spline.type != "BEZIER":
        raise MotionError(f"path {name!r} is a NURBS curve with thickness: take its bevel and extrusion off")
    corners = list(spline.bezier_points)
    pairs = list(zip(corners, [*corners[1:], corners[0]], strict=True))
    out = [np.array([corners[0].co])]
    for a, b in pairs if spline.use_cyclic_u else pairs[:-1]:
        steps = interpolate_bezier(a.co, a.handle_right, b.handle_left, b.co, spline.resolution_u + 1)
        out.append(np.array(steps[1:]))
    points = np.concatenate(out)
    return points[:-1] if spline.use_cyclic_u else points
