"""Rigs for the command line: armatures from files, or from the file that is open."""

import argparse
from pathlib import Path

import bpy

from ...core.character.frame import WORLD_AXES, axis
from ...core.quat import Array
from ..io import load
from ..io.load import Request


def add_rig_options(parser: argparse.ArgumentParser) -> None:
    """Add the options that tell more about a rig."""
    parser.add_argument("--armature", metavar="NAME", help="which armature, in files that hold several")
    parser.add_argument(
        "--up", choices=list(WORLD_AXES), metavar="AXIS", help="the (target) rig's up axis in the world, as +Z"
    )
    parser.add_argument("--forward", choices=list(WORLD_AXES), metavar="AXIS", help="its forward axis, as -Y")


def axes(arguments: argparse.Namespace) -> tuple[Array | None, Array | None]:
    """Return the up and forward axes that were given."""
    return axis(arguments.up) if arguments.up else None, axis(arguments.forward) if arguments.forward else None


def armature_here(text: str) -> bpy.types.Object | None:
    """Return the armature of the open file that is called ``text``, unless there is a file of that name."""
    if Path(text).exists() or any("\ud800" <= sign <= "\udfff" for sign in text):
        return None  # a file; one whose name is no Unicode would trip Blender up
    found = bpy.data.objects.get(text)
    return found if found is not None and found.type == "ARMATURE" else None


def open_rig(text: str, armature: str | None, fresh: bool = True) -> tuple[bpy.types.Object, str]:
    """Return an armature from a file or from the open file, and what to call it in messages.

    Args:
        text: A file, or the name of an armature in the open file.
        armature: Which armature, in files that hold several.
        fresh: Close what is open first; else a file is added to it.

    Raises:
        FileError: See `load.load` and `load.choose`.
    """
    here = armature_here(text)
    if here is not None:
        return here, text
    request = Request.parse(text)
    armatures = load.load(request) if fresh else load.add(request)
    return load.choose(armatures, request.path, armature), str(request.path)
