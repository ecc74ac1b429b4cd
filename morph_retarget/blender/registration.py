"""Putting the extension into Blender, and taking it out again, in reverse."""

from typing import Any

import bpy

from . import changes, handlers, live, operators, presets, properties, translations, ui
from .cli.messages import NAME
from .cli.program import main
from .directing import changes as orders
from .directing import known, reading, walking
from .locomotion import guides
from .locomotion import properties as locomotion
from .morph import autokey, cast, keys, perform, remap, values
from .morph import properties as morph
from .ui import menus, overlay

CLASSES = (*properties.CLASSES, *operators.CLASSES, *ui.CLASSES)

_LISTENERS: tuple[tuple[list[Any], Any], ...] = (
    (changes.listeners, live.refresh),
    (morph.movement_listeners, remap.changed),
    (morph.name_listeners, keys.rename),
    (morph.definition_listeners, perform.definition_changed),
    (values.value_listeners, autokey.valued),
    (values.character_listeners, perform.character_changed),
    (locomotion.course_listeners, perform.course_changed),
    (locomotion.manner_listeners, perform.gait_changed),
    (orders.command_listeners, perform.gait_changed),
    (known.finders, reading.library_now),
    (guides.guides, walking.GUIDE),
)
"""Who is told of which changes of settings, and who leads characters where."""

_commands: list[Any] = []


def register(package: str | None) -> None:
    """Register everything.

    Args:
        package: Name that the extension is imported by; its presets live in that extension's folder.
    """
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    properties.attach()
    for listeners, listener in _LISTENERS:
        listeners.append(listener)
    presets.use(package or NAME)
    handlers.attach()
    overlay.attach()
    menus.attach()
    translations.attach()
    _commands.append(bpy.utils.register_cli_command(NAME, main))


def unregister() -> None:
    """Undo `register`."""
    while _commands:
        bpy.utils.unregister_cli_command(_commands.pop())
    translations.detach()
    menus.detach()
    overlay.detach()
    handlers.detach()
    live.forget()
    perform.forget()
    cast.forget(rig=True)
    for listeners, listener in _LISTENERS:
        listeners.remove(listener)
    properties.detach()
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
