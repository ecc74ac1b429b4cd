"""Validation grids: pass rates, comparisons, samples, and how cells are drawn and told."""

import json
from dataclasses import replace
from functools import cache
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from morph_retarget.core import quat
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.errors import FileError
from morph_retarget.core.skeleton import pose_from_basis
from morph_retarget.core.validation import drawing, grid, raster
from morph_retarget.core.validation.cell import Cell, Status
from morph_retarget.core.validation.drawing import Strip
from morph_retarget.core.validation.grid import Grid
from morph_retarget.core.validation.page import page
from morph_retarget.core.verdicts.performance import Performance
from morph_retarget.core.verdicts.verdict import Found, Verdict
from tests.skeletons import skeleton_of
from tools.figure import humanoid

FRAMES = 49


@cache
def _performance() -> Performance:
    character = analyze(skeleton_of(humanoid()))
    count = len(character.skeleton)
    shift = np.zeros((FRAMES, count, 3))
    shift[:, 0, 1] = -np.linspace(0.0, 5.0, FRAMES)
    pose = pose_from_basis(character.skeleton, quat.identity(FRAMES, count), shift)
    return Performance.of_pose(character, 0, pose, 1.0 / 24.0)


def _strip(*wrong: int) -> Strip:
    return drawing.strip_of(_performance(), wrong)


def _cell(action: str, character: str, value: float = 0.0) -> Cell:
    verdicts = {"slide": Verdict(Found(value, 20, "leftFoot"), 0.1, "leg lengths/s")}
    return Cell(action, character, verdicts, first=1.0, frames=FRAMES, strip=_strip(20) if value else _strip())


def _cells() -> list[Cell]:
    return [
        _cell("Wave", "Ann"),
        _cell("Wave", "<Bob>", 0.5),
        Cell("Bow", "Ann", problems=("it lacks a mouth",), applies=False),
        Cell("Bow", "<Bob>", error="<Bob>: is no rig"),
    ]


# --- counting ---


def test_cells_that_do_not_apply_count_neither_way() -> None:
    own = Grid(_cells())
    assert [own.count(status) for status in Status] == [1, 2, 1]
    assert own.pass_rate == pytest.approx(1.0 / 3.0)
    assert own.by_verdict == {"slide": 1, "error": 1}
    assert Grid([_cells()[2]]).pass_rate is None


def test_what_fails_comes_first() -> None:
    assert [cell.status for cell in Grid(_cells()).ordered] == [
        Status.FAILED, Status.FAILED, Status.PASSED, Status.NOT_FOR_IT,
    ]  # fmt: skip


def test_a_grid_is_told_as_plain_data() -> None:
    told = json.loads(json.dumps(Grid(_cells(), {"fps": 24.0}, "1.0").described()))
    assert (told["version"], told["settings"]) == ("1.0", {"fps": 24.0})
    assert (told["passed"], told["failed"], told["does_not_apply"]) == (1, 2, 1)
    first = told["cells"][0]
    assert (first["action"], first["character"], first["status"]) == ("Wave", "<Bob>", "failed")
    assert first["verdicts"]["slide"] == {
        "value": 0.5, "limit": 0.1, "unit": "leg lengths/s", "passed": False, "where": "leftFoot", "frame": 21.0,
    }  # fmt: skip


def test_a_value_that_cannot_be_measured_is_no_number() -> None:
    told = replace(_cell("Wave", "Ann"), verdicts={"slide": Verdict(Found(np.nan), 0.1, "")}).described()
    assert told["status"] == "failed"
    assert told["verdicts"]["slide"]["value"] is None


# --- comparing ---


def test_regressions_come_before_what_is_mended_and_that_before_the_rest(tmp_path: Path) -> None:
    before = [_cell("Wave", "Ann"), _cell("Wave", "Bob", 0.5), _cell("Wave", "Cid", 0.5), _cell("Wave", "Dan")]
    path = tmp_path / "report.json"
    path.write_text(json.dumps(Grid(before).described()))
    now = [_cell("Wave", "Ann", 0.5), _cell("Wave", "Bob"), _cell("Wave", "Cid", 0.5), _cell("Wave", "Eve")]
    changes = grid.changes_since(path, now)
    assert changes.regressions == {("Wave", "Ann")}
    assert changes.mended == {("Wave", "Bob")}
    assert (changes.new, changes.gone) == ({("Wave", "Eve")}, {("Wave", "Dan")})
    own = Grid([*reversed(now)], changes=changes)
    assert [cell.character for cell in own.ordered] == ["Ann", "Bob", "Cid", "Eve"]
    assert own.described()["compared"]["regressions"] == [["Wave", "Ann"]]


