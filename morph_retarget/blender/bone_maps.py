"""Bone maps for rigs: files of any tool that is known, and the presets that come with the extension."""

from pathlib import Path

from ..core.character import families
from ..core.character.analysis import Overrides
from ..core.character.bone_maps import placing, reading
from ..core.character.bone_maps.bone_map import BoneMap
from ..core.character.bone_maps.placing import Placed
from ..core.character.character import Character
from ..core.character.families import Family
from ..core.errors import FileError
from . import retarget
from .rig import Rig

MOST_BYTES = 8 * 1024 * 1024
"""A larger file is no bone map."""


def load(path: Path) -> BoneMap:
    """Read a bone map.

    Raises:
        FileError: It cannot be read.
        MappingError: It is no bone map.
    """
    try:
        size = path.stat().st_size
        if size > MOST_BYTES:
            raise FileError(f"{path}: has {size // 1024**2} MB, which no bone map has: choose another file")
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError, ValueError) as error:  # a path may hold what none can
        raise FileError(f"{path}: cannot be read as a bone map: check the path") from error
    return reading.read(text, str(path))


def file_of(name: str, folder: Path | None = None) -> Path:
    """Return the file that holds a map: of that name, or else of the preset that is called so.

    Args:
        name: What the user has named.
        folder: Where names of files begin; where the program runs when None.
    """
    path = (folder or Path()) / name
    known = {family.name.casefold(): family.path for family in families.shipped()}
    return path if path.exists() else known.get(name.casefold(), path)


def find(name: str) -> BoneMap | Family:
    """Return the map that a file holds, or the preset of that name where there is no such file.

    Raises:
        FileError: The file cannot be read.
        MappingError: It is no bone map.
    """
    path = file_of(name)
    return families.named(path.stem) if path.parent == families.FOLDER else load(path)


def place(
    given: BoneMap | Family | None, own: Rig, overrides: Overrides | None = None, other: Character | None = None
) -> Placed:
    """Return what a map says of a rig, nothing without a map.

    Args:
        given: The map.
        own: The rig.
        overrides: What else the user knows better about it.
        other: What the rig at the other end is, for maps that pair two rigs.

    Raises:
        MappingError: It fits no bone of the rig, or is for two rigs of which neither is this one.
    """
    if given is None:
        return Placed({}, {})
    if isinstance(given, BoneMap) and given.exact:
        return placing.to_the_letter(given)
    return placing.place(given, retarget.character_of(own, overrides), other)
