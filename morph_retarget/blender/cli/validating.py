"""``validate ACTION… --on CHARACTER… --out DIR``: judge generalized actions and gaits on many characters."""

import argparse
import contextlib
import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, fields, replace
from itertools import groupby
from pathlib import Path
from typing import Any

import bpy

from ...core.errors import FileError, MorphError
from ...core.validation import grid, page
from ...core.validation.cell import Cell, Status
from ...core.validation.grid import Grid
from ...core.verdicts.judging import DEFAULT, Limits
from .. import retarget, rig, version
from ..io import save
from ..morph import analyses, cast
from ..properties import of_rig
from ..validation import cells, picture
from ..validation.cells import Options
from . import action_file, characters, data, locomotion, manner, numbers
from .action_file import ActionFile
from .characters import CharacterFile
from .messages import naming
from .outputs import set_rate

FAILED = 1
FPS = 24.0
"""Frames a second at which all are judged; what turns how far in one frame depends on it."""
REPORT, PAGE, PICTURE = "report.json", "index.html", "grid.png"


def add_to(parser: argparse.ArgumentParser) -> None:
    """Describe the command to ``parser``."""
    parser.add_argument(
        "actions",
        metavar="ACTION",
        nargs="+",
        help="generalized actions: FILE.blend for all of a file, FILE.blend#ACTION, or actions in the open file; "
        "- for locomotion alone",
    )
    parser.add_argument(
        "--on",
        metavar="CHARACTER",
        nargs="+",
        required=True,
        help="rigs: FILE.blend for all armatures of a file, FILE, FILE#ARMATURE, or armatures in the open file",
    )
    parser.add_argument(
        "--out", required=True, metavar="DIR", help=f"folder for {REPORT}, {PAGE} and {PICTURE}; it is made if need be"
    )
    parser.add_argument(
        "--sample", metavar="N", type=numbers.count, help="judge so many cells alone, chosen at random (default: all)"
    )
    parser.add_argument(
        "--seed", metavar="S", type=int, default=0, help="which ones: the same for the same number (default: 0)"
    )
    parser.add_argument(
        "--compare",
        metavar="FILE",
        help=f"{REPORT} of an earlier run: what passed then and fails now comes first, then what is mended",
    )
    parser.add_argument("--frames", metavar="A:B", type=numbers.frames, help="first and last frame of all actions")
    parser.add_argument(
        "--fps", type=numbers.above_zero, default=FPS, metavar="RATE", help=f"frame rate to judge at (default: {FPS:g})"
    )
    parser.add_argument(
        "--variant",
        type=int,
        metavar="N",
        help="which of the ways to play, from 0 (default: whose bodies have the shortest way to their targets)",
    )
    manner.add_options(parser)
    limits = parser.add_argument_group("limits", "the most that each verdict lets pass")
    for field in fields(Limits):
        default = getattr(DEFAULT, field.name)
        option = f"--max-{field.name}"
        limits.add_argument(
            option, type=numbers.from_zero, default=default, metavar="V", help=f"(default: {default:g})"
        )
    parser.set_defaults(run=run)


@dataclass(frozen=True)
class _Job:
    """What was asked for, checked and read."""

    arguments: argparse.Namespace
    actions: Sequence[tuple[str, ActionFile]]
    """What each is called, and where it is."""
    characters: Sequence[CharacterFile]
    chosen: frozenset[tuple[int, int]]
    """Cells to be judged: which action on which character."""
    limits: Limits


def run(arguments: argparse.Namespace) -> int:
    """Judge all cells and write the grid: all of its files, or none."""
    folder = Path(arguments.out)
    with _made(folder), data.known(), contextlib.ExitStack() as stack:
        if arguments.compare:
            grid.earlier(Path(arguments.compare))
        on = characters.all_found(arguments.on)
        stays_open = all(own.path is None for own in on)
        sources = [own for text in arguments.actions for own in _sources(stack, text, stays_open)]
        job = _Job(arguments, _named(sources), on, _chosen(arguments, len(sources), len(on)), _limits(arguments))
        try:
            found = list(_judged(job))
        finally:
            cast.forget(rig=True)
        result = Grid([cell for _, cell in sorted(found, key=_place)], _settings(job), version.told())
        if arguments.compare:
            result = replace(result, changes=grid.changes_since(Path(arguments.compare), result.cells))
        with save.Outbox() as outbox:
            outbox.text(folder / REPORT, json.dumps(result.described(), indent=1, ensure_ascii=False) + "\n")
            outbox.text(folder / PAGE, page.page(result))
            outbox.made(folder / PICTURE, lambda path: picture.write(path, result))
    print("\n".join(_told(result)))
    return FAILED if result.count(Status.FAILED) else 0


@contextlib.contextmanager
def _made(folder: Path) -> Iterator[None]:
    """Make the folder of the results, and remove it again if there are none."""
    if folder.is_file():
        raise FileError(f"{folder}: is a file: name a folder")
    there = folder.is_dir()
    if not there:
        save.check_folder(folder)
        folder.mkdir()
    save.check_folder(folder / REPORT)
    try:
        yield
    except BaseException:
        if not there:
            folder.rmdir()
        raise


