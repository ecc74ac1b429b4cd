"""How properties are declared: what overrides in other files may change, what can be keyed, and who is told."""

import contextlib
from collections.abc import Callable, Collection, Generator
from typing import Any

import bpy

Listener = Callable[[bpy.types.ID], None]
"""Takes the object or action that something has changed on."""
Tell = Callable[..., None]
"""An ``update`` of properties; takes the settings, and for Blender's sake a context."""

OVERRIDABLE: Any = {"LIBRARY_OVERRIDABLE"}
OVERRIDABLE_LIST: Any = {"LIBRARY_OVERRIDABLE", "USE_INSERTION"}
_held: list[Tell] = []
"""What tells later; see `together`."""


def telling(listeners: Collection[Listener]) -> Tell:
    """Return what tells listeners that settings have changed; the list may grow later."""

    def tell(own: Any, _: bpy.types.Context | None = None) -> None:
        for listener in () if is_held(tell) else listeners:
            listener(own.id_data)

    return tell


@contextlib.contextmanager
def together(tell: Tell, *about: object) -> Generator[None]:
    """Let something tell once of all that is changed meanwhile: ``tell(*about)``."""
    _held.append(tell)
    try:
        yield
    finally:
        _held.pop()
    tell(*about)


def is_held(tell: Tell) -> bool:
    """Return whether something shall be silent now, as it tells of all changes `together` later."""
    return tell in _held


def overridable(tell: Tell) -> Any:
    """Return what settings are declared with that an override may change, and of which somebody is told."""
    return {"override": OVERRIDABLE, "update": tell}


def fixed(tell: Tell) -> Any:
    """Return the same for settings that cannot be keyed: they are the same for a whole clip."""
    return {"options": set(), **overridable(tell)}


def only(kind: str) -> Callable[[object, bpy.types.Object], bool]:
    """Return a ``poll`` that offers objects of one type, such as ``MESH``."""

    def offered(_: object, ob: bpy.types.Object) -> bool:
        return ob.type == kind

    return offered


def proposed(names: Collection[str], text: str) -> list[str]:
    """Return which names a ``search`` proposes while ``text`` is typed: those with it, all where there are none."""
    return [name for name in names if text.lower() in name] or list(names)
