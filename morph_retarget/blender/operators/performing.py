"""From generalized actions to ordinary ones and back: baking characters, generalizing captured motions."""

from collections.abc import Generator

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, StringProperty

from ...core.errors import MotionError
from ...core.morph.capture import CaptureSettings
from .. import collect
from ..morph import bake, capture, cast, channel_presets, query, telling
from ..rig import armature_of
from .generalized import any_performer, performer_meant
from .manners import Status, refuse, scene_in
from .stepping import Stepping


class MORPHRETARGET_OT_bake_action(Stepping, bpy.types.Operator):
    bl_idname = "morph_retarget.bake_action"
    bl_label = "Bake Action"
    bl_description = "Write what a character plays as an ordinary action; the generalized action is kept as it is"
    bl_options = {"REGISTER", "UNDO"}
    doing = "Baking"

    character: StringProperty(name="Character", description="Armature object; the active one when empty")
    all_characters: BoolProperty(
        name="All Characters", description="Bake every character of the scene that plays a generalized action"
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return any_performer(cls, context)

    def start(self, context: bpy.types.Context) -> Generator[float, None, list[bake.Outcome]]:
        scene = scene_in(context)
        if self.all_characters:
            found = cast.performers(scene)
        else:
            found = [performer_meant(context, self.character)]
            self.character = found[0].name
        playing = [ob for ob in found if cast.member(ob).plays]
        for ob in found:
            if ob not in playing:
                problems = "; ".join(telling.tell(ob)) or "it has no channels for it"
                if len(playing) == 0:
                    raise MotionError(f"nothing of the action plays on {ob.name!r}: {problems}")
                self.report({"WARNING"}, f"{ob.name}: left out: {problems}")
        return bake.bake(playing, scene, bake.Options())

    def finish(self, _: bpy.types.Context, outcomes: list[bake.Outcome]) -> Status:
        for outcome in outcomes:
            ob = outcome.take.member.rig.object
            for warning in outcome.take.warnings:
                self.report({"WARNING"}, f"{ob.name}: {warning}")
        made = repr(outcomes[0].action.name) if len(outcomes) == 1 else f"{len(outcomes)} actions"
        self.report({"INFO"}, f"Baked {made}; the generalized action is kept")
        return {"FINISHED"}


_names: list[tuple[str, str, str]] = []


def _presets(_: object, __: object) -> list[tuple[str, str, str]]:
    # Blender keeps no reference to these texts itself.
    found = sorted(channel_presets.names(), key=lambda name: name != channel_presets.BIPED)
    _names[:] = [(name, name, f"The channels of the preset {name}") for name in found]
    return _names


class MORPHRETARGET_OT_generalize_action(Stepping, bpy.types.Operator):
    bl_idname = "morph_retarget.generalize_action"
    bl_label = "Generalize Action"
    bl_description = "Make a generalized action of what the armature's action does, for characters of any shape"
    bl_options = {"REGISTER", "UNDO"}
    doing = "Generalizing"
    remembered = ("preset", "in_place", "slow")

    character: StringProperty(name="Character", description="Armature object; the active one when empty")
    action: StringProperty(name="Action", description="Action of the armature; the one that it plays when empty")
    preset: EnumProperty(name="Channels", description="Which channels the new action gets", items=_presets)
    in_place: BoolProperty(
        name="In Place",
        description="Leave out the way over the ground and slow turns, which unlike bodies cannot share",
        default=True,
    )
    slow: FloatProperty(
        name="Slow",
        description="What takes longer than this counts as way",
        default=1.0,
        min=0.0,
        soft_max=5.0,
        unit="TIME",
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return query.active_character(context) is not None or refuse(cls, "Select an armature that moves")

    def start(self, context: bpy.types.Context) -> Generator[float, None, capture.Outcome]:
        ob = collect.armature(self.character, "performer") if self.character else query.active_character(context)
        if ob is None:
            raise MotionError("no armature is active: select the one that moves, or give its name")
        if not len(armature_of(ob).bones):
            raise MotionError(f"armature {ob.name!r} has no bones: choose one that moves")
        action, slot = collect.actions_of(ob, self.action)[0]
        self.character, self.action = ob.name, action.name
        channels = channel_presets.load(self.preset)
        options = capture.Options(CaptureSettings(self.in_place, self.slow))
        return capture.generalize(ob, action, slot, scene_in(context), channels, options)

    def finish(self, _: bpy.types.Context, outcome: capture.Outcome) -> Status:
        for warning in outcome.warnings:
            self.report({"WARNING"}, warning)
        self.report({"INFO"}, f"Made {outcome.action.name!r}: add it to characters to see it")
        return {"FINISHED"}


CLASSES = (MORPHRETARGET_OT_bake_action, MORPHRETARGET_OT_generalize_action)
