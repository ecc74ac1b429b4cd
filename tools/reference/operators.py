"""Operators, from what Blender knows about them."""

from collections.abc import Iterator
from typing import Any

import bpy

from morph_retarget.blender import operators as ours

from .markdown import code, page, table

_PREFIX = "morph_retarget."
_INTRODUCTION = """
All that buttons do, scripts can do: `bpy.ops.morph_retarget.NAME(…)`. Arguments that are left out are taken from what
is chosen in the window. An operator that cannot do its work raises `RuntimeError` with the line that the window would
show; each is one step of undo. `F3` finds them by the names in bold.
"""


def operators() -> str:
    """Return the page of all operators."""
    found = sorted((cls for cls in ours.CLASSES if hasattr(cls, "bl_idname")), key=lambda cls: cls.bl_idname)
    own = [cls for cls in found if cls.bl_idname.startswith(_PREFIX)]
    return page("Operators", _INTRODUCTION.strip(), *(part for cls in own for part in _operator(cls)))


def _operator(cls: Any) -> Iterator[str]:
    name = cls.bl_idname.removeprefix(_PREFIX)
    rna = getattr(bpy.ops.morph_retarget, name).get_rna_type()
    own = [p for p in rna.properties if p.identifier != "rna_type" and not p.is_hidden]
    yield f"## `{name}`\n\n**{cls.bl_label}.** {_told(cls)}"
    yield table(("argument", "usual", "meaning"), ((code(p.identifier), _usual(p), _meaning(p)) for p in own))


def _told(cls: Any) -> str:
    text = " ".join((getattr(cls, "bl_description", "") or cls.__doc__ or "").split())
    return text if not text or text.endswith(".") else f"{text}."


def _usual(own: Any) -> str:
    if own.type in {"POINTER", "COLLECTION"}:
        return ""
    if own.type == "ENUM":
        return code(repr(own.default)) if own.default else ""
    if own.type == "FLOAT" and not own.is_array:
        return code(f"{own.default:g}")
    return "" if getattr(own, "is_array", False) else code(repr(own.default))


def _meaning(own: Any) -> str:
    text = own.description or own.name
    items = [item.identifier for item in own.enum_items_static] if own.type == "ENUM" else []
    return f"{text}: {', '.join(code(item) for item in items)}" if items else text
