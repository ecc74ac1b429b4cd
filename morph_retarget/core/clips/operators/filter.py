"""Filter, Grünvogel 2003 §5.3.2: a finite impulse response on the curves of a clip."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ... import quat
from ...arrays import Array, Indices
from ..clip import Clip
from ..frames import Frames
from ..travel import Travel
from .aggregate import ClipAggregate


@dataclass(frozen=True, eq=False)
class Filter(ClipAggregate):
    """A clip whose frames are sums over their neighbours: B(t) = Σ h[i] A(t - i), α ≤ i ≤ ω (eq. 3).

    Rotations are filtered in the space that is tangent at the frame itself (Lee 2000): there neighbours are rotation
    vectors, whose weighted sum leads to the filtered frame. Places are filtered by the same rule, so a frame itself
    counts by as much as all coefficients lack to 1, and whatever they are, what does not move stays as it is.

    Translations and feet are filtered axis by axis. Contacts and the way over the ground stay as they are.
    """

    coefficients: Sequence[float]
    """h[α] … h[ω]."""
    first: int
    """α, 0 or less, and at most as far before 0 as there are coefficients."""
    clip: Clip
    reflected: bool = False
    """Whether a clip goes on beyond its ends as it came, seen in a mirror; else it is held there."""

    def __post_init__(self) -> None:
        self.checked(**{f"coefficient_{self.first + i}": h for i, h in enumerate(self.coefficients)})
        last = self.first + len(self.coefficients) - 1
        if not self.first <= 0 <= last:
            raise self.refused(f"its coefficients go from {self.first} to {last}: let 0 be among them")

    @property
    def parts(self) -> tuple[Clip, ...]:
        """The clip."""
        return (self.clip,)

    def frame(self, times: Array) -> Frames:
        """Return frames at times, shape (n,)."""
        times = self.held(times)
        own = self.clip.frame(times)
        taps = [(float(h), self.first + i) for i, h in enumerate(self.coefficients) if h != 0.0 and self.first + i]
        if not taps:
            return own
        around, rows = self._around(times, [i for _, i in taps])
        back = quat.conjugate(own.rotations)
        turns = np.zeros((*own.rotations.shape[:-1], 3))
        translations, feet = own.translations.copy(), own.feet.copy()
        for (h, _), row in zip(taps, rows, strict=True):
            turns += h * quat.to_rotation_vector(quat.multiply(back, around.rotations[row]))
            translations += h * (around.translations[row] - own.translations)
            feet += h * (around.feet[row] - own.feet)
        turned = quat.normalize(quat.multiply(own.rotations, quat.from_rotation_vector(turns)))
        return Frames(turned, translations, feet, own.contacts)

    def travel(self, times: Array) -> Travel:
        """Return where it has led at times, shape (n,)."""
        return self.clip.travel(times)

    def _around(self, times: Array, shifts: Sequence[int]) -> tuple[Frames, Indices]:
        """Return the neighbours of frames, each once, and which is whose, shape (shift, n)."""
        wanted = times - np.array(shifts, dtype=np.float64)[:, None]
        if self.reflected:
            wanted = self._seen_back(wanted)
        once, rows = np.unique(self.held(wanted), return_inverse=True)
        return self.clip.frame(once), rows.reshape(wanted.shape)

    def _seen_back(self, times: Array) -> Array:
        """Return times beyond the ends as those within that are as far from the end."""
        early = self.start + np.abs(times - self.start)
        return self.end - np.abs(self.end - early) if self.clip.is_finite else early
