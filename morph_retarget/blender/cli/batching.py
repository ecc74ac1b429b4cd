"""``batch JOBS.toml|FOLDER --out DIR``: many clips onto many rigs, in worker processes."""

import argparse
import contextlib
import json
import os
import signal
import sys
from collections.abc import Generator, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ...core.errors import FileError, MorphError
from .. import bone_maps, version
from ..batch import files, gates, jobs_file, junit, ledger, plan, recording, summary, worker
from ..batch.jobs import FILES, Item, Job, Refused, Wish, usual_options
from ..batch.pool import Settings
from ..batch.prints import Prints
from ..batch.progress import Progress
from ..batch.recording import Rules
from ..batch.results import Answer, Result, Status, counted
from ..io import save
from . import numbers, retargeting
from .messages import say

FAILED = 1
WORKER = "worker"
_REQUESTS = (signal.SIGINT, signal.SIGTERM)
"""Ask the program to end."""


def add_to(parser: argparse.ArgumentParser) -> None:
    """Describe the command to ``parser``."""
    parser.add_argument("jobs", metavar="JOBS", help="file of jobs (.toml), or a folder of clips with --on")
    parser.add_argument(
        "--on", metavar="RIG", nargs="+", help="rigs for the clips of a folder: files, or patterns such as 'rigs/*.glb'"
    )
    parser.add_argument(
        "--out", required=True, metavar="DIR", help="folder of the results and reports; it is made if need be"
    )
    parser.add_argument(
        "--files",
        metavar="TEMPLATE",
        help=f"names of the results below DIR for a folder (.blend .glb .fbx .bvh; default: {plan.OUT}, "
        f"with --all-actions {plan.OUT_EVERY})",
    )
    run_group = parser.add_argument_group("run")
    run_group.add_argument(
        "--jobs", dest="workers", metavar="N", type=numbers.count, default=1, help="worker processes"
    )
    run_group.add_argument("--timeout", metavar="S", type=numbers.above_zero, help="most time for one job [s]")
    run_group.add_argument(
        "--memory", metavar="MB", type=numbers.count, help="most memory for one worker, where limits exist"
    )
    run_group.add_argument(
        "--resume", action="store_true", help="skip what an earlier run did and has not changed since"
    )
    run_group.add_argument("--overwrite", action="store_true", help="replace files that are there")
    run_group.add_argument(
        "--chunk",
        metavar="I/N",
        type=_chunk,
        default=(1, 1),
        help="do the I-th of N shares alone, on one of N machines",
    )
    measures = "; ".join(f"{name}: {meaning}" for name, (meaning, _) in gates.MEASURES.items()).replace("%", "%%")
    run_group.add_argument(
        "--fail-on",
        metavar="GATES",
        type=_gates,
        default=[],
        help=f"let jobs fail by what is measured, as 'slide>0.01,error>5'; measures are {measures}",
    )
    retargeting.add_options(parser)
    parser.set_defaults(run=run)


def add_worker_to(parser: argparse.ArgumentParser) -> None:
    """Describe the command of a worker to ``parser``; `batch` starts it."""
    parser.add_argument("--memory", metavar="MB", type=numbers.count)
    parser.set_defaults(run=lambda arguments: worker.run(arguments.memory))


def _chunk(text: str) -> tuple[int, int]:
    first, _, last = text.partition("/")
    if not (first.isdecimal() and last.isdecimal() and 1 <= int(first) <= int(last)):
        raise argparse.ArgumentTypeError(f"{text!r} is no share: write it as 1/4, from 1/4 to 4/4")
    return int(first), int(last)


def _gates(text: str) -> list[gates.Gate]:
    try:
        return gates.parse(text)
    except MorphError as error:
        raise argparse.ArgumentTypeError(str(error)) from error


def run(arguments: argparse.Namespace) -> int:
    """Do all jobs, and write the reports."""
    folder = Path(os.path.abspath(arguments.out))  # noqa: PTH100 - resolve() would follow links
    if folder.exists() and not folder.is_dir():
        raise FileError(f"{arguments.out}: is no folder: name one")
    number, count = arguments.chunk
    part = f".{number}-of-{count}" if count > 1 else ""
    items = plan.chunk(plan.plan(_wishes(arguments, folder), folder), number, count)
    reports = _Reports(folder / f"report{part}.json", folder / f"junit{part}.xml", folder / f"index{part}.html")
    if not (arguments.resume or arguments.overwrite):
        _check_new(items, reports)
    rules = Rules(folder, arguments.resume, arguments.overwrite, arguments.fail_on)
    progress = Progress(len(items), sys.stderr)
    with _stoppable(), ledger.opened(folder, part, arguments.resume) as record:
        doing = recording.run(items, rules, record, Prints(version.told()), _settings(arguments))
        results = _followed(doing, progress)
        left = _left(items, results)
        if left:
            say(f"stopped after {len(results)} of {len(items)} jobs: go on with --resume")
        order = {item.name: i for i, item in enumerate(items)}
        results = sorted([*results, *left], key=lambda result: order[result.job.name])
        _write(reports, results, progress.seconds)
    counts = ", ".join(f"{count} {status}" for status, count in counted(results).items() if count)
    print(f"{len(results)} jobs in {progress.seconds:.1f} s: {counts or 'nothing to do'}: {reports.json}")
    return 0 if all(result.good for result in results) else FAILED


