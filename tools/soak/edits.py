"""Random values for any property of ours, as a user may set them in a panel."""

import math
from collections.abc import Iterator
from random import Random
from typing import Any

import bpy

from morph_retarget.blender.morph.properties import of_action
from morph_retarget.blender.properties import of_rig, of_scene

WORDS = ("", "walk", "wave", "Head", "Hand.L", "Spine", "nobody", "left", "1, 2, 3", 'a "b" [c]', "😀", "../x")
KEPT = {"rna_type", "name", "version", "known_as", "keyed_in"}
"""Properties that are no user's."""
REACH = 5.0
"""Numbers without limits of their own are within this."""


def groups(rng: Random) -> list[bpy.types.PropertyGroup]:
    """Return groups of our properties on something of the open file."""
    owners: list[Any] = [of_scene(bpy.context.scene)]
    owners += [of_rig(ob) for ob in bpy.data.objects if ob.type == "ARMATURE" and not ob.name.startswith("Bystander")]
    owners += [of_action(action) for action in bpy.data.actions if len(of_action(action).channels)]
    return list(_below(rng.choice(owners)))


def _below(group: bpy.types.PropertyGroup) -> Iterator[bpy.types.PropertyGroup]:
    yield group
    for prop in group.bl_rna.properties:
        if prop.identifier == "rna_type":
            continue
        if prop.type == "POINTER" and isinstance(getattr(group, prop.identifier), bpy.types.PropertyGroup):
            yield from _below(getattr(group, prop.identifier))
        elif prop.type == "COLLECTION":
            for item in getattr(group, prop.identifier):
                yield from _below(item)


def edit(group: bpy.types.PropertyGroup, rng: Random) -> str:
    """Give one property of a group another value, and return which."""
    props = [prop for prop in group.bl_rna.properties if prop.identifier not in KEPT and not prop.is_readonly]
    props = [prop for prop in props if prop.type != "COLLECTION"]
    if not props:
        return "nothing"
    prop = rng.choice(props)
    found = _value(group, prop, rng)
    if found is not NotImplemented:
        setattr(group, prop.identifier, found)
    return f"{type(group).__name__}.{prop.identifier} = {found!r}"


def _value(group: bpy.types.PropertyGroup, prop: Any, rng: Random) -> Any:
    match prop.type:
        case "BOOLEAN":
            return not getattr(group, prop.identifier) if not prop.is_array else NotImplemented
        case "ENUM":
            names = [item.identifier for item in prop.enum_items]
            if not names:
                return NotImplemented  # told by a function
            return set(rng.sample(names, rng.randint(0, len(names)))) if prop.is_enum_flag else rng.choice(names)
        case "INT":
            return rng.randint(max(prop.soft_min, -50), min(prop.soft_max, 50))
        case "FLOAT":
            low, high = max(prop.soft_min, -REACH), min(prop.soft_max, REACH)
            number = lambda: rng.choice((low, high, 0.0 if low <= 0.0 <= high else low, rng.uniform(low, high)))  # noqa: E731
            return [number() for _ in range(prop.array_length)] if prop.is_array else number()
        case "STRING":
            return rng.choice(WORDS)
        case "POINTER":
            return _pointed(group, prop, rng)
        case _:
            return NotImplemented


def _pointed(group: bpy.types.PropertyGroup, prop: Any, rng: Random) -> Any:
    if isinstance(getattr(group, prop.identifier), bpy.types.PropertyGroup):
        return NotImplemented
    kinds = {"Object": bpy.data.objects, "Action": bpy.data.actions, "Collection": bpy.data.collections}
    found = list(kinds.get(prop.fixed_type.identifier, ()))
    usable = [item for item in found if not item.name.startswith("Bystander")]
    return rng.choice([None, *usable])


def number(rng: Random) -> float:
    """Return a frame, mostly one of the first hundred."""
    return rng.choice((rng.randint(-5, 100), rng.uniform(0.0, 100.0), rng.choice((-5000.0, 1e5, math.pi))))
