"""A validation grid as one picture: actions below each other, characters side by side, each cell over time."""

import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import blf
import bpy
import imbuf
import numpy as np

from ...core.arrays import Array
from ...core.validation import raster
from ...core.validation.cell import Cell, Status
from ...core.validation.drawing import Strip
from ...core.validation.grid import Grid
from ...core.validation.raster import Color

TILE, GAP = 46, 4
"""Side of a picture and what is between cells [px]."""
SHOWN = 3
"""Pictures of each cell."""
LABELS, HEAD = 150, 22
"""Room for the names of actions and of characters [px]."""
TEXT = 12
PAPER: Color = (0.955, 0.955, 0.945)
GROUND: Color = (0.73, 0.73, 0.73)
BACKGROUND = {Status.PASSED: (0.90, 0.955, 0.915), Status.FAILED: (0.985, 0.87, 0.845), Status.NOT_FOR_IT: PAPER}
EDGE = {Status.PASSED: (0.24, 0.55, 0.35), Status.FAILED: (0.78, 0.26, 0.18), Status.NOT_FOR_IT: PAPER}
SIDES: dict[int, Color] = {-1: (0.85, 0.51, 0.17), 0: (0.2, 0.2, 0.2), 1: (0.18, 0.5, 0.76)}


@dataclass(frozen=True)
class _Label:
    text: str
    x: int
    """[px] from the left."""
    y: int
    """Of the line that the letters stand on [px], from the top."""


def write(path: Path, grid: Grid) -> None:
    """Write a grid as a PNG."""
    image = drawn(grid)
    labels = list(_labels(grid))
    cover = _lettered(image.shape[1], image.shape[0], labels)[..., None]
    image += cover * (np.array((0.1, 0.1, 0.1)) - image)
    _save(path, image)


def drawn(grid: Grid) -> Array:
    """Return the picture without its labels: red, green and blue from 0 to 1, shape (row, column, 3)."""
    wide, high = _corner(len(grid.actions), len(grid.characters))
    image: Array = np.tile(np.array(PAPER), (high, wide, 1))
    rows = {name: i for i, name in enumerate(grid.actions)}
    columns = {name: i for i, name in enumerate(grid.characters)}
    for cell in grid.cells:
        left, top = _corner(rows[cell.action], columns[cell.character])
        _draw(image[top : top + TILE, left : left + SHOWN * TILE], cell)
    return image


def _corner(row: int, column: int) -> tuple[int, int]:
    """Return the left and upper edge of a cell [px]."""
    return LABELS + column * (SHOWN * TILE + GAP), HEAD + row * (TILE + GAP)


def _draw(image: Array, cell: Cell) -> None:
    image[:] = BACKGROUND[cell.status]
    image[:, :2] = EDGE[cell.status]
    if cell.strip is None:
        return
    for place, i in enumerate(_chosen(cell.strip)):
        tile = image[:, place * TILE : (place + 1) * TILE]
        floor = TILE * float(cell.strip.floors[i])
        raster.draw(tile, np.array([[[4.0, floor], [TILE - 4.0, floor]]]), GROUND, 1.0)
        for side, color in SIDES.items():
            raster.draw(tile, TILE * cell.strip.lines[i][cell.strip.sides == side], color, 1.1)


def _chosen(strip: Strip) -> list[int]:
    """Return which pictures of a cell are shown: those in which something is wrong, and some from its middle."""
    count = len(strip.lines)
    spread = np.linspace(0, count - 1, SHOWN + 2).round().astype(int).tolist()[1:-1]
    wanted = [*np.flatnonzero(strip.marked).tolist(), *spread, *range(count)]
    return sorted(list(dict.fromkeys(wanted))[:SHOWN])


# --- letters ---


def _labels(grid: Grid) -> Iterator[_Label]:
    for i, name in enumerate(grid.actions):
        _, top = _corner(i, 0)
        yield _Label(_cut(name, LABELS - 10), 6, top + TILE // 2 + 4)
    for i, name in enumerate(grid.characters):
        left, _ = _corner(0, i)
        yield _Label(_cut(name, SHOWN * TILE), left, HEAD - 7)


def _cut(text: str, width: int) -> str:
    """Return as much of a text as there is room for [px]."""
    blf.size(0, TEXT)
    if blf.dimensions(0, text)[0] <= width:
        return text
    while text and blf.dimensions(0, f"{text}…")[0] > width:
        text = text[:-1]
    return f"{text}…"


def _lettered(wide: int, high: int, labels: list[_Label]) -> Array:
    """Return how much letters cover each pixel, from 0 to 1, the top row first, shape (row, column)."""
    paper = imbuf.new((wide, high))
    with tempfile.TemporaryDirectory() as folder:
        with blf.bind_imbuf(0, paper):  # pyright: ignore[reportGeneralTypeIssues]
            blf.size(0, TEXT)
            blf.color(0, 1.0, 1.0, 1.0, 1.0)
            for label in labels:
                blf.position(0, label.x, high - label.y, 0)
                blf.draw_buffer(0, label.text)
        file = Path(folder, "letters.png")
        imbuf.write(paper, filepath=str(file))
        read = bpy.data.images.load(str(file))
        try:
            pixels = np.empty(wide * high * 4, dtype=np.float32)
            read.pixels.foreach_get(pixels)
        finally:
            bpy.data.images.remove(read)
    return pixels.reshape(high, wide, 4)[::-1, :, 3].astype(np.float64)


def _save(path: Path, image: Array) -> None:
    high, wide, _ = image.shape
    made = bpy.data.images.new(path.stem, wide, high)
    try:
        pixels = np.ones((high, wide, 4), dtype=np.float32)
        pixels[..., :3] = image[::-1]
        made.pixels.foreach_set(pixels.ravel())  # pyright: ignore[reportArgumentType]
        made.file_format = "PNG"
        made.save(filepath=str(path))
    finally:
        bpy.data.images.remove(made)
