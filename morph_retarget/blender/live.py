"""Targets that follow their source while frames change: the whole clip is transferred once, frames are served from it.

Everything here is run-time state, keyed by Blender's session-wide number of the object and dropped on load, undo and
redo. What is shown depends on the time alone, never on how often it was asked for.
"""

from collections.abc import Generator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import bpy
import numpy as np
from mathutils import Matrix
from numpy.typing import NDArray

from ..core.arrays import Array, Indices
from ..core.errors import MorphError, MotionError, RigError
from . import actions, channels, collect, retarget, writing
from .channels import OFF_REST, Channel
from .controls import deforming
from .controls.task import Onto
from .properties import of_rig
from .retarget import Source
from .rig import Rig, pose_of

Singles = NDArray[np.float32]

_WIDTHS = {"rotation_quaternion": 4, "rotation_euler": 3, "rotation_axis_angle": 4, "location": 3, "scale": 3}


@dataclass(eq=False)
class _Property:
    """One property of all pose bones, with the part of it that the motion owns."""

    name: str
    buffer: Singles
    """Of all bones, shape (bone * width,)."""
    places: Indices
    """What the motion owns in it, shape (n,)."""
    values: Singles
    """Shape (frame, n)."""


@dataclass(frozen=True, eq=False)
class _Motion:
    """A transferred clip, ready to be shown."""

    followed: tuple[int, int]
    """Session-wide numbers of the source's action and of the source."""
    frames: Array
    properties: Sequence[_Property]
    own: Sequence[Channel]
    """Channels of the object itself."""

    def show(self, ob: bpy.types.Object, frame: float) -> None:
        """Put the pose of one frame on an armature."""
        place = float(np.clip((frame - self.frames[0]) / self._step, 0.0, len(self.frames) - 1.0))
        row = min(int(place + 1e-4), len(self.frames) - 1)
        part = place - row
        bones = pose_of(ob).bones
        for prop in self.properties:
            bones.foreach_get(prop.name, prop.buffer)
            prop.buffer[prop.places] = _between(prop.values, row, part)
            bones.foreach_set(prop.name, prop.buffer)
        for channel in self.own:
            setattr(ob, channel.prop, _between(channel.values, row, part))
        ob.update_tag(refresh={"OBJECT"})  # the pose follows, at two thirds of what "DATA" costs

    @property
    def _step(self) -> float:
        return float(self.frames[1] - self.frames[0]) if len(self.frames) > 1 else 1.0


def _between(values: NDArray[Any], row: int, part: float) -> NDArray[Any]:
    """Return values between two rows; rotations are close enough to each other to be mixed part by part."""
    if part < 1e-3 or row + 1 >= len(values):
        return values[row]
    return values[row] + part * (values[row + 1] - values[row])


_motions: dict[int, _Motion] = {}
_preparing: list[int] = []
problems: dict[int, str] = {}
"""Why an armature has stopped following, by session-wide number."""


def following(ob: bpy.types.Object) -> bool:
    """Return whether an armature follows a source."""
    return ob.type == "ARMATURE" and of_rig(ob).live_source is not None


def start(scene: bpy.types.Scene, source: bpy.types.Object, target: bpy.types.Object) -> None:
    """Let a target follow a source.

    Raises:
        MorphError: The motion cannot be transferred.
    """
    retarget.run(starting(scene, source, target))


def starting(
    scene: bpy.types.Scene, source: bpy.types.Object, target: bpy.types.Object
) -> Generator[float, None, None]:
    """Do the same in steps; yields the share done. Closed before its end it leaves everything as it was.

    Raises:
        MorphError: The motion cannot be transferred.
    """
    clip = yield from _sampled(scene, source, target)
    if of_rig(target).live_source is None:
        of_rig(target).home = [value for row in target.matrix_basis for value in row]
    _motions[target.session_uid] = _transferred(scene, source, target, clip)
    problems.pop(target.session_uid, None)
    of_rig(target).live_source = source
    show_frame(scene)


def stop(target: bpy.types.Object, clear: bool) -> None:
    """Let a target follow no more.

    Args:
        target: The armature.
        clear: Put the bones that followed back to rest; else they keep the pose.
    """
    following_till_now = following(target)
    of_rig(target).live_source = None
    motion = _motions.pop(target.session_uid, None)
    if not clear:
        return
    if following_till_now:
        _go_home(target)
    names = {bone.name for bone in pose_of(target).bones}
    if motion is not None:
        rest = {"rotation_quaternion": (1.0, 0.0, 0.0, 0.0), "rotation_axis_angle": (0.0, 0.0, 1.0, 0.0)}
        for prop in motion.properties:
            width = _WIDTHS[prop.name]
            neutral = np.array(rest.get(prop.name, (float(prop.name == "scale"),) * width), dtype=np.float32)
            pose_of(target).bones.foreach_get(prop.name, prop.buffer)
            prop.buffer[prop.places] = np.resize(neutral, len(prop.places))
            pose_of(target).bones.foreach_set(prop.name, prop.buffer)
    elif names:
        for bone in pose_of(target).bones:
            bone.matrix_basis.identity()
    target.update_tag(refresh={"DATA"})


