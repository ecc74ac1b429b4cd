"""Whether a long clip costs more a frame than a short one."""

from functools import partial

import bpy

from . import walkers
from .figures import Figure, medians, short

SHORT, LONG = 240, 2400
BONES = 52
REPETITIONS = 9


def run() -> list[Figure]:
    """Return the time a frame of a long clip over that of a short one."""
    bpy.ops.wm.read_homefile(use_empty=True)
    pairs = [walkers.add_pair(BONES, frames) for frames in (SHORT, LONG)]
    times = medians([partial(walkers.timed, pair, plant_feet=True) for pair in pairs], REPETITIONS)
    brief, long = (1000.0 * taken / frames for taken, frames in zip(times, (SHORT, LONG), strict=True))
    print(f"{LONG} frames: {short(long)} ms a frame, {SHORT} frames: {short(brief)} ms a frame")
    return [Figure("length: time a frame of 2,400 frames over 240", long / brief, "", 1.1)]
