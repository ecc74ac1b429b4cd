"""What judging comes to: a measured value, the limit that it must not exceed, and where it is worst."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Array


@dataclass(frozen=True)
class Found:
    """The worst of what was measured."""

    value: float
    """NaN if anything could not be measured, which passes no limit."""
    row: int | None = None
    """The frame in which it is worst, as a row of the batch; None where nothing was measured."""
    name: str = ""
    """The bone, or what else was measured."""

    @classmethod
    def worst(cls, values: Array, names: Sequence[str]) -> "Found":
        """Return the largest of some values, shape (frame, n); 0 where there are none."""
        if not values.size:
            return cls(0.0)
        row, column = np.unravel_index(int(np.argmax(values)), values.shape)
        return cls(float(values[row, column]), int(row), names[int(column)])


@dataclass(frozen=True)
class Verdict:
    """One thing that was judged."""

    found: Found
    limit: float
    unit: str
    """Of value and limit."""

    @property
    def value(self) -> float:
        """What was measured."""
        return self.found.value

    @property
    def passed(self) -> bool:
        """Whether it keeps the limit."""
        return self.found.value <= self.limit

    @property
    def told(self) -> str:
        """The verdict in words: value, limit and where."""
        where = "" if self.found.row is None else f", worst at {self.found.name!r}"
        return f"{self.value:.3g} {self.unit} (limit {self.limit:g}){where}"
