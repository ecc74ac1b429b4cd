"""Who is told when something has changed that a retarget depends on: a setting, or a joint's bone."""

import contextlib
from collections.abc import Callable

import bpy

from . import declaring

listeners: list[Callable[[bpy.types.Scene], None]] = []
"""Called after a setting has changed that a live pose depends on."""


def changed(_: object, context: bpy.types.Context) -> None:
    """Tell that a setting has changed."""
    if context.scene is not None and not declaring.is_held(changed):
        for listener in listeners:
            listener(context.scene)


def together() -> contextlib.AbstractContextManager[None]:
    """Tell once of all that is changed meanwhile: each time, a live target is given its motion anew."""
    return declaring.together(changed, None, bpy.context)
