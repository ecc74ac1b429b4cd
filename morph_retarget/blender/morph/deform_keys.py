"""Deforms as keys: curves on custom properties, and on the shape keys of the meshes that hang on an armature."""

from collections.abc import Mapping

import bpy
import numpy as np

from ...core.arrays import Array
from ...core.play import Played
from .. import actions
from ..actions import Writer
from ..channels import Channel
from ..rig import pose_bone
from . import deforms
from .member import Member


def channels_of(member: Member, played: Played) -> list[Channel]:
    """Return the custom properties of bones and of the object that are called like a deform, over a clip."""
    ob, names = member.rig.object, member.rig.skeleton.names
    out = [
        Channel(names[body], _path(deform), curve[:, None])
        for (body, deform), curve in played.deforms.items()
        if deform in pose_bone(ob, names[body])
    ]
    return out + [Channel(None, _path(name), mean[:, None]) for name, mean in means(played).items() if name in ob]


def _path(name: str) -> str:
    return f'["{bpy.utils.escape_identifier(name)}"]'


def means(played: Played) -> Mapping[str, Array]:
    """Return the mean of each deform over all bodies that have it, shapes (frame,)."""
    found: dict[str, list[Array]] = {}
    for (_, name), curve in played.deforms.items():
        found.setdefault(name, []).append(curve)
    return {name: np.mean(curves, axis=0) for name, curves in found.items()}


def write(member: Member, played: Played, frames: Array, name: str) -> list[bpy.types.Action]:
    """Key the shape keys that are called like a deform, in a new action for the keys of each mesh; return these.

    What an old action does to other shape keys is taken over; the old action is left as it is.
    """
    wanted: dict[bpy.types.Key, list[tuple[bpy.types.ShapeKey, Array]]] = {}
    for deform, mean in means(played).items():
        for block in deforms.keys_of(member.rig.object, deform):
            assert isinstance(block.id_data, bpy.types.Key), "shape keys belong to the keys of a mesh"
            wanted.setdefault(block.id_data, []).append((block, mean))
    return [_write(owner, pairs, frames, name) for owner, pairs in wanted.items()]


def _write(
    owner: bpy.types.Key, pairs: list[tuple[bpy.types.ShapeKey, Array]], frames: Array, name: str
) -> bpy.types.Action:
    old, slot = actions.assigned(owner)
    writer = Writer(name, owner)
    written: set[str] = set()
    for block, mean in pairs:
        path = block.path_from_id("value")
        writer.write(path, mean[:, None], frames, block.name)
        written.add(path)
    for (path, _), curve in (actions.curves(old, slot) if old and slot else {}).items():
        if path not in written:
            writer.copy(curve)
    writer.limit(frames[0], frames[-1])
    actions.play(owner, writer.action, writer.slot)
    if old is not None and old.users == 0:
        old.use_fake_user = True
    return writer.action