def forget() -> None:
    """Drop all motions; they are transferred anew when they are next needed."""
    _motions.clear()
    problems.clear()


def refresh(scene: bpy.types.Scene) -> None:
    """Transfer all motions anew and show them: something that they depend on has changed."""
    layer = bpy.context.view_layer
    assert layer is not None, "a setting was changed, so there is a scene"
    for target in _targets(scene):
        layer.update()  # what was shown last may not have been evaluated yet
        _motions.pop(target.session_uid, None)
        try:
            source = of_rig(target).live_source
            _motions[target.session_uid] = _prepare(scene, source, target)
        except MorphError as error:
            _give_up(target, error)
    show_frame(scene)


def show_frame(scene: bpy.types.Scene) -> None:
    """Put the pose of the scene's frame on all targets; one that cannot be shown follows no more, and says why."""
    if _preparing:
        return  # a source is being sampled by stepping through frames
    for target in _targets(scene):
        try:
            motion = _motions.get(target.session_uid)
            if motion is None or motion.followed != _followed(of_rig(target).live_source):
                motion = _prepare(scene, of_rig(target).live_source, target, may_step=False)
                _motions[target.session_uid] = motion
            motion.show(target, scene.frame_current_final)
        except MorphError as error:
            _give_up(target, error)


def _give_up(target: bpy.types.Object, error: MorphError) -> None:
    problems[target.session_uid] = str(error)
    of_rig(target).live_source = None


def _targets(scene: bpy.types.Scene) -> list[bpy.types.Object]:
    return [ob for ob in scene.objects if following(ob)]


def _followed(source: bpy.types.Object) -> tuple[int, int]:
    action, _ = actions.assigned(source)
    return (action.session_uid if action else 0, source.session_uid)


def _prepare(
    scene: bpy.types.Scene, source: bpy.types.Object, target: bpy.types.Object, may_step: bool = True
) -> _Motion:
    if not may_step and collect.needs_steps(source, *collect.actions_of(source)[0]):
        raise MotionError(f"armature {source.name!r} is moved by more than its action: switch Live on again")
    return _transferred(scene, source, target, retarget.run(_sampled(scene, source, target)))


def _sampled(
    scene: bpy.types.Scene, source: bpy.types.Object, target: bpy.types.Object
) -> Generator[float, None, Source]:
    """Sample what a source plays in steps, while nothing is shown."""
    action, slot = collect.actions_of(source)[0]
    _preparing.append(target.session_uid)
    try:
        return (yield from collect.source_of(source, action, slot, scene))
    finally:
        _preparing.remove(target.session_uid)


def _transferred(scene: bpy.types.Scene, source: bpy.types.Object, target: bpy.types.Object, clip: Source) -> _Motion:
    """Transfer a sampled clip to a target."""
    _go_home(target)
    own, character = collect.target_of(target)
    options = collect.options_of(scene, target)
    if options.onto is not Onto.NONE and deforming.body_of(own, character) is not None:
        raise RigError(
            f"armature {target.name!r} is posed by controls, which Live does not move: press Retarget, "
            "or let it write on bones"
        )
    ground = collect.ground_of(scene, character)
    given = collect.contacts_of(source, collect.actions_of(source)[0][0])
    _, result = retarget.transfer(clip, own, character, options, given, ground)
    found = writing.channels_of(own, character, result)
    body = channels.body_bones(own, result.bones)
    if options.only:
        found = [channel for channel in found if channel.bone in options.only]
        body = [name for name in body if name in options.only]
    playing, its_slot = actions.assigned(target)
    animated = {path for path, _ in actions.curves(playing, its_slot)} if playing and its_slot else set[str]()
    frames = clip.clip.frames
    for still in channels.resting(target, body, found, animated):
        found.append(replace(still, values=np.repeat(still.values, len(frames), axis=0)))
    own_channels = [channel for channel in found if channel.bone is None]
    return _Motion(_followed(source), frames, _packed(own, found), own_channels)


def _go_home(target: bpy.types.Object) -> None:
    """Put an object back to where it was before it began to follow; its world matrix is right at once."""
    home, now = Matrix(np.array(of_rig(target).home).reshape(4, 4).tolist()), target.matrix_basis
    if np.abs(np.array(home) - np.array(now)).max() > OFF_REST:
        target.matrix_world = target.matrix_world @ now.inverted() @ home


def _packed(own: Rig, found: Sequence[Channel]) -> list[_Property]:
    """Return channels of bones as rows of whole properties."""
    bones = pose_of(own.object).bones
    place = {bone.name: i for i, bone in enumerate(bones)}
    out: list[_Property] = []
    for name, width in _WIDTHS.items():
        some = [channel for channel in found if channel.prop == name and channel.bone is not None]
        if not some:
            continue
        starts = np.array([place[channel.bone or ""] * width for channel in some])
        places = (starts[:, None] + np.arange(width)).ravel()
        values = np.concatenate([channel.values for channel in some], axis=1).astype(np.float32)
        out.append(_Property(name, np.empty(len(bones) * width, dtype=np.float32), places, values))
    return out
