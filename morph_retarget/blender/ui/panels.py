"""The panels of the Morph Retarget tab, from the first choice to the last option."""

# The stubs take every layout and every operator button for optional.
# pyright: reportOptionalMemberAccess=false, reportArgumentType=false

from typing import Any

import bpy

from ...core.character import families
from ...core.character.control_given import ENDS
from .. import live, presets
from ..laying import Lay
from ..operators.manners import shown_rig
from ..operators.retargeting import latest
from ..properties import of_rig, of_scene
from ..rig import armature_of
from ..scene_properties import MORPHRETARGET_PG_scene
from .joint_list import icon
from .lists import draw_list
from .tab import InTab, say, split_layout, told


def _settings(context: bpy.types.Context) -> MORPHRETARGET_PG_scene:
    assert context.scene is not None, "the viewport shows a scene"
    return of_scene(context.scene)


class MORPHRETARGET_PT_main(InTab, bpy.types.Panel):
    bl_idname = "MORPHRETARGET_PT_main"
    bl_label = "Morph Retarget"

    def draw(self, context: bpy.types.Context) -> None:
        layout, settings = split_layout(self), _settings(context)
        row = layout.row(align=True)
        column = row.column(align=True)
        column.prop(settings, "source", icon="ARMATURE_DATA")
        column.prop(settings, "target", icon="ARMATURE_DATA")
        buttons = row.column(align=True)
        buttons.operator("morph_retarget.use_selected", text="", icon="RESTRICT_SELECT_OFF")
        buttons.operator("morph_retarget.swap", text="", icon="UV_SYNC_SELECT")
        self._tell_action(context, layout, settings)
        column = layout.column()
        column.scale_y = 1.4
        column.operator_context = "INVOKE_DEFAULT"
        column.enabled = settings.source is not None and settings.target is not None
        column.operator("morph_retarget.retarget", icon="ARMATURE_DATA")
        if settings.target is not None:
            self._draw_live(context, layout, settings.target)
            self._tell_result(layout, settings.target)

    def _tell_action(
        self, context: bpy.types.Context, layout: bpy.types.UILayout, settings: MORPHRETARGET_PG_scene
    ) -> None:
        if settings.source is None or settings.target is None:
            if sum(ob.type == "ARMATURE" for ob in bpy.data.objects) < 2:
                say(layout, "Bring a clip and a character into the file first: File > Import", "INFO", context)
            else:
                say(layout, "Choose the armature that moves and the one that shall move", "INFO", context)
            return
        if settings.source == settings.target:
            say(layout, "Source and target are the same armature", "ERROR", context)
            return
        data = settings.source.animation_data
        if data is None or data.action is None:
            say(layout, told("{name} plays no action", name=settings.source.name), "ERROR", context)
            return
        layout.prop(settings, "all_actions")
        if not settings.all_actions:
            row = layout.row()
            row.use_property_split = True
            row.prop(data, "action", text="Action")

    def _draw_live(self, context: bpy.types.Context, layout: bpy.types.UILayout, target: bpy.types.Object) -> None:
        row = layout.row(align=True)
        if live.following(target):
            row.operator("morph_retarget.live_stop", text="Stop Live", icon="PAUSE", depress=True).clear = False
            row.operator("morph_retarget.live_stop", text="Clear Live Pose", icon="X").clear = True
        else:
            row.operator("morph_retarget.live_start", icon="PLAY")
        problem = live.problems.get(target.session_uid)
        if problem:
            say(layout, problem, "ERROR", context)

    def _tell_result(self, layout: bpy.types.UILayout, target: bpy.types.Object) -> None:
        report = latest(target)
        if report is None:
            return
        box = layout.box().column(align=True)
        box.scale_y = 0.8
        title = told("{source}: {frames} frames", source=report["source"], frames=report["frames"])
        box.label(text=title, icon="CHECKMARK", translate=False)
        slide, deep = report["foot_slide_m_per_s"], report["ground_penetration_m"]["max"]
        error = report["bone_direction_error_deg"]
        ways = {name: 100.0 * value for name, value in slide.items()}
        for text in (
            told("Foot slide {target:.1f} cm/s (source {source:.1f})", **ways),
            told("Below ground {depth:.1f} cm", depth=100.0 * deep),
            told("Bone directions {mean:.1f}° off, at most {most:.0f}°", mean=error["mean"], most=error["max"]),
        ):
            box.label(text=text, translate=False)


