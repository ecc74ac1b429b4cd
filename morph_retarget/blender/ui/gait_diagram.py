"""A gait as lines of text: when each foot is on the ground over one cycle (Hildebrand 1965), and where the cycle is."""

from dataclasses import dataclass

import numpy as np

from ...core.arrays import Flags
from ...core.locomotion.stepping.gait import Gait

STANDS, FLIES = "█", "░"
STANDS_NOW, FLIES_NOW = "▓", "▒"
MOST_FEET = 24
"""More are not drawn."""


@dataclass(frozen=True, eq=False)
class Row:
    """One foot over one cycle of its group of legs."""

    leg: int
    """Of the gait."""
    stands: Flags
    """Shape (column,)."""
    now: int
    """Column at which the cycle is."""

    @property
    def text(self) -> str:
        """A character for each column."""
        marks = [STANDS if stands else FLIES for stands in self.stands.tolist()]
        marks[self.now] = STANDS_NOW if self.stands[self.now] else FLIES_NOW
        return "".join(marks)


def rows(gait: Gait, time: float, columns: int) -> list[Row]:
    """Return the feet of a gait, group by group, from the front to the rear.

    Args:
        gait: The gait.
        time: At which it is looked at [s].
        columns: Into how many parts a cycle is cut.
    """
    phases, out = gait.phases(np.array([time]))[0], list[Row]()
    middles = (np.arange(columns) + 0.5) / columns
    for group, pace, phase in zip(gait.legs.groups, gait.paces, phases.tolist(), strict=True):
        sample = int(np.clip(np.searchsorted(pace.times, time), 0, len(pace.times) - 1))
        duty, triggers = pace.pattern.duty[sample], pace.pattern.triggers[sample]
        now = min(int((phase % 1.0) * columns), columns - 1)
        made = [Row(leg, (middles - triggers[i]) % 1.0 < duty[i], now) for i, leg in enumerate(group.legs)]
        out += sorted(made, key=lambda row: row.leg)
    return out[:MOST_FEET]
