"""What armatures were found to be. Run-time state, kept by Blender's session-wide number of the object.

It is dropped on load, undo and redo, and when bones or the user's corrections are edited.
"""

import bpy
import numpy as np

from ...core.character.character import Character
from ...core.morph.bodies import Bodies
from .. import collect
from ..controls import deforming
from ..properties import of_rig
from ..rig import Rig, armature_of
from ..rig_properties import BY_USER

Analysis = tuple[Rig, Character, Bodies]

_known: dict[int, Analysis] = {}
_rests: dict[int, tuple[object, object]] = {}
"""What these were found from."""


def of(ob: bpy.types.Object) -> Analysis:
    """Return what an armature is; found once and kept.

    Raises:
        MorphError: It cannot be analysed.
    """
    known = _known.get(ob.session_uid)
    if known is None:
        own, character = collect.target_of(ob)
        own, character = deforming.body_of(own, character) or (own, character)
        known = _known[ob.session_uid] = (own, character, Bodies.of(character))
        _rests[ob.session_uid] = _corrections(ob), _bones_of(ob)
    return known


def forget(ob: bpy.types.Object | None = None) -> None:
    """Drop what an armature was found to be, or what all were."""
    for kept in (_known, _rests):
        if ob is None:
            kept.clear()
        else:
            kept.pop(ob.session_uid, None)


def is_edited(ob: bpy.types.Object, bones: bool = True) -> bool:
    """Return whether the user's corrections, and the bones, of an analysed armature have changed since."""
    known = _rests.get(ob.session_uid)
    return known is not None and (known[0] != _corrections(ob) or (bones and known[1] != _bones_of(ob)))


def _corrections(ob: bpy.types.Object) -> tuple[object, ...]:
    own = of_rig(ob)
    return own.up, own.forward, [(joint.name, joint.bone) for joint in own.joints if joint.by in BY_USER]


def _bones_of(ob: bpy.types.Object) -> tuple[object, ...]:
    bones = armature_of(ob).bones
    parts: list[object] = [[(bone.name, bone.parent and bone.parent.name) for bone in bones]]
    for name, width, kind in (("matrix_local", 16, np.float32), ("tail_local", 3, np.float32)):
        values = np.empty(width * len(bones), dtype=kind)
        bones.foreach_get(name, values)
        parts.append(values.tobytes())
    for name in ("use_deform", "use_inherit_rotation", "use_connect"):
        flags = np.empty(len(bones), dtype=np.bool_)
        bones.foreach_get(name, flags)
        parts.append(flags.tobytes())
    return tuple(parts)
