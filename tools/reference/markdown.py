"""Markdown, as the pages of the reference are written in it."""

from collections.abc import Iterable, Sequence

NOTE = "<!-- Made from the code by `dev.py docs`: change the code, not this page. -->"


def page(title: str, *parts: str) -> str:
    """Return a page: its title, then its parts, of which empty ones are left out."""
    return "\n\n".join((NOTE, f"# {title}", *(part for part in parts if part))) + "\n"


def table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table; empty where there are no rows."""
    lines = [f"| {' | '.join(map(cell, row))} |" for row in rows]
    if not lines:
        return ""
    return "\n".join((f"| {' | '.join(heads)} |", f"| {' | '.join('---' for _ in heads)} |", *lines))


def cell(text: str) -> str:
    """Return a text that stays within one cell of a table."""
    return " ".join(text.split()).replace("|", "\\|")


def code(text: str) -> str:
    """Return a text as code; nothing for nothing."""
    return f"`{text}`" if text else ""


def sentence(text: str) -> str:
    """Return a text that begins with a capital letter."""
    return text[:1].upper() + text[1:]
