"""What keeps an armature from playing all of its action, in words."""

import bpy

from ...core.errors import MorphError
from ..properties import of_rig
from ..rig import pose_of
from . import cast, stretching
from .properties import of_action


def tell(ob: bpy.types.Object) -> list[str]:
    """Return what keeps an armature from playing all of its action, in words."""
    problem = cast.problems.get(ob.session_uid)
    if problem is not None:
        return [problem]
    try:
        own = cast.member(ob)
        stiff = stretching.told(own.rig, own.part.pose.stiff) if own.solver.allows_stretch else []
        return [*own.binding.problems, *stiff, *_lost_limbs(ob), *_lost(ob)]
    except MorphError as error:
        return [str(error)]


def _lost_limbs(ob: bpy.types.Object) -> list[str]:
    """Return which limbs with solver settings a character has not, in words."""
    lost = of_rig(ob).solver.lost(pose_of(ob).bones)
    return [f"{name!r} has solver settings and is no bone of {ob.name!r}: remove these" for name in lost]


def _lost(ob: bpy.types.Object) -> list[str]:
    """Return which specialized curves of a character stand for channels that are gone, in words."""
    action = cast.action_of(ob)
    known = of_action(action).channels if action is not None else {}
    mine = [other for other in bpy.data.objects if other.type == "EMPTY" and of_rig(other).stands_for == ob]
    return [
        f"{empty.name!r} shows specialized curves of {of_rig(empty).stands_for_channel!r}, which is gone: delete it"
        for empty in mine
        if of_rig(empty).stands_for_channel not in known
    ]
