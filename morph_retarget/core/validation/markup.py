"""What pages about many results are made of: a style, tables of all results, and drawings; none needs a network."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from html import escape

from .drawing import Strip

TILE = 100
"""Side of a picture [units of the drawing]."""
STYLE = """
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
PASSED, FAILED, NONE = ("passed", "✓"), ("failed", "✗"), ("none", "·")
"""Looks of a square: its style and its sign."""


@dataclass(frozen=True)
class Square:
    """One result in the table of all."""

    look: tuple[str, str]
    told: str
    """Shown where the mouse rests on it."""
    link: str = ""
    """What it leads to on the page; empty for nothing."""


def opening(title: str) -> str:
    """Return how a page begins."""
    head = f'<meta charset="utf-8"><title>{escape(title)}</title><style>{STYLE}</style>'
    return f'<!doctype html>\n<html lang="en">{head}'


def table(rows: Sequence[str], columns: Sequence[str], squares: Mapping[tuple[str, str], Square]) -> Iterator[str]:
    """Yield the table of all results by the names of their rows and columns, each a link to what is told of it."""
    yield '<div class="scroll"><table class="map"><thead><tr><td>'
    yield "".join(f"<th>{escape(name)}" for name in columns)
    yield "</thead>"
    for row in rows:
        yield f"<tr><th>{escape(row)}"
        for column in columns:
            square = squares.get((row, column))
            if square is None:
                yield "<td>"
                continue
            style, sign = square.look
            text = f'<a href="#{square.link}">{sign}</a>' if square.link else sign
            yield f'<td class="{style}" title="{escape(square.told)}">{text}'
    yield "</table></div>"


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
