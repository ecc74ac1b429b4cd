"""Runs a soak and tells what was wrong: errors, bystanders that have changed, memory that grows."""

import contextlib
import ctypes
import gc
import io
import sys
import time
import traceback
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import bpy
import numpy as np

from morph_retarget.blender import registration
from morph_retarget.blender.io.quiet import quiet
from morph_retarget.core.errors import MorphError

from . import bystander
from .operations import OPERATIONS, World, new

WEIGHED_EVERY = 250
"""Operations between looks at the memory; then nothing is open."""
WARM = 1000
"""Operations before the first look that counts: until then, caches fill, such as that of libraries of 16 characters."""
_MB = 1024.0


@dataclass
class Soak:
    """What came of a soak."""

    operations: int = 0
    seconds: float = 0.0
    faults: Counter[str] = field(default_factory=Counter)
    """How often what went wrong, by its last line."""
    details: dict[str, str] = field(default_factory=dict)
    """The first of each, with what had been done before it."""
    done: Counter[str] = field(default_factory=Counter)
    refused: Counter[str] = field(default_factory=Counter)
    longest: dict[str, float] = field(default_factory=dict)
    """Most time that each operation has taken [s]."""
    weights: list[tuple[int, float]] = field(default_factory=list)
    """Memory [MB] after so many operations."""

    @property
    def growth(self) -> float | None:
        """Growth of the memory for a thousand operations, as a share of it; None while nobody can tell."""
        counted = np.array([pair for pair in self.weights if pair[0] >= WARM])
        if len(counted) < 3:
            return None
        slope, _ = np.polyfit(counted[:, 0], counted[:, 1], 1)
        return float(1000.0 * slope / counted[0, 1])


def run(
    operations: int,
    seed: int,
    seconds: float = np.inf,
    tell: Callable[[Soak], None] | None = None,
    trail: Path | None = None,
) -> Soak:
    """Do random operations, and return what came of them.

    Args:
        operations: How many.
        seed: Of the random choices.
        seconds: Time after which it ends earlier [s].
        tell: Told now and then how far it is.
        trail: File in which each operation is named before it is done: what a crash has been led to by.
    """
    out, start = Soak(), time.monotonic()
    registration.register("morph_retarget")
    try:
        with quiet():
            bpy.ops.wm.read_homefile(use_empty=True)
        world = World(seed)
        recent: list[str] = []
        while out.operations < operations and time.monotonic() - start < seconds:
            operation = world.rng.choices([*OPERATIONS], [*OPERATIONS.values()])[0]
            recent = [*recent[-19:], operation.__name__]
            if trail is not None:
                with trail.open("a", encoding="utf-8") as stream:
                    stream.write(f"{out.operations + 1} {operation.__name__}\n")
            wrong = _done(operation, world, out)
            out.operations += 1
            out.seconds = time.monotonic() - start
            if wrong:
                last = wrong.strip().splitlines()[-1]
                out.faults[last] += 1
                out.details.setdefault(last, f"operation {out.operations}, after {' '.join(recent)}\n{wrong}")
                _done(new, world, Soak())
            if out.operations % WEIGHED_EVERY == 0:
                out.weights.append((out.operations, _weigh()))
                world.began()
                if tell is not None:
                    tell(out)
    finally:
        registration.unregister()
    return out


def _done(operation: Callable[[World], None], world: World, out: Soak) -> str:
    """Do an operation, and return what was wrong about it."""
    name, start = operation.__name__, time.perf_counter()
    out.done[name] += 1
    with _heard() as said:
        try:
            operation(world)
            out.longest[name] = max(out.longest.get(name, 0.0), time.perf_counter() - start)
            if name not in {"undo", "redo"}:
                bpy.ops.ed.undo_push(message=name)
        except (MorphError, RuntimeError) as error:
            if "Traceback" in str(error) or isinstance(error, RecursionError | NotImplementedError):
                return str(error)
            out.refused[name] += 1
        except Exception:  # noqa: BLE001 - whatever it is, it is what is looked for
            return traceback.format_exc()
    if "Traceback" in said.getvalue():
        return said.getvalue()
    try:
        return "" if bystander.fingerprint() == world.before else f"{name} changed a bystander"
    except LookupError as error:
        return f"{name}: {error}"


@contextlib.contextmanager
def _heard() -> Iterator[io.StringIO]:
    """Catch what handlers and callbacks print of their errors, and keep the rest to itself."""
    said = io.StringIO()
    with quiet(), contextlib.redirect_stderr(said):
        yield said


def _weigh() -> float:
    """Return the memory that the process takes with nothing open [MB]."""
    with quiet():
        bpy.ops.wm.read_homefile(use_empty=True)
    gc.collect()
    if sys.platform == "linux":
        with contextlib.suppress(OSError, AttributeError):  # of another C library than GNU's
            ctypes.CDLL(None).malloc_trim(0)
        pages = int(Path("/proc/self/statm").read_text().split()[1])
        return pages * 4096 / _MB / _MB
    return 0.0
