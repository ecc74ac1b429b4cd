"""Vector properties as keys of curves, whose values can be taken through linear maps without changing their motion.

A curve is mapped exactly by mapping its keys and handles. Where components mix, `joined` first gives them common keys.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

import bpy
import numpy as np
from numpy.typing import NDArray

from ...core.arrays import Array
from ..actions import CurveMap, copy_modifier, pairs, put_in_group
from .joined import BEZIER, ELASTIC, FREE, LINEAR, MOST, NOTHING, OF_PIECE, SAME, Joined, Keys, union
from .joining import join

__all__ = ["SAME", "Change", "Keys", "Track", "read", "union", "write"]
_MIXING = 1e-9
KEPT = 1e-12
"""A map that differs by less from one that changes nothing changes nothing."""


@dataclass(frozen=True, eq=False)
class Change:
    """A map of a vector property's values that is linear at each time; it may bend where a height is zero."""

    times: Array
    """Frames at which it is known, shape (time,)."""
    matrix: Array
    """Of values, shape (time or 1, component, component)."""
    offset: Array
    """What is added to them, shape (time or 1, component)."""
    above: tuple[Array, Array] | None
    """Matrix and offset where the height is above zero, None without a bend."""
    height: tuple[Array, Array]
    """Row and offset that give the height of a value, shapes (time or 1, component) and (time or 1,)."""
    tolerance: Array
    """Difference in each component that does not matter, shape (component,)."""

    def groups(self) -> list[list[int]]:
        """Return the components that mix with each other, each group in order."""
        count = self.matrix.shape[-1]
        mixing = np.eye(count, dtype=bool)
        for matrix in [self.matrix] + ([] if self.above is None else [self.above[0]]):
            mixing |= (np.abs(matrix) > _MIXING * np.abs(matrix).max()).any(axis=0)
        if self.above is not None:
            row = (np.abs(self.height[0]) > _MIXING).any(axis=0)
            mixing |= np.outer(row, row)
        mixing |= mixing.T
        for _ in range(count):
            mixing = mixing @ mixing
        return [np.flatnonzero(mixing[i]).tolist() for i in range(count) if not mixing[i, :i].any()]

    @property
    def holds(self) -> bool:
        """Whether the map is the same at all times."""
        return len(self.matrix) == len(self.offset) == len(self.height[0]) == 1

    def keeps(self, group: Sequence[int]) -> bool:
        """Return whether the map changes nothing about some components."""
        sides = [(self.matrix, self.offset)] + ([] if self.above is None else [self.above])
        return all(
            bool((np.abs(matrix[:, group][:, :, group] - np.eye(len(group))) < KEPT).all())
            and bool((np.abs(offset[:, group]) < KEPT).all())
            for matrix, offset in sides
        )

    def bends_in(self, group: Sequence[int]) -> bool:
        """Return whether the map bends along some components."""
        return self.above is not None and bool((np.abs(self.height[0][:, group]) > _MIXING).any())

    def heights(self, group: Sequence[int], values: Array) -> Array:
        """Return the heights of values of a group, shape (key, member), at the first times, shape (key,)."""
        rows, offset = (part[: len(values)] for part in self.height)
        return (rows[:, group] * values).sum(axis=-1) + offset

    def applied(self, group: Sequence[int], values: Array, up: NDArray[np.bool_] | None = None) -> Array:
        """Return values of a group, shape (key, member), mapped; ``up`` tells which are above the bend."""
        out = _affine(self.matrix, self.offset, group, values)
        if self.above is None:
            return out
        if up is None:
            up = self.heights(group, values) > 0.0 if self.bends_in(group) else np.zeros(len(values), dtype=bool)
        return np.where(up[:, None], _affine(*self.above, group, values), out)


def _affine(matrix: Array, offset: Array, group: Sequence[int], values: Array) -> Array:
    own = matrix[:, group][:, :, group]
    return (own @ values[..., None])[..., 0] + offset[:, group]


@dataclass(frozen=True, eq=False)
class Track:
    """Keys of a vector property."""

    curves: tuple[Keys | None, ...]
    """By component, None for one without keys."""
    still: Array
    """Values of the components without keys, shape (component,)."""
    sources: tuple[bpy.types.FCurve | None, ...]
    """Curves that the keys are from, as long as nobody writes to them."""

    @property
    def times(self) -> Array:
        """All times of keys [frames], shape (time,)."""
        return union([own.times for own in self.curves if own is not None])

    def mapped(self, at: Callable[[Array], Change]) -> "Track":
        """Return the track with its values taken through a map.

        Args:
            at: Returns the map at some times.
        """
        change = at(self.times)
        curves: list[Keys | None] = [None] * len(self.curves)
        still = self.still.copy()
        for group in change.groups():
            if change.keeps(group):
                for i in group:
                    curves[i] = self.curves[i]
                continue
            found = self._joined(group, change)
            if found is None:
                values = change.applied(group, np.tile(self.still[group], (len(change.times), 1)))
                still[group] = values[0]
                if np.ptp(values, axis=0).max() > NOTHING:
                    found = Joined.flat(change.times, self.still[group], LINEAR)
            if found is None:
                continue
            if change.bends_in(group):
                there = change if change.holds else at(found.times)
                found = found.split_where(lambda values, g=group, c=there: c.heights(g, values))
            there = change if change.holds else at(found.times)
            for i, own in zip(group, _changed(found, group, there), strict=True):
                curves[i] = own
        return Track(tuple(curves), still, self.sources)

    def same_as(self, other: "Track") -> bool:
        """Return whether another track has the same keys, handles and interpolation, but for rounding."""
        return all(
            a.same_as(b) if a is not None and b is not None else a is b or _level(a, s, b, t)
            for a, b, s, t in zip(self.curves, other.curves, self.still, other.still, strict=True)
        )

    def _joined(self, group: Sequence[int], change: Change) -> Joined | None:
        """Return the curves of some components with common keys, None when they have none."""
        sources = [self.sources[i] for i in group]
        eased = set() if change.bends_in(group) else set(range(BEZIER + 1, MOST))
        if not (change.holds and len(group) == 1 and change.matrix[0, group[0], group[0]] > 0.0):
            eased -= {ELASTIC}  # its amplitude is absolute, and its phase has no mirror image
        return join([self.curves[i] for i in group], self.still[group], sources, change.tolerance[group], eased)


