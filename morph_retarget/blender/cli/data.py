"""The extension's data in files, for a command line that runs where the extension is not switched on."""

import contextlib
from collections.abc import Iterator

import bpy

from .. import properties
from ..directing import walking
from ..locomotion import guides


@contextlib.contextmanager
def known() -> Iterator[None]:
    """Let Blender know the extension's properties for a while; handlers, operators and panels are not needed."""
    if hasattr(bpy.types.Action, "morph_retarget"):
        yield
        return
    for cls in properties.CLASSES:
        bpy.utils.register_class(cls)
    properties.attach()
    guides.guides.append(walking.GUIDE)
    try:
        yield
    finally:
        guides.guides.remove(walking.GUIDE)
        properties.detach()
        for cls in reversed(properties.CLASSES):
            bpy.utils.unregister_class(cls)
