"""Keeping joint maps: as presets in the extension's folder, and as files."""

from pathlib import Path

import bpy
from bpy.props import StringProperty
from bpy_extras.io_utils import ExportHelper, ImportHelper

from ...core.character import joints as joint_names
from ...core.errors import FileError, MappingError, RigError
from .. import collect, presets, rig
from ..properties import of_rig, together
from .manners import Status, refuse, reporting, rig_meant, scene_in, shown_rig
from .rigs import analyze

_RIG = StringProperty(name="Rig", description="Armature object; the shown one when empty")


def _joints(ob: bpy.types.Object) -> dict[str, str]:
    found = {joint.name: joint.bone for joint in of_rig(ob).joints if joint.bone}
    if not found:
        raise RigError(f"{ob.name!r} has no joints to save: analyze it first")
    return found


def _use(context: bpy.types.Context, ob: bpy.types.Object, path: Path) -> None:
    """Give a rig a joint map and its controls; all of it, or nothing where a bone is missing."""
    given, controls = presets.load(path), presets.load_controls(path)
    skeleton = rig.read(ob).skeleton
    joint_names.check_names(given, skeleton)
    missing = [bone for bone in controls.values() if bone not in skeleton.index]
    if missing:
        raise MappingError(f"{path}: names the control {missing[0]!r}, which {ob.name!r} does not have: correct it")
    with together():
        if not of_rig(ob).joints:
            of_rig(ob).show(collect.target_of(ob)[1])
        for joint, bone in given.items():
            of_rig(ob).assign(joint, bone, by="preset")
        for joint, control in controls.items():
            of_rig(ob).joints[joint].control = control
        analyze(scene_in(context), ob)


class MORPHRETARGET_OT_save_preset(bpy.types.Operator):
    bl_idname = "morph_retarget.save_preset"
    bl_label = "Save Joint Preset"
    bl_description = "Keep the shown rig's joints for other rigs with the same bones"
    bl_options = {"REGISTER"}

    rig: _RIG
    name: StringProperty(name="Name", description="Name of the preset", default="My Rig")

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        ob = shown_rig(context)
        return (ob is not None and len(of_rig(ob).joints) > 0) or refuse(cls, "Analyze a rig first")

    def invoke(self, context: bpy.types.Context, _: bpy.types.Event) -> Status:
        assert context.window_manager is not None, "there is a window"
        return context.window_manager.invoke_props_dialog(self)

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        ob = rig_meant(context, self.rig)
        presets.save(presets.path_of(self.name), _joints(ob), of_rig(ob).controls())
        self.report({"INFO"}, f"Saved joint preset {self.name!r}")
        return {"FINISHED"}


class MORPHRETARGET_OT_load_preset(bpy.types.Operator):
    bl_idname = "morph_retarget.load_preset"
    bl_label = "Load Joint Preset"
    bl_description = "Give the shown rig the joints of this preset"
    bl_options = {"REGISTER", "UNDO"}

    rig: _RIG
    name: StringProperty(name="Name", description="Name of the preset")

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        path = presets.path_of(self.name)
        if not path.exists():
            raise FileError(f"there is no preset {self.name!r}: choose one of {', '.join(presets.names()) or 'none'}")
        _use(context, rig_meant(context, self.rig), path)
        return {"FINISHED"}


class MORPHRETARGET_OT_delete_preset(bpy.types.Operator):
    bl_idname = "morph_retarget.delete_preset"
    bl_label = "Delete Joint Preset"
    bl_description = "Delete this preset for good"
    bl_options = {"REGISTER"}

    name: StringProperty(name="Name", description="Name of the preset")

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> Status:
        assert context.window_manager is not None, "there is a window"
        return context.window_manager.invoke_confirm(self, event)

    @reporting
    def execute(self, _: bpy.types.Context) -> Status:
        presets.delete(self.name)
        return {"FINISHED"}


class MORPHRETARGET_OT_export_map(bpy.types.Operator, ExportHelper):
    bl_idname = "morph_retarget.export_map"
    bl_label = "Export Joint Map"
    bl_description = "Write the shown rig's joints to a JSON file, which the command line reads too"
    bl_options = {"REGISTER"}

    filename_ext = ".json"
    filter_glob: StringProperty(default="*.json", options={"HIDDEN"})
    rig: _RIG

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        ob = rig_meant(context, self.rig)
        presets.save(Path(self.properties.filepath), _joints(ob), of_rig(ob).controls())
        return {"FINISHED"}


class MORPHRETARGET_OT_import_map(bpy.types.Operator, ImportHelper):
    bl_idname = "morph_retarget.import_map"
    bl_label = "Import Joint Map"
    bl_description = "Read the shown rig's joints from a JSON file, such as the output of map --json"
    bl_options = {"REGISTER", "UNDO"}

    filename_ext = ".json"
    filter_glob: StringProperty(default="*.json", options={"HIDDEN"})
    rig: _RIG

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        _use(context, rig_meant(context, self.rig), Path(self.properties.filepath))
        return {"FINISHED"}


CLASSES = (
    MORPHRETARGET_OT_save_preset,
    MORPHRETARGET_OT_load_preset,
    MORPHRETARGET_OT_delete_preset,
    MORPHRETARGET_OT_export_map,
    MORPHRETARGET_OT_import_map,
)
