"""A motion ready to be shown on an armature, frame by frame: whole properties of all its pose bones in rows."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ..core.arrays import Array, Indices
from . import actions, channels
from .channels import Channel
from .controls import reading
from .rig import pose_of
from .writing import Written

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
class Motion:
    """A transferred clip, ready to be shown."""

    followed: tuple[int, int]
    """Session-wide numbers of the source's action and of the source."""
    frames: Array
    properties: Sequence[_Property]
    own: Sequence[Channel]
    """Channels of the object itself."""
    switches: Sequence[Channel]
    """Custom properties of bones that decide which controls count."""
    moving: Sequence[Channel]
    """Those of them that the armature's own animation would set otherwise at each frame."""

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
        if self.moving:
            _set(ob, self.moving)
        else:
            ob.update_tag(refresh={"OBJECT"})  # the pose follows, at two thirds of what "DATA" costs

    def switch(self, ob: bpy.types.Object) -> None:
        """Let the controls count that the motion is on."""
        if self.switches:
            _set(ob, self.switches)

    def clear(self, ob: bpy.types.Object) -> None:
        """Put the bones of an armature that are moved back to rest."""
        rest = {"rotation_quaternion": (1.0, 0.0, 0.0, 0.0), "rotation_axis_angle": (0.0, 0.0, 1.0, 0.0)}
        bones = pose_of(ob).bones
        for prop in self.properties:
            width = _WIDTHS[prop.name]
            neutral = np.array(rest.get(prop.name, (float(prop.name == "scale"),) * width), dtype=np.float32)
            bones.foreach_get(prop.name, prop.buffer)
            prop.buffer[prop.places] = np.resize(neutral, len(prop.places))
            bones.foreach_set(prop.name, prop.buffer)

    @property
    def _step(self) -> float:
        return float(self.frames[1] - self.frames[0]) if len(self.frames) > 1 else 1.0


def of_written(target: bpy.types.Object, made: Written, followed: tuple[int, int]) -> Motion:
    """Return what is to be keyed as a motion that can be shown without keys.

    Args:
        target: The armature.
        made: What would be keyed on it.
        followed: Session-wide numbers of the source's action and of the source.
    """
    playing, its_slot = actions.assigned(target)
    animated = {path for path, _ in actions.curves(playing, its_slot)} if playing and its_slot else set[str]()
    animated |= actions.paths_in_strips(target)
    switches = [channel for channel in made.channels if channel.prop.startswith("[")]
    found = [channel for channel in made.channels if not channel.prop.startswith("[")]
    still = channels.resting(target, made.body, found, animated)
    found += [replace(channel, values=np.repeat(channel.values, len(made.frames), axis=0)) for channel in still]
    own = [channel for channel in found if channel.bone is None]
    moving = [channel for channel in switches if channel.path(target) in animated]
    return Motion(followed, made.frames, _packed(target, found), own, switches, moving)


def _between(values: NDArray[Any], row: int, part: float) -> NDArray[Any]:
    """Return values between two rows; rotations are close enough to each other to be mixed part by part."""
    if part < 1e-3 or row + 1 >= len(values):
        return values[row]
    return values[row] + part * (values[row + 1] - values[row])


def _set(ob: bpy.types.Object, switches: Sequence[Channel]) -> None:
    """Give custom properties of bones their first values."""
    for channel in switches:
        reading.switch(ob, channel)
    ob.update_tag()  # drivers read them


def _packed(ob: bpy.types.Object, found: Sequence[Channel]) -> list[_Property]:
    """Return channels of bones as rows of whole properties."""
    bones = pose_of(ob).bones
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
