"""The page on troubleshooting quotes what the program really says."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "troubleshooting.md"


def _said() -> Iterator[str]:
    """Yield all texts in the code, with an ellipsis for what is filled in."""
    for path in sorted((ROOT / "morph_retarget").rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.JoinedStr):
                yield "".join(str(v.value) if isinstance(v, ast.Constant) else "…" for v in node.values)
            elif isinstance(node, ast.Constant) and isinstance(node.value, str):
                yield node.value


def _quoted() -> list[str]:
    """Return what the page quotes: its quotations, and code in the first column of its tables."""
    text = PAGE.read_text(encoding="utf-8")
    lines = [match[1] for match in re.finditer(r"^> (.*)$", text, re.MULTILINE)]
    cells = [match[1] for match in re.finditer(r"^\| `([^`]*)` \|", text, re.MULTILINE)]
    return [*lines, *cells]


def test_each_message_on_the_page_is_said_by_the_program() -> None:
    said = "\n".join(_said())
    parts = {part.strip(" :(") for quoted in _quoted() for part in quoted.split("…")}
    lost = sorted(part for part in parts if len(part) > 8 and part not in said)
    assert not lost
    assert len(_quoted()) > 20
