"""Files that texts and patterns mean."""

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from ...core.errors import FileError
from ..io.load import KINDS

_WILD = ("*", "?", "[")


@dataclass(frozen=True)
class Found:
    """A file that was asked for."""

    path: Path
    action: str | None
    label: str
    """As it is named in reports."""
    folder: str
    """Folder that it was found in, below the part of the pattern that has no wild cards; with slashes."""
    by_pattern: bool


def find(text: str, base: Path) -> list[Found]:
    """Return the files that ``FILE``, ``PATTERN``, ``FILE#ACTION`` or ``PATTERN#ACTION`` mean, in order.

    Args:
        text: What was asked for; ``**`` stands for any folders.
        base: Folder that it starts from.

    Raises:
        FileError: There is no such file, or no file like that.
    """
    named, action = _parts(text, base)
    if (base / named).is_file():
        return [Found(_whole(base / named), action, text, "", by_pattern=False)]
    if not any(sign in named for sign in _WILD):
        what = "is a folder: write FOLDER/**/*.bvh" if (base / named).is_dir() else "no such file: check the path"
        raise FileError(f"{named}: {what}")
    pieces = Path(named).parts
    still = next(i for i, piece in enumerate(pieces) if any(sign in piece for sign in _WILD))
    start = base.joinpath(*pieces[:still])
    try:
        paths = sorted(path for path in start.glob("/".join(pieces[still:])) if _usable(path, start))
    except (ValueError, OSError, NotImplementedError) as error:
        raise FileError(f"{named}: is no pattern of files ({error}): use *, ? and **") from error
    if not paths:
        raise FileError(f"{named}: no file is like that: check the pattern (kinds: {', '.join(KINDS)})")
    lead = Path(*pieces[:still])
    out: list[Found] = []
    for path in paths:
        below = path.relative_to(start)
        label = (lead / below).as_posix() + ("" if action is None else f"#{action}")
        out.append(Found(_whole(path), action, label, _folder(below), by_pattern=True))
    return out


def below(folder: Path) -> Iterator[str]:
    """Yield all clips in a folder and the folders in it, from it on, in order; hidden ones are left out."""
    for place, folders, names in os.walk(folder):
        folders[:] = sorted(name for name in folders if not name.startswith("."))
        for name in sorted(names):
            path = Path(place, name)
            if _usable(path, folder):
                yield path.relative_to(folder).as_posix()


def as_found(text: str, base: Path) -> list[Found]:
    """Return a file below a folder, as `below` yields them; its name means nothing else."""
    return [Found(_whole(base / text), None, text, _folder(Path(text)), by_pattern=True)]


def _usable(path: Path, start: Path) -> bool:
    hidden = any(piece.startswith(".") for piece in path.relative_to(start).parts)
    return path.suffix.lower() in KINDS and not hidden and path.is_file()


def _parts(text: str, base: Path) -> tuple[str, str | None]:
    """Return file or pattern, and the action behind a ``#``, which may also be part of a file's name."""
    if "#" not in text or (base / text).exists():
        return text, None
    pieces = text.split("#")
    for i in range(1, len(pieces)):
        named = "#".join(pieces[:i])
        if Path(named).suffix.lower() in KINDS or named.endswith("*"):
            return named, "#".join(pieces[i:]) or None
    return text, None


def _folder(path: Path) -> str:
    return "" if path.parent == Path() else path.parent.as_posix()


def _whole(path: Path) -> Path:
    return Path(os.path.abspath(path))  # noqa: PTH100 - resolve() would follow links, whose names count
