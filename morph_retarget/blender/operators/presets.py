"""Keeping joint maps: as presets in the extension's folder, and as files."""

from pathlib import Path

import bpy
from bpy.props import EnumProperty, StringProperty
from bpy_extras.io_utils import ExportHelper, ImportHelper

from ...core.character import families
from ...core.character import joints as joint_names
from ...core.character.bone_maps import pair_maps, rokoko
from ...core.character.bone_maps.bone_map import BoneMap
from ...core.character.bone_maps.placing import Placed
from ...core.character.character import Character
from ...core.character.families import Family
from ...core.errors import MappingError, RigError
from .. import bone_maps, collect, presets, rig
from ..changes import together
from ..properties import of_rig, of_scene
from .manners import Asking, Confirming, Status, refuse, reporting, rig_meant, scene_in, shown_rig
from .rigs import analyze

_RIG = StringProperty(name="Rig", description="Armature object; the shown one when empty")


def _joints(ob: bpy.types.Object) -> dict[str, str]:
    found = {joint.name: joint.bone for joint in of_rig(ob).joints if joint.bone}
    if not found:
        raise RigError(f"{ob.name!r} has no joints to save: analyze it first")
    return found


def _use(context: bpy.types.Context, ob: bpy.types.Object, given: BoneMap | Family) -> Placed:
    """Give a rig what a bone map says of it; all of it, or nothing where a bone is missing."""
    own = rig.read(ob)
    placed = bone_maps.place(given, own, of_rig(ob).overrides(), _character(_partner(context, ob)))
    skeleton, controls, reaches = own.skeleton, placed.controls, placed.reaches
    joint_names.check_names(placed.joints, skeleton)
    named = [*controls.values(), *(bone for said in reaches.values() for bone in (said.control, said.pole) if bone)]
    missing = [bone for bone in named if bone not in skeleton.index]
    if missing:
        raise MappingError(f"the map names the control {missing[0]!r}, which {ob.name!r} does not have: correct it")
    with together():
        if not of_rig(ob).joints:
            of_rig(ob).show(collect.target_of(ob)[1])
        for joint, bone in placed.joints.items():
            of_rig(ob).assign(joint, bone, by="preset")
        for joint, control in controls.items():
            of_rig(ob).joints[joint].control = control
        for joint, said in reaches.items():
            of_rig(ob).joints[joint].hold(said)
        analyze(scene_in(context), ob)
    return placed


def _partner(context: bpy.types.Context, ob: bpy.types.Object) -> bpy.types.Object | None:
    """Return the other of source and target, None where the rig is neither or stands alone."""
    settings = of_scene(scene_in(context))
    return {settings.source: settings.target, settings.target: settings.source}.get(ob)


def _character(ob: bpy.types.Object | None) -> Character | None:
    return None if ob is None else collect.target_of(ob)[1]


def _tell(operator: bpy.types.Operator, placed: Placed) -> None:
    """Say what a map has brought, and what of it was left out."""
    count = len({*placed.joints, *placed.controls})
    operator.report({"INFO"}, f"Took {count} joints from the map")
    if placed.left_out:
        operator.report({"WARNING"}, placed.told())


class MORPHRETARGET_OT_save_preset(Asking, bpy.types.Operator):
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

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        ob = rig_meant(context, self.rig)
        presets.save(presets.path_of(self.name), _joints(ob), of_rig(ob).controls(), of_rig(ob).reaches())
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
        given = bone_maps.load(path) if path.exists() else families.named(self.name)
        _tell(self, _use(context, rig_meant(context, self.rig), given))
        return {"FINISHED"}


class MORPHRETARGET_OT_delete_preset(Confirming, bpy.types.Operator):
    bl_idname = "morph_retarget.delete_preset"
    bl_label = "Delete Joint Preset"
    bl_description = "Delete this preset for good"
    bl_options = {"REGISTER"}

    name: StringProperty(name="Name", description="Name of the preset")

    @reporting
    def execute(self, _: bpy.types.Context) -> Status:
        presets.delete(self.name)
        return {"FINISHED"}


class MORPHRETARGET_OT_export_map(bpy.types.Operator, ExportHelper):
    bl_idname = "morph_retarget.export_map"
    bl_label = "Export Joint Map"
    bl_description = "Write the shown rig's joints to a JSON file, for the command line or another tool"
    bl_options = {"REGISTER"}

    filename_ext = ".json"
    filter_glob: StringProperty(default="*.json", options={"HIDDEN"})
    rig: _RIG
    form: EnumProperty(
        name="Format",
        description="Which tool shall read the map",
        items=[
            ("OURS", "Morph Retarget", "Joints and their bones, which the command line reads too"),
            ("KEEMAP", "KeeMap", "Bones of Source and Target side by side; calculate the corrections in KeeMap"),
            ("ROKOKO", "Rokoko", "A custom naming scheme, without upper chest and face, which Rokoko does not know"),
        ],
    )

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        ob, path = rig_meant(context, self.rig), Path(self.properties.filepath)
        joints = _joints(ob)
        if self.form == "OURS":
            presets.save(path, joints, of_rig(ob).controls(), of_rig(ob).reaches())
        elif self.form == "ROKOKO":
            presets.write(path, rokoko.write(joints))
        else:
            other = _partner(context, ob)
            if other is None:
                raise RigError("a KeeMap map pairs two rigs: choose both Source and Target")
            theirs = {joint: match.bone for joint, match in collect.target_of(other)[1].joints.items()}
            moves = of_scene(scene_in(context)).source == ob
            ends = (joints, theirs) if moves else (theirs, joints)
            names = (ob.name, other.name) if moves else (other.name, ob.name)
            presets.write(path, pair_maps.write_keemap(pair_maps.paired(*ends), *names))
        self.report({"INFO"}, f"Wrote the joints of {ob.name!r}")
        return {"FINISHED"}


class MORPHRETARGET_OT_import_map(bpy.types.Operator, ImportHelper):
    bl_idname = "morph_retarget.import_map"
    bl_label = "Import Joint Map"
    bl_description = "Read the shown rig's joints from our own JSON, or a bone map of KeeMap, Rokoko or another tool"
    bl_options = {"REGISTER", "UNDO"}

    filename_ext = ".json"
    filter_glob: StringProperty(default="*.json;*.blend-retarget;*.py;*.txt", options={"HIDDEN"})
    rig: _RIG

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        _tell(self, _use(context, rig_meant(context, self.rig), bone_maps.load(Path(self.properties.filepath))))
        return {"FINISHED"}


CLASSES = (
    MORPHRETARGET_OT_save_preset,
    MORPHRETARGET_OT_load_preset,
    MORPHRETARGET_OT_delete_preset,
    MORPHRETARGET_OT_export_map,
    MORPHRETARGET_OT_import_map,
)
