"""Drawing a performance: its bones as lines, at some of its frames side by side."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from .. import quat
from ..arrays import Array, Flags, Indices
from ..ground import heights_on
from ..verdicts.performance import Performance

TURN, RISE = np.radians(-40.0), np.radians(12.0)
"""From where it is seen: before it, from its left, and a little from above."""
THUMBNAILS = 6
MARGIN = 0.06
"""Of a picture on all sides, as a share of it."""
LONGEST_TIP = 0.12
"""Longest bone that is drawn where nothing says where it ends but its tail, as a share of the size: importers guess."""


@dataclass(frozen=True, eq=False)
class Strip:
    """Pictures of unit size, side by side: x to the right and y down, both from 0 to 1."""

    lines: Array
    """Ends of the bones, shape (picture, bone, 2, 2)."""
    sides: Indices
    """Of each bone: +1 left, -1 right, 0 in the middle, shape (bone,)."""
    floors: Array
    """Height of the ground beneath, shape (picture,)."""
    rows: Indices
    """Which frames they are, as rows of the batch, shape (picture,)."""
    marked: Flags
    """Whether something is wrong in them, shape (picture,)."""


def strip_of(performance: Performance, wrong: Collection[int] = ()) -> Strip:
    """Return pictures from the first frame to the last, and of frames in which something is wrong.

    Args:
        performance: What is drawn.
        wrong: Rows of those frames; nearby ones of the others give way to them.
    """
    rows = chosen(len(performance), wrong)
    heads, tails, bones = _bones(performance)
    now, turns = performance.places[rows], performance.turns[rows]
    ends = [now[:, bones] + quat.rotate(turns[:, bones], away) for away in (heads, tails)]
    lines = np.stack(ends, axis=2)
    below = now[:, performance.root].copy()
    below[:, 2] = 0.0
    if performance.ground is not None:
        below[:, 2] = heights_on(performance.ground, now[:, performance.root], 0.0)
    flat = _projected(lines - below[:, None, None])
    low, high = flat.min(axis=(0, 1, 2)), flat.max(axis=(0, 1, 2))
    low[1] = min(low[1], 0.0)
    scale = (1.0 - 2.0 * MARGIN) / max(float((high - low).max()), 1e-9)
    middle = 0.5 * (low + high)
    flat = (flat - middle) * scale
    flat[..., 1] *= -1.0
    floor = float(0.5 + middle[1] * scale)
    side = performance.rest[bones, 0]
    near = 0.02 * performance.size
    sides: Indices = np.where(np.abs(side) < near, 0, np.sign(side)).astype(np.intp)
    marked: Flags = np.isin(rows, list(wrong))
    return Strip(flat + 0.5, sides, np.full(len(rows), floor), rows, marked)


def chosen(count: int, wrong: Collection[int] = ()) -> Indices:
    """Return which of some frames are drawn, in order, shape (picture,)."""
    out = sorted(dict.fromkeys(np.linspace(0, count - 1, min(THUMBNAILS, count)).round().astype(int).tolist()))
    for row in sorted(set(wrong)):
        free = [i for i in range(len(out)) if out[i] not in wrong]
        if free and row not in out:
            out[min(free, key=lambda i: abs(out[i] - row))] = row
    return np.array(sorted(out), dtype=np.intp)


def _bones(performance: Performance) -> tuple[Array, Array, Indices]:
    """Return where bones start and end from the joints that turn them, at rest [m], and these joints."""
    rest, tree = performance.rest, performance.hierarchy.tree
    tips = performance.character.local_to_character.points(performance.character.skeleton.rest_tails)
    body: Sequence[int] = performance.body.tolist()
    pairs: list[tuple[int, Array]] = []
    for bone in body:
        ends = [rest[child] for child in tree.children[bone]]
        if not ends:
            way = tips[bone] - rest[bone]
            length = float(quat.length(way))
            ends = [rest[bone] + way * min(LONGEST_TIP * performance.size / max(length, 1e-12), 1.0)]
        pairs += [(bone, end - rest[bone]) for end in ends]
    tails = np.array([away for _, away in pairs]).reshape(-1, 3)
    return np.zeros_like(tails), tails, np.array([bone for bone, _ in pairs], dtype=np.intp)


def _projected(points: Array) -> Array:
    """Return points as they are seen, x to the right and y up, shape (..., 3) to (..., 2)."""
    right = np.array([np.cos(TURN), np.sin(TURN), 0.0])
    up = np.array([np.sin(TURN) * np.sin(RISE), -np.cos(TURN) * np.sin(RISE), 0.0]) * -1.0
    up[2] = np.cos(RISE)
    return np.stack([points @ right, points @ up], axis=-1)
