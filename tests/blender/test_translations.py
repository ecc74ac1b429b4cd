"""The window in other languages: every text of the panels has its translation, and none is left over."""

import bpy
import pytest

from morph_retarget.blender import translations
from morph_retarget.blender.ui.tab import lines
from tests.blender import window
from tools import messages


@pytest.fixture(scope="module")
def texts() -> set[str]:
    """Return all texts that want translating."""
    with window.registered():
        return messages.collected()


@pytest.mark.parametrize("code", translations.LANGUAGES)
def test_every_text_is_translated_and_none_is_left_over(texts: set[str], code: str) -> None:
    told = translations.LANGUAGES[code].keys()
    what = f"in the table of {code}; `python -m tools.messages` prints all"
    missing, stale = sorted(texts - told), sorted(told - texts)
    assert not missing, f"missing {what}"
    assert not stale, f"stale {what}"


@pytest.mark.parametrize("code", translations.LANGUAGES)
def test_values_that_are_filled_in_are_the_same_in_all_languages(code: str) -> None:
    for text, told in translations.LANGUAGES[code].items():
        assert told.strip(), text
        assert sorted(_fields(text)) == sorted(_fields(told)), text


def _fields(text: str) -> list[str]:
    return [part.partition("}")[0] for part in text.split("{")[1:]]


def test_texts_of_panels_are_found_wherever_they_stand(texts: set[str]) -> None:
    label, button, heading, sentence, choice, setting = (
        "Place Among Its Kind",
        "Add Selected",
        "Relative To",
        "Source and target are the same armature",
        "Creature Size",
        "Foot Roll",
    )
    assert {label, button, heading, sentence, choice, setting} <= texts
    assert "ARMATURE_DATA" not in texts, "icons are not shown as texts"


def test_blender_takes_the_tables_and_forgets_them() -> None:
    for _ in range(2):
        with window.registered():
            assert bpy.app.translations.pgettext("Retarget") == "Retarget", "the window speaks English"


def test_lines_break_between_words_and_wide_letters_anywhere() -> None:
    assert lines("a short sentence in English", 12) == ["a short", "sentence in", "English"]
    broken = lines("動いているアーマチュアを選ぶ", 10)
    assert "".join(broken) == "動いているアーマチュアを選ぶ"
    assert max(map(len, broken)) == 5
