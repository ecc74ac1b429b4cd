"""Bringing curves to common keys; see `joined`."""

import contextlib
from collections.abc import Container, Iterator, Sequence
from dataclasses import dataclass, field

import bpy
import numpy as np

from ...core.arrays import Array
from .joined import BEZIER, BOUNCE, CONSTANT, FREE, LINEAR, NEAR, NOTHING, OF_PIECE, SAME, SETTINGS, Joined, Keys, union

STEP = 0.012
"""A jump among curved pieces begins this long before its key [frames]."""
POINTS = 13
"""At so many points a piece is compared with what it is drawn from; cubics go through four of them."""
_FLAT = -1


def join(
    curves: Sequence[Keys | None],
    still: Array,
    sources: Sequence[bpy.types.FCurve | None],
    tolerance: Array,
    eased: Container[int],
) -> Joined | None:
    """Return curves with common keys, None when there are none.

    Args:
        curves: The keys of each, None for what stays where it is.
        still: Where that is, shape (curve,).
        sources: Where the keys are from.
        tolerance: Difference in each that does not matter, shape (curve,).
        eased: Easings that may be kept where curves have them in common.
    """
    times = union([own.times for own in curves if own is not None])
    if not len(times):
        return None
    with _bare(sources):
        joiner = _Joiner(curves, still, sources, tolerance, eased)
        joiner.begin(float(times[0]))
        for start, end in zip(times[:-1].tolist(), times[1:].tolist(), strict=True):
            joiner.add(start, end)
        return joiner.end()


@contextlib.contextmanager
def _bare(sources: Sequence[bpy.types.FCurve | None]) -> Iterator[None]:
    """Leave the modifiers of curves out for a while."""
    active = [m for source in sources if source is not None for m in source.modifiers if not m.mute]
    for modifier in active:
        modifier.mute = True
    try:
        yield
    finally:
        for modifier in active:
            modifier.mute = False


@dataclass
class _Knot:
    """One common key."""

    time: float
    values: Array
    settings: dict[str, float]
    left_time: float = 0.0
    left: Array = field(default_factory=lambda: np.empty(0))
    right_time: float = 0.0
    right: Array = field(default_factory=lambda: np.empty(0))


@dataclass(frozen=True)
class _Span:
    """What one curve does between two times."""

    kind: int
    """Its interpolation, or _FLAT."""
    key: int | None = None
    """The key that begins it, if the span is the whole way to the next key."""
    jumps: bool = False
    """Whether it ends with a jump."""


