"""Recipes of the starter library against the acts that they are written from."""

from morph_retarget.core.directing.recipes.shelf import FOLDER
from tools import make_recipes


def test_the_files_are_what_the_script_writes() -> None:
    written = make_recipes.texts()
    assert {path.name for path in FOLDER.glob("*.json")} == set(written)
    for name, text in written.items():
        assert (FOLDER / name).read_text(encoding="utf-8") == text
