"""The reference pages of the documentation say what the code does."""

import json
from pathlib import Path

import pytest

from morph_retarget.blender.batch import results
from morph_retarget.blender.batch.jobs import Job
from morph_retarget.blender.batch.results import Answer, Result, Status
from morph_retarget.blender.cli import program
from morph_retarget.core import report
from morph_retarget.core.morph import measure
from morph_retarget.core.validation import cell, grid
from morph_retarget.core.validation.cell import Cell
from morph_retarget.core.validation.grid import Changes, Grid
from morph_retarget.core.verdicts.verdict import Found, Verdict
from tests.blender import window
from tools import make_reference
from tools.pictures import SAMPLES


def test_the_reference_is_as_the_code_is() -> None:
    with window.registered():
        stale = make_reference.stale()
    assert not stale, f"{', '.join(stale)}: run dev.py docs"


@pytest.mark.parametrize(
    ("command", "fields"),
    [
        (["retarget", str(SAMPLES / "walk_and_wave.bvh"), str(SAMPLES / "sprout.blend")], report.FIELDS),
        (["play", f"{SAMPLES / 'actions.blend'}#Wave by Hand", str(SAMPLES / "sprout.blend")], measure.FIELDS),
    ],
    ids=lambda value: value[0] if isinstance(value, list) else "",
)
def test_reports_have_the_fields_that_are_told(command: list[str], fields: dict[str, str], tmp_path: Path) -> None:
    written = tmp_path / "report.json"
    out = ["-o", str(tmp_path / "out.blend"), "--report", str(written), "--frames", "1:4"]
    assert program.main([*command, *out]) == 0
    (entry,) = json.loads(written.read_text(encoding="utf-8"))
    assert entry.keys() == fields.keys()


def test_a_grid_has_the_fields_that_are_told() -> None:
    judged = Cell("Wave", "Ann", {"slide": Verdict(Found(0.2, 3, "Foot"), 0.1, "leg lengths/s")})
    nothing: frozenset[tuple[str, str]] = frozenset()
    described = Grid([judged], changes=Changes("report.json", nothing, nothing, nothing, nothing)).described()
    assert described.keys() == grid.FIELDS.keys()
    assert described["cells"][0].keys() == cell.FIELDS.keys()
    assert described["cells"][0]["verdicts"]["slide"].keys() == cell.VERDICT_FIELDS.keys()


def test_a_batch_has_the_fields_that_are_told(tmp_path: Path) -> None:
    job = Job(tmp_path / "a.bvh", None, tmp_path / "b.glb", tmp_path / "c.glb", "c.glb", {}, ("a.bvh", "b.glb"))
    lost = Result(job, Answer(Status.CRASHED, "gone", log=["the last line"]))
    assert lost.described().keys() == results.FIELDS.keys()
