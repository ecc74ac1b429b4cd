"""Loading rigs and clips from files through Blender's own importers."""

import contextlib
import os
import shutil
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import bpy

from ...core.errors import FileError, listed
from .. import actions
from ..rig import armature_of, scene_of
from . import addons, bvh_check, gltf
from .failing import letting_go, reason_of
from .quiet import quiet

KINDS = (".bvh", ".fbx", ".glb", ".gltf", ".vrm", ".blend")
_GLTF = (".glb", ".gltf", ".vrm")
_ADDONS = {".bvh": "io_anim_bvh", ".glb": "io_scene_gltf2", ".gltf": "io_scene_gltf2", ".vrm": "io_scene_gltf2"}


@dataclass(frozen=True)
class Request:
    """A file, and the action in it if one was named: ``clip.blend#Walk``."""

    path: Path
    action: str | None = None

    @classmethod
    def parse(cls, text: str) -> "Request":
        """Return what ``text`` asks for; a ``#`` counts only where the file itself does not have it in its name."""
        if Path(text).exists() or "#" not in text:
            return cls(Path(text))
        path, _, action = text.rpartition("#")
        return cls(Path(path), action or None)

    def check(self) -> None:
        """Check that the file exists and is of a known kind.

        Raises:
            FileError: It is not.
        """
        if not self.path.exists():
            raise FileError(f"{self.path}: no such file: check the path")
        if self.path.is_dir():
            raise FileError(f"{self.path}: is a folder: name a file in it")
        if self.path.suffix.lower() not in KINDS:
            raise FileError(f"{self.path}: unknown kind of file: use {', '.join(KINDS)}")
        if not os.access(self.path, os.R_OK):
            raise FileError(f"{self.path}: cannot be read: check its permissions")
        if self.path.stat().st_size == 0:
            raise FileError(f"{self.path}: is empty: export it again")


def load(request: Request) -> list[bpy.types.Object]:
    """Replace the open file with what ``request`` names and return its armatures.

    Raises:
        FileError: The file is missing, of an unknown kind, unreadable, or holds no armature.
    """
    request.check()
    with quiet(errors=True):
        if request.path.suffix.lower() == ".blend":
            _run(request.path, bpy.ops.wm.open_mainfile, load_ui=False, use_scripts=False)
        else:
            bpy.ops.wm.read_homefile(use_empty=True)
            _import(request.path)
    return _armatures(request.path, list(bpy.data.objects))


def add(request: Request) -> list[bpy.types.Object]:
    """Add what ``request`` names to the open file and return the new armatures.

    Raises:
        FileError: See `load`.
    """
    with _kept_times():
        return _add(request)


def _add(request: Request) -> list[bpy.types.Object]:
    """Add what ``request`` names, and give the scene its frame rate."""
    request.check()
    before = set(bpy.data.objects)
    with quiet(errors=True):
        if request.path.suffix.lower() == ".blend":
            _append(request.path)
        else:
            _import(request.path)
    return _armatures(request.path, [ob for ob in bpy.data.objects if ob not in before])


@contextlib.contextmanager
def borrowed(request: Request) -> Iterator[list[bpy.types.Object]]:
    """Add what ``request`` names to the open file for a while, at its own frame rate, and remove all of it again.

    Raises:
        FileError: See `load`.
    """
    before = _everything()
    with _kept_times():
        try:
            yield _add(request)
        finally:
            bpy.data.batch_remove(list(_everything() - before))


@contextlib.contextmanager
def _kept_times() -> Iterator[None]:
    """Put the scene's frame rate and range back, which importers set."""
    scene = scene_of()
    kept = scene.render.fps, scene.render.fps_base, scene.frame_start, scene.frame_end
    try:
        yield
    finally:
        scene.render.fps, scene.render.fps_base, scene.frame_start, scene.frame_end = kept


def _everything() -> set[bpy.types.ID]:
    data = bpy.data
    kinds = (data.objects, data.armatures, data.meshes, data.actions, data.materials, data.images, data.collections)
    return {item for kind in kinds for item in kind}


