"""Simple meshes for skeletons: round lumps along the bones, so that a bare armature can be seen."""

from collections.abc import Sequence

import bpy
import numpy as np
from mathutils import Vector

from . import flesh
from .flesh import Lump, Paint, Part

Color = tuple[float, float, float]

_FIXED: dict[Paint, Color] = {
    Paint.DARK: (0.03, 0.025, 0.03),
    Paint.WHITE: (0.85, 0.85, 0.82),
    Paint.MOUTH: (0.55, 0.08, 0.09),
}


_SIDES = 6
"""Of the lumps of any rig, which may have hundreds of bones."""


def clothe(armature: bpy.types.Object, color: Color = (0.6, 0.6, 0.6), thickness: float = 0.16) -> bpy.types.Object:
    """Return a new mesh that follows any armature rigidly, bone by bone.

    Args:
        armature: An armature object.
        color: Linear RGB of its material.
        thickness: Width of a bone's lump over its length.
    """
    limit = 0.06 * max(armature.dimensions) if max(armature.dimensions) else 1.0
    limit /= max(armature.matrix_world.to_scale())
    parts = [
        Part(bone.name, bone.parent and bone.parent.name, tuple(bone.head_local), tuple(bone.tail_local), lumps)
        for bone in armature.data.bones
        if (lumps := _lumps(bone, thickness, limit))
    ]
    return dress(armature, parts, {Paint.SKIN: color})


def dress(armature: bpy.types.Object, parts: Sequence[Part], colors: dict[Paint, Color]) -> bpy.types.Object:
    """Return a new mesh of the flesh that a figure's bones carry, with a shape key for each shape of the figure.

    Args:
        armature: The armature that was built from ``parts``.
        parts: The figure.
        colors: Linear RGB of its paints; eyes and mouths have colors of their own.
    """
    lumps = [(part.name, lump) for part in parts for lump in part.flesh]
    meshes = [flesh.mesh(lump) for _, lump in lumps]
    starts = np.cumsum([0, *(len(vertices) for vertices, _ in meshes)])
    vertices = np.concatenate([vertices for vertices, _ in meshes])
    faces = [[tuple(start + i for i in face) for face in own] for start, (_, own) in zip(starts, meshes, strict=False)]
    data = bpy.data.meshes.new(f"{armature.name} body")
    data.from_pydata(vertices.tolist(), [], [face for own in faces for face in own])
    paints = [paint for paint in Paint if any(lump.paint is paint for _, lump in lumps)]
    for paint in paints:
        data.materials.append(_material(f"{armature.name} {paint}", (_FIXED | colors)[paint]))
    slots = [paints.index(lump.paint) for _, lump in lumps]
    data.polygons.foreach_set("material_index", np.repeat(slots, [len(own) for own in faces]).astype(np.int32))
    data.polygons.foreach_set("use_smooth", np.ones(len(data.polygons), dtype=bool))
    body = bpy.data.objects.new(data.name, data)
    for collection in armature.users_collection:
        collection.objects.link(body)
    body.parent = armature
    for i, (bone, _) in enumerate(lumps):
        group = body.vertex_groups.get(bone) or body.vertex_groups.new(name=bone)
        group.add(list(range(starts[i], starts[i + 1])), 1.0, "REPLACE")
    body.modifiers.new("Armature", "ARMATURE").object = armature
    bones = np.repeat([bone for bone, _ in lumps], np.diff(starts))
    _add_shapes(body, parts, bones, vertices)
    return body


def _add_shapes(body: bpy.types.Object, parts: Sequence[Part], bones: np.ndarray, vertices: np.ndarray) -> None:
    """Add a shape key for each shape of the figure; ``bones`` names the bone of each vertex."""
    names = flesh.shapes(parts)
    if names:
        body.shape_key_add(name="Basis")
    for name in names:
        moves, places = flesh.shaped(parts, name), vertices.copy()
        for bone, move in moves.items():
            own = bones == bone
            places[own] = flesh.grained(vertices[own] @ move[:3, :3].T + move[:3, 3])
        body.shape_key_add(name=name, from_mix=False).data.foreach_set("co", places.astype(np.float32).ravel())


def _material(name: str, color: Color) -> bpy.types.Material:
    material = bpy.data.materials.new(name)
    material.diffuse_color = (*color, 1.0)
    return material


def _lumps(bone: bpy.types.Bone, thickness: float, limit: float) -> tuple[Lump, ...]:
    """Return lumps from a bone to where it leads, at most ``limit`` wide."""
    out: list[Lump] = []
    for tail in _ends(bone):
        length = (tail - bone.head_local).length
        if length < 1e-5:
            continue
        if bone.name.lower().endswith("head") and not bone.children:
            return _ball(bone.head_local, tail)
        width = min(thickness * length, limit)
        inset = 0.3 * width / length if length > width else 0.0
        start, end = bone.head_local.lerp(tail, inset), bone.head_local.lerp(tail, 1.0 - 0.6 * inset)
        out.append(Lump(tuple(start), tuple(end), (0.55 * width, 0.4 * width), sides=_SIDES))
    return tuple(out)


def _ends(bone: bpy.types.Bone) -> list[Vector]:
    """Return where a bone leads: to its children's heads, or to its own tail without children."""
    if bone.parent is None and len(bone.children) <= 1:
        return []  # a root that only carries the hips
    return [child.head_local for child in bone.children] or [bone.tail_local]


def _ball(head: Vector, tail: Vector) -> tuple[Lump, ...]:
    """Return an egg from ``head`` to ``tail`` with a nose at the front."""
    radius = 0.42 * (tail - head).length
    axis = (tail - head).normalized()
    front = axis.cross(Vector((0.0, -1.0, 0.0))).cross(axis) or Vector((0.0, 0.0, 1.0))
    nose = head.lerp(tail, 0.4) + 0.95 * radius * front.normalized()
    egg = Lump(tuple(head.lerp(tail, 0.42)), tuple(head.lerp(tail, 0.6)), (0.9 * radius, radius), sides=12)
    return egg, Lump(tuple(nose), tuple(nose + 0.1 * radius * front.normalized()), (0.2 * radius, 0.15 * radius))
