"""What the extension draws into the viewport, over what Blender draws there."""

from typing import Any

import bpy

from ..morph import paths, query
from ..properties import of_scene
from . import path_overlay, solver_overlay, strokes
from .strokes import Stroke

_handles: list[Any] = []


def strokes_now(context: bpy.types.Context) -> list[Stroke]:
    """Return what is drawn for the active character, as far as it is switched on."""
    scene, layer = context.scene, context.view_layer
    if scene is None or layer is None or layer.depsgraph is None:
        return []
    own = of_scene(scene)
    if not (own.show_paths or own.show_solver):
        return []
    ob = query.active_character(context)
    if ob is None or not ob.visible_get():
        return []
    out: list[Stroke] = []
    if own.show_paths:
        out += path_overlay.strokes(ob, scene, layer.depsgraph)
    if own.show_solver:
        out += solver_overlay.strokes(ob)
    return out


def _draw() -> None:
    """Draw into the viewport, after what Blender draws there."""
    space = bpy.context.space_data
    if isinstance(space, bpy.types.SpaceView3D) and space.overlay is not None and space.overlay.show_overlays:
        strokes.draw(strokes_now(bpy.context))


def attach() -> None:
    """Draw from now on, where there is a window."""
    if not bpy.app.background and not _handles:
        _handles.append(bpy.types.SpaceView3D.draw_handler_add(_draw, (), "WINDOW", "POST_VIEW"))


def detach() -> None:
    """Draw no more."""
    while _handles:
        bpy.types.SpaceView3D.draw_handler_remove(_handles.pop(), "WINDOW")
    paths.forget()
