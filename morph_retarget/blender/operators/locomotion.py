"""Locomotion: letting characters go over the ground, mixing styles, keying how they go."""

import bpy
from bpy.props import EnumProperty, IntProperty

from ...core import play
from ...core.errors import RigError, listed
from ..locomotion import foot_path, going, standing
from ..locomotion.properties import KEYED, STYLE_ITEMS, MORPHRETARGET_PG_gait
from ..morph import analyses, cast, definitions, perform
from ..properties import of_rig
from .generalized import characters_meant, let_play, performer_meant
from .manners import (
    PLACE,
    OfArmature,
    OfSelected,
    Status,
    armature_meant,
    place_meant,
    refuse,
    reporting,
    scene_in,
    show_alone,
)

NAME = "Locomotion"
"""Of actions without channels, and of the group of curves."""


def any_walker(cls: type[bpy.types.Operator], context: bpy.types.Context) -> bool:
    """Return whether a character of the scene has locomotion, for a ``poll``."""
    found = cast.performers(context.scene) if context.scene is not None else []
    return any(of_rig(ob).gait.enabled for ob in found) or refuse(cls, "No character has locomotion: add it to one")


class OfWalker(OfArmature):
    """What operators on one character that has locomotion share."""

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return any_walker(cls, context)  # type: ignore[arg-type]  # the operator that this is part of


class MORPHRETARGET_OT_add_locomotion(OfSelected, bpy.types.Operator):
    bl_idname = "morph_retarget.add_locomotion"
    bl_label = "Add Locomotion"
    bl_description = (
        "Let the selected armatures walk, run or crawl over the ground by themselves, "
        "beneath what their generalized actions do"
    )

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        found = let_go(context, self.character, NAME)
        for ob in found:
            of_rig(ob).gait.enabled = True
        self.report({"INFO"}, f"{listed([ob.name for ob in found], 3)} can go now: set a speed or a path")
        return {"FINISHED"}


def let_go(context: bpy.types.Context, character: str, name: str) -> list[bpy.types.Object]:
    """Return the characters that are meant, all of them able to go over the ground, and live.

    Args:
        context: Where some are selected.
        character: Name of one; the selected ones when empty.
        name: Of the new action without channels that those play which played nothing.

    Raises:
        RigError: There is none, or one cannot go.
    """
    found = characters_meant(context, character)
    for ob in found:
        _, its_character, bodies = analyses.of(ob)
        standing.of(its_character, play.root_of(bodies), of_rig(ob).gait)  # who cannot go is refused here
    idle = [ob for ob in found if cast.action_of(ob) is None]
    if idle:
        action = bpy.data.actions.new(name)
        action.use_fake_user = True
        definitions.make(action)
        let_play(idle, action)
    return found


class MORPHRETARGET_OT_remove_locomotion(OfWalker, bpy.types.Operator):
    bl_idname = "morph_retarget.remove_locomotion"
    bl_label = "Remove Locomotion"
    bl_description = "Let the character stay where its generalized action puts it; the settings are kept"

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        ob = performer_meant(context, self.character)
        if not of_rig(ob).gait.enabled:
            raise RigError(f"{ob.name!r} has no locomotion: choose a character that has")
        of_rig(ob).gait.enabled = False
        action = cast.action_of(ob)
        if action is not None and not cast.member(ob).definition.channels:
            cast.remove(ob)
            perform.release(ob)
        return {"FINISHED"}


class MORPHRETARGET_OT_add_gait_style(OfArmature, bpy.types.Operator):
    bl_idname = "morph_retarget.add_gait_style"
    bl_label = "Add Style"
    bl_description = "Mix another style into the gait, or give a group of legs a style of its own"

    style: EnumProperty(name="Style", description="Manner of going that is mixed in", items=STYLE_ITEMS)
    group: IntProperty(
        name="Legs", description="Group of legs, 1 for the longest; 0 for all of them", min=0, max=99, soft_max=4
    )

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        of_rig(armature_meant(context, self.character)).gait.add(self.style, self.group)
        return {"FINISHED"}


class MORPHRETARGET_OT_remove_gait_style(OfArmature, bpy.types.Operator):
    bl_idname = "morph_retarget.remove_gait_style"
    bl_label = "Remove Style"
    bl_description = "Take the chosen style out of the gait"

    place: PLACE

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        ob = armature_meant(context, self.character)
        own = of_rig(ob).gait
        missing = f"{ob.name!r} has no such style: choose one in the list"
        own.remove(place_meant(self, len(own.layers), own.active_layer, missing))
        self.character = ob.name
        return {"FINISHED"}


_SETTINGS = [
    (name, MORPHRETARGET_PG_gait.__annotations__[name].keywords["name"], "Key this at the present frame")
    for name in KEYED
]


class MORPHRETARGET_OT_key_locomotion(OfWalker, bpy.types.Operator):
    bl_idname = "morph_retarget.key_locomotion"
    bl_label = "Key Speed"
    bl_description = "Key how fast the character goes at the present frame; the gait changes with it"

    setting: EnumProperty(name="Setting", description="What is keyed", items=_SETTINGS)

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        ob = _walker_meant(context, self.character)
        ob.keyframe_insert(going.curve_path(self.setting), frame=scene_in(context).frame_current_final, group=NAME)
        return {"FINISHED"}


class MORPHRETARGET_OT_new_foot_path(OfWalker, bpy.types.Operator):
    bl_idname = "morph_retarget.new_foot_path"
    bl_label = "New Foot Path"
    bl_description = (
        "Draw the flight of the feet as curves: make an empty that has them, select it, "
        "and reshape its location and rotation in the Graph Editor"
    )

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        ob = _walker_meant(context, self.character)
        own = of_rig(ob).gait
        if own.foot_path is not None:
            raise RigError(f"{ob.name!r} has the foot path {own.foot_path.name!r}: reshape that, or remove it first")
        if ob.library is not None:
            raise RigError(f"{ob.name!r} is linked from {ob.library.filepath}: make a library override of it first")
        own.foot_path = empty = foot_path.new(ob, scene_in(context))
        show_alone(context, empty)
        return {"FINISHED"}


class MORPHRETARGET_OT_remove_foot_path(OfWalker, bpy.types.Operator):
    bl_idname = "morph_retarget.remove_foot_path"
    bl_label = "Remove Foot Path"
    bl_description = "Let feet fly as their style wants; the empty with the curves goes too if nothing else uses it"

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        ob = _walker_meant(context, self.character)
        own = of_rig(ob).gait
        if own.foot_path is None:
            raise RigError(f"{ob.name!r} has no foot path: its feet fly as their style wants")
        empty, own.foot_path = own.foot_path, None
        foot_path.remove(empty)
        return {"FINISHED"}


def _walker_meant(context: bpy.types.Context, name: str) -> bpy.types.Object:
    """Return the character that is meant, which has locomotion.

    Raises:
        RigError: There is none, or it has no locomotion.
    """
    ob = performer_meant(context, name)
    if not of_rig(ob).gait.enabled:
        raise RigError(f"{ob.name!r} has no locomotion: add it first")
    return ob


CLASSES = (
    MORPHRETARGET_OT_add_locomotion,
    MORPHRETARGET_OT_remove_locomotion,
    MORPHRETARGET_OT_add_gait_style,
    MORPHRETARGET_OT_remove_gait_style,
    MORPHRETARGET_OT_key_locomotion,
    MORPHRETARGET_OT_new_foot_path,
    MORPHRETARGET_OT_remove_foot_path,
)
