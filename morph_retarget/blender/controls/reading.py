"""Control rigs as plain data: names, shapes, constraints, and by which properties drivers switch these."""

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence

import bpy
import numpy as np

from ...core import euler
from ...core.character.control_facts import BoneFacts, Follows
from ...core.mocap.copying import Copy
from ..channels import Channel
from ..rig import pose_bone, pose_of
from .evaluating import Stage

_LOW, _HIGH = 0.0, 1.0
_COUNTS = ("influence", "mute", "enabled")
Switch = tuple[str, str]
"""Bone and custom property."""


def facts(stage: Stage) -> list[BoneFacts]:
    """Return what a rig is made of."""
    ob = stage.rig.object
    switches = _switches(ob)
    counts = _counts(stage, switches)
    out: list[BoneFacts] = []
    for bone in pose_of(ob).bones:
        follows = [
            Follows(
                constraint.type,
                targets(ob, constraint),
                switches.get((bone.name, constraint.name)),
                counts[bone.name, constraint.name],
                (_LOW, _HIGH),
                "LOCAL" in constraint.owner_space,
                _pole(ob, constraint),
            )
            for constraint in bone.constraints
            if (bone.name, constraint.name) in counts
        ]
        parent = bone.parent.name if bone.parent else None
        shaped = bone.custom_shape is not None
        out.append(BoneFacts(bone.name, parent, bone.bone.use_deform, shaped, tuple(follows), _numbers(bone)))
    return out


def has_constraints(ob: bpy.types.Object) -> bool:
    """Return whether any deform bone of an armature follows others, as in rigs with controls."""
    return any(bone.bone.use_deform and len(bone.constraints) > 0 for bone in pose_of(ob).bones)


def _numbers(bone: bpy.types.PoseBone) -> tuple[str, ...]:
    return tuple(name for name, value in bone.items() if isinstance(value, int | float))


def targets(ob: bpy.types.Object, constraint: bpy.types.Constraint) -> tuple[str, ...]:
    """Return the bones of the same armature that a constraint looks at."""
    several = getattr(constraint, "targets", None)
    found = [getattr(one, "subtarget", "") for one in (several or (constraint,)) if getattr(one, "target", None) == ob]
    return tuple(name for name in found if name)


def _pole(ob: bpy.types.Object, constraint: bpy.types.Constraint) -> str | None:
    """Return the bone of the same armature that the middle joint of inverse kinematics points to."""
    own = isinstance(constraint, bpy.types.KinematicConstraint) and constraint.pole_target == ob
    return (constraint.pole_subtarget or None) if own else None  # type: ignore[union-attr]


def _switches(ob: bpy.types.Object) -> dict[tuple[str, str], Switch]:
    """Return the custom property that drives how far a constraint counts, by bone and constraint."""
    owners: dict[str, Switch] = {}
    for bone in pose_of(ob).bones:
        for name in _numbers(bone):
            owners[path(bone, name)] = bone.name, name
    places = {
        f"{constraint.path_from_id()}.{prop}": (bone.name, constraint.name)
        for bone in pose_of(ob).bones
        for constraint in bone.constraints
        for prop in _COUNTS
    }
    curves = ob.animation_data.drivers if ob.animation_data else ()
    reads = {curve.data_path: own for curve in curves if (own := _reads(curve, owners)) is not None}
    out: dict[tuple[str, str], Switch] = {}
    for driven, place in places.items():
        source, seen = reads.get(driven), {driven}
        while source is not None and source in reads and source not in seen:  # it is driven itself
            seen.add(source)
            source = reads[source]
        if source is not None:
            out[place] = owners[source]
    return out


def _reads(curve: bpy.types.FCurve, owners: Mapping[str, Switch]) -> str | None:
    """Return the data path of the first custom property of a bone that a driver reads."""
    variables = [] if curve.driver is None else list(curve.driver.variables)
    paths = [target.data_path for variable in variables for target in variable.targets]
    return next((path for path in paths if path in owners), None)


def path(bone: bpy.types.PoseBone, prop: str) -> str:
    """Return the data path of a custom property of a bone."""
    return f'{bone.path_from_id()}["{bpy.utils.escape_identifier(prop)}"]'


