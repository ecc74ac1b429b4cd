"""Feet that keep their spots from one clip to the next until they lift.

Where a stop follows the cycle that it fits, poses agree but for the spots on which feet stand: each clip knows them
only from its own frames. A foot that stands goes on standing where it does; on its next way through the air it comes to
where the second clip has it.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ...arrays import Array
from ..frames import Frames
from ..operators.aggregate import ClipAggregate
from ..operators.blend import Blend
from ..operators.envelope import risen
from ..spots import STANDS
from ..travel import Travel, turned

LATEST = 240.0
"""Frames within which a foot lifts, or keeps its spot for good."""
FLIGHT = 8.0
"""Frames in the air of a foot that does not land again."""


@dataclass(frozen=True, eq=False)
class Released(ClipAggregate):
    """A short blend of clips whose poses agree, from which on feet are the second's, but let go only as they lift."""

    blend: Blend

    @property
    def parts(self) -> tuple[Blend]:
        """The blend."""
        return (self.blend,)

    @property
    def label(self) -> str:
        """Like the blend's."""
        return f"{self.blend.label}, feet released"

    def frame(self, times: Array) -> Frames:
        """Return frames at times, shape (n,)."""
        out, own = self.blend.frame(times), self.held(times)
        late = own >= self.blend.begin
        if not late.any():
            return out
        own, feet, contacts = own[late], out.feet.copy(), out.contacts.copy()
        second = self.blend.second.frame(own)
        feet[late], contacts[late] = second.feet, second.contacts
        # What is away in the world, as the travel sees it.
        headings = self.blend.travel(own).headings - self.blend.travel(self._begin).headings
        for foot, (lift, land) in enumerate(self._flights):
            away = turned(self._away[foot], -headings)
            feet[late, foot, :2] += (1.0 - risen(own, lift, land))[:, None] * away
        return replace(out, feet=feet, contacts=contacts)

    def travel(self, times: Array) -> Travel:
        """Return where it has led at times, shape (n,)."""
        return self.blend.travel(times)

    @cached_property
    def _away(self) -> Array:
        """How far spots of the first clip are from the second's where the foot stands in both [m], shape (foot, 2)."""
        before = self.blend.first.frame(self._begin + np.array([-1.0, 0.0]))
        after = self.blend.second.frame(self._begin)
        stands = (before.contacts.min(axis=0) > STANDS) & (after.contacts[0] > STANDS)
        return (before.feet[1, :, :2] - after.feet[0, :, :2]) * stands[:, None]

    @property
    def _begin(self) -> Array:
        return np.array([self.blend.begin])

    @cached_property
    def _flights(self) -> list[tuple[float, float]]:
        """When each foot lifts next in the second clip, and when it lands; never if it does not lift."""
        times = self.blend.begin + np.arange(LATEST)
        stands = self.blend.second.frame(times).contacts > STANDS
        out: list[tuple[float, float]] = []
        for foot in stands.T:
            lifted = np.flatnonzero(~foot)
            if not len(lifted):
                out.append((np.inf, np.inf))
                continue
            landed = np.flatnonzero(foot[lifted[0] :])
            lasts = float(landed[0]) if len(landed) else FLIGHT
            out.append((float(times[lifted[0]]), float(times[lifted[0]]) + lasts))
        return out
