"""What all operators share: errors as reports, and which rig is meant."""

import functools
import inspect
from collections.abc import Callable
from typing import Any

import bpy
from bpy.props import IntProperty, StringProperty

from ...core.errors import MorphError, RigError
from .. import collect
from ..morph import query
from ..properties import of_scene
from ..rig import armature_of

Status = set[str]
PLACE = IntProperty(name="Place", description="Place in the list; that of the chosen one when -1", default=-1, min=-1)
"""What operators ask for that take one thing out of a list."""


def reporting(method: Callable[[Any, bpy.types.Context], Status]) -> Callable[[Any, bpy.types.Context], Status]:
    """Turn a user's error into a report; scripts get it as a RuntimeError, as from all of Blender's operators."""

    @functools.wraps(method)
    def polite(self: Any, context: bpy.types.Context) -> Status:
        try:
            return method(self, context)
        except MorphError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}

    return polite


class OfArmature:
    """What operators on one armature share; scripts may name it."""

    bl_options = {"REGISTER", "UNDO"}

    character: StringProperty(name="Character", description="Armature object; the active one when empty")

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Return whether there is any."""
        return armature_poll(cls, context)  # type: ignore[arg-type]  # the operator that this is part of


class Asking:
    """What operators share that ask for their settings first, where there is a window."""

    def invoke(self, context: bpy.types.Context, _: bpy.types.Event) -> Status:
        """Ask in a dialog."""
        return _windows(context).invoke_props_dialog(self)  # type: ignore[arg-type]


class Confirming:
    """What operators share that cannot be taken back."""

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> Status:
        """Ask whether that is meant."""
        return _windows(context).invoke_confirm(self, event)  # type: ignore[arg-type]


def _windows(context: bpy.types.Context) -> bpy.types.WindowManager:
    assert context.window_manager is not None, "there is a window"
    return context.window_manager


class OfSelected(OfArmature):
    """What operators on all selected armatures share; scripts may name one."""

    character: StringProperty(name="Character", description="Armature object; the selected ones when empty")


def scene_in(context: bpy.types.Context) -> bpy.types.Scene:
    """Return the scene; operators are only offered where there is one."""
    assert context.scene is not None, "operators run in a window with a scene"
    return context.scene


def shown_rig(context: bpy.types.Context) -> bpy.types.Object | None:
    """Return the rig whose joints the panel lists."""
    settings = of_scene(scene_in(context))
    return settings.source if settings.shown == "SOURCE" else settings.target


def rig_meant(context: bpy.types.Context, name: str) -> bpy.types.Object:
    """Return the armature called ``name``, or the one that the panel shows.

    Raises:
        RigError: There is none.
    """
    if name:
        return collect.armature(name, "rig")
    found = shown_rig(context)
    if found is None:
        raise RigError("no rig is chosen: set Source and Target in the panel, or name a rig")
    return found


def pair_poll(cls: type[bpy.types.Operator], context: bpy.types.Context) -> bool:
    """Return whether a source and a target are chosen, or none of them, as when a script names them."""
    if context.scene is None or len([ob for ob in context.scene.objects if ob.type == "ARMATURE"]) < 2:
        return refuse(cls, "The scene needs two armatures, one that moves and one that shall move")
    settings = of_scene(context.scene)
    if settings.source is None and settings.target is None:
        return True
    if settings.source is None or settings.target is None:
        return refuse(cls, f"Choose a {'source' if settings.source is None else 'target'} first")
    return settings.source != settings.target or refuse(cls, "Source and target are the same armature")


def armature_poll(cls: type[bpy.types.Operator], context: bpy.types.Context) -> bool:
    """Return whether the scene has an armature."""
    there = context.scene is not None and any(ob.type == "ARMATURE" for ob in context.scene.objects)
    return there or refuse(cls, "The scene needs an armature")


def armature_meant(context: bpy.types.Context, name: str) -> bpy.types.Object:
    """Return the armature of a name, else the active character.

    Raises:
        RigError: There is none.
    """
    ob = collect.armature(name, "character") if name else query.active_character(context)
    if ob is None:
        raise RigError("no armature is active: select one, or give its name")
    return ob


def active_bone(ob: bpy.types.Object) -> str:
    """Return the name of the active bone of an armature.

    Raises:
        RigError: There is none.
    """
    active = armature_of(ob).bones.active
    if active is None:
        raise RigError(f"no bone of {ob.name!r} is active: select one in Pose mode, or give its name")
    return active.name


def place_meant(operator: Any, count: int, active: int, missing: str) -> int:
    """Return which item of a list an operator with a `PLACE` means, and keep it in there.

    Args:
        operator: It.
        count: Length of the list.
        active: Place of the chosen item.
        missing: What is wrong if there is no such item, and what to do.

    Raises:
        RigError: There is none.
    """
    place = active if operator.place < 0 else operator.place
    if not 0 <= place < count:
        raise RigError(missing)
    operator.place = place
    return place


def show_alone(context: bpy.types.Context, ob: bpy.types.Object) -> None:
    """Select an object and no other, and make it the active one, so that the Graph Editor shows its curves."""
    layer = context.view_layer
    assert layer is not None, "operators run in a window with a scene"
    if context.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    for other in context.selected_objects:
        other.select_set(False)
    ob.select_set(True)
    layer.objects.active = ob


def forget_settings(cls: type[bpy.types.Operator]) -> None:
    """Let an operator begin anew each time, but for the settings that it names as `remembered`.

    Blender would give a button that leaves a setting open what was chosen last, and so act on the character before.
    """
    remembered = getattr(cls, "remembered", ())
    for base in cls.__mro__:
        own = inspect.get_annotations(base) if base.__module__.startswith(__package__ or "") else {}
        for name, declared in own.items():
            if name not in remembered and hasattr(declared, "keywords"):
                declared.keywords["options"] = {*declared.keywords.get("options", {"ANIMATABLE"}), "SKIP_SAVE"}


def refuse(cls: type[bpy.types.Operator], reason: str) -> bool:
    """Say why an operator cannot run now, and return False for its ``poll``."""
    cls.poll_message_set(reason)
    return False
