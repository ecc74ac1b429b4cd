"""The window in other languages: one table for each, from the English text to its translation."""

import bpy

from . import chinese, japanese

LANGUAGES: dict[str, dict[str, str]] = {"ja_JP": japanese.MESSAGES, "zh_HANS": chinese.MESSAGES}
"""Tables by Blender's code of the language."""
OWN = "Morph Retarget"
"""A context in which Blender itself has no words: its "Characters" are letters."""
CONTEXTS = ("*", "Operator", OWN)
"""Blender looks for labels of operators in a context of their own; ours mean the same in all."""

_OWNER = "morph_retarget"
"""Under which Blender keeps the tables."""


def tables() -> dict[str, dict[tuple[str, str], str]]:
    """Return the tables as Blender takes them."""
    return {
        code: {(context, text): told for text, told in messages.items() for context in CONTEXTS}
        for code, messages in LANGUAGES.items()
    }


def attach() -> None:
    """Let Blender know the tables."""
    bpy.app.translations.register(_OWNER, tables())  # type: ignore[arg-type]  # the stubs want another form


def detach() -> None:
    """Let Blender forget them."""
    bpy.app.translations.unregister(_OWNER)
