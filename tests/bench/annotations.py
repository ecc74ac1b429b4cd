"""How well annotations are found in real clips, against strikes that were read by eye (`tests/strikes.py`)."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import bpy
import numpy as np

from morph_retarget.blender import retarget, rig
from morph_retarget.blender.io.load import Request, load
from morph_retarget.blender.retarget import Source
from morph_retarget.blender.rig import armature_of
from morph_retarget.core.clips.character_model import RATE
from morph_retarget.core.clips.motions import finding
from morph_retarget.core.clips.motions.finding import Found
from tests.conftest import DATA
from tests.strikes import READ, Read

from .figures import Figure, seconds

NEAR = 2.0
"""Strikes found within this many frames are right."""


@dataclass(frozen=True, eq=False)
class Judgement:
    """What was found in a clip, beside what was read."""

    read: Read
    found: Found

    @cached_property
    def misses(self) -> tuple[float, ...]:
        """For each strike that was read how far the nearest one found is [frames], infinite where there is none."""
        period = (
            self.found.cycle.length * self.found.seen.step * RATE if self.found.is_loop and self.found.cycle else 0.0
        )
        left = list(self.found.annotations.strikes)
        out: list[float] = []
        for foot, frame in self.read.strikes:
            away = [_apart(own.frame - frame, period) if own.foot == foot else np.inf for own in left]
            best = int(np.argmin(away)) if away else 0
            out.append(away[best] if away else np.inf)
            if out[-1] <= NEAR:
                del left[best]
        return tuple(out)

    @property
    def right(self) -> int:
        """Strikes found where they were read."""
        return sum(miss <= NEAR for miss in self.misses)

    @property
    def extra(self) -> int:
        """Strikes found where none was read."""
        return len(self.found.annotations.strikes) - self.right

    @property
    def line(self) -> str:
        """All of it for people."""
        own = self.found.annotations
        kind = own.kind if own.kind == self.read.kind else f"{own.kind} (read: {self.read.kind})"
        near = [miss for miss in self.misses if miss <= NEAR]
        return (
            f"{Path(self.read.path).stem[:26]:26} {self.read.action[:26]:26} {kind:20} "
            f"strikes {self.right}/{len(self.read.strikes)}, {self.extra} extra, off by {np.mean(near or [0.0]):.2f}"
        )


def _apart(frames: float, period: float) -> float:
    return abs((frames + 0.5 * period) % period - 0.5 * period) if period else abs(frames)


def opened(path: Path) -> list[bpy.types.Object]:
    """Replace the open file with what a file holds and return its armatures."""
    return load(Request(path))


def judged(data: Path, opening: Callable[[Path], list[bpy.types.Object]] = opened) -> Iterator[Judgement]:
    """Yield what is found in all clips that were read, of files that are opened by ``opening``."""
    for path in dict.fromkeys(read.path for read in READ):
        own = [read for read in READ if read.path == path]
        for read, source in zip(own, _sources(opening(data / path), [read.action for read in own]), strict=True):
            clip = source.clip
            yield Judgement(read, finding.find(source.character, clip.pose, clip.seconds_per_frame))


def _sources(armatures: list[bpy.types.Object], endings: list[str]) -> list[Source]:
    """Return motions of the open file by how the names of their actions end; the shortest name that fits counts."""
    armature = max(armatures, key=lambda ob: len(armature_of(ob).bones))
    out: list[Source] = []
    for ending in endings:
        action = min((a for a in bpy.data.actions if a.name.endswith(ending)), key=lambda a: len(a.name))
        out.append(retarget.run(retarget.read_source(rig.read(armature), action, action.slots[0], bpy.context.scene)))
    return out


def figures_of(found: list[Judgement]) -> Mapping[str, float]:
    """Return the shares of strikes that are right and that are not there [%], and of kinds that are right [%]."""
    strikes = sum(len(own.read.strikes) for own in found)
    return {
        "strikes right": 100.0 * sum(own.right for own in found) / strikes,
        "strikes too many": 100.0 * sum(own.extra for own in found) / strikes,
        "kinds right": 100.0 * sum(own.found.kind == own.read.kind for own in found) / len(found),
    }


def run() -> list[Figure]:
    """Return how many strikes and kinds are right, and how long it takes to find them."""
    if not DATA.is_dir():
        print(f"no real clips at {DATA}: nothing to compare with (set MORPH_RETARGET_DATA to their folder)")
        return []
    found = list(judged(DATA))
    for own in found:
        print(own.line)
    figures = figures_of(found)
    near = [miss for own in found for miss in own.misses if miss <= NEAR]
    walk = found[0].found.seen
    taken = seconds(lambda: finding.annotate(walk.character, walk.pose, walk.step))
    return [
        Figure("annotations: strikes within 2 frames", figures["strikes right"], "%", 95.0, at_least=True),
        Figure("annotations: strikes too many", figures["strikes too many"], "%", 6.0),
        Figure("annotations: off by, mean of those", float(np.mean(near)), "frames"),
        Figure("annotations: kinds right", figures["kinds right"], "%", 95.0, at_least=True),
        Figure("annotations: time a frame", 1e6 * taken / len(walk), "µs"),
    ]
