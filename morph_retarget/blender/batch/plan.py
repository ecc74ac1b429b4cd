"""From wishes to jobs: which clip goes onto which rig into which file. All that can be wrong is found here."""

import os
from collections.abc import Iterator, Sequence
from pathlib import Path

from ...core.errors import FileError, MorphError
from ..cli.outputs import Outputs
from ..io import save
from . import files
from .files import Found
from .jobs import EVERY, Item, Job, Refused, Wish, check_options

OUT = "{target}/{folder}/{source}.glb"
OUT_EVERY = "{target}/{folder}/{source}_{action}.glb"
"""Usual names of results, for one action and for several."""
_FIELDS = ("{folder}", "{source}", "{target}", "{action}")


def plan(wishes: Sequence[Wish | Refused], folder: Path) -> list[Item]:
    """Return the jobs that wishes mean, in order, and in their places what cannot be meant.

    A file that is missing or lies where the results go, a result that would lie outside of the folder or is that of
    another job too: each is refused alone.

    Args:
        wishes: What is asked for.
        folder: Of the results.

    Raises:
        FileError: Nothing is left to be done; with the first thing that is wrong.
    """
    items: list[Item] = []
    for wish in wishes:
        items += [wish] if isinstance(wish, Refused) else _items(wish, folder)
    items = _not_nested(_apart(items))
    if not any(isinstance(item, Job) for item in items):
        refused = [item.error for item in items if isinstance(item, Refused)]
        more = f" (and {len(refused) - 1} more)" if len(refused) > 1 else ""
        alone = "no job is left: each clip and rig are the same file: choose other rigs"
        raise FileError(refused[0] + more if refused else alone)
    return items


def chunk(items: Sequence[Item], number: int, count: int) -> list[Item]:
    """Return every ``count``-th item from the ``number``-th on, counted from 1: a share of work for one machine."""
    return list(items[number - 1 :: count])


def _items(wish: Wish, folder: Path) -> Iterator[Item]:
    try:
        check_options(wish.options)
        if wish.out is not None:
            _check_template(wish.out)
    except MorphError as error:
        yield _refused(wish, error)
        return
    sources: list[Found] = []
    targets: list[Found] = []
    for texts, out, look in (
        (wish.sources, sources, files.as_found if wish.by_folder else files.find),
        (wish.targets, targets, _rigs),
    ):
        for text in texts:
            try:
                found = look(text, wish.base)
            except MorphError as error:
                yield _refused(wish, error, text)
                continue
            for own in found:
                try:
                    _check_input(own, folder)
                    out.append(own)
                except MorphError as error:
                    yield _refused(wish, error, own.label)
    every = bool(wish.options.get("all-actions")) or any(found.action == EVERY for found in sources)
    template = (OUT_EVERY if every else OUT) if wish.out is None else wish.out
    for source in sources:
        for target in targets:
            if source.path.samefile(target.path) and (source.by_pattern or target.by_pattern):
                continue  # a pattern means the others
            try:
                yield _job(wish, source, target, template, folder)
            except MorphError as error:
                yield _refused(wish, error, labels=(source.label, target.label))


def _rigs(text: str, base: Path) -> list[Found]:
    found = files.find(text, base)
    if found[0].action is not None:
        raise FileError(f"{found[0].label}: a rig has no action: use the option armature to choose one of several")
    return found


def _refused(wish: Wish, error: MorphError, text: str = "", labels: tuple[str, str] | None = None) -> Refused:
    """Return a wish, a text of it or a pair as refused."""
    what = " on ".join(labels) if labels else text
    told = ", ".join(wish.sources), ", ".join(wish.targets)
    return Refused(
        ": ".join(filter(None, (wish.name, what))) or "jobs",
        f"{wish.where}: {error}" if wish.where else str(error),
        labels or told,
    )


def _apart(items: Sequence[Item]) -> Iterator[Item]:
    """Yield items; a job that would have the same result as another before it is refused."""
    places: dict[str, str] = {}
    for item in items:
        if isinstance(item, Refused):
            yield item
            continue
        key, pair = os.path.normcase(item.out), " on ".join(item.labels)
        if key in places:
            told = f"{item.name}: would hold {pair} and also {places[key]}"
            yield _unfit(item, f"{told}: tell them apart with {{folder}}, {{source}} and {{target}}")
        else:
            places[key] = pair
            yield item


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
    labels, place = (source.label, target.label), (wish.where, wish.name)
    return Job(source.path, source.action, target.path, out, name, wish.options, labels, place)


def _inside(path: Path, folder: Path) -> bool:
    """Return whether a file is, or would be, in a folder, links followed."""
    return path.resolve().is_relative_to(folder.resolve()) and path.resolve() != folder.resolve()


def _not_nested(items: Iterator[Item]) -> list[Item]:
    """Return items; results that have the name of a folder that another needs are refused."""
    own = list(items)
    folders = {folder for item in own if isinstance(item, Job) for folder in item.out.parents}
    told = "would be a file and a folder: give results other names"
    return [
        _unfit(item, f"{item.name}: {told}") if isinstance(item, Job) and item.out in folders else item for item in own
    ]


def _unfit(job: Job, error: str) -> Refused:
    """Return that a job is refused for what it would write."""
    place, name = job.place
    where = f"{place}: {error}" if place else error
    return Refused(": ".join(filter(None, (name, " on ".join(job.labels)))), where, job.labels)