def _sources(stack: contextlib.ExitStack, text: str, stays_open: bool) -> list[ActionFile]:
    if text == locomotion.NO_ACTION:
        return [locomotion.no_action()]
    return stack.enter_context(action_file.all_found(text, stays_open))


def _named(sources: Sequence[ActionFile]) -> list[tuple[str, ActionFile]]:
    """Return actions with what they are called: by their files as well where several have the same name."""
    names = [own.name for own in sources]
    named = [
        (own.name if names.count(own.name) == 1 or own.path is None else f"{own.path.stem}#{own.name}", own)
        for own in sources
    ]
    labels = [label for label, _ in named]
    twice = [label for i, label in enumerate(labels) if label in labels[:i]]
    if twice:
        raise FileError(f"{twice[0]}: is there twice: name each action once")
    return named


def _chosen(arguments: argparse.Namespace, actions: int, on: int) -> frozenset[tuple[int, int]]:
    every = [(i, j) for i in range(actions) for j in range(on)]
    return frozenset(every if arguments.sample is None else grid.sampled(every, arguments.sample, arguments.seed))


def _limits(arguments: argparse.Namespace) -> Limits:
    return Limits(**{field.name: getattr(arguments, f"max_{field.name}") for field in fields(Limits)})


# --- cells ---


def _judged(job: _Job) -> Iterator[tuple[tuple[int, int], Cell]]:
    """Yield all cells, character by character, so that each file is opened once."""
    places = range(len(job.characters))
    for path, group in groupby(places, lambda j: job.characters[j].path):
        own = [j for j in group if any((i, j) in job.chosen for i in range(len(job.actions)))]
        if not own:
            continue
        try:
            there = job.characters[own[0]].open()
            brought = _brought(job)
        except MorphError as error:
            yield from (found for j in own for found in _lost(job, j, str(error)))
            continue
        for j in own:
            try:
                with naming(str(path) if path is not None else job.characters[j].label):
                    ob = job.characters[j].among(there)
                    retarget.check_target(ob)
                    analyses.of(ob)
            except MorphError as error:
                yield from _lost(job, j, str(error))
            else:
                yield from _of_character(job, j, ob, brought)


def _brought(job: _Job) -> list[bpy.types.Action]:
    """Bring all actions into the open file, and give its scene the rate to judge at."""
    set_rate(job.arguments.fps, "", job.arguments.fps)
    return [source.bring() for _, source in job.actions]


def _lost(job: _Job, j: int, error: str) -> Iterator[tuple[tuple[int, int], Cell]]:
    """Yield the cells of a character that cannot be played on."""
    for i, (name, _) in enumerate(job.actions):
        if (i, j) in job.chosen:
            yield (i, j), Cell(name, job.characters[j].label, error=error)


def _of_character(
    job: _Job, j: int, ob: bpy.types.Object, brought: Sequence[bpy.types.Action]
) -> Iterator[tuple[tuple[int, int], Cell]]:
    arguments, label = job.arguments, job.characters[j].label
    goes = of_rig(ob).gait.enabled
    for i, (name, source) in enumerate(job.actions):
        if (i, j) not in job.chosen:
            continue
        alone = isinstance(source, locomotion.NoAction)
        asked = argparse.Namespace(**{**vars(arguments), "action": locomotion.NO_ACTION if alone else source.name})
        of_rig(ob).gait.enabled = goes
        try:
            manner.apply(asked, source, ob)
        except MorphError as error:
            yield (i, j), Cell(name, label, error=str(error))
            continue
        options = Options(
            job.limits,
            _frames(arguments, alone),
            1.0 if alone else source.rate / arguments.fps,
            arguments.variant,
        )
        yield (i, j), cells.judged(ob, brought[i], options, (name, label), brought)


def _frames(arguments: argparse.Namespace, alone: bool) -> tuple[int, int] | None:
    """Return the first and last frame to play, None where keys tell."""
    if arguments.frames is not None or not alone:
        return arguments.frames
    scene = rig.scene_of()
    return scene.frame_start, scene.frame_end


# --- results ---


def _place(found: tuple[tuple[int, int], Cell]) -> tuple[int, int]:
    """Return the row of a cell and its column."""
    return found[0]


def _settings(job: _Job) -> dict[str, Any]:
    """Return what the grid was made with."""
    left_out = {"run", "command", "out", "compare", *(f"max_{field.name}" for field in fields(Limits))}
    given = {name: value for name, value in vars(job.arguments).items() if name not in left_out}
    return given | {"limits": asdict(job.limits)}


def _told(result: Grid) -> Iterator[str]:
    """Yield the lines to print: the pass rate, and what fails."""
    for cell in result.ordered:
        if cell.status is Status.FAILED:
            why = cell.error or ", ".join(f"{name} {cell.verdicts[name].told}" for name in cell.failing)
            sign = "regression" if result.changes is not None and cell.key in result.changes.regressions else "failed"
            yield f"{sign}: {cell.action}, {cell.character}: {why}"
    rate = "nothing to judge" if result.pass_rate is None else f"{100.0 * result.pass_rate:.1f} % pass"
    counts = ", ".join(f"{result.count(status)} {status.value}" for status in Status)
    yield f"{len(result.cells)} cells: {counts}: {rate}"
