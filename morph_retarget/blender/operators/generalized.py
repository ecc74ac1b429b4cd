"""Generalized actions and the characters that play them."""

from collections.abc import Sequence

import bpy
from bpy.props import StringProperty

from ...core.character.morphology import Capability
from ...core.errors import MorphError, MotionError, RigError, listed
from ...core.morph import branch
from ...core.morph.channels import Channel
from ...core.morph.context import Context
from ...core.morph.movement import Movement, ScaleMode
from .. import collect
from ..morph import analyses, cast, definitions, jiggles, own_values, perform, query
from ..morph.properties import of_action
from ..properties import of_rig
from ..rig import scene_of
from .manners import OfSelected, Status, refuse, reporting, scene_in

FIRST = Channel("Graspers", Context(Capability.GRASPER), Movement(scale=ScaleMode.LIMB_LENGTH))
"""What a new action starts with."""


def selected(context: bpy.types.Context) -> list[bpy.types.Object]:
    """Return the selected armatures, the active one first; without any, the active one alone."""
    active = [context.object] if context.object is not None else []
    found = [ob for ob in context.selected_objects or active if ob.type == "ARMATURE"]
    return sorted(found, key=lambda ob: ob != context.object)


def generalized_actions() -> list[bpy.types.Action]:
    """Return the generalized actions of the file."""
    return [action for action in bpy.data.actions if definitions.is_generalized(action)]


def action_meant(context: bpy.types.Context, name: str) -> bpy.types.Action:
    """Return a named action, else that of the active character, of another selected one, or the only one there is.

    Raises:
        MotionError: There is none.
    """
    if name:
        found = bpy.data.actions.get(name)
        if found is None:
            names = listed([action.name for action in generalized_actions()])
            raise MotionError(f"there is no action {name!r}: choose one of {names or 'none'}")
        return found
    active = query.active_character(context)
    for ob in [*([active] if active is not None else []), *selected(context)]:
        own = cast.action_of(ob)
        if own is not None:
            return own
    every = generalized_actions()
    if len(every) != 1:
        raise MotionError("no generalized action is chosen: select a character that plays one, or name it")
    return every[0]


def characters_meant(context: bpy.types.Context, name: str) -> list[bpy.types.Object]:
    """Return a named armature, else the selected ones.

    Raises:
        RigError: There is none.
    """
    found = [collect.armature(name, "character")] if name else selected(context)
    if not found:
        raise RigError("no character is selected: select an armature, or name one")
    return found


def performer_meant(context: bpy.types.Context, name: str) -> bpy.types.Object:
    """Return a named character, else the active one.

    Raises:
        RigError: There is none, or it plays no generalized action.
    """
    ob = collect.armature(name, "character") if name else query.active_character(context)
    if ob is None or cast.action_of(ob) is None:
        raise RigError(f"{repr(ob.name) if ob else 'nothing'} plays no generalized action: add it to one first")
    return ob


def any_performer(cls: type[bpy.types.Operator], context: bpy.types.Context) -> bool:
    """Return whether a character plays a generalized action, for a ``poll``."""
    playing = context.scene is not None and len(cast.performers(context.scene)) > 0
    return playing or refuse(cls, "No character in the scene plays a generalized action")


def any_generalized(cls: type[bpy.types.Operator]) -> bool:
    """Return whether there is a generalized action, for a ``poll``."""
    return len(generalized_actions()) > 0 or refuse(cls, "There is no generalized action yet: make a new one")


def let_play(characters: Sequence[bpy.types.Object], action: bpy.types.Action) -> None:
    """Let characters play an action, all or none; what they played before is not lost.

    Raises:
        MorphError: One of them cannot be analysed.
    """
    for ob in characters:
        analyses.of(ob)
    scene = scene_of()
    for ob in characters:
        jiggles.welcome(ob)
        cast.add(ob, action)
        for other in cast.playing(scene, action):
            _share_deforms(other, ob, action)


def _share_deforms(old: bpy.types.Object, new: bpy.types.Object, action: bpy.types.Action) -> None:
    """Give a character the deforms that another one has in the channels of an action."""
    for item in of_action(action).channels:
        there, here = of_rig(old).channels.get(item.name), of_rig(new).channels[item.name].deforms
        for deform in there.deforms if there is not None else ():
            if deform.name not in here:
                here.add().name = deform.name


def add_channel(context: bpy.types.Context, action: bpy.types.Action, wanted: Channel) -> None:
    """Give an action a channel, and all who play it a place for its values."""
    definitions.add(action, wanted)
    for ob in cast.playing(scene_in(context), action):
        own_values.ensure(ob, action)


