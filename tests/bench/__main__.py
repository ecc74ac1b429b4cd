"""``python -m tests.bench [NAME…] [--json FILE]``: measures accuracy and speed against goals.

A benchmark is a file with a function that prints its details and returns its figures; `BENCHMARKS` lists them all.
"""

import argparse
import json
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import bpy
import numpy as np

from . import (
    annotations,
    batch,
    clips,
    core,
    directing,
    fuzz,
    gait,
    ik,
    jiggle,
    length,
    live,
    mapping,
    mesh,
    perform,
    playback,
    retarget,
    transfer,
)
from .figures import Figure, table

BENCHMARKS: Mapping[str, Callable[[], list[Figure]]] = {
    "mapping": mapping.run,
    "transfer": transfer.run,
    "core": core.run,
    "clips": clips.run,
    "retarget": retarget.run,
    "mesh": mesh.run,
    "length": length.run,
    "live": live.run,
    "perform": perform.run,
    "playback": playback.run,
    "jiggle": jiggle.run,
    "ik": ik.run,
    "gait": gait.run,
    "annotations": annotations.run,
    "directing": directing.run,
    "batch": batch.run,
    "fuzz": fuzz.run,
}


def main(arguments: Sequence[str]) -> int:
    """Run the benchmarks that were asked for and return the exit status; goals that do not hold are no failure."""
    parser = argparse.ArgumentParser(prog="bench", description="Measure accuracy and speed against goals.")
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"all when none is named: {', '.join(BENCHMARKS)}")
    parser.add_argument("--json", metavar="FILE", type=Path, help="also write the figures to this file")
    asked = parser.parse_args(arguments)
    unknown = [name for name in asked.names if name not in BENCHMARKS]
    if unknown:
        print(f"no benchmark {unknown[0]!r}: choose from {', '.join(BENCHMARKS)}", file=sys.stderr)
        return 2
    if asked.json and not asked.json.absolute().parent.is_dir():
        print(f"{asked.json}: its folder does not exist: make it first", file=sys.stderr)
        return 2
    figures: list[Figure] = []
    for name in asked.names or BENCHMARKS:
        print(f"── {name}", flush=True)
        figures += BENCHMARKS[name]()
    print(f"── figures, Blender {bpy.app.version_string}, NumPy {np.__version__}\n{table(figures)}")
    if asked.json:
        asked.json.write_text(json.dumps([f.described() for f in figures], indent=1) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
