"""Asking characters for bodies, as scripts and buttons do (Hecker 2008 §3.1.2: game code evaluates contexts too).

from morph_retarget.blender.morph import query
hands = query.bodies_of(ob, Context(Capability.GRASPER, Depth.FRONT, Side.LEFT))
"""

from collections.abc import Collection, Sequence

import bpy

from ...core.errors import MorphError, RigError
from ...core.morph.context import Context, select
from ..properties import of_rig
from ..rig import armature_of, pose_of
from . import analyses, cast
from .member import Member
from .properties import MORPHRETARGET_PG_channel, of_action


def bodies_of(ob: bpy.types.Object, context: Context) -> list[str]:
    """Return the bones of the bodies that a context selects on an armature, whether or not it plays an action.

    Raises:
        MorphError: The armature cannot be analysed.
    """
    _, _, bodies = analyses.of(ob)
    return [bodies.names[body] for body in select(context, bodies)]


def bodies_of_channel(ob: bpy.types.Object, name: str) -> list[str]:
    """Return the bones of the bodies that a channel poses on a character, in its present variant.

    Raises:
        MorphError: The action cannot be played, or has no such channel.
    """
    member = cast.member(ob)
    for channel, own in zip(member.definition.channels, member.part.binding.selected, strict=True):
        if channel.name == name:
            return [member.bodies.names[body] for body in own]
    raise RigError(f"{ob.name!r} plays no channel {name!r}: choose one of its action's channels")


def is_ready(ob: bpy.types.Object) -> bool:
    """Return whether an armature plays an action and has a place for the values of all its channels."""
    action = cast.action_of(ob)
    return action is not None and all(item.name in of_rig(ob).channels for item in of_action(action).channels)


def member_now(ob: bpy.types.Object) -> Member | None:
    """Return how an armature plays its action without changing any data, as panels must not; None where it cannot."""
    try:
        return cast.member(ob) if is_ready(ob) else None
    except MorphError:
        return None


def active_character(context: bpy.types.Context) -> bpy.types.Object | None:
    """Return the armature that is meant: the active object's, else the first of the scene that plays an action.

    It is that of a stand-in as well, or of a foot path.
    """
    ob = context.object
    if ob is not None:
        found = ob if ob.type == "ARMATURE" else of_rig(ob).stands_for or ob.find_armature()
        if found is not None:
            return found
    playing = cast.performers(context.scene) if context.scene is not None else []
    flying = [other for other in playing if ob is not None and of_rig(other).gait.foot_path == ob]
    return next(iter(flying or playing), None)


def active_channel(action: bpy.types.Action | None) -> MORPHRETARGET_PG_channel | None:
    """Return the channel of an action that the buttons act on, None without one."""
    own = of_action(action) if action is not None else None
    if own is None or not len(own.channels):
        return None
    return own.channels[min(max(own.active_channel, 0), len(own.channels) - 1)]


def choose_bones(ob: bpy.types.Object, names: Collection[str], first: str = "") -> None:
    """Select some bones of an armature and no others, and make one of them the active one.

    Args:
        ob: The armature.
        names: The bones.
        first: Becomes the active one if it is among them; else the first of them does.
    """
    bones, poses = armature_of(ob).bones, pose_of(ob).bones
    holders: Sequence[bpy.types.Bone | bpy.types.PoseBone] = (
        list(poses) if "select" in bpy.types.PoseBone.bl_rna.properties else list(bones)
    )
    for holder in holders:
        holder.select = holder.name in names  # type: ignore[union-attr]
    active = first if first in names else next(iter(names), "")
    bones.active = bones.get(active)


def show_in_pose_mode(context: bpy.types.Context, found: Sequence[bpy.types.Object]) -> list[bpy.types.Object]:
    """Bring armatures into Pose mode, together with those that are in it already; return all that are in it then.

    Raises:
        RigError: One is hidden, or the window is in another mode that should be left first.
    """
    layer = context.view_layer
    assert layer is not None, "operators run where there is a view layer"
    if context.mode not in {"OBJECT", "POSE"}:
        raise RigError("selecting bodies needs Object or Pose mode: leave the present mode first")
    for ob in found:
        if not ob.visible_get():
            raise RigError(f"{ob.name!r} is hidden: show it first")
    posed = [ob for ob in layer.objects if ob.mode == "POSE"]
    together = list(dict.fromkeys([*found, *posed]))
    if len(together) == len(posed):
        return posed
    if context.mode == "POSE":
        bpy.ops.object.mode_set(mode="OBJECT")
    if layer.objects.active not in together:
        layer.objects.active = together[0]
    for ob in layer.objects:
        ob.select_set(ob in together)
    bpy.ops.object.mode_set(mode="POSE")
    return together


def channels_in_hand(ob: bpy.types.Object) -> list[str]:
    """Return the channels that pose the selected bones of a character, the active channel when there are none."""
    action = cast.action_of(ob)
    if action is None:
        return []
    own = of_action(action)
    active = [own.channels[own.active_channel].name] if 0 <= own.active_channel < len(own.channels) else []
    bones = {bone.name for bone in bpy.context.selected_pose_bones or [] if bone.id_data == ob}
    if not bones:
        return active
    member = cast.member(ob)
    names = [
        member.definition.channels[e.channel].name
        for e in member.part.binding.entries
        if member.bodies.names[e.body] in bones
    ]
    return [name for name in dict.fromkeys(names) if name in active] or list(dict.fromkeys(names)) or active
