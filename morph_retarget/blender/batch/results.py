"""What became of jobs."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Any

from .jobs import Item, Job


class Status(StrEnum):
    """How a job ended."""

    OK = "ok"
    """It is done."""
    FAILED = "failed"
    """An input could not be used, or a gate was not passed."""
    SKIPPED = "skipped"
    """An earlier run did it, and nothing has changed since."""
    CRASHED = "crashed"
    """The process that worked on it ended."""
    TIMEOUT = "timeout"
    """It took too long."""
    STOPPED = "stopped"
    """The run was ended before it."""


GOOD = (Status.OK, Status.SKIPPED)
REPORT_FIELDS: Mapping[str, str] = {
    "program": "what did it: its version and Blender's",
    "seconds": "how long it took in all",
    "counts": "how many jobs ended in each way",
    "jobs": "all of them, in the order of the request",
}
"""Meaning of the fields of a batch's report."""
FIELDS: Mapping[str, str] = {
    "name": "of the job: that of its result",
    "source": "the clip",
    "target": "the rig",
    "status": "how it ended",
    "error": "what was wrong, in one line; null when all is well",
    "seconds": "that it took",
    "files": "results, from the output folder on",
    "measures": "reports of `retarget`, one for each action",
    "log": "last lines of a worker that was lost",
    "command": "for jobs that are not done: the arguments that do the same alone",
}
"""Meaning of what `Result.described` returns."""


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
    drawings: Sequence[str] = ()
    """How they look, as SVG, one for each report."""
    log: Sequence[str] = ()
    """Last lines that a crashed worker said."""


@dataclass(frozen=True)
class Result:
    """A job, or what was refused, and what became of it."""

    job: Item
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
        source, target = self.job.labels
        entry: dict[str, Any] = {
            "name": self.job.name,
            "source": source,
            "target": target,
            "status": self.answer.status.value,
            "error": self.answer.error or None,
            "seconds": round(self.answer.seconds, 3),
            "files": list(self.answer.files),
            "measures": list(self.answer.reports),
        }
        if self.answer.log:
            entry["log"] = list(self.answer.log)
        if not self.good and isinstance(self.job, Job):
            entry["command"] = ["morph_retarget", "retarget", *self.job.argv]
        return entry


def counted(results: Sequence[Result]) -> dict[str, int]:
    """Return how many jobs ended in each way."""
    return {status.value: sum(r.answer.status is status for r in results) for status in Status}
