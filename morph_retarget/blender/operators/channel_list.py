"""Editing the list of a generalized action's channels, and their deforms."""

from dataclasses import replace

import bpy
from bpy.props import EnumProperty, StringProperty

from ...core.character.morphology import Capability
from ...core.errors import MotionError
from ...core.morph.context import Context
from ..morph import cast, definitions, keys, own_values, perform, tracks
from ..morph.properties import MORPHRETARGET_PG_context, of_action, unlike
from ..morph.values import MORPHRETARGET_PG_values
from ..properties import of_rig
from .generalized import FIRST, action_meant, add_channel, any_generalized
from .manners import Asking, Status, refuse, reporting, scene_in

_OF_CHARACTER = ("position", "rotation", "weight", "target", "target_bone", "active_body")


class _OnList(bpy.types.Operator):
    """What acts on the channels of a generalized action."""

    bl_options = {"REGISTER", "UNDO"}

    action: StringProperty(name="Action", description="Generalized action; the active character's when empty")

    @classmethod
    def poll(cls, _: bpy.types.Context) -> bool:
        return any_generalized(cls)


class _OnChannel(_OnList):
    """What acts on one channel."""

    channel: StringProperty(name="Channel", description="Name of the channel; the active one when empty")

    def _meant(self, context: bpy.types.Context) -> tuple[bpy.types.Action, int]:
        """Return the action, and the place of the channel in its list.

        Raises:
            MotionError: There is none.
        """
        action = action_meant(context, self.action)
        item = keys.channel_named(action, self.channel)
        return action, of_action(action).channels.find(item.name)


class MORPHRETARGET_OT_add_channel(_OnList):
    bl_idname = "morph_retarget.add_channel"
    bl_label = "Add Channel"
    bl_description = "Add a channel for the bodies that have a capability"

    name: StringProperty(name="Name", description="Name of the channel; that of the capability when empty")
    capability: EnumProperty(
        name="Type",
        description="What the bodies can do",
        items=[(c.value, c.value.title(), f"Bodies with the capability {c.value}") for c in Capability],
        default=Capability.GRASPER.value,
    )

    @classmethod
    def poll(cls, _: bpy.types.Context) -> bool:
        return len(bpy.data.actions) > 0 or refuse(cls, "There is no action in this file: make a generalized one")

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        action = action_meant(context, self.action)
        name = self.name or self.capability.title()
        add_channel(context, action, replace(FIRST, name=name, context=Context(Capability(self.capability))))
        of_action(action).active_channel = len(of_action(action).channels) - 1
        return {"FINISHED"}


class MORPHRETARGET_OT_remove_channel(_OnChannel):
    bl_idname = "morph_retarget.remove_channel"
    bl_label = "Remove Channel"
    bl_description = "Remove a channel with its keys"

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        action, place = self._meant(context)
        own = of_action(action)
        if len(own.channels) == 1:
            raise MotionError(f"{own.channels[0].name!r} is the last channel of {action.name!r}: add another one first")
        keys.remove(action, own.channels[place].name)
        own.channels.remove(place)
        own.active_channel = max(min(own.active_channel, len(own.channels) - 1), 0)
        perform.definition_changed(action)
        return {"FINISHED"}


class MORPHRETARGET_OT_duplicate_channel(_OnChannel):
    bl_idname = "morph_retarget.duplicate_channel"
    bl_label = "Duplicate Channel"
    bl_description = "Add a channel like this one below it, with its keys and values"

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        action, place = self._meant(context)
        own = of_action(action)
        wanted, secondary = definitions.channel(own.channels[place]), definitions.context(own.channels[place].secondary)
        name = unlike(wanted.name, [item.name for item in own.channels])
        made = definitions.add(action, replace(wanted, name=name))
        _fill(made.secondary, secondary)
        own.channels.move(len(own.channels) - 1, place + 1)
        own.active_channel = place + 1
        for ob in cast.playing(scene_in(context), action):
            own_values.ensure(ob, action)
            _copy_values(of_rig(ob).channels[wanted.name], of_rig(ob).channels[name])
        _copy_keys(action, wanted.name, name)
        perform.definition_changed(action)
        return {"FINISHED"}


