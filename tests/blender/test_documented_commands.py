"""Commands and operators in the documents can be given as they are written."""

import re
import shlex
from collections.abc import Iterator
from pathlib import Path

import bpy
import pytest

from morph_retarget.blender.cli import program
from tests.blender import acting, scenes, window

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


def _scripts() -> Iterator[tuple[str, str]]:
    """Yield each piece of Python in a document, and the document's name."""
    for page in PAGES:
        for script in re.findall(r"```python\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL):
            yield page.name, script


@pytest.mark.usefixtures("registered")
@pytest.mark.parametrize(("page", "script"), [pytest.param(*found, id=found[0]) for found in _scripts()])
def test_documented_python_runs_in_a_file_that_has_what_it_names(page: str, script: str) -> None:
    scenes.walker()
    scenes.sprout("Hero").data.bones["Foot.L"].name = "ankle_l"
    fox = acting.creature("hound", "Fox")
    scenes.key(fox, "Run", {fox.pose.bones[0].path_from_id("location"): [[0.0, 0.0, 0.0], [0.0, 0.3, 0.0]]})
    acting.dip(scenes.figure("Ann"), acting.creature("hound")).name = "Wave"
    for name, data in (("Bird", None), ("Hill", bpy.data.meshes.new("Hill"))):
        bpy.context.scene.collection.objects.link(bpy.data.objects.new(name, data))
    exec(compile(script, page, "exec"), {"bpy": bpy})


def test_documented_operators_and_their_arguments_are_there() -> None:
    with window.registered():
        for page in PAGES:
            for name, given in re.findall(r"bpy\.ops\.morph_retarget\.([a-z_]+)\(([^)]*)\)", page.read_text("utf-8")):
                known = getattr(bpy.ops.morph_retarget, name).get_rna_type().properties
                lost = [word for word in re.findall(r"(\w+)=", given) if word not in known]
                assert not lost, (page.name, name)
