"""Generalizing a captured or baked action: what an armature does becomes a generalized action for all characters."""

from collections.abc import Generator, Sequence
from dataclasses import dataclass, field

import bpy
import numpy as np

from ...core.arrays import Array
from ...core.errors import MotionError
from ...core.mocap import reference
from ...core.morph import capture
from ...core.morph.capture import Captured, CaptureSettings
from ...core.morph.channels import Channel
from .. import retarget, rig
from ..actions import Writer
from ..properties import of_rig
from ..retarget import Source
from . import definitions, keys


@dataclass(frozen=True)
class Options:
    """What can be chosen about generalizing an action."""

    settings: CaptureSettings = field(default_factory=CaptureSettings)
    frames: tuple[int, int] | None = None
    """First and last frame of the action; all of it when None."""
    name: str = "{action} generalized"
    """Name of the new action; ``{action}`` and ``{character}`` are filled in."""


@dataclass(frozen=True, eq=False)
class Outcome:
    """A generalized action."""

    action: bpy.types.Action
    captured: Captured
    warnings: tuple[str, ...]


def generalize(
    ob: bpy.types.Object,
    action: bpy.types.Action,
    slot: bpy.types.ActionSlot,
    scene: bpy.types.Scene,
    channels: Sequence[Channel],
    options: Options | None = None,
) -> Generator[float, None, Outcome]:
    """Make a generalized action of what an action does to an armature; yields the share done.

    The armature and its action are left as they are; the new action has no users yet and is kept in the file.

    Raises:
        MotionError: The action is generalized already, moves no bone, or no channel selects a body.
        RigError: The armature cannot be read.
    """
    options = options or Options()
    if definitions.is_generalized(action):
        raise MotionError(f"action {action.name!r} is generalized already: choose one that moves bones, or bake it")
    overrides = of_rig(ob).overrides()
    source = yield from retarget.read_source(rig.read(ob), action, slot, scene, overrides, options.frames)
    captured = of_source(source, channels, options.settings)
    name = options.name.replace("{action}", action.name).replace("{character}", ob.name)
    made = write(captured, source.clip.frames, name, ob)
    warnings = [*source.rig.warnings, *source.character.warnings, *captured.warnings]
    height = source.character.frame.height
    if captured.travel > height or captured.turning > np.pi / 4.0:
        warnings.append(
            f"the motion is generalized in place: {captured.travel:.3g} m of way and "
            f"{np.degrees(captured.turning):.0f} degrees of turning were left out"
        )
    return Outcome(made, captured, tuple(warnings))


def of_source(source: Source, channels: Sequence[Channel], settings: CaptureSettings) -> Captured:
    """Return the generalized values of a sampled motion."""
    character, pose = source.character, source.clip.pose
    stance = reference.standing_frame(character, pose, character.frame.up)
    return capture.of_clip(character, pose, channels, stance, source.clip.seconds_per_frame, settings)


def write(captured: Captured, frames: Array, name: str, ob: bpy.types.Object) -> bpy.types.Action:
    """Return captured values as a new generalized action, keyed on every frame.

    Args:
        captured: Channels and values.
        frames: Frames to key, shape (frame,).
        name: Of the action.
        ob: The performer.
    """
    writer = Writer(name, ob)
    try:
        writer.slot.name_display = "Characters"
        for i, channel in enumerate(captured.channels):
            definitions.add(writer.action, channel)
            if channel.poses_position and channel.position_weight > 0.0:
                path = keys.path(channel.name, "position")
                writer.write(path, captured.values.positions[:, i], frames, channel.name)
            if channel.poses_rotation and channel.rotation_weight > 0.0:
                path = keys.path(channel.name, "rotation")
                writer.write(path, captured.values.rotations[:, i], frames, channel.name)
    except BaseException:
        writer.discard()
        raise
    writer.action.use_fake_user = True
    return writer.action
