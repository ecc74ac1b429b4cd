"""Annotations of actions: found from the motion itself, and forgotten."""

from collections.abc import Generator

import bpy
from bpy.props import StringProperty

from ...core.clips.motions import finding
from ...core.clips.motions.annotations import Annotations
from ...core.errors import MotionError, RigError
from .. import collect
from ..directing import annotations, clips
from .generalized import selected
from .manners import Status, refuse, reporting, scene_in
from .stepping import Stepping

_ACTION = StringProperty(name="Action", description="Action that is annotated; that of the armature when empty")


def mover_meant(context: bpy.types.Context, name: str) -> bpy.types.Object:
    """Return a named armature, else the active one.

    Raises:
        RigError: There is none.
    """
    found = [collect.armature(name, "motion")] if name else selected(context)
    if not found:
        raise RigError("no armature is selected: select the one that the action moves, or name it")
    return found[0]


def action_in_hand(context: bpy.types.Context) -> bpy.types.Action | None:
    """Return the ordinary action that is shown in an Action editor, else that of the active object."""
    shown = getattr(context.space_data, "action", None)
    if isinstance(shown, bpy.types.Action):
        return shown
    ob = context.object
    return None if ob is None or ob.animation_data is None else ob.animation_data.action


class MORPHRETARGET_OT_find_annotations(Stepping, bpy.types.Operator):
    bl_idname = "morph_retarget.find_annotations"
    bl_label = "Find Annotations"
    bl_description = (
        "Find out from the motion what it is, how fast it goes and when the feet touch down, which markers will tell"
    )
    bl_options = {"REGISTER", "UNDO"}
    doing = "Looking at the motion"

    armature: StringProperty(name="Armature", description="Armature object that the action moves; the active one")
    action: _ACTION

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return bool(selected(context)) or refuse(cls, "Select an armature that moves")

    def start(self, context: bpy.types.Context) -> Generator[float, None, tuple[bpy.types.Action, Annotations]]:
        ob = mover_meant(context, self.armature)
        shown = action_in_hand(context)
        name = self.action or ("" if shown is None or self.armature else shown.name)
        action, slot = collect.actions_of(ob, name)[0]
        _check(action)
        self.armature, self.action = ob.name, action.name
        return _found(ob, action, slot, scene_in(context))

    def finish(self, _: bpy.types.Context, result: tuple[bpy.types.Action, Annotations]) -> Status:
        action, found = result
        speed = f" at {found.speed:.2g} m/s" if found.speed else ""
        self.report({"INFO"}, f"{action.name!r} is {found.kind}{speed}, with {len(found.strikes)} steps")
        return {"FINISHED"}


def _found(
    ob: bpy.types.Object, action: bpy.types.Action, slot: bpy.types.ActionSlot, scene: bpy.types.Scene
) -> Generator[float, None, tuple[bpy.types.Action, Annotations]]:
    """Find and keep the annotations of an action in steps; its style, which nobody finds, stays."""
    style = annotations.of_action(action).style
    sampled = yield from clips.sample(clips.Wanted(ob, action, slot), scene, annotated=False)
    found = finding.annotate(sampled.character, sampled.pose, sampled.seconds_per_frame, style=style)
    annotations.write(action, found, sampled.feet, sampled.first, sampled.rate)
    return action, found


class MORPHRETARGET_OT_clear_annotations(bpy.types.Operator):
    bl_idname = "morph_retarget.clear_annotations"
    bl_label = "Clear Annotations"
    bl_description = "Forget what is known of the action, with the markers of its steps; other markers stay"
    bl_options = {"REGISTER", "UNDO"}

    action: _ACTION

    @classmethod
    def poll(cls, _: bpy.types.Context) -> bool:
        return len(bpy.data.actions) > 0 or refuse(cls, "There is no action")

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        action = bpy.data.actions.get(self.action) if self.action else action_in_hand(context)
        if action is None:
            raise MotionError(f"there is no action {self.action!r}: select an armature that plays one, or name one")
        _check(action)
        self.action = action.name
        annotations.of_action(action).clear()
        annotations.clear_strikes(action)
        return {"FINISHED"}


def _check(action: bpy.types.Action) -> None:
    if action.library is not None:
        raise MotionError(f"action {action.name!r} is linked from {action.library.filepath}: make it local first")


CLASSES = (MORPHRETARGET_OT_find_annotations, MORPHRETARGET_OT_clear_annotations)