class MORPHRETARGET_OT_new_action(OfSelected, bpy.types.Operator):
    bl_idname = "morph_retarget.new_action"
    bl_label = "New Generalized Action"
    bl_description = "Make a generalized action with a first channel, and let the selected armatures play it"

    name: StringProperty(name="Name", description="Name of the action", default="Generalized")

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        found = characters_meant(context, self.character)
        action = bpy.data.actions.new(self.name)
        try:
            let_play(found, action)
        except MorphError:
            bpy.data.actions.remove(action)
            raise
        action.use_fake_user = True
        add_channel(context, action, FIRST)
        self.report({"INFO"}, f"{action.name!r} plays on {listed([ob.name for ob in found], 3)}")
        return {"FINISHED"}


class MORPHRETARGET_OT_add_character(OfSelected, bpy.types.Operator):
    bl_idname = "morph_retarget.add_character"
    bl_label = "Add Character"
    bl_description = "Let the selected armatures play the generalized action of the active character"

    action: StringProperty(name="Action", description="Generalized action; the active character's when empty")

    @classmethod
    def poll(cls, _: bpy.types.Context) -> bool:
        return any_generalized(cls)

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        action = action_meant(context, self.action)
        if not definitions.is_generalized(action):
            raise MotionError(f"action {action.name!r} has no channels: choose a generalized action, or make a new one")
        definitions.read(action)  # one of a newer version is refused here
        found = [ob for ob in characters_meant(context, self.character) if cast.action_of(ob) != action]
        if not found:
            raise RigError(f"the selected armatures play {action.name!r} already: select others")
        let_play(found, action)
        self.report({"INFO"}, f"{action.name!r} plays on {listed([ob.name for ob in found], 3)}")
        return {"FINISHED"}


class MORPHRETARGET_OT_remove_character(OfSelected, bpy.types.Operator):
    bl_idname = "morph_retarget.remove_character"
    bl_label = "Remove Character"
    bl_description = "Let the selected armatures play their generalized action no more"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return any_performer(cls, context)

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        found = [ob for ob in characters_meant(context, self.character) if cast.action_of(ob) is not None]
        if not found:
            raise RigError("none of these armatures plays a generalized action: select one that does")
        for ob in found:
            cast.remove(ob)
            perform.release(ob)
        return {"FINISHED"}


class MORPHRETARGET_OT_activate_character(bpy.types.Operator):
    bl_idname = "morph_retarget.activate_character"
    bl_label = "Make Active"
    bl_description = "Make a character the active object, which the panel and the motion path are about"
    bl_options = {"REGISTER", "UNDO"}

    character: StringProperty(name="Character", description="Armature object")

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        ob = collect.armature(self.character, "character")
        layer = context.view_layer
        assert layer is not None, "operators run in a window with a scene"
        if not ob.visible_get():
            raise RigError(f"{ob.name!r} is hidden: show it first")
        if context.mode == "POSE":
            query.show_in_pose_mode(context, [ob])
        ob.select_set(True)
        layer.objects.active = ob
        return {"FINISHED"}


class MORPHRETARGET_OT_play_movement(OfSelected, bpy.types.Operator):
    bl_idname = "morph_retarget.play_movement"
    bl_label = "Play Movement"
    bl_description = "Give each selected armature the first action of a movement that is made for characters like it"

    movement: StringProperty(name="Movement", description="Movement; that of the active character's action when empty")

    @classmethod
    def poll(cls, _: bpy.types.Context) -> bool:
        named = any(of_action(action).movement for action in generalized_actions())
        return named or refuse(cls, "No action belongs to a movement: give one a movement among its predicates")

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        name = self.movement or of_action(action_meant(context, "")).movement
        found = branches_of(name)
        told: list[str] = []
        chosen: list[tuple[bpy.types.Object, bpy.types.Action]] = []
        for ob in characters_meant(context, self.character):
            _, _, bodies = analyses.of(ob)
            choice = branch.choose([definitions.read(action).branch for action in found], bodies)
            if choice is not None:
                chosen.append((ob, found[choice]))
                continue
            why = [f"{a.name}: {listed(definitions.read(a).branch.refusals(bodies))}" for a in found]
            told.append(f"no branch of {name!r} is for {ob.name!r} ({'; '.join(why)})")
        if not chosen:
            raise MotionError(f"{told[0]}: change its predicates, or make a branch for such characters")
        for ob, action in chosen:
            let_play([ob], action)
        for text in told:
            self.report({"WARNING"}, text)
        return {"FINISHED"}


def branches_of(name: str) -> list[bpy.types.Action]:
    """Return the actions that are branches of a movement.

    Raises:
        MotionError: There are none.
    """
    named = {action: of_action(action).movement for action in generalized_actions()}
    found = [action for action, movement in named.items() if name and movement == name]
    if not found:
        names = listed(sorted({movement for movement in named.values() if movement}))
        raise MotionError(f"no action belongs to the movement {name!r}: choose one of {names or 'none'}")
    return found


CLASSES = (
    MORPHRETARGET_OT_new_action,
    MORPHRETARGET_OT_add_character,
    MORPHRETARGET_OT_remove_character,
    MORPHRETARGET_OT_activate_character,
    MORPHRETARGET_OT_play_movement,
)
