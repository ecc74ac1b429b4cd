"""The page for developers leads to files that are there, and its drawing is what the script draws."""

import re
from pathlib import Path

from tools import house

ROOT = Path(__file__).resolve().parents[2]


def test_the_table_of_the_house_leads_to_files_that_are_there() -> None:
    text = (ROOT / "docs" / "house.md").read_text(encoding="utf-8").partition("## Where to look")[2]
    lost: list[str] = []
    for row in re.findall(r"^\|[^|]*\|(.*)\|$", text, re.MULTILINE):
        known = {ROOT, ROOT / "morph_retarget"}
        for name in re.findall(r"`([\w/.]+)`", row):
            found = [folder / name for folder in known if (folder / name).exists()]
            known |= {above for path in found for above in (path, *path.parents) if above.is_relative_to(ROOT)}
            lost += [] if found else [name]
    assert not lost


def test_each_box_of_the_drawing_is_there() -> None:
    base = ROOT / "morph_retarget"
    for kind, _, boxes in house.ROWS:
        for name in (word for names, _ in boxes for word in names.split()):
            below = "core" if kind == "core" else "blender"
            assert any((base / below / f"{name}{end}").exists() for end in ("", ".py")), name


def test_the_drawing_is_what_the_script_draws() -> None:
    assert house.PATH.read_text(encoding="utf-8") == house.drawing(), "run tools.house"