def _counts(stage: Stage, switches: Mapping[tuple[str, str], Switch]) -> dict[tuple[str, str], tuple[float, float]]:
    """Return how far constraints count with all switches low and with all high; Blender evaluates the drivers."""
    found: dict[tuple[str, str], list[float]] = defaultdict(list)
    frames = np.array([1.0, 2.0])
    values = np.array([[_LOW], [_HIGH]])
    stage.show([setting(bone, prop, values) for bone, prop in dict.fromkeys(switches.values())], frames)
    for frame in frames:
        for bone in pose_of(stage.at(frame)).bones:
            for constraint in bone.constraints:
                off = constraint.mute or not constraint.enabled
                found[bone.name, constraint.name].append(0.0 if off else constraint.influence)
    return {place: (low, high) for place, (low, high) in found.items() if low > 0.0 or high > 0.0}


def copies(ob: bpy.types.Object, names: Sequence[str]) -> dict[int, Copy]:
    """Return which of some bones copy the local turns of others among them before their own, by their places.

    Args:
        ob: The armature, evaluated with its switches set.
        names: The bones.
    """
    place, out = {name: i for i, name in enumerate(names)}, dict[int, Copy]()
    for name, i in place.items():
        bone = pose_bone(ob, name)
        for constraint in _copying(bone):
            source = next((place[other] for other in targets(ob, constraint) if other in place), None)
            is_local = constraint.owner_space == constraint.target_space == "LOCAL"
            is_inverted = constraint.invert_x or constraint.invert_y or constraint.invert_z
            if source is not None and is_local and not is_inverted and constraint.mix_mode == "BEFORE":
                axes = constraint.use_x, constraint.use_y, constraint.use_z
                out[i] = Copy(source, axes, _order(bone, constraint))
    return out


def turns_along(ob: bpy.types.Object, name: str, carrier: str) -> bool:
    """Return whether a bone turns as what carries it does: not where a mechanism between them copies another's turn.

    Args:
        ob: The armature, evaluated with its switches set.
        name: The bone.
        carrier: The bone that carries it.
    """
    bone = pose_bone(ob, name).parent
    while bone is not None and bone.name != carrier:
        whole = (c for c in _copying(bone) if c.mix_mode == "REPLACE" and c.use_x and c.use_y and c.use_z)
        copied = (constraint for constraint in whole if "LOCAL" not in constraint.owner_space)
        if any(carrier not in targets(ob, constraint) for constraint in copied):
            return False
        bone = bone.parent
    return True


def _copying(bone: bpy.types.PoseBone) -> Iterator[bpy.types.CopyRotationConstraint]:
    """Yield the constraints by which a bone copies turns in full."""
    for constraint in bone.constraints:
        counts = constraint.enabled and not constraint.mute and constraint.influence == 1.0
        if counts and isinstance(constraint, bpy.types.CopyRotationConstraint):
            yield constraint


def _order(bone: bpy.types.PoseBone, constraint: bpy.types.CopyRotationConstraint) -> str:
    """Return the order of the Euler angles that a bone copies: its own, unless the constraint says otherwise."""
    order = bone.rotation_mode if constraint.euler_order == "AUTO" else constraint.euler_order
    return order if order in euler.ORDERS else euler.ORDERS[0]


def setting(bone: str, prop: str, values: np.ndarray) -> Channel:
    """Return a custom property of a bone as a channel, values of shape (frame, 1)."""
    return Channel(bone, f'["{bpy.utils.escape_identifier(prop)}"]', values)


def value(ob: bpy.types.Object, channel: Channel) -> float:
    """Return what the custom property of a bone holds that `setting` has made a channel of."""
    return float(pose_bone(ob, channel.bone or "")[_name(channel)])


def switch(ob: bpy.types.Object, channel: Channel) -> None:
    """Give the custom property of a bone the first value of a channel that `setting` has made."""
    bone, name = pose_bone(ob, channel.bone or ""), _name(channel)
    bone[name] = type(bone[name])(channel.values[0, 0])


def _name(channel: Channel) -> str:
    return bpy.utils.unescape_identifier(channel.prop[2:-2])
