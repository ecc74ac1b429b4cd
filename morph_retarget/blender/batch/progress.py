"""How far a batch is: one line that is renewed on a terminal, plain lines now and then elsewhere."""

import time
from typing import TextIO

from ..cli.messages import NAME
from .results import Result, Status

EVERY = 5.0
"""Time between plain lines [s]."""


class Progress:
    """Tells how far a batch is."""

    def __init__(self, total: int, stream: TextIO) -> None:
        """Begin.

        Args:
            total: Number of jobs.
            stream: Where to tell it.
        """
        self._total, self._stream, self._live = total, stream, stream.isatty()
        self._done = self._bad = self._worked = 0
        self._start = time.monotonic()
        self._told = self._start

    @property
    def seconds(self) -> float:
        """Time since the beginning."""
        return time.monotonic() - self._start

    def ended(self, result: Result) -> None:
        """Count a job; a bad one is told at once."""
        self._done += 1
        self._worked += result.answer.status is not Status.SKIPPED
        if not result.good:
            self._bad += 1
            self._line(f"{result.answer.status}: {result.job.name}: {result.answer.error}")
        self.renew()

    def renew(self) -> None:
        """Tell how far it is, if it is time to."""
        now = time.monotonic()
        if self._live:
            self._stream.write(f"\r\033[K{self._text()}")
            self._stream.flush()
        elif now - self._told >= EVERY:
            self._told = now
            self._line(self._text())

    def close(self) -> None:
        """Leave the line as it is."""
        if self._live:
            self._stream.write("\r\033[K")
            self._stream.flush()

    def _line(self, text: str) -> None:
        clear = "\r\033[K" if self._live else ""
        self._stream.write(f"{clear}{NAME}: {' '.join(text.split())}\n")
        self._stream.flush()

    def _text(self) -> str:
        text = f"{self._done}/{self._total} done, {self._bad} failed"
        left = self._total - self._done
        if self._worked and left:
            text += f", {_clock(self.seconds / self._worked * left)} left"
        return text


def _clock(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{rest:02}" if hours else f"{minutes}:{rest:02}"
