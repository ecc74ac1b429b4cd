"""Creatures that go over the ground, and what they go on, for tests."""

from collections.abc import Sequence

import bpy
import numpy as np

from morph_retarget.blender.locomotion.properties import MORPHRETARGET_PG_gait
from morph_retarget.blender.morph import analyses
from morph_retarget.blender.properties import of_rig
from morph_retarget.core import play
from morph_retarget.core.arrays import Array
from tests.blender import acting, acts, scenes

FRAMES = [1, 2, 7.5, 31, 32, 60, 100, 180]
"""Frames at which it is enough to look, of scenes of 180."""
WHOLE = [1, 2, 31, 32, 60, 100, 180]
"""The same without fractions: those that a bake keys."""


def walker(kind: str = "biped", **settings: object) -> bpy.types.Object:
    """Return a creature that goes over the ground."""
    ob = acts.creature(kind)
    bpy.context.view_layer.objects.active = ob
    bpy.ops.morph_retarget.add_locomotion(character=ob.name)
    for name, value in settings.items():
        setattr(gait(ob), name, value)
    return ob


def gait(ob: bpy.types.Object) -> MORPHRETARGET_PG_gait:
    """Return the settings of a creature's locomotion."""
    return of_rig(ob).gait


def shown(ob: bpy.types.Object, frames: Sequence[float] = FRAMES) -> Array:
    """Return where all bones of a creature are in the world, shape (frame, bone, 3)."""
    return acting.shown(ob, frames)


def root(ob: bpy.types.Object, frames: Sequence[float] = FRAMES) -> Array:
    """Return where the root of a creature is in the world, shape (frame, 3)."""
    _, _, bodies = analyses.of(ob)
    return scenes.heads(ob, [bodies.names[play.root_of(bodies)]], frames)[:, 0]


def seconds(frames: Sequence[float]) -> Array:
    """Return the times of frames, from the first of the scene on [s]."""
    return (np.array(frames) - 1.0) / scenes.FPS


def path(points: Sequence[Sequence[float]], kind: str = "POLY", cyclic: bool = False) -> bpy.types.Object:
    """Return a curve through some points."""
    curve = bpy.data.curves.new("Path", "CURVE")
    curve.dimensions = "3D"
    spline = curve.splines.new(kind)
    spline.use_cyclic_u = cyclic
    if kind == "BEZIER":
        spline.bezier_points.add(len(points) - 1)
        for point, place in zip(spline.bezier_points, points, strict=True):
            point.co, point.handle_left_type, point.handle_right_type = place, "AUTO", "AUTO"
    else:
        spline.points.add(len(points) - 1)
        for point, place in zip(spline.points, points, strict=True):
            point.co = (*place, 1.0)
    return added("Path", curve)


def added(name: str, data: bpy.types.ID | None) -> bpy.types.Object:
    """Return a new object in the scene."""
    ob = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(ob)
    bpy.context.view_layer.update()
    return ob


def plane(size: float, height: float, slope: float = 0.0) -> bpy.types.Object:
    """Return a mesh whose height rises by ``slope`` along -Y."""
    mesh = bpy.data.meshes.new("Hill")
    corners = [(x, y, height - slope * y) for x, y in ((-size, -size), (size, -size), (size, size), (-size, size))]
    mesh.from_pydata(corners, [], [(0, 1, 2, 3)])
    return added("Hill", mesh)
