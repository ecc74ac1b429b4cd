"""Commands and operators in the documents can be given as they are written."""

import re
import shlex
from collections.abc import Iterator
from pathlib import Path

import bpy
import pytest

from morph_retarget.blender.cli import program
from tests.blender import window

ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")), ROOT / "sample_blends" / "jobs.toml"]


def _commands() -> Iterator[tuple[str, str]]:
    """Yield each command of the program in a document, and the document's name."""
    for page in PAGES:
        text = page.read_text(encoding="utf-8").replace("\\\n", " ")
        for line in re.findall(r"python -m morph_retarget (.*)$", text, re.MULTILINE):
            if not line.startswith("COMMAND"):
                yield page.name, line.rstrip("`")


@pytest.mark.parametrize(("page", "line"), [pytest.param(*found, id=" ".join(found)[:80]) for found in _commands()])
def test_a_documented_command_is_understood(page: str, line: str) -> None:
    words = shlex.split(line.split(" # ")[0].split(" > ")[0])
    asked = program.parser().parse_args(words)
    assert callable(asked.run), page


def test_there_are_documented_commands() -> None:
    assert len(list(_commands())) > 20


def test_documented_operators_and_their_arguments_are_there() -> None:
    with window.registered():
        for page in PAGES:
            for name, given in re.findall(r"bpy\.ops\.morph_retarget\.([a-z_]+)\(([^)]*)\)", page.read_text("utf-8")):
                known = getattr(bpy.ops.morph_retarget, name).get_rna_type().properties
                lost = [word for word in re.findall(r"(\w+)=", given) if word not in known]
                assert not lost, (page.name, name)
