"""Vector properties as curves with keys at common times, so that a linear map of their values keeps their shape.

A cubic Bezier curve is mapped exactly by mapping its keys and handles, if all components have them at the same
times. `read` brings them there: it splits segments where another component has a key, which changes no curve, and gives
handles of different lengths a common one, which keeps their slopes.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import bpy
import numpy as np
from numpy.typing import NDArray

from ...core.arrays import Array
from ..actions import CurveMap, put_in_group

SAME = 1e-4
"""Times nearer than this are the same [frames]."""
NOTHING = 1e-7
"""Values nearer than this are the same."""
_BEZIER = 2
_FREE = 0
_SETTINGS = ("interpolation", "easing", "handle_left_type", "handle_right_type")


@dataclass(frozen=True, eq=False)
class Track:
    """Keys of a vector property."""

    times: Array
    """Frames, shape (key,)."""
    values: Array
    """Shape (key, component)."""
    left_times: Array
    """Of the handles before the keys, shape (key,)."""
    left: Array
    """Values of these handles, shape (key, component)."""
    right_times: Array
    right: Array
    settings: dict[str, NDArray[np.uint8]]
    """Interpolation, easing and handle types of each key."""

    def stays(self, component: int, value: float) -> bool:
        """Return whether a component is ``value`` all the time."""
        parts = (self.values, self.left, self.right)
        return max(float(np.abs(part[:, component] - value).max()) for part in parts) < NOTHING

    def mapped(self, change: Callable[[Array], Array]) -> "Track":
        """Return the track with keys and handles taken through a map of values, shape (key, component) to the same."""
        return replace(self, values=change(self.values), left=change(self.left), right=change(self.right))


def read(found: CurveMap, path: str, defaults: Sequence[float]) -> Track | None:
    """Return the keys of a vector property, None when it has none.

    Args:
        found: Curves by path and index.
        path: Of the property.
        defaults: Values of components without a curve.
    """
    curves = [found.get((path, i)) for i in range(len(defaults))]
    own = [_Curve.read(curve) for curve in curves if curve is not None and len(curve.keyframe_points)]
    if not own:
        return None
    times = union([curve.times for curve in own])
    parts = [
        _Curve.read(curve).split(times)
        if curve is not None and len(curve.keyframe_points)
        else _Curve.flat(times, value)
        for curve, value in zip(curves, defaults, strict=True)
    ]
    moving = [p for p, c in zip(parts, curves, strict=True) if c is not None and len(c.keyframe_points)]
    left_times, left = _common([p.left for p in parts], [p.left for p in moving], times, parts)
    right_times, right = _common([p.right for p in parts], [p.right for p in moving], times, parts)
    values = np.stack([p.values for p in parts], axis=-1)
    return Track(times, values, left_times, left, right_times, right, moving[0].settings)


def write(
    bag: bpy.types.ActionChannelbag,
    found: CurveMap,
    path: str,
    track: Track,
    group: str,
    defaults: Sequence[float] | None = None,
) -> None:
    """Replace the keys of a vector property; curves keep their modifiers and extrapolation.

    Components that have no curve and never leave their default, if there is one, are not given one.
    """
    for i in range(track.values.shape[1]):
        curve = found.get((path, i))
        if curve is None:
            if defaults is not None and track.stays(i, defaults[i]):
                continue
            curve = found[path, i] = bag.fcurves.new(path, index=i)
            put_in_group(bag, curve, group)
        _fill(curve, track, i)


def _fill(curve: bpy.types.FCurve, track: Track, component: int) -> None:
    """Replace the keys of one curve. Handles that Blender would compute otherwise become free ones."""
    points = curve.keyframe_points
    points.clear()
    points.add(len(track.times))
    points.foreach_set("co", _pairs(track.times, track.values[:, component]))
    for name, values in track.settings.items():
        points.foreach_set(name, values)
    left = _pairs(track.left_times, track.left[:, component])
    right = _pairs(track.right_times, track.right[:, component])
    points.foreach_set("handle_left", left)
    points.foreach_set("handle_right", right)
    curve.update()
    for name, wanted in (("handle_left", left), ("handle_right", right)):
        now = np.empty(len(wanted), dtype=np.float32)
        points.foreach_get(name, now)
        off = np.abs(now - wanted).reshape(-1, 2).max(axis=-1) > 1e-6 * (1.0 + np.abs(wanted.reshape(-1, 2)).max())
        if off.any():
            for kind in ("handle_left_type", "handle_right_type"):
                points.foreach_set(kind, np.where(off, _FREE, track.settings[kind]).astype(np.uint8))
            points.foreach_set("handle_left", left)
            points.foreach_set("handle_right", right)
            curve.update()


def _pairs(times: Array, values: Array) -> NDArray[np.float32]:
    return np.stack([times, values], axis=-1).astype(np.float32).ravel()


def union(times: Sequence[Array]) -> Array:
    """Return all times once."""
    if not times:
        return np.empty(0)
    found = np.sort(np.concatenate(times))
    return found[np.concatenate([[True], np.diff(found) > SAME])]


def _common(all_: list[Array], moving: list[Array], times: Array, parts: list["_Curve"]) -> tuple[Array, Array]:
    """Return common handle times and the handles' values at them, shapes (key,) and (key, component)."""
    stacked = np.stack([handles[:, 0] for handles in moving])
    lengths = stacked.mean(axis=0)
    alike = np.ptp(stacked, axis=0) < SAME
    out = np.empty((len(times), len(all_)))
    for i, (handles, part) in enumerate(zip(all_, parts, strict=True)):
        away = handles[:, 0] - times
        slope = (handles[:, 1] - part.values) / np.where(np.abs(away) > SAME, away, 1.0)
        along = part.values + np.where(np.abs(away) > SAME, slope, 0.0) * (lengths - times)
        out[:, i] = np.where(alike & (np.abs(handles[:, 0] - lengths) < SAME), handles[:, 1], along)
    return lengths, out


