"""What all settings of directing share: who is told of a change, and what may be overridden."""

import contextlib
from collections.abc import Callable, Generator
from typing import Any

import bpy

command_listeners: list[Callable[[bpy.types.ID], None]] = []
"""Called after a command, or what commands are understood with, has changed."""

OVERRIDABLE: Any = {"LIBRARY_OVERRIDABLE"}
OVERRIDABLE_LIST: Any = {"LIBRARY_OVERRIDABLE", "USE_INSERTION"}
_together: list[bool] = []
"""Not empty while several settings are changed, of which is told once."""


def tell(own: Any, _: bpy.types.Context | None = None) -> None:
    """Tell that something about the commands has changed."""
    for listener in () if _together else command_listeners:
        listener(own.id_data)


@contextlib.contextmanager
def together(own: Any) -> Generator[None]:
    """Tell once of all that is changed meanwhile."""
    _together.append(True)
    try:
        yield
    finally:
        _together.pop()
    tell(own)


SETTING: Any = {"options": set(), "override": OVERRIDABLE, "update": tell}
"""Of what is the same for a whole clip: it cannot be keyed."""


def owner_of(own: bpy.types.PropertyGroup) -> bpy.types.ID:
    """Return the object that settings belong to."""
    assert own.id_data is not None, "settings belong to an object"
    return own.id_data
