"""Libraries of motions as characters name them: read from their files once, and again when those change."""

from collections.abc import Iterable
from pathlib import Path

import bpy

from ...core.character.character import Character
from ...core.clips.models.controller import BASE
from ...core.clips.motions import library_file
from ...core.clips.motions.library import Library
from ...core.directing import starter

Stamp = tuple[str, int, int]
"""A file, when it was written, and its size."""
GOING = {"go", "turn", "walk"}
"""Whoever is told one of these needs the motions of all."""
MOST = 16
"""Starter libraries of no more characters are kept."""
_read: dict[Path, tuple[Stamp, Library]] = {}
_starters: dict[Character, Library] = {}
"""Those used last at the end."""


def forget() -> None:
    """Drop all that was read."""
    _read.clear()
    _starters.clear()


def stamp(path: Path) -> Stamp:
    """Return what is equal as long as a file holds the same library."""
    try:
        found = path.stat()
    except OSError:
        return str(path), 0, 0  # reading it will tell
    return str(path), found.st_mtime_ns, found.st_size


def text_of(path: Path) -> str:
    """Return a file as settings keep it: as seen from the open file where that is above it, so both can move."""
    folder = Path(bpy.data.filepath).parent if bpy.data.filepath else None
    return str(path) if folder is None or folder not in path.parents else f"//{path.relative_to(folder).as_posix()}"


def read(path: Path) -> Library:
    """Return the library of a file.

    Raises:
        FileError: It cannot be read.
    """
    now, known = stamp(path), _read.get(path)
    if known is None or known[0] != now:
        known = _read[path] = now, library_file.load(path)
    return known[1]


def of(character: Character, file: Stamp | None, models: Iterable[str]) -> Library:
    """Return the library of a character that is told to use some models.

    Args:
        character: What it is.
        file: Of its library; None for the starter library, of which only what is used is made.
        models: Names that commands use; those that it has not are told by the controller.

    Raises:
        FileError: The file cannot be read.
        RigError: The character cannot be posed.
    """
    known = _starters.get(character) if file is None else read(Path(file[0]))
    names = {BASE, *models} if file is None else {BASE}
    if names & GOING:
        names |= GOING
    wanted = [kind for kind in starter.kinds_of_starter() if kind in names]
    if known is None:
        known = starter.starter(character, wanted)
    elif not set(wanted) <= set(known.kinds):
        known = starter.completed(known, wanted)
    if file is None:
        _starters.pop(character, None)
        _starters[character] = known
        if len(_starters) > MOST:
            del _starters[next(iter(_starters))]
    else:
        _read[Path(file[0])] = file, known
    return known


def kept(character: Character, path: Path | None) -> Library | None:
    """Return the library of a character as far as it was read or made already, None if it was not."""
    if path is None:
        return _starters.get(character)
    known = _read.get(path)
    return None if known is None else known[1]
