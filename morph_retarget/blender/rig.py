"""Armature objects as the core sees them: skeleton, placement and poses."""

from dataclasses import dataclass

import bpy
import numpy as np

from ..core import quat
from ..core.arrays import Array, Indices
from ..core.character.frame import Placement
from ..core.errors import RigError
from ..core.skeleton import Skeleton
from ..core.tree import Tree

SHEAR = 0.01
"""An uneven scale larger than this is worth a warning."""


@dataclass(frozen=True, eq=False)
class Rig:
    """An armature object with its skeleton."""

    object: bpy.types.Object
    name: str
    uid: int
    """Blender's session-wide number of the object; name and number outlive the file that the object was read from."""
    skeleton: Skeleton
    placement: Placement
    pose_order: Indices
    """For each bone of the skeleton its place among the object's pose bones, shape (bone,)."""
    warnings: tuple[str, ...]

    @property
    def armature(self) -> bpy.types.Armature:
        """The armature data."""
        return armature_of(self.object)


def scene_of() -> bpy.types.Scene:
    """Return the scene that is open, for the command line and file formats, which have no scene of their own."""
    scene = bpy.context.scene
    assert scene is not None, "a file always has a scene"
    return scene


def armature_of(ob: bpy.types.Object) -> bpy.types.Armature:
    """Return the data of an armature object."""
    assert isinstance(ob.data, bpy.types.Armature), "only armature objects are asked for their bones"
    return ob.data


def pose_of(ob: bpy.types.Object) -> bpy.types.Pose:
    """Return the pose of an armature object.

    Raises:
        RigError: Blender has made none yet, as for an object that is in no scene.
    """
    if ob.pose is None:
        raise RigError(f"armature {ob.name!r} has no pose yet: link it to a scene, and show that")
    return ob.pose


def pose_bone(ob: bpy.types.Object, name: str) -> bpy.types.PoseBone:
    """Return a pose bone of an armature object."""
    return pose_of(ob).bones[name]


def selected_bones(ob: bpy.types.Object) -> list[str]:
    """Return the names of the selected bones of an armature.

    Raises:
        RigError: None is selected.
    """
    new = "select" in bpy.types.PoseBone.bl_rna.properties  # up to Blender 4.5 the armature's bones are selected
    found = [bone.name for bone in pose_of(ob).bones if (bone if new else bone.bone).select]  # type: ignore[union-attr]
    if not found:
        raise RigError(f"no bone of {ob.name!r} is selected: select those that shall move in Pose mode")
    return found


def read(ob: bpy.types.Object) -> Rig:
    """Return an armature object's rest, armature space, and its place in the world.

    Raises:
        RigError: It is no armature, has no bones, is scaled to zero, or a place in it is no number.
    """
    if ob.type != "ARMATURE":
        raise RigError(f"object {ob.name!r} is no armature: choose one")
    bones = armature_of(ob).bones
    count = len(bones)
    if count == 0:
        raise RigError(f"armature {ob.name!r} has no bones: choose one that has")
    matrices = np.empty(count * 16, dtype=np.float32)
    heads, tails = np.empty(count * 3, dtype=np.float32), np.empty(count * 3, dtype=np.float32)
    bones.foreach_get("matrix_local", matrices)
    bones.foreach_get("head_local", heads)
    bones.foreach_get("tail_local", tails)
    finite = np.isfinite(
        np.column_stack([matrices.reshape(count, 16), heads.reshape(count, 3), tails.reshape(count, 3)])
    )
    if not finite.all():
        name = bones[int(np.argmin(finite.all(axis=1)))].name
        raise RigError(
            f"bone {name!r} of armature {ob.name!r} lies at values that are no numbers: export the rig again"
        )
    place = {bone.name: i for i, bone in enumerate(bones)}
    parents = np.array([place[bone.parent.name] if bone.parent else -1 for bone in bones], dtype=np.intp)
    order = Tree(parents).order
    rank = np.empty(count, dtype=np.intp)
    rank[order] = np.arange(count)
    linear = matrices.astype(np.float64).reshape(count, 4, 4).transpose(0, 2, 1)[:, :3, :3]
    skeleton = Skeleton(
        names=tuple(bones[int(i)].name for i in order),
        parents=np.where(parents[order] >= 0, rank[parents[order]], -1),
        rest_positions=heads.astype(np.float64).reshape(count, 3)[order],
        rest_rotations=quat.from_matrix(linear)[order],
        rest_tails=tails.astype(np.float64).reshape(count, 3)[order],
        deform=np.array([bones[int(i)].use_deform for i in order]),
        inherits=np.array([bones[int(i)].use_inherit_rotation for i in order]),
    )
    placement, shear = Placement.from_matrix(np.array(ob.matrix_world, dtype=np.float64))
    warnings = (
        (f"armature {ob.name!r} is scaled unevenly: its motion will be off by that much",) if shear > SHEAR else ()
    )
    return Rig(ob, ob.name, ob.session_uid, skeleton, placement, _pose_order(ob, skeleton), warnings)


def _pose_order(ob: bpy.types.Object, skeleton: Skeleton) -> Indices:
    place = {bone.name: i for i, bone in enumerate(pose_of(ob).bones)}
    return np.array([place[name] for name in skeleton.names], dtype=np.intp)


def read_pose(rig: Rig, evaluated: bpy.types.Object) -> tuple[Array, Array]:
    """Return orientations and heads of all bones as they are now, armature space, shapes (bone, 4) and (bone, 3)."""
    count = len(rig.skeleton)
    buffer = np.empty(count * 16, dtype=np.float32)
    pose_of(evaluated).bones.foreach_get("matrix", buffer)
    matrices = buffer.astype(np.float64).reshape(count, 4, 4).transpose(0, 2, 1)[rig.pose_order]
    return rotations_of(matrices[:, :3, :3]), matrices[:, :3, 3]


def rotations_of(linear: Array) -> Array:
    """Return the rotations of matrices that may be scaled as well, shape (..., 3, 3) to (..., 4)."""
    columns = linear / np.maximum(np.linalg.norm(linear, axis=-2, keepdims=True), 1e-12)
    flipped = np.linalg.det(columns) < 0.0
    return quat.from_matrix(np.where(flipped[..., None, None], -columns, columns))
