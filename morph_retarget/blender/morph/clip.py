"""What a character is told over a clip: values of channels and places of targets, gathered before any work.

Values come straight from F-curves where nothing else moves them; what only Blender knows, such as targets that move,
is read by stepping through the frames, after which the scene's frame is put back.
"""

from collections.abc import Generator, Mapping, Sequence
from dataclasses import dataclass

import bpy
import numpy as np

from ...core.arrays import Array
from ...core.errors import MotionError
from ...core.morph.channels import TargetKind, Values
from .. import actions
from ..properties import of_rig
from ..sampling import STEPS_PER_YIELD, set_frame
from . import keys, own_values, stage, targets
from .member import Member


@dataclass(frozen=True, eq=False)
class Clip:
    """Frames of an action as one character is told them."""

    frames: Array
    """Of the scene, shape (frame,)."""
    values: Values
    targets: Mapping[int, Array]
    """External targets by channel [m], character frame, shapes (frame or 1, 3)."""
    stepped: tuple[str, ...]
    """Why frames had to be stepped, empty when they were not."""


def range_of(member: Member, scene: bpy.types.Scene) -> tuple[int, int]:
    """Return the first and last frame of what a character plays.

    They are those of the scene for a character that goes over the ground, unless its action has a manual range.

    Raises:
        MotionError: The action has no keys.
    """
    ob, action = member.rig.object, member.action
    if member.gait is not None and not (action.use_frame_range and actions.assigned(ob)[0] == action):
        return scene.frame_start, scene.frame_end
    found = keyed_range(ob, action)
    if found is None:
        raise MotionError(f"action {action.name!r} has no keys for {ob.name!r}: key its channels first")
    return found


def keyed_range(ob: bpy.types.Object, action: bpy.types.Action) -> tuple[int, int] | None:
    """Return the first and last frame of an action on a character: its manual range, its keys, or its NLA strips."""
    playing, _ = actions.assigned(ob)
    if playing != action:
        strips = _strips(ob, action)
        found = (min(s.frame_start for s in strips), max(s.frame_end for s in strips)) if strips else None
    elif action.use_frame_range:
        found = (action.frame_start, action.frame_end)
    else:
        found = actions.frame_range(keys.curves(action).values())
    if found is None:
        return None
    first = int(np.floor(found[0] + 1e-3))
    return first, max(int(np.ceil(found[1] - 1e-3)), first)


def _strips(ob: bpy.types.Object, action: bpy.types.Action) -> list[bpy.types.NlaStrip]:
    tracks = ob.animation_data.nla_tracks if ob.animation_data else ()
    return [s for track in tracks if not track.mute for s in track.strips if not s.mute and s.action == action]


def clip_of(
    member: Member, ob: bpy.types.Object, scene: bpy.types.Scene, frames: Array, rate: float = 1.0
) -> Generator[float, None, Clip]:
    """Gather what a character is told in steps; yields the share done and returns the `Clip`.

    Args:
        member: How the character plays its action.
        ob: The character.
        scene: Its frame is put back after stepping.
        frames: Frames of the scene, shape (frame,).
        rate: Frames of the action for each frame of the scene, counted from the first one.
    """
    others, moving = driven(ob, member.action), _moving(member, ob)
    values: Values | None = None
    if not others:
        values = stage.values_over(member, ob, frames[0] + (frames - frames[0]) * rate)
    if others or moving:
        read, places = yield from _stepped(member, ob, scene, frames)
        values = values or read
    else:
        places = stage.targets_of(member, ob, bpy.context.evaluated_depsgraph_get())
    assert values is not None, "they come from curves or from stepping"
    return Clip(frames, values, places, (*others, *moving))


def _stepped(
    member: Member, ob: bpy.types.Object, scene: bpy.types.Scene, frames: Array
) -> Generator[float, None, tuple[Values, Mapping[int, Array]]]:
    """Read each frame as Blender evaluates it; yields the share done."""
    before = scene.frame_current_final
    read: list[tuple[Values, Mapping[int, Array]]] = []
    try:
        for i, frame in enumerate(frames.tolist()):
            set_frame(scene, frame)
            graph = bpy.context.evaluated_depsgraph_get()
            values = stage.values_of(member, ob.evaluated_get(graph))
            read.append((values, stage.targets_of(member, ob, graph)))
            if i % STEPS_PER_YIELD == 0:
                yield i / len(frames)
    finally:
        set_frame(scene, before)
    places = {channel: np.concatenate([found[channel] for _, found in read]) for channel in read[0][1]}
    return _joined([values for values, _ in read]), places


def _joined(parts: Sequence[Values]) -> Values:
    return Values(
        np.concatenate([part.positions for part in parts]),
        np.concatenate([part.rotations for part in parts]),
        np.concatenate([part.weights for part in parts]),
        {key: np.concatenate([part.deforms[key] for part in parts]) for key in parts[0].deforms},
    )


def driven(ob: bpy.types.Object, action: bpy.types.Action) -> tuple[str, ...]:
    """Return what besides the F-curves of the assigned action gives channels their values."""
    data, out = ob.animation_data, list[str]()
    assert data is not None, "it plays an action"
    if any(curve.data_path.startswith("morph_retarget.") for curve in data.drivers):
        out.append("drivers")
    strips = data.use_nla and any(not t.mute and any(not s.mute for s in t.strips) for t in data.nla_tracks)
    if strips or data.action != action:
        out.append("NLA strips")
    return tuple(out)


def _moving(member: Member, ob: bpy.types.Object) -> tuple[str, ...]:
    """Return what may move the external targets, as seen from a character."""
    items = of_rig(ob).channels
    wanted = [c for c in member.definition.channels if c.has_target and c.target is TargetKind.EXTERNAL]
    given = [items[c.name] for c in wanted if own_values.has_target(items[c.name])]
    if given and targets.moves(ob):
        return (f"movements of {ob.name!r} itself",)
    names = [item.target.name for item in given if targets.moves(item.target, item.target_bone)]
    return tuple(f"target {name!r}" for name in dict.fromkeys(names))
