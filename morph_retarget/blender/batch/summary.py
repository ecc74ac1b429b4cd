"""A batch as one page: what is bad first, jobs with their measures and with pictures of their results."""

from collections.abc import Iterator, Mapping, Sequence
from html import escape
from typing import Any

from ...core.validation import markup
from ...core.validation.markup import Square
from .results import GOOD, Result, Status, counted

DRAWN = 1000
"""Jobs with pictures at most, so that browsers can open the page; bad ones come first."""
_SHOWN: Mapping[str, tuple[str, str, str]] = {
    "slide": ("foot_slide_m_per_s", "target", "m/s"),
    "error": ("bone_direction_error_deg", "mean", "°"),
    "penetration": ("ground_penetration_m", "max", "m"),
    "jump": ("pose_jump_deg", "max", "°"),
}
"""Measures on the page, as gates call them: where they stand in a report, and their units."""


def page(results: Sequence[Result], seconds: float, version: str) -> str:
    """Return the page.

    Args:
        results: Of all jobs.
        seconds: That the batch took.
        version: Of what did it.
    """
    return "\n".join(_page(results, seconds, version)) + "\n"


def _page(results: Sequence[Result], seconds: float, version: str) -> Iterator[str]:
    good = sum(result.good for result in results)
    title = f"{good} of {len(results)} jobs are done"
    told = ", ".join(f"{count} {status}" for status, count in counted(results).items() if count) or "none"
    yield markup.opening(f"Batch: {title}")
    yield f"<h1>{title}</h1>"
    yield f"<p>{escape(told)}, in {seconds:.1f} s. {escape(version)}</p>"
    ordered = sorted(range(len(results)), key=lambda i: _rank(results[i]))
    yield from _table(results, ordered)
    drawn = frozenset(ordered[:DRAWN])
    if len(results) > DRAWN:
        yield f"<p>Pictures are shown of the first {DRAWN} jobs below.</p>"
    for status in sorted(Status, key=_STATUSES.index):
        found = [i for i in ordered if results[i].answer.status is status]
        if found:
            yield f"<h2>{status.value.capitalize()} ({len(found)})</h2>"
            for i in found:
                yield from _job(results[i], i, i in drawn)


_STATUSES = [*(status for status in Status if status not in GOOD), *GOOD]
"""What is to be looked at first before the others."""


def _rank(result: Result) -> int:
    return _STATUSES.index(result.answer.status)


def _table(results: Sequence[Result], ordered: Sequence[int]) -> Iterator[str]:
    """Yield the table of clips and rigs; of several jobs of a pair, one that is bad is shown."""
    squares: dict[tuple[str, str], Square] = {}
    for i in ordered:
        result = results[i]
        look = markup.PASSED if result.good else markup.FAILED
        told = f"{result.job.name}: {result.answer.error or result.answer.status.value}"
        squares.setdefault(result.job.labels, Square(look, told, f"j{i}"))
    rows, columns = (list(dict.fromkeys(result.job.labels[side] for result in results)) for side in (0, 1))
    yield from markup.table(rows, columns, squares)


def _job(result: Result, number: int, drawn: bool) -> Iterator[str]:
    answer, (source, target) = result.answer, result.job.labels
    yield f'<div class="cell{"" if result.good else " bad"}" id="j{number}"><h3>{escape(result.job.name)}'
    yield f"<small>{escape(source)} · {escape(target)}, {answer.seconds:.1f} s</small></h3>"
    if answer.error:
        yield f'<p class="wrong">{escape(answer.error)}</p>'
    for i, report in enumerate(answer.reports):
        if drawn and i < len(answer.drawings):
            yield answer.drawings[i]
        yield f'<p class="verdicts">{"".join(_measures(report))}</p>'
        yield from (f"<p>{escape(str(warning))}</p>" for warning in report["warnings"])
    if answer.log:
        yield f"<details><summary>Last lines</summary><pre>{escape(chr(10).join(answer.log))}</pre></details>"
    yield "</div>"


def _measures(report: Mapping[str, Any]) -> Iterator[str]:
    yield f"<span>{report['frames']} frames</span><span>{report['joints_mapped']} joints</span>"
    for name, (where, part, unit) in _SHOWN.items():
        yield f"<span>{name} {report[where][part]:.3g} {unit}</span>"
