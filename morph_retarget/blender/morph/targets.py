"""Where targets are over a range of frames, for baking and for remapping keys.

A target that nothing moves is asked for once; any other is sampled by stepping through the frames, since constraints,
parents and drivers may move it.
"""

from collections.abc import Callable

import bpy
import numpy as np

from ...core import play
from ...core.arrays import Array
from ...core.play import Part
from .. import actions
from ..channels import ROTATIONS
from ..properties import of_rig
from ..rig import pose_of
from ..sampling import set_frame
from . import stage
from .member import Member
from .values import MORPHRETARGET_PG_values

_TRANSFORMS = {f"{prefix}{name}" for prefix in ("", "delta_") for name in ("location", "scale", *ROTATIONS)}


def over(member: Member, item: MORPHRETARGET_PG_values, scene: bpy.types.Scene, frames: Array) -> Array:
    """Return where the external target of a channel is [m], character frame, shape (frame, 3) or (1, 3)."""
    ob = member.rig.object

    def place() -> Array:
        graph = bpy.context.evaluated_depsgraph_get()
        frame = np.array(ob.evaluated_get(graph).matrix_world, dtype=np.float64)
        return stage.to_character(member, frame, stage.place_of(item.target, item.target_bone, graph))

    if not (moves(item.target, item.target_bone) or moves(ob)):
        return place()[None]
    return stepped(scene, frames, place)


def of_body(member: Member, part: Part, body: int, scene: bpy.types.Scene, frames: Array) -> Array:
    """Return where a body that others follow is brought by what plays first [m], character frame, (frame or 1, 3)."""
    ob, channels = member.rig.object, part.binding.action.channels
    external = {
        i: over(member, of_rig(ob).channels[channels[i].name], scene, frames)
        for i in sorted({channel for _, channel in part.binding.plan.external})
    }
    if not part.binding.entries:
        return part.bodies.positions[body][None]
    return play.evaluate(part, stage.values_over(member, ob, frames), external).pose.positions[:, body]


def moves(ob: bpy.types.Object, bone: str = "") -> bool:
    """Return whether anything may move an object, or a bone of it, while frames change."""
    if bone and (ob.animation_data is not None or any(len(b.constraints) for b in pose_of(ob).bones)):
        return True
    data = ob.animation_data
    if len(ob.constraints) > 0 or (data is not None and (len(data.drivers) > 0 or len(data.nla_tracks) > 0)):
        return True
    action, slot = actions.assigned(ob)
    if action is not None and slot is not None and any(path in _TRANSFORMS for path, _ in actions.curves(action, slot)):
        return True
    return ob.parent is not None and moves(ob.parent, ob.parent_bone if ob.parent_type == "BONE" else "")


def stepped(scene: bpy.types.Scene, frames: Array, place: Callable[[], Array]) -> Array:
    """Return what ``place`` says at each frame, shape (frame, 3); the scene's frame is put back."""
    before = scene.frame_current_final
    out = np.empty((len(frames), 3))
    try:
        for i, frame in enumerate(frames.tolist()):
            set_frame(scene, frame)
            out[i] = place()
    finally:
        set_frame(scene, before)
    return out
