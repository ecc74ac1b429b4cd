"""Jiggles on ordinary actions: what an action leaves alone follows it, and is keyed beside it."""

from collections.abc import Generator
from dataclasses import dataclass, replace

import bpy
import numpy as np

from ..core import jiggling, quat
from ..core.arrays import Array
from ..core.errors import MotionError
from ..core.jiggling import Jiggling
from ..core.skeleton import Pose, pose_from_basis
from . import actions, channels, collect, jiggle_bones, sampling
from .actions import Writer
from .channels import ROTATIONS, Channel
from .properties import of_rig
from .rig import Rig, pose_bone

NAME = "{action} with Jiggles"


@dataclass(frozen=True, eq=False)
class Outcome:
    """A new action with jiggles."""

    action: bpy.types.Action
    slot: bpy.types.ActionSlot
    bones: tuple[str, ...]
    """What jiggles in it."""


def bake(
    ob: bpy.types.Object,
    action: bpy.types.Action,
    slot: bpy.types.ActionSlot,
    scene: bpy.types.Scene,
    wanted: tuple[int, int] | None = None,
) -> Generator[float, None, Outcome]:
    """Key jiggles in a copy of an action, and make the armature play it; yields the share done.

    Args:
        ob: The armature.
        action: The action; it is left as it is.
        slot: Its slot.
        scene: Gives the frame rate; its frame is put back if it has to be changed.
        wanted: First and last frame to jiggle in, all of the action's when None.

    Raises:
        MotionError: The action has no keys or moves no bones, or it leaves nothing that could jiggle.
        MorphError: The armature cannot be analysed.
    """
    own, character = collect.target_of(ob)
    found = actions.curves(action, slot)
    what = jiggling.prepare(character, jiggle_bones.posed(own, found), of_rig(ob).jiggles.settings())
    if not what:
        raise MotionError(
            f"nothing jiggles on {ob.name!r}: it has no tail, ears, hair or the like, "
            f"or action {action.name!r} moves them already"
        )
    clip = yield from sampling.sample(own, action, slot, scene, wanted)
    basis = _with_changes(own, what, clip)
    names = [own.skeleton.names[bone] for bone in what.chains.bones]
    keyed = [channels.rotation(pose_bone(ob, name), name, basis[:, i]) for i, name in enumerate(names)]
    return _write(own, action, slot, keyed, clip.frames)


def _with_changes(own: Rig, what: Jiggling, clip: sampling.Clip) -> Array:
    """Return the basis rotations of the jiggling bones: what the action holds them in, and the jiggles on top."""
    bones, pose, skeleton = what.chains.bones, clip.pose, own.skeleton
    mine = Pose(pose.rotations[:, bones], pose.positions[:, bones])
    local = quat.multiply(quat.conjugate(pose.rotations[:, skeleton.parents[bones]]), mine.rotations)
    held = quat.multiply(quat.conjugate(skeleton.local_rotations[bones]), local)
    # What the action holds a tail in is what gravity has made of it.
    basis = quat.identity(1, len(skeleton))
    basis[:, bones] = held[:1]
    rest = pose_from_basis(skeleton, basis, np.zeros((1, len(skeleton), 3))).rotations[0, bones]
    what = replace(what, chains=replace(what.chains, rest=rest))
    return quat.multiply(held, jiggling.changes(what, mine, clip.seconds_per_frame))


def _write(
    own: Rig, action: bpy.types.Action, slot: bpy.types.ActionSlot, keyed: list[Channel], frames: Array
) -> Outcome:
    ob, names = own.object, tuple(channel.bone or "" for channel in keyed)
    replaced = {pose_bone(ob, name).path_from_id(prop) for name in names for prop in ROTATIONS}
    writer = Writer(NAME.format(action=action.name), ob)
    try:
        for (path, _), curve in actions.curves(action, slot).items():
            if path not in replaced:
                writer.copy(curve)
        for channel in keyed:
            writer.write(channel.path(ob), channel.values, frames, channel.bone or "")
    except BaseException:
        writer.discard()
        raise
    for name in ("use_frame_range", "frame_start", "frame_end", "use_cyclic"):
        setattr(writer.action, name, getattr(action, name))
    for marker in action.pose_markers:
        writer.action.pose_markers.new(marker.name).frame = marker.frame
    actions.play(ob, writer.action, writer.slot)
    if action.users == 0:
        action.use_fake_user = True  # what nobody plays any more must still be saved
    return Outcome(writer.action, writer.slot, names)
