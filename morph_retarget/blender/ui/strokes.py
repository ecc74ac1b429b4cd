"""Strokes: what the overlays draw into the viewport, as data that can be looked at without a window."""

# The stubs do not know arrays as buffers.
# pyright: reportArgumentType=false

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader

from ...core.arrays import Array

Color = tuple[float, float, float, float]

PATH: Color = (0.95, 0.16, 0.1, 0.9)
TARGET: Color = (0.2, 0.85, 0.3, 1.0)
MET: Color = (0.25, 0.9, 0.35, 1.0)
MISSED: Color = (1.0, 0.2, 0.15, 1.0)
BLENDED: Color = (1.0, 0.8, 0.2, 1.0)
FIXED: Color = (0.65, 0.65, 0.65, 1.0)
LIMB: Color = (0.45, 0.75, 1.0, 0.9)
SPINE: Color = (1.0, 0.5, 0.9, 0.9)
PULL: Color = (1.0, 0.5, 0.9, 0.45)
LOOSE: Color = (0.95, 0.95, 0.75, 0.9)

THIN, THICK = 1.0, 2.0
"""Widths of lines [px]."""
SMALL, LARGE = 5.0, 8.0
"""Sizes of points [px]."""


@dataclass(frozen=True, eq=False)
class Stroke:
    """Points or lines of one kind and colour."""

    kind: Literal["POINTS", "LINES", "LINE_STRIP"]
    places: Array
    """World space, shape (n, 3); of `LINES` the two ends of each."""
    color: Color
    size: float
    """Width of lines, or size of points [px]."""


def draw(strokes: Iterable[Stroke]) -> None:
    """Draw strokes into the viewport that Blender draws just now."""
    gpu.state.blend_set("ALPHA")
    for stroke in strokes:
        if stroke.kind == "POINTS":
            gpu.state.point_size_set(stroke.size)
            shader = gpu.shader.from_builtin("POINT_UNIFORM_COLOR")
        else:
            shader = gpu.shader.from_builtin("POLYLINE_UNIFORM_COLOR")
            shader.uniform_float("viewportSize", gpu.state.viewport_get()[2:])
            shader.uniform_float("lineWidth", stroke.size)
        shader.uniform_float("color", stroke.color)
        batch_for_shader(shader, stroke.kind, {"pos": stroke.places.astype(np.float32)}).draw(shader)
    gpu.state.point_size_set(1.0)
    gpu.state.blend_set("NONE")
