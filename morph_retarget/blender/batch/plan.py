"""From wishes to jobs: which clip goes onto which rig into which file. All that can be wrong is found here."""

import os
from collections.abc import Iterator, Sequence
from pathlib import Path

from ...core.errors import FileError, MorphError, listed
from ..cli.outputs import Outputs
from ..io import save
from . import files
from .files import Found
from .jobs import EVERY, Job, Wish, check_options

OUT = "{target}/{folder}/{source}.glb"
OUT_EVERY = "{target}/{folder}/{source}_{action}.glb"
"""Usual names of results, for one action and for several."""
_FIELDS = ("{folder}", "{source}", "{target}", "{action}")


def plan(wishes: Sequence[Wish], folder: Path) -> list[Job]:
    """Return the jobs that wishes mean, in order.

    Args:
        wishes: What is asked for.
        folder: Of the results.

    Raises:
        FileError: A file is missing, a result would lie outside of the folder, two would get the same file, or an
            input lies where results do. The message begins with the place of the wish.
    """
    jobs: list[Job] = []
    places: dict[str, str] = {}
    for wish in wishes:
        try:
            for job in _jobs(wish, folder):
                key = os.path.normcase(job.out)
                if key in places:
                    raise FileError(
                        f"{job.name}: would hold {job.labels[0]} on {job.labels[1]} and also {places[key]}: "
                        "tell them apart with {folder}, {source} and {target}"
                    )
                places[key] = f"{job.labels[0]} on {job.labels[1]}"
                jobs.append(job)
        except MorphError as error:
            raise FileError(f"{wish.where}: {error}" if wish.where else str(error)) from error
    if not jobs:
        raise FileError("no job is left: each clip and rig are the same file: choose other rigs")
    _check_nested(jobs)
    return jobs


def chunk(jobs: Sequence[Job], number: int, count: int) -> list[Job]:
    """Return every ``count``-th job from the ``number``-th on, counted from 1: a share of work for one machine."""
    return list(jobs[number - 1 :: count])


def _jobs(wish: Wish, folder: Path) -> Iterator[Job]:
    check_options(wish.options)
    look = files.as_found if wish.by_folder else files.find
    sources = [found for text in wish.sources for found in look(text, wish.base)]
    targets = [found for text in wish.targets for found in files.find(text, wish.base)]
    for found in (*sources, *targets):
        _check_input(found, folder)
    every = bool(wish.options.get("all-actions")) or any(found.action == EVERY for found in sources)
    template = (OUT_EVERY if every else OUT) if wish.out is None else wish.out
    _check_template(template)
    for found in targets:
        if found.action is not None:
            raise FileError(f"{found.label}: a rig has no action: use the option armature to choose one of several")
    for source in sources:
        for target in targets:
            if source.path.samefile(target.path) and (source.by_pattern or target.by_pattern):
                continue  # a pattern means the others
            yield _job(wish, source, target, template, folder)


def _check_input(found: Found, folder: Path) -> None:
    if found.path.suffix.lower() not in files.KINDS:
        raise FileError(f"{found.label}: unknown kind of file: use {', '.join(files.KINDS)}")
    if _inside(found.path, folder):
        raise FileError(f"{found.label}: lies in {folder}, where the results go: choose another folder for them")


def _check_template(template: str) -> None:
    bare = template
    for name in _FIELDS:
        bare = bare.replace(name, "")
    if "{" in bare or "}" in bare:
        raise FileError(f"{template}: use {', '.join(_FIELDS)} and no other braces")
    if "{action}" in template.replace("\\", "/").rpartition("/")[0]:
        raise FileError(f"{template}: an action gives no folder its name: put {{action}} behind the last slash")
    if Path(template).suffix.lower() not in save.KINDS:
        raise FileError(f"{template}: unknown kind of output: end it in {', '.join(save.KINDS)}")
    if Path(template).is_absolute() or template.startswith(("/", "\\")):
        raise FileError(f"{template}: starts at the root: name results from --out on")


def _job(wish: Wish, source: Found, target: Found, template: str, folder: Path) -> Job:
    several = source.action == EVERY or bool(wish.options.get("all-actions"))
    if several and "{action}" not in template and not template.lower().endswith(".blend"):
        raise FileError(f"{template}: holds one action: put {{action}} into its name, or write a .blend")
    outputs = Outputs(template.replace("{folder}", source.folder), str(source.path), [str(target.path)])
    # An empty field must not leave a slash in front, and no piece may climb out.
    pieces = [piece for piece in outputs.path(str(target.path), "{action}").as_posix().split("/") if piece]
    out = Path(os.path.normpath(folder.joinpath(*pieces)))
    if not _inside(out, folder):
        raise FileError(f"{template}: leads out of {folder} for {source.label}: results stay below it")
    name = out.relative_to(folder).as_posix()
    return Job(source.path, source.action, target.path, out, name, wish.options, (source.label, target.label))


def _inside(path: Path, folder: Path) -> bool:
    """Return whether a file is, or would be, in a folder, links followed."""
    return path.resolve().is_relative_to(folder.resolve()) and path.resolve() != folder.resolve()


def _check_nested(jobs: Sequence[Job]) -> None:
    """Check that no result has the name of a folder that another needs."""
    folders = {folder for job in jobs for folder in job.out.parents}
    wrong = [job.name for job in jobs if job.out in folders]
    if wrong:
        raise FileError(f"{listed(wrong)}: would be a file and a folder: give results other names")
