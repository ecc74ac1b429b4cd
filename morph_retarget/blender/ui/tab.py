"""What the panels of the Morph Retarget tab share."""

# The stubs take every layout for optional.
# pyright: reportOptionalMemberAccess=false

import textwrap
import unicodedata
from typing import Any

import bpy

from .. import translations
from ..morph import query


class InTab:
    """Where the panels are."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Morph Retarget"


class OfCharacter(InTab):
    """What panels about the active armature share; they are closed to begin with."""

    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Return whether there is one."""
        return query.active_character(context) is not None


def split_layout(panel: Any) -> bpy.types.UILayout:
    """Return a panel's layout with names beside the fields."""
    layout = panel.layout
    layout.use_property_split = True
    layout.use_property_decorate = False
    return layout


def say(layout: bpy.types.UILayout, text: str, icon_name: Any, context: bpy.types.Context) -> None:
    """Write a sentence, in the language of the window, in as many lines as the sidebar needs."""
    width = context.region.width if context.region is not None else 300
    column = layout.column(align=True)
    column.scale_y = 0.8
    for i, line in enumerate(lines(told(text), max(int(width / 8), 20))):
        column.label(text=line, icon=icon_name if i == 0 else "BLANK1", translate=False)


def told(text: str, **values: object) -> str:
    """Return a text in the language of the window, with values filled in."""
    found = bpy.app.translations.pgettext_iface(text, translations.OWN)
    return found.format(**values) if values else found


def lines(text: str, width: int) -> list[str]:
    """Break a text into lines; East Asian letters are twice as wide as others, and may be parted anywhere."""
    if not any(_is_wide(letter) for letter in text):
        return textwrap.wrap(text, width)
    out, used = [""], 0
    for letter in text:
        own = 1 + _is_wide(letter)
        if used + own > width:
            out.append("")
            used = 0
        out[-1] += letter
        used += own
    return out


def _is_wide(letter: str) -> bool:
    return unicodedata.east_asian_width(letter) in "WF"
