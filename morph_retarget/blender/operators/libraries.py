"""Libraries of motions: built from actions and from files of clips, and kept as files."""

from collections.abc import Generator
from pathlib import Path

import bpy
from bpy.props import BoolProperty, StringProperty
from bpy_extras.io_utils import ExportHelper, ImportHelper

from ...core.character.character import Character
from ...core.clips.motions import library_file
from ...core.clips.motions.library import Library
from ...core.directing import starter
from ...core.directing.building import Builder, Taken
from ...core.directing.performing import model_of
from ...core.errors import FileError, MotionError, RigError, listed
from ..directing import clips, libraries
from ..morph import analyses
from ..properties import of_rig
from .directing import directing_of
from .generalized import selected
from .manners import OfArmature, Status, armature_meant, reporting, scene_in
from .stepping import Stepping, SteppingFromDialog

_GLOB = f"*{library_file.SUFFIX}"


class MORPHRETARGET_OT_build_library(Stepping, OfArmature, bpy.types.Operator):
    bl_idname = "morph_retarget.build_library"
    bl_label = "Build Library"
    bl_description = (
        "Make a library for the active character of all actions of the selected armatures, and of the files in Clips"
    )
    doing = "Building the library"

    filepath: StringProperty(
        name="File",
        description="Where the library is written; beside the open file when empty, under a name that is free",
        subtype="FILE_PATH",
    )
    folder: StringProperty(
        name="Clips", description="Folder of clips; that of the character when empty", subtype="DIR_PATH"
    )
    add: BoolProperty(name="Add", description="Keep the motions of the character's library beside the new ones")

    def start(self, context: bpy.types.Context) -> Generator[float, None, tuple[bpy.types.Object, Path, list[Taken]]]:
        ob = armature_meant(context, self.character)
        own = directing_of(ob)
        _, character, _ = analyses.of(ob)
        kept = own.library_path if self.add else None
        path = _free_file(ob, self.filepath) if kept is None else kept
        obs = [ob, *(other for other in selected(context) if other != ob)]
        folder = self.folder or own.clips
        files = _files(Path(bpy.path.abspath(folder, library=ob.library))) if folder else []
        wanted = clips.wanted_of(obs)
        if not wanted and not files:
            names = listed([other.name for other in obs])
            raise MotionError(f"no action moves {names}: select armatures that move, or choose a folder of clips")
        library = Library(model_of(character)) if kept is None else library_file.load(kept)
        assert context.view_layer is not None, "operators run in a window with a scene"
        return _built(ob, library, path, wanted, files, scene_in(context), context.view_layer)

    def finish(self, _: bpy.types.Context, result: tuple[bpy.types.Object, Path, list[Taken]]) -> Status:
        ob, path, taken = result
        for one in taken:
            self.report({"INFO" if one.kept else "WARNING"}, str(one))
        of_rig(ob).directing.library = libraries.text_of(path)
        kept = sum(one.kept for one in taken)
        self.report({"INFO"}, f"{path.name} has {kept} more motions; {len(taken) - kept} clips were left out")
        return {"FINISHED"}


def _built(
    ob: bpy.types.Object,
    library: Library,
    path: Path,
    wanted: list[clips.Wanted],
    files: list[Path],
    scene: bpy.types.Scene,
    layer: bpy.types.ViewLayer,
) -> Generator[float, None, tuple[bpy.types.Object, Path, list[Taken]]]:
    """Build a library in steps, and write it; importers of files leave the selection of the layer as it was."""
    builder, active = Builder(library), layer.objects.active
    chosen = [other for other in layer.objects if other.select_get()]
    try:
        taken = yield from clips.take(builder, wanted, files, scene)
    finally:
        layer.update()  # what was borrowed has gone
        for other in chosen:
            other.select_set(True)
        layer.objects.active = active
    if not any(one.kept for one in taken):
        raise MotionError(f"no clip could be used: {taken[0]}")
    library_file.save(builder.library, path)
    return ob, path, taken


def _files(folder: Path) -> list[Path]:
    if not folder.is_dir():
        raise FileError(f"{folder}: is no folder: choose one that has clips")
    return clips.files_of(folder)


def _free_file(ob: bpy.types.Object, given: str) -> Path:
    """Return where a new library of a character is written.

    Raises:
        FileError: The open file has no place yet.
    """
    if given:
        return Path(bpy.path.abspath(given)).with_suffix(library_file.SUFFIX)
    if not bpy.data.filepath:
        raise FileError("the open file has no folder yet, beside which the library goes: save it first")
    stem = bpy.path.clean_name(ob.name)
    folder, number = Path(bpy.data.filepath).parent, 1
    path = folder / f"{stem}{library_file.SUFFIX}"
    while path.exists():
        number += 1
        path = folder / f"{stem} {number}{library_file.SUFFIX}"
    return path


class MORPHRETARGET_OT_save_library(ExportHelper, SteppingFromDialog, OfArmature, bpy.types.Operator):
    bl_idname = "morph_retarget.save_library"
    bl_label = "Save Library"
    bl_description = "Write the motions of the character to a file: its library, or the whole starter library"
    bl_options = {"REGISTER"}
    doing = "Saving the library"

    filename_ext = library_file.SUFFIX
    filter_glob: StringProperty(default=_GLOB, options={"HIDDEN"})

    def start(self, context: bpy.types.Context) -> Generator[float, None, tuple[int, Path]]:
        ob, path = armature_meant(context, self.character), Path(self.properties.filepath)
        _, character, _ = analyses.of(ob)
        return _saved(character, of_rig(ob).directing.library_path, path)

    def finish(self, _: bpy.types.Context, result: tuple[int, Path]) -> Status:
        count, path = result
        self.report({"INFO"}, f"Wrote {count} motions to {path.name}")
        return {"FINISHED"}


def _saved(character: Character, own: Path | None, path: Path) -> Generator[float, None, tuple[int, Path]]:
    """Write a character's library, or the starter library, which is made kind by kind; return how much it has."""
    if own is not None:
        library = library_file.load(own)
    else:
        library, kinds = Library(model_of(character)), starter.kinds_of_starter()
        for done, kind in enumerate(kinds):
            yield done / len(kinds)
            library = starter.completed(library, [kind])
    yield 1.0  # writing takes next to no time
    library_file.save(library, path)
    return len(library), path


class MORPHRETARGET_OT_load_library(OfArmature, bpy.types.Operator, ImportHelper):
    bl_idname = "morph_retarget.load_library"
    bl_label = "Load Library"
    bl_description = "Let the character carry commands out with the motions of a file"

    filename_ext = library_file.SUFFIX
    filter_glob: StringProperty(default=_GLOB, options={"HIDDEN"})

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        ob = armature_meant(context, self.character)
        own, path = directing_of(ob), Path(self.properties.filepath)
        library = library_file.load(path)
        if not len(library):
            raise RigError(f"{path.name} has no motions: build it again")
        own.library = libraries.text_of(path)
        self.report({"INFO"}, f"{path.name} has {len(library)} motions: {listed(library.kinds, 20)}")
        return {"FINISHED"}


CLASSES = (MORPHRETARGET_OT_build_library, MORPHRETARGET_OT_save_library, MORPHRETARGET_OT_load_library)
