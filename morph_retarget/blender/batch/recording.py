"""A run of jobs with its record: what is done already, what may be replaced, what came of the rest."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from ...core.errors import FileError
from . import gates
from .gates import Gate
from .jobs import Job
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
    jobs: Sequence[Job], rules: Rules, ledger: Ledger, prints: Prints, settings: Settings
) -> Iterator[Result | None]:
    """Do jobs, and yield what came of each as it ends; None now and then.

    Raises:
        FileError: Workers do not start, or the record cannot be written.
    """
    tasks: list[Task] = []
    keys: dict[str, str] = {}
    for job in jobs:
        try:
            keys[job.name] = prints.key(job)
            before = _before(job, keys[job.name], rules, ledger)
        except FileError as error:
            before = Result(job, Answer(Status.FAILED, str(error)))
        if before is None:
            tasks.append(Task(job, rules.overwrite or (rules.resume and ledger.ours(job.name))))
        else:
            yield _judged(before, rules)
    for event in Pool(tasks, settings).run():
        if isinstance(event, Began):
            ledger.begun(event.job.name, keys[event.job.name], event.worker)
        elif event is not None:
            yield _judged(_recorded(event, keys[event.job.name], rules, ledger), rules)
        else:
            yield None


def _before(job: Job, key: str, rules: Rules, ledger: Ledger) -> Result | None:
    """Return what is known of a job without doing it: it is done, or cannot be; None when it is to be done."""
    entry = ledger.entry(job.name)
    if entry.get("state") == BEGUN:
        sweep(job.out.parent, entry["worker"])
    if entry.get("state") == DONE and entry["key"] == key and ledger.whole(job.name):
        return Result(job, Answer(Status.SKIPPED, "", entry["seconds"], entry["reports"], tuple(entry["files"])))
    if not rules.overwrite and job.out.exists() and not ledger.ours(job.name):
        error = f"{job.name}: is there already, and is not what a run wrote: move it away, or use --overwrite"
        return Result(job, Answer(Status.FAILED, error))
    try:
        job.out.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise FileError(f"{job.out.parent}: cannot be made ({error.strerror}): choose another folder") from error
    return None


def _recorded(result: Result, key: str, rules: Rules, ledger: Ledger) -> Result:
    """Record what came of a job, its files named from the folder of the results on."""
    if result.answer.status is not Status.OK:
        ledger.lost(result.job.name)
        return result
    files = [Path(file).relative_to(rules.folder).as_posix() for file in result.answer.files]
    answer = replace(result.answer, files=files)
    ledger.done(result.job.name, key, answer)
    return replace(result, answer=answer)


def _judged(result: Result, rules: Rules) -> Result:
    """Return a result that has failed if it does not pass the gates; its files stay to be looked at."""
    wrong = gates.judged(result.answer.reports, rules.gates) if result.good else ""
    return result.failing(f"measured {wrong}: look at the result, or raise --fail-on") if wrong else result
