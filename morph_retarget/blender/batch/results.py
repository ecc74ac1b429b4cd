"""What became of jobs."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from enum import StrEnum
from typing import Any

from .jobs import Job


class Status(StrEnum):
    """How a job ended."""

    OK = "ok"
    FAILED = "failed"
    """An input could not be used, or a gate was not passed."""
    SKIPPED = "skipped"
    """An earlier run did it, and nothing has changed since."""
    CRASHED = "crashed"
    """The process that worked on it ended."""
    TIMEOUT = "timeout"
    """It took too long."""


GOOD = (Status.OK, Status.SKIPPED)


@dataclass(frozen=True)
class Answer:
    """What a worker, or its end, told of a job."""

    status: Status
    error: str = ""
    """One line that names the item and says what to do; empty when all is well."""
    seconds: float = 0.0
    reports: Sequence[dict[str, Any]] = ()
    """Reports of ``retarget``, one for each action."""
    files: Sequence[str] = ()
    """Results that were written."""
    log: Sequence[str] = ()
    """Last lines that a crashed worker said."""


@dataclass(frozen=True)
class Result:
    """A job and what became of it."""

    job: Job
    answer: Answer

    @property
    def good(self) -> bool:
        """Whether it is done."""
        return self.answer.status in GOOD

    def failing(self, error: str) -> "Result":
        """Return the same job as one that failed."""
        return replace(self, answer=replace(self.answer, status=Status.FAILED, error=error))

    def described(self) -> dict[str, Any]:
        """Return its entry in the report."""
        told = asdict(self.answer)
        source, target = self.job.labels
        entry: dict[str, Any] = {
            "name": self.job.name,
            "source": source,
            "target": target,
            "status": self.answer.status.value,
            "error": self.answer.error or None,
            "seconds": round(self.answer.seconds, 3),
            "files": list(told["files"]),
            "measures": list(told["reports"]),
        }
        if self.answer.log:
            entry["log"] = list(told["log"])
        if not self.good:
            entry["command"] = ["morph_retarget", "retarget", *self.job.argv]
        return entry


def counted(results: Sequence[Result]) -> dict[str, int]:
    """Return how many jobs ended in each way."""
    return {status.value: sum(r.answer.status is status for r in results) for status in Status}
