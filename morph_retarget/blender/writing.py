"""What a transfer keys: channels of bones or of controls, and what Blender makes of them."""

from collections.abc import Generator, Mapping, Sequence
from dataclasses import dataclass, field

import bpy
import numpy as np

from ..core.arrays import Array
from ..core.character.character import Character
from ..core.mocap.motion import Motion
from ..core.mocap.root_motion import RootMotion
from ..core.pipeline import Result
from . import channels, sampling
from .channels import Channel
from .controls import carrying
from .controls.task import Onto, Task, Times
from .rig import Rig
from .sampling import Clip


@dataclass(frozen=True, eq=False)
class Written:
    """What is to be keyed, and what it shows."""

    channels: Sequence[Channel]
    body: Sequence[str]
    """Bones that the motion owns."""
    frames: Array
    """To be keyed, shape (n,)."""
    motion: Motion
    """What the target does."""
    on_controls: Mapping[str, object] | None = None
    """What is told of controls, None where bones are keyed."""
    warnings: tuple[str, ...] = field(default=())


def written(
    clip: Clip,
    task: Task,
    result: Result,
    onto: Onto,
    resample: bool,
    scene: bpy.types.Scene,
) -> Generator[float, None, Written]:
    """Say what to key for a motion, in steps; yields the share done.

    Args:
        clip: What was transferred.
        task: The target, and what the user has said of its controls.
        result: The motion.
        onto: Bones or controls.
        resample: Key whole frames where the clip has another rate than the scene.
        scene: Gives the frame rate.

    Raises:
        RigError: Controls were asked for and there are none.
        MappingError: A control that the user has named does not exist.
    """
    times = shown_at(clip, scene)
    frames, places = key_frames(times, clip, resample)
    carried = yield from carrying.carry(task, result, onto, Times(frames, places, times), scene)
    if carried is not None:
        return Written(carried.channels, carried.body, frames, carried.motion, carried.described, carried.warnings)
    keyed = result if places is None else result.resampled(places)
    found, body = channels_of(task.target, task.character, keyed), channels.body_bones(task.target, keyed.bones)
    if task.only:
        found = [channel for channel in found if channel.bone in task.only]
        body = [name for name in body if name in task.only]
    return Written(found, body, frames, result.motion)


def shown_at(clip: Clip, scene: bpy.types.Scene) -> Array:
    """Return when the frames of a clip are shown in a scene [frames]; the motion keeps its duration."""
    ratio = clip.seconds_per_frame / sampling.seconds_per_frame(scene)
    return clip.frames if abs(ratio - 1.0) < 1e-6 else clip.frames[0] + (clip.frames - clip.frames[0]) * ratio


def key_frames(times: Array, clip: Clip, resample: bool) -> tuple[Array, Array | None]:
    """Return the frames to key and at which places of the clip they are, None where they are its own frames."""
    if not resample or times is clip.frames:
        return times, None
    whole = np.arange(np.ceil(times[0]), np.floor(times[-1]) + 1.0)
    return whole, np.interp(whole, times, np.arange(len(times)))


def channels_of(target: Rig, character: Character, result: Result) -> list[Channel]:
    """Return a motion as values of the properties of the bones that were mapped."""
    root = channels.root_bone(target, character) if result.root_motion is RootMotion.ROOT_BONE else None
    return channels.of_result(target, character, result, root)
