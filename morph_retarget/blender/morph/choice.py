"""Choosing a variant by itself: the one whose bodies are nearest to their targets (Hecker 2008 §4.1.2)."""

import bpy
import numpy as np

from ...core.arrays import Array
from ...core.errors import MotionError
from ...core.morph.bind import NONE, Binding, bind
from ...core.morph.channels import TargetKind
from ...core.morph.context import TIE
from ...core.morph.variants import nearest
from . import stage
from .member import Member


def nearest_variant(member: Member, ob: bpy.types.Object, graph: bpy.types.Depsgraph) -> int:
    """Return the variant whose bodies have the shortest way from rest to their targets at the present frame.

    Raises:
        MotionError: No channel that plays has a target.
    """
    external = stage.targets_of(member, ob, graph)
    channels, bodies = member.definition.channels, member.bodies
    outside = [i for i, c in enumerate(channels) if c.has_target and c.target is TargetKind.EXTERNAL]
    missing = {i for i in outside if i not in external}

    def ways(found: Binding) -> list[tuple[Array, Array]]:
        aimed = [e for e in found.entries if channels[e.channel].has_target]
        return [
            (bodies.positions[e.body], external[e.channel][0] if e.target == NONE else bodies.positions[e.target])
            for e in aimed
            if e.position or e.rotation
        ]

    count = len(member.part.binding.variants)
    found = [ways(bind(member.definition, bodies, variant, missing)) for variant in range(count)]
    most = max((len(pairs) for pairs in found), default=0)
    if not most:
        raise MotionError(f"no channel has a target on {ob.name!r}: choose a variant by number")
    both = np.full((count, most, 2, 3), np.nan)
    for variant, pairs in enumerate(found):
        for i, pair in enumerate(pairs):
            both[variant, i] = pair
    return nearest(both[:, :, 0], both[:, :, 1], TIE * bodies.size)
