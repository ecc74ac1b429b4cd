"""Soaks the extension and tells what was wrong; the exit status is 1 if anything was."""

import argparse
import sys
from pathlib import Path

import bpy
import numpy as np

from .running import Soak, run

MOST_GROWTH = 0.01
"""For a thousand operations, as a share of the memory."""


def main() -> int:
    """Run it."""
    parser = argparse.ArgumentParser(prog="python -m tools.soak", description=__doc__)
    parser.add_argument("--operations", type=int, default=10_000, metavar="N", help="how many (default: 10000)")
    parser.add_argument("--seed", type=int, default=1, metavar="S", help="of the random choices (default: 1)")
    parser.add_argument("--seconds", type=float, default=np.inf, metavar="S", help="end earlier, after so much time")
    parser.add_argument("--trail", type=Path, metavar="FILE", help="name each operation there, should Blender crash")
    asked = parser.parse_args()
    found = run(asked.operations, asked.seed, asked.seconds, _tell, asked.trail)
    for last, count in found.faults.most_common():
        print(f"── {count} ×: {last}\n{found.details[last]}")
    print(f"done:    {', '.join(f'{name} {count}' for name, count in found.done.most_common())}")
    print(f"refused: {', '.join(f'{name} {count}' for name, count in found.refused.most_common()) or 'none'}")
    slow = sorted(found.longest.items(), key=lambda pair: -pair[1])[:6]
    print(f"longest: {', '.join(f'{name} {seconds:.1f} s' for name, seconds in slow)}")
    growth = "unknown" if found.growth is None else f"{100.0 * found.growth:.2f} %"
    print(
        f"Blender {bpy.app.version_string}, seed {asked.seed}: {found.operations} operations in {found.seconds:.0f} s, "
        f"{sum(found.faults.values())} faults of {len(found.faults)} kinds, memory grows by {growth} per thousand"
    )
    return 1 if found.faults or (found.growth or 0.0) > MOST_GROWTH else 0


def _tell(found: Soak) -> None:
    count, weight = found.weights[-1]
    print(
        f"{count} operations, {found.seconds:.0f} s, {weight:.1f} MB, {sum(found.faults.values())} faults", flush=True
    )


if __name__ == "__main__":
    sys.exit(main())