def _followed(doing: Generator[Result | None, None, None], progress: Progress) -> list[Result]:
    """Return what came of jobs as far as they were done before somebody stopped them."""
    results: list[Result] = []
    try:
        with contextlib.closing(doing):
            for found in doing:
                if found is None:
                    progress.renew()
                else:
                    results.append(found)
                    progress.ended(found)
    except KeyboardInterrupt:
        pass  # what is left is told
    finally:
        progress.close()
    return results


def _left(items: Sequence[Item], results: Sequence[Result]) -> list[Result]:
    """Return the jobs that nothing came of since the run was stopped."""
    ended = {result.job.name for result in results}
    told = Answer(Status.STOPPED, "the run was stopped before it was done: go on with --resume")
    return [Result(item, told) for item in items if item.name not in ended]


@dataclass(frozen=True)
class _Reports:
    """Where the reports go."""

    json: Path
    xml: Path
    page: Path


def _write(reports: _Reports, results: Sequence[Result], seconds: float) -> None:
    with save.Outbox() as outbox:
        outbox.text(reports.json, json.dumps(_described(results, seconds), indent=1, ensure_ascii=False) + "\n")
        outbox.text(reports.xml, junit.document(results, seconds))
        outbox.text(reports.page, summary.page(results, seconds, version.told()))


# --- what is asked for ---


def _wishes(arguments: argparse.Namespace, out: Path) -> list[Wish | Refused]:
    source, options = Path(arguments.jobs), _options(arguments)
    if not source.is_dir():
        if source.suffix.lower() != ".toml":
            told = "is neither a .toml file nor a folder" if source.exists() else "no such file or folder"
            raise FileError(f"{source}: {told}: name a file of jobs, or a folder of clips")
        given = [*options, *(name for name in ("on", "files") if getattr(arguments, name))]
        if given:
            raise FileError(f"{source}: --{given[0]} is for a folder of clips: write it into the file")
        return jobs_file.read(source)
    if not arguments.on:
        raise FileError(f"{source}: is a folder of clips: name rigs with --on")
    if out.resolve().is_relative_to(source.resolve()):
        raise FileError(f"{arguments.out}: lies in {source}, whose clips are read: choose another folder")
    rigs = {found.path for text in arguments.on for found in files.find(text, Path())}
    base = source.absolute()
    clips = [name for name in files.below(source) if base / name not in rigs]
    if not clips:
        raise FileError(f"{source}: holds no clips: choose a folder with {', '.join(files.KINDS)} in it")
    targets = tuple(os.path.abspath(text) for text in arguments.on)  # noqa: PTH100 - patterns
    return [Wish(tuple(clips), targets, arguments.files, options, base, by_folder=True)]


def _options(arguments: argparse.Namespace) -> dict[str, str | bool]:
    """Return the options of ``retarget`` that were given, as text."""
    out: dict[str, str | bool] = {}
    for name, usual in usual_options().items():
        value: Any = getattr(arguments, name.replace("-", "_"))
        if value == usual:
            continue
        if name in FILES:
            value = bone_maps.file_of(value).absolute()
            if not value.is_file():
                raise FileError(f"{value}: no such file: check the path")
        pair = isinstance(value, tuple)
        out[name] = True if value is True else ":".join(map(str, value)) if pair else str(value)
    return out


def _check_new(items: Sequence[Item], reports: _Reports) -> None:
    """Check that nothing would be replaced."""
    results = [item.out for item in items if isinstance(item, Job)]
    there = [path for path in (*results, reports.json, reports.xml, reports.page) if path.exists()]
    if there:
        more = f" and {len(there) - 1} more" if len(there) > 1 else ""
        raise FileError(
            f"{there[0]}{more}: there already: use --resume to go on, --overwrite to replace, or another folder"
        )


# --- the run ---


def _settings(arguments: argparse.Namespace) -> Settings:
    limit = [] if arguments.memory is None else [f"--memory={arguments.memory}"]
    return Settings([*worker.command(), WORKER, *limit], arguments.workers, arguments.timeout, worker.environment())


@contextlib.contextmanager
def _stoppable() -> Iterator[None]:
    """Let the first request to end the program arrive as `KeyboardInterrupt`; more of them change nothing.

    Workers are ended then, and what is known is reported, which takes a moment and shall not be cut short.
    """

    def stop(*_: object) -> None:
        for number in _REQUESTS:
            signal.signal(number, signal.SIG_IGN)
        raise KeyboardInterrupt

    before = {number: signal.signal(number, stop) for number in _REQUESTS}
    try:
        yield
    finally:
        for number, handler in before.items():
            # None is a handler of Blender's own, which Python cannot put back; the program is about to end.
            signal.signal(number, signal.SIG_DFL if handler is None else handler)


def _described(results: Sequence[Result], seconds: float) -> dict[str, Any]:
    # What is meant stands in `results.REPORT_FIELDS`.
    return {
        "program": version.told(),
        "seconds": round(seconds, 3),
        "counts": counted(results),
        "jobs": [result.described() for result in results],
    }
