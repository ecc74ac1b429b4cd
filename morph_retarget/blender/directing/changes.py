"""What all settings of directing share: who is told of a change, and how often."""

import contextlib

import bpy

from .. import declaring
from ..declaring import Listener

command_listeners: list[Listener] = []
"""Called after a command, or what commands are understood with, has changed."""
tell = declaring.telling(command_listeners)
"""Tells that something about the commands has changed."""
SETTING = declaring.fixed(tell)
"""Of what is the same for a whole clip: it cannot be keyed."""


def together(own: bpy.types.bpy_struct) -> contextlib.AbstractContextManager[None]:
    """Tell once of all that is changed meanwhile."""
    return declaring.together(tell, own)


def owner_of(own: bpy.types.PropertyGroup) -> bpy.types.ID:
    """Return the object that settings belong to."""
    assert own.id_data is not None, "settings belong to an object"
    return own.id_data
