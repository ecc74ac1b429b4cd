"""A transferred motion as values of Blender's own properties: what keys hold and what the live pose shows."""

from collections.abc import Container, Iterable
from dataclasses import dataclass

import bpy
import numpy as np

from ..core import euler, quat
from ..core.arrays import Array
from ..core.character.character import Character
from ..core.character.frame import Placement
from ..core.errors import RigError
from ..core.mocap.root_motion import RootMotion, Travel
from ..core.pipeline import Result
from .rig import Rig, pose_bone, rotations_of

OFF_REST = 1e-6
"""A channel farther than this from its neutral value shows."""
ROTATIONS = ("rotation_quaternion", "rotation_euler", "rotation_axis_angle")


@dataclass(frozen=True, eq=False)
class Channel:
    """One vector property over a clip."""

    bone: str | None
    """Name of the pose bone, None for the object itself."""
    prop: str
    """"location", "rotation_quaternion" and so on; a custom property as ``["name"]``, its name escaped."""
    values: Array
    """Shape (frame, component)."""

    def path(self, ob: bpy.types.Object) -> str:
        """Return the property's data path from the object."""
        if self.bone is None:
            return self.prop
        bone = pose_bone(ob, self.bone)
        return f"{bone.path_from_id()}{self.prop}" if self.prop.startswith("[") else bone.path_from_id(self.prop)


def of_result(target: Rig, character: Character, result: Result, root: str | None) -> list[Channel]:
    """Return all channels of a motion, in the rotation modes of the target's bones.

    Args:
        target: The rig.
        character: What it is.
        result: The motion.
        root: Bone that carries the travel; the object does when None.
    """
    names = target.skeleton.names
    out: list[Channel] = []
    for i, bone in enumerate(result.bones):
        out.append(rotation(pose_bone(target.object, names[bone]), names[bone], result.basis[:, i]))
    shifts = {movable(target, int(bone)): result.shifts[:, i] for i, bone in enumerate(result.moved)}
    if result.travel is not None and result.root_motion is RootMotion.ROOT_BONE and root is not None:
        # Where the hips cannot move by themselves, what is left to them moves the root as well.
        own = shifts.pop(target.skeleton.index[root], np.zeros((1, 3)))
        out += _root_travel(target, character, result.travel, root, own)
    out += [location(target, bone, shift) for bone, shift in shifts.items()]
    if result.travel is not None and result.root_motion is RootMotion.OBJECT:
        out += _object_travel(target.object, character, _pivot(character), result.travel)
    return out


def rotation(owner: bpy.types.PoseBone | bpy.types.Object, bone: str | None, rotations: Array) -> Channel:
    """Return rotations, shape (frame, 4), in the owner's own rotation mode."""
    mode = owner.rotation_mode
    if mode == "QUATERNION":
        return Channel(bone, "rotation_quaternion", quat.continuous(rotations))
    if mode == "AXIS_ANGLE":
        vectors = quat.to_rotation_vector(rotations)
        angles = np.linalg.norm(vectors, axis=-1, keepdims=True)
        axes = np.where(angles > 1e-9, vectors / np.maximum(angles, 1e-9), np.array([0.0, 1.0, 0.0]))
        return Channel(bone, "rotation_axis_angle", np.concatenate([angles, axes], axis=-1))
    return Channel(bone, "rotation_euler", euler.from_quaternions(rotations, mode))


def body_bones(target: Rig, bones: Iterable[int]) -> list[str]:
    """Return the bones that a transfer owns: keyed ones, and those above them, which must rest."""
    own = {int(b) for b in bones}
    above = {a for b in own for a in target.skeleton.tree.ancestors[b]}
    return [target.skeleton.names[b] for b in sorted(own | above)]


