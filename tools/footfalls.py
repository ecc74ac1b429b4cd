"""Gait diagrams: which feet are on the ground over time, a row for each foot, below the speed of the body."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np
from PIL import Image, ImageDraw

from morph_retarget.blender import rig
from morph_retarget.blender.locomotion import walks
from morph_retarget.core.arrays import Array
from morph_retarget.core.locomotion.stepping.gait import Gait

from .sheet import BACKGROUND

NAMES, ROW, BAR, CURVE, FOOT = 92, 15, 10, 64, 20
"""Width of the names, height of a row, of a bar in it, of the curve of the speed and of the line of seconds [px]."""
STEP = 0.1
"""From one moment that is looked at to the next [frames]."""
LINE, TEXT, STANDS, SPEED = (70, 74, 80), (220, 220, 220), (226, 160, 64), (120, 180, 230)


@dataclass(frozen=True, eq=False)
class Footfalls:
    """When the feet of a character stand."""

    frames: Array
    """Of the scene, shape (frame,)."""
    second: float
    """Frames in a second."""
    speed: Array
    """Of its body over the ground [m/s], shape (frame,)."""
    feet: Sequence[str]
    """Names from the front to the rear, left before right."""
    stands: np.ndarray
    """Shape (frame, foot)."""


def of(ob: bpy.types.Object) -> Footfalls:
    """Return when the feet of a character stand over the frames of the open scene."""
    scene = rig.scene_of()
    frames = np.arange(float(scene.frame_start), scene.frame_end + STEP, STEP)
    scene.frame_set(scene.frame_current)
    walk = walks.known(ob, scene)
    assert walk is not None and isinstance(walk.gait, Gait), "only those that go on feet have footfalls"  # noqa: PT018
    times, legs = walk.clock.times(frames), walk.gait.legs.legs
    order = sorted(range(len(legs)), key=lambda leg: (legs[leg].row, -legs[leg].side))
    names = [walk.gait.character.skeleton.names[legs[leg].foot] for leg in order]
    velocity = walk.course.velocity(times)[0]
    return Footfalls(
        frames, walk.clock.second, np.linalg.norm(velocity, axis=-1), names, walk.gait.contacts(times)[:, order]
    )


def draw(path: Path, found: Footfalls, width: int = 900) -> None:
    """Draw footfalls and write one picture.

    Args:
        path: PNG to write.
        found: What to draw; markers of the open scene are written above it.
        width: Of the picture [px].
    """
    top = CURVE + 2 * FOOT
    image = Image.new("RGB", (width, top + ROW * len(found.feet) + FOOT), BACKGROUND)
    pen = ImageDraw.Draw(image)
    first, last = float(found.frames[0]), float(found.frames[-1])

    def across(frame: float) -> float:
        return NAMES + (frame - first) / (last - first) * (width - NAMES - 8)

    for second in range(int((last - first) / found.second) + 1):
        x = across(first + second * found.second)
        pen.line([(x, FOOT), (x, image.height - FOOT)], LINE)
        pen.text((x - 3, image.height - FOOT + 4), f"{second} s" if second else "0", TEXT)
    for marker in rig.scene_of().timeline_markers:
        pen.text((across(marker.frame) + 3, 5), marker.name, TEXT)
    highest = max(float(found.speed.max()), 1e-3)
    heights = FOOT + CURVE * (1.0 - found.speed / highest)
    pen.line(list(zip(map(across, found.frames.tolist()), heights.tolist(), strict=True)), SPEED, 2)
    pen.text((6, FOOT), f"{highest:.1f} m/s", SPEED)
    for row, name in enumerate(found.feet):
        y = top + row * ROW
        pen.text((6, y - 1), name, TEXT)
        for start, end in _spans(found.stands[:, row]):
            pen.rectangle(
                [across(float(found.frames[start])), y, across(float(found.frames[end])), y + BAR - 1], STANDS
            )
    image.quantize(32).save(path, optimize=True)


def _spans(flags: np.ndarray) -> list[tuple[int, int]]:
    """Return the first and last places of the runs of true flags, shape (n,)."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], flags.astype(np.int8), [0]])))
    return [(int(a), int(b) - 1) for a, b in edges.reshape(-1, 2)]
