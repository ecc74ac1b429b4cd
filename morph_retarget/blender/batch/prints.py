"""Fingerprints of files and jobs: whether anything has changed is asked of what is in files, not of their dates."""

import hashlib
import json
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import unquote

from ...core.errors import FileError
from .jobs import FILES, Job


def digest(path: Path) -> str:
    """Return the fingerprint of what is in a file.

    Raises:
        FileError: It cannot be read.
    """
    try:
        with path.open("rb") as stream:
            return hashlib.file_digest(stream, "sha256").hexdigest()
    except OSError as error:
        raise FileError(f"{path}: cannot be read ({error.strerror}): check its permissions") from error


class Prints:
    """Keys of jobs; each file is read once."""

    def __init__(self, version: str) -> None:
        """Begin.

        Args:
            version: Of what does the jobs: another one may do them otherwise.
        """
        self._version = version
        self._known: dict[Path, str] = {}

    def key(self, job: Job) -> str:
        """Return a text that changes when anything changes that a job depends on.

        Raises:
            FileError: An input cannot be read.
        """
        options = {name: value for name, value in job.options.items() if name not in FILES}
        inputs = [[self._of(own) for own in (path, *beside(path))] for path in job.inputs]
        text = json.dumps([self._version, job.name, job.action, options, inputs], sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()

    def _of(self, path: Path) -> str:
        if path not in self._known:
            self._known[path] = digest(path)
        return self._known[path]


def beside(path: Path) -> Iterator[Path]:
    """Yield the files with the numbers of a .gltf, which holds none itself."""
    if path.suffix.lower() != ".gltf":
        return
    try:
        buffers = json.loads(path.read_bytes())["buffers"]
        names = [unquote(buffer["uri"]) for buffer in buffers if not buffer["uri"].startswith("data:")]
        found = [path.parent / name for name in names if (path.parent / name).is_file()]
    except (OSError, ValueError, TypeError, KeyError, AttributeError, RecursionError):
        return  # no glTF: what is wrong with it is told when it is opened
    yield from found
