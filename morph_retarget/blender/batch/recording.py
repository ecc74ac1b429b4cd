"""A run of jobs with its record: what is done already, what may be replaced, what came of the rest."""

import contextlib
from collections.abc import Generator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from ...core.errors import FileError
from . import gates
from .gates import Gate
from .jobs import Item, Job, Refused
from .ledger import BEGUN, DONE, Ledger
from .pool import Began, Pool, Settings, Task
from .prints import Prints
from .process import sweep
from .results import Answer, Result, Status


@dataclass(frozen=True)
class Rules:
    """How results are judged and kept."""

    folder: Path
    """Of the results."""
    resume: bool = False
    """Leave what is done and unchanged."""
    overwrite: bool = False
    """Replace files that are there."""
    gates: Sequence[Gate] = ()


def run(
    items: Sequence[Item], rules: Rules, ledger: Ledger, prints: Prints, settings: Settings
) -> Generator[Result | None, None, None]:
    """Do jobs, and yield what came of each as it ends, first of those that are not to be done; None now and then.

    Raises:
        FileError: Workers do not start.
    """
    tasks: list[Task] = []
    keys: dict[str, str] = {}
    for item in items:
        if isinstance(item, Refused):
            yield Result(item, Answer(Status.FAILED, item.error))
            continue
        try:
            keys[item.name] = prints.key(item)
            before = _before(item, keys[item.name], rules, ledger)
        except FileError as error:
            before = Result(item, Answer(Status.FAILED, str(error)))
        if before is None:
            tasks.append(Task(item, rules.overwrite or (rules.resume and ledger.ours(item.name))))
        else:
            yield _judged(before, rules)
    with contextlib.closing(Pool(tasks, settings).run()) as events:
        for event in events:
            if isinstance(event, Began):
                # Where that cannot be recorded, neither can the end: then it is told.
                with contextlib.suppress(FileError):
                    ledger.begun(event.job.name, keys[event.job.name], event.worker)
            elif event is not None:
                yield _judged(_recorded(event, keys, rules, ledger), rules)
            else:
                yield None


def _before(job: Job, key: str, rules: Rules, ledger: Ledger) -> Result | None:
    """Return what is known of a job without doing it: it is done, or cannot be; None when it is to be done."""
    entry = ledger.entry(job.name)
    if entry.get("state") == BEGUN:
        sweep(job.out.parent, entry["worker"])
    if entry.get("state") == DONE and entry["key"] == key and ledger.whole(job.name):
        told = entry["seconds"], entry["reports"], tuple(entry["files"]), entry.get("drawings", ())
        return Result(job, Answer(Status.SKIPPED, "", *told))
    if not rules.overwrite and job.out.exists() and not ledger.ours(job.name):
        error = f"{job.name}: is there already, and is not what a run wrote: move it away, or use --overwrite"
        return Result(job, Answer(Status.FAILED, error))
    try:
        job.out.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise FileError(f"{job.out.parent}: cannot be made ({error.strerror}): choose another folder") from error
    return None


def _recorded(result: Result, keys: Mapping[str, str], rules: Rules, ledger: Ledger) -> Result:
    """Record what came of a job, its files named from the folder of the results on."""
    name = result.job.name
    try:
        if result.answer.status is not Status.OK:
            ledger.lost(name)
            return result
        files = [Path(file).relative_to(rules.folder).as_posix() for file in result.answer.files]
        result = replace(result, answer=replace(result.answer, files=files))
        ledger.done(name, keys[name], result.answer)
    except FileError as error:
        return result.failing(str(error)) if result.good else result
    return result


def _judged(result: Result, rules: Rules) -> Result:
    """Return a result that has failed if it does not pass the gates; its files stay to be looked at."""
    wrong = gates.judged(result.answer.reports, rules.gates) if result.good else ""
    return result.failing(f"measured {wrong}: look at the result, or raise --fail-on") if wrong else result
