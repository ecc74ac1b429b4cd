"""Selecting the bodies that a context finds, and choosing which of them a varying channel plays on."""

from dataclasses import fields
from typing import Any

import bpy
from bpy.props import BoolProperty, EnumProperty, IntProperty, StringProperty

from ...core.errors import MotionError, RigError
from ...core.morph.context import Context
from .. import collect
from ..morph import cast, choice, definitions, keys, query
from ..morph.properties import MORPHRETARGET_PG_context
from ..properties import of_rig
from .generalized import any_performer, performer_meant
from .manners import Status, refuse, reporting, scene_in

_QUERY: dict[str, Any] = {own.name: MORPHRETARGET_PG_context.__annotations__[own.name] for own in fields(Context)}
"""Settings of a context, by name."""


def _plain(declared: Any) -> Any:
    """Return a setting like one of a context, without what the context does when it changes."""
    return EnumProperty(**{key: value for key, value in declared.keywords.items() if key not in {"update", "attr"}})


class _Query:
    """The settings of a context, as an operator takes them."""

    __annotations__ = {name: _plain(declared) for name, declared in _QUERY.items()}


class MORPHRETARGET_OT_select_bodies(_Query, bpy.types.Operator):
    bl_idname = "morph_retarget.select_bodies"
    bl_label = "Select Bodies"
    bl_description = "Select the bones of the bodies that a channel poses, or that a context finds"
    bl_options = {"REGISTER", "UNDO"}

    character: StringProperty(name="Character", description="Armature object; all that play the action when empty")
    use_channel: BoolProperty(
        name="Of Channel", description="Bodies that a channel poses, not those of the context below", default=True
    )
    channel: StringProperty(name="Channel", description="Channel of the action; the active one when empty")

    @classmethod
    def poll(cls, _: bpy.types.Context) -> bool:
        return len(bpy.data.armatures) > 0 or refuse(cls, "There is no armature in this file")

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        found = self._found(context)
        count = sum(len(names) for names, _ in found.values())
        if not count:
            what = f"channel {self.channel!r}" if self.use_channel and self.channel else "the context"
            raise RigError(f"{what} selects nothing on {', '.join(ob.name for ob in found)}: change the context")
        for ob in query.show_in_pose_mode(context, list(found)):
            query.choose_bones(ob, *found.get(ob, ((), "")))
        self.report({"INFO"}, f"Bodies selected: {count}")
        return {"FINISHED"}

    def _found(self, context: bpy.types.Context) -> dict[bpy.types.Object, tuple[list[str], str]]:
        """Return the bones to select by character, and the one that shall be active if it is among them."""
        if not self.use_channel:
            wanted = definitions.context(self)  # type: ignore[arg-type]
            characters = [collect.armature(self.character, "character")] if self.character else None
            return {ob: (query.bodies_of(ob, wanted), "") for ob in characters or _all(context)}
        ob = performer_meant(context, self.character)
        action = cast.action_of(ob)
        assert action is not None, "performers play one"
        name = self.channel or keys.channel_named(action, "").name
        characters = [ob] if self.character else cast.playing(scene_in(context), action)
        out: dict[bpy.types.Object, tuple[list[str], str]] = {}
        for own in characters:
            item = of_rig(own).channels.get(name)
            out[own] = (query.bodies_of_channel(own, name), item.active_body if item is not None else "")
        return out


def _all(context: bpy.types.Context) -> list[bpy.types.Object]:
    """Return the characters of the scene, else the active one.

    Raises:
        RigError: There are none.
    """
    active = query.active_character(context)
    found = cast.performers(scene_in(context)) or ([active] if active is not None else [])
    if not found:
        raise RigError("no character is selected: select an armature, or name one")
    return found


class MORPHRETARGET_OT_choose_variant(bpy.types.Operator):
    bl_idname = "morph_retarget.choose_variant"
    bl_label = "Choose Variant"
    bl_description = "Choose in which of the possible ways an action plays on a character"
    bl_options = {"REGISTER", "UNDO"}

    character: StringProperty(name="Character", description="Armature object; the active one when empty")
    choice: EnumProperty(
        name="Choice",
        description="Which variant",
        items=[
            ("NUMBER", "Number", "The one with this number, counted from 0"),
            ("NEXT", "Next", "The next one"),
            ("PREVIOUS", "Previous", "The one before"),
            ("NEAREST", "Nearest", "The one whose bodies have the shortest way to their targets at this frame"),
        ],
    )
    variant: IntProperty(name="Variant", description="Number of the variant, counted from 0", min=0)

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return any_performer(cls, context)

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        ob = performer_meant(context, self.character)
        member = cast.member(ob)
        count = len(member.part.binding.variants)
        if count == 0:
            raise MotionError(f"{member.action.name!r} has one way to play on {ob.name!r}: let a channel vary first")
        now = member.part.binding.variant
        if self.choice == "NEAREST":
            chosen = choice.nearest_variant(member, ob, context.evaluated_depsgraph_get())
        else:
            chosen = {"NUMBER": self.variant, "NEXT": now + 1, "PREVIOUS": now - 1}[self.choice]
        if self.choice == "NUMBER" and chosen >= count:
            raise MotionError(f"there are {count} variants on {ob.name!r}: choose one from 0 to {count - 1}")
        of_rig(ob).variant = chosen % count
        return {"FINISHED"}


CLASSES = (MORPHRETARGET_OT_select_bodies, MORPHRETARGET_OT_choose_variant)
