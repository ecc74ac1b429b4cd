"""A validation grid: its cells, how many pass, what has changed since an earlier run, and all of it as plain data.

The grid is that of Hecker 2008 §5 and figure 9: actions by characters, played and judged.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import FileError
from .cell import Cell, Status

FIELDS: Mapping[str, str] = {
    "version": "of the product and of Blender",
    "settings": "options and limits that it was made with",
    "pass_rate": "share of the cells that pass, of those that apply; null where none does",
    "passed": "how many cells pass",
    "failed": "how many fail",
    "does_not_apply": "how many count neither way",
    "failed_by_verdict": "how many cells fail each verdict, and how many could not be played (`error`)",
    "compared": "with `--compare`: `regressions`, `mended`, `new` and `gone` cells, as pairs of action and character",
    "cells": "all of them, what is to be seen first before the others",
}
"""Meaning of what `Grid.described` returns."""


@dataclass(frozen=True)
class Changes:
    """What has changed since an earlier run."""

    since: str
    """File of the earlier run's report."""
    regressions: frozenset[tuple[str, str]]
    """Cells that passed and now fail."""
    mended: frozenset[tuple[str, str]]
    """Cells that failed and now pass."""
    new: frozenset[tuple[str, str]]
    """Cells that were not there."""
    gone: frozenset[tuple[str, str]]
    """Cells that are there no more."""


@dataclass(frozen=True, eq=False)
class Grid:
    """Cells of actions and characters."""

    cells: Sequence[Cell]
    settings: Mapping[str, Any] = field(default_factory=dict[str, Any])
    """What it was made with, as plain data."""
    version: str = ""
    """Of the product and of Blender."""
    changes: Changes | None = None

    @cached_property
    def actions(self) -> list[str]:
        """Names of the actions, in order."""
        return list(dict.fromkeys(cell.action for cell in self.cells))

    @cached_property
    def characters(self) -> list[str]:
        """Names of the characters, in order."""
        return list(dict.fromkeys(cell.character for cell in self.cells))

    def count(self, status: Status) -> int:
        """Return how many cells have a status."""
        return sum(cell.status is status for cell in self.cells)

    @property
    def pass_rate(self) -> float | None:
        """Share of cells that pass, of those whose actions bind; None where none does."""
        passed, failed = self.count(Status.PASSED), self.count(Status.FAILED)
        return passed / (passed + failed) if passed + failed else None

    @cached_property
    def by_verdict(self) -> dict[str, int]:
        """How many cells fail each verdict; those that could not be played under ``error``."""
        names = list(dict.fromkeys(name for cell in self.cells for name in cell.verdicts))
        out = {name: sum(name in cell.failing for cell in self.cells) for name in names}
        return out | {"error": sum(bool(cell.error) for cell in self.cells)}

    @cached_property
    def ordered(self) -> list[Cell]:
        """All cells, what is to be seen first before the others: regressions, then mended ones, then what fails."""
        changes = self.changes
        order = {Status.FAILED: 2, Status.PASSED: 3, Status.NOT_FOR_IT: 4}

        def place(cell: Cell) -> int:
            if changes is not None and cell.key in changes.regressions:
                return 0
            if changes is not None and cell.key in changes.mended:
                return 1
            return order[cell.status]

        return sorted(self.cells, key=place)

    def described(self) -> dict[str, Any]:
        """Return the grid as plain data, as it is written to reports."""
        rate = self.pass_rate
        out: dict[str, Any] = {
            "version": self.version,
            "settings": dict(self.settings),
            "pass_rate": None if rate is None else round(rate, 5),
            "passed": self.count(Status.PASSED),
            "failed": self.count(Status.FAILED),
            "does_not_apply": self.count(Status.NOT_FOR_IT),
            "failed_by_verdict": self.by_verdict,
        }
        if self.changes is not None:
            own = self.changes
            named = {"regressions": own.regressions, "mended": own.mended, "new": own.new, "gone": own.gone}
            out["compared"] = {"with": own.since, **{name: sorted(map(list, keys)) for name, keys in named.items()}}
        return out | {"cells": [cell.described() for cell in self.ordered]}


def changes_since(path: Path, cells: Sequence[Cell]) -> Changes:
    """Return what has changed since an earlier run.

    Args:
        path: Report of that run.
        cells: Of the present one.

    Raises:
        FileError: There is no such report.
    """
    before, now = earlier(path), {cell.key: cell.status.value for cell in cells}
    passed, failed = Status.PASSED.value, Status.FAILED.value
    both = before.keys() & now.keys()
    return Changes(
        str(path),
        frozenset(key for key in both if before[key] == passed and now[key] == failed),
        frozenset(key for key in both if before[key] == failed and now[key] == passed),
        frozenset(now.keys() - before.keys()),
        frozenset(before.keys() - now.keys()),
    )


def earlier(path: Path) -> dict[tuple[str, str], str]:
    """Return the status of each cell in the report of an earlier run.

    Raises:
        FileError: There is no such report.
    """
    try:
        told = json.loads(path.read_text(encoding="utf-8"))
        return {(str(cell["action"]), str(cell["character"])): str(cell["status"]) for cell in told["cells"]}
    except OSError as error:
        raise FileError(f"{path}: cannot be read ({error.strerror}): give the report.json of an earlier run") from error
    except (ValueError, KeyError, TypeError, RecursionError) as error:
        raise FileError(f"{path}: is no report of a validation: give the report.json of an earlier run") from error


def sampled(cells: Sequence[tuple[int, int]], count: int, seed: int) -> list[tuple[int, int]]:
    """Return some of many cells at random, in their own order; the same for the same seed.

    Args:
        cells: Which action on which character.
        count: How many; all where there are not more.
        seed: Any number.
    """
    if count >= len(cells):
        return list(cells)
    places = np.random.default_rng(seed).choice(len(cells), count, replace=False)
    return [cells[i] for i in sorted(places.tolist())]
