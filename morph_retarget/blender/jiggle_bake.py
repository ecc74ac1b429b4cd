"""Jiggles on ordinary actions: what an action leaves alone follows it, and is keyed beside it in a copy."""

from collections.abc import Generator
from dataclasses import dataclass

import bpy

from ..core import jiggling
from ..core.errors import MotionError
from . import actions, collect, jiggle_bones, jiggle_keys
from .actions import Writer
from .jiggle_keys import Jiggles
from .properties import of_rig

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
    posed = jiggle_bones.posed(own, actions.curves(action, slot))
    loose = jiggling.prepare(character, posed, of_rig(ob).jiggles.settings())
    if not loose:
        raise MotionError(
            f"nothing jiggles on {ob.name!r}: it has no tail, ears, hair or the like, "
            f"or action {action.name!r} moves them already"
        )
    found = yield from jiggle_keys.of(own, loose, (action, slot), scene, wanted)
    return _copy(ob, action, slot, found)


def _copy(ob: bpy.types.Object, action: bpy.types.Action, slot: bpy.types.ActionSlot, found: Jiggles) -> Outcome:
    writer, replaced = Writer(NAME.format(action=action.name), ob), found.paths
    try:
        for (path, _), curve in actions.curves(action, slot).items():
            if path not in replaced:
                writer.copy(curve)
        found.write(writer)
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
    return Outcome(writer.action, writer.slot, found.bones)
