"""Editing a channel as specialized curves: the active body's own location and rotation (Hecker 2008 §3.3).

A stand-in, an empty on the character, gets the body's curves in the character frame as its ordinary location and
rotation. It is selected, so that the Graph Editor shows them; what is reshaped there is generalized back to the keys of
the channel, times, values and handles, and all characters follow at once.
"""

from dataclasses import replace
from functools import partial

import bpy
import numpy as np
from mathutils import Matrix

from ...core.arrays import Array
from ...core.errors import MotionError
from ...core.morph.channels import TargetKind
from ...core.morph.movement import Movement, PositionMode, RotationMode
from .. import actions
from ..properties import of_rig
from ..rig import scene_of
from . import cast, keys, remap, tracks
from .properties import of_action
from .remap import FramesAt, Space
from .tracks import Track

PATHS = {"position": "location", "rotation": "rotation_quaternion"}
_ABSOLUTE = Movement(position=PositionMode.ABSOLUTE, rotation=RotationMode.ABSOLUTE)


_synced: dict[int, tuple[bytes, bytes]] = {}
"""What a stand-in's curves and those of its channel were when they last meant the same, by session-wide number."""


def start(ob: bpy.types.Object, name: str) -> bpy.types.Object:
    """Return a new stand-in for the active body of a channel on a character, with its specialized curves.

    Raises:
        MotionError: The channel selects nothing on the character.
    """
    action = cast.action_of(ob)
    if action is None:
        raise MotionError(f"{ob.name!r} plays no generalized action: add it to one first")
    for other in stand_ins(action):
        if of_rig(other).stands_for == ob and of_rig(other).stands_for_channel == name:
            return other
    keys.by_name(action, ob)
    body = _space(ob, action, name, "").body
    character = cast.member(ob).character
    empty = bpy.data.objects.new(f"{ob.name}: {name}", None)
    empty.empty_display_type, empty.empty_display_size = "ARROWS", 0.1 * character.frame.height
    empty.rotation_mode = "QUATERNION"
    for collection in ob.users_collection:
        collection.objects.link(empty)
    empty.parent = ob
    place = character.local_to_character.inverse()
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = place.scale * place.rotation, place.translation
    empty.matrix_parent_inverse = Matrix(matrix.tolist())
    own = of_rig(empty)
    own.stands_for, own.stands_for_channel = ob, name
    own.stands_for_body = cast.member(ob).bodies.names[body]
    made = bpy.data.actions.new(f"{empty.name} (specialized)")
    actions.assign(empty, made, made.slots.new(id_type="OBJECT", name=empty.name))
    _show(empty, made, action)
    return empty


def stand_ins(action: bpy.types.Action) -> list[bpy.types.Object]:
    """Return the stand-ins whose characters play an action."""
    found = [ob for ob in bpy.data.objects if ob.type == "EMPTY" and of_rig(ob).stands_for is not None]
    return [ob for ob in found if cast.action_of(of_rig(ob).stands_for) == action]


def forget() -> None:
    """Drop what is known about stand-ins."""
    _synced.clear()


def _show(empty: bpy.types.Object, own: bpy.types.Action, action: bpy.types.Action) -> None:
    """Give a stand-in the curves of its channel, specialized."""
    ob, name = of_rig(empty).stands_for, of_rig(empty).stands_for_channel
    frames, plain = _frames(empty, action)
    bag = keys.bag_of(own)
    found = keys.curves(own)
    for part, path in PATHS.items():
        track, value = _specialized(ob, action, name, part, frames, plain)
        setattr(empty, path, value)
        if track is not None:
            tracks.write(bag, found, path, track, "Specialized")
    _synced[empty.session_uid] = _traces(empty, action)


def _traces(empty: bpy.types.Object, action: bpy.types.Action) -> tuple[bytes, bytes]:
    """Return what the curves of a stand-in and those of its channel look like."""
    own, _ = actions.assigned(empty)
    name = of_rig(empty).stands_for_channel
    shown = b"" if own is None else tracks.trace(keys.curves(own), PATHS.values())
    return shown, tracks.trace(keys.curves(action), [keys.path(name, part) for part in PATHS])


