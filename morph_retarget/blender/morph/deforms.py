"""Deforms: scalar curves that drive shape keys and custom properties of the same name (Hecker 2008 §1.2)."""

import bpy

from ...core.play import Played
from ..rig import pose_bone
from .cast import Member


def show(member: Member, played: Played) -> None:
    """Give shape keys and custom properties that are called like a deform its value.

    A bone's own property counts for that bone; shape keys of the meshes that hang on the armature, and its object's
    properties, count for the mean of all bodies.
    """
    ob = member.rig.object
    means: dict[str, list[float]] = {}
    for (body, name), curve in played.deforms.items():
        bone = pose_bone(ob, member.rig.skeleton.names[body])
        means.setdefault(name, []).append(float(curve[0]))
        if name in bone:
            bone[name] = float(curve[0])
    for name, values in means.items():
        value = sum(values) / len(values)
        if name in ob:
            ob[name] = value
        for key in keys_of(ob, name):
            key.value = value


def keys_of(ob: bpy.types.Object, name: str) -> list[bpy.types.ShapeKey]:
    """Return the shape keys of a name on the meshes that hang on an armature."""
    meshes = [child.data for child in ob.children if isinstance(child.data, bpy.types.Mesh)]
    keys = [mesh.shape_keys for mesh in meshes if mesh.shape_keys is not None]
    return [own.key_blocks[name] for own in keys if name in own.key_blocks]
