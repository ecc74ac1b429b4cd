"""Versions of what files keep: stamped on save, brought up to date on load."""

from collections.abc import Callable, Mapping

import bpy

from .morph.properties import of_action
from .properties import of_scene
from .scene_properties import MORPHRETARGET_PG_scene

VERSION = 1

STEPS: Mapping[int, Callable[[MORPHRETARGET_PG_scene], None]] = {}
"""What brings a scene from a version to the next one; nothing has changed yet."""


def stamp() -> None:
    """Mark all scenes and generalized actions with the present version, except what a newer one has made."""
    for scene in bpy.data.scenes:
        if scene.library is None:
            of_scene(scene).version = max(of_scene(scene).version, VERSION)
    for action in bpy.data.actions:
        own = of_action(action)
        if action.library is None and (len(own.channels) or own.version):
            own.version = max(own.version, VERSION)


def upgrade() -> None:
    """Bring all scenes up to date."""
    for scene in bpy.data.scenes:
        settings = of_scene(scene)
        if scene.library is not None or settings.version == 0:  # linked, or never saved with data of ours
            continue
        for version in range(settings.version, VERSION):
            STEPS[version](settings)
        settings.version = max(settings.version, VERSION)
