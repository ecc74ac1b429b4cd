"""A worker process as the one sees it that hands out jobs."""

import contextlib
import json
import os
import queue
import signal
import subprocess
import tempfile
import threading
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from .worker import OUT_OF_MEMORY

_LINES = 20
"""Last lines of what a worker said that are kept."""

Message = dict[str, Any] | None
"""What a worker tells; None at its end."""


class Process:
    """A worker process; what it tells arrives in a queue that all share."""

    def __init__(
        self, command: Sequence[str], environment: Mapping[str, str], told: "queue.SimpleQueue[tuple[Process, Message]]"
    ) -> None:
        """Start it.

        Args:
            command: Program and arguments.
            environment: Environment variables.
            told: Where its messages go.

        Raises:
            OSError: It does not start.
        """
        self._log = tempfile.TemporaryFile()  # noqa: SIM115 - closed in `close`
        self._popen = subprocess.Popen(
            command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._log,
            env=dict(environment),
            text=True,
            encoding="utf-8",
            errors="replace",
            start_new_session=True,  # an interrupt at the keyboard is for the one who asks
        )
        self._told = told
        self._thread = threading.Thread(target=self._listen, daemon=True)
        self._thread.start()

    @property
    def number(self) -> int:
        """Process number."""
        return self._popen.pid

    def send(self, request: Mapping[str, Any]) -> None:
        """Hand over a job."""
        stream = self._popen.stdin
        assert stream is not None, "it was asked for"
        with contextlib.suppress(BrokenPipeError):  # it has ended, which its queue tells
            stream.write(json.dumps(request) + "\n")
            stream.flush()

    def close(self) -> None:
        """End it, at once."""
        self._popen.kill()
        self._popen.wait()
        self._thread.join()
        for stream in (self._popen.stdin, self._popen.stdout, self._log):
            assert stream is not None, "they were asked for"
            with contextlib.suppress(BrokenPipeError):
                stream.close()

    def last_lines(self) -> list[str]:
        """Return what it said last."""
        size = os.fstat(self._log.fileno()).st_size
        self._log.seek(max(size - 8000, 0))
        lines = self._log.read().decode("utf-8", "replace").splitlines()
        return [line.rstrip() for line in lines if line.strip()][-_LINES:]

    def ending(self) -> str:
        """Return how it ended, as one line."""
        status = self._popen.wait()
        lines = self.last_lines()
        if status == OUT_OF_MEMORY or (lines and lines[-1].startswith("MemoryError")):
            return "the worker ran out of memory: allow more with --memory, or use fewer --jobs"
        if status == -signal.SIGKILL:
            return "the worker was killed, as systems do when memory runs out: use fewer --jobs"
        if status < 0:
            return f"the worker ended with {signal.Signals(-status).name}: run its command alone to see more"
        told = f" ({lines[-1].strip()})" if lines else ""
        return f"the worker ended with status {status}{told}: run its command alone to see more"

    def _listen(self) -> None:
        stream = self._popen.stdout
        assert stream is not None, "it was asked for"
        for line in stream:
            message = _read(line)
            if message is not None:
                self._told.put((self, message))
        self._told.put((self, None))


def _read(line: str) -> dict[str, Any] | None:
    """Return a message; None for what Blender prints while it starts."""
    try:
        found = json.loads(line)
    except ValueError:
        return None
    return found.get("morph_retarget") if isinstance(found, dict) else None


def sweep(folder: Path, number: int) -> None:
    """Remove the unfinished files that a killed worker has left."""
    for path in folder.glob(f".{number}.*"):
        path.unlink(missing_ok=True)
