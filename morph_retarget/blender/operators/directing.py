"""Directing: telling characters what to do, command by command."""

from typing import Any

import bpy
from bpy.props import EnumProperty, IntProperty, StringProperty

from ...core.clips.commands.command import Verb
from ...core.errors import RigError, listed
from ..directing import known, marking
from ..directing.properties import MORPHRETARGET_PG_command, MORPHRETARGET_PG_directing
from ..locomotion.properties import Source
from ..morph import cast, query
from ..properties import of_rig
from .generalized import characters_meant, performer_meant
from .locomotion import let_go
from .manners import OfArmature, OfSelected, Status, armature_meant, reporting, scene_in

NAME = "Directing"
"""Of actions without channels."""

_PLACE = IntProperty(
    name="Command", description="Place of the command in the list; the active one when -1", default=-1, min=-1
)
_VERBS = [(verb.value, verb.value.title(), "What shall be done with the motion") for verb in Verb]


def directing_of(ob: bpy.types.Object) -> MORPHRETARGET_PG_directing:
    """Return what an armature is told to do, for a change.

    Raises:
        RigError: The armature is linked.
    """
    if ob.library is not None:
        raise RigError(f"{ob.name!r} is linked from {ob.library.filepath}: make a library override of it first")
    return of_rig(ob).directing


def command_meant(ob: bpy.types.Object, place: int) -> MORPHRETARGET_PG_command:
    """Return a command of an armature by its place, the active one for -1.

    Raises:
        RigError: There is none, or the armature is linked.
    """
    own = directing_of(ob)
    place = own.active_command if place < 0 else place
    if not 0 <= place < len(own.commands):
        raise RigError(f"{ob.name!r} has no such command: choose one in the list")
    return own.commands[place]


class MORPHRETARGET_OT_direct(OfSelected, bpy.types.Operator):
    bl_idname = "morph_retarget.direct"
    bl_label = "Direct"
    bl_description = (
        "Let the selected armatures do what they are told by commands: walk, run, wave, look at and reach for things"
    )

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        for ob in characters_meant(context, self.character):
            directing_of(ob)  # what is linked is refused before anything has changed
        found = let_go(context, self.character, NAME)
        for ob in found:
            of_rig(ob).gait.source = Source.COMMANDS.value
            of_rig(ob).gait.enabled = True
        self.report({"INFO"}, f"{listed([ob.name for ob in found], 3)} can be directed now: add commands")
        return {"FINISHED"}


class MORPHRETARGET_OT_add_command(OfArmature, bpy.types.Operator):
    bl_idname = "morph_retarget.add_command"
    bl_label = "Add Command"
    bl_description = "Tell the character at the present frame to do something"

    verb: EnumProperty(name="Verb", description="What shall be done with the motion", items=_VERBS)
    model: StringProperty(name="Model", description="Motion or behavior that is meant", default="walk")

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        ob = armature_meant(context, self.character)
        own = directing_of(ob)
        item = own.command(scene_in(context).frame_current_final, self.verb, self.model)
        for name in known.needed(ob, self.model) if self.verb == Verb.START else ():
            item.expect(name)
        return {"FINISHED"}


class MORPHRETARGET_OT_remove_command(OfArmature, bpy.types.Operator):
    bl_idname = "morph_retarget.remove_command"
    bl_label = "Remove Command"
    bl_description = "Take the chosen command out of the list"

    place: _PLACE

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        ob = armature_meant(context, self.character)
        command_meant(ob, self.place)
        own = directing_of(ob)
        place = own.active_command if self.place < 0 else self.place
        if place < _inherited(ob):
            raise RigError(f"this command of {ob.name!r} comes from its library: mute it instead")
        own.remove(place)
        return {"FINISHED"}


def _inherited(ob: bpy.types.Object) -> int:
    """Return how many commands an override has from its library."""
    override = ob.override_library
    if override is None or not isinstance(override.reference, bpy.types.Object):
        return 0
    return len(of_rig(override.reference).directing.commands)


class MORPHRETARGET_OT_move_command(OfArmature, bpy.types.Operator):
    bl_idname = "morph_retarget.move_command"
    bl_label = "Move to Present Frame"
    bl_description = "Give the command at the present frame"

    place: _PLACE

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        item = command_meant(armature_meant(context, self.character), self.place)
        item.frame = scene_in(context).frame_current_final
        return {"FINISHED"}


class MORPHRETARGET_OT_add_parameter(OfArmature, bpy.types.Operator):
    bl_idname = "morph_retarget.add_parameter"
    bl_label = "Add Parameter"
    bl_description = "Say more about how the command is carried out"

    place: _PLACE
    name: StringProperty(name="Name", description="What is said; something new that can be named later when empty")
    model: StringProperty(name="Model", description="Whose parameter is described", options={"HIDDEN", "SKIP_SAVE"})

    @classmethod
    def description(cls, context: bpy.types.Context, properties: Any) -> str:
        """Return what the parameter means."""
        ob = query.active_character(context)
        found = None if ob is None else known.parameters(ob, properties.model).get(properties.name)
        return cls.bl_description if found is None else found.description

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        item = command_meant(armature_meant(context, self.character), self.place)
        if self.name in item.parameters:
            raise RigError(f"{item.words!r} says its {self.name} already: change that")
        item.expect(self.name or "parameter")
        return {"FINISHED"}


class MORPHRETARGET_OT_remove_parameter(OfArmature, bpy.types.Operator):
    bl_idname = "morph_retarget.remove_parameter"
    bl_label = "Remove Parameter"
    bl_description = "Leave this as it usually is"

    place: _PLACE
    name: StringProperty(name="Name", description="What is not said any more")

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        command_meant(armature_meant(context, self.character), self.place).remove(self.name)
        return {"FINISHED"}


class MORPHRETARGET_OT_commands_to_markers(OfArmature, bpy.types.Operator):
    bl_idname = "morph_retarget.commands_to_markers"
    bl_label = "Commands to Markers"
    bl_description = (
        "Move the commands of the list onto pose markers of the character's action, "
        "where they can be dragged: Action editor, Marker > Show Pose Markers"
    )

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        ob = performer_meant(context, self.character)
        action = action_played(ob)
        count = marking.to_markers(directing_of(ob), action)
        self.report({"INFO"}, f"Moved {count} commands to markers of {action.name!r}")
        return {"FINISHED"}


class MORPHRETARGET_OT_markers_to_commands(OfArmature, bpy.types.Operator):
    bl_idname = "morph_retarget.markers_to_commands"
    bl_label = "Markers to Commands"
    bl_description = "Move the commands among the pose markers of the character's action into its list"

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        ob = performer_meant(context, self.character)
        count = marking.to_list(directing_of(ob), action_played(ob))
        self.report({"INFO"}, f"Moved {count} commands to the list of {ob.name!r}")
        return {"FINISHED"}


def action_played(ob: bpy.types.Object) -> bpy.types.Action:
    """Return the generalized action of a character that plays one."""
    action = cast.action_of(ob)
    assert action is not None, "performers play one"
    return action


CLASSES = (
    MORPHRETARGET_OT_direct,
    MORPHRETARGET_OT_add_command,
    MORPHRETARGET_OT_remove_command,
    MORPHRETARGET_OT_move_command,
    MORPHRETARGET_OT_add_parameter,
    MORPHRETARGET_OT_remove_parameter,
    MORPHRETARGET_OT_commands_to_markers,
    MORPHRETARGET_OT_markers_to_commands,
)
