"""Gestures in time with commands: how a clip is warped so that its stroke falls on the moment that was asked for.

A gesture prepares, strokes and goes back. Of its times, those that the command tells are met; the others keep their
distance from the nearest of them, so that what nobody asked for keeps its own speed.
"""

from collections.abc import Mapping
from dataclasses import astuple, fields

import numpy as np

from ...arrays import Array
from ...errors import MotionError, listed
from ..motions.annotations import Strokes

NAMES = tuple(own.name for own in fields(Strokes))
"""Of the times of a gesture, in their order."""
FASTEST, SLOWEST = 3.0, 0.25
"""No part of a gesture is played faster or slower than by these factors …"""
LEAST = 1.0
"""… or in less than this [frames]."""


def keys(strokes: Strokes, wanted: Mapping[str, float]) -> tuple[Array, Array, tuple[str, ...]]:
    """Return the keys of a time warp: frames of the clip, and the frames at which they are shown, shapes (key,).

    Args:
        strokes: Of the gesture [frames of its clip].
        wanted: When some of them shall be [frames from where the gesture starts], by name.

    Returns:
        The two rows of keys, both rising, and the names that could not be met: they would have played a part of the
        gesture faster than `FASTEST` or slower than `SLOWEST`, or in another order.

    Raises:
        MotionError: A name is none of a gesture's times.
    """
    unknown = [name for name in wanted if name not in NAMES]
    if unknown:
        raise MotionError(f"a gesture has no time {unknown[0]!r}: choose one of {listed(NAMES)}")
    own = np.array(astuple(strokes), dtype=np.float64)
    asked = {NAMES.index(name): float(time) for name, time in wanted.items() if np.isfinite(time)}
    shown = _shown(own, asked)
    missed = tuple(NAMES[i] for i, time in sorted(asked.items()) if abs(shown[i] - time) > 1e-9)
    first = np.concatenate([[True], np.diff(own) > 0.0])
    return own[first], shown[first], missed


def _shown(own: Array, asked: Mapping[int, float]) -> Array:
    """Return when the times of a gesture are shown: those that are asked for first, then those between and beside."""
    if not asked:
        return own
    order = sorted(asked)
    out = own.copy()
    before = order[0]
    # What comes before is as long as by itself, or as short as it must be to begin at the start.
    whole = own[before] - own[0]
    lead = min(whole, max(asked[before], whole / FASTEST))
    start = asked[before] - lead if whole > 0.0 else asked[before]
    start = max(start, 0.0)
    out[: before + 1] = start + (own[: before + 1] - own[0]) * (lead / whole if whole > 0.0 else 0.0)
    last, now = before, out[before]
    for key in order[1:]:
        length = own[key] - own[last]
        if length <= 0.0:
            out[last : key + 1] = now
            last = key
            continue
        takes = float(np.clip(asked[key] - now, max(length / FASTEST, LEAST), length / SLOWEST))
        out[last : key + 1] = now + (own[last : key + 1] - own[last]) * (takes / length)
        last, now = key, now + takes
    out[last:] = now + (own[last:] - own[last])
    return out
