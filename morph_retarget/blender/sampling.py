"""Sampling a rig's motion: straight from F-curves when nothing else moves it, else by stepping through frames."""

from collections.abc import Generator
from dataclasses import dataclass

import bpy
import numpy as np

from ..core import euler, quat
from ..core.arrays import Array
from ..core.errors import MotionError
from ..core.skeleton import Pose, pose_from_basis
from . import actions
from .actions import CurveMap
from .rig import Rig, armature_of, pose_of, read_pose, rotations_of

STEPS_PER_YIELD = 16


@dataclass(frozen=True, eq=False)
class Clip:
    """A rig's sampled motion."""

    name: str
    frames: Array
    """Frame numbers, shape (frame,)."""
    seconds_per_frame: float
    pose: Pose
    """Armature space, where the object stood at rest."""
    stepped: tuple[str, ...]
    """Why frames had to be stepped, empty when F-curves were read directly."""


def seconds_per_frame(scene: bpy.types.Scene) -> float:
    """Return the time between two frames [s]."""
    return scene.render.fps_base / scene.render.fps


def frames_of(found: CurveMap, name: str, wanted: tuple[int, int] | None = None) -> Array:
    """Return the whole frames of a motion.

    Raises:
        MotionError: The action has no keys.
    """
    keyed = actions.frame_range(found.values())
    if keyed is None:
        raise MotionError(f"action {name!r} has no keys: choose one that moves the armature")
    first, last = wanted or (int(np.floor(keyed[0] + 1e-3)), int(np.ceil(keyed[1] - 1e-3)))
    return np.arange(first, max(last, first) + 1, dtype=np.float64)


def sample(
    rig: Rig,
    action: bpy.types.Action,
    slot: bpy.types.ActionSlot,
    scene: bpy.types.Scene,
    wanted: tuple[int, int] | None = None,
) -> Generator[float, None, Clip]:
    """Sample a motion in steps; yields the share done and returns the `Clip`.

    Args:
        rig: The rig that the action moves.
        action: The action.
        slot: Its slot.
        scene: Gives the frame rate; its frame is put back after stepping.
        wanted: First and last frame, the keyed range when None.

    Raises:
        MotionError: The action has no keys, or moves none of the rig's bones.
    """
    found = actions.curves(action, slot)
    frames = frames_of(found, action.name, wanted)
    reasons = reasons_to_step(rig, found)
    if reasons:
        pose = yield from _stepped(rig, action, slot, scene, frames)
    else:
        pose = from_curves(rig, found, frames)
    if not np.isfinite(pose.positions).all() or not np.isfinite(pose.rotations).all():
        raise MotionError(f"action {action.name!r} holds values that are no numbers: import it again or mend its keys")
    return Clip(action.name, frames, seconds_per_frame(scene), pose, reasons)


def reasons_to_step(rig: Rig, found: CurveMap) -> tuple[str, ...]:
    """Return what besides plain F-curves moves a rig, empty for nothing."""
    ob = rig.object
    reasons: list[str] = []
    constrained = [b.name for b in pose_of(ob).bones if any(c.enabled and c.influence > 0.0 for c in b.constraints)]
    if constrained or any(c.enabled for c in ob.constraints):
        reasons.append("constraints" + (f" on {constrained[0]!r}" if constrained else ""))
    for owner in (ob, armature_of(ob)):
        if owner.animation_data and len(owner.animation_data.drivers):
            reasons.append("drivers")
            break
    data = ob.animation_data
    if data and data.use_nla and any(not t.mute and any(not s.mute for s in t.strips) for t in data.nla_tracks):
        reasons.append("NLA strips")
    if _carried_along(ob):
        reasons.append("an animated parent")
    if any(path.startswith("delta_") for path, _ in found) or not _no_delta(ob):
        reasons.append("delta transforms")
    odd = [
        b.name
        for b in armature_of(ob).bones
        if not b.use_inherit_rotation or b.inherit_scale not in {"FULL", "ALIGNED", "FIX_SHEAR"}
    ]
    if odd:
        reasons.append(f"inheritance settings of {odd[0]!r}")
    if _scales(ob, found):
        reasons.append("animated scale")
    return tuple(reasons)


def _carried_along(ob: bpy.types.Object) -> bool:
    """Return whether anything above an object may move."""
    parent = ob.parent
    while parent is not None:
        if parent.animation_data is not None or len(parent.constraints) > 0:
            return True
        parent = parent.parent
    return False


def _no_delta(ob: bpy.types.Object) -> bool:
    moved = np.abs(np.array(ob.delta_location)).max() > 0.0 or np.abs(np.array(ob.delta_scale) - 1.0).max() > 0.0
    turned = np.abs(np.array(ob.delta_rotation_euler)).max() > 0.0
    return not (moved or turned or abs(ob.delta_rotation_quaternion.w) < 1.0)


def _scales(ob: bpy.types.Object, found: CurveMap) -> bool:
    for (path, _), curve in found.items():
        if path == "scale" or (path.startswith("pose.bones") and path.endswith(".scale")):
            keys = np.empty(len(curve.keyframe_points) * 2, dtype=np.float32)
            curve.keyframe_points.foreach_get("co", keys)
            if np.abs(keys[1::2] - 1.0).max(initial=0.0) > 1e-4:
                return True
    scales = np.empty(len(pose_of(ob).bones) * 3, dtype=np.float32)
    pose_of(ob).bones.foreach_get("scale", scales)
    return bool(np.abs(scales - 1.0).max() > 1e-4) and not any(p.endswith(".scale") for p, _ in found)


# --- F-curves ---


