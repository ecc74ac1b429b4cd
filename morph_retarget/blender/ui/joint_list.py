"""The list of joints: sure, doubtful or missing, each with the bone that plays it."""

# The stubs take every layout and every operator button for optional.
# pyright: reportOptionalMemberAccess=false, reportArgumentType=false

import re
from typing import Any

import bpy

from ...core.character.joints import FINGER_JOINTS
from ..properties import of_rig
from ..rig import armature_of
from ..rig_properties import MORPHRETARGET_PG_joint
from .lists import Rows

SURE = 0.8
"""Confidence from which on a joint is not marked as doubtful."""
REQUIRED = frozenset(
    ["hips", "spine", "head"]
    + [side + joint for side in ("left", "right") for joint in ("UpperArm", "LowerArm", "Hand")]
    + [side + joint for side in ("left", "right") for joint in ("UpperLeg", "LowerLeg", "Foot")]
)
"""Joints that every humanoid has by VRM 1.0."""
WIDE = 340
"""From this width of the sidebar on, bones are fields in the list [pixels]; below it they are chosen beneath."""


def label(joint: str) -> str:
    """Return a joint's name for people: "Upper Arm L", short enough for a narrow sidebar."""
    words = re.sub(r"(?<!^)(?=[A-Z])", " ", joint).title()
    side, _, rest = words.partition(" ")
    return f"{rest} {side[0]}" if side in ("Left", "Right") else words


def icon(joint: MORPHRETARGET_PG_joint) -> Any:
    """Return the icon that tells how sure a joint is."""
    if not joint.bone:
        return "ERROR" if joint.name in REQUIRED and joint.by != "user" else "RADIOBUT_OFF"
    if joint.by in ("user", "preset"):
        return "USER"
    return "CHECKMARK" if joint.confidence >= SURE else "QUESTION"


def _is_wide(context: bpy.types.Context) -> bool:
    """Return whether fields in the list are wide enough to read what they hold."""
    if context.region is None or context.preferences is None:
        return True
    return context.region.width >= WIDE * (context.preferences.system.ui_scale or 1.0)


class MORPHRETARGET_UL_joints(Rows, bpy.types.UIList):
    """Joints with their bones."""

    bl_idname = "MORPHRETARGET_UL_joints"

    show_fingers: bpy.props.BoolProperty(name="Fingers", description="List the joints of the fingers too")
    show_missing: bpy.props.BoolProperty(
        name="Missing", description="List joints that the rig does not have too", default=True
    )

    @staticmethod
    def draw_row(layout: bpy.types.UILayout, item: Any, context: bpy.types.Context) -> None:
        split = layout.split(factor=0.54)
        split.label(text=label(item.name), icon=icon(item), translate=False)
        if _is_wide(context):
            split.prop_search(item, "bone", armature_of(item.id_data), "bones", text="")
        else:
            split.label(text=item.bone, translate=False)

    def draw_filter(self, _context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        row = layout.row(align=True)
        row.prop(self, "filter_name", text="")
        row.prop(self, "show_fingers", toggle=True)
        row.prop(self, "show_missing", toggle=True)

    def filter_items(self, _context: bpy.types.Context, data: Any, _property: str) -> tuple[list[int], list[int]]:
        wanted = self.filter_name.lower()
        flags = [
            self.bitflag_filter_item
            if (self.show_fingers or joint.name not in FINGER_JOINTS)
            and (self.show_missing or joint.bone)
            and (wanted in label(joint.name).lower() or wanted in joint.bone.lower())
            else 0
            for joint in of_rig(data.id_data).joints
        ]
        return flags, []


class MORPHRETARGET_UL_contacts(Rows, bpy.types.UIList):
    """Intervals in which feet stand."""

    bl_idname = "MORPHRETARGET_UL_contacts"

    @staticmethod
    def draw_row(layout: bpy.types.UILayout, item: Any, _context: bpy.types.Context) -> None:
        split = layout.split(factor=0.5)
        split.label(text=item.name, translate=False)
        row = split.row(align=True)
        row.prop(item, "start", text="", emboss=False)
        row.prop(item, "end", text="", emboss=False)


CLASSES = (MORPHRETARGET_UL_joints, MORPHRETARGET_UL_contacts)