class _Joiner:
    """Common keys, made one after the other."""

    def __init__(
        self,
        curves: Sequence[Keys | None],
        still: Array,
        sources: Sequence[bpy.types.FCurve | None],
        tolerance: Array,
        eased: Container[int],
    ) -> None:
        self._curves, self._still, self._sources = curves, still, sources
        self._tolerance, self._easings = tolerance, eased
        self._knots: list[_Knot] = []

    def begin(self, time: float) -> None:
        """Make the first key."""
        knot = self._knot(time)
        knot.left_time, knot.left = self._handle(time, knot.values, "left")
        self._knots.append(knot)

    def end(self) -> Joined:
        """Return all keys."""
        knots, last = self._knots, self._knots[-1]
        last.right_time, last.right = self._handle(last.time, last.values, "right")
        return Joined(
            np.array([k.time for k in knots]),
            np.array([k.values for k in knots]),
            np.array([k.left_time for k in knots]),
            np.array([k.left for k in knots]),
            np.array([k.right_time for k in knots]),
            np.array([k.right for k in knots]),
            {name: np.array([k.settings[name] for k in knots]).astype(kind) for name, (kind, _) in SETTINGS.items()},
        )

    def add(self, start: float, end: float) -> None:
        """Make the keys from one time to the next."""
        spans = [self._span(i, start, end) for i in range(len(self._curves))]
        kinds = {span.kind for span in spans}
        if CONSTANT in kinds and kinds <= {_FLAT, CONSTANT}:
            self._exact(end, spans, CONSTANT)
        elif any(span.jumps for span in spans):
            before = end - STEP
            if before > start + STEP:
                self.add(start, before)
            self._exact(end, [], CONSTANT)
        elif any(kind > BEZIER for kind in kinds):
            self._eased(end, spans)
        elif BEZIER in kinds and not self._alike(spans):
            self._curved(start, end)
        else:
            kind = BEZIER if BEZIER in kinds else LINEAR
            self._exact(end, spans, kind)

    def _eased(self, end: float, spans: Sequence[_Span]) -> None:
        """Keep an easing that all moving curves have in common, or draw it."""
        moving = [(own, s.key) for own, s in zip(self._curves, spans, strict=True) if s.kind not in {_FLAT, CONSTANT}]
        manners = {
            tuple(own.setting(name, key) for name in OF_PIECE) if own is not None and key is not None else None
            for own, key in moving
        }
        kind = max(span.kind for span in spans)
        if kind in self._easings and len(manners) == 1 and None not in manners:
            self._exact(end, spans, kind)
            return
        times = [self._knots[-1].time, end]
        times += [t for own, key in moving if own is not None for t in _kinks(own, *times[:2])]
        times = [t for t in union([np.array(times)]).tolist() if t < end - NEAR]
        for first, last in zip(times, [*times[1:], end], strict=True):
            self._curved(first, last)

    def _alike(self, spans: Sequence[_Span]) -> bool:
        """Return whether all curved spans run through time in the same way."""
        found: list[tuple[float, float]] = []
        for own, span in zip(self._curves, spans, strict=True):
            if span.kind == BEZIER:
                if own is None or span.key is None:
                    return False
                found.append((own.right[span.key, 0], own.left[span.key + 1, 0]))
        return bool(np.ptp(np.array(found), axis=0).max() < SAME)

    def _span(self, i: int, start: float, end: float) -> _Span:
        """Return what a curve does between two times that have none of its keys between them."""
        own, source = self._curves[i], self._sources[i]
        if own is None or source is None:
            return _Span(_FLAT)
        if end < own.times[0] + NEAR or start > own.times[-1] - NEAR:
            return _Span(LINEAR if source.extrapolation == "LINEAR" else _FLAT)
        key = int(np.searchsorted(own.times, start + NEAR)) - 1
        kind, level = int(own.settings["interpolation"][key]), own.values[key]
        ends = abs(own.times[key + 1] - end) < NEAR
        whole = key if ends and abs(own.times[key] - start) < NEAR else None
        if kind == CONSTANT:
            return _Span(CONSTANT, whole, bool(ends and abs(own.values[key + 1] - level) > NOTHING))
        points = [own.values[key + 1], *((own.right[key, 1], own.left[key + 1, 1]) if kind == BEZIER else ())]
        if kind <= BEZIER and max(abs(point - level) for point in points) < NOTHING:
            return _Span(_FLAT, whole)
        return _Span(kind, whole)

    def _exact(self, end: float, spans: Sequence[_Span], kind: int) -> None:
        """Make the next key, with a piece between that is drawn as it was."""
        last, knot = self._knots[-1], self._knot(end)
        whole = [(own, span.key) for own, span in zip(self._curves, spans, strict=False) if span.key is not None]
        like = [(own, key) for own, key in whole if own is not None and own.settings["interpolation"][key] == kind]
        last.settings["interpolation"] = kind
        last.settings["handle_right_type"] = knot.settings["handle_left_type"] = FREE
        last.right_time, knot.left_time = last.time + (end - last.time) / 3.0, end - (end - last.time) / 3.0
        curved = [pair for pair in like if kind != BEZIER or not _is_flat(*pair)] or like
        if curved:
            own, key = curved[0]
            for name in OF_PIECE:
                last.settings[name] = own.setting(name, key)
            last.settings["handle_right_type"] = own.setting("handle_right_type", key)
            knot.settings["handle_left_type"] = own.setting("handle_left_type", key + 1)
            last.right_time, knot.left_time = float(own.right[key, 0]), float(own.left[key + 1, 0])
        slope = (knot.values - last.values) / (end - last.time)
        last.right = last.values + slope * (last.right_time - last.time)
        knot.left = knot.values + slope * (knot.left_time - end)
        for i, span in enumerate(spans):
            own = self._curves[i]
            if own is not None and span.key is not None and (span.kind != LINEAR or kind != BEZIER):
                last.right[i], knot.left[i] = own.right[span.key, 1], own.left[span.key + 1, 1]
        self._knots.append(knot)

    def _curved(self, start: float, end: float) -> None:
        """Make the keys from one time to the next, with as many cubic pieces as it takes."""
        times = np.linspace(start, end, POINTS)
        seen = np.array([self._values(start), *(self._sampled(t) for t in times[1:-1].tolist()), self._values(end)])
        a, b, c, d = seen[:: POINTS // 3]
        first = (-5.0 * a + 18.0 * b - 9.0 * c + 2.0 * d) / 6.0
        second = (2.0 * a - 9.0 * b + 18.0 * c - 5.0 * d) / 6.0
        t = np.linspace(0.0, 1.0, POINTS)[:, None]
        drawn = (1.0 - t) ** 3 * a + 3.0 * t * (1.0 - t) ** 2 * first + 3.0 * t * t * (1.0 - t) * second + t**3 * d
        if (np.abs(drawn - seen) > self._tolerance).any() and end - start > 2.0 * NEAR:
            middle = 0.5 * (start + end)
            self._curved(start, middle)
            self._curved(middle, end)
            return
        last, knot = self._knots[-1], self._knot(end)
        last.settings["interpolation"], last.settings["easing"] = BEZIER, 0
        last.settings["handle_right_type"] = knot.settings["handle_left_type"] = FREE
        last.right_time, last.right = start + (end - start) / 3.0, first
        knot.left_time, knot.left = end - (end - start) / 3.0, second
        self._knots.append(knot)

    def _knot(self, time: float) -> _Knot:
        """Return a key with the settings of the first curve that has one there."""
        settings = {name: float(new) for name, (_, new) in SETTINGS.items()}
        for own in self._curves:
            key = None if own is None else own.at(time)
            if own is not None and key is not None:
                settings = {name: own.setting(name, key) for name in SETTINGS}
                break
        return _Knot(time, self._values(time), settings)

    def _handle(self, time: float, values: Array, side: str) -> tuple[float, Array]:
        """Return the outer handle of the first or last key: its time, and its value on each curve."""
        out, at = values.copy(), time
        for i, own in enumerate(self._curves):
            key = None if own is None else own.at(time)
            if own is not None and key is not None:
                handle = getattr(own, side)[key]
                at = float(handle[0]) if at == time else at
                away = handle[0] - time
                out[i] += (handle[1] - out[i]) * ((at - time) / away if abs(away) > SAME else 1.0)
        return at, out

    def _values(self, time: float) -> Array:
        """Return the values of all curves at a time, those of keys where they are, shape (curve,)."""
        out = self._sampled(time)
        for i, own in enumerate(self._curves):
            key = None if own is None else own.at(time)
            if own is not None and key is not None:
                out[i] = own.values[key]
        return out

    def _sampled(self, time: float) -> Array:
        """Return the values of all curves at a time as Blender evaluates them, shape (curve,)."""
        pairs = zip(self._sources, self._still, strict=True)
        return np.array([value if source is None else source.evaluate(time) for source, value in pairs])


def _kinks(own: Keys, start: float, end: float) -> list[float]:
    """Return where a bouncing curve between two times hits its ground, if any piece of it does."""
    key = int(np.searchsorted(own.times, start + NEAR)) - 1
    if key < 0 or int(own.settings["interpolation"][key]) != BOUNCE:
        return []
    hits = np.array([0.0, 1.0, 2.0, 2.5, 2.75]) / 2.75
    shares = np.concatenate([hits, 1.0 - hits, 0.5 * (1.0 + hits), 0.5 * (1.0 - hits)])
    times = own.times[key] + shares * (own.times[key + 1] - own.times[key])
    return [t for t in times.tolist() if start + NEAR < t < end - NEAR]


def _is_flat(own: Keys, key: int) -> bool:
    level = own.values[key]
    return max(abs(v - level) for v in (own.values[key + 1], own.right[key, 1], own.left[key + 1, 1])) < NOTHING
