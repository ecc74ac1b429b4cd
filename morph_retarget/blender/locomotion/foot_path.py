"""Foot paths: the flight of a foot as F-curves that an animator draws (Hecker 2008 §4.2).

An empty carries them. Its action is the flight, whatever it lasts: the foot lifts off at frame 0 and touches down at
frame 100. It knows no sizes, so one path serves legs of any length.
"""

from functools import lru_cache

import bpy
import numpy as np

from ...core.arrays import Array
from ...core.errors import MotionError
from ...core.locomotion.foot_path import ARC, SAMPLES, FootPath, drawn
from .. import actions
from ..actions import Writer

LIFT_OFF, TOUCH_DOWN = 0.0, 100.0
"""Frames of the action at which a foot leaves the ground and comes to it again."""
CURVES = {
    "way": ("location", 1),
    "height": ("location", 2),
    "side": ("location", 0),
    "pitch": ("rotation_euler", 0),
}
"""What the curves mean, in the order of `drawn`: their data paths and components."""
WAY_KEYS = (0.0, 25.0, 75.0, 100.0)
"""Frames of the keys that draw the way of an ordinary flight, to 1 % …"""
HEIGHT_KEYS = (0.0, 10.0, 25.0, 45.0, 68.0, 87.0, 100.0)
"""… and those that draw its height."""
OTHER_KEYS = (0.0, 50.0, 100.0)
"""Frames of the keys of what an ordinary flight leaves alone."""
BESIDE = 0.75
"""A new path stands to the left of its character by this share of its size."""


def of(ob: bpy.types.Object) -> FootPath:
    """Return the flight that an object's curves draw; curves that are alike give the same.

    Raises:
        MotionError: It has no keys, none for the way, or the curves draw no flight.
    """
    action, slot = actions.assigned(ob)
    found = actions.curves(action, slot) if action is not None and slot is not None else {}
    if not any(curve in found for curve in CURVES.values()):
        raise MotionError(
            f"foot path {ob.name!r} has no keys: key its location from frame 0 to 100, or choose another object"
        )
    if CURVES["way"] not in found:
        raise MotionError(f"foot path {ob.name!r} has no curve for its way: key its Y location from 0 to 1")
    turned = any(path in {"rotation_quaternion", "rotation_axis_angle"} for path, _ in found)
    if turned and ob.rotation_mode in {"QUATERNION", "AXIS_ANGLE"}:
        raise MotionError(f"foot path {ob.name!r} is not turned by angles: set its rotation mode to XYZ Euler")
    frames = np.linspace(LIFT_OFF, TOUCH_DOWN, SAMPLES)
    flat = np.zeros(SAMPLES)
    rows = [actions.sample(found[curve], frames) if curve in found else flat for curve in CURVES.values()]
    try:
        return _of_rows(np.stack(rows).tobytes())
    except MotionError as error:
        raise MotionError(f"foot path {ob.name!r}: {error}") from error


@lru_cache(maxsize=64)
def _of_rows(rows: bytes) -> FootPath:
    """Return the flight of sampled curves. Whoever compares settings sees by its identity that nothing has changed."""
    return drawn(*np.frombuffer(rows, dtype=np.float64).reshape(len(CURVES), SAMPLES))


def new(ob: bpy.types.Object, scene: bpy.types.Scene) -> bpy.types.Object:
    """Return a new foot path of a character, which draws the flight that feet have without one.

    Args:
        ob: The character; its path stands beside it.
        scene: The path becomes part of it.
    """
    empty = bpy.data.objects.new(f"{ob.name}: Foot Path", None)
    empty.empty_display_type, empty.empty_display_size = "SPHERE", 0.05
    # Keys say where it is; what brings it near is no part of them.
    empty.delta_location = ob.matrix_world.translation
    empty.delta_location.x += BESIDE * ob.dimensions.length
    writer = Writer(empty.name, empty)
    _draw(writer, "way", WAY_KEYS, ARC.along)
    _draw(writer, "height", HEIGHT_KEYS, ARC.up)
    _draw(writer, "side", OTHER_KEYS, ARC.side)
    _draw(writer, "pitch", OTHER_KEYS, ARC.pitch)
    actions.assign(empty, writer.action, writer.slot)
    scene.collection.objects.link(empty)
    return empty


def _draw(writer: Writer, name: str, keys: tuple[float, ...], values: Array) -> None:
    """Draw one curve of a flight through its values at some frames."""
    every, frames = np.linspace(LIFT_OFF, TOUCH_DOWN, SAMPLES), np.array(keys)
    slopes = np.gradient(values, every, edge_order=2)
    path, index = CURVES[name]
    writer.draw(path, index, frames, np.interp(frames, every, values), np.interp(frames, every, slopes), "Foot Path")


def remove(ob: bpy.types.Object) -> None:
    """Delete a foot path with its action, unless something else than a scene still uses them."""
    users = bpy.data.user_map(subset=[ob])[ob]
    if ob.library is not None or any(not isinstance(user, bpy.types.Collection | bpy.types.Scene) for user in users):
        return
    action, _ = actions.assigned(ob)
    bpy.data.objects.remove(ob)
    if action is not None and action.users == 0 and action.library is None:
        bpy.data.actions.remove(action)
