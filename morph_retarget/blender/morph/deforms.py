"""Deforms: scalar curves that drive shape keys and custom properties of the same name (Hecker 2008 §1.2)."""

from collections.abc import Iterator
from typing import Any

import bpy

from ...core.play import Played
from ..rig import pose_bone, pose_of
from .member import Member

_Holder = bpy.types.PoseBone | bpy.types.Object | bpy.types.ShapeKey
"""What takes the value of a deform: one with a custom property of its name, or a shape key of that name."""
Given = tuple[_Holder, str, object]
"""What has got a value, from which deform, and what the value is now: shape keys keep to their limits."""


def show(member: Member, played: Played) -> list[Given]:
    """Give shape keys and custom properties that are called like a deform its value, and return what has got one.

    A bone's own property counts for that bone; shape keys of the meshes that hang on the armature, and its object's
    properties, count for the mean of all bodies.
    """
    given: list[Given] = []
    for holder, name, value in _taking(member, played):
        if isinstance(holder, bpy.types.ShapeKey):
            holder.value = value
        else:
            holder[name] = value
        given.append((holder, name, _value(holder, name)))
    return given


def holds(given: list[Given], graph: bpy.types.Depsgraph) -> bool:
    """Return whether all has the value that it was given, as it is and as it was evaluated."""
    return all(
        _value(holder, name) == value == _value(_evaluated(holder, graph), name) for holder, name, value in given
    )


def _taking(member: Member, played: Played) -> Iterator[tuple[_Holder, str, float]]:
    """Yield what takes the value of a deform, the deform's name, and the value."""
    if not played.deforms:
        return
    ob = member.rig.object
    means: dict[str, list[float]] = {}
    for (body, name), curve in played.deforms.items():
        bone = pose_bone(ob, member.rig.skeleton.names[body])
        means.setdefault(name, []).append(float(curve[0]))
        if name in bone:
            yield bone, name, float(curve[0])
    keys = _keys_of(ob)
    for name, values in means.items():
        value = sum(values) / len(values)
        if name in ob:
            yield ob, name, value
        for own in keys:
            if name in own.key_blocks:
                yield own.key_blocks[name], name, value


def _value(holder: _Holder, name: str) -> object:
    return holder.value if isinstance(holder, bpy.types.ShapeKey) else holder[name]


def _evaluated(holder: _Holder, graph: bpy.types.Depsgraph) -> _Holder:
    owner: Any = holder.id_data
    seen = owner.evaluated_get(graph)
    if isinstance(holder, bpy.types.ShapeKey):
        return seen.key_blocks[holder.name]
    return pose_of(seen).bones[holder.name] if isinstance(holder, bpy.types.PoseBone) else seen


def keys_of(ob: bpy.types.Object, name: str) -> list[bpy.types.ShapeKey]:
    """Return the shape keys of a name on the meshes that hang on an armature."""
    return [own.key_blocks[name] for own in _keys_of(ob) if name in own.key_blocks]


def _keys_of(ob: bpy.types.Object) -> list[bpy.types.Key]:
    """Return the shape keys of the meshes that hang on an armature."""
    if not bpy.data.shape_keys:  # Blender looks through all objects for children, and this is asked at each frame
        return []
    meshes = [child.data for child in ob.children if isinstance(child.data, bpy.types.Mesh)]
    return [mesh.shape_keys for mesh in meshes if mesh.shape_keys is not None]
