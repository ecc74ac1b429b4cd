"""A validation grid as one page that needs no network: what fails first, cells with their verdicts and pictures."""

from collections.abc import Iterator
from html import escape

from . import markup
from .cell import Cell, Status
from .grid import Grid
from .markup import Square

_LOOKS = {Status.PASSED: markup.PASSED, Status.FAILED: markup.FAILED, Status.NOT_FOR_IT: markup.NONE}


def page(grid: Grid) -> str:
    """Return the page."""
    return "\n".join(_page(grid)) + "\n"


def _page(grid: Grid) -> Iterator[str]:
    numbers = {cell.key: i for i, cell in enumerate(grid.cells)}
    yield markup.opening(f"Validation: {_rate(grid)}")
    yield f"<h1>{_rate(grid)} of {grid.count(Status.PASSED) + grid.count(Status.FAILED)} cells pass</h1>"
    told = ", ".join(f"{name} {count}" for name, count in grid.by_verdict.items() if count) or "none"
    yield f"<p>{len(grid.actions)} actions, {len(grid.characters)} characters; on {grid.count(Status.NOT_FOR_IT)} cells"
    yield f"the action does not apply. Failed verdicts: {escape(told)}. {escape(grid.version)}</p>"
    squares = {cell.key: _square(cell, numbers[cell.key]) for cell in grid.cells}
    yield from markup.table(grid.actions, grid.characters, squares)
    for title, cells in _groups(grid):
        if cells:
            yield f"<h2>{title} ({len(cells)})</h2>"
            for cell in cells:
                yield from _cell(cell, numbers[cell.key])


def _rate(grid: Grid) -> str:
    return "nothing" if grid.pass_rate is None else f"{100.0 * grid.pass_rate:.1f} %"


def _groups(grid: Grid) -> Iterator[tuple[str, list[Cell]]]:
    """Yield the cells under their headings, what is to be seen first before the others."""
    changes = grid.changes
    regressions = frozenset[tuple[str, str]]() if changes is None else changes.regressions
    mended = frozenset[tuple[str, str]]() if changes is None else changes.mended
    rest = [cell for cell in grid.ordered if cell.key not in regressions | mended]
    yield "Regressions", [cell for cell in grid.ordered if cell.key in regressions]
    yield "Mended", [cell for cell in grid.ordered if cell.key in mended]
    yield "Failed", [cell for cell in rest if cell.status is Status.FAILED]
    yield "Passed", [cell for cell in rest if cell.status is Status.PASSED]


def _square(cell: Cell, number: int) -> Square:
    """Return a cell in the table of all."""
    applies = cell.status is not Status.NOT_FOR_IT
    why = ", ".join(cell.failing) or cell.error or cell.status.value if applies else "; ".join(cell.problems)
    return Square(_LOOKS[cell.status], f"{cell.action}, {cell.character}: {why}", f"c{number}" if applies else "")


def _cell(cell: Cell, number: int) -> Iterator[str]:
    bad = " bad" if cell.status is Status.FAILED else ""
    variant = f", variant {cell.variant} of {cell.variants}" if cell.variants > 1 else ""
    yield f'<div class="cell{bad}" id="c{number}"><h3>{escape(cell.action)} · {escape(cell.character)}'
    yield f"<small>{cell.frames} frames{variant}</small></h3>"
    if cell.error:
        yield f'<p class="wrong">{escape(cell.error)}</p>'
    if cell.strip is not None:
        yield markup.svg(cell.strip, cell.first)
    yield '<p class="verdicts">' + "".join(_verdicts(cell)) + "</p>"
    yield from (f"<p>{escape(problem)}</p>" for problem in cell.problems)
    yield "</div>"


def _verdicts(cell: Cell) -> Iterator[str]:
    for name, verdict in cell.verdicts.items():
        found, style = verdict.found, "" if verdict.passed else ' class="wrong"'
        where = "" if found.row is None or verdict.passed else f", {found.name} at frame {cell.first + found.row:g}"
        yield f"<span{style}>{name} {found.value:.3g} {escape(verdict.unit)}{escape(where)}</span>"
