"""From a bone that the animator moves to generalized values, for all characters that play the action."""

from collections.abc import Mapping
from dataclasses import dataclass

import bpy
import numpy as np

from ...core import quat
from ...core.arrays import Array
from ...core.layering import Layer
from ...core.morph import movement, specialize
from ..locomotion import walks
from ..properties import of_rig
from ..rig import pose_of
from . import cast, on_controls, pose
from .member import Member
from .properties import of_action
from .shown import Shown


@dataclass(frozen=True, eq=False)
class Held:
    """A body that the animator has moved."""

    ob: bpy.types.Object
    member: Member
    entry: int
    """Who poses the body: its place among the entries of the binding."""
    position: Array
    """Generalized, shape (3,)."""
    rotation: Array
    """Generalized, shape (4,)."""
    bones: tuple[str, ...]
    """Bones, or controls, that bring the body to its place; they are the animator's while they are held."""

    @property
    def channel(self) -> str:
        """Name of the channel that poses the body."""
        return self.member.definition.channels[self.member.part.binding.entries[self.entry].channel].name

    @property
    def parts(self) -> tuple[str, ...]:
        """Values that are changed."""
        entry = self.member.part.binding.entries[self.entry]
        return tuple(part for part in ("position", "rotation") if getattr(entry, part))


def posed_by_hand(scene: bpy.types.Scene, graph: bpy.types.Depsgraph, shown: Mapping[int, Shown]) -> Held | None:
    """Return the body whose bone has been moved since it was last shown, None when there is none."""
    layer = bpy.context.view_layer
    ob = layer.objects.active if layer is not None else None
    if ob is None or ob.mode != "POSE" or ob.name not in scene.objects:
        return None
    before = shown.get(ob.session_uid)
    bone = bpy.context.active_pose_bone
    if before is None or bone is None or before.member.action != cast.action_of(ob):
        return None
    member = before.member
    moves = on_controls.moves(member)
    entry = entry_for(member, bone.name if moves is None else moves.get(bone.name, ""))
    if entry is None:
        return None
    now = pose.state(member.rig, list(before.state))
    chain = _chain(member, entry)
    if moves is not None:
        chain = tuple(control for control, own in moves.items() if own in chain)
    bones = pose_of(ob).bones
    if not any(pose.changed(before.state, now, bones.find(name)) for name in chain):
        return None
    before.state = now
    seen = ob.evaluated_get(graph)
    position, rotation = generalized(member, before, entry, seen, walks.layer_now(member, seen, graph))
    return Held(ob, member, entry, position, rotation, chain)


def entry_for(member: Member, bone: str) -> int | None:
    """Return who poses a bone, else a body that it brings to its place; the active channel first, None without one."""
    body = member.rig.skeleton.index.get(bone)
    entries = member.binding.entries
    posing = [i for i, e in enumerate(entries) if e.position or e.rotation]
    own = [i for i in posing if entries[i].body == body] or [i for i in posing if bone in _chain(member, i)]
    active = of_action(member.action).active_channel
    return next((i for i in own if entries[i].channel == active), own[0] if own else None)


def _chain(member: Member, entry: int) -> tuple[str, ...]:
    """Return the body of an entry and the bones that bring it to its place."""
    body = member.part.binding.entries[entry].body
    return tuple(member.rig.skeleton.names[b] for b in (*member.part.pose.joints_of(body), body))


def generalized(
    member: Member, shown: Shown, entry: int, seen: bpy.types.Object, lower: Layer | None
) -> tuple[Array, Array]:
    """Return the generalized values of an entry for where its bone is.

    Args:
        member: How the character plays its action.
        shown: What it shows.
        entry: Of its binding.
        seen: The evaluated object.
        lower: What its action is laid over.
    """
    binding = member.part.binding
    body = binding.entries[entry].body
    head, turned = pose.matrix_of(seen, member.rig.skeleton.names[body])
    place = member.character.local_to_character
    turn = quat.multiply(turned, quat.conjugate(member.rig.skeleton.rest_rotations[body]))
    position = place.points(head)
    rotation = quat.multiply(place.turns(turn), binding.bodies.axes[body])
    targets = shown.targets.places
    if lower is not None:  # values are those of a body that stands
        position, targets = lower.seen({0: position[None]})[0][0], lower.seen(targets)
        rotation = quat.multiply(quat.conjugate(lower.turns[0]), rotation)
    count = len(binding.entries)
    positions, rotations = np.tile(position, (1, count, 1)), np.tile(rotation, (1, count, 1))
    frames = specialize.frames_of(binding, targets, shown.played.followed)
    found_positions, found_rotations = movement.generalize(frames, positions, rotations)
    return found_positions[0, entry], found_rotations[0, entry]


def give(held: Held) -> None:
    """Take over a held body into its channel's values, which all characters of the action share."""
    entry = held.member.part.binding.entries[held.entry]
    item = of_rig(held.ob).channels[held.channel]
    if entry.position:
        item.position = held.position.tolist()
    if entry.rotation:
        near = held.rotation @ np.array(item.rotation) >= 0.0
        item.rotation = (held.rotation if near else -held.rotation).tolist()
    item.active_body = held.member.rig.skeleton.names[entry.body]
