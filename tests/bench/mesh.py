"""What a dense mesh on the target costs a retarget: nothing, as long as no frame is evaluated."""

from functools import partial

import bpy
import numpy as np

from . import walkers
from .figures import Figure, medians, short
from .walkers import Pair

FRAMES, BONES = 240, 22
ROWS, COLUMNS = 500, 400
"""Of the mesh: 200,000 vertices."""
REPETITIONS = 15


def run() -> list[Figure]:
    """Return the time with a mesh in the scene over the time without."""
    pair = walkers.open_pair(BONES, FRAMES)
    mesh = _skinned(pair.sprout)
    without, with_mesh = medians([partial(_timed, pair, mesh, shown) for shown in (False, True)], REPETITIONS)
    print(f"{ROWS * COLUMNS} vertices: {short(1000 * with_mesh)} ms, without {short(1000 * without)} ms")
    return [Figure("mesh: time with 200,000 vertices over without", with_mesh / without, "", 1.1)]


def _timed(pair: Pair, mesh: bpy.types.Object, shown: bool) -> float:
    """Return the time of a retarget [s] with or without the mesh in the scene, everything up to date before."""
    objects = bpy.context.scene.collection.objects
    if shown:
        objects.link(mesh)
    bpy.context.view_layer.update()
    taken = walkers.timed(pair, plant_feet=True)
    if shown:
        objects.unlink(mesh)
    bpy.context.view_layer.update()
    return taken


def _skinned(armature: bpy.types.Object) -> bpy.types.Object:
    """Return a sheet as high as an armature, each row of it on the bone that comes nearest in height."""
    bones = list(armature.data.bones)
    heads = np.array([bone.head_local.z for bone in bones])
    heights = np.linspace(0.0, heads.max(), ROWS)
    x, z = np.meshgrid(np.linspace(-0.3, 0.3, COLUMNS), heights)
    corners = np.arange(ROWS * COLUMNS).reshape(ROWS, COLUMNS)
    faces = np.stack([corners[:-1, :-1], corners[:-1, 1:], corners[1:, 1:], corners[1:, :-1]], axis=-1)
    data = bpy.data.meshes.new("Sheet")
    data.from_pydata(np.stack([x, np.zeros_like(x), z], axis=-1).reshape(-1, 3), [], faces.reshape(-1, 4).tolist())
    ob = bpy.data.objects.new("Sheet", data)
    owners = np.abs(heights[:, None] - heads).argmin(axis=1)
    for i in np.unique(owners):
        group = ob.vertex_groups.new(name=bones[i].name)
        group.add(corners[owners == i].ravel().tolist(), 1.0, "REPLACE")
    ob.modifiers.new("Armature", "ARMATURE").object = armature
    return ob
