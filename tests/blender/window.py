"""What the tests of the window share: the extension registered, and two armatures chosen in its panel."""

import contextlib
from collections.abc import Iterator

import bpy

from morph_retarget.blender import registration
from morph_retarget.blender.properties import of_scene
from morph_retarget.blender.scene_properties import MORPHRETARGET_PG_scene
from tests.blender import scenes


@contextlib.contextmanager
def registered() -> Iterator[None]:
    """Register the extension for a while; a handler left behind would block the end of Blender 4.5."""
    registration.register("morph_retarget")
    try:
        yield
    finally:
        registration.unregister()


def pair(**options: object) -> tuple[MORPHRETARGET_PG_scene, bpy.types.Object, bpy.types.Object]:
    """Return the panel's settings with a walking source and a target chosen in them."""
    source, target = scenes.walker(**options), scenes.sprout()
    settings = of_scene(bpy.context.scene)
    settings.source, settings.target = source, target
    return settings, source, target
