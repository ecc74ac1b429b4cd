"""What the panels of the Morph Retarget tab share."""

# The stubs take every layout for optional.
# pyright: reportOptionalMemberAccess=false

import textwrap
from typing import Any

import bpy


class InTab:
    """Where the panels are."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Morph Retarget"


def split_layout(panel: Any) -> bpy.types.UILayout:
    """Return a panel's layout with names beside the fields."""
    layout = panel.layout
    layout.use_property_split = True
    layout.use_property_decorate = False
    return layout


def say(layout: bpy.types.UILayout, text: str, icon_name: Any, context: bpy.types.Context) -> None:
    """Write a sentence in as many lines as the sidebar needs."""
    width = context.region.width if context.region is not None else 300
    column = layout.column(align=True)
    column.scale_y = 0.8
    for i, line in enumerate(textwrap.wrap(text, max(int(width / 8), 20))):
        column.label(text=line, icon=icon_name if i == 0 else "BLANK1", translate=False)
