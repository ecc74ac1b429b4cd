"""Fields of reports, from the modules that write them."""

from collections.abc import Mapping

from morph_retarget.blender.batch import gates, results
from morph_retarget.core import report
from morph_retarget.core.morph import measure
from morph_retarget.core.validation import cell, grid
from morph_retarget.core.verdicts import judging

from . import modules
from .markdown import code, page, sentence, table

_INTRODUCTION = """
Reports are JSON. Lengths are metres of the target, angles degrees, unless the name says otherwise. New versions may
add fields; none changes its meaning.
"""


def reports() -> str:
    """Return the page of all reports."""
    limits, told = judging.Limits(), modules.told_below("blender.batch.results", "Status")
    return page(
        "Fields of reports",
        _INTRODUCTION.strip(),
        "## `retarget --report`\n\nA list with one entry for each pair:",
        _fields(report.FIELDS),
        "For rigs with controls there is `controls` as well, which has:",
        _fields(report.CONTROLS_FIELDS),
        "## `play --report`\n\nA list with one entry for each character:",
        _fields(measure.FIELDS),
        "## `batch`: `report.json`",
        _fields(results.REPORT_FIELDS),
        "Each of its `jobs` has:",
        _fields(results.FIELDS),
        "and is one of these:",
        table(("status", "meaning"), ((code(s.value), told.get(s.name, "")) for s in results.Status)),
        "Gates (`--fail-on`) compare these measures of a pair:",
        table(("measure", "meaning"), ((code(name), sentence(text)) for name, (text, _) in gates.MEASURES.items())),
        "## `validate`: `report.json`",
        _fields(grid.FIELDS),
        "Each of its `cells` has:",
        _fields(cell.FIELDS),
        "Each verdict of a cell has:",
        _fields(cell.VERDICT_FIELDS),
        "They are judged with these limits:",
        table(("verdict", "limit"), ((code(name), f"{getattr(limits, name):g}") for name in judging.VERDICTS)),
    )


def _fields(fields: Mapping[str, str]) -> str:
    return table(("field", "meaning"), ((code(name), meaning) for name, meaning in fields.items()))
