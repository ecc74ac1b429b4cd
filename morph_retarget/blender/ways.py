"""How objects move through the world, read from the keys on them and on what they hang on, without setting frames."""

import bpy
import numpy as np

from ..core import quat
from ..core.arrays import Array
from . import actions
from .actions import CurveMap
from .rig import Rig
from .sampling import own_rotation

_CHANNELS = ("location", "scale", "rotation_quaternion", "rotation_euler", "rotation_axis_angle")


def over(rig: Rig, frames: Array) -> Array | None:
    """Return how an armature object moves, None where no keys move it or what it hangs on.

    Constraints, drivers and NLA strips are not seen.

    Returns:
        Matrices that lead from its own space to that space as it was when it was analysed, shape (frame, 4, 4).
    """
    if not keyed(rig.object):
        return None
    place = np.eye(4)
    place[:3, :3] = rig.placement.scale * rig.placement.rotation
    place[:3, 3] = rig.placement.translation
    return np.linalg.inv(place) @ world(rig.object, frames)


def readable(ob: bpy.types.Object) -> bool:
    """Return whether nothing but keys moves an object and what it hangs on."""
    drivers = ob.animation_data.drivers if ob.animation_data is not None else ()
    others = {*(curve.data_path for curve in drivers), *actions.paths_in_strips(ob)}
    if len(ob.constraints) > 0 or any(path.removeprefix("delta_") in _CHANNELS for path in others):
        return False
    return ob.parent is None or (ob.parent_type == "OBJECT" and readable(ob.parent))


def world(ob: bpy.types.Object, frames: Array) -> Array:
    """Return an object's matrices as keys make them, shape (frame, 4, 4)."""
    found = _curves(ob)
    rotation, _ = own_rotation(ob, "", found, frames)
    basis = np.tile(np.eye(4), (len(frames), 1, 1))
    basis[:, :3, :3] = quat.to_matrix(np.broadcast_to(rotation, (len(frames), 4)))
    basis[:, :3, :3] *= _vector(found, "scale", frames, np.array(ob.scale))[:, None]
    basis[:, :3, 3] = _vector(found, "location", frames, np.array(ob.location))
    if ob.parent is None:
        return basis
    return world(ob.parent, frames) @ np.array(ob.matrix_parent_inverse, dtype=np.float64) @ basis


def keyed(ob: bpy.types.Object) -> bool:
    """Return whether keys move an object or what it hangs on."""
    return any(path in _CHANNELS for path, _ in _curves(ob)) or (ob.parent is not None and keyed(ob.parent))


def _curves(ob: bpy.types.Object) -> CurveMap:
    action, slot = actions.assigned(ob)
    return actions.curves(action, slot) if action is not None and slot is not None else {}


def _vector(found: CurveMap, path: str, frames: Array, now: Array) -> Array:
    values = actions.sample_vector(found, path, frames, now)
    return np.broadcast_to(now, (len(frames), 3)) if values is None else values
