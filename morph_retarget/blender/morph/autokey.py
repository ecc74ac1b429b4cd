"""Values set by hand: all characters of an action share them, and auto-keying keys them as it keys bones.

While a bone is dragged nothing is keyed. When the drag is over, the channel's values are keyed if auto-keying is on,
the keys that Blender has put on the bone itself are taken away again, and the character that was held is posed by its
values like all others.
"""

from collections.abc import Callable
from typing import Any

import bpy

from .. import actions
from ..properties import of_rig
from ..rig import pose_bone
from . import cast, keys
from .generalize import Held
from .properties import of_action
from .values import MORPHRETARGET_PG_values

PAUSE = 0.1
"""Between looks at whether a drag is over [s]."""

_held: list[Held] = []
_sharing: list[bool] = []
_then: list[Callable[[bpy.types.Scene], None]] = []


def hold(held: Held, then: Callable[[bpy.types.Scene], None]) -> None:
    """Remember what is dragged, and call ``then`` when it is let go."""
    _held[:], _then[:] = [held], [then]
    if not bpy.app.background and not bpy.app.timers.is_registered(_look):
        bpy.app.timers.register(_look, first_interval=PAUSE)


def forget() -> None:
    """Drop what is dragged."""
    _held.clear()


def _look() -> float | None:
    if _dragging():
        return PAUSE
    scene = bpy.context.scene
    if scene is not None and _held:
        settle(scene)
        bpy.ops.ed.undo_push(message="Pose Generalized Channel")
        for area in (area for window in _windows() if window.screen for area in window.screen.areas):
            area.tag_redraw()
    return None


def _dragging() -> bool:
    return any(op.bl_idname.startswith("TRANSFORM_OT") for window in _windows() for op in window.modal_operators)


def _windows() -> list[bpy.types.Window]:
    manager = bpy.context.window_manager
    return list(manager.windows) if manager is not None else []


def settle(scene: bpy.types.Scene) -> None:
    """Key what was dragged if auto-keying is on, and show everybody's pose."""
    settings = scene.tool_settings
    for held in _held:
        if settings is not None and settings.use_keyframe_insert_auto:
            keys.insert(held.ob, held.channel, held.parts, scene.frame_current_final)
        _remove_bone_keys(held)
    _held.clear()
    for then in _then:
        then(scene)


def _remove_bone_keys(held: Held) -> None:
    """Remove curves of the bones that generalized values pose, which would only fight them."""
    action, slot = actions.assigned(held.ob)
    if action is None or slot is None:
        return
    own = tuple(pose_bone(held.ob, name).path_from_id() + "." for name in held.bones)
    bag = keys.bag_of(action)
    for curve in [curve for curve in bag.fcurves if curve.data_path.startswith(own)]:
        bag.fcurves.remove(curve)


def valued(item: MORPHRETARGET_PG_values, part: str) -> None:
    """Give all characters of an action a value that was set on one, and key it where auto-keying would."""
    ob, scene = item.id_data, bpy.context.scene
    assert isinstance(ob, bpy.types.Object), "values are on objects"
    action = cast.action_of(ob)
    if _sharing or action is None or scene is None or item.name not in of_action(action).channels:
        return
    share(action, item.name, part, getattr(item, part))
    settings = scene.tool_settings
    animated = any(path == keys.path(item.name, part) for path, _ in keys.curves(action))
    if settings is not None and settings.use_keyframe_insert_auto and animated and not _held:
        keys.insert(ob, item.name, (part,), scene.frame_current_final)


def share(action: bpy.types.Action, channel: str, part: str, value: Any) -> None:
    """Give all characters of an action a value of a channel, without keying it."""
    scene = bpy.context.scene
    _sharing.append(True)
    try:
        for ob in cast.playing(scene, action) if scene is not None else ():
            item = of_rig(ob).channels.get(channel)
            if item is not None:
                setattr(item, part, value)
    finally:
        _sharing.clear()
