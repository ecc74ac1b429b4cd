"""What a going body has done and goes on to do: what its token keeps (Grünvogel 2003 §5.5, figures 5 and 6)."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

from ..clip import Clip
from ..commands.command import Value
from ..operators.blend import Blend
from ..operators.section import Section
from .cycles import Cycle
from .pace import Pace, Paced
from .released import Released
from .transitions import crossfade

AT_ONCE = 1.0
"""Frames in which a stop clip follows a cycle that it fits."""


@dataclass(frozen=True, eq=False)
class Stage:
    """One cycle of a going body, and when it comes in."""

    cycle: Cycle
    begin: float
    finish: float


@dataclass(frozen=True, eq=False)
class Gone:
    """What a going body has done and goes on to do."""

    stop: "Callable[[Gone, float], Gone]"
    """How its model brings it to a stand from some frame on."""
    way: Mapping[str, Value]
    """Parameters, all of them."""
    pace: Pace
    stages: tuple[Stage, ...]
    settled: float
    """From when on the pace tells where in its cycle the body is."""
    opening: Clip | None = None
    """What comes before the first cycle, None where that begins at once."""
    closing: Clip | None = None
    """The stop clip."""
    end: float = math.inf
    """Where the motion is cut off, if there is no stop clip."""

    @cached_property
    def tree(self) -> Clip:
        """The motion tree."""
        tree = self.opening
        for stage in self.stages:
            cycle = stage.cycle
            paced = Paced(self.pace, cycle.clip, cycle.period, cycle.zero, stage.begin)
            tree = paced if tree is None else crossfade(tree, paced, stage.begin, stage.finish)
        assert tree is not None, "there is a clip"
        if self.closing is not None:
            start = self.closing.start
            tree = Released(Blend(tree.start, start, start, start + AT_ONCE, tree, self.closing))
        return tree if self.end == math.inf else Section(tree.start, self.end, tree)

    def since(self, frame: float) -> "Gone":
        """Return the same without what is over at a frame."""
        over = [i for i, stage in enumerate(self.stages) if stage.finish <= frame]
        return replace(self, opening=None, stages=self.stages[over[-1] :]) if over else self
