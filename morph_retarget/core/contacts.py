"""Finding when feet stand: plant and flight intervals from the motion alone (Feng 2013 §5.2 takes them as annotated).

A foot stands while it is slow and low, or very still at any height (a step, a ledge). Two thresholds keep the
intervals from flickering: a stricter one starts them, a looser one ends them.
"""

from dataclasses import dataclass

import numpy as np

from . import quat
from .arrays import Array, Flags
from .runs import runs


@dataclass(frozen=True)
class ContactSettings:
    """When a foot counts as standing. Lengths are in leg lengths, speeds in leg lengths a second."""

    start_speed: float = 0.20
    """Slower than this, a low foot starts to stand."""
    end_speed: float = 0.40
    """Faster than this, it has left."""
    still_speed: float = 0.10
    """Slower than this, a foot stands at any height."""
    height: float = 0.07
    """How far above the floor a foot is still low."""
    shortest: float = 0.08
    """Shorter plants are dropped [s]."""
    shortest_high: float = 0.2
    """The same for plants above the floor: for a moment a foot is still wherever it turns back [s]."""
    shortest_flight: float = 0.05
    """Shorter flights between two plants are closed [s]."""


@dataclass(frozen=True)
class Plant:
    """One interval in which a foot stands."""

    foot: int
    """Place of the foot in the list of feet."""
    start: int
    """First frame, as a row of the batch."""
    end: int
    """Last frame, included."""


def find_plants(points: Array, seconds_per_frame: float, leg_length: float, settings: ContactSettings) -> Flags:
    """Return whether each foot stands in each frame, shape (frame, foot).

    Args:
        points: Places of the feet, shape (frame, foot, 3), any unit, up along z.
        seconds_per_frame: Time between frames [s].
        leg_length: In the unit of ``points``.
        settings: Thresholds.
    """
    frames = len(points)
    if frames < 3 or not points.shape[1]:
        return np.ones(points.shape[:2], dtype=bool)
    speed = speeds(points, seconds_per_frame) / leg_length
    height = points[..., 2] / leg_length
    floor = floor_height(height, speed, settings)
    low = height < floor + settings.height
    starts = (low & (speed < settings.start_speed)) | (speed < settings.still_speed)
    holds = (low & (speed < settings.end_speed)) | (speed < 1.5 * settings.still_speed)
    out = np.stack([hysteresis(starts[:, f], holds[:, f]) for f in range(points.shape[1])], axis=-1)
    for foot in range(out.shape[1]):
        _drop_turns(out[:, foot], low[:, foot], settings.shortest_high / seconds_per_frame)
        drop_short(out[:, foot], False, settings.shortest_flight / seconds_per_frame)
        drop_short(out[:, foot], True, settings.shortest / seconds_per_frame)
    return out


def _drop_turns(standing: Flags, low: Flags, frames: float) -> None:
    """Drop plants of one foot that are nowhere low and shorter than ``frames``, in place."""
    for first, last in runs(standing):
        if last - first + 1 < frames and not low[first : last + 1].any():
            standing[first : last + 1] = False


MOST_BELOW = 0.2
"""A foot is below its floor in no larger share of a clip."""
SPEED_TIME = 0.04
"""Speeds are taken over this time, so that capture noise at 120 Hz does not look like motion [s]."""


def speeds(points: Array, seconds_per_frame: float) -> Array:
    """Return the speed of points, shape (frame, ...): before or after each frame, whichever is slower.

    So a foot stands in the frame in which it lands, and still in the one from which it leaves.
    """
    half = max(round(0.5 * SPEED_TIME / seconds_per_frame), 1)
    half = min(half, len(points) - 1)
    speed = quat.length(points[half:] - points[:-half]) / (half * seconds_per_frame)
    wide = [(0, 0)] * (speed.ndim - 1)
    before = np.pad(speed, [(half, 0), *wide], mode="edge")
    after = np.pad(speed, [(0, half), *wide], mode="edge")
    return np.minimum(before, after)


def floor_height(height: Array, speed: Array, settings: ContactSettings) -> Array:
    """Return the height of each foot when it stands on the lowest ground of the clip, shape (foot,).

    The level at which a foot is slow most often near its lowest: a low quantile of the heights of its slow frames,
    so that one bad frame below the floor does not drag it down. A foot that is below that for long was slow in the
    air alone, where it turns back, as in a run on the spot: its floor is where it is lowest.
    """
    out = np.quantile(height, 0.02, axis=0)
    for foot in range(height.shape[1]):
        slow = speed[:, foot] < settings.start_speed
        found = float(np.quantile(height[slow, foot], 0.1)) if slow.any() else np.inf
        if np.mean(height[:, foot] < found - settings.height) < MOST_BELOW:
            out[foot] = found
    return out


def hysteresis(starts: Flags, holds: Flags) -> Flags:
    """Return the runs of ``holds`` that contain at least one start."""
    out = np.zeros_like(holds)
    for first, last in runs(holds):
        out[first : last + 1] = starts[first : last + 1].any()
    return out


def drop_short(standing: Flags, kind: bool, frames: float) -> None:
    """Turn over runs of one foot's flags that are shorter than ``frames``, in place.

    Args:
        standing: Shape (frame,).
        kind: True drops short plants, False closes short flights; not those at the ends.
        frames: The shortest that stays.
    """
    for first, last in runs(standing == kind):
        inner = kind or (first > 0 and last < len(standing) - 1)
        if last - first + 1 < frames and inner:
            standing[first : last + 1] = not kind


def plants(standing: Flags) -> list[Plant]:
    """Return the intervals of all feet, foot by foot, in order of time."""
    return [Plant(f, first, last) for f in range(standing.shape[1]) for first, last in runs(standing[:, f])]


def from_plants(intervals: list[Plant], frames: int, feet: int) -> Flags:
    """Return the flags of intervals, shape (frame, foot); the way back from `plants`."""
    out = np.zeros((frames, feet), dtype=bool)
    for plant in intervals:
        out[max(plant.start, 0) : plant.end + 1, plant.foot] = True
    return out
