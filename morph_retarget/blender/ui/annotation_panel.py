"""The panel of annotations: what is known of an action as a base motion, in our tab and in the Action editor."""

# The stubs take every layout and every operator button for optional.
# pyright: reportOptionalMemberAccess=false, reportArgumentType=false

import bpy

from ..directing import annotations
from ..directing.annotations import STROKES
from ..morph import definitions
from ..operators.annotations import action_in_hand
from .tab import InTab, split_layout, told

_FIRST = ("kind", "style", "phase", "cycle", "side", "parts")
_MOTION = ("speed", "turn_rate", "direction")


def _action(context: bpy.types.Context) -> bpy.types.Action | None:
    """Return the action that can be annotated: an ordinary one that moves bones."""
    found = action_in_hand(context)
    return None if found is None or definitions.is_generalized(found) else found


class _Annotations:
    """What both places show."""

    bl_label = "Annotations"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Return whether there is an action to annotate."""
        return _action(context) is not None

    def draw(self, context: bpy.types.Context) -> None:
        """Draw what is known, and what finds it."""
        action = _action(context)
        if action is None:
            return
        layout, own = split_layout(self), annotations.of_action(action)
        row = layout.row(align=True)
        row.operator_context = "INVOKE_DEFAULT"
        row.operator("morph_retarget.find_annotations", icon="VIEWZOOM")
        if own.is_annotated:
            row.operator("morph_retarget.clear_annotations", text="", icon="X").action = action.name
        column = layout.column()
        for name in _FIRST if own.is_annotated else _FIRST[:1]:
            column.prop(own, name)
        if not own.is_annotated:
            return
        column = layout.column(align=True)
        for name in _MOTION:
            column.prop(own, name)
        if len(own.places):
            layout.label(text="Place Among Its Kind")
        column = layout.column(align=True)
        for place in own.places:
            column.prop(place, "value", text=place.name.replace("_", " ").capitalize(), translate=False)
        layout.prop(own, "is_gesture")
        column = layout.column(align=True)
        for name in STROKES if own.is_gesture else ():
            column.prop(own, name)
        steps = sum(annotations.is_strike(marker.name) for marker in action.pose_markers)
        text = told("{count} steps told by pose markers", count=steps)
        layout.label(text=text, icon="MARKER_HLT", translate=False)


class MORPHRETARGET_PT_annotations(_Annotations, InTab, bpy.types.Panel):
    bl_idname = "MORPHRETARGET_PT_annotations"


class MORPHRETARGET_PT_action_annotations(_Annotations, bpy.types.Panel):
    bl_idname = "MORPHRETARGET_PT_action_annotations"
    bl_space_type = "DOPESHEET_EDITOR"
    bl_region_type = "UI"
    bl_category = "Action"


CLASSES = (MORPHRETARGET_PT_annotations, MORPHRETARGET_PT_action_annotations)
