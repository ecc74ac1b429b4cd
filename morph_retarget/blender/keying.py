"""Writing channels as keys: a new action with a slot of its own, beside the old one."""

from collections.abc import Sequence

import bpy

from ..core.arrays import Array
from . import actions, channels
from .actions import CurveMap, Writer
from .channels import Channel
from .rig import Rig, pose_bone

OBJECT_GROUP = "Object Transforms"


def write(
    target: Rig,
    found: Sequence[Channel],
    body: Sequence[str],
    frames: Array,
    name: str,
    keep_others: bool,
    keep_object: bool = False,
) -> tuple[bpy.types.Action, bpy.types.ActionSlot]:
    """Key channels in a new action and make the target play it; the old action is left as it is.

    Args:
        target: The rig.
        found: Channels; those with a single frame of values are keyed at the first one.
        body: Bones that the motion owns; what else moved or turned them before must not show.
        frames: Frames to key, shape (frame,).
        name: Of the action.
        keep_others: Take over what the old action does to everything else.
        keep_object: Also what it does to the object itself.
    """
    ob = target.object
    old_action, old_slot = actions.assigned(ob)
    old = actions.curves(old_action, old_slot) if old_action and old_slot else {}
    writer = Writer(name, ob)
    try:
        written: set[str] = set()
        for channel in found:
            path = channel.path(ob)
            writer.write(path, channel.values, frames[: len(channel.values)], channel.bone or OBJECT_GROUP)
            written.add(path)
        for channel in channels.resting(ob, body, found, {path for path, _ in old} | actions.paths_in_strips(ob)):
            writer.write(channel.path(ob), channel.values, frames[:1], channel.bone or OBJECT_GROUP)
            written.add(channel.path(ob))
        if keep_others:
            _copy_others(ob, body, old, written, writer, keep_object)
            writer.limit(frames[0], frames[-1])
    except BaseException:
        writer.discard()
        raise
    actions.play(ob, writer.action, writer.slot)
    if old_action is not None and old_action.users == 0:
        old_action.use_fake_user = True  # what nobody plays any more must still be saved
    return writer.action, writer.slot


def _copy_others(
    ob: bpy.types.Object, body: Sequence[str], old: CurveMap, written: set[str], writer: Writer, keep_object: bool
) -> None:
    """Take over the old action's curves for bones that are not mapped, custom properties and the like."""
    own = {pose_bone(ob, name).path_from_id() for name in body}
    transforms = {"location", "scale", *channels.ROTATIONS}
    for (path, _), curve in old.items():
        stem, _, prop = path.rpartition(".")
        of_body = stem in own and prop in transforms
        of_object = not keep_object and not stem and (prop in transforms or prop.startswith("delta_"))
        generalized = path.startswith("morph_retarget.")  # it moves the body too
        if path not in written and not of_body and not of_object and not generalized:
            writer.copy(curve)
