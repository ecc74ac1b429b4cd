"""TimeWarp, Grünvogel 2003 §5.3.5 (after Witkin and Popović 1995)."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...arrays import Array
from ..clip import Clip
from ..frames import Frames
from ..travel import Travel
from .aggregate import ClipAggregate, length_to

_NEAR = 1e-9
"""A key is still on the clip's end when it is beyond it by this share of its frame: keys are computed."""


@dataclass(frozen=True, eq=False)
class TimeWarp(ClipAggregate):
    """A clip that is squeezed and stretched in time (eqs. 8 to 10).

    Keys outside of the clip are not used. Between keys time is interpolated linearly. The paper leaves open what is
    beyond the first and the last: here time runs on as in the clip. So keys warp what is between them and shift the
    rest, one key is a time shift, none leaves the clip as it is, and a clip without end keeps having none. Keys on
    both ends of the clip decide its start and its length (eqs. 15 to 17).
    """

    keys: Sequence[tuple[float, float]]
    """Pairs (a, b): what the clip shows at frame a is shown at frame b. Both ascend; a may stay, which is a pause."""
    clip: Clip

    def __post_init__(self) -> None:
        for key in self.keys:
            self.checked(**{f"key_{key[0]:g}": key[0], f"place_of_key_{key[0]:g}": key[1]})
        for (a, b), (later, place) in zip(self.keys[:-1], self.keys[1:], strict=True):
            if later < a or place <= b:
                told = f"({a:g}, {b:g}) and ({later:g}, {place:g})"
                raise self.refused(f"keys {told} are out of order: sort them, and let no two have the same place")

    @property
    def parts(self) -> tuple[Clip, ...]:
        """The clip."""
        return (self.clip,)

    @cached_property
    def used(self) -> Array:
        """Keys that are within the clip, shape (key, 2)."""
        keys = np.array(self.keys, dtype=np.float64).reshape(-1, 2)
        near = _NEAR * np.maximum(np.abs(keys[:, 0]), 1.0)
        inside = (keys[:, 0] >= self.clip.start - near) & (keys[:, 0] <= self.clip.end + near)
        return keys[inside]

    @property
    def start(self) -> float:
        """First frame."""
        return self._shown[0]

    @property
    def length(self) -> float:
        """Frames that it has, 0 without end."""
        return length_to(*self._shown)

    def frame(self, times: Array) -> Frames:
        """Return frames at times, shape (n,)."""
        return self.clip.frame(self.warped(times))

    def travel(self, times: Array) -> Travel:
        """Return where it has led at times, shape (n,)."""
        return self.clip.travel(self.warped(times))

    @cached_property
    def _shown(self) -> tuple[float, float]:
        """Where the clip's ends are shown."""
        start, end = self.clip.start, self.clip.end
        if not len(self.used):
            return start, end
        (first, early), (last, late) = self.used[0].tolist(), self.used[-1].tolist()
        return early - max(first - start, 0.0), late + max(end - last, 0.0)

    def warped(self, times: Array) -> Array:
        """Return the clip's own frames that are shown at times, shape (n,)."""
        if not len(self.used):
            return times
        own, shown = self.used[:, 0], self.used[:, 1]
        beyond = np.minimum(times - shown[0], 0.0) + np.maximum(times - shown[-1], 0.0)
        return np.interp(times, shown, own) + beyond
