"""A user changes the language, and the panels speak it."""

from collections.abc import Iterator

import bpy

from morph_retarget.blender.translations import LANGUAGES
from morph_retarget.blender.ui.tab import told
from tests.window.hand import Hand

OURS, THEIRS = "Retarget", "Characters"


def path(hand: Hand) -> Iterator[None]:
    """Play it."""
    view = bpy.context.preferences.view
    assert bpy.app.translations.pgettext_iface(OURS) == OURS
    for code, messages in LANGUAGES.items():
        assert code in bpy.app.translations.locales, f"Blender knows no language {code}"
        view.language = code
        yield
        for context in ("*", "Operator"):
            assert bpy.app.translations.pgettext_iface(OURS, context) == messages[OURS]
        assert told(THEIRS) == messages[THEIRS], "the word that Blender has means something else"
        hand.point_at()
        yield
    view.language = "en_US"
    yield
