"""The panel of a channel's values on the active character, and of their keys."""

# The stubs take every layout and every operator button for optional.
# pyright: reportOptionalMemberAccess=false, reportArgumentType=false

from typing import Any

import bpy
import numpy as np

from ...core.arrays import Array
from ..actions import CurveMap
from ..morph import keys, tracks
from ..morph.properties import MORPHRETARGET_PG_channel
from ..properties import of_rig
from .channel_panels import OfChannel, shown, values_shown
from .tab import split_layout, told


class MORPHRETARGET_PT_values(OfChannel, bpy.types.Panel):
    bl_idname = "MORPHRETARGET_PT_values"
    bl_label = "Values and Keys"

    def draw(self, context: bpy.types.Context) -> None:
        draw_values(self, context)


def draw_values(panel: bpy.types.Panel, context: bpy.types.Context) -> None:
    """Draw the values of the active channel on the active character, and what keys them."""
    layout, (ob, action, item) = split_layout(panel), shown(context)
    values = values_shown(ob, item)
    if values is None:
        return
    assert context.scene is not None, "the viewport shows a scene"
    frame, found = context.scene.frame_current_final, keys.curves(action)
    column = layout.column()
    vectors = (("position", "XYZ", told("Position {axis}")), ("rotation", "WXYZ", told("Rotation {axis}")))
    for part, axes, title in vectors:
        column.active = getattr(item, f"poses_{part}")
        row = column.row(align=True)
        fields = row.column(align=True)
        for i, axis in enumerate(axes):
            fields.prop(values, part, index=i, text=title.format(axis=axis) if i == 0 else axis, translate=False)
        _draw_key(row, ob, item, part, _key_icon(found, keys.path(item.name, part), frame))
        column = layout.column()
    row = column.row(align=True)
    row.prop(values, "weight")
    _draw_key(row, ob, item, "weight", _key_icon(found, keys.path(item.name, "weight"), frame))
    for deform in values.deforms:
        row = column.row(align=True)
        row.prop(deform, "value", text=deform.name, translate=False)
        row.operator("morph_retarget.remove_deform", text="", icon="X", emboss=False).name = deform.name
        _draw_key(row, ob, item, "deforms", _key_icon(found, keys.deform_path(item.name, deform.name), frame))
    _draw_buttons(layout, ob, item, context.object)


def _draw_buttons(
    layout: bpy.types.UILayout,
    ob: bpy.types.Object,
    item: MORPHRETARGET_PG_channel,
    active: bpy.types.Object | None,
) -> None:
    """Draw what acts on the whole channel."""
    row = layout.row(align=True)
    key = row.operator("morph_retarget.key_channel", text="Key", icon="KEYINGSET")
    rest = row.operator("morph_retarget.rest_channel", text="Rest", icon="LOOP_BACK")
    for button in (key, rest):
        button.character, button.channel = ob.name, item.name
    row.operator("morph_retarget.add_deform", text="Deform", icon="ADD").channel = item.name
    layout.prop_search(of_rig(ob).channels[item.name], "active_body", ob.data, "bones", icon="BONE_DATA")
    if active is not None and of_rig(active).stands_for is not None:
        layout.operator("morph_retarget.finish_specialized", icon="CHECKMARK").stand_in = active.name
        return
    button = layout.operator("morph_retarget.edit_specialized", icon="FCURVE")
    button.character, button.channel = ob.name, item.name


def _key_icon(found: CurveMap, path: str, frame: float) -> Any:
    """Return the icon that says whether a property is keyed, at this frame or at others.

    Blender's own signs beside its fields look for curves by an item's number and do not see those by its name.
    """
    own = [curve for i in range(4) if (curve := found.get((path, i))) is not None]
    times = np.concatenate([np.empty(0), *(_times(curve) for curve in own)])
    if len(times) and np.abs(times - frame).min() < tracks.SAME:
        return "DECORATE_KEYFRAME"
    return "DECORATE_ANIMATE" if own else "DECORATE"


def _times(curve: bpy.types.FCurve) -> Array:
    buffer = np.empty(2 * len(curve.keyframe_points), dtype=np.float32)
    curve.keyframe_points.foreach_get("co", buffer)
    return buffer[::2].astype(np.float64)


def _draw_key(
    layout: bpy.types.UILayout, ob: bpy.types.Object, item: MORPHRETARGET_PG_channel, part: str, icon: Any
) -> None:
    """Draw the button beside a value that keys it."""
    button = layout.operator("morph_retarget.key_channel", text="", icon=icon, emboss=False)
    button.character, button.channel = ob.name, item.name
    for name in (*keys.PARTS, "deforms"):
        setattr(button, name, name == part)


CLASSES = (MORPHRETARGET_PT_values,)
