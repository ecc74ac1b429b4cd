"""Targets that follow their source while frames change: the whole clip is transferred once, frames are served from it.

Everything here is run-time state, keyed by Blender's session-wide number of the object and dropped on load, undo and
redo. What is shown depends on the time alone, never on how often it was asked for.
"""

from collections.abc import Generator, Iterable
from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Matrix

from ..core.errors import MorphError, MotionError
from ..core.pipeline import Result
from . import actions, collect, live_motion, retarget, writing
from .channels import OFF_REST
from .controls import carrying
from .controls.task import Onto, Task
from .live_motion import Motion
from .properties import of_rig, of_scene
from .retarget import Source
from .rig import pose_of
from .steps import within
from .writing import Written


@dataclass(frozen=True, eq=False)
class _Carried:
    """What Blender has made of a motion on controls, and of what: it is costly, and undo asks for it again."""

    task: Task
    result: Result
    onto: Onto
    written: Written

    def fits(self, task: Task, result: Result, onto: Onto) -> bool:
        """Return whether the same would come of other work."""
        ours, theirs = self.task, task
        same = (ours.given, ours.reaches, set(ours.only), self.onto) == (
            theirs.given,
            theirs.reaches,
            set(theirs.only),
            onto,
        )
        points, others = self.result.motion.points, result.motion.points
        return same and (
            points.shape == others.shape
            and result.root_motion is self.result.root_motion
            and np.allclose(points, others, atol=1e-6)
            and np.allclose(self.result.motion.turns, result.motion.turns, atol=1e-6)
        )


_motions: dict[int, Motion] = {}
_carried: dict[int, _Carried] = {}
_preparing: list[int] = []
_waiting: set[int] = set()
"""Armatures that are given their motion as soon as the window is served."""
problems: dict[int, str] = {}
"""Why an armature has stopped following, by session-wide number."""


def following(ob: bpy.types.Object) -> bool:
    """Return whether an armature follows a source."""
    return ob.type == "ARMATURE" and of_rig(ob).live_source is not None


def start(scene: bpy.types.Scene, source: bpy.types.Object, target: bpy.types.Object) -> None:
    """Let a target follow a source.

    Raises:
        MorphError: The motion cannot be transferred.
    """
    retarget.run(starting(scene, source, target))


def starting(
    scene: bpy.types.Scene, source: bpy.types.Object, target: bpy.types.Object
) -> Generator[float, None, None]:
    """Do the same in steps; yields the share done. Closed before its end it leaves everything as it was.

    Raises:
        MorphError: The motion cannot be transferred.
    """
    retarget.check_target(target)
    _carried.pop(target.session_uid, None)
    clip = yield from within(0.0, 0.5, _sampled(scene, source, target))
    if of_rig(target).live_source is None:
        of_rig(target).home = [value for row in target.matrix_basis for value in row]
    motion = yield from within(0.5, 1.0, _transferred(scene, source, target, clip))
    _accept(target, motion)
    problems.pop(target.session_uid, None)
    of_rig(target).live_source = source
    show_frame(scene)


def stop(target: bpy.types.Object, clear: bool) -> None:
    """Let a target follow no more.

    Args:
        target: The armature.
        clear: Put the bones that followed back to rest; else they keep the pose.
    """
    following_till_now = following(target)
    of_rig(target).live_source = None
    motion = _motions.pop(target.session_uid, None)
    if not clear:
        return
    if following_till_now:
        _go_home(target)
    if motion is not None:
        motion.clear(target)
    else:
        for bone in pose_of(target).bones:
            bone.matrix_basis.identity()
    target.update_tag(refresh={"DATA"})


def forget(for_good: bool = True) -> None:
    """Drop all motions; they are transferred anew when they are next needed.

    Args:
        for_good: Drop what controls were found to do as well; else it is kept for motions that turn out to be the same.
    """
    _motions.clear()
    problems.clear()
    if for_good:
        _carried.clear()
        _waiting.clear()


def catch_up(scene: bpy.types.Scene) -> None:
    """Give targets on controls the motions that they lack: while frames change, Blender cannot be asked for them."""
    for target in _targets(scene):
        if target.session_uid not in _motions and not _is_plain(scene, target):
            _renew(scene, target)


def refresh(scene: bpy.types.Scene) -> None:
    """Transfer all motions anew and show them: something that they depend on has changed."""
    layer = bpy.context.view_layer
    assert layer is not None, "a setting was changed, so there is a scene"
    for target in _targets(scene):
        layer.update()  # what was shown last may not have been evaluated yet
        _motions.pop(target.session_uid, None)
        _renew(scene, target)
    show_frame(scene)


def _renew(scene: bpy.types.Scene, target: bpy.types.Object) -> None:
    try:
        _accept(target, _prepare(scene, of_rig(target).live_source, target))
    except MorphError as error:
        _give_up(target, error)


