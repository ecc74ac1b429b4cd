"""The texts of the window that want translating, collected from what is registered and from the code of the panels.

``python -m tools.messages`` prints what each language lacks, and what it translates that is shown no more.
"""

import ast
import os
import sys
from collections.abc import Iterator
from pathlib import Path

import bpy

from morph_retarget.blender import registration, translations

UI = Path(registration.__file__).parent / "ui"
TEXTS = ("text", "heading", "placeholder")
"""Arguments of layouts that are shown."""
SAYING = {"say": 1, "told": 0}
"""Functions that translate a sentence, and which of their arguments it is."""
BASES = (
    bpy.types.Panel,
    bpy.types.Menu,
    bpy.types.Operator,
    bpy.types.PropertyGroup,
    bpy.types.UIList,
    bpy.types.KeyingSetInfo,
)


def main() -> int:
    """Print what is missing and what is stale; 1 if there is any."""
    registration.register("morph_retarget")
    try:
        wanted = collected()
    finally:
        registration.unregister()
    bad = False
    for code, messages in translations.LANGUAGES.items():
        missing, stale = sorted(wanted - messages.keys()), sorted(messages.keys() - wanted)
        bad |= bool(missing or stale)
        print(f"{code}: {len(wanted & messages.keys())} of {len(wanted)} texts")
        for text in (*(f"missing: {text}" for text in missing), *(f"stale: {text}" for text in stale)):
            print(f"  {text}")
    return int(bad)


def collected() -> set[str]:
    """Return all texts; the extension has to be registered."""
    found = {*registered(), *written()}
    return {text for text in found if sum(c.isalpha() for c in text) > 1}


def registered() -> Iterator[str]:
    """Return the labels of what is registered: panels, menus, operators, settings and their choices."""
    for cls in registration.CLASSES:
        if hasattr(cls, "bl_label"):
            yield cls.bl_label
        for prop in settings(cls):
            if not prop.is_hidden:
                yield prop.name
                yield from (item.name for item in prop.enum_items) if prop.type == "ENUM" else ()


def settings(cls: type) -> list[bpy.types.Property]:
    """Return what can be set on a registered class, as Blender knows it, without what all of its kind have."""
    found: bpy.types.bpy_prop_collection = cls.bl_rna.properties
    if issubclass(cls, bpy.types.Operator):
        module, name = cls.bl_idname.split(".")
        found = getattr(getattr(bpy.ops, module), name).get_rna_type().properties
    known = next(base for base in BASES if issubclass(cls, base)).bl_rna.properties.keys()
    return [prop for prop in found if prop.identifier not in known]


def written() -> Iterator[str]:
    """Return the texts that are written in the code of the panels."""
    for path in sorted(UI.glob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call):
                yield from _of_call(node)


def _of_call(call: ast.Call) -> Iterator[str]:
    given = {word.arg: word.value for word in call.keywords}
    if isinstance(call.func, ast.Name) and call.func.id in SAYING:
        yield from _constants(call.args[SAYING[call.func.id]])
    elif "translate" not in given:
        for name in TEXTS:
            if name in given:
                yield from _constants(given[name])


def _constants(value: ast.expr) -> Iterator[str]:
    """Return the texts that an expression may be: itself, or either branch of a choice."""
    if isinstance(value, ast.Constant) and isinstance(value.value, str):
        yield value.value
    elif isinstance(value, ast.IfExp):
        yield from _constants(value.body)
        yield from _constants(value.orelse)


if __name__ == "__main__":
    status = main()
    sys.stdout.flush()
    os._exit(status)  # Blender 4.5 as a module may block its end by a thread of its own
