"""What batches do: jobs in a second with one worker and with two, and the memory of a worker over many jobs.

On the real clips and rigs where they are there, else on our own.
"""

import json
import queue
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from itertools import cycle, islice
from pathlib import Path

import numpy as np

from morph_retarget.blender.batch import worker
from morph_retarget.blender.batch.process import Process
from morph_retarget.blender.cli.batching import WORKER
from tests.blender.files import Files
from tests.conftest import DATA, ROOT

from .figures import Figure

RIGS = ("kaykit_knight.glb", "cesium_man.glb", "quaternius_modular_man.glb", "rigify_def_ymca.glb")
LARGEST = 450_000
"""Clips of more bytes are left out: exporting a few of them would be most of the time."""
CLIPS = 12
"""Each is taken as often as it needs for that."""
LOOKS = 10
"""At the memory."""
JOBS = 500
"""Of one worker, which a batch would renew before; short ones."""


def run() -> list[Figure]:
    """Return throughput and growth of memory."""
    with tempfile.TemporaryDirectory(prefix="batch_") as name:
        folder = Path(name)
        clips, rigs = _inputs(folder)
        done, one = _throughput(folder, clips, rigs, 1)
        _, two = _throughput(folder, clips, rigs, 2)
        print(f"{done} jobs: {one:.2f} a second with one worker, {two:.2f} with two")
        out = [Figure("batch: two workers over one", two / one, "×", 1.7, at_least=True)]
        return [*out, Figure("batch: one worker", one, "jobs/s"), *_memory(folder, clips, rigs)]


def _inputs(folder: Path) -> tuple[list[Path], list[Path]]:
    """Return clips and rigs, the clips in a folder of their own."""
    place = folder / "clips"
    place.mkdir()
    if DATA.is_dir():
        found = [path for path in sorted((DATA / "mocap").glob("*.bvh")) if path.stat().st_size < LARGEST]
        rigs = [DATA / "rigs" / name for name in RIGS]
    else:
        own = Files.make(folder)
        found, rigs = [own.clip()], [own.tall_glb, own.sprout]
    clips: list[Path] = []
    for i, path in enumerate(islice(cycle(found), CLIPS)):
        clips.append(place / f"{i:02} {path.name}")
        clips[-1].symlink_to(path)
    return clips, rigs


def _throughput(folder: Path, clips: Sequence[Path], rigs: Sequence[Path], workers: int) -> tuple[int, float]:
    """Return the number of jobs, and how many are done in a second."""
    out = folder / f"out {workers}"
    command = [sys.executable, "-m", "morph_retarget", "batch", clips[0].parent, "--on", *rigs, "--out", out]
    subprocess.run([*map(str, command), "--jobs", str(workers)], cwd=ROOT, check=False, stderr=subprocess.DEVNULL)
    told = json.loads((out / "report.json").read_text(encoding="utf-8"))
    bad = [entry["error"] for entry in told["jobs"] if entry["status"] != "ok"]
    print("\n".join(bad) if bad else "all jobs are done")
    return len(told["jobs"]), len(told["jobs"]) / told["seconds"]


def _memory(folder: Path, clips: Sequence[Path], rigs: Sequence[Path]) -> list[Figure]:
    """Return how much the memory of one worker grows over many jobs."""
    if not Path("/proc/self/status").exists():
        print("the memory of a process is not told here: no figure")
        return []
    told: queue.SimpleQueue[tuple[Process, dict[str, object] | None]] = queue.SimpleQueue()
    process = Process([*worker.command(), WORKER], worker.environment(), told)
    shortest = sorted(clips, key=lambda path: path.stat().st_size)[:3]
    pairs = [(clip, rig) for clip in shortest for rig in rigs[:2]]
    weights: list[tuple[int, float]] = []
    try:
        told.get()
        for i in range(JOBS):
            clip, rig = pairs[i % len(pairs)]
            process.send(
                {"argv": [str(clip), str(rig), f"--out={folder / 'out.glb'}", "--frames=1:30"], "fresh": False}
            )
            _, answer = told.get()
            assert answer is not None, process.last_lines()
            if (i + 1) % (JOBS // LOOKS) == 0:
                weights.append((i + 1, _weight(process.number)))
                print(f"{i + 1} jobs: {weights[-1][1]:.1f} MB")
    finally:
        process.close()
    jobs, taken = np.array(weights[1:]).T  # until the first look, caches fill
    slope, _ = np.polyfit(jobs, taken, 1)
    return [
        Figure("batch: memory of a worker", float(taken[-1]), "MB"),
        Figure(f"batch: its growth over {JOBS} jobs", 100.0 * float(slope) * JOBS / float(taken[0]), "%", 2.0),
    ]


def _weight(process: int) -> float:
    rows = Path(f"/proc/{process}/status").read_text().splitlines()
    return next(float(row.split()[1]) / 1024.0 for row in rows if row.startswith("VmRSS:"))
