"""Pictures of walks: a clip and ours, when each foot stands and how high it flies over one cycle."""

from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

from .gait_clips import PHASES, Pair, Walk

WIDTH, ROW, TOP, LEFT, CURVE = 420, 22, 46, 130, 120
"""Of a diagram, its bars, its heading, the names before it, and its curves [px]."""
PAPER, INK, FAINT = (250, 250, 248), (40, 40, 44), (205, 205, 200)
COLORS = ((214, 69, 65), (52, 101, 196), (224, 150, 40), (46, 139, 87))
"""Of the feet, by their place."""


def draw(path: Path, pair: Pair) -> None:
    """Write a picture of a clip beside our walk."""
    count = len(pair.names)
    high = TOP + ROW * count + CURVE + 30
    image = Image.new("RGB", (2 * (LEFT + WIDTH) + 30, high), PAPER)
    pen = ImageDraw.Draw(image)
    shift = _shift(pair)
    for column, (title, walk, turn) in enumerate((("clip", pair.clip, 0), ("ours", pair.ours, shift))):
        x = LEFT + column * (LEFT + WIDTH)
        own = f"stride {walk.stride:.2f}, cycle {walk.cycle:.2f}, duty {walk.duty.mean():.2f}"
        pen.text((x, 6), f"{title}: {own}", INK)
        _bars(pen, x, pair.names, np.roll(walk.contacts, turn, axis=0))
        _curves(pen, x, TOP + ROW * count + 10, np.roll(walk.heights, turn, axis=0), _highest(pair))
    pen.text((LEFT, 24), f"{pair.example.title}, u = {pair.clip.speed:.2f}", INK)
    image.save(path)


def _shift(pair: Pair) -> int:
    """Return by how many samples our cycle is turned to fit the clip's contacts best."""
    fits = [(np.roll(pair.ours.contacts, k, axis=0) == pair.clip.contacts).sum() for k in range(PHASES)]
    return int(np.argmax(fits))


def _highest(pair: Pair) -> float:
    walks: tuple[Walk, Walk] = (pair.clip, pair.ours)
    return max(float(walk.heights.max()) for walk in walks)


def _bars(pen: ImageDraw.ImageDraw, x: int, names: tuple[str, ...], contacts: np.ndarray) -> None:
    for row, name in enumerate(names):
        y = TOP + ROW * row
        pen.text((x - LEFT + 6, y + 3), name[:18], INK)
        pen.rectangle((x, y + 4, x + WIDTH, y + ROW - 4), outline=FAINT)
        for i in np.flatnonzero(contacts[:, row]).tolist():
            pen.rectangle(
                (x + i * WIDTH // PHASES, y + 4, x + (i + 1) * WIDTH // PHASES, y + ROW - 4),
                fill=COLORS[row % len(COLORS)],
            )


def _curves(pen: ImageDraw.ImageDraw, x: int, y: int, heights: np.ndarray, highest: float) -> None:
    pen.text((x - LEFT + 6, y), f"height (to {highest:.2f} h)", INK)
    pen.line((x, y + CURVE, x + WIDTH, y + CURVE), fill=FAINT)
    for row in range(heights.shape[1]):
        own = heights[:, row] / max(highest, 1e-9)
        points = [(x + i * WIDTH / PHASES, y + CURVE * (1.0 - value)) for i, value in enumerate(own)]
        pen.line(points, fill=COLORS[row % len(COLORS)], width=2)