def _level(a: Keys | None, still_a: float, b: Keys | None, still_b: float) -> bool:
    """Return whether two components, one of them at least without keys, stay at the same value."""
    keys, still = (b, still_a) if a is None else (a, still_b)
    return keys is not None and keys.stays(still)


def _changed(found: Joined, group: Sequence[int], change: Change) -> list[Keys]:
    """Return the keys of each component of a group, mapped."""
    middle = found.middles
    up = change.heights(group, middle) > 0.0 if change.bends_in(group) else np.zeros(len(middle), dtype=bool)
    values = change.applied(group, found.values)
    left = change.applied(group, found.left, np.append(up[:1], up) if len(up) else None)
    right = change.applied(group, found.right, np.append(up, up[-1:]) if len(up) else None)
    settings = found.settings
    if len(group) == 1:
        factor = abs(float(change.matrix[0, group[0], group[0]]))
        amplitude = settings["amplitude"] * np.where(settings["interpolation"] == ELASTIC, factor, 1.0)
        settings = settings | {"amplitude": amplitude.astype(np.float32)}
    return replace(found, values=values, left=left, right=right, settings=settings).parts()


def read(found: CurveMap, path: str, defaults: Sequence[float] | Array) -> Track | None:
    """Return the keys of a vector property, None when it has none.

    Args:
        found: Curves by path and index.
        path: Of the property.
        defaults: Values of components without a curve.
    """
    curves = [found.get((path, i)) for i in range(len(defaults))]
    sources = tuple(c if c is not None and len(c.keyframe_points) else None for c in curves)
    if not any(source is not None for source in sources):
        return None
    own = tuple(None if source is None else Keys.read(source) for source in sources)
    return Track(own, np.array(defaults, dtype=np.float64), sources)


def trace(found: CurveMap, paths: Iterable[str]) -> bytes:
    """Return all that can be seen of the keys of some properties, to see whether they have changed."""
    wanted = set(paths)
    parts: list[bytes] = []
    for (path, index), curve in sorted(found.items(), key=lambda pair: pair[0]):
        if path in wanted:
            own = Keys.read(curve)
            seen = [own.times, own.values, own.left, own.right, *(own.settings[name] for name in OF_PIECE)]
            parts += [f"{path}[{index}]".encode(), *(values.tobytes() for values in seen)]
    return b"".join(parts)


def write(
    bag: bpy.types.ActionChannelbag,
    found: CurveMap,
    path: str,
    track: Track,
    group: str,
    defaults: Sequence[float] | Array | None = None,
) -> None:
    """Replace the keys of a vector property; curves keep their modifiers and extrapolation, new ones get the others'.

    Components that have no curve and never leave their default, if there is one, are not given one.
    """
    first = next(source for source in track.sources if source is not None)
    for i, keys in enumerate(track.curves):
        curve = found.get((path, i))
        if keys is None or (curve is None and defaults is not None and keys.stays(float(defaults[i]))):
            continue
        if curve is None:
            curve = found[path, i] = bag.fcurves.new(path, index=i)
            put_in_group(bag, curve, group)
            _fill(curve, keys)
            _behave_like(curve, track.sources[i] or first)
        else:
            _fill(curve, keys)


def _behave_like(curve: bpy.types.FCurve, other: bpy.types.FCurve) -> None:
    curve.extrapolation = other.extrapolation
    for modifier in other.modifiers:
        copy_modifier(modifier, curve)


def _fill(curve: bpy.types.FCurve, keys: Keys) -> None:
    """Replace the keys of one curve. Handles that Blender would compute otherwise become free ones."""
    points = curve.keyframe_points
    if len(points) != len(keys.times):
        points.clear()
        points.add(len(keys.times))
    points.foreach_set("co", pairs(keys.times, keys.values))
    for name, values in keys.settings.items():
        points.foreach_set(name, values)
    handles = {"handle_left": keys.left, "handle_right": keys.right}
    free = np.zeros(len(keys.times), dtype=bool)
    for _ in range(2):  # Blender computes handles of some types anew
        for name, wanted in handles.items():
            points.foreach_set(name, wanted.astype(np.float32).ravel())
        curve.update()
        for name, wanted in handles.items():
            free |= _off(points, name, wanted, np.abs(keys.values).max())
        if not free.any():
            return
        for kind in ("handle_left_type", "handle_right_type"):
            points.foreach_set(kind, np.where(free, FREE, keys.settings[kind]).astype(np.uint8))


def _off(points: bpy.types.FCurveKeyframePoints, name: str, wanted: Array, size: float) -> NDArray[np.bool_]:
    """Return which handles are not where they shall be."""
    now = np.empty(2 * len(wanted), dtype=np.float32)
    points.foreach_get(name, now)
    away = np.abs(now.reshape(-1, 2) - wanted)
    return (away[:, 0] > SAME) | (away[:, 1] > 1e-6 * max(size, 1e-3))