def _renew_soon(target: bpy.types.Object) -> None:
    """Give a target its motion as soon as the window is served: while a frame changes, Blender cannot be asked."""
    number = target.session_uid
    _motions.pop(number, None)

    def renew() -> None:
        if number not in _waiting:
            return  # all was forgotten meanwhile
        _waiting.discard(number)
        for scene in bpy.data.scenes:
            catch_up(scene)
            show_frame(scene)

    if number not in _waiting:
        _waiting.add(number)
        bpy.app.timers.register(renew, first_interval=0.0)


def _accept(target: bpy.types.Object, motion: Motion) -> None:
    """Take a motion as that of a target, with its controls switched for it."""
    _motions[target.session_uid] = motion
    motion.switch(target)


def show_frame(scene: bpy.types.Scene, among: Iterable[bpy.types.Object] | None = None) -> None:
    """Put the pose of the scene's frame on all targets; one that cannot be shown follows no more, and says why.

    Args:
        scene: The scene.
        among: All its armatures, where they are known.
    """
    if _preparing:
        return  # a source is being sampled by stepping through frames
    for target in _targets(scene, among):
        try:
            motion = _motions.get(target.session_uid)
            if motion is None or motion.followed != _followed(of_rig(target).live_source):
                if not _is_plain(scene, target) and not bpy.app.background:
                    _renew_soon(target)
                    continue
                motion = _prepare(scene, of_rig(target).live_source, target, may_step=False)
                _accept(target, motion)
            motion.show(target, scene.frame_current_final)
        except MorphError as error:
            _give_up(target, error)


def _give_up(target: bpy.types.Object, error: MorphError) -> None:
    problems[target.session_uid] = str(error)
    of_rig(target).live_source = None


def _targets(scene: bpy.types.Scene, among: Iterable[bpy.types.Object] | None = None) -> list[bpy.types.Object]:
    return [ob for ob in (scene.objects if among is None else among) if following(ob)]


def _followed(source: bpy.types.Object) -> tuple[int, int]:
    action, _ = actions.assigned(source)
    return (action.session_uid if action else 0, source.session_uid)


def _is_plain(scene: bpy.types.Scene, target: bpy.types.Object) -> bool:
    """Return whether a target is posed by its bones, so that its motion is found without asking Blender."""
    return carrying.is_plain(
        target, Onto(of_scene(scene).onto), {*of_rig(target).controls(), *of_rig(target).reaches()}
    )


def _prepare(
    scene: bpy.types.Scene, source: bpy.types.Object, target: bpy.types.Object, may_step: bool = True
) -> Motion:
    if not may_step and collect.needs_steps(source, *collect.actions_of(source)[0]):
        raise MotionError(f"armature {source.name!r} is moved by more than its action: switch Live on again")
    clip = retarget.run(_sampled(scene, source, target))
    return retarget.run(_transferred(scene, source, target, clip, may_step))


def _sampled(
    scene: bpy.types.Scene, source: bpy.types.Object, target: bpy.types.Object
) -> Generator[float, None, Source]:
    """Sample what a source plays in steps, while nothing is shown."""
    action, slot = collect.actions_of(source)[0]
    _preparing.append(target.session_uid)
    try:
        return (yield from collect.source_of(source, action, slot, scene))
    finally:
        _preparing.remove(target.session_uid)


def _transferred(
    scene: bpy.types.Scene, source: bpy.types.Object, target: bpy.types.Object, clip: Source, may_step: bool = True
) -> Generator[float, None, Motion]:
    """Transfer a sampled clip to a target in steps, while nothing is shown."""
    _preparing.append(target.session_uid)
    try:
        _go_home(target)
        own, character = collect.target_of(target)
        options = collect.options_of(scene, target)
        ground = collect.ground_of(scene, character)
        given = collect.contacts_of(source, collect.actions_of(source)[0][0])
        task, result = retarget.task_of(clip, own, character, options, given, ground)
        kept = _carried.get(target.session_uid)
        if kept is not None and kept.fits(task, result, options.onto):
            made = kept.written
        elif may_step or _is_plain(scene, target):
            made = yield from writing.written(clip.clip, task, result, options.onto, resample=False, scene=scene)
        else:
            raise MotionError(
                f"what the controls of armature {target.name!r} do is not found out while frames change: "
                "switch Live on again"
            )
        if not _is_plain(scene, target):
            _carried[target.session_uid] = _Carried(task, result, options.onto, made)
        return live_motion.of_written(target, made, _followed(source))
    finally:
        _preparing.remove(target.session_uid)


def _go_home(target: bpy.types.Object) -> None:
    """Put an object back to where it was before it began to follow; its world matrix is right at once."""
    home, now = Matrix(np.array(of_rig(target).home).reshape(4, 4).tolist()), target.matrix_basis
    if np.abs(np.array(home) - np.array(now)).max() > OFF_REST:
        target.matrix_world = target.matrix_world @ now.inverted() @ home
