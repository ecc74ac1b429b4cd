"""Looking into a motion tree: which of its branches are asked at a frame, and at which frames of their own.

Operators ask their parts only for what they need, so the tree itself tells by being evaluated, while all its clips take
notes of the frames that they are asked for.
"""

import contextlib
from collections.abc import Callable, Generator
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from .clip import Clip
from .frames import Frames

_FRAME = "frame"


@dataclass(frozen=True, eq=False)
class Branch:
    """A clip in a motion tree, as it is at a frame of the tree."""

    clip: Clip
    depth: int
    """0 for the whole tree, 1 for what that is made from, …"""
    frame: float | None
    """The clip's own frame that it shows; None where it is not asked."""

    @property
    def is_active(self) -> bool:
        """Whether it takes part in what is shown."""
        return self.frame is not None


def trace(tree: Clip, frame: float) -> tuple[Branch, ...]:
    """Return the branches of a motion tree at a frame, each before what it is made from.

    Branches below one that is not asked are left out.
    """
    with _noting(tree) as asked:
        tree.frame(np.array([frame], dtype=np.float64))
    out: list[Branch] = []

    def walk(clip: Clip, depth: int) -> None:
        notes = asked[id(clip)]
        out.append(Branch(clip, depth, notes[0] if notes else None))
        for part in clip.parts if notes else ():
            walk(part, depth + 1)

    walk(tree, 0)
    return tuple(out)


@contextlib.contextmanager
def _noting(tree: Clip) -> Generator[dict[int, list[float]]]:
    """Let the clips of a tree note the frames that they are asked for, by the numbers of these objects, for a while."""
    clips = {id(clip): clip for clip in _all(tree)}
    notes: dict[int, list[float]] = {number: [] for number in clips}
    try:
        for number, clip in clips.items():
            # Clips are frozen; this stands before the method of their class, and is gone before anybody else looks.
            object.__setattr__(clip, _FRAME, _noted(clip.frame, notes[number]))
        yield notes
    finally:
        for clip in clips.values():
            vars(clip).pop(_FRAME, None)


def _noted(frame: Callable[[Array], Frames], notes: list[float]) -> Callable[[Array], Frames]:
    def asked(times: Array) -> Frames:
        notes.extend(times.tolist())
        return frame(times)

    return asked


def _all(tree: Clip) -> list[Clip]:
    """Return all clips of a tree; one that is in it twice comes once."""
    found: dict[int, Clip] = {}
    waiting = [tree]
    while waiting:
        clip = waiting.pop()
        if id(clip) not in found:
            found[id(clip)] = clip
            waiting += clip.parts
    return list(found.values())
