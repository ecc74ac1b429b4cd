"""Keying channels, editing them as specialized curves, and changing what they are relative to."""

import bpy
from bpy.props import BoolProperty, StringProperty

from ...core.errors import MotionError, RigError
from .. import collect
from ..morph import cast, keys, query, specialized
from ..properties import of_rig
from .generalized import any_performer
from .manners import Status, refuse, reporting, scene_in, show_alone


class _OfChannel:
    """What operators on one channel of one character ask for."""

    character: StringProperty(name="Character", description="Armature object; the active one when empty")
    channel: StringProperty(name="Channel", description="Channel of its action; the active one when empty")

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Return whether there is any."""
        return any_performer(cls, context)  # type: ignore[arg-type]  # the operator that this is part of

    def meant(self, context: bpy.types.Context) -> tuple[bpy.types.Object, str]:
        """Return the character and the name of the channel that are meant.

        Raises:
            RigError: It is no armature, or plays no generalized action.
            MotionError: The action has no such channel.
        """
        ob = collect.armature(self.character, "character") if self.character else context.object
        action = None if ob is None else cast.action_of(ob)
        if ob is None or action is None:
            raise RigError(f"{ob.name if ob else 'nothing'!r} plays no generalized action: add it to one first")
        self.character, self.channel = ob.name, keys.channel_named(action, self.channel).name
        return ob, self.channel


class MORPHRETARGET_OT_key_channel(_OfChannel, bpy.types.Operator):
    bl_idname = "morph_retarget.key_channel"
    bl_label = "Key Channel"
    bl_description = "Insert keys for the values of a channel at the present frame"
    bl_options = {"REGISTER", "UNDO"}

    position: BoolProperty(name="Position", description="Key the position", default=True)
    rotation: BoolProperty(name="Rotation", description="Key the rotation", default=True)
    weight: BoolProperty(name="Weight", description="Key the weight")
    deforms: BoolProperty(name="Deforms", description="Key the deforms")
    all_channels: BoolProperty(name="All Channels", description="Key all channels of the action")

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        ob, channel = self.meant(context)
        wanted = [part for part in (*keys.PARTS, "deforms") if getattr(self, part)]
        if not wanted:
            raise MotionError("nothing is chosen to be keyed: choose position, rotation, weight or deforms")
        names = [c.name for c in cast.member(ob).definition.channels] if self.all_channels else [channel]
        for name in names:
            keys.insert(ob, name, wanted, scene_in(context).frame_current_final)
        return {"FINISHED"}


class MORPHRETARGET_OT_rest_channel(_OfChannel, bpy.types.Operator):
    bl_idname = "morph_retarget.rest_channel"
    bl_label = "Rest"
    bl_description = "Put a channel's position and rotation back to rest on all characters of the action"
    bl_options = {"REGISTER", "UNDO"}

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        ob, channel = self.meant(context)
        item = of_rig(ob).channels[channel]
        item.position, item.rotation = (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0)
        return {"FINISHED"}


class MORPHRETARGET_OT_edit_specialized(_OfChannel, bpy.types.Operator):
    bl_idname = "morph_retarget.edit_specialized"
    bl_label = "Edit as Specialized Curves"
    bl_description = (
        "Show the active body's own location and rotation as curves in the Graph Editor; "
        "what is reshaped there goes back into the channel's keys"
    )
    bl_options = {"REGISTER", "UNDO"}

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        show_alone(context, specialized.start(*self.meant(context)))
        return {"FINISHED"}


class MORPHRETARGET_OT_finish_specialized(bpy.types.Operator):
    bl_idname = "morph_retarget.finish_specialized"
    bl_label = "Finish Specialized Curves"
    bl_description = "Put the reshaped curves into the channel's keys and remove the stand-in"
    bl_options = {"REGISTER", "UNDO"}

    stand_in: StringProperty(name="Stand-in", description="Its empty object; the active one when empty")

    @classmethod
    def poll(cls, _: bpy.types.Context) -> bool:
        found = any(of_rig(ob).stands_for is not None for ob in bpy.data.objects)
        return found or refuse(cls, "No channel is edited as specialized curves")

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        empty = bpy.data.objects.get(self.stand_in) if self.stand_in else context.object
        if empty is None or of_rig(empty).stands_for is None:
            raise MotionError("the active object is no stand-in: select the empty of the specialized curves")
        ob = of_rig(empty).stands_for
        specialized.finish(empty)
        layer = context.view_layer
        assert layer is not None, "operators run in a window with a scene"
        if ob.name in layer.objects:
            ob.select_set(True)
            layer.objects.active = ob
        return {"FINISHED"}


class MORPHRETARGET_KS_channels(bpy.types.KeyingSetInfo):
    """Keys the generalized values of the characters' active channels."""

    bl_idname = "MORPHRETARGET_KS_channels"
    bl_label = "Generalized Channels"
    bl_description = "Position and rotation of the channels that pose the selected bones, or of the active channel"

    def poll(self, context: bpy.types.Context) -> bool:
        return context.object is not None and cast.action_of(context.object) is not None

    def iterator(self, context: bpy.types.Context, keying_set: bpy.types.KeyingSet) -> None:
        if context.object is not None:
            self.generate(context, keying_set, context.object)

    def generate(self, _: bpy.types.Context, keying_set: bpy.types.KeyingSet, data: bpy.types.Object) -> None:
        for name in query.channels_in_hand(data):
            for part in ("position", "rotation"):
                keying_set.paths.add(data, keys.path(name, part), index=-1, group_method="NAMED", group_name=name)


CLASSES = (
    MORPHRETARGET_OT_key_channel,
    MORPHRETARGET_OT_rest_channel,
    MORPHRETARGET_OT_edit_specialized,
    MORPHRETARGET_OT_finish_specialized,
    MORPHRETARGET_KS_channels,
)
