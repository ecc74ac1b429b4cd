"""Generalized actions for the command line: found in a .blend or in the open file, brought into other files."""

import contextlib
import tempfile
from collections.abc import Callable, Iterator, Sequence
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
        if self.path is None or is_open(self.path):
            return bpy.data.actions[self.name]
        with quiet(errors=True), bpy.data.libraries.load(str(self.path)) as (theirs, ours):  # pyright: ignore[reportGeneralTypeIssues]
            ours.actions = [action for action in theirs.actions if action == self.name]
        return ours.actions[0]

    def bring_object(self, name: str) -> bpy.types.Object | None:
        """Return an object of the open file or of the action's, which is added then; None when neither has it."""
        here = bpy.data.objects.get(name)
        if here is not None or self.path is None or is_open(self.path):
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
    with _meant(text, stays_open, _choose) as (action,):
        yield action


@contextlib.contextmanager
def all_found(text: str, stays_open: bool) -> Iterator[list[ActionFile]]:
    """Find the actions that ``FILE.blend#Action``, a name, or for all of its generalized ones ``FILE.blend`` means.

    Arguments and errors as for `found`.
    """
    with _meant(text, stays_open, _choose_all) as actions:
        yield actions


_Chooser = Callable[[Sequence[bpy.types.Action], str | None, str], list[bpy.types.Action]]


@contextlib.contextmanager
def _meant(text: str, stays_open: bool, choose: _Chooser) -> Iterator[list[ActionFile]]:
    request = Request.parse(text)
    if request.path.exists() and not is_open(request.path):
        request.check()
        if request.path.suffix.lower() != ".blend":
            raise FileError(f"{request.path}: holds no generalized actions: only .blend files do")
        yield _in_file(request.path.absolute(), request.action, str(request.path), choose)
        return
    if request.path.exists():
        actions = choose(list(bpy.data.actions), request.action, str(request.path))
    elif request.path.suffix or request.action:
        raise FileError(f"{request.path}: no such file: check the path")
    else:
        actions = choose(list(bpy.data.actions), text, "the open file")
    rate = _rate(rig.scene_of())
    known = [(action.name, definitions.read(action)) for action in actions]
    if stays_open:
        yield [ActionFile(None, name, definition, rate) for name, definition in known]
        return
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "open.blend")
        bpy.data.libraries.write(str(path), {*actions, *bpy.data.objects}, fake_user=True)
        yield [ActionFile(path, name, definition, rate) for name, definition in known]


def is_open(path: Path) -> bool:
    """Return whether a file is the one that is open."""
    return bool(bpy.data.filepath) and path.is_file() and path.samefile(bpy.data.filepath)


def _in_file(path: Path, name: str | None, label: str, choose: _Chooser) -> list[ActionFile]:
    """Look into a file without leaving anything of it in the open one."""
    before = set(bpy.data.libraries)
    try:
        with quiet(errors=True), bpy.data.libraries.load(str(path), link=True) as (theirs, ours):  # pyright: ignore[reportGeneralTypeIssues]
            ours.actions, ours.scenes = list(theirs.actions), list(theirs.scenes)[:1]
    except OSError as error:
        raise FileError(f"{label}: is no blend file that this Blender can read: save it again") from error
    try:
        actions = choose(list(ours.actions), name, label)
        rate = _rate(ours.scenes[0] if ours.scenes else rig.scene_of())
        with naming(label):
            return [ActionFile(path, action.name, definitions.read(action), rate) for action in actions]
    finally:
        bpy.data.batch_remove([library for library in bpy.data.libraries if library not in before])


def _choose(found: Sequence[bpy.types.Action], name: str | None, label: str) -> list[bpy.types.Action]:
    """Return the generalized action that is meant: the named one, or the only one."""
    own = _generalized(found)
    names = f"choose one of {listed(own, 20)}" if own else "it holds no generalized action; make one first"
    if name is None:
        if len(own) == 1:
            return list(own.values())
        if not own:
            raise MotionError(f"{label}: holds no generalized action: make one in it first")
        raise MotionError(f"{label}: holds {len(own)} generalized actions: {names} with FILE#ACTION")
    if name in own:
        return [own[name]]
    if any(action.name == name for action in found):
        raise MotionError(f"{label}: action {name!r} is not generalized, it has no channels: {names}")
    raise MotionError(f"{label}: has no action {name!r}: {names}")


def _choose_all(found: Sequence[bpy.types.Action], name: str | None, label: str) -> list[bpy.types.Action]:
    """Return the generalized actions that are meant: the named one, or all."""
    own = _generalized(found)
    return list(own.values()) if name is None and own else _choose(found, name, label)


def _generalized(found: Sequence[bpy.types.Action]) -> dict[str, bpy.types.Action]:
    return {a.name: a for a in sorted(found, key=lambda a: a.name) if definitions.is_generalized(a)}


def _rate(scene: bpy.types.Scene) -> float:
    return scene.render.fps / scene.render.fps_base
