"""The canonical joints: VRM 1.0 humanoid bone names, their tree, their order and their mirror images."""

from collections.abc import Mapping
from dataclasses import dataclass

from ..errors import MappingError, listed
from ..skeleton import Skeleton

_LIMBS = ("Shoulder", "UpperArm", "LowerArm", "Hand"), ("UpperLeg", "LowerLeg", "Foot", "Toes")
_FINGERS = {
    "Thumb": ("Metacarpal", "Proximal", "Distal"),
    "Index": ("Proximal", "Intermediate", "Distal"),
    "Middle": ("Proximal", "Intermediate", "Distal"),
    "Ring": ("Proximal", "Intermediate", "Distal"),
    "Little": ("Proximal", "Intermediate", "Distal"),
}
SIDES = ("left", "right")


def _parents() -> dict[str, str | None]:
    out: dict[str, str | None] = {
        "hips": None,
        "spine": "hips",
        "chest": "spine",
        "upperChest": "chest",
        "neck": "upperChest",
        "head": "neck",
        "jaw": "head",
    }
    for side in SIDES:
        out[f"{side}Eye"] = "head"
    for chain, top in zip(_LIMBS, ("upperChest", "hips"), strict=True):
        for side in SIDES:
            above = top
            for joint in chain:
                out[side + joint] = above
                above = side + joint
    for side in SIDES:
        for digit, segments in _FINGERS.items():
            above = f"{side}Hand"
            for segment in segments:
                out[side + digit + segment] = above
                above = side + digit + segment
    return out


PARENTS: Mapping[str, str | None] = _parents()
"""Every canonical joint, parents first, and the joint above it."""
FINGER_JOINTS = frozenset(s + d + j for s in SIDES for d, js in _FINGERS.items() for j in js)


def mirrored(joint: str) -> str:
    """Return the joint of the other side; trunk joints are their own mirror image."""
    for side, other in (SIDES, SIDES[::-1]):
        if joint.startswith(side):
            return other + joint[len(side) :]
    return joint


@dataclass(frozen=True)
class JointMatch:
    """A bone that was found for a joint."""

    bone: str
    confidence: float
    """0 … 1."""
    by: str
    """What decided: "name", "topology", "geometry", "user" or "preset"."""


def in_order(matches: Mapping[str, JointMatch]) -> dict[str, JointMatch]:
    """Return ``matches`` sorted like `PARENTS`."""
    return {joint: matches[joint] for joint in PARENTS if joint in matches}


def check_names(mapping: Mapping[str, str], skeleton: Skeleton) -> None:
    """Check a mapping from joints to bones, where an empty bone means "none".

    Raises:
        MappingError: A joint or a bone does not exist, or one bone is given to two joints.
    """
    unknown = [joint for joint in mapping if joint not in PARENTS]
    if unknown:
        raise MappingError(f"unknown joint {listed(map(repr, unknown))}: the names are {listed(PARENTS, 60)}")
    missing = {joint: bone for joint, bone in mapping.items() if bone and bone not in skeleton.index}
    if missing:
        joint, bone = next(iter(missing.items()))
        more = f" (and {len(missing) - 1} more)" if len(missing) > 1 else ""
        raise MappingError(
            f"joint {joint} is mapped to bone {bone!r}, which the armature does not have{more}: correct the map"
        )
    seen: dict[str, str] = {}
    for joint, bone in mapping.items():
        if bone and bone in seen:
            raise MappingError(f"bone {bone!r} is mapped to both {seen[bone]} and {joint}: keep one")
        seen[bone] = joint


def override(found: Mapping[str, JointMatch], given: Mapping[str, str], skeleton: Skeleton) -> dict[str, JointMatch]:
    """Return ``found`` with the user's own choices in their place; a bone given to a joint leaves its old one.

    Raises:
        MappingError: See `check_names`.
    """
    check_names(given, skeleton)
    taken = {bone for bone in given.values() if bone}
    out = {joint: match for joint, match in found.items() if joint not in given and match.bone not in taken}
    out |= {joint: JointMatch(bone, 1.0, "user") for joint, bone in given.items() if bone}
    return in_order(out)
