"""What a benchmark hands over: named figures with a goal, and how times are taken."""

import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Figure:
    """One measured figure."""

    name: str
    value: float
    unit: str
    goal: float | None = None
    """What is aimed for; None when the figure only informs."""
    floor: float | None = None
    """What the same work would cost at the least, in ``unit``; None when nobody knows."""
    at_least: bool = False
    """Whether the goal is to be reached or surpassed rather than stayed under."""

    @property
    def holds(self) -> bool | None:
        """Whether the value meets the goal, None without one."""
        if self.goal is None:
            return None
        return self.value >= self.goal if self.at_least else self.value <= self.goal

    def described(self) -> dict[str, object]:
        """Return the figure as plain data."""
        return {key: getattr(self, key) for key in ("name", "value", "unit", "goal", "floor", "holds")}

    def cells(self) -> tuple[str, ...]:
        """Return the figure as one line of a table."""
        floor = "" if self.floor is None else short(self.floor)
        if self.goal is None:
            return self.name, short(self.value), self.unit, "", floor, ""
        goal = f"{'≥' if self.at_least else '≤'} {short(self.goal)}"
        return self.name, short(self.value), self.unit, goal, floor, "yes" if self.holds else "NO"


HEADINGS = ("figure", "value", "unit", "goal", "floor", "holds")
_RIGHT = (1, 3, 4)
"""Columns with numbers."""


def table(figures: Sequence[Figure]) -> str:
    """Return figures as a table to read."""
    rows = [HEADINGS, *(figure.cells() for figure in figures)]
    widths = [max(len(row[i]) for row in rows) for i in range(len(HEADINGS))]
    lines: list[str] = []
    for row in rows:
        cells = [c.rjust(w) if i in _RIGHT else c.ljust(w) for i, (c, w) in enumerate(zip(row, widths, strict=True))]
        lines.append("  ".join(cells).rstrip())
    return "\n".join(lines)


def short(value: float) -> str:
    """Return a number with four digits that count."""
    return f"{value:.0f}" if abs(value) >= 1000 else f"{value:.4g}"


def seconds(work: Callable[[], object]) -> float:
    """Return the time that ``work`` takes [s]."""
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def medians(sides: Sequence[Callable[[], float]], repetitions: int) -> list[float]:
    """Return the median time of each side [s].

    Args:
        sides: Each runs once, cleans up after itself and returns the time that counts [s].
        repetitions: How often each runs, in turns, after one run to warm up.
    """
    for side in sides:
        side()
    taken = [[side() for side in sides] for _ in range(repetitions)]
    return [statistics.median(times) for times in zip(*taken, strict=True)]
