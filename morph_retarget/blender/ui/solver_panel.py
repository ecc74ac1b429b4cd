"""The panel of the solver: a few switches, settings of single limbs, and fine tuning."""

# The stubs take every layout and every operator button for optional.
# pyright: reportOptionalMemberAccess=false, reportArgumentType=false

from typing import Any

import bpy

from ..morph import cast, query
from ..properties import of_rig
from .lists import Rows, chosen, draw_list, draw_remove
from .tab import InTab, split_layout

SWITCHES = ("bends_spine", "allows_stretch", "avoids_collisions", "keeps_above_ground", "use_joint_limits")
"""Properties of a character that are shown first."""
OF_LIMBS = ("swivel", "pull", "spine_start", "slow_down", "full_reach", "softness", "outer_iterations")
OF_ALL = ("slow_down", "full_reach", "softness", "outer_iterations", "nudge", "footing")
FOR_SPINE = ("pull", "spine_start", "twist", "anti_buckling", "spine_shrink", "refinements")
FOR_COLLISIONS = ("margin", "most_swivel")


def _ends(ob: bpy.types.Object) -> list[str]:
    """Return the bones at the ends of the limbs that a character's action poses."""
    member = query.member_now(ob)
    return [] if member is None else [member.bodies.names[body] for body in member.part.pose.ends]


def _draw_settings(layout: bpy.types.UILayout, ob: bpy.types.Object, own: Any, names: tuple[str, ...]) -> None:
    """Draw settings, grey where what they are for is switched off."""
    character, column = of_rig(ob), layout.column()
    for name in names:
        row = column.row()
        if name in FOR_SPINE:
            row.active = character.bends_spine
        if name in FOR_COLLISIONS:
            row.active = character.avoids_collisions
        row.prop(own, name)


class MORPHRETARGET_UL_limb_settings(Rows, bpy.types.UIList):
    """Limbs that have settings of their own."""

    bl_idname = "MORPHRETARGET_UL_limb_settings"

    @staticmethod
    def draw_row(layout: bpy.types.UILayout, item: Any, _context: bpy.types.Context) -> None:
        ob, known = item.id_data, item.name in item.id_data.pose.bones
        row = layout.row()
        row.active = item.name in _ends(ob)
        row.label(text=item.name, icon="CON_KINEMATIC" if known else "ERROR", translate=False)
        row.label(text="" if row.active else ("Not Posed" if known else "No Bone"))


class MORPHRETARGET_MT_limbs(bpy.types.Menu):
    bl_idname = "MORPHRETARGET_MT_limbs"
    bl_label = "Limbs"

    def draw(self, context: bpy.types.Context) -> None:
        layout, ob = self.layout, query.active_character(context)
        own = of_rig(ob).solver.limbs if ob is not None else {}
        names = [name for name in _ends(ob) if name not in own] if ob is not None else []
        for name in names:
            button = layout.operator(
                "morph_retarget.add_limb_settings", text=name, icon="CON_KINEMATIC", translate=False
            )
            button.character, button.bone = ob.name, name
        if not names:
            layout.label(text="No other limbs are posed")


class MORPHRETARGET_PT_solver(InTab, bpy.types.Panel):
    bl_idname = "MORPHRETARGET_PT_solver"
    bl_parent_id = "MORPHRETARGET_PT_generalized"
    bl_label = "Solver"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        ob = query.active_character(context)
        return ob is not None and cast.action_of(ob) is not None

    def draw(self, context: bpy.types.Context) -> None:
        layout, ob = split_layout(self), query.active_character(context)
        if ob is None:
            return
        column = layout.column()
        for name in SWITCHES:
            column.prop(of_rig(ob), name)
        own = of_rig(ob).solver
        buttons = draw_list(layout, "MORPHRETARGET_UL_limb_settings", own, "limbs", "active_limb")
        buttons.menu("MORPHRETARGET_MT_limbs", text="", icon="ADD")
        draw_remove(buttons, "morph_retarget.remove_limb_settings", len(own.limbs) > 0).character = ob.name
        item = chosen(own.limbs, own.active_limb)
        if item is not None:
            _draw_settings(layout, ob, item, OF_LIMBS)


class MORPHRETARGET_PT_solver_tuning(InTab, bpy.types.Panel):
    bl_idname = "MORPHRETARGET_PT_solver_tuning"
    bl_parent_id = "MORPHRETARGET_PT_solver"
    bl_label = "All Limbs and Spine"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        layout, ob = split_layout(self), query.active_character(context)
        if ob is None:
            return
        for names in (OF_ALL, FOR_SPINE, FOR_COLLISIONS):
            _draw_settings(layout, ob, of_rig(ob).solver, names)


CLASSES = (
    MORPHRETARGET_UL_limb_settings,
    MORPHRETARGET_MT_limbs,
    MORPHRETARGET_PT_solver,
    MORPHRETARGET_PT_solver_tuning,
)