def from_curves(rig: Rig, found: CurveMap, frames: Array) -> Pose:
    """Return the pose that F-curves alone make, armature space, object motion included.

    Raises:
        MotionError: No curve moves the object or one of its bones.
    """
    pose, moved = bones_from_curves(rig, found, frames)
    return _with_object(rig, found, frames, pose, moved)


def bones_from_curves(rig: Rig, found: CurveMap, frames: Array) -> tuple[Pose, bool]:
    """Return the pose that F-curves alone make of the bones, armature space, and whether one of them moves any."""
    count = len(rig.skeleton)
    rotations = quat.identity(len(frames), count)
    locations = np.zeros((len(frames), count, 3))
    moved = False
    for i, name in enumerate(rig.skeleton.names):
        bone = pose_of(rig.object).bones[name]
        rotation, keyed = own_rotation(bone, bone.path_from_id(), found, frames)
        rotations[:, i] = rotation
        moved |= keyed
        if not bone.bone.use_connect:
            location = actions.sample_vector(found, bone.path_from_id("location"), frames, np.array(bone.location))
            moved |= location is not None
            value = np.array(bone.location) if location is None else location
            if not bone.bone.use_local_location:
                # It counts along the axes of the parent, or the armature's for roots.
                value = quat.rotate(quat.conjugate(rig.skeleton.local_rotations[i]), value)
            locations[:, i] = value
    return pose_from_basis(rig.skeleton, rotations, locations), moved


def own_rotation(
    owner: bpy.types.Object | bpy.types.PoseBone, prefix: str, found: CurveMap, frames: Array
) -> tuple[Array, bool]:
    """Return an object's or bone's own rotation, shape (frame, 4) or (4,), and whether it is animated."""
    dot = f"{prefix}." if prefix else ""
    mode = owner.rotation_mode
    if mode == "QUATERNION":
        values = actions.sample_vector(found, f"{dot}rotation_quaternion", frames, np.array(owner.rotation_quaternion))
        return quat.normalize(np.array(owner.rotation_quaternion) if values is None else values), values is not None
    if mode == "AXIS_ANGLE":
        values = actions.sample_vector(found, f"{dot}rotation_axis_angle", frames, np.array(owner.rotation_axis_angle))
        value = np.array(owner.rotation_axis_angle) if values is None else values
        return quat.from_axis_angle(quat.unit(value[..., 1:]), value[..., 0]), values is not None
    values = actions.sample_vector(found, f"{dot}rotation_euler", frames, np.array(owner.rotation_euler))
    return euler.to_quaternions(np.array(owner.rotation_euler) if values is None else values, mode), values is not None


def _with_object(rig: Rig, found: CurveMap, frames: Array, pose: Pose, moved: bool) -> Pose:
    """Return the pose with the object's own motion folded in, as seen from where the object stands at rest."""
    ob = rig.object
    location = actions.sample_vector(found, "location", frames, np.array(ob.location))
    rotation, turns = own_rotation(ob, "", found, frames)
    if location is None and not turns:
        if not moved:
            raise MotionError(
                f"the action moves no bone of {ob.name!r}: its channels name other bones; "
                "choose the armature it was made for"
            )
        return pose
    # World = parent * basis; only the basis is animated here.
    basis = np.tile(np.eye(4), (len(frames), 1, 1))
    basis[:, :3, :3] = quat.to_matrix(np.broadcast_to(rotation, (len(frames), 4))) * np.array(ob.scale)
    basis[:, :3, 3] = np.array(ob.location) if location is None else location
    rest = np.linalg.inv(np.array(ob.matrix_world, dtype=np.float64))
    parent = np.array(ob.matrix_world, dtype=np.float64) @ np.linalg.inv(np.array(ob.matrix_basis, dtype=np.float64))
    return moved_pose(pose, rest @ parent @ basis)


def moved_pose(pose: Pose, matrices: Array) -> Pose:
    """Return ``pose`` moved by a matrix for each frame, shape (frame, 4, 4)."""
    turns = rotations_of(matrices[:, :3, :3])[:, None]
    positions = np.einsum("fij,fbj->fbi", matrices[:, :3, :3], pose.positions) + matrices[:, None, :3, 3]
    return Pose(quat.multiply(turns, pose.rotations), positions)


# --- stepping ---


def _stepped(
    rig: Rig, action: bpy.types.Action, slot: bpy.types.ActionSlot, scene: bpy.types.Scene, frames: Array
) -> Generator[float, None, Pose]:
    """Sample by setting every frame; yields the share done and returns the pose."""
    ob = rig.object
    before, kept = scene.frame_current_final, actions.assigned(ob)
    rest = np.linalg.inv(np.array(ob.matrix_world, dtype=np.float64))
    count = len(frames)
    rotations, positions = np.empty((count, len(rig.skeleton), 4)), np.empty((count, len(rig.skeleton), 3))
    matrices = np.empty((count, 4, 4))
    try:
        actions.assign(ob, action, slot)
        for i, frame in enumerate(frames.tolist()):
            set_frame(scene, frame)
            evaluated = ob.evaluated_get(bpy.context.evaluated_depsgraph_get())
            rotations[i], positions[i] = read_pose(rig, evaluated)
            matrices[i] = rest @ np.array(evaluated.matrix_world, dtype=np.float64)
            if i % STEPS_PER_YIELD == 0:
                yield i / count
    finally:
        actions.assign(ob, *kept)
        set_frame(scene, before)
    return moved_pose(Pose(rotations, positions), matrices)


def set_frame(scene: bpy.types.Scene, frame: float) -> None:
    """Set a scene to a frame that need not be whole."""
    whole = int(np.floor(frame))
    scene.frame_set(whole, subframe=frame - whole)
