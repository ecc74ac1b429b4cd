"""Writing results to files: whole or not at all."""

import contextlib
import os
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import bpy
from mathutils import Matrix

from ...core.errors import FileError
from ..rig import armature_of, scene_of
from . import addons
from .failing import letting_go, reason_of
from .quiet import quiet

KINDS = (".blend", ".glb", ".fbx", ".bvh")
_ADDONS = {".fbx": "io_scene_fbx", ".glb": "io_scene_gltf2", ".bvh": "io_anim_bvh"}


def check(path: Path) -> None:
    """Check that a result can be written to ``path``, before any work is done.

    Raises:
        FileError: Its kind is unknown, or its folder is missing or cannot be written.
    """
    if path.suffix.lower() not in KINDS:
        raise FileError(f"{path}: unknown kind of output: use {', '.join(KINDS)}")
    check_folder(path)


def check_folder(path: Path) -> None:
    """Check that a file can be created at ``path``.

    Raises:
        FileError: It is a folder, or its folder is missing or cannot be written.
    """
    folder = path.absolute().parent
    if path.is_dir():
        raise FileError(f"{path}: is a folder: name a file in it")
    if not folder.is_dir():
        raise FileError(f"{path}: there is no folder {folder}: create it first")
    try:
        probe = folder / f".{os.getpid()}.probe"
        probe.touch()
        probe.unlink()
    except OSError as error:
        raise FileError(f"{path}: cannot be written ({error.strerror}): choose another folder") from error


class Outbox:
    """Files that appear together when all of them are whole, and not at all when anything fails.

    Each is written under another name beside its place first::

        with Outbox() as outbox:
            outbox.rigs(Path("walk.glb"), [armature])
            outbox.text(Path("report.json"), "[]")
    """

    def __init__(self) -> None:
        self._waiting: dict[Path, Path] = {}

    def rigs(self, path: Path, armatures: Sequence[bpy.types.Object]) -> None:
        """Write armatures with their meshes and current actions, or for a .blend the whole file.

        Raises:
            FileError: It cannot be written.
        """
        kind = path.suffix.lower()
        if kind == ".bvh" and len(armatures) > 1:
            raise FileError(
                f"{path}: a BVH file holds one armature: write each to a file of its own with {{target}} in the name"
            )
        if kind in _ADDONS:
            addons.enable(_ADDONS[kind])
        self._write(path, lambda temporary: _WRITERS[kind](temporary, armatures))

    def text(self, path: Path, text: str) -> None:
        """Write a text file; names of files that are no Unicode are told with escapes, as JSON has them.

        Raises:
            FileError: It cannot be written.
        """
        self._write(path, lambda temporary: temporary.write_text(text, encoding="utf-8", errors="backslashreplace"))

    def made(self, path: Path, make: Callable[[Path], object]) -> None:
        """Write a file as ``make`` does, which is told where.

        Raises:
            FileError: It cannot be written.
        """
        self._write(path, make)

    def _write(self, path: Path, write: Callable[[Path], object]) -> None:
        check_folder(path)
        final = path.absolute()
        temporary = final.with_name(f".{os.getpid()}.{len(self._waiting)}{final.suffix}")
        if final in self._waiting.values():
            raise FileError(f"{path}: two results would get this file: tell them apart in its name")
        self._waiting[temporary] = final
        with _explained(path), quiet(errors=True), letting_go():
            write(temporary)
        if not temporary.exists():
            raise FileError(f"{path}: Blender wrote nothing: check the disk and the folder's permissions")

    def __enter__(self) -> "Outbox":
        return self

    def __exit__(self, kind: object, error: object, trace: object) -> None:
        try:
            if error is None:
                for temporary, final in self._waiting.items():
                    with _explained(final):
                        temporary.replace(final)
        finally:
            for temporary in self._waiting:
                temporary.unlink(missing_ok=True)


@contextlib.contextmanager
def _explained(path: Path) -> Iterator[None]:
    """Turn what goes wrong while writing into one line that names the file."""
    try:
        yield
    except (OSError, RuntimeError) as error:
        raise FileError(
            f"{path}: cannot be written ({reason_of(error)}): check the disk and the folder's permissions"
        ) from error


def _write_blend(path: Path, _: Sequence[bpy.types.Object]) -> None:
    bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True, compress=True)


@contextlib.contextmanager
def _selected(armatures: Sequence[bpy.types.Object]) -> Iterator[None]:
    """Select armatures and what they carry, and nothing else, shown for a while if they were hidden."""
    layer, scene = bpy.context.view_layer, scene_of()
    assert layer is not None, "there is a scene while a file is open"
    wanted = set(armatures) | {child for ob in armatures for child in ob.children_recursive}
    # An object in the scene's own collection cannot be hidden by those that it lies in.
    linked = [ob for ob in wanted if ob.name not in scene.collection.objects]
    for ob in linked:
        scene.collection.objects.link(ob)
    layer.update()
    hidden = [(ob, ob.hide_get(), ob.hide_viewport, ob.hide_select) for ob in wanted]
    for ob in wanted:
        ob.hide_viewport = ob.hide_select = False
        ob.hide_set(False)
    for ob in scene.objects:
        if ob.name in layer.objects:
            ob.select_set(ob in wanted)
    layer.objects.active = armatures[0]
    try:
        yield
    finally:
        for ob, away, viewport, select in hidden:
            ob.hide_set(away)
            ob.hide_viewport, ob.hide_select = viewport, select
        for ob in linked:
            scene.collection.objects.unlink(ob)


def _write_glb(path: Path, armatures: Sequence[bpy.types.Object]) -> None:
    with _selected(armatures):
        bpy.ops.export_scene.gltf(
            filepath=str(path),
            export_format="GLB",
            use_selection=True,
            export_animation_mode="ACTIVE_ACTIONS",
            export_rest_position_armature=True,
            export_frame_range=True,
        )


def _write_fbx(path: Path, armatures: Sequence[bpy.types.Object]) -> None:
    with _selected(armatures):
        bpy.ops.export_scene.fbx(
            filepath=str(path),
            use_selection=True,
            add_leaf_bones=False,
            bake_anim_use_all_actions=False,
            bake_anim_use_nla_strips=False,
            bake_anim_simplify_factor=0.0,
        )


def _write_bvh(path: Path, armatures: Sequence[bpy.types.Object]) -> None:
    """Write a BVH file, Y up and -Z forward as everyone expects it.

    Blender's exporter writes armature space as it is, whatever way the object is turned, so a turned copy is written.
    """
    ob = armatures[0]
    _, rotation, scale = ob.matrix_world.decompose()
    copy, data = ob.copy(), armature_of(ob).copy()
    assert copy is not None, "local objects can be copied"
    assert data is not None, "so can their data"
    copy.data = data
    try:
        scene_of().collection.objects.link(copy)
        data.transform(_TO_Y_UP @ rotation.to_matrix().to_4x4())
        copy.matrix_world.identity()
        with _selected([copy]):
            bpy.ops.export_anim.bvh(
                filepath=str(path),
                frame_start=scene_of().frame_start,
                frame_end=scene_of().frame_end,
                global_scale=(scale.x + scale.y + scale.z) / 3.0,
                root_transform_only=False,
            )
    finally:
        bpy.data.objects.remove(copy)
        bpy.data.armatures.remove(data)


_TO_Y_UP = Matrix(((1, 0, 0, 0), (0, 0, 1, 0), (0, -1, 0, 0), (0, 0, 0, 1)))


_WRITERS = {".blend": _write_blend, ".glb": _write_glb, ".fbx": _write_fbx, ".bvh": _write_bvh}
