"""Rigs with controls: one that Blender's own add-on generates, and small ones of several families."""

from collections.abc import Callable
from pathlib import Path

import bpy
import numpy as np

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


def controlled(
    names: Callable[[str], str], controls: Callable[[str], str], *, shaped: bool = True, seed: int = 5
) -> bpy.types.Object:
    """Return a figure whose deform bones follow controls with rolls of their own.

    Args:
        names: Canonical joint to deform bone.
        controls: Canonical joint to control.
        shaped: Whether controls are drawn in shapes of their own.
        seed: Of the rolls of the controls.
    """
    ob = scenes.figure("Puppet", names=names, height=1.4)
    joints = {names(joint): joint for joint in _JOINTS if names(joint) in ob.data.bones}
    rng = np.random.default_rng(seed)
    bpy.context.view_layer.objects.active = ob
    bpy.ops.object.mode_set(mode="EDIT")
    edit = ob.data.edit_bones
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
    return ob


_JOINTS = [
    "hips", "spine", "chest", "upperChest", "neck", "head",
    *(f"{side}{joint}" for side in ("left", "right") for joints in LIMBS.values() for joint in joints),
    "leftShoulder", "rightShoulder", "leftToes", "rightToes",
]  # fmt: skip
