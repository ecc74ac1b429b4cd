"""Lists of the panels: how their rows are drawn, and the buttons beside them."""

# The stubs take every layout and every operator button for optional.
# pyright: reportOptionalMemberAccess=false, reportArgumentType=false

from typing import Any

import bpy


class Rows:
    """A list whose rows tell of their items alone."""

    @staticmethod
    def draw_row(layout: bpy.types.UILayout, item: Any, context: bpy.types.Context) -> None:
        """Draw the row of an item."""
        raise NotImplementedError

    def draw_item(
        self,
        context: bpy.types.Context,
        layout: bpy.types.UILayout,
        _data: Any,
        item: Any,
        _icon: int | None,
        _active_data: Any,
        _active_property: str | None,
        *_: Any,
    ) -> None:
        """Draw the row of an item; Blender calls this."""
        self.draw_row(layout, item, context)


def draw_list(
    layout: bpy.types.UILayout, kind: str, own: Any, items: str, active: str, rows: int = 3
) -> bpy.types.UILayout:
    """Draw a list and return the column beside it, for its buttons.

    Args:
        layout: Where.
        kind: Name of the class of the list.
        own: Settings that have the list.
        items: Name of the list in them.
        active: Name of the place of its chosen item in them.
        rows: How many are shown at least.
    """
    row = layout.row()
    row.template_list(kind, "", own, items, own, active, rows=rows)
    return row.column(align=True)


def draw_remove(buttons: bpy.types.UILayout, operator: str, offered: bool) -> Any:
    """Draw the button that takes the chosen item out of a list, and return it for its settings."""
    column = buttons.column(align=True)
    column.enabled = offered
    return column.operator(operator, text="", icon="REMOVE")


def chosen(items: Any, place: int) -> Any:
    """Return the chosen item of a list, None where there is none."""
    return items[place] if 0 <= place < len(items) else None
