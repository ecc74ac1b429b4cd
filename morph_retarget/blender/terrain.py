"""The height of a ground object under a character."""

import bpy
import numpy as np
from mathutils import Vector
from mathutils.bvhtree import BVHTree

from ..core.arrays import Array
from ..core.character.character import Character
from ..core.errors import RigError
from ..core.mocap.feet import Ground

HIGH = 3.0
"""Rays start this many heights above the character's ground."""


def ground_of(ob: bpy.types.Object, character: Character) -> Ground:
    """Return the height of a mesh under points of a character's frame; 0 where there is nothing below.

    Raises:
        RigError: The object is no mesh.
    """
    if ob.type != "MESH":
        raise RigError(f"object {ob.name!r} cannot be the ground: choose a mesh")
    depsgraph = bpy.context.evaluated_depsgraph_get()
    evaluated = ob.evaluated_get(depsgraph)
    mesh = evaluated.to_mesh()
    assert mesh is not None, "mesh objects have a mesh"
    to_character = character.world_to_character
    world = np.array(evaluated.matrix_world, dtype=np.float64)
    corners = np.empty(len(mesh.vertices) * 3)
    mesh.vertices.foreach_get("co", corners)
    placed = to_character.points(corners.reshape(-1, 3) @ world[:3, :3].T + world[:3, 3])
    mesh.calc_loop_triangles()
    triangles = np.empty(len(mesh.loop_triangles) * 3, dtype=np.int32)
    mesh.loop_triangles.foreach_get("vertices", triangles)
    tree = BVHTree.FromPolygons(placed.tolist(), triangles.reshape(-1, 3).tolist(), all_triangles=True)
    evaluated.to_mesh_clear()
    top = HIGH * character.frame.height
    down = Vector((0.0, 0.0, -1.0))

    def height(points: Array) -> Array:
        hits = [tree.ray_cast(Vector((x, y, z + top)), down)[0] for x, y, z in points.tolist()]
        return np.array([0.0 if hit is None else hit.z for hit in hits])

    return height
