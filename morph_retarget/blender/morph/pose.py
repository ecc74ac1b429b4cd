"""Writing a played pose to pose bones, in the rotation modes that they have."""

from collections.abc import Collection

import bpy
import numpy as np
from numpy.typing import NDArray

from ...core.arrays import Array
from ...core.play import Played
from .. import channels
from ..channels import Channel
from ..rig import Rig, pose_bone, pose_of, rotations_of

Singles = NDArray[np.float32]
_WIDTHS = {"rotation_quaternion": 4, "rotation_euler": 3, "rotation_axis_angle": 4, "location": 3}


def channels_of(rig: Rig, played: Played) -> list[Channel]:
    """Return a played clip as values of the bones' properties."""
    names = rig.skeleton.names
    out = [
        channels.rotation(pose_bone(rig.object, names[bone]), names[bone], played.basis[:, i])
        for i, bone in enumerate(played.bones)
    ]
    out.append(channels.location(rig, channels.movable(rig, played.root), played.shift))
    return out


def show(rig: Rig, played: Played, but: Collection[str] = ()) -> dict[str, Singles]:
    """Put the first frame of a played clip on an armature, and return what its bones' properties are now.

    Args:
        rig: The armature.
        played: The clip.
        but: Bones to leave as they are.
    """
    found = [channel for channel in channels_of(rig, played) if channel.bone not in but]
    bones = pose_of(rig.object).bones
    place = {name: int(i) for name, i in zip(rig.skeleton.names, rig.pose_order, strict=True)}
    now: dict[str, Singles] = {}
    for name in dict.fromkeys(channel.prop for channel in found):
        width = _WIDTHS[name]
        own = [channel for channel in found if channel.prop == name]
        buffer = np.empty(len(bones) * width, dtype=np.float32)
        bones.foreach_get(name, buffer)
        rows = buffer.reshape(len(bones), width)
        rows[[place[channel.bone or ""] for channel in own]] = np.stack([channel.values[0] for channel in own])
        bones.foreach_set(name, buffer)
        now[name] = buffer
    rig.object.update_tag(refresh={"OBJECT"})
    return now


def state(rig: Rig, names: Collection[str]) -> dict[str, Singles]:
    """Return properties of all bones as they are."""
    bones = pose_of(rig.object).bones
    out: dict[str, Singles] = {}
    for name in names:
        out[name] = np.empty(len(bones) * _WIDTHS[name], dtype=np.float32)
        bones.foreach_get(name, out[name])
    return out


def changed(before: dict[str, Singles], now: dict[str, Singles], bone: int) -> bool:
    """Return whether a bone, by its place among the pose bones, has other properties than before."""
    return any(
        np.abs(before[name].reshape(-1, _WIDTHS[name])[bone] - values.reshape(-1, _WIDTHS[name])[bone]).max() > 1e-6
        for name, values in now.items()
        if name in before
    )


def matrix_of(ob: bpy.types.Object, bone: str) -> tuple[Array, Array]:
    """Return where a bone's head is and how far the bone is turned from rest, armature space, (3,) and (4,)."""
    matrix = np.array(pose_of(ob).bones[bone].matrix, dtype=np.float64)
    return matrix[:3, 3], rotations_of(matrix[:3, :3])
