"""Simple meshes for skeletons: a tapered box along every bone, so that a bare armature can be seen."""

import math

import bpy
import numpy as np
from mathutils import Vector

_FACES = ((0, 1, 2, 3), (7, 6, 5, 4), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0))


def clothe(
    armature: bpy.types.Object, color: tuple[float, float, float] = (0.6, 0.6, 0.6), thickness: float = 0.16
) -> bpy.types.Object:
    """Return a new mesh that follows ``armature`` rigidly, bone by bone.

    Args:
        armature: An armature object.
        color: Linear RGB of its material.
        thickness: Width of a bone's box over its length.
    """
    vertices: list[Vector] = []
    faces: list[tuple[int, ...]] = []
    groups: list[tuple[str, range]] = []
    limit = 0.06 * max(armature.dimensions) if max(armature.dimensions) else 1.0
    scale = max(armature.matrix_world.to_scale())
    for bone in armature.data.bones:
        ends = _ends(bone)
        for tail in ends:
            if (tail - bone.head_local).length < 1e-5:
                continue
            corners, sides = _box(bone.head_local, tail, thickness, limit / scale), _FACES
            if bone.name.lower().endswith("head") and not bone.children:
                corners, sides = _ball(bone.head_local, tail)
            groups.append((bone.name, range(len(vertices), len(vertices) + len(corners))))
            faces += [tuple(len(vertices) + i for i in face) for face in sides]
            vertices += corners
    mesh = bpy.data.meshes.new(f"{armature.name} body")
    mesh.from_pydata([tuple(v) for v in vertices], [], faces)
    material = bpy.data.materials.new(mesh.name)
    material.diffuse_color = (*color, 1.0)
    mesh.materials.append(material)
    body = bpy.data.objects.new(mesh.name, mesh)
    for collection in armature.users_collection:
        collection.objects.link(body)
    body.parent = armature
    for name, own in groups:
        group = body.vertex_groups.get(name) or body.vertex_groups.new(name=name)
        group.add(list(own), 1.0, "REPLACE")
    body.modifiers.new("Armature", "ARMATURE").object = armature
    return body


def _ends(bone: bpy.types.Bone) -> list[Vector]:
    """Return where a bone leads: to its children's heads, or to its own tail without children."""
    if bone.parent is None and len(bone.children) <= 1:
        return []  # a root that only carries the hips
    return [child.head_local for child in bone.children] or [bone.tail_local]


def _ball(head: Vector, tail: Vector) -> tuple[list[Vector], list[tuple[int, ...]]]:
    """Return an egg from ``head`` to ``tail`` with a nose at the front."""
    around, along = 12, 8
    middle, axis = head.lerp(tail, 0.5), 0.5 * (tail - head)
    side = axis.cross(Vector((0.0, -1.0, 0.0)))
    front = 0.85 * side.cross(axis).normalized() * axis.length
    side = 0.75 * side.normalized() * axis.length
    vertices = [head, tail]
    for i in range(1, along):
        latitude = math.pi * (i / along - 0.5)
        for j in range(around):
            angle = 2.0 * math.pi * j / around
            flat = math.cos(latitude) * (math.cos(angle) * front + math.sin(angle) * side)
            nose = 1.35 if j == 0 and i == along // 2 - 1 else 1.0
            vertices.append(middle + math.sin(latitude) * axis + nose * flat)
    faces: list[tuple[int, ...]] = []
    for j in range(around):
        k, last = (j + 1) % around, 2 + (along - 2) * around
        faces += [(0, 2 + k, 2 + j), (1, last + j, last + k)]
        for i in range(along - 2):
            low, high = 2 + i * around, 2 + (i + 1) * around
            faces.append((low + j, low + k, high + k, high + j))
    return vertices, faces


def _box(head: Vector, tail: Vector, thickness: float, limit: float) -> list[Vector]:
    axis = (tail - head).normalized()
    side = axis.cross(Vector(np.eye(3)[int(np.argmin(np.abs(axis)))])).normalized()
    up = axis.cross(side)
    width = min(thickness * (tail - head).length, limit)
    out: list[Vector] = []
    for center, half in ((head.lerp(tail, 0.04), 0.5 * width), (head.lerp(tail, 0.96), 0.32 * width)):
        out += [center + half * (a * side + b * up) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    return out
