"""Joint limits as Blender keeps them: what its inverse kinematics know of each pose bone."""

import bpy
import numpy as np

from ..core.arrays import Array, Flags
from ..core.solve.limits import JointLimits
from .rig import Rig, pose_of

_AXES = "xyz"


def read(ob: bpy.types.Object, rig: Rig) -> JointLimits | None:
    """Return the limits of an armature's bones, as its skeleton has them, None when nothing limits any."""
    limited, locked = _flags(ob, "use_ik_limit_"), _flags(ob, "lock_ik_")
    if not (limited.any() or locked.any()):
        return None
    order = rig.pose_order
    return JointLimits.of(limited[order], locked[order], _ranges(ob, "ik_min_")[order], _ranges(ob, "ik_max_")[order])


def state(ob: bpy.types.Object) -> bytes:
    """Return what tells whether the limits of an armature have been edited: the ranges only where some count."""
    flags = [_flags(ob, "use_ik_limit_"), _flags(ob, "lock_ik_")]
    ranges = [_ranges(ob, name) for name in ("ik_min_", "ik_max_")] if flags[0].any() else []
    return b"".join(part.tobytes() for part in (*flags, *ranges))


def _flags(ob: bpy.types.Object, name: str) -> Flags:
    """Return a flag of all pose bones for each axis, shape (bone, 3)."""
    bones = pose_of(ob).bones
    out = np.empty((3, len(bones)), dtype=np.bool_)
    for values, axis in zip(out, _AXES, strict=True):
        bones.foreach_get(name + axis, values)
    return out.T


def _ranges(ob: bpy.types.Object, name: str) -> Array:
    """Return angles of all pose bones for each axis [rad], shape (bone, 3)."""
    bones = pose_of(ob).bones
    out = np.empty((3, len(bones)), dtype=np.float32)
    for values, axis in zip(out, _AXES, strict=True):
        bones.foreach_get(name + axis, values)
    return out.T.astype(np.float64)
