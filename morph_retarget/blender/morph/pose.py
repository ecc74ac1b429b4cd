"""Writing a played pose to pose bones, in the rotation modes that they have."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Self

import bpy
import numpy as np
from numpy.typing import NDArray

from ...core.arrays import Array, Indices
from ...core.play import Played
from .. import channels
from ..channels import Channel
from ..rig import Rig, pose_bone, pose_of, rotations_of

Singles = NDArray[np.float32]
_WIDTHS = {"rotation_quaternion": 4, "rotation_euler": 3, "rotation_axis_angle": 4, "location": 3}


_MODES: Any = bpy.types.PoseBone.bl_rna.properties["rotation_mode"]
_QUATERNION: int = _MODES.enum_items["QUATERNION"].value
"""How Blender numbers that rotation mode."""


def channels_of(rig: Rig, played: Played) -> list[Channel]:
    """Return a played clip as values of the bones' properties."""
    names = rig.skeleton.names
    out = [
        channels.rotation(pose_bone(rig.object, names[bone]), names[bone], played.basis[:, i])
        for i, bone in enumerate(played.bones)
    ]
    out.append(channels.location(rig, channels.movable(rig, played.root), played.shift))
    return out + [channel for channel in _stretched(rig, played) if channel.values.any()]


def _stretched(rig: Rig, played: Played) -> list[Channel]:
    """Return the locations of bones that are moved off their parents where these have stretched."""
    own = played.stretched
    if own is None:
        return []
    return [channels.location(rig, bone, own.shifts[:, i]) for i, bone in enumerate(own.bones.tolist())]


@dataclass(frozen=True, eq=False)
class Setting:
    """What one frame sets on pose bones."""

    bones: frozenset[str]
    """Names of the bones that the frame turns, those that are left as they are among them."""
    rows: Mapping[str, tuple[Indices, Singles]]
    """By property: places among the numbers of all pose bones, and values, shapes (n * width,)."""

    @classmethod
    def of(cls, rig: Rig, played: Played, but: Collection[str] = ()) -> Self:
        """Return the first frame of a played clip, in the rotation modes that the bones have.

        Args:
            rig: The armature.
            played: The clip.
            but: Bones to leave as they are.
        """
        bones, names = pose_of(rig.object).bones, rig.skeleton.names
        rows = [i for i, bone in enumerate(played.bones) if names[bone] not in but] if but else range(len(played.bones))
        places, basis = rig.pose_order[played.bones[rows]], played.basis[:1, rows]
        by_quaternion = np.frombuffer(modes(rig.object), dtype=np.int32)[places] == _QUATERNION
        quaternions = np.flatnonzero(by_quaternion)
        others: dict[str, list[tuple[int, Array]]] = {}
        for i in np.flatnonzero(~by_quaternion).tolist():
            channel = channels.rotation(bones[places[i]], None, basis[:, i])
            others.setdefault(channel.prop, []).append((int(places[i]), channel.values[0]))
        moved = [channels.location(rig, channels.movable(rig, played.root), played.shift[:1])]
        moved = [own for own in (*moved, *_stretched(rig, played)) if own.bone not in but]
        at = [rig.pose_order[rig.skeleton.index[own.bone or ""]] for own in moved]
        # An animator may have pulled a bone off its place.
        still = np.zeros((len(places) + len(at), 3))
        for i, own in enumerate(moved, len(places)):
            still[i] = own.values[0]
        out = {"location": _row("location", np.append(places, at).astype(np.intp), still)}
        if len(quaternions):
            out["rotation_quaternion"] = _row("rotation_quaternion", places[quaternions], basis[0, quaternions])
        for prop, given in others.items():
            out[prop] = _row(prop, np.array([place for place, _ in given]), np.array([value for _, value in given]))
        return cls(frozenset([names[bone] for bone in played.bones.tolist()]), out)

    @classmethod
    def on(cls, rig: Rig, found: Sequence[Channel], but: Collection[str] = ()) -> Self:
        """Return what the first frame of channels sets, but for bones to leave as they are."""
        by_prop: dict[str, list[tuple[int, Array]]] = {}
        for channel in found:
            assert channel.bone is not None, "characters pose bones"
            if channel.bone in but:
                continue
            place = int(rig.pose_order[rig.skeleton.index[channel.bone]])
            by_prop.setdefault(channel.prop, []).append((place, channel.values[0]))
        rows = {
            prop: _row(prop, np.array([place for place, _ in given]), np.array([values for _, values in given]))
            for prop, given in by_prop.items()
        }
        return cls(frozenset(channel.bone or "" for channel in found), rows)


def _row(prop: str, places: Indices, values: Array) -> tuple[Indices, Singles]:
    """Return a property of bones by its single numbers, which NumPy puts in place much faster than rows."""
    width = _WIDTHS[prop]
    return (places[:, None] * width + np.arange(width)).ravel(), values.astype(np.float32).ravel()


def modes(ob: bpy.types.Object) -> bytes:
    """Return the rotation modes of all pose bones, to see whether they have changed."""
    bones = pose_of(ob).bones
    codes = np.empty(len(bones), dtype=np.int32)
    bones.foreach_get("rotation_mode", codes)
    return codes.tobytes()


def show(ob: bpy.types.Object, setting: Setting) -> dict[str, Singles]:
    """Put a frame on an armature, and return what its bones' properties are now."""
    bones = pose_of(ob).bones
    now: dict[str, Singles] = {}
    for prop, (places, values) in setting.rows.items():
        width = _WIDTHS[prop]
        buffer = now[prop] = np.empty(len(bones) * width, dtype=np.float32)
        bones.foreach_get(prop, buffer)
        buffer[places] = values
        if ob.library is None:
            bones.foreach_set(prop, buffer)
        else:  # Blender sets linked data one by one alone
            for start in places[::width].tolist():
                setattr(bones[start // width], prop, buffer[start : start + width])
    ob.update_tag(refresh={"OBJECT"})
    return now


def basis(ob: bpy.types.Object) -> bytes:
    """Return how all bones are turned, moved and scaled from rest, whatever their rotation modes, to compare it."""
    bones = pose_of(ob).bones
    matrices = np.empty(len(bones) * 16, dtype=np.float32)
    bones.foreach_get("matrix_basis", matrices)
    return matrices.tobytes()


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
