"""Mix: several clips brought to one common time, and averaged by weights (blend spaces are made of these)."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from ...arrays import Array, Flags
from ...errors import MotionError
from ..clip import Clip
from ..frames import Frames
from ..travel import Travel
from . import ways
from .aggregate import ClipAggregate
from .averaging import averaged
from .loop import Loop
from .ways import Way


@dataclass(frozen=True, eq=False)
class Mix(ClipAggregate):
    """Clips at the same phase of what they do, averaged: each counts by its weight.

    What they have in common is given by marks, as the frames at which the feet strike: these meet, and between them
    time is interpolated linearly. Without marks phases are uniform. The common length and the phases at which marks
    meet are the weighted means, so is the way from each phase to the next. It starts where the first clip does.

    A mix of cycles is a cycle without end.
    """

    clips: Sequence[Clip]
    weights: Sequence[float]
    """Of each clip, 0 or more; they need not sum to 1."""
    cyclic: bool = True
    """Whether the frame after each clip's last is its first again; it is looped then, unless it is a loop already."""
    marks: Sequence[Sequence[float]] = field(default_factory=tuple[Sequence[float], ...])
    """For each clip the frames of its own that meet those of the others, as many for each and in the same order; in
    cycles they may begin anywhere in it. Empty for none."""

    def __post_init__(self) -> None:
        if not self.clips:
            raise MotionError("a mix of no clips: choose one at least")
        if len(self.weights) != len(self.clips):
            raise self.refused(f"{len(self.weights)} weights are given for {len(self.clips)} clips: give one for each")
        self.checked(**{f"weight_{i + 1}": weight for i, weight in enumerate(self.weights)})
        if min(self.weights) < 0.0 or sum(self.weights) <= 0.0:
            raise self.refused("weights must be 0 or more, and one must be more: change them")
        for clip in self.clips:
            if not clip.is_finite and not (self.cyclic and isinstance(clip, Loop | Mix)):
                raise self.refused(f"{clip.label!r} has no end and no cycle: mix cycles, or cut a section from it")
        if self.marks and (len(self.marks) != len(self.clips) or len({len(m) for m in self.marks}) > 1):
            counts = ", ".join(str(len(m)) for m in self.marks)
            raise self.refused(f"clips have {counts} marks: give all as many")
        _ = self._phases

    @property
    def parts(self) -> tuple[Clip, ...]:
        """All clips."""
        return tuple(self.clips)

    @property
    def cycle(self) -> float:
        """Frames of a round; of clips that are no cycles, frames from the first to the last."""
        return float(self._shares @ self._spans)

    @property
    def length(self) -> float:
        """Frames that it has; 0, without end, when it is a cycle."""
        return 0.0 if self.cyclic else self.cycle + 1.0

    @property
    def active(self) -> Flags:
        """Joints that one of those that count has."""
        return np.any([clip.active for clip, _ in self._counting], axis=0)

    @property
    def met(self) -> Array:
        """Frames of the first round at which the marks meet, shape (mark,)."""
        return self.start + self.cycle * (self._common % 1.0 if self.cyclic else self._common)

    def frame(self, times: Array) -> Frames:
        """Return frames at times, shape (n,)."""
        phases = self._phase(times)
        frames = [clip.frame(self._own_times(i, phases)) for clip, i in self._counting]
        if len(frames) == 1:
            return frames[0]
        weights = np.array([self._shares[i] for _, i in self._counting])
        return averaged(self.model, frames, weights, np.array([clip.active for clip, _ in self._counting]))

    def travel(self, times: Array) -> Travel:
        """Return where it has led at times, shape (n,)."""
        phases = self._phase(times)
        if not self.cyclic:
            return self._way.at(phases)
        rounds = np.floor(phases)
        return ways.repeated(self._way.whole, rounds).then(self._way.at(phases - rounds))

    def _phase(self, times: Array) -> Array:
        """Return how many rounds are over at times, shape (n,)."""
        return (self.held(times) - self.start) / self.cycle if self.cycle > 0.0 else np.zeros(len(times))

    @cached_property
    def _shares(self) -> Array:
        weights = np.array(self.weights, dtype=np.float64)
        return weights / weights.sum()

    @cached_property
    def _counting(self) -> list[tuple[Clip, int]]:
        """Clips that count, as they are played, and their places."""
        return [(self._played(clip), i) for i, clip in enumerate(self.clips) if self.weights[i] > 0.0]

    def _played(self, clip: Clip) -> Clip:
        return Loop(0, clip) if self.cyclic and clip.is_finite else clip

    @cached_property
    def _spans(self) -> Array:
        """Frames of each clip's round, or from its first to its last, shape (clip,)."""
        return np.array([_span(clip, self.cyclic) for clip in self.clips])

    @cached_property
    def _phases(self) -> Array:
        """Of each clip's marks, those of cycles ascending from wherever they begin, shape (clip, mark)."""
        if not self.marks:
            return np.zeros((len(self.clips), 0))
        starts = np.array([clip.start for clip in self.clips])
        spans = np.where(self._spans > 0.0, self._spans, 1.0)
        out = (np.array(self.marks, dtype=np.float64) - starts[:, None]) / spans[:, None]
        if not np.isfinite(out).all():
            raise self.refused("a mark is not a number: give the frame of each")
        if self.cyclic and out.shape[1]:
            # On from the first mark, which of its rounds is chosen to be nearest to that of the first clip's.
            after = (out - out[:, :1]) % 1.0
            out = out[:, :1] - np.round(out[:, :1] - out[:1, :1]) + after
        within = self.cyclic or not out.shape[1] or (out.min() >= -1e-9 and out.max() <= 1.0 + 1e-9)
        if not within or (np.diff(out, axis=1) <= 0.0).any():
            raise self.refused("marks must ascend within each clip: sort them, in cycles the same one first")
        return out

    @cached_property
    def _common(self) -> Array:
        """Phases at which the marks meet, shape (mark,)."""
        return self._shares @ self._phases

    def _own_times(self, clip: int, phases: Array) -> Array:
        """Return the frames of a clip's own that belong to phases of the mix, shape (n,)."""
        warped = _warped(phases, self._common, self._phases[clip], self.cyclic)
        return self.clips[clip].start + warped * self._spans[clip]

    @cached_property
    def _way(self) -> Way:
        """Of one round, over its phases."""
        count = max(int(np.ceil(self.cycle / ways.STEP)), 1)
        nodes = np.linspace(0.0, 1.0, count + 1)
        root = self.model.root
        leading = [(clip, i) for clip, i in self._counting if clip.active[root]]
        total = sum(self._shares[i] for _, i in leading)
        places, headings = np.zeros((count, 2)), np.zeros(count)
        for clip, i in leading:
            steps = clip.travel(self._own_times(i, nodes)).steps()
            places += self._shares[i] / total * steps.places
            headings += self._shares[i] / total * steps.headings
        return Way(nodes, Travel(places, headings).summed())


def _warped(phases: Array, common: Array, own: Array, cyclic: bool) -> Array:
    """Return a clip's own phases where its marks' phases, shape (mark,), are at common ones, shape (mark,)."""
    if not len(own):
        return phases
    if not cyclic:
        inner = (common > 0.0) & (common < 1.0)
        knots, places = (np.concatenate([[0.0], values[inner], [1.0]]) for values in (common, own))
        return np.asarray(np.interp(phases, knots, places), dtype=np.float64)
    # Before phase 0 there are frames as well, a round later: a clip shows nothing before its start.
    since = np.append(phases, 0.0) - common[0]
    rounds = np.floor(since)
    knots, places = np.append(common - common[0], 1.0), np.append(own, own[0] + 1.0)
    into: Array = np.asarray(np.interp(since - rounds, knots, places), dtype=np.float64)
    out = rounds + into
    return out[:-1] - np.floor(out[-1])


def _span(clip: Clip, cyclic: bool) -> float:
    if isinstance(clip, Loop | Mix) and not clip.is_finite:
        return clip.cycle
    return clip.length if cyclic else clip.length - 1.0
