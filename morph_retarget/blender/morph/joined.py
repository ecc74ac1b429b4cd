"""Curves with common keys, so that linear maps of their values together keep their shape.

Curves that have keys and handles at the same times can be mapped key by key. Where they have not, straight and constant
pieces are split, which changes nothing, and what is curved is drawn anew by as many cubic pieces as it takes;
see `joining`.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from ...core.arrays import Array

SAME = 1e-4
"""Times of handles nearer than this are the same [frames]."""
NEAR = 0.011
"""Keys nearer than this are one: Blender merges those within a hundredth of a frame [frames]."""
NOTHING = 1e-7
"""Values nearer than this are the same."""
CONSTANT, LINEAR, BEZIER = 0, 1, 2
FREE = 0
SETTINGS: dict[str, tuple[type, float]] = {
    "interpolation": (np.uint8, BEZIER),
    "easing": (np.uint8, 0),
    "handle_left_type": (np.uint8, FREE),
    "handle_right_type": (np.uint8, FREE),
    "type": (np.uint8, 0),
    "amplitude": (np.float32, 0.8),
    "back": (np.float32, 1.70158),
    "period": (np.float32, 4.1),
    "select_control_point": (np.bool_, 0),
    "select_left_handle": (np.bool_, 0),
    "select_right_handle": (np.bool_, 0),
}
"""Further properties of keys, with those of a new one."""
ROUNDING = 1e-6
"""Relative to the largest value."""
BOUNCE, ELASTIC, MOST = 4, 7, 13
OF_PIECE = ("interpolation", "easing", "amplitude", "back", "period")
_Settings = dict[str, NDArray[np.generic]]


def union(times: Sequence[Array]) -> Array:
    """Return all times once."""
    if not times:
        return np.empty(0)
    found = np.sort(np.concatenate(times))
    kept: list[float] = []
    for time in found.tolist():
        if not kept or time - kept[-1] > NEAR:
            kept.append(time)
    return np.array(kept)


@dataclass(frozen=True, eq=False)
class Keys:
    """Keys of one curve."""

    times: Array
    """Frames, shape (key,)."""
    values: Array
    left: Array
    """Time and value of the handle before each key, shape (key, 2)."""
    right: Array
    settings: _Settings
    """Interpolation, handle types and so on of each key, by the name of the property."""

    @classmethod
    def read(cls, curve: bpy.types.FCurve) -> "Keys":
        """Return the keys of a curve."""
        points = curve.keyframe_points
        count = len(points)
        pairs: dict[str, Array] = {}
        for name in ("co", "handle_left", "handle_right"):
            buffer = np.empty(count * 2, dtype=np.float32)
            points.foreach_get(name, buffer)
            pairs[name] = buffer.astype(np.float64).reshape(count, 2)
        settings: _Settings = {name: np.empty(count, dtype=kind) for name, (kind, _) in SETTINGS.items()}
        for name, values in settings.items():
            points.foreach_get(name, values)
        return cls(pairs["co"][:, 0], pairs["co"][:, 1], pairs["handle_left"], pairs["handle_right"], settings)

    def stays(self, value: float) -> bool:
        """Return whether the curve is ``value`` all the time."""
        return max(float(np.abs(part - value).max()) for part in (self.values, self.left[:, 1], self.right[:, 1])) < (
            NOTHING
        )

    def same_as(self, other: "Keys") -> bool:
        """Return whether another curve has the same keys, handles and interpolation, but for rounding."""
        if len(self.times) != len(other.times) or np.abs(self.times - other.times).max() > SAME:
            return False
        size = ROUNDING * max(float(np.abs(self.values).max()), 1.0)
        away = [self.values - other.values, (self.left - other.left)[:, 1], (self.right - other.right)[:, 1]]
        times = [(self.left - other.left)[:, 0], (self.right - other.right)[:, 0]]
        return (
            max(float(np.abs(part).max()) for part in away) < size
            and max(float(np.abs(part).max()) for part in times) < SAME
            and all(bool((self.settings[name] == other.settings[name]).all()) for name in OF_PIECE)
        )

    def at(self, time: float) -> int | None:
        """Return the key at a time, None without one."""
        near = int(np.argmin(np.abs(self.times - time)))
        return near if abs(self.times[near] - time) < NEAR else None

    def setting(self, name: str, key: int) -> float:
        """Return one setting of a key."""
        return float(self.settings[name][key])


@dataclass(frozen=True, eq=False)
class Joined:
    """Keys that several curves have in common."""

    times: Array
    """Frames, shape (key,)."""
    values: Array
    """Shape (key, curve)."""
    left_times: Array
    """Of the handles before the keys, shape (key,)."""
    left: Array
    """Values of these handles, shape (key, curve)."""
    right_times: Array
    right: Array
    settings: _Settings

    @classmethod
    def flat(cls, times: Array, values: Array, interpolation: int) -> "Joined":
        """Return keys at some times of curves that stay where they are."""
        rows = np.tile(values, (len(times), 1))
        settings = {name: np.full(len(times), new, dtype=kind) for name, (kind, new) in SETTINGS.items()}
        settings["interpolation"][:] = interpolation
        return cls(times, rows, times, rows, times, rows, settings)

    @property
    def middles(self) -> Array:
        """Values between each key and the next, shape (key - 1, curve)."""
        kinds = self.settings["interpolation"][:-1]
        ends = self.values[:-1], self.values[1:]
        curved = 0.125 * (ends[0] + 3.0 * self.right[:-1] + 3.0 * self.left[1:] + ends[1])
        out = np.where((kinds == BEZIER)[:, None], curved, 0.5 * (ends[0] + ends[1]))
        return np.where((kinds == CONSTANT)[:, None], ends[0], out)

    def parts(self) -> list[Keys]:
        """Return the keys of each curve."""
        return [
            Keys(
                self.times,
                self.values[:, i],
                np.stack([self.left_times, self.left[:, i]], axis=-1),
                np.stack([self.right_times, self.right[:, i]], axis=-1),
                self.settings,
            )
            for i in range(self.values.shape[1])
        ]

    def split_where(self, heights: Callable[[Array], Array]) -> "Joined":
        """Return the same curves with keys where they cross a level.

        Args:
            heights: From values of one place between each key and the next, shape (key - 1, curve), to their heights
                above the level, shape (key - 1,); linear.
        """
        control = [self.values[:-1], self.right[:-1], self.left[1:], self.values[1:]]
        high = np.stack([heights(part) for part in control], axis=-1)
        out = self
        for key in reversed(range(len(high))):
            whole = 1.0
            for share in reversed(_crossings(high[key], int(self.settings["interpolation"][key]))):
                split = out._with_key(key, share / whole)
                out, whole = (split, share) if split is not out else (out, whole)
        return out

    def _with_key(self, key: int, share: float) -> "Joined":
        """Return the same curves with one more key, at a share of the piece after a key, unless one is near."""
        pair = np.stack([self.times, self.right_times, self.left_times], axis=-1)
        p0 = np.append(self.values[key], pair[key, 0])
        p1, p2 = np.append(self.right[key], pair[key, 1]), np.append(self.left[key + 1], pair[key + 1, 2])
        p3 = np.append(self.values[key + 1], pair[key + 1, 0])
        right, left = self.right.copy(), self.left.copy()
        right_times, left_times = self.right_times.copy(), self.left_times.copy()
        settings = {name: values.copy() for name, values in self.settings.items()}
        if settings["interpolation"][key] == BEZIER:
            p1, p2 = _kept_in(p0, p1, p2, p3)
            a, b, c = p0 + share * (p1 - p0), p1 + share * (p2 - p1), p2 + share * (p3 - p2)
            d, e = a + share * (b - a), b + share * (c - b)
            new = d + share * (e - d)
            right[key], right_times[key] = a[:-1], a[-1]
            left[key + 1], left_times[key + 1] = c[:-1], c[-1]
            settings["handle_right_type"][key] = settings["handle_left_type"][key + 1] = FREE
        else:
            d = e = new = p0 + share * (p3 - p0)
        if min(new[-1] - p0[-1], p3[-1] - new[-1]) < NEAR:
            return self
        row = key + 1
        for name, values in settings.items():
            fresh = values[key] if name in OF_PIECE else SETTINGS[name][1]
            settings[name] = np.insert(values, row, fresh)
        return Joined(
            np.insert(self.times, row, new[-1]),
            np.insert(self.values, row, new[:-1], axis=0),
            np.insert(left_times, row, d[-1]),
            np.insert(left, row, d[:-1], axis=0),
            np.insert(right_times, row, e[-1]),
            np.insert(right, row, e[:-1], axis=0),
            settings,
        )


def _crossings(heights: Array, kind: int) -> list[float]:
    """Return where a piece crosses the level, as shares of its parameter, in order."""
    if kind == CONSTANT or heights.min() > -NOTHING or heights.max() < NOTHING:
        return []
    a, b, c, d = heights if kind == BEZIER else heights[0] + (heights[3] - heights[0]) * np.arange(4) / 3.0
    roots = np.roots([d - 3.0 * c + 3.0 * b - a, 3.0 * (c - 2.0 * b + a), 3.0 * (b - a), a])
    real = roots[np.abs(roots.imag) < 1e-9].real
    return sorted(float(r) for r in real if 1e-6 < r < 1.0 - 1e-6)


def _kept_in(p0: Array, p1: Array, p2: Array, p3: Array) -> tuple[Array, Array]:
    """Return handles, whose last component is time, shortened as Blender does where they overlap in time."""
    length, total = p3[-1] - p0[-1], abs(p1[-1] - p0[-1]) + abs(p3[-1] - p2[-1])
    if total <= length:
        return p1, p2
    share = length / total
    return p0 + share * (p1 - p0), p3 + share * (p2 - p3)
