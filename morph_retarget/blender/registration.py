"""Putting the extension into Blender, and taking it out again, in reverse."""

from typing import Any

import bpy

from . import handlers, live, operators, presets, properties, ui
from .cli.messages import NAME
from .cli.program import main

CLASSES = (*properties.CLASSES, *operators.CLASSES, *ui.CLASSES)

_commands: list[Any] = []


def register(package: str | None) -> None:
    """Register everything.

    Args:
        package: Name that the extension is imported by; its presets live in that extension's folder.
    """
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    properties.attach()
    properties.listeners.append(live.refresh)
    presets.use(package or NAME)
    handlers.attach()
    _commands.append(bpy.utils.register_cli_command(NAME, main))


def unregister() -> None:
    """Undo `register`."""
    while _commands:
        bpy.utils.unregister_cli_command(_commands.pop())
    handlers.detach()
    live.forget()
    properties.listeners.remove(live.refresh)
    properties.detach()
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
