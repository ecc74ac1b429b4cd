"""Editing a channel as specialized curves: the active body's own location and rotation (Hecker 2008 §3.3).

A stand-in, an empty on the character, gets the body's curves in the character frame as its ordinary location and
rotation. It is selected, so that the Graph Editor shows them; what is reshaped there is generalized back to the keys of
the channel, times, values and handles, and all characters follow at once.
"""

import bpy
import numpy as np
from mathutils import Matrix

from ...core.arrays import Array
from ...core.errors import MotionError
from ...core.morph import movement
from ...core.morph.movement import Frames, Movement, PositionMode, RotationMode
from .. import actions
from ..properties import of_rig
from . import cast, keys, remap, tracks

PATHS = {"position": "location", "rotation": "rotation_quaternion"}
_ABSOLUTE = Movement(position=PositionMode.ABSOLUTE, rotation=RotationMode.ABSOLUTE)


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
    space = remap.space_of(ob, action, name, np.zeros(1))
    if space is None:
        raise MotionError(f"channel {name!r} selects nothing on {ob.name!r}: change its context, or choose another one")
    empty = bpy.data.objects.new(f"{ob.name}: {name}", None)
    empty.empty_display_type, empty.empty_display_size = "ARROWS", 0.1 * space.member.character.frame.height
    empty.rotation_mode = "QUATERNION"
    for collection in ob.users_collection:
        collection.objects.link(empty)
    empty.parent = ob
    place = space.member.character.local_to_character.inverse()
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = place.scale * place.rotation, place.translation
    empty.matrix_parent_inverse = Matrix(matrix.tolist())
    own = of_rig(empty)
    own.stands_for, own.stands_for_channel = ob, name
    _show(empty, action)
    return empty


def stand_ins(action: bpy.types.Action) -> list[bpy.types.Object]:
    """Return the stand-ins whose characters play an action."""
    found = [ob for ob in bpy.data.objects if ob.type == "EMPTY" and of_rig(ob).stands_for is not None]
    return [ob for ob in found if cast.action_of(of_rig(ob).stands_for) == action]


def _show(empty: bpy.types.Object, action: bpy.types.Action) -> None:
    """Give a stand-in the curves of its channel, specialized."""
    ob, name = of_rig(empty).stands_for, of_rig(empty).stands_for_channel
    found = keys.curves(action)
    own = bpy.data.actions.new(f"{empty.name} (specialized)")
    slot = own.slots.new(id_type="OBJECT", name=empty.name)
    actions.assign(empty, own, slot)
    bag = keys.bag_of(own)
    parts = {part: tracks.read(found, keys.path(name, part), keys.DEFAULTS[part]) for part in PATHS}
    times = tracks.union([track.times for track in parts.values() if track is not None])
    if not len(times):
        return
    old, flat = _frames(ob, action, name, times)
    for part, track in remap.mapped(parts, times, old, flat).items():
        tracks.write(bag, {}, PATHS[part], track, "Specialized")


def apply(empty: bpy.types.Object) -> None:
    """Generalize a stand-in's curves back to the keys of its channel.

    Raises:
        MotionError: The character is gone, or plays the action no more.
    """
    ob, name = of_rig(empty).stands_for, of_rig(empty).stands_for_channel
    action = None if ob is None else cast.action_of(ob)
    if ob is None or action is None or name not in [c.name for c in cast.member(ob).definition.channels]:
        raise MotionError(f"the channel of {empty.name!r} is gone: delete it")
    own, slot = actions.assigned(empty)
    if own is None or slot is None:
        return
    found = actions.curves(own, slot)
    rest = {"position": empty.location[:], "rotation": empty.rotation_quaternion[:]}
    parts = {part: tracks.read(found, path, rest[part]) for part, path in PATHS.items()}
    times = tracks.union([track.times for track in parts.values() if track is not None])
    if not len(times):
        return
    new, flat = _frames(ob, action, name, times)
    there, bag = keys.curves(action), keys.bag_of(action)
    for part, track in remap.mapped(parts, times, flat, new).items():
        tracks.write(bag, there, keys.path(name, part), track, name, keys.DEFAULTS[part])


def finish(empty: bpy.types.Object) -> None:
    """Generalize a stand-in's curves back and remove it.

    Raises:
        MotionError: See `apply`.
    """
    apply(empty)
    own, _ = actions.assigned(empty)
    bpy.data.objects.remove(empty)
    if own is not None and own.users == 0:
        bpy.data.actions.remove(own)


def _frames(ob: bpy.types.Object, action: bpy.types.Action, name: str, times: Array) -> tuple[Frames, Frames]:
    """Return the frames of a channel's active body in its own modes, and in plain places and orientations."""
    space = remap.space_of(ob, action, name, times)
    assert space is not None, "it selected something when the stand-in was made"
    body, plain = np.array([space.body]), np.array([False])
    return space.frames(space.channel), movement.frames(space.member.bodies, body, [_ABSOLUTE], plain)
