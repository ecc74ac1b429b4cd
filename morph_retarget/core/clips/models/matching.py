"""Matching: where in a cycle a body is as it is at the end of one clip, or at the beginning of another.

A start ends in some frame of the loop, and a stop begins in one (Grünvogel 2003 §5.5). Which one need not be annotated:
it is where the body is most alike.
"""

import numpy as np

from ...arrays import Array
from ..clip import Clip
from ..operators.likeness import unlikeness

BESIDE = 1.0
"""Frames from the end of a clip at which it is compared: how it moves shows only where it goes on to both sides."""
FINE = 2.0
"""Frames of a cycle are compared in so many steps each …"""
NARROWED, SAMPLES = 4, 9
"""… and then so many times those about the best, at so many frames."""


def phase_at(cycle: Clip, period: float, clip: Clip, frame: float) -> float:
    """Return at which of its frames, 0 … period, a cycle is most alike a clip at a frame.

    Args:
        cycle: Without end; its cycle begins where it starts.
        period: Of the cycle [frames].
        clip: The other clip.
        frame: Of the other clip.
    """
    inside = float(np.clip(frame, clip.start + BESIDE, max(clip.end - BESIDE, clip.start + BESIDE)))
    count = max(round(FINE * period), 4)
    near, best = np.arange(count) / count * period, 0.0
    width = period / count
    for _ in range(NARROWED + 1):
        best = float(near[_unlike(cycle, near + period, clip, inside).argmin()])
        near = best + width * np.linspace(-1.0, 1.0, SAMPLES)
        width *= 2.0 / (SAMPLES - 1)
    return (best + frame - inside) % period


def _unlike(cycle: Clip, times: Array, clip: Clip, frame: float) -> Array:
    return unlikeness(cycle, cycle.start + times, clip, np.array([frame]))[:, 0]
