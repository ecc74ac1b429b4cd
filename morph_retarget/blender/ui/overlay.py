"""The motion path in the viewport: where the active channel brings the active body, and its target.

Hecker 2008 draws this red curve (figures 2 and 3): it shows how a movement bends when its target moves.
"""

# The stubs know neither arrays as buffers nor the matrix stack as a context.
# pyright: reportArgumentType=false, reportGeneralTypeIssues=false

from typing import Any

import bpy
import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader

from ...core.arrays import Array
from ...core.errors import MorphError
from ..morph import paths, query
from ..morph.paths import MotionPath
from ..properties import of_scene

Color = tuple[float, float, float, float]

PATH: Color = (0.95, 0.16, 0.1, 0.9)
TARGET: Color = (0.2, 0.85, 0.3, 1.0)
CROSS = 0.03
"""Half the width of the target's cross, as a share of the character's size."""

_handles: list[Any] = []


def _draw() -> None:
    """Draw into the viewport, after what Blender draws there."""
    context = bpy.context
    scene, space, layer = context.scene, context.space_data, context.view_layer
    if scene is None or layer is None or layer.depsgraph is None or not isinstance(space, bpy.types.SpaceView3D):
        return
    if not (of_scene(scene).show_paths and space.overlay is not None and space.overlay.show_overlays):
        return
    ob = query.active_character(context)
    if ob is None or not ob.visible_get():
        return
    try:
        found = paths.path_of(ob, scene, layer.depsgraph)
    except MorphError:
        return  # the panel tells what is wrong
    if found is not None:
        with gpu.matrix.push_pop():
            gpu.matrix.multiply_matrix(ob.matrix_world)
            _paint(found)


def _paint(found: MotionPath) -> None:
    gpu.state.blend_set("ALPHA")
    _line(found.line, "LINE_STRIP", PATH)
    if len(found.keyed):
        gpu.state.point_size_set(7.0)
        shader = gpu.shader.from_builtin("POINT_UNIFORM_COLOR")
        shader.uniform_float("color", PATH)
        batch_for_shader(shader, "POINTS", {"pos": found.keyed.astype(np.float32)}).draw(shader)
        gpu.state.point_size_set(1.0)
    if found.target is not None:
        arms = CROSS * found.size * np.stack([np.eye(3), -np.eye(3)], axis=1).reshape(6, 3)
        _line(found.target + arms, "LINES", TARGET)
    gpu.state.blend_set("NONE")


def _line(points: Array, kind: Any, color: Color) -> None:
    shader = gpu.shader.from_builtin("POLYLINE_UNIFORM_COLOR")
    shader.uniform_float("viewportSize", gpu.state.viewport_get()[2:])
    shader.uniform_float("lineWidth", 2.0)
    shader.uniform_float("color", color)
    batch_for_shader(shader, kind, {"pos": points.astype(np.float32)}).draw(shader)


def attach() -> None:
    """Draw from now on, where there is a window."""
    if not bpy.app.background and not _handles:
        _handles.append(bpy.types.SpaceView3D.draw_handler_add(_draw, (), "WINDOW", "POST_VIEW"))


def detach() -> None:
    """Draw no more."""
    while _handles:
        bpy.types.SpaceView3D.draw_handler_remove(_handles.pop(), "WINDOW")
    paths.forget()
