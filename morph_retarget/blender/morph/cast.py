"""The cast: armatures that play generalized actions, and how each action binds to each. Run-time state.

What is found here is kept by Blender's session-wide number of the object and dropped on load, undo and redo, when a
definition or a rig is edited, and when another action is assigned.
"""

from collections.abc import Iterable
from dataclasses import replace

import bpy

from ...core import play
from ...core.errors import MotionError
from ...core.morph.bind import bind
from .. import actions, joint_limits
from ..locomotion import standing
from ..properties import of_rig
from ..rig import pose_of
from . import analyses, definitions, own_values, stretching
from .member import Member
from .properties import of_action

problems: dict[int, str] = {}
"""Why an armature does not play its action, by session-wide number."""

_members: dict[int, tuple[tuple[object, ...], Member]] = {}
_limits: dict[int, bytes] = {}
"""What limited the joints of each member."""


def action_of(ob: bpy.types.Object) -> bpy.types.Action | None:
    """Return the generalized action that an armature plays: its own, else the topmost in its NLA strips."""
    if ob.type != "ARMATURE" or ob.animation_data is None:
        return None
    own = ob.animation_data.action
    if own is not None:
        return own if definitions.is_generalized(own) else None
    tracks = [track for track in ob.animation_data.nla_tracks if not track.mute]
    strips = [strip.action for track in reversed(tracks) for strip in track.strips if not strip.mute]
    return next((action for action in strips if definitions.is_generalized(action)), None)


def performers(scene: bpy.types.Scene, among: Iterable[bpy.types.Object] | None = None) -> list[bpy.types.Object]:
    """Return the armatures of a scene that play a generalized action.

    Args:
        scene: The scene.
        among: All its armatures, where they are known.
    """
    if among is None:  # most files have no generalized action, and some have very many objects
        among = scene.objects if any(map(definitions.is_generalized, bpy.data.actions)) else ()
    return [ob for ob in among if action_of(ob) is not None]


def playing(scene: bpy.types.Scene, action: bpy.types.Action) -> list[bpy.types.Object]:
    """Return the armatures of a scene that play ``action``."""
    return [ob for ob in performers(scene) if action_of(ob) == action]


def is_limited_anew(ob: bpy.types.Object) -> bool:
    """Return whether the joint limits of a member have been edited since."""
    known = _limits.get(ob.session_uid)
    return known is not None and known != _limits_of(ob)


def _limits_of(ob: bpy.types.Object) -> bytes:
    return joint_limits.state(ob) if of_rig(ob).use_joint_limits else b""


def member(ob: bpy.types.Object, action: bpy.types.Action | None = None) -> Member:
    """Return how an armature plays its action, or another one.

    Raises:
        MorphError: The armature cannot be analysed, or the action cannot be read.
    """
    action = action or action_of(ob)
    assert action is not None, "only performers are asked for"
    own = of_rig(ob)
    solving = own.bends_spine, own.allows_stretch, own.avoids_collisions, own.keeps_above_ground, own.use_joint_limits
    state = (action.session_uid, len(of_action(action).channels), own.variant, solving, own.gait.enabled)
    known = _members.get(ob.session_uid)
    if known is not None and known[0] == state:
        return known[1]
    rig, character, bodies = analyses.of(ob)
    own_values.ensure(ob, action)
    definition, unknown = definitions.read_known(action)
    binding = bind(definition, bodies, own.variant, own_values.missing(ob, definition))
    if unknown:
        binding = replace(
            binding,
            entries=tuple(entry for entry in binding.entries if entry.channel not in unknown),
            selected=tuple(() if i in unknown else bodies for i, bodies in enumerate(binding.selected)),
            problems=(*unknown.values(), *binding.problems),
        )
    solver = replace(
        own.solver.settings(rig.skeleton.index),
        bends_spine=own.bends_spine,
        allows_stretch=own.allows_stretch,
        avoids_collisions=own.avoids_collisions,
        keeps_above_ground=own.keeps_above_ground,
    )
    limits = joint_limits.read(ob, rig) if own.use_joint_limits else None
    fixed = stretching.connected(rig) if own.allows_stretch else frozenset[int]()
    gait = standing.of(character, play.root_of(bodies), own.gait) if own.gait.enabled else None
    found = Member(rig, action, definition, character, binding, solver, limits, fixed, gait)
    _members[ob.session_uid] = (state, found)
    _limits[ob.session_uid] = _limits_of(ob)
    return found


def is_stepping_anew(ob: bpy.types.Object) -> bool:
    """Return whether the gait of a member has other goals since its settings were edited, or is on or off.

    Raises:
        MorphError: It cannot go as it is set.
    """
    known = _members.get(ob.session_uid)
    if known is None:
        return False
    before, own = known[1].gait, of_rig(ob).gait
    if before is None or not own.enabled:
        return (before is not None) != own.enabled
    return standing.of(known[1].character, known[1].root, own).wanted != before.wanted


def add(ob: bpy.types.Object, action: bpy.types.Action) -> None:
    """Let an armature play a generalized action, through the slot that all others share.

    Raises:
        MorphError: It cannot be analysed, or the action is linked and has no slot.
    """
    if analyses.is_edited(ob):
        forget(ob, rig=True)
    analyses.of(ob)
    own_values.ensure(ob, action)
    slot = next((slot for slot in action.slots if slot.target_id_type in {"OBJECT", "UNSPECIFIED"}), None)
    if slot is None and action.library is not None:
        raise MotionError(f"action {action.name!r} is linked from a library where nobody plays it: make it local")
    if slot is None:
        slot = action.slots.new(id_type="OBJECT", name="Characters")
    before, _ = actions.assigned(ob)
    actions.play(ob, action, slot)
    if before is not None and before.users == 0:
        before.use_fake_user = True  # what nobody plays any more must still be saved
    for bone in pose_of(ob).bones:
        bone.matrix_basis.identity()  # what an earlier action left behind
    forget(ob)


def remove(ob: bpy.types.Object) -> None:
    """Let an armature play its generalized action no more; its values are kept."""
    actions.assign(ob, None, None)
    forget(ob)


def forget(ob: bpy.types.Object | None = None, rig: bool = False) -> None:
    """Drop what is known about an armature, or about all; with ``rig`` what its bones were found to be as well."""
    if ob is None:
        _members.clear()
        _limits.clear()
        problems.clear()
        if rig:
            analyses.forget()
        return
    _members.pop(ob.session_uid, None)
    _limits.pop(ob.session_uid, None)
    problems.pop(ob.session_uid, None)
    if rig:
        analyses.forget(ob)
