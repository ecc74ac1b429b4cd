"""One cell of a validation grid: an action on a character, what it was judged to be, and how it looks."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from math import isfinite
from typing import Any

from ..verdicts.verdict import Verdict
from .drawing import Strip

FIELDS: Mapping[str, str] = {
    "action": "the action",
    "character": "the character",
    "status": "`passed`, `failed`, or `does not apply`: the action does not bind there, which counts neither way",
    "verdicts": "by name; none where nothing was played",
    "problems": "what of the action does not play, and why",
    "error": "what went wrong, empty where nothing did",
    "frames": "how many were judged",
    "variant": "which of the ways to play was judged, from 0",
    "variants": "how many ways there are",
    "seconds": "time to play and to judge",
}
"""Meaning of what `Cell.described` returns."""
VERDICT_FIELDS: Mapping[str, str] = {
    "value": "what was measured, at its worst; null where it could not be, which fails",
    "limit": "the most that passes",
    "unit": "of both",
    "passed": "whether it keeps within the limit",
    "where": "body at which it is at its worst",
    "frame": "in which it is so",
}
"""Meaning of a verdict in it."""


class Status(StrEnum):
    """What became of a cell."""

    PASSED = "passed"
    FAILED = "failed"
    NOT_FOR_IT = "does not apply"
    """The action does not bind on the character, which counts neither way."""


@dataclass(frozen=True, eq=False)
class Cell:
    """An action on a character."""

    action: str
    character: str
    verdicts: Mapping[str, Verdict] = field(default_factory=dict[str, Verdict])
    """By name; none where nothing was played."""
    problems: tuple[str, ...] = ()
    """What of the action does not play, and why; and other things that the user should know."""
    error: str = ""
    """What went wrong."""
    applies: bool = True
    first: float = 0.0
    """Frame of the scene at which it begins."""
    frames: int = 0
    variant: int = 0
    variants: int = 0
    seconds: float = 0.0
    """That it took to play and to judge."""
    strip: Strip | None = None
    """How it looks."""

    @property
    def key(self) -> tuple[str, str]:
        """What tells it from all other cells of its grid."""
        return self.action, self.character

    @property
    def status(self) -> Status:
        """What became of it."""
        if not self.applies:
            return Status.NOT_FOR_IT
        return Status.FAILED if self.error or self.failing else Status.PASSED

    @property
    def failing(self) -> list[str]:
        """Names of the verdicts that it does not pass."""
        return [name for name, verdict in self.verdicts.items() if not verdict.passed]

    def described(self) -> dict[str, Any]:
        """Return the cell as plain data, as it is written to reports."""
        return {
            "action": self.action,
            "character": self.character,
            "status": self.status.value,
            "verdicts": {name: self._verdict(verdict) for name, verdict in self.verdicts.items()},
            "problems": list(self.problems),
            "error": self.error,
            "frames": self.frames,
            "variant": self.variant,
            "variants": self.variants,
            "seconds": round(self.seconds, 4),
        }

    def _verdict(self, verdict: Verdict) -> dict[str, Any]:
        found = verdict.found
        return {
            "value": round(found.value, 6) if isfinite(found.value) else None,
            "limit": verdict.limit,
            "unit": verdict.unit,
            "passed": verdict.passed,
            "where": found.name,
            "frame": None if found.row is None else round(self.first + found.row, 3),
        }