def choose(armatures: list[bpy.types.Object], path: Path, name: str | None) -> bpy.types.Object:
    """Return the one armature that is meant.

    Raises:
        FileError: There are several and ``name`` does not say which.
    """
    named = [ob for ob in armatures if name in (ob.name, armature_of(ob).name)]
    if named:
        return named[0]
    names = listed([ob.name for ob in armatures])
    if len(armatures) > 1:
        wrong = f"none of them is called {name!r}: " if name else ""
        raise FileError(f"{path}: holds {len(armatures)} armatures ({names}): {wrong}choose one with --armature NAME")
    return armatures[0]


def _armatures(path: Path, objects: list[bpy.types.Object]) -> list[bpy.types.Object]:
    found = [ob for ob in objects if ob.type == "ARMATURE"]
    # A linked rig that has been overridden here is there through its override.
    replaced = {ob.override_library.reference for ob in found if ob.override_library is not None}
    found = [ob for ob in found if ob not in replaced]
    if not found:
        raise FileError(f"{path}: holds no armature: choose a file with a rig in it")
    bpy.context.evaluated_depsgraph_get().update()
    return sorted(found, key=lambda ob: (-len(armature_of(ob).bones), ob.name))


def _append(path: Path) -> None:
    try:
        with bpy.data.libraries.load(str(path)) as (theirs, ours):  # pyright: ignore[reportGeneralTypeIssues]
            ours.objects, ours.scenes = list(theirs.objects), list(theirs.scenes)[:1]
    except OSError as error:
        raise FileError(f"{path}: is no blend file that this Blender can read: save it again") from error
    for scene in ours.scenes:
        scene_of().render.fps, scene_of().render.fps_base = scene.render.fps, scene.render.fps_base
        bpy.data.scenes.remove(scene)
    for ob in ours.objects:
        if ob is not None and not ob.users_collection:
            scene_of().collection.objects.link(ob)


def _import(path: Path) -> None:
    kind = path.suffix.lower()
    if kind in _GLTF:
        rate = gltf.frame_rate(path)
        if rate is not None:
            scene_of().render.fps, scene_of().render.fps_base = round(rate), round(rate) / rate
    if kind in _ADDONS:
        addons.enable(_ADDONS[kind])
    if kind == ".bvh":
        bvh_check.check(path)
        _run(path, bpy.ops.import_anim.bvh, update_scene_fps=True, update_scene_duration=True)
    elif kind == ".fbx":
        before = set(bpy.data.actions)
        _run(path, bpy.ops.wm.fbx_import)
        for action in bpy.data.actions:
            if action not in before:
                actions.escape_names(action)
    elif kind == ".vrm":
        # A VRM is a GLB with more in it; the importer goes by the ending.
        with tempfile.TemporaryDirectory() as folder:
            copy = Path(folder, path.stem + ".glb")
            shutil.copyfile(path, copy)
            _run(path, bpy.ops.import_scene.gltf, actual=copy)
    else:
        _run(path, bpy.ops.import_scene.gltf)


def _run(path: Path, operator: object, actual: Path | None = None, **options: object) -> None:
    """Run an importer; what it reports as an error, or trips over, becomes one line that names the file."""
    try:
        with letting_go():
            result = operator(filepath=str(actual or path), **options)  # type: ignore[operator]
    except (RuntimeError, ValueError, KeyError, IndexError, TypeError, AttributeError, UnicodeError, OSError) as error:
        packed = gltf.compression(path) if path.suffix.lower() in _GLTF else None
        if packed is not None:
            raise FileError(
                f"{path}: is compressed ({packed}), which this Blender cannot read: export it without compression"
            ) from error
        raise FileError(
            f"{path}: cannot be read ({reason_of(error)}): check that it is whole, or export it again"
        ) from error
    if "FINISHED" not in result:
        raise FileError(f"{path}: Blender's importer gave up: check that it is whole, or export it again")