@pytest.mark.parametrize("text", [None, "no json", "[]", '{"cells": [{"action": "Wave"}]}'])
def test_what_is_no_report_is_refused(tmp_path: Path, text: str | None) -> None:
    path = tmp_path / "report.json"
    if text is not None:
        path.write_text(text)
    with pytest.raises(FileError, match=r"report\.json.*give the report\.json of an earlier run"):
        grid.earlier(path)


# --- sampling ---


def test_a_sample_is_the_same_for_the_same_seed_and_keeps_the_order() -> None:
    every = [(i, j) for i in range(20) for j in range(30)]
    one, same, other = (grid.sampled(every, 50, seed) for seed in (3, 3, 4))
    assert one == same
    assert one != other
    assert len(set(one)) == 50
    assert one == sorted(one)
    assert grid.sampled(every, 1000, 3) == every


# --- drawing ---


def test_pictures_go_from_the_first_frame_to_the_last_and_show_what_is_wrong() -> None:
    assert drawing.chosen(FRAMES).tolist() == [0, 10, 19, 29, 38, 48]
    assert drawing.chosen(FRAMES, {21}).tolist() == [0, 10, 21, 29, 38, 48]
    assert set(drawing.chosen(FRAMES, range(9)).tolist()) <= set(range(9))
    assert drawing.chosen(1).tolist() == [0]
    assert _strip(20).marked.tolist() == [False, False, True, False, False, False]


def test_a_body_stays_in_its_pictures_however_far_it_goes() -> None:
    strip = _strip()
    assert strip.lines.min() >= 0.0
    assert strip.lines.max() <= 1.0
    np.testing.assert_allclose(strip.lines, strip.lines[:1].repeat(len(strip.lines), axis=0), atol=1e-9)
    feet = strip.lines[0, strip.sides != 0, :, 1].max()
    assert feet == pytest.approx(strip.floors[0], abs=0.05), "feet stand on the ground"


def test_left_and_right_are_told_apart() -> None:
    assert set(_strip().sides.tolist()) == {-1, 0, 1}


def test_a_line_covers_its_pixels() -> None:
    image = np.ones((20, 20, 3))
    raster.draw(image, np.array([[[2.0, 10.0], [18.0, 10.0]]]), (0.0, 0.0, 0.0), 2.0)
    np.testing.assert_allclose(image[9:11, 5:15], 0.0)
    np.testing.assert_allclose(image[:8], 1.0)
    np.testing.assert_allclose(image[12:], 1.0)


def test_a_line_may_leave_the_image() -> None:
    image = np.ones((8, 8, 3))
    raster.draw(image, np.array([[[-5.0, -5.0], [20.0, 20.0]], [[30.0, 30.0], [40.0, 40.0]]]), (0.0, 0.0, 0.0), 1.0)
    assert image[4, 4].max() < 0.5


# --- the page ---


class _Reader(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.links: list[str] = []
        self.ids: list[str] = []
        self.loaded: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        own = dict(attrs)
        self.links += [own["href"] or ""] if tag == "a" else []
        self.ids += [own["id"] or ""] if "id" in own else []
        self.loaded += [own["src"] or ""] if "src" in own else []
        self.loaded += ["link"] if tag in {"link", "script", "iframe"} else []


def test_the_page_needs_nothing_else_and_its_links_lead_somewhere() -> None:
    text = page(Grid(_cells()))
    reader = _Reader()
    reader.feed(text)
    assert not reader.loaded
    assert "http" not in text
    assert {link.removeprefix("#") for link in reader.links} == set(reader.ids)
    assert len(reader.ids) == 3, "a cell that does not apply has nothing to show"


def test_the_page_shows_failing_cells_first_and_names_as_they_are() -> None:
    text = page(Grid(_cells()))
    assert "33.3 % of 3 cells pass" in text
    assert text.index("Failed (2)") < text.index("Passed (1)")
    assert "&lt;Bob&gt;" in text
    assert "<Bob>" not in text
    assert "leftFoot at frame 21" in text
