"""Workers that do jobs side by side: each job costs at most its worker, which is replaced."""

import os
import queue
import time
from collections import deque
from collections.abc import Generator, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from ...core.errors import FileError
from .jobs import Job
from .process import Message, Process, sweep
from .results import Answer, Result, Status

STARTING = 180.0
"""Most time that a worker may take to get ready [s]."""
_TRIES = 2
"""Workers in a row that may fail to start."""
RENEWED_AFTER = 200
"""Jobs after which a worker gives way to a new one: what Blender and its add-ons keep does not pile up."""
_TICK = 0.5
"""Time between looks at the clock [s]."""


@dataclass(frozen=True)
class Task:
    """A job to be done, and whether it may replace files."""

    job: Job
    replace: bool = False


@dataclass(frozen=True)
class Settings:
    """How workers are run."""

    command: Sequence[str]
    """Starts one."""
    count: int = 1
    """How many there are at once."""
    timeout: float | None = None
    """Most time for one job [s]."""
    environment: Mapping[str, str] = field(default_factory=lambda: dict(os.environ))


@dataclass(frozen=True)
class Began:
    """A worker is about to get a job."""

    job: Job
    worker: int
    """Process number."""


@dataclass
class _Seat:
    """A worker, and what it does."""

    process: Process
    since: float
    """When it began with that [s]."""
    ready: bool = False
    task: Task | None = None
    answered: int = 0
    """Jobs that it has done."""


class Pool:
    """Does tasks; `run` yields what happens as it happens."""

    def __init__(self, tasks: Sequence[Task], settings: Settings) -> None:
        self._waiting, self._settings = deque(tasks), settings
        self._seats: dict[Process, _Seat] = {}
        self._told: queue.SimpleQueue[tuple[Process, Message]] = queue.SimpleQueue()
        self._failed_starts = 0

    def run(self) -> Generator[Began | Result | None, None, None]:
        """Do all tasks.

        Yields:
            `Began` before a job is handed over, its `Result` when it has ended, and None now and then.

        Raises:
            FileError: Workers do not start.
        """
        try:
            while self._waiting or self._busy():
                self._fill()
                try:
                    process, message = self._told.get(timeout=self._patience())
                except queue.Empty:
                    yield from self._look_at_clock()
                    yield None
                    continue
                seat = self._seats.get(process)
                if seat is None:
                    continue  # the end of one that was ended here
                if message is None:
                    yield from self._ended(seat)
                elif seat.task is None:
                    seat.ready, self._failed_starts = True, 0
                else:
                    result = _result(seat, message)
                    seat.task, seat.answered = None, seat.answered + 1
                    yield result
                if message is not None:
                    yield from self._hand_over(seat)
                yield from self._look_at_clock()
        finally:
            for seat in list(self._seats.values()):
                self._remove(seat)

    def _busy(self) -> int:
        return sum(seat.task is not None for seat in self._seats.values())

    def _fill(self) -> None:
        """Start workers where some are missing."""
        wanted = min(self._settings.count, len(self._waiting) + self._busy())
        while len(self._seats) < wanted:
            try:
                process = Process(self._settings.command, self._settings.environment, self._told)
            except OSError as error:
                raise FileError(f"{self._settings.command[0]}: no worker starts ({error.strerror})") from error
            self._seats[process] = _Seat(process, time.monotonic())

    def _hand_over(self, seat: _Seat) -> Iterator[Began]:
        if not self._waiting or seat.answered >= RENEWED_AFTER:
            self._remove(seat)
            return
        task = self._waiting.popleft()
        yield Began(task.job, seat.process.number)
        seat.task, seat.since = task, time.monotonic()
        seat.process.send({"argv": task.job.argv, "fresh": not task.replace})

    def _ended(self, seat: _Seat) -> Iterator[Result]:
        """Deal with a worker that has ended by itself."""
        how, lines = seat.process.ending(), seat.process.last_lines()
        self._remove(seat)
        if seat.task is not None:
            yield Result(seat.task.job, Answer(Status.CRASHED, how, time.monotonic() - seat.since, log=lines))
        elif not seat.ready:
            self._failed_to_start(how)

    def _patience(self) -> float:
        """Return how long to wait for news: no longer than until a worker's time is over [s]."""
        timeout, now = self._settings.timeout, time.monotonic()
        if timeout is None:
            return _TICK
        left = (seat.since + timeout - now for seat in self._seats.values() if seat.task is not None)
        return max(min([_TICK, *left]), 0.0)

    def _look_at_clock(self) -> Iterator[Result]:
        """End workers that take too long."""
        now, timeout = time.monotonic(), self._settings.timeout
        for seat in list(self._seats.values()):
            spent = now - seat.since
            if seat.task is not None and timeout is not None and spent > timeout:
                lines = seat.process.last_lines()
                self._remove(seat)
                told = f"took longer than {timeout:g} s: allow more with --timeout, or look at the clip"
                yield Result(seat.task.job, Answer(Status.TIMEOUT, told, spent, log=lines))
            elif not seat.ready and spent > STARTING:
                self._remove(seat)
                self._failed_to_start(f"the worker was not ready after {STARTING:g} s")

    def _failed_to_start(self, how: str) -> None:
        self._failed_starts += 1
        if self._failed_starts >= _TRIES:
            raise FileError(f"no worker starts: {how}")

    def _remove(self, seat: _Seat) -> None:
        """End a worker, and remove what it was writing."""
        del self._seats[seat.process]
        seat.process.close()
        if seat.task is not None:
            sweep(seat.task.job.out.parent, seat.process.number)


def _result(seat: _Seat, message: dict[str, object]) -> Result:
    assert seat.task is not None, "it answers what it was asked"
    seconds = time.monotonic() - seat.since
    error = message.get("error")
    if error is not None:
        return Result(seat.task.job, Answer(Status.FAILED, str(error), seconds))
    reports: Sequence[dict[str, object]] = message["reports"]  # type: ignore[assignment]
    files: Sequence[str] = message["files"]  # type: ignore[assignment]
    drawings: Sequence[str] = message.get("drawings", ())  # type: ignore[assignment]
    return Result(seat.task.job, Answer(Status.OK, "", seconds, reports, files, drawings))
