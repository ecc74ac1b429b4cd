"""Generalized actions for the command line: found in a .blend or in the open file, brought into other files."""

import contextlib
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import bpy

from ...core.errors import FileError, MotionError, listed
from ...core.morph.bind import GeneralizedAction
from .. import rig
from ..io.load import Request
from ..io.quiet import quiet
from ..morph import definitions
from .messages import naming


@dataclass(frozen=True)
class ActionFile:
    """A generalized action and the .blend that holds it."""

    path: Path | None
    """None for the open file."""
    name: str
    definition: GeneralizedAction
    rate: float
    """Of the scene that it was made in [1/s]."""

    def bring(self) -> bpy.types.Action:
        """Return the action in the open file, added to it if need be."""
        if self.path is None or _is_open(self.path):
            return bpy.data.actions[self.name]
        with quiet(errors=True), bpy.data.libraries.load(str(self.path)) as (theirs, ours):  # pyright: ignore[reportGeneralTypeIssues]
            ours.actions = [action for action in theirs.actions if action == self.name]
        return ours.actions[0]

    def bring_object(self, name: str) -> bpy.types.Object | None:
        """Return an object of the open file or of the action's, which is added then; None when neither has it."""
        here = bpy.data.objects.get(name)
        if here is not None or self.path is None or _is_open(self.path):
            return here
        with quiet(errors=True), bpy.data.libraries.load(str(self.path)) as (theirs, ours):  # pyright: ignore[reportGeneralTypeIssues]
            ours.objects = [own for own in theirs.objects if own == name]
        found = ours.objects[0] if ours.objects else None
        if found is not None and not found.users_collection:
            rig.scene_of().collection.objects.link(found)
        return found


@contextlib.contextmanager
def found(text: str, stays_open: bool) -> Iterator[ActionFile]:
    """Find the action that ``FILE.blend#Action``, ``FILE.blend`` or the name of one in the open file means.

    Args:
        text: What was asked for.
        stays_open: Whether the open file is where it shall play; else what is needed of it is kept meanwhile.

    Raises:
        FileError: There is no such file, or it is none that can hold generalized actions.
        MotionError: It has no such action, or one that is not generalized, or that a newer version made.
    """
    request = Request.parse(text)
    if request.path.exists() and not _is_open(request.path):
        request.check()
        if request.path.suffix.lower() != ".blend":
            raise FileError(f"{request.path}: holds no generalized actions: only .blend files do")
        yield _in_file(request.path.absolute(), request.action, str(request.path))
        return
    if request.path.exists():
        action = _choose(list(bpy.data.actions), request.action, str(request.path))
    elif request.path.suffix or request.action:
        raise FileError(f"{request.path}: no such file: check the path")
    else:
        action = _choose(list(bpy.data.actions), text, "the open file")
    definition, rate = definitions.read(action), _rate(rig.scene_of())
    if stays_open:
        yield ActionFile(None, action.name, definition, rate)
        return
    with tempfile.TemporaryDirectory() as folder:
        path, name = Path(folder, "open.blend"), action.name
        bpy.data.libraries.write(str(path), {action, *bpy.data.objects}, fake_user=True)
        yield ActionFile(path, name, definition, rate)


def _is_open(path: Path) -> bool:
    return bool(bpy.data.filepath) and path.is_file() and path.samefile(bpy.data.filepath)


def _in_file(path: Path, name: str | None, label: str) -> ActionFile:
    """Look into a file without leaving anything of it in the open one."""
    before = set(bpy.data.libraries)
    try:
        with quiet(errors=True), bpy.data.libraries.load(str(path), link=True) as (theirs, ours):  # pyright: ignore[reportGeneralTypeIssues]
            ours.actions, ours.scenes = list(theirs.actions), list(theirs.scenes)[:1]
    except OSError as error:
        raise FileError(f"{label}: is no blend file that this Blender can read: save it again") from error
    try:
        action = _choose(list(ours.actions), name, label)
        with naming(label):
            definition = definitions.read(action)
        return ActionFile(path, action.name, definition, _rate(ours.scenes[0] if ours.scenes else rig.scene_of()))
    finally:
        bpy.data.batch_remove([library for library in bpy.data.libraries if library not in before])


def _choose(found: Sequence[bpy.types.Action], name: str | None, label: str) -> bpy.types.Action:
    """Return the generalized action that is meant: the named one, or the only one."""
    own = {a.name: a for a in sorted(found, key=lambda a: a.name) if definitions.is_generalized(a)}
    names = f"choose one of {listed(own, 20)}" if own else "it holds no generalized action; make one first"
    if name is None:
        if len(own) == 1:
            return next(iter(own.values()))
        if not own:
            raise MotionError(f"{label}: holds no generalized action: make one in it first")
        raise MotionError(f"{label}: holds {len(own)} generalized actions: {names} with FILE#ACTION")
    if name in own:
        return own[name]
    if any(action.name == name for action in found):
        raise MotionError(f"{label}: action {name!r} is not generalized, it has no channels: {names}")
    raise MotionError(f"{label}: has no action {name!r}: {names}")


def _rate(scene: bpy.types.Scene) -> float:
    return scene.render.fps / scene.render.fps_base
