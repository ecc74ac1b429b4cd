"""A validation grid as one page that needs no network: what fails first, cells with their verdicts and pictures."""

from collections.abc import Iterator, Sequence
from html import escape

from .cell import Cell, Status
from .drawing import Strip
from .grid import Grid

TILE = 100
"""Side of a picture [units of the drawing]."""
_STYLE = """
body{font:14px/1.4 system-ui,sans-serif;margin:1.5em;background:#f4f4f2;color:#222}
h1{font-size:1.5em;margin:0 0 .2em}h2{font-size:1.15em;margin:1.6em 0 .5em}
table{border-collapse:collapse}th,td{padding:2px 6px;text-align:left}
.map td{width:1.5em;height:1.5em;padding:0;text-align:center;border:1px solid #f4f4f2}
.map th{font-weight:normal;white-space:nowrap}.map thead th{writing-mode:vertical-rl;transform:rotate(180deg)}
.map a{display:block;color:#fff;text-decoration:none}
.passed{background:#3c8d5a}.failed{background:#c8432f}.none{background:#ddd;color:#999}
.scroll{overflow-x:auto}
.cell{background:#fff;border-left:5px solid #3c8d5a;margin:.6em 0;padding:.5em .8em;border-radius:3px}
.cell.bad{border-color:#c8432f}.cell h3{font-size:1em;margin:0 0 .3em}.cell h3 small{font-weight:normal;color:#777}
.cell p{margin:.2em 0;color:#555}.cell .wrong{color:#b03020}
.verdicts span{display:inline-block;margin-right:1em;color:#666}.verdicts .wrong{font-weight:bold}
svg{width:100%;max-width:900px;height:auto;display:block}
svg path{fill:none;stroke-width:1.5;stroke-linecap:round}
.m{stroke:#3a3a3a}.l{stroke:#2f7fc2}.r{stroke:#d9822b}.g{stroke:#bbb;stroke-width:1}
svg rect{fill:#fafaf8}svg rect.w{fill:#fbe9e6;stroke:#c8432f}
@media(prefers-color-scheme:dark){body{background:#1e1f22;color:#ddd}.cell{background:#292b2f}
.cell p,.verdicts span{color:#aaa}
.map td{border-color:#1e1f22}.none{background:#333;color:#666}.cell .wrong{color:#f08070}
svg rect{fill:#303237}svg rect.w{fill:#442a28}.m{stroke:#ddd}.g{stroke:#666}}
"""
_SHOWN = {Status.PASSED: ("passed", "✓"), Status.FAILED: ("failed", "✗")}


def page(grid: Grid) -> str:
    """Return the page."""
    return "\n".join(_page(grid)) + "\n"


def _page(grid: Grid) -> Iterator[str]:
    numbers = {cell.key: i for i, cell in enumerate(grid.cells)}
    yield "<!doctype html>"
    yield f'<html lang="en"><meta charset="utf-8"><title>Validation: {_rate(grid)}</title><style>{_STYLE}</style>'
    yield f"<h1>{_rate(grid)} of {grid.count(Status.PASSED) + grid.count(Status.FAILED)} cells pass</h1>"
    told = ", ".join(f"{name} {count}" for name, count in grid.by_verdict.items() if count) or "none"
    yield f"<p>{len(grid.actions)} actions, {len(grid.characters)} characters; on {grid.count(Status.NOT_FOR_IT)} cells"
    yield f"the action does not apply. Failed verdicts: {escape(told)}. {escape(grid.version)}</p>"
    yield from _map(grid, numbers)
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


def _map(grid: Grid, numbers: dict[tuple[str, str], int]) -> Iterator[str]:
    """Yield the table of all cells, each a link to what is told of it."""
    cells = {cell.key: cell for cell in grid.cells}
    yield '<div class="scroll"><table class="map"><thead><tr><td>'
    yield "".join(f"<th>{escape(name)}" for name in grid.characters)
    yield "</thead>"
    for action in grid.actions:
        yield f"<tr><th>{escape(action)}"
        for character in grid.characters:
            cell = cells.get((action, character))
            if cell is None:
                yield "<td>"
                continue
            style, sign = _SHOWN.get(cell.status, ("none", "·"))
            said = escape(f"{action}, {character}: {', '.join(cell.failing) or cell.error or cell.status.value}")
            if cell.status is Status.NOT_FOR_IT:
                said = escape(f"{action}, {character}: {'; '.join(cell.problems)}")
                yield f'<td class="{style}" title="{said}">{sign}'
            else:
                yield f'<td class="{style}" title="{said}"><a href="#c{numbers[cell.key]}">{sign}</a>'
    yield "</table></div>"


def _cell(cell: Cell, number: int) -> Iterator[str]:
    bad = " bad" if cell.status is Status.FAILED else ""
    variant = f", variant {cell.variant} of {cell.variants}" if cell.variants > 1 else ""
    yield f'<div class="cell{bad}" id="c{number}"><h3>{escape(cell.action)} · {escape(cell.character)}'
    yield f"<small>{cell.frames} frames{variant}</small></h3>"
    if cell.error:
        yield f'<p class="wrong">{escape(cell.error)}</p>'
    if cell.strip is not None:
        yield svg(cell.strip, cell.first)
    yield '<p class="verdicts">' + "".join(_verdicts(cell)) + "</p>"
    yield from (f"<p>{escape(problem)}</p>" for problem in cell.problems)
    yield "</div>"


def _verdicts(cell: Cell) -> Iterator[str]:
    for name, verdict in cell.verdicts.items():
        found, style = verdict.found, "" if verdict.passed else ' class="wrong"'
        where = "" if found.row is None or verdict.passed else f", {found.name} at frame {cell.first + found.row:g}"
        yield f"<span{style}>{name} {found.value:.3g} {escape(verdict.unit)}{escape(where)}</span>"


def svg(strip: Strip, first: float = 0.0) -> str:
    """Return the pictures of a cell as one drawing; ``first`` is the frame of its first row."""
    count = len(strip.lines)
    out = [f'<svg viewBox="0 0 {TILE * count} {TILE}" role="img">']
    for i in range(count):
        left, floor = TILE * i, TILE * float(strip.floors[i])
        style = ' class="w"' if strip.marked[i] else ""
        out.append(f'<rect{style} x="{left + 1}" y="1" width="{TILE - 2}" height="{TILE - 2}">')
        out.append(f"<title>frame {first + int(strip.rows[i]):g}</title></rect>")
        out.append(f'<path class="g" d="M{left + 6} {floor:.1f}h{TILE - 12}"/>')
        for side, style in ((-1, "r"), (0, "m"), (1, "l")):
            ways = [_line(line, left) for line in (TILE * strip.lines[i][strip.sides == side]).tolist()]
            if ways:
                out.append(f'<path class="{style}" d="{"".join(ways)}"/>')
    return "".join([*out, "</svg>"])


def _line(ends: Sequence[Sequence[float]], left: float) -> str:
    (x, y), (to_x, to_y) = ends
    return f"M{left + x:.1f} {y:.1f}L{left + to_x:.1f} {to_y:.1f}"