def _fill(item: MORPHRETARGET_PG_context, wanted: Context) -> None:
    """Keep a secondary context that is set up but not in use."""
    for name in Context.__dataclass_fields__:
        setattr(item, name, getattr(wanted, name).value)


def _copy_values(old: MORPHRETARGET_PG_values, new: MORPHRETARGET_PG_values) -> None:
    for name in _OF_CHARACTER:
        setattr(new, name, getattr(old, name))
    new.deforms.clear()
    for deform in old.deforms:
        made = new.deforms.add()
        made.name, made.value = deform.name, deform.value


def _copy_keys(action: bpy.types.Action, old: str, new: str) -> None:
    """Give a channel curves of the same shape as another one's."""
    found, bag, start = keys.curves(action), keys.bag_of(action), keys.prefix(old)
    for path in dict.fromkeys(path for path, _ in found if path.startswith(start)):
        defaults = keys.DEFAULTS.get(path.rpartition(".")[2], (0.0,))
        track = tracks.read(found, path, defaults)
        if track is not None:
            tracks.write(bag, found, keys.prefix(new) + path.removeprefix(start), track, new, defaults)


class MORPHRETARGET_OT_move_channel(_OnChannel):
    bl_idname = "morph_retarget.move_channel"
    bl_label = "Move Channel"
    bl_description = "Move a channel in the list; of channels of one priority the upper ones take bodies first"

    direction: EnumProperty(
        name="Direction",
        description="Where to",
        items=[("UP", "Up", "Before the one above"), ("DOWN", "Down", "Behind the one below")],
    )

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        action, place = self._meant(context)
        own = of_action(action)
        to = place + (-1 if self.direction == "UP" else 1)
        if not 0 <= to < len(own.channels):
            raise MotionError(f"{own.channels[place].name!r} is at the end of the list already: move it the other way")
        own.channels.move(place, to)
        own.active_channel = to
        perform.definition_changed(action)
        return {"FINISHED"}


class MORPHRETARGET_OT_add_deform(Asking, _OnChannel):
    bl_idname = "morph_retarget.add_deform"
    bl_label = "Add Deform"
    bl_description = "Add a scalar curve for shape keys and custom properties that are called like it"

    name: StringProperty(name="Name", description="Of the shape keys and properties, such as open", default="open")

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        action, place = self._meant(context)
        name = of_action(action).channels[place].name
        if not self.name:
            raise MotionError("a deform needs a name: that of a shape key or custom property, such as open")
        for ob in cast.playing(scene_in(context), action):
            own_values.ensure(ob, action)
            deforms = of_rig(ob).channels[name].deforms
            if self.name not in deforms:
                deforms.add().name = self.name
        perform.definition_changed(action)
        return {"FINISHED"}


class MORPHRETARGET_OT_remove_deform(_OnChannel):
    bl_idname = "morph_retarget.remove_deform"
    bl_label = "Remove Deform"
    bl_description = "Remove a scalar curve from all characters, with its keys"

    name: StringProperty(name="Name", description="Of the deform")

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        action, place = self._meant(context)
        name = of_action(action).channels[place].name
        playing = cast.playing(scene_in(context), action)
        lists = [of_rig(ob).channels[name].deforms for ob in playing if name in of_rig(ob).channels]
        if not any(self.name in deforms for deforms in lists):
            raise MotionError(f"channel {name!r} has no deform {self.name!r}: choose one of its deforms")
        for deforms in lists:
            if self.name in deforms:
                deforms.remove(deforms.find(self.name))
        curve = keys.curves(action).get((keys.deform_path(name, self.name), 0))
        if curve is not None:
            keys.bag_of(action).fcurves.remove(curve)
        perform.definition_changed(action)
        return {"FINISHED"}


CLASSES = (
    MORPHRETARGET_OT_add_channel,
    MORPHRETARGET_OT_remove_channel,
    MORPHRETARGET_OT_duplicate_channel,
    MORPHRETARGET_OT_move_channel,
    MORPHRETARGET_OT_add_deform,
    MORPHRETARGET_OT_remove_deform,
)
