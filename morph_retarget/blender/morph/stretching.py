"""Which bones can move off their parents, for limbs that stretch: in Blender, all that are not connected to these."""

from collections.abc import Sequence

from ...core.errors import listed
from ..rig import Rig


def connected(rig: Rig) -> frozenset[int]:
    """Return the bones whose heads stay at the tails of their parents: Blender ignores their locations."""
    bones = rig.armature.bones
    return frozenset(i for i, name in enumerate(rig.skeleton.names) if bones[name].use_connect)


def told(rig: Rig, stiff: Sequence[int]) -> list[str]:
    """Return what keeps limbs from stretching, in words.

    Args:
        rig: The armature.
        stiff: Connected bones that would have to move.
    """
    if not stiff:
        return []
    names = listed(repr(rig.skeleton.names[bone]) for bone in stiff)
    what, own = ("bones", "they are") if len(stiff) > 1 else ("bone", "it is")
    return [f"{what} {names} cannot stretch away from what {own} connected to: clear Connected in Edit Mode"]
