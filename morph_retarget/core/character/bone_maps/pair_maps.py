"""Maps that name a bone of a source for each bone of a target: those of KeeMap and of Mwni's Animation Retargeting.

Both hold corrections of rotations besides, which are theirs alone: here rest poses are matched without.
"""

import json
from collections.abc import Mapping
from typing import Any, cast

from ...errors import MappingError
from .bone_map import KEEMAP, MWNI, BoneMap, Pair

_KEEMAP_KEYS = ("SourceBoneName", "DestinationBoneName")
_MWNI_KEYS = ("source", "target")


def is_keemap(data: Mapping[str, Any]) -> bool:
    """Return whether plain data are a map of KeeMap."""
    return isinstance(data.get("bones"), list)


def is_mwni(data: Mapping[str, Any]) -> bool:
    """Return whether plain data are a ``.blend-retarget`` file of Animation Retargeting."""
    return isinstance(data.get("mappings"), list)


def read_keemap(data: Mapping[str, Any], origin: str) -> BoneMap:
    """Return what a map of KeeMap says.

    Raises:
        MappingError: An entry is not as it must be.
    """
    return _read(KEEMAP, "bones", _KEEMAP_KEYS, data, origin)


def read_mwni(data: Mapping[str, Any], origin: str) -> BoneMap:
    """Return what a file of Animation Retargeting says.

    Raises:
        MappingError: An entry is not as it must be.
    """
    return _read(MWNI, "mappings", _MWNI_KEYS, data, origin)


def paired(source: Mapping[str, str], target: Mapping[str, str]) -> dict[str, Pair]:
    """Return the bones of two rigs side by side, by joint.

    Args:
        source: Joint to bone of the rig that moves.
        target: The same of the rig that shall move.
    """
    return {joint: Pair(source[joint], bone) for joint, bone in target.items() if source.get(joint) and bone}


def write_keemap(pairs: Mapping[str, Pair], source: str, target: str) -> str:
    """Return pairs of bones as a map for KeeMap, whose corrections are to be calculated there.

    Args:
        pairs: By joint; the hips carry the position.
        source: Name of the armature that moves.
        target: Name of the armature that shall move.
    """
    zeros = ("CorrectionFactor", "position_correction_factor")
    bones = [
        {
            "name": pair.source,
            "label": joint,
            "description": "",
            "SourceBoneName": pair.source,
            "DestinationBoneName": pair.target,
            "keyframe_this_bone": True,
            **{name + axis: 0.0 for name in zeros for axis in "XYZ"},
            "position_gain": 1.0,
            "has_twist_bone": False,
            "TwistBoneName": "",
            "set_bone_position": joint == "hips",
            "set_bone_rotation": True,
            "bone_rotation_application_axis": "XYZ",
        }
        for joint, pair in pairs.items()
    ]
    data = {"bones": bones, "source_rig_name": source, "destination_rig_name": target}
    return json.dumps(data, indent=1, ensure_ascii=False) + "\n"


def _read(tool: str, key: str, names: tuple[str, str], data: Mapping[str, Any], origin: str) -> BoneMap:
    pairs: list[Pair] = []
    left_out: list[str] = []
    for i, entry in enumerate(data[key]):
        if not isinstance(entry, dict):
            raise MappingError(f"{origin}: {key}[{i}] is {entry!r:.40}: save the map again with {tool}")
        source, target = (_name(cast("dict[str, Any]", entry), name, f"{origin}: {key}[{i}]") for name in names)
        if source and target:
            pairs.append(Pair(source, target))
        else:
            left_out.append(f"{source or target or f'{key}[{i}]'!r} has no partner")
    return BoneMap(tool, origin, pairs=tuple(pairs), left_out=tuple(left_out))


def _name(entry: Mapping[str, Any], key: str, place: str) -> str:
    if key not in entry:
        raise MappingError(f"{place} has no {key}: give it the name of a bone")
    if not isinstance(entry[key], str):
        raise MappingError(f"{place}.{key} is {entry[key]!r:.40}: give it the name of a bone")
    return entry[key]
