"""Looking at results in files: what the small body of the tests does in them."""

from pathlib import Path

import bpy

from morph_retarget.blender.io import load
from morph_retarget.blender.io.load import Request
from morph_retarget.core.arrays import Array
from tests.blender import scenes
from tools.figure import blender

ARMS = [i for i, segment in enumerate(scenes.SEGMENTS) if segment in scenes.ARMS]
"""Places of the arms among the segments."""


def reload(path: Path) -> bpy.types.Object:
    """Open a result and return its armature."""
    load.load(Request(path))
    return scenes.only_armature()


def places(path: Path, count: int = scenes.COUNT, joints: tuple[str, ...] = ("hips",)) -> Array:
    """Return the places of joints of a result's small body over its action, shape (frame, joint, 3)."""
    ob = reload(path)
    return scenes.heads(ob, [blender(joint) for joint in joints], scenes.over_action(ob, count))


def directions(path: Path, count: int = scenes.COUNT) -> Array:
    """Return the directions of the segments of a result's small body over its action, shape (frame, segment, 3)."""
    ob = reload(path)
    return scenes.directions(ob, scenes.over_action(ob, count), blender)
