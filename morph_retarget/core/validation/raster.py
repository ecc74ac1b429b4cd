"""Drawing lines into an image with soft edges."""

import numpy as np

from ..arrays import Array

Color = tuple[float, float, float]


def draw(image: Array, lines: Array, color: Color, width: float) -> None:
    """Draw lines into an image.

    Args:
        image: Red, green and blue from 0 to 1, the top row first, shape (row, column, 3); changed in place.
        lines: Ends as x to the right and y down [px], shape (line, 2, 2).
        color: Of the lines.
        width: Of the lines [px].
    """
    reach, (high, wide) = 0.5 * width + 1.0, image.shape[:2]
    low = np.maximum(np.floor(lines.min(axis=1) - reach), 0.0).astype(int)
    top = np.minimum(np.ceil(lines.max(axis=1) + reach), (wide, high)).astype(int)
    # Lines are short: looking at the pixels beside each is much less than looking at all pixels for all lines.
    for (start, end), (left, first), (right, last) in zip(lines, low.tolist(), top.tolist(), strict=True):
        x: Array = np.arange(left, right, dtype=np.float64) + 0.5 - start[0]
        y: Array = np.arange(first, last, dtype=np.float64)[:, None] + 0.5 - start[1]
        way = end - start
        along = np.clip((x * way[0] + y * way[1]) / max(float(way @ way), 1e-12), 0.0, 1.0)
        cover = np.clip(reach - 0.5 - np.hypot(x - along * way[0], y - along * way[1]), 0.0, 1.0)
        part = image[first:last, left:right]
        part += cover[..., None] * (np.array(color) - part)
