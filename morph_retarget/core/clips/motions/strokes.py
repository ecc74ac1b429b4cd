"""The times of a gesture, found from how its hands move.

A hand leaves where it rests, comes to where the gesture begins, does its stroke, and goes back to rest. It is slow
between these parts: preparation ends, and retraction begins, at a moment of least speed far from rest (the phases that
the Behavior Markup Language names).
"""

import numpy as np

from ... import quat
from ...arrays import Array, Flags
from ...smoothing import moving_average
from .annotations import Strokes

REST = 0.12
"""A hand rests while it is slower than this share of its greatest speed …"""
HOME = 0.15
"""… and nearer to where it began or ends than this share of the farthest."""
AWAY = 0.7
"""The stroke is done where hands are further than this share of the farthest."""
SLOWED = 0.3
"""A hand has come to where the stroke begins when it is slower than this share of how fast it came."""
LIVELY = 0.5
"""A stroke that gets no faster than this share of the speed at its ends is held."""
SMOOTH = 0.05
"""Speeds are taken over this time to either side [s]."""


def find(hands: Array, step: float) -> Strokes | None:
    """Return the times of a gesture in rows, None for hands that do not move.

    Args:
        hands: Places of the hands that make it beside the body, shape (frame, hand, 3).
        step: Time between two frames [s].
    """
    if len(hands) < 4:
        return None
    raw = quat.length(np.gradient(hands, step, axis=0)).max(axis=1)
    speed = moving_average(raw, max(round(SMOOTH / step), 1))
    away = np.minimum(_distance(hands, hands[0]), _distance(hands, hands[-1]))
    last, far = len(hands) - 1, float(away.max())
    if speed.max() < 1e-9 or far < 1e-9:
        return None
    peak = int(away.argmax())
    rests = (speed < REST * speed.max()) & (away < HOME * far)
    ready = _last(rests[: peak + 1], 0)
    relax = peak + _first(rests[peak:], last - peak)
    out = ready + np.flatnonzero(away[ready : relax + 1] > AWAY * far)
    start = _slowed(speed, ready, int(out[0]), peak)
    end = last - _slowed(speed[::-1], last - relax, last - int(out[-1]), last - peak)
    stroke = start + _peak(speed[start : end + 1])
    return Strokes(float(ready), float(start), float(stroke), float(end), float(relax))


def _slowed(speed: Array, since: int, out: int, until: int) -> int:
    """Return when a hand that moves since a row, and is out in another, has slowed down, at the latest ``until``."""
    fast = float(speed[since : out + 1].max())
    for row in range(out, until):
        if speed[row] < SLOWED * fast or speed[row + 1] > speed[row]:
            return row
    return max(until, out)


def _peak(speed: Array) -> int:
    """Return when a stroke is fastest, or for hands that hold still where they have come to, slowest."""
    inner = speed[1:-1]
    tops = 1 + np.flatnonzero((inner > speed[:-2]) & (inner >= speed[2:]))
    tops = tops[speed[tops] > max(speed[0], speed[-1], 1e-9) * LIVELY] if len(tops) else tops
    return int(tops[speed[tops].argmax()]) if len(tops) else int(speed.argmin())


def _distance(hands: Array, home: Array) -> Array:
    """Return how far the farthest hand is from home, shape (frame,)."""
    return quat.length(hands - home).max(axis=1)


def _last(flags: Flags, otherwise: int) -> int:
    found = np.flatnonzero(flags)
    return int(found[-1]) if len(found) else otherwise


def _first(flags: Flags, otherwise: int) -> int:
    found = np.flatnonzero(flags)
    return int(found[0]) if len(found) else otherwise
