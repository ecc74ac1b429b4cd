"""Reading a file of jobs: TOML with ``[defaults]`` and any number of ``[[job]]``."""

import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ...core.errors import FileError, MorphError, listed
from .. import bone_maps
from .jobs import FILES, Refused, Wish, check_options, usual_options

_OWN = ("source", "target", "out")


def read(path: Path) -> list[Wish | Refused]:
    """Return what a file asks for; a job with a key or value that no job can have is refused, with its line.

    Raises:
        FileError: The file cannot be read, is no TOML, or says something wrong for all jobs; with the line.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise FileError(f"{path}: cannot be read as text: check the path and save it as UTF-8") from error
    found = _parsed(text, path)
    lines = _Lines(path, text)
    for key in found:
        if key not in ("defaults", "job"):
            raise FileError(f"{lines.of(key)}: there is no {key!r}: use [defaults] and [[job]]")
    defaults, jobs = found.get("defaults", {}), found.get("job", [])
    if not isinstance(defaults, dict):
        raise FileError(f"{lines.of('defaults')}: defaults is no table: write [defaults]")
    if not isinstance(jobs, list) or not all(isinstance(job, dict) for job in jobs):
        raise FileError(f"{lines.of('job')}: job is no list of tables: write [[job]]")
    if not jobs:
        raise FileError(f"{path}: holds no jobs: write [[job]] with source and target")
    _check_keys(defaults, lines, None)
    out: list[Wish | Refused] = []
    for i, job in enumerate(jobs):
        try:
            out.append(_wish(job, defaults, i, lines))
        except FileError as error:
            out.append(Refused(lines.called(i), str(error), (_shown(job.get("source")), _shown(job.get("target")))))
    return out


def _parsed(text: str, path: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        place = re.search(r" \(at (?:line (\d+), column \d+|end of document)\)$", str(error))
        rows = text.splitlines()
        line = int(place[1]) if place and place[1] else max(len(rows), 1)
        reason = str(error)[: place.start()] if place else str(error)
        key = re.match(r"""\s*["']?([\w-]+)["']?\s*=""", rows[line - 1] if line <= len(rows) else "")
        what = f"mend {key[1]!r} in this line" if key else "mend this line"
        raise FileError(f"{path}:{line}: is no TOML ({reason[:1].lower() + reason[1:]}): {what}") from error
    except (ValueError, RecursionError) as error:  # numbers of very many digits are no decoding errors
        raise FileError(f"{path}: is no TOML ({error or 'nested too deeply'}): mend it") from error


class _Lines:
    """Finds the lines that keys stand in, for messages."""

    def __init__(self, path: Path, text: str) -> None:
        self._path, self._rows = path, text.splitlines()
        self.folder = path.absolute().parent

    def called(self, job: int) -> str:
        """Return what a job is called where no result gives it a name."""
        return f"{self._path.name}: job {job + 1}"

    def of(self, key: str, job: int | None = None, table: bool = False) -> str:
        """Return file and line of a key.

        Args:
            key: In the table; its first line if it is not there.
            job: Which ``[[job]]``; what stands before all of them when None.
            table: Look into ``[defaults]``.
        """
        head = r"\s*\[\[\s*job\s*\]\]" if job is not None else r"\s*\[\s*defaults\s*\]" if table else None
        start = 0
        if head is not None:
            heads = [i for i, row in enumerate(self._rows) if re.match(head, row)]
            place = job or 0
            if place >= len(heads):  # written in another way, as `job = [{…}]`
                return self.of("job" if job is not None else "defaults")
            start = heads[place] + 1
        named = re.compile(rf"""\s*\[*\s*["']?{re.escape(key)}["']?\s*[=.\]]""")
        for i in range(start, len(self._rows)):
            if named.match(self._rows[i]):
                return f"{self._path}:{i + 1}"
            if head is not None and self._rows[i].lstrip().startswith("["):
                break
        return f"{self._path}:{max(start, 1)}"


def _check_keys(table: Mapping[str, Any], lines: _Lines, job: int | None) -> None:
    options = usual_options()
    for key, value in table.items():
        where = lines.of(key, job, table=job is None)
        if key in _OWN:
            kinds = "text" if key == "out" else "text or a list of texts"
            if not (isinstance(value, str) or (key != "out" and _texts(value))):
                raise FileError(f"{where}: {key} is no {kinds}: write it in quotes")
            continue
        if key not in options:
            raise FileError(f"{where}: there is no {key!r}: use {listed([*_OWN, *options], 40)}")
        try:
            check_options(_told({key: value}))
        except MorphError as error:
            raise FileError(f"{where}: {key}: {error}") from error
        if key == "name" and str(value).lower().endswith((".blend", ".glb", ".fbx", ".bvh")):
            raise FileError(f"{where}: name is what the action is called: use out for the file")


def _texts(value: object) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(item, str) for item in value)


def _told(table: Mapping[str, Any]) -> dict[str, str | bool]:
    """Return options as text.

    Raises:
        FileError: A value is of the wrong kind.
    """
    usual, out = usual_options(), dict[str, str | bool]()
    for key, value in table.items():
        takes_none = usual[key] is False
        if takes_none and not isinstance(value, bool):
            raise FileError(f"{value!r} is neither true nor false")
        if not takes_none and (isinstance(value, bool) or not isinstance(value, str | int | float)):
            raise FileError(f"{value!r} is neither text nor a number")
        if value is not False:
            out[key] = True if value is True else str(value)
    return out


def _wish(job: Mapping[str, Any], defaults: Mapping[str, Any], number: int, lines: _Lines) -> Wish:
    _check_keys(job, lines, number)
    both, base = {**defaults, **job}, lines.folder
    for key in ("source", "target"):
        if key not in both:
            raise FileError(f"{lines.of(key, number)}: the job has no {key}: name a file or a pattern")
    options = _told({key: value for key, value in both.items() if key not in _OWN})
    for key in FILES:
        if key in options:
            options[key] = str(bone_maps.file_of(str(options[key]), base))
            if not Path(str(options[key])).is_file():
                raise FileError(f"{lines.of(key, number)}: {options[key]}: no such file: check the path")
    return Wish(
        _listed(both["source"]),
        _listed(both["target"]),
        both.get("out"),
        options,
        base,
        lines.of("source", number),
        lines.called(number),
    )


def _listed(value: Any) -> tuple[str, ...]:
    return (value,) if isinstance(value, str) else tuple(value)


def _shown(value: object) -> str:
    return ", ".join(map(str, value)) if isinstance(value, list) else str(value or "")
