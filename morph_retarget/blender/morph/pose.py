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
    bones, names = pose_of(rig.object).bones, rig.skeleton.names
    now: dict[str, Singles] = {}
    shown = [(int(rig.pose_order[bone]), i) for i, bone in enumerate(played.bones) if names[bone] not in but]
    still = np.zeros(3)  # an animator may have pulled a bone off its place
    rows: dict[str, list[tuple[int, Array]]] = {"location": [(place, still) for place, _ in shown]}
    for place, i in shown:
        if (owner := bones[place]).rotation_mode == "QUATERNION":
            prop, value = "rotation_quaternion", played.basis[0, i]
        else:
            channel = channels.rotation(owner, None, played.basis[:1, i])
            prop, value = channel.prop, channel.values[0]
        rows.setdefault(prop, []).append((place, value))
    moved = channels.location(rig, channels.movable(rig, played.root), played.shift[:1])
    if moved.bone not in but:
        place = int(rig.pose_order[rig.skeleton.index[moved.bone or ""]])
        rows.setdefault(moved.prop, []).append((place, moved.values[0]))
    for prop, given in rows.items():
        buffer = np.empty(len(bones) * _WIDTHS[prop], dtype=np.float32)
        bones.foreach_get(prop, buffer)
        buffer.reshape(len(bones), _WIDTHS[prop])[[place for place, _ in given]] = np.array([v for _, v in given])
        if rig.object.library is None:
            bones.foreach_set(prop, buffer)
        else:  # Blender sets linked data one by one alone
            for place, value in given:
                setattr(bones[place], prop, value)
        now[prop] = buffer
    rig.object.update_tag(refresh={"OBJECT"})
    return now


def rest(ob: bpy.types.Object, names: Collection[str]) -> None:
    """Put bones back to rest, as far as they are still there."""
    bones = pose_of(ob).bones
    for name in names:
        if name in bones:
            bones[name].matrix_basis.identity()
    if names:
        ob.update_tag(refresh={"OBJECT"})


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
