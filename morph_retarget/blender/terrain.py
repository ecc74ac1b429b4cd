"""The height of a ground object under a character."""

import bpy
import numpy as np
from mathutils import Vector
from mathutils.bvhtree import BVHTree

from ..core.arrays import Array, Indices
from ..core.character.character import Character
from ..core.errors import RigError
from ..core.ground import Ground

HIGH = 3.0
"""Rays start this many heights above the character's ground."""


def ground_of(ob: bpy.types.Object, character: Character) -> Ground:
    """Return the height of a mesh under points of a character's frame.

    Raises:
        RigError: The object is no mesh.
    """
    corners, triangles = surface_of(ob, bpy.context.evaluated_depsgraph_get())
    return under(character.world_to_character.points(corners), triangles, HIGH * character.frame.height)


def surface_of(ob: bpy.types.Object, graph: bpy.types.Depsgraph, matrix: Array | None = None) -> tuple[Array, Indices]:
    """Return the corners of a mesh [m], world space, shape (corner, 3), and its triangles, shape (triangle, 3).

    Args:
        ob: The mesh object.
        graph: Where it is evaluated.
        matrix: Where it is in the world, shape (4, 4); where it is now when None.

    Raises:
        RigError: The object is no mesh.
    """
    if ob.type != "MESH":
        raise RigError(f"object {ob.name!r} cannot be the ground: choose a mesh")
    evaluated = ob.evaluated_get(graph)
    mesh = evaluated.to_mesh()
    assert mesh is not None, "mesh objects have a mesh"
    world = np.array(evaluated.matrix_world, dtype=np.float64) if matrix is None else matrix
    corners = np.empty(len(mesh.vertices) * 3)
    mesh.vertices.foreach_get("co", corners)
    mesh.calc_loop_triangles()
    triangles = np.empty(len(mesh.loop_triangles) * 3, dtype=np.int32)
    mesh.loop_triangles.foreach_get("vertices", triangles)
    evaluated.to_mesh_clear()
    sides = triangles.reshape(-1, 3).astype(np.intp)
    mirrored = np.linalg.det(world[:3, :3]) < 0.0
    return corners.reshape(-1, 3) @ world[:3, :3].T + world[:3, 3], sides[:, ::-1] if mirrored else sides


def under(corners: Array, triangles: Indices, top: float) -> Ground:
    """Return the height of a surface under points, or over those that are inside it; NaN where there is neither.

    Args:
        corners: Of the surface [m], in the space of the points, shape (corner, 3).
        triangles: Their places among the corners, shape (triangle, 3).
        top: How far above the points it is looked for first [m].
    """
    tree = BVHTree.FromPolygons(corners.tolist(), triangles.tolist(), all_triangles=True)
    up, down = Vector((0.0, 0.0, 1.0)), Vector((0.0, 0.0, -1.0))

    def height(point: Vector) -> float:
        below, side, _, _ = tree.ray_cast(point, down)
        if below is not None and side is not None and side.z > 0.0:
            return below.z
        # A hill may be higher than where the ray starts.
        above = tree.ray_cast(point, up)[0]
        found = below if above is None else above
        return np.nan if found is None else found.z

    def heights(points: Array) -> Array:
        return np.array([height(Vector((x, y, z + top))) for x, y, z in points.tolist()])

    return heights
