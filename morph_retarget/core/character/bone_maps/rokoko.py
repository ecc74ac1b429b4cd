"""Custom naming schemes of the add-on Rokoko Studio Live: for each of its joints the names that a bone may have.

Names are in lower case there, and are meant for any rig. What its users have paired by hand stands among them as
``custom_bone_…`` with the bone of the source and the bone of the target.
"""

import json
from collections.abc import Mapping
from typing import Any, cast

from ...errors import MappingError
from ..joints import SIDES
from .bone_map import ROKOKO, BoneMap, Pair

_CUSTOM = "custom_bone_"
_TRUNK = {"hip": "hips", "spine": "spine", "chest": "chest", "neck": "neck", "head": "head"}
_LIMBS = {
    "Shoulder": "Shoulder",
    "UpperArm": "UpperArm",
    "LowerArm": "LowerArm",
    "Hand": "Hand",
    "UpLeg": "UpperLeg",
    "Leg": "LowerLeg",
    "Foot": "Foot",
    "Toe": "Toes",
    "ThumbProximal": "ThumbMetacarpal",
    "ThumbMedial": "ThumbProximal",
    "ThumbDistal": "ThumbDistal",
    **{
        digit + theirs: digit + ours
        for digit in ("Index", "Middle", "Ring", "Little")
        for theirs, ours in (("Proximal", "Proximal"), ("Medial", "Intermediate"), ("Distal", "Distal"))
    },
}
JOINTS: Mapping[str, str] = _TRUNK | {side + theirs: side + ours for side in SIDES for theirs, ours in _LIMBS.items()}
"""Rokoko's joints and ours; there are none of theirs for the upper chest and the face."""


def looks_like(data: Mapping[str, Any]) -> bool:
    """Return whether plain data are a naming scheme of Rokoko's."""
    return "rokoko_custom_names" in data


def read(data: Mapping[str, Any], origin: str) -> BoneMap:
    """Return what a naming scheme says.

    Raises:
        MappingError: It has no bones, or they are no lists of names.
    """
    bones = data.get("bones")
    if not isinstance(bones, dict):
        raise MappingError(f"{origin}: has no table 'bones': export the naming scheme again")
    joints: dict[str, tuple[str, ...]] = {}
    pairs: list[Pair] = []
    left_out: list[str] = []
    for key, value in cast("dict[str, Any]", bones).items():
        names = _names(value, f"{origin}: bones[{key!r}]")
        if key.startswith(_CUSTOM) and len(names) >= 2:
            pairs.append(Pair(names[0], names[1]))
        elif key not in JOINTS:
            left_out.append(f"{key!r} is none of Rokoko's joints")
        elif names:
            joints[JOINTS[key]] = names
    return BoneMap(ROKOKO, origin, joints, pairs=tuple(pairs), left_out=tuple(left_out))


def write(joints: Mapping[str, str]) -> str:
    """Return joints as a naming scheme for Rokoko; those that it does not know are left out.

    Args:
        joints: Joint to bone.
    """
    bones = {theirs: [joints[ours].lower()] for theirs, ours in JOINTS.items() if joints.get(ours)}
    data = {"rokoko_custom_names": True, "version": 1, "bones": bones, "shapes": {}}
    return json.dumps(data, indent=4, ensure_ascii=False) + "\n"


def _names(value: object, place: str) -> tuple[str, ...]:
    """Return a list of names without empty ones.

    Raises:
        MappingError: It is none.
    """
    found = cast("list[object]", value) if isinstance(value, list) else None
    if found is None or not all(isinstance(name, str) for name in found):
        raise MappingError(f"{place} is {value!r:.40}: make it a list of names of bones")
    return tuple(name for name in cast("list[str]", found) if name)
