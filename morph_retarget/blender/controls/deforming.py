"""What a motion is found for on a rig with controls: its deform bones, as a rig of their own."""

from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import replace

import bpy

from ...core.character import deform_tree
from ...core.character.analysis import Overrides
from ...core.character.character import Character
from ...core.character.control_facts import AIMING, COPYING, MOST, BoneFacts
from ...core.character.controls import Wanted, without_names
from ..recognition import recognized
from ..rig import Rig, pose_of
from . import reading


def body_of(target: Rig, character: Character, keep: Iterable[str] = ()) -> tuple[Rig, Character] | None:
    """Return the deform bones of a rig with controls, and what they are; None for a rig that is posed by its bones.

    Args:
        target: The whole rig.
        character: What it is as a whole: its directions and what the user has said hold for the body too.
        keep: Further bones that belong to the body.
    """
    bones = pose_of(target.object).bones
    deform = {bone.name for bone in bones if bone.bone.use_deform}
    copies = {bone.name: _leading(target.object, bone, COPYING) for bone in bones}
    aims = {bone.name: _leading(target.object, bone, AIMING) for bone in bones}
    if not deform_tree.is_controlled(deform, copies):
        return None
    given = {joint: match.bone for joint, match in character.joints.items() if match.by == "user"}
    deform |= {*given.values(), *(name for name in keep if name in target.skeleton.index)}
    frame, dropped = character.frame, set[str]()
    while True:
        skeleton, rows = deform_tree.within(target.skeleton, deform - dropped, copies, aims)
        found = recognized(skeleton, target.placement, Overrides(frame.up, frame.forward, given))
        more = _segments(target.object, found)
        if not more or dropped:
            break
        dropped = more
    if not _follows(found, copies):
        return None
    own = replace(target, skeleton=skeleton, pose_order=target.pose_order[rows])
    return own, replace(found, frame=frame, floor=character.floor)


def _follows(body: Character, copies: Mapping[str, Sequence[str]]) -> bool:
    """Return whether most of what poses a body copies others: not skirts alone that copy legs, or twist bones."""
    names = body.skeleton.names
    posing = [names[bone] for chain in (body.spine, *(limb.bones for limb in body.limbs)) for bone in chain]
    return 2 * sum(bool(copies.get(name)) for name in posing) >= len(posing)


def _segments(ob: bpy.types.Object, found: Character) -> set[str]:
    """Return bones of limbs, neck and tails that no control turns: they bend with those before them."""
    names, roles = found.skeleton.names, {joint: match.bone for joint, match in found.joints.items()}
    bones = pose_of(ob).bones
    facts = [
        BoneFacts(b.name, b.parent.name if b.parent else None, b.bone.use_deform, b.custom_shape is not None)
        for b in bones
    ]
    chains = [*(limb.bones for limb in found.limbs), found.neck, *found.tails]
    lines = [names[bone] for chain in chains for bone in chain]
    loose = without_names(facts, Wanted([*lines, *roles.values()], roles))
    return loose.intersection(lines) - set(roles.values())


def _leading(ob: bpy.types.Object, bone: bpy.types.PoseBone, kinds: Container[str]) -> Sequence[str]:
    """Return the bones of the same armature that a bone follows by some kinds of constraints."""
    found = [c for c in bone.constraints if c.type in kinds and not c.mute and c.influence >= MOST]
    return [name for constraint in found for name in reading.targets(ob, constraint)]
