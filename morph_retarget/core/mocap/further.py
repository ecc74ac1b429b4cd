"""Further bones of a target that turn as a joint of the source does: a second pair of arms, a hat, a shadow."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ..character.character import Character
from ..character.joints import PARENTS
from ..errors import MappingError

Also = Sequence[tuple[str, str]]
"""Canonical joints of the source, each with a further bone of the target."""


@dataclass(frozen=True)
class Further:
    """A further bone, found on both bodies."""

    name: str
    """Of its link: "leftHand+Claw.L"."""
    source: int
    target: int
    above: str
    """The link that carries it."""


def is_further(name: str) -> bool:
    """Return whether a link is that of a further bone."""
    return "+" in name


def joint_of(name: str) -> str:
    """Return the joint that the link of a further bone follows; any other link is its own."""
    return name.partition("+")[0]


def find(source: Character, target: Character, taken: Mapping[int, str], joint: str, bone: str) -> Further:
    """Return how a further bone follows a joint.

    Args:
        source: The body that moves.
        target: The body that shall move likewise.
        taken: Bones of the target that are linked already, with the names of their links.
        joint: Canonical joint of the source.
        bone: Name of the target's bone.

    Raises:
        MappingError: There is no such joint or bone, or the bone is linked already.
    """
    if joint not in PARENTS:
        raise MappingError(
            f"bone {bone!r} is to follow {joint!r}, which is no joint: use VRM 1.0 names such as leftHand"
        )
    here, there = source.bone(joint), target.skeleton.index.get(bone)
    if there is None:
        raise MappingError(f"bone {bone!r} is to follow {joint}, but the target has no such bone: correct its name")
    if here is None:
        raise MappingError(f"bone {bone!r} is to follow {joint}, which the source does not have: map it by hand")
    if there in taken:
        raise MappingError(f"bone {bone!r} is to follow {joint}, but is {taken[there]} already: take it off there")
    above = next((taken[b] for b in target.skeleton.tree.ancestors[there] if b in taken), "hips")
    return Further(f"{joint}+{bone}", here, there, above)