@dataclass(frozen=True, eq=False)
class _Curve:
    """Keys of one curve."""

    times: Array
    values: Array
    left: Array
    """Time and value of the handle before each key, shape (key, 2)."""
    right: Array
    settings: dict[str, NDArray[np.uint8]]

    @classmethod
    def read(cls, curve: bpy.types.FCurve) -> "_Curve":
        """Return the keys of a curve."""
        points = curve.keyframe_points
        count = len(points)
        pairs: dict[str, Array] = {}
        for name in ("co", "handle_left", "handle_right"):
            buffer = np.empty(count * 2, dtype=np.float32)
            points.foreach_get(name, buffer)
            pairs[name] = buffer.astype(np.float64).reshape(count, 2)
        settings = {name: np.empty(count, dtype=np.uint8) for name in _SETTINGS}
        for name, values in settings.items():
            points.foreach_get(name, values)
        return cls(pairs["co"][:, 0], pairs["co"][:, 1], pairs["handle_left"], pairs["handle_right"], settings)

    @classmethod
    def flat(cls, times: Array, value: float) -> "_Curve":
        """Return a curve that stays where it is."""
        values = np.full(len(times), value)
        handles = np.stack([times, values], axis=-1)
        return cls(times, values, handles, handles.copy(), {})

    def split(self, times: Array) -> "_Curve":
        """Return the same curve with keys at ``times`` as well."""
        out = self
        for time in times:
            if np.abs(out.times - time).min() > SAME:
                out = out._with_key(float(time))
        return out

    def _with_key(self, time: float) -> "_Curve":
        place = int(np.searchsorted(self.times, time))
        if place in (0, len(self.times)):
            return self._beyond(time, place)
        before, after = place - 1, place
        left, right = self.left.copy(), self.right.copy()
        if self.settings["interpolation"][before] == _BEZIER:
            p0 = np.array([self.times[before], self.values[before]])
            p3 = np.array([self.times[after], self.values[after]])
            p1, p2 = _kept_in(p0, self.right[before], self.left[after], p3)
            t = _parameter(p0[0], p1[0], p2[0], p3[0], time)
            a, b, c = p0 + t * (p1 - p0), p1 + t * (p2 - p1), p2 + t * (p3 - p2)
            d, e = a + t * (b - a), b + t * (c - b)
            right[before], left[after], value = a, c, d + t * (e - d)
            own_left, own_right = d, e
        else:
            value = np.array([time, self._between(before, time)])
            own_left = own_right = value
        settings = {name: np.insert(v, place, v[before]) for name, v in self.settings.items()}
        for side in ("handle_left_type", "handle_right_type"):
            settings[side][before : after + 2] = _FREE
        return _Curve(
            np.insert(self.times, place, time),
            np.insert(self.values, place, value[1]),
            np.insert(left, place, own_left, axis=0),
            np.insert(right, place, own_right, axis=0),
            settings,
        )

    def _between(self, before: int, time: float) -> float:
        """Return the value between two keys that no Bezier curve joins: a line, or a step for constant ones."""
        if self.settings["interpolation"][before] == 0:
            return float(self.values[before])
        return float(np.interp(time, self.times, self.values))

    def _beyond(self, time: float, place: int) -> "_Curve":
        """Return the curve with a key before its first or after its last one, where it is constant."""
        end = 0 if place == 0 else len(self.times) - 1
        handle = np.array([time, self.values[end]])
        return _Curve(
            np.insert(self.times, place, time),
            np.insert(self.values, place, self.values[end]),
            np.insert(self.left, place, handle, axis=0),
            np.insert(self.right, place, handle, axis=0),
            {name: np.insert(v, place, v[end]) for name, v in self.settings.items()},
        )


def _kept_in(p0: Array, p1: Array, p2: Array, p3: Array) -> tuple[Array, Array]:
    """Return handles shortened as Blender does where they overlap in time."""
    length, total = p3[0] - p0[0], abs(p1[0] - p0[0]) + abs(p3[0] - p2[0])
    if total <= length:
        return p1, p2
    share = length / total
    return p0 + share * (p1 - p0), p3 + share * (p2 - p3)


def _parameter(x0: float, x1: float, x2: float, x3: float, time: float) -> float:
    """Return where a Bezier curve that runs forward in time is at ``time``."""
    low, high = 0.0, 1.0
    for _ in range(60):
        t = 0.5 * (low + high)
        s = 1.0 - t
        x = s**3 * x0 + 3.0 * s * s * t * x1 + 3.0 * s * t * t * x2 + t**3 * x3
        low, high = (t, high) if x < time else (low, t)
    return 0.5 * (low + high)
