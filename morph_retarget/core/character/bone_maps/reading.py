"""Reading bone maps: which tool wrote one is seen from what is in it. Nothing in a map is ever executed."""

from typing import Any, cast

from .. import map_file
from . import expy_kit, pair_maps, rokoko
from .bone_map import OURS, BoneMap


def read(text: str, origin: str) -> BoneMap:
    """Return what a bone map says.

    Args:
        text: Of the file.
        origin: Where it came from, for messages.

    Raises:
        MappingError: It is no bone map, or something in it is not as it must be.
    """
    text = text.removeprefix("\ufeff")
    if expy_kit.looks_like(text):
        return expy_kit.read(text, origin)
    data = map_file.plain(text, origin)
    if isinstance(data, dict):
        table = cast("dict[str, Any]", data)
        for looks_like, reader in (
            (rokoko.looks_like, rokoko.read),
            (pair_maps.is_keemap, pair_maps.read_keemap),
            (pair_maps.is_mwni, pair_maps.read_mwni),
        ):
            if looks_like(table):
                return reader(table, origin)
    joints = {joint: (bone,) if bone else () for joint, bone in map_file.parse(text, origin).items()}
    controls, reaches = map_file.parse_controls(text, origin), map_file.parse_reaches(text, origin)
    return BoneMap(OURS, origin, joints, controls, reaches)
