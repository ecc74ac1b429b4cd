"""Tracks that many acts have: feet that stand, hips that sink, tails that follow, hands that turn."""

from collections.abc import Mapping
from dataclasses import replace
from functools import partial

import numpy as np

from morph_retarget.core import quat
from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.morph.branch import Answer, Branch
from morph_retarget.core.morph.channels import Channel, MirrorRule, TargetKind
from morph_retarget.core.morph.context import Context, Depth, Height, Space
from morph_retarget.core.morph.movement import Movement, RotationMode, ScaleMode

from ..acting import Track, Vector

Keys = Mapping[int, Vector]
"""Positions or rotations by frame."""
REST: Vector = (0.0, 0.0, 0.0)
FIRM, FIRST = 2, 3
"""Priority of feet that stand, and of those that do something else."""
GRASPER, MOUTH, FOOT = Context(Capability.GRASPER), Context(Capability.MOUTH), Context(Capability.FOOT)
FRONT_FEET = replace(FOOT, depth=Depth.FRONT, depth_space=Space.SETSPACE)
HANDED = Branch(upright_spine=Answer.TRUE, has_graspers=Answer.TRUE, has_wings=Answer.FALSE)
"""Who has hands rather than a mouth, paws or wings to use."""
WITH_VARIANT = MirrorRule.VARIANT
limb = partial(Movement, scale=ScaleMode.LIMB_LENGTH)


def feet(weight: Mapping[int, float] | None = None) -> Track:
    """Return feet that stay where they stand, whatever the body does."""
    channel = Channel("Feet", FOOT, limb(ground_relative=True), priority=FIRM, mirror=MirrorRule.LEFT)
    return Track(channel, {1: REST}, {1: REST}, weight or {})


def root(position: Keys, turn: Keys | None = None, mirror: MirrorRule = MirrorRule.NEVER) -> Track:
    """Return the hips, which sink by shares of their height."""
    channel = Channel("Root", Context(Capability.ROOT), limb(ground_relative=True), mirror=mirror)
    return Track(channel, position, turn or {1: REST})


def turning(name: str, context: Context | Capability, turn: Keys, mirror: MirrorRule = MirrorRule.NEVER) -> Track:
    """Return bodies that only turn."""
    context = context if isinstance(context, Context) else Context(context)
    return Track(Channel(name, context, poses_position=False, mirror=mirror), turn=turn)


spine = partial(turning, "Spine", Capability.SPINE)
trunk = partial(turning, "Trunk", Context(Capability.SPINE, depth=Depth.BACK))
"""The spine without a neck that is part of it: a snake reaches with that."""
head = partial(turning, "Head", Capability.HEAD)
neck = partial(turning, "Neck", Capability.NECK)
wings = partial(turning, "Wings", Capability.WING, mirror=MirrorRule.LEFT)
ears = partial(turning, "Ears", Capability.EAR, mirror=MirrorRule.LEFT)


def tail(base: Keys | None = None, tip: Keys | None = None) -> tuple[Track, ...]:
    """Return a tail that does not swing along when its carrier turns; its outer half follows late.

    What lies on the ground, as a snake's body does, is only swept to the sides.
    """
    base, tip = base or {1: REST}, tip or {1: REST}
    whole = Context(Capability.TAIL)
    outer = replace(whole, depth=Depth.BACK, depth_space=Space.SETSPACE)
    flat = [{frame: (0.0, 0.0, yaw) for frame, (_, _, yaw) in turn.items()} for turn in (base, tip)]
    if flat == [base, tip]:
        return turning("Tail Tip", outer, tip), turning("Tail", whole, base)
    high, high_outer = replace(whole, height=Height.TOP), replace(outer, height=Height.TOP)
    return (
        turning("Tail Tip", high_outer, tip),
        turning("Tail", high, base),
        turning("Low Tail", whole, flat[0]),
    )


def mouths(opening: Mapping[int, float] | None = None) -> Track:
    """Return mouths that stay with their heads, and open."""
    channel = Channel("Mouths", MOUTH, limb(), position_weight=0.0, rotation_weight=0.0, priority=1)
    return Track(channel, deforms={"open": opening or {1: 0.0}})


def graspers(position: Keys, movement: Movement | None = None, closed: Mapping[int, float] | None = None) -> Track:
    """Return all graspers, authored on the left."""
    channel = Channel("Graspers", GRASPER, movement or limb(), poses_rotation=False, mirror=MirrorRule.LEFT)
    return Track(channel, position, deforms={"closed": closed} if closed else {})


def palms(turn: Keys, weight: Mapping[int, float], group: str = "") -> Track:
    """Return hands turned the same way however they rest, as far as the weight goes."""
    channel = Channel(
        "Palms",
        GRASPER,
        Movement(rotation=RotationMode.ABSOLUTE),
        poses_position=False,
        varies=bool(group),
        variant_group=group,
        mirror=MirrorRule.LEFT,
    )
    return Track(channel, turn=turn, weight=weight)


def eyes(weight: Mapping[int, float]) -> Track:
    """Return eyes on the target."""
    channel = Channel(
        "Eyes", Context(Capability.EYE), Movement(look_at=True), TargetKind.EXTERNAL, poses_position=False
    )
    return Track(channel, turn={1: REST}, weight=weight)


def facing(fingers: Vector, back: Vector) -> Vector:
    """Return the rotation vector [deg] of a hand whose fingers and back point in two directions."""
    forward = np.array(fingers) / np.linalg.norm(fingers)
    up = np.array(back) - (np.array(back) @ forward) * forward
    up /= np.linalg.norm(up)
    matrix = np.stack([np.cross(-forward, up), -forward, up], axis=-1)
    x, y, z = np.degrees(quat.to_rotation_vector(quat.from_matrix(matrix))).tolist()
    return x, y, z