class MORPHRETARGET_PT_joints(InTab, bpy.types.Panel):
    bl_idname = "MORPHRETARGET_PT_joints"
    bl_parent_id = "MORPHRETARGET_PT_main"
    bl_label = "Joints"

    def draw(self, context: bpy.types.Context) -> None:
        layout, settings = self.layout, _settings(context)
        layout.row().prop(settings, "shown", expand=True)
        ob = settings.source if settings.shown == "SOURCE" else settings.target
        if ob is None:
            layout.label(text="No armature is chosen", icon="INFO")
            return
        rig = of_rig(ob)
        row = layout.row(align=True)
        row.operator("morph_retarget.analyze", icon="VIEWZOOM").rig = ob.name
        row.menu("MORPHRETARGET_MT_presets", text="", icon="PRESET")
        if not rig.joints:
            say(
                layout, "Analyze shows what was found and lets you correct it; retargeting does it too", "INFO", context
            )
            return
        self._tell_state(layout, rig)
        # The buttons stand below, so that a narrow sidebar still shows the names of bones.
        layout.template_list("MORPHRETARGET_UL_joints", "", rig, "joints", rig, "active_joint", rows=10)
        buttons = layout.row(align=True)
        buttons.operator("morph_retarget.pick_bone", text="Pick", icon="EYEDROPPER").rig = ob.name
        buttons.operator("morph_retarget.mirror_joint", text="Mirror", icon="MOD_MIRROR").rig = ob.name
        buttons.operator("morph_retarget.clear_joint", text="", icon="X").rig = ob.name
        buttons.operator("morph_retarget.select_joint", text="", icon="RESTRICT_SELECT_OFF").rig = ob.name
        buttons.operator("morph_retarget.reset_joints", text="", icon="LOOP_BACK").rig = ob.name
        column = layout.column(align=True)
        column.use_property_split = True
        column.use_property_decorate = False
        joint = rig.joints[min(max(rig.active_joint, 0), len(rig.joints) - 1)]
        column.prop_search(joint, "bone", armature_of(ob), "bones", icon="BONE_DATA")
        if settings.shown == "TARGET":
            column.prop_search(joint, "control", armature_of(ob), "bones", icon="BONE_DATA")
            if joint.name in ENDS:
                column.prop_search(joint, "reach", armature_of(ob), "bones", icon="BONE_DATA")
                column.prop_search(joint, "pole", armature_of(ob), "bones", icon="BONE_DATA")
                column.prop(joint, "switch")
            column.prop(joint, "also")
        column.prop(rig, "up")
        column.prop(rig, "forward")

    def _tell_state(self, layout: bpy.types.UILayout, rig: Any) -> None:
        icons = [icon(joint) for joint in rig.joints]
        row = layout.row()
        row.label(text=rig.kind, icon="OUTLINER_OB_ARMATURE")
        for name in ("CHECKMARK", "QUESTION", "USER", "ERROR"):
            if name in icons:
                row.label(text=str(icons.count(name)), icon=name)


def _fitting(ob: bpy.types.Object | None) -> list[str]:
    """Return the presets that come with the extension and fit the bones of a rig."""
    names = [] if ob is None else [bone.name for bone in armature_of(ob).bones]
    return [fit.family.name for fit in families.fitting(names)]


