"""Characters for the command line that are asked for by the file: each armature of it is one, or one that is named."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import bpy

from ...core.errors import FileError, listed
from ..io import load
from ..io.load import Request
from ..io.quiet import quiet
from .action_file import is_open
from .opening import armature_here


@dataclass(frozen=True)
class CharacterFile:
    """An armature and where it is."""

    path: Path | None
    """None for the open file."""
    armature: str | None
    """None for the one with the most bones."""
    label: str
    """What it is called."""

    def open(self) -> list[bpy.types.Object]:
        """Open its file and return the armatures in it; those of the open file are there already.

        Raises:
            FileError: See `load.load`.
        """
        if self.path is None:
            return [ob for ob in bpy.data.objects if ob.type == "ARMATURE"]
        return load.load(Request(self.path))

    def among(self, armatures: Sequence[bpy.types.Object]) -> bpy.types.Object:
        """Return it among the armatures of its file.

        Raises:
            FileError: It is not there.
        """
        if self.armature is None:
            return armatures[0]
        found = next((ob for ob in armatures if self.armature in (ob.name, ob.data and ob.data.name)), None)
        if found is None:
            names = listed([ob.name for ob in armatures])
            raise FileError(f"{self.path}: has no armature {self.armature!r}: choose one of {names}")
        return found


def all_found(texts: Sequence[str]) -> list[CharacterFile]:
    """Return the characters that ``FILE``, ``FILE#Armature`` or names of armatures in the open file mean.

    A .blend file means all of its armatures, other files the one with the most bones. Those of the open file come
    first: it is closed when others are opened.

    Raises:
        FileError: A file is not there, of an unknown kind or unreadable.
    """
    out: list[CharacterFile] = []
    for text in texts:
        if armature_here(text) is not None:
            out.append(CharacterFile(None, text, text))
            continue
        request = Request.parse(text)
        request.check()
        names = [request.action] if request.action or request.path.suffix.lower() != ".blend" else _in(request.path)
        for name in names:
            several = request.action or len(names) > 1
            label = f"{request.path.stem}#{name}" if several else request.path.stem
            out.append(CharacterFile(request.path, name, label))
    twice = [found for i, found in enumerate(out) if found in out[:i]]
    if twice:
        raise FileError(f"{twice[0].label}: is there twice: name each character once")
    return _told_apart(sorted(out, key=lambda found: found.path is not None))


def _in(path: Path) -> list[str | None]:
    """Return the names of the armatures in a .blend file, without leaving anything of it in the open one."""
    if is_open(path):
        return [*sorted(ob.name for ob in bpy.data.objects if ob.type == "ARMATURE")]
    before = set(bpy.data.libraries)
    try:
        with quiet(errors=True), bpy.data.libraries.load(str(path), link=True) as (theirs, ours):  # pyright: ignore[reportGeneralTypeIssues]
            ours.objects = list(theirs.objects)
        names = [ob.name for ob in ours.objects if ob is not None and ob.type == "ARMATURE"]
    except OSError as error:
        raise FileError(f"{path}: is no blend file that this Blender can read: save it again") from error
    finally:
        bpy.data.batch_remove([library for library in bpy.data.libraries if library not in before])
    if not names:
        raise FileError(f"{path}: holds no armature: choose a file with a rig in it")
    return [*sorted(names)]


def _told_apart(found: Sequence[CharacterFile]) -> list[CharacterFile]:
    """Return characters that are called by their paths where their names are the same."""
    labels = [own.label for own in found]
    return [
        own if labels.count(own.label) == 1 else CharacterFile(own.path, own.armature, f"{own.path}#{own.armature}")
        for own in found
    ]