def _specialized(
    ob: bpy.types.Object, action: bpy.types.Action, name: str, part: str, own: FramesAt, plain: FramesAt
) -> tuple[Track | None, Array]:
    """Return a part of a channel as a stand-in has it: its keys, if there are any, and its value without keys."""
    now = np.array(getattr(of_rig(ob).channels[name], part), dtype=np.float64)
    track, at = tracks.read(keys.curves(action), keys.path(name, part), now), partial(remap.change, part, own, plain)
    value = at(np.array([scene_of().frame_current_final])).applied(range(len(now)), now[None])[0]
    return (None if track is None else track.mapped(at)), value


def follow(empty: bpy.types.Object) -> None:
    """Bring a stand-in and its channel together: what was reshaped goes into the keys, else it shows them as they are.

    Raises:
        MotionError: See `apply`.
    """
    action = _action(empty)
    own, _ = actions.assigned(empty)
    now, known = _traces(empty, action), _synced.get(empty.session_uid)
    if known is None or now[0] != known[0]:
        apply(empty)
    elif now[1] != known[1] and own is not None:
        _show(empty, own, action)


def apply(empty: bpy.types.Object) -> None:
    """Generalize a stand-in's curves back to the keys of its channel, if they were reshaped.

    Raises:
        MotionError: The character or the channel is gone, or plays no more.
    """
    action, ob, name = _action(empty), of_rig(empty).stands_for, of_rig(empty).stands_for_channel
    known = _synced.get(empty.session_uid)
    own, slot = actions.assigned(empty)
    if own is None or slot is None or (known is not None and known[0] == _traces(empty, action)[0]):
        return
    keys.by_name(action, ob)
    found, there, bag = actions.curves(own, slot), keys.curves(action), keys.bag_of(action)
    frames, plain = _frames(empty, action)
    for part, path in PATHS.items():
        shaped = tracks.read(found, path, getattr(empty, path)[:])
        if shaped is None:
            continue
        before, _ = _specialized(ob, action, name, part, frames, plain)
        if before is None or not before.same_as(shaped):
            back = shaped.mapped(partial(remap.change, part, plain, frames))
            tracks.write(bag, there, keys.path(name, part), back, name, getattr(of_rig(ob).channels[name], part))
    _synced[empty.session_uid] = _traces(empty, action)


def finish(empty: bpy.types.Object) -> None:
    """Generalize a stand-in's curves back and remove it.

    Raises:
        MotionError: See `apply`.
    """
    apply(empty)
    own, _ = actions.assigned(empty)
    _synced.pop(empty.session_uid, None)
    bpy.data.objects.remove(empty)
    if own is not None and own.users == 0:
        bpy.data.actions.remove(own)


def _action(empty: bpy.types.Object) -> bpy.types.Action:
    """Return the generalized action whose channel a stand-in shows.

    Raises:
        MotionError: It is gone.
    """
    ob, name = of_rig(empty).stands_for, of_rig(empty).stands_for_channel
    action = None if ob is None else cast.action_of(ob)
    if action is None or name not in of_action(action).channels:
        raise MotionError(f"what {empty.name!r} stands for, channel {name!r}, is gone: delete it")
    return action


def _space(ob: bpy.types.Object, action: bpy.types.Action, name: str, body: str) -> Space:
    """Return how a body of a channel moves, the active one without a name.

    Raises:
        MotionError: The channel does not select it on the character.
    """
    space = remap.space_of(ob, action, name, body)
    if space is None:
        what = f"does not select {body!r}" if body else "selects nothing"
        raise MotionError(f"channel {name!r} {what} on {ob.name!r}: change its context, or choose another one")
    return space


def _frames(empty: bpy.types.Object, action: bpy.types.Action) -> tuple[FramesAt, FramesAt]:
    """Return the frames of a stand-in's body in its own modes, and in plain places and orientations.

    Raises:
        MotionError: The channel does not select it any more.
    """
    own = of_rig(empty)
    space = _space(own.stands_for, action, own.stands_for_channel, own.stands_for_body)
    plain = replace(space.channel, movement=_ABSOLUTE, target=TargetKind.NONE)
    return (
        remap.steady(partial(space.frames, space.channel)),
        remap.steady(partial(replace(space, mirrored=False).frames, plain)),
    )