def resting(
    ob: bpy.types.Object, body: Iterable[str], moving: Iterable[Channel], animated: Container[str]
) -> list[Channel]:
    """Return the rest, one frame of it, for what a motion leaves alone on its bones but would show otherwise.

    Args:
        ob: The armature.
        body: Bones that the motion owns.
        moving: What it moves.
        animated: Data paths that something else moves.
    """
    moved = {(channel.bone, channel.prop) for channel in moving}
    out: list[Channel] = []
    for name in body:
        bone = pose_bone(ob, name)
        rest = rotation(bone, name, quat.identity(1))
        for channel in (rest, Channel(name, "location", np.zeros((1, 3))), Channel(name, "scale", np.ones((1, 3)))):
            off = np.abs(np.array(getattr(bone, channel.prop)) - channel.values[0]).max() > OFF_REST
            if (name, channel.prop) not in moved and (off or channel.path(ob) in animated):
                out.append(channel)
    return out


def location(target: Rig, bone: int, shifts: Array) -> Channel:
    """Return the location that moves a bone's head by ``shifts``, armature space, while its parents rest."""
    values = quat.rotate(quat.conjugate(_location_axes(target, bone)), shifts)
    return Channel(target.skeleton.names[bone], "location", values)


def root_bone(target: Rig, character: Character) -> str:
    """Return the bone that root motion can be moved to: the topmost above the hips.

    Raises:
        RigError: The hips have no bone above them.
    """
    hips = character.joints.get("hips")
    above = [] if hips is None else target.armature.bones[hips.bone].parent_recursive
    if not above:
        raise RigError(
            f"rig {target.name!r} has no bone above its hips to carry root motion: keep it on the hips or the object"
        )
    return above[-1].name


def movable(target: Rig, bone: int) -> int:
    """Return the bone that moves in place of ``bone``: a connected one cannot, but what it is connected to can."""
    bones = target.armature.bones
    line = [bone, *target.skeleton.tree.ancestors[bone]]
    return next((b for b in line if not bones[target.skeleton.names[b]].use_connect), line[-1])


def _location_axes(target: Rig, bone: int) -> Array:
    """Return the axes along which a bone's location counts while its parents rest, shape (4,)."""
    skeleton = target.skeleton
    if target.armature.bones[skeleton.names[bone]].use_local_location:
        return skeleton.rest_rotations[bone]
    parent = int(skeleton.parents[bone])
    return skeleton.rest_rotations[parent] if parent >= 0 else quat.IDENTITY


def _pivot(character: Character) -> Array:
    """Return the point on the ground about which travel turns, character frame, shape (3,)."""
    hips = character.bone("hips")
    assert hips is not None, "the plan has checked that there are hips"
    return character.local_to_character.points(character.skeleton.rest_positions[hips]) * np.array([1.0, 1.0, 0.0])


def _root_travel(target: Rig, character: Character, travel: Travel, root: str, own: Array) -> list[Channel]:
    """Return what carries the travel on a bone that also moves by ``own`` itself, armature space, shape (frame, 3)."""
    bone, pivot = target.skeleton.index[root], _pivot(character)
    to_local = character.local_to_character.inverse()
    rest = target.skeleton.rest_rotations[bone]
    basis = quat.multiply(quat.multiply(quat.conjugate(rest), to_local.turns(travel.turns)), rest)
    head = character.local_to_character.points(target.skeleton.rest_positions[bone] + own)
    moved = to_local.points(pivot + travel.points + quat.rotate(travel.turns, head - pivot))
    return [
        rotation(pose_bone(target.object, root), root, basis),
        location(target, bone, moved - target.skeleton.rest_positions[bone]),
    ]


def _object_travel(ob: bpy.types.Object, character: Character, pivot: Array, travel: Travel) -> list[Channel]:
    """Return the object's own transform, moved as the body moves."""
    to_world: Placement = character.world_to_character.inverse()
    world = np.array(ob.matrix_world, dtype=np.float64)
    parent = world @ np.linalg.inv(np.array(ob.matrix_basis, dtype=np.float64))
    moves = np.tile(np.eye(4), (len(travel.turns), 1, 1))
    moves[:, :3, :3] = quat.to_matrix(to_world.turns(travel.turns))
    start = to_world.points(pivot)
    moves[:, :3, 3] = to_world.points(pivot + travel.points) - np.einsum("fij,j->fi", moves[:, :3, :3], start)
    basis = np.linalg.inv(parent) @ moves @ world
    return [rotation(ob, None, rotations_of(basis[:, :3, :3])), Channel(None, "location", basis[:, :3, 3])]
