"""The time of a whole retarget in Blender: sampling, analysis, transfer and keys."""

from functools import partial

import bpy
import numpy as np

from morph_retarget.blender.actions import Writer

from . import walkers
from .figures import Figure, medians, seconds
from .walkers import Pair

FRAMES = 240
REPETITIONS = 15
GOALS = {22: (0.12, 0.20), 52: (0.25, 0.35)}
"""Number of bones to the goals with free and with planted feet [ms a frame]."""


def run() -> list[Figure]:
    """Return the time a frame for each number of bones; writing as many keys and nothing else is the floor."""
    figures: list[Figure] = []
    for bones, goals in GOALS.items():
        pair = walkers.open_pair(bones, FRAMES)
        sides = [partial(_write_alone, pair), *(partial(walkers.timed, pair, plants) for plants in (False, True))]
        floor, *times = (1000.0 * t / FRAMES for t in medians(sides, REPETITIONS))
        for feet, goal, time in zip(("free", "planted"), goals, times, strict=True):
            figures.append(Figure(f"retarget: {bones} bones, feet {feet}", time, "ms a frame", goal, floor))
        _print_stages(pair, bones)
    return figures


def _write_alone(pair: Pair) -> float:
    """Return the time to key a rotation for every bone and one location, with values at hand [s]."""
    rng = np.random.default_rng(0)
    frames = np.arange(1.0, FRAMES + 1.0)
    turns, place = rng.normal(size=(FRAMES, 4)), rng.normal(size=(FRAMES, 3))
    paths = {bone.name: bone.path_from_id("rotation_quaternion") for bone in pair.sprout.pose.bones}
    root = pair.sprout.pose.bones[0]
    writer: list[Writer] = []

    def write() -> None:
        writer.append(Writer("Alone", pair.sprout))
        for bone, path in paths.items():
            writer[0].write(path, turns, frames, bone)
        writer[0].write(root.path_from_id("location"), place, frames, root.name)

    taken = seconds(write)
    bpy.data.actions.remove(writer[0].action)
    return taken


def _print_stages(pair: Pair, bones: int) -> None:
    for plants in (False, True):
        outcome = walkers.transfer(pair, plants)
        stages = outcome.report["seconds_per_stage"]
        parts = ", ".join(f"{stage} {1000.0 * taken:.2f}" for stage, taken in stages.items())
        print(f"{bones} bones, feet {'planted' if plants else 'free'}, once, ms: {parts}")
        walkers.forget(pair)
