"""Blender's own add-ons that read and write files."""

import bpy  # noqa: F401 - the wheel's own modules can be imported only after it

# isort: split
import addon_utils


def enable(name: str) -> None:
    """Enable an add-on that ships with Blender, for this session."""
    addon_utils.enable(name, default_set=True)
