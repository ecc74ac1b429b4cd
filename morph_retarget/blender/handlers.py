"""The handlers: one that shows live poses, and those that keep run-time state and saved data in order."""

from typing import Any

import bpy
from bpy.app.handlers import persistent

from . import live, migrations, present
from .controls import evaluating
from .morph import cast, events, own_values, perform


@persistent
def _before_frame(scene: bpy.types.Scene, *_: object) -> None:
    if scene.session_uid not in evaluating.stages:
        perform.foresee(scene, present.armatures(scene))


@persistent
def _on_frame(scene: bpy.types.Scene, graph: bpy.types.Depsgraph | None = None) -> None:
    present.notice(graph)
    if scene.session_uid not in evaluating.stages:
        found = present.armatures(scene)
        live.show_frame(scene, found)
        perform.show_frame(scene, graph, found)
        events.show_frame(scene, found)


@persistent
def _on_edit(scene: bpy.types.Scene, graph: bpy.types.Depsgraph) -> None:
    present.notice(graph)
    if scene.session_uid not in evaluating.stages:
        perform.update(scene, graph, present.armatures(scene))


@persistent
def _before_all_is_replaced(*_: object) -> None:
    present.forget()


def _forget(for_good: bool) -> None:
    present.forget()
    live.forget(for_good)
    perform.forget()
    cast.forget(rig=True)
    events.forget()


@persistent
def _on_load(*_: object) -> None:
    _forget(for_good=True)
    migrations.upgrade()
    for scene in bpy.data.scenes:
        live.catch_up(scene)


@persistent
def _on_undo(scene: bpy.types.Scene, *_: object) -> None:
    _forget(for_good=False)
    live.catch_up(scene)
    perform.show_frame(scene)  # the step may have kept a bone where it was dragged


@persistent
def _on_save(*_: object) -> None:
    own_values.keep_overrides()
    migrations.stamp()


def _pairs() -> list[tuple[list[Any], Any]]:
    handlers = bpy.app.handlers
    return [
        (handlers.frame_change_pre, _before_frame),
        (handlers.frame_change_post, _on_frame),
        (handlers.depsgraph_update_post, _on_edit),
        (handlers.load_pre, _before_all_is_replaced),
        (handlers.undo_pre, _before_all_is_replaced),
        (handlers.redo_pre, _before_all_is_replaced),
        (handlers.load_post, _on_load),
        (handlers.undo_post, _on_undo),
        (handlers.redo_post, _on_undo),
        (handlers.save_pre, _on_save),
    ]


def attach() -> None:
    """Append the handlers, each once."""
    for found, handler in _pairs():
        if handler not in found:
            found.append(handler)


def detach() -> None:
    """Remove the handlers; one left behind blocks the end of Blender 4.5 as a module."""
    for found, handler in _pairs():
        if handler in found:
            found.remove(handler)
