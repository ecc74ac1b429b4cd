"""Documents lead to what is there, and each picture in them is made by a script."""

import re
from pathlib import Path

import pytest

from tools import make_pictures

ROOT = Path(__file__).resolve().parents[2]
IMAGES = sorted(path.name for path in (ROOT / "docs" / "images").iterdir())
PAGES = sorted(path.relative_to(ROOT).as_posix() for path in [ROOT / "README.md", *(ROOT / "docs").rglob("*.md")])
LARGEST = 2_000_000
"""Of all pictures together [bytes], beside the animated one, which may have as much."""


@pytest.mark.parametrize("name", PAGES)
def test_links_lead_to_files_that_are_there(name: str) -> None:
    page = ROOT / name
    targets = re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", page.read_text(encoding="utf-8"))
    lost = [target for target in targets if "://" not in target and not (page.parent / target).exists()]
    assert not lost


@pytest.mark.parametrize("name", IMAGES)
def test_each_picture_is_shown_and_made_by_a_script(name: str) -> None:
    shots = re.findall(r'"(\w+)": Shot\(', (ROOT / "tools" / "window_shots.py").read_text(encoding="utf-8"))
    assert name in {*make_pictures.PICTURES, *(f"panel_{shot}.png" for shot in shots)}
    shown = any(name in (ROOT / page).read_text(encoding="utf-8") for page in PAGES)
    assert shown or name.startswith("panel_"), "no page shows it"


def test_pictures_are_small() -> None:
    sizes = {path.name: path.stat().st_size for path in (ROOT / "docs" / "images").iterdir()}
    assert max(sizes.values()) < LARGEST
    assert sum(size for name, size in sizes.items() if not name.endswith(".gif")) < LARGEST
