"""The record of a batch on the disk: what was begun and what is done, so that a later run can go on.

One JSON object a line, added and handed to the system at once; a line that is cut short, as when the machine stops, is
the last one and counts as not written. The last line of a job counts.
"""

import contextlib
import errno
import json
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, BinaryIO, TextIO

from ...core.errors import FileError
from .prints import digest
from .results import Answer

FOLDER = ".morph_retarget"
"""In the folder of the results."""
BEGUN, DONE, LOST = "begun", "done", "lost"


class Ledger:
    """The record of one run, and of those before it."""

    def __init__(self, folder: Path, entries: Mapping[str, dict[str, Any]], stream: BinaryIO) -> None:
        self._folder, self._entries, self._stream = folder, dict(entries), stream
        self._before: dict[str, dict[str, Any]] = {}

    def begun(self, name: str, key: str, worker: int) -> None:
        """Record that a worker works on a job; its files may be there from now on.

        Args:
            name: Of the job.
            key: What it depends on, see `prints.key`.
            worker: Process number.

        Raises:
            FileError: It cannot be written, as when the disk is full; so for `done` and `lost`.
        """
        self._before[name] = self.entry(name)
        self._add({"job": name, "state": BEGUN, "key": key, "worker": worker})

    def done(self, name: str, key: str, answer: Answer) -> None:
        """Record that a job is done, with what its results hold."""
        files = {file: digest(self._folder / file) for file in answer.files}
        told = {"reports": list(answer.reports), "seconds": answer.seconds, "files": files}
        told["drawings"] = list(answer.drawings)
        self._add({"job": name, "state": DONE, "key": key, **told})

    def lost(self, name: str) -> None:
        """Record that a job wrote nothing: what an earlier run wrote is what there is."""
        before = self._before.get(name, {})
        self._add(before if before.get("state") == DONE else {"job": name, "state": LOST})

    def entry(self, name: str) -> dict[str, Any]:
        """Return what was last recorded of a job; nothing if it is new."""
        return self._entries.get(name, {})

    def whole(self, name: str) -> bool:
        """Return whether all results of a job are there, as they were written."""
        files = self.entry(name).get("files", {})
        return bool(files) and all(
            (self._folder / file).is_file() and digest(self._folder / file) == was for file, was in files.items()
        )

    def ours(self, name: str) -> bool:
        """Return whether what is there of a job's results was written by a run: then another may replace it."""
        entry = self.entry(name)
        if entry.get("state") == BEGUN:
            return True
        there = {file: was for file, was in entry.get("files", {}).items() if (self._folder / file).is_file()}
        return entry.get("state") == DONE and all(digest(self._folder / file) == was for file, was in there.items())

    def _add(self, entry: dict[str, Any]) -> None:
        """Write a line, whole or not at all."""
        line, size = json.dumps(entry).encode() + b"\n", self._stream.seek(0, os.SEEK_END)
        try:
            if self._stream.write(line) < len(line):
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        except OSError as error:
            with contextlib.suppress(OSError):  # what is cut short counts as not written anyway
                self._stream.truncate(size)
            raise FileError(f"{self._folder}: the record cannot be written ({error.strerror}): free space") from error
        self._entries[entry["job"]] = entry


@contextlib.contextmanager
def opened(folder: Path, part: str, resume: bool) -> Iterator[Ledger]:
    """Open the record of a folder for one run.

    Args:
        folder: Of the results; its record is made if need be.
        part: Which share of the jobs, as part of the record's name; several may run at once, each with its own.
        resume: Go on from the records of earlier runs; else this one begins anew.

    Raises:
        FileError: Another run works on this share, a record is damaged, or it cannot be written.
    """
    place = folder / FOLDER
    path = place / f"ledger{part}.jsonl"
    with contextlib.ExitStack() as stack:
        try:
            place.mkdir(parents=True, exist_ok=True)
            _lock(stack.enter_context((place / f"lock{part}").open("w")), folder)
            entries: dict[str, dict[str, Any]] = {}
            if resume:
                for own in sorted(place.glob("ledger*.jsonl"), key=lambda own: own == path):
                    entries |= _read(own)
            # Written anew as a whole, so that a line that was cut short is not followed by others.
            fresh = path.with_suffix(f".{os.getpid()}")
            fresh.write_text("".join(json.dumps(entry) + "\n" for entry in entries.values()), encoding="utf-8")
            fresh.replace(path)
            stream = stack.enter_context(path.open("ab", buffering=0))
        except OSError as error:
            raise FileError(f"{place}: cannot be written ({error.strerror}): choose another folder") from error
        yield Ledger(folder, entries, stream)


def _read(path: Path) -> dict[str, dict[str, Any]]:
    out: dict[str, dict[str, Any]] = {}
    lines = path.read_bytes().split(b"\n")
    for i, line in enumerate(lines[:-1]):  # behind the last line break is nothing, or a line that was cut short
        try:
            entry = _checked(json.loads(line))
            out[entry["job"]] = entry
        except (ValueError, TypeError, KeyError, RecursionError) as error:
            raise FileError(f"{path}:{i + 1}: is damaged: delete the file and run without --resume") from error
    return out


def _checked(entry: Any) -> dict[str, Any]:
    """Return an entry that is one; others raise what `_read` expects."""
    kinds = {"job": str, **_KINDS[entry["state"]]}
    if not all(isinstance(entry[name], kind) for name, kind in kinds.items()):
        raise TypeError("a value is of another kind")
    return entry


_KINDS: Mapping[str, Mapping[str, Any]] = {
    BEGUN: {"key": str, "worker": int},
    DONE: {"key": str, "reports": list, "seconds": int | float, "files": dict},
    LOST: {},
}
"""What entries hold besides the job, by their states."""


def _lock(stream: TextIO, folder: Path) -> None:
    """Keep other runs out until ``stream`` is closed or the process ends, where the system can."""
    try:
        import fcntl
    except ImportError:  # not on Windows
        return
    try:
        fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError as error:
        raise FileError(f"{folder}: another batch is writing there: wait for its end") from error