class MORPHRETARGET_MT_presets(bpy.types.Menu):
    bl_idname = "MORPHRETARGET_MT_presets"
    bl_label = "Joint Presets"

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        found = presets.names()
        fitting = [name for name in _fitting(shown_rig(context)) if name not in found]
        for name in found:
            layout.operator("morph_retarget.load_preset", text=name, icon="PRESET", translate=False).name = name
        if not found and not fitting:
            layout.label(text="No presets yet")
        if fitting:
            layout.label(text="For Bones with Such Names")
        for name in fitting:
            layout.operator("morph_retarget.load_preset", text=name, icon="PRESET", translate=False).name = name
        layout.separator()
        layout.operator_context = "INVOKE_DEFAULT"
        layout.operator("morph_retarget.save_preset", icon="ADD")
        if found:
            layout.menu("MORPHRETARGET_MT_delete_preset", icon="REMOVE")
        layout.separator()
        layout.operator("morph_retarget.import_map", icon="IMPORT")
        layout.operator("morph_retarget.export_map", icon="EXPORT")


class MORPHRETARGET_MT_delete_preset(bpy.types.Menu):
    bl_idname = "MORPHRETARGET_MT_delete_preset"
    bl_label = "Delete Joint Preset"

    def draw(self, _: bpy.types.Context) -> None:
        self.layout.operator_context = "INVOKE_DEFAULT"
        for name in presets.names():
            self.layout.operator("morph_retarget.delete_preset", text=name, translate=False).name = name


class MORPHRETARGET_PT_transfer(InTab, bpy.types.Panel):
    bl_idname = "MORPHRETARGET_PT_transfer"
    bl_parent_id = "MORPHRETARGET_PT_main"
    bl_label = "Transfer"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        layout, settings = split_layout(self), _settings(context)
        column = layout.column(align=True)
        column.prop(settings, "reference")
        if settings.reference == "frame":
            column.prop(settings, "reference_frame")
        column.prop(settings, "matching")
        layout.prop(settings, "onto")
        layout.prop(settings, "root_motion")
        layout.prop(settings, "scale")
        layout.prop(settings, "reach_hands")
        layout.prop(settings, "mirror")


class MORPHRETARGET_PT_feet(InTab, bpy.types.Panel):
    bl_idname = "MORPHRETARGET_PT_feet"
    bl_parent_id = "MORPHRETARGET_PT_main"
    bl_label = "Plant Feet"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_header(self, context: bpy.types.Context) -> None:
        self.layout.prop(_settings(context), "plant_feet", text="")

    def draw(self, context: bpy.types.Context) -> None:
        layout, settings = split_layout(self), _settings(context)
        layout.active = settings.plant_feet
        layout.prop(settings, "lock")
        layout.prop(settings, "ground")
        row = layout.row(align=True)
        row.operator("morph_retarget.detect_contacts", icon="SNAP_ON")
        if settings.source is None or not of_rig(settings.source).contacts:
            return
        rig = of_rig(settings.source)
        row.operator("morph_retarget.clear_contacts", text="", icon="X")
        layout.label(text=told("For {action}", action=rig.contacts_action), icon="ACTION", translate=False)
        buttons = draw_list(layout, "MORPHRETARGET_UL_contacts", rig, "contacts", "active_contact", rows=5)
        buttons.operator("morph_retarget.add_contact", text="", icon="ADD")
        buttons.operator("morph_retarget.remove_contact", text="", icon="REMOVE")


class MORPHRETARGET_PT_keys(InTab, bpy.types.Panel):
    bl_idname = "MORPHRETARGET_PT_keys"
    bl_parent_id = "MORPHRETARGET_PT_main"
    bl_label = "New Action"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        layout, settings = split_layout(self), _settings(context)
        layout.prop(settings, "name_template")
        layout.prop(settings, "use_range")
        if settings.use_range:
            column = layout.column(align=True)
            column.prop(settings, "frame_start")
            column.prop(settings, "frame_end")
        layout.prop(settings, "lay")
        layout.prop(settings, "selected_only")
        layout.prop(settings, "resample")
        layout.prop(settings, "keep_others")
        row = layout.row()
        row.active = settings.lay != Lay.ADD.value
        row.prop(settings, "jiggles")


CLASSES = (
    MORPHRETARGET_PT_main,
    MORPHRETARGET_PT_joints,
    MORPHRETARGET_MT_presets,
    MORPHRETARGET_MT_delete_preset,
    MORPHRETARGET_PT_transfer,
    MORPHRETARGET_PT_feet,
    MORPHRETARGET_PT_keys,
)
