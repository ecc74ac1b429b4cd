"""Scripts of commands: brought in from files and texts, and written to them."""

from pathlib import Path

import bpy
from bpy.props import BoolProperty, StringProperty
from bpy_extras.io_utils import ExportHelper, ImportHelper

from ...core.clips.commands import script
from ...core.errors import FileError, RigError, listed
from ..directing import scripts
from ..morph import analyses
from ..sampling import seconds_per_frame
from .directing import directing_of
from .manners import OfArmature, Status, armature_meant, reporting, scene_in

_TEXT = StringProperty(name="Text", description="Text of the file in place of a file on disk")


class MORPHRETARGET_OT_import_commands(OfArmature, bpy.types.Operator, ImportHelper):
    bl_idname = "morph_retarget.import_commands"
    bl_label = "Import Commands"
    bl_description = "Read commands from a script (TOML) or from Behavior Markup Language (BML), beside those there are"

    filter_glob: StringProperty(default="*.toml;*.bml;*.xml", options={"HIDDEN"})
    text: _TEXT
    replace: BoolProperty(name="Replace", description="Remove the commands that the character has")

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        ob, scene = armature_meant(context, self.character), scene_in(context)
        own, rate = directing_of(ob), 1.0 / seconds_per_frame(scene)
        path = Path(self.properties.filepath)
        found = scripts.parse(_text(self.text), self.text, rate) if self.text else scripts.load(path, rate)
        _, character, _ = analyses.of(ob)
        if self.replace:
            own.clear()
        for warning in scripts.bring_in(ob, character, found, scene, None if self.text else path.parent):
            self.report({"WARNING"}, warning)
        self.report({"INFO"}, f"{ob.name} got {len(found.commands)} commands")
        return {"FINISHED"}


class MORPHRETARGET_OT_export_commands(OfArmature, bpy.types.Operator, ExportHelper):
    bl_idname = "morph_retarget.export_commands"
    bl_label = "Export Commands"
    bl_description = "Write the commands of the list as a script (TOML)"
    bl_options = {"REGISTER"}

    filename_ext = scripts.TABLES
    filter_glob: StringProperty(default="*.toml", options={"HIDDEN"})
    text: StringProperty(name="Text", description="Name of a text of this file to write to, in place of a file on disk")

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        ob = armature_meant(context, self.character)
        _, character, _ = analyses.of(ob)
        found = scripts.taken_out(ob, character, scene_in(context))
        if not found.commands:
            raise RigError(f"{ob.name!r} has no commands to write: add some first")
        written = script.written(found)
        if self.text:
            block = bpy.data.texts.get(self.text) or bpy.data.texts.new(self.text)
            block.from_string(written)
        else:
            path = Path(self.properties.filepath)
            try:
                path.write_text(written, encoding="utf-8")
            except OSError as error:
                raise FileError(f"{path}: cannot be written ({error.strerror}): choose another place") from error
        self.report({"INFO"}, f"Wrote {len(found.commands)} commands")
        return {"FINISHED"}


def _text(name: str) -> str:
    """Return the content of a text of the open file.

    Raises:
        FileError: There is none of that name.
    """
    found = bpy.data.texts.get(name)
    if found is None:
        raise FileError(f"there is no text {name!r}: choose one of {listed(bpy.data.texts.keys()) or 'none'}")
    return found.as_string()


CLASSES = (MORPHRETARGET_OT_import_commands, MORPHRETARGET_OT_export_commands)
