"""Rigs with controls: one that Blender's own add-on generates, and small ones of several families."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np
from mathutils import Vector

from morph_retarget.blender.io import addons
from tests.blender import scenes

LIMBS = {
    "arm": ("UpperArm", "LowerArm", "Hand"),
    "leg": ("UpperLeg", "LowerLeg", "Foot"),
}


def rigify(path: Path, kind: str = "basic_human") -> Path:
    """Write a file with a rig that Rigify has generated, and return it."""
    addons.enable("rigify")
    scenes.empty()
    getattr(bpy.ops.object, f"armature_{kind}_metarig_add")()
    metarig = bpy.context.object
    bpy.ops.pose.rigify_generate()
    bpy.data.objects.remove(metarig)
    return scenes.save(path)


@dataclass(frozen=True)
class Reach:
    """How the limbs of a figure are brought to places besides; each name is made from that of a joint."""

    control: Callable[[str], str]
    """Of the end of a limb."""
    pole: Callable[[str], str]
    """Of what its middle joint points to, from its upper joint."""
    holder: Callable[[str], str] | None = None
    """Who holds the switch, from the end; None without a switch: inverse kinematics always counts then."""
    prop: Callable[[str], str] = str
    """The switch, from the end."""
    turned: float = 0.0
    """Its value for forward kinematics."""


def controlled(
    names: Callable[[str], str],
    controls: Callable[[str], str],
    *,
    shaped: bool = True,
    seed: int = 5,
    reach: Reach | None = None,
) -> bpy.types.Object:
    """Return a figure whose deform bones follow controls with rolls of their own.

    Args:
        names: Canonical joint to deform bone.
        controls: Canonical joint to control.
        shaped: Whether controls are drawn in shapes of their own.
        seed: Of the rolls of the controls.
        reach: How limbs are brought to places, None where they cannot be.
    """
    ob = scenes.figure("Puppet", names=names, height=1.4)
    joints = {names(joint): joint for joint in _JOINTS if names(joint) in ob.data.bones}
    rng = np.random.default_rng(seed)
    bpy.context.view_layer.objects.active = ob
    bpy.ops.object.mode_set(mode="EDIT")
    edit = ob.data.edit_bones
    for upper, middle, _ in _limbs() if reach else ():
        knee = edit[names(middle)].head.copy()
        knee.y += 0.02 if "Arm" in upper else -0.02
        edit[names(upper)].tail = edit[names(middle)].head = knee
    for bone in [edit[name] for name in joints]:
        made, held = edit.new(controls(joints[bone.name])), edit.new(f"MCH-{bone.name}")
        made.head, made.tail, made.roll = bone.head, bone.tail, bone.roll + rng.uniform(-3.0, 3.0)
        held.head, held.tail, held.roll = bone.head, bone.tail, bone.roll
        held.parent = made
        made.use_deform = held.use_deform = False
    for name, joint in joints.items():
        above = edit[name].parent
        if above is not None and above.name in joints:
            edit[controls(joint)].parent = edit[controls(joints[above.name])]
    bpy.ops.object.mode_set(mode="OBJECT")
    shape = scenes.empty_object("Shape") if shaped else None
    for name, joint in joints.items():
        constraint = ob.pose.bones[name].constraints.new("COPY_TRANSFORMS")
        constraint.target, constraint.subtarget = ob, f"MCH-{name}"
        ob.pose.bones[controls(joint)].custom_shape = shape
        ob.pose.bones[name].bone.use_deform = True
    for limb in _limbs() if reach else ():
        _let_reach(ob, limb, names, controls, reach)
    for joint in ("leftHand", "rightHand", "leftFoot", "rightFoot") if reach else ():
        ob.pose.bones[reach.control(joint)].custom_shape = shape
    return ob


def _limbs() -> list[tuple[str, ...]]:
    return [tuple(side + joint for joint in joints) for side in ("left", "right") for joints in LIMBS.values()]


def _let_reach(
    ob: bpy.types.Object,
    limb: tuple[str, ...],
    names: Callable[[str], str],
    controls: Callable[[str], str],
    reach: Reach,
) -> None:
    """Give a limb a mechanism of inverse kinematics beside the one that turns it."""
    upper, middle, end = limb
    mechanism = [f"IKM-{names(joint)}" for joint in limb]
    bpy.ops.object.mode_set(mode="EDIT")
    edit = ob.data.edit_bones
    places = [(edit[names(j)].head.copy(), edit[names(j)].tail.copy(), edit[names(j)].roll) for j in limb]
    control, pole = reach.control(end), reach.pole(upper)
    for name, (head, tail, roll) in zip([*mechanism, control], [*places, places[2]], strict=True):
        made = edit.new(name)
        made.head, made.tail, made.roll = head, tail, roll
    away = (edit[names(middle)].head - (places[0][0] + places[2][0]) / 2).normalized() * 0.4
    made = edit.new(pole)
    made.head = edit[names(middle)].head + away
    made.tail = made.head + away * 0.2
    holder = None if reach.holder is None else reach.holder(end)
    if holder is not None and holder not in edit:
        edit.new(holder).tail = (0.0, 0.0, 0.1)
        edit[holder].use_deform = False
    edit[mechanism[0]].parent = edit[controls(upper)].parent
    edit[mechanism[1]].parent = edit[mechanism[0]]
    edit[mechanism[2]].parent = edit[control]
    toes = end.replace("Foot", "Toes")
    if toes != end and controls(toes) in edit:
        edit[controls(toes)].parent = edit[names(end)]
    for name in (*mechanism, control, pole):
        edit[name].use_deform = False
    bpy.ops.object.mode_set(mode="OBJECT")
    _aim(ob, mechanism, mechanism[2], pole)
    for joint, name in zip(limb, mechanism, strict=True):
        constraint = ob.pose.bones[names(joint)].constraints.new("COPY_TRANSFORMS")
        constraint.target, constraint.subtarget = ob, name
        if holder is not None:
            _drive(ob, constraint, ob.pose.bones[holder], reach.prop(end), reach.turned)


def pull(ob: bpy.types.Object, limb: tuple[str, str, str], control: str, pole: str) -> None:
    """Let inverse kinematics pose the bones of a limb themselves; the end turns as the control does."""
    bpy.ops.object.mode_set(mode="EDIT")
    edit = ob.data.edit_bones
    upper, middle, end = (edit[name] for name in limb)
    upper.tail = middle.head = middle.head + Vector((0.0, -0.02, 0.0))
    made, aim = edit.new(control), edit.new(pole)
    made.head, made.tail = end.head, end.tail
    aim.head, aim.tail = middle.head + Vector((0.0, -0.4, 0.0)), middle.head + Vector((0.0, -0.5, 0.0))
    made.use_deform = aim.use_deform = False
    bpy.ops.object.mode_set(mode="OBJECT")
    _aim(ob, limb, control, pole)
    turn = ob.pose.bones[limb[2]].constraints.new("COPY_ROTATION")
    turn.target, turn.subtarget = ob, control


def _aim(ob: bpy.types.Object, limb: Sequence[str], control: str, pole: str) -> None:
    """Let inverse kinematics bring the first two bones of a limb to a control, as they lie at rest."""
    bones = ob.data.bones
    first, start = bones[limb[0]], bones[limb[0]].head_local
    across = (bones[control].head_local - start).cross(bones[pole].head_local - start).cross(first.y_axis)
    angle = first.x_axis.angle(across)
    angle = -angle if first.x_axis.cross(across).angle(first.y_axis) < 1.0 else angle
    found = ob.pose.bones[limb[1]].constraints.new("IK")
    found.target, found.subtarget, found.chain_count = ob, control, 2
    found.pole_target, found.pole_subtarget, found.pole_angle = ob, pole, angle


def _drive(
    ob: bpy.types.Object, constraint: bpy.types.Constraint, holder: bpy.types.PoseBone, prop: str, turned: float
) -> None:
    """Let a custom property of a bone, which is at ``turned`` now, switch a constraint on elsewhere."""
    holder[prop] = turned
    driver = constraint.driver_add("influence").driver
    driver.type = "SCRIPTED"
    read = driver.variables.new()
    read.name, read.targets[0].id = "switch", ob
    read.targets[0].data_path = f'{holder.path_from_id()}["{prop}"]'
    driver.expression = "switch" if turned == 0.0 else "1 - switch"


_JOINTS = [
    "hips", "spine", "chest", "upperChest", "neck", "head",
    *(f"{side}{joint}" for side in ("left", "right") for joints in LIMBS.values() for joint in joints),
    "leftShoulder", "rightShoulder", "leftToes", "rightToes",
]  # fmt: skip
