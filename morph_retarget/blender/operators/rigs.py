"""Finding out what a rig is, and which two rigs are meant."""

from collections.abc import Generator

import bpy
from bpy.props import StringProperty

from ...core.character.character import Character
from ...core.errors import RigError
from .. import actions, collect, retarget
from ..properties import of_rig, of_scene
from .manners import Status, armature_poll, refuse, reporting, rig_meant, scene_in
from .stepping import Stepping


def analyze(scene: bpy.types.Scene, ob: bpy.types.Object) -> Character:
    """Find out what an armature is and fill its joint list.

    Raises:
        MorphError: It cannot be analysed.
    """
    return retarget.run(analyzing(scene, ob))


def analyzing(scene: bpy.types.Scene, ob: bpy.types.Object) -> Generator[float, None, Character]:
    """Do the same in steps: a source is judged by its clip where its rest is no pose, which may take a while.

    Raises:
        MorphError: It cannot be analysed.
    """
    own, found = collect.target_of(ob)
    action, slot = actions.assigned(ob)
    if not found.rest_is_pose and action is not None and slot is not None:
        source = yield from collect.source_of(ob, action, slot, scene)
        found = retarget.character_of(own, of_rig(ob).overrides(), source.clip)
    of_rig(ob).show(found)
    return found


class MORPHRETARGET_OT_analyze(Stepping, bpy.types.Operator):
    bl_idname = "morph_retarget.analyze"
    bl_label = "Analyze"
    bl_description = "Find the rig's joints, body parts and directions; your own corrections are kept"
    bl_options = {"REGISTER", "UNDO"}
    doing = "Analyzing"

    rig: StringProperty(name="Rig", description="Armature object; the shown one when empty")

    @classmethod
    def poll(cls, _: bpy.types.Context) -> bool:
        return bpy.data.armatures.values() != [] or refuse(cls, "There is no armature in this file")

    def start(self, context: bpy.types.Context) -> Generator[float, None, Character]:
        ob = rig_meant(context, self.rig)
        self.rig = ob.name
        return analyzing(scene_in(context), ob)

    def finish(self, context: bpy.types.Context, found: Character) -> Status:
        ob = rig_meant(context, self.rig)
        doubtful = [joint for joint, match in found.joints.items() if match.confidence < 0.8]
        for warning in found.warnings:
            self.report({"WARNING"}, f"{ob.name}: {warning}")
        text = f"{ob.name}: {len(found.joints)} joints found"
        self.report({"INFO"}, f"{text}, {len(doubtful)} doubtful" if doubtful else text)
        return {"FINISHED"}


class MORPHRETARGET_OT_swap(bpy.types.Operator):
    bl_idname = "morph_retarget.swap"
    bl_label = "Swap Source and Target"
    bl_description = "Make the source the target and the target the source"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context: bpy.types.Context) -> Status:
        settings = of_scene(scene_in(context))
        settings.source, settings.target = settings.target, settings.source
        return {"FINISHED"}


class MORPHRETARGET_OT_use_selected(bpy.types.Operator):
    bl_idname = "morph_retarget.use_selected"
    bl_label = "Use Selected"
    bl_description = "Take the active armature as the target and the other selected one as the source"
    bl_options = {"REGISTER", "UNDO"}

    source: StringProperty(name="Source", description="Armature object; the selected one that is not active when empty")
    target: StringProperty(name="Target", description="Armature object; the active one when empty")

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return armature_poll(cls, context)

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        settings, found = of_scene(scene_in(context)), _selected(context)
        if len(found) != 2 and not (self.source and self.target):
            raise RigError("two armatures have to be selected: select the one that moves, then the target")
        self.source, self.target = self.source or found[0].name, self.target or found[1].name
        settings.source = collect.armature(self.source, "source")
        settings.target = collect.armature(self.target, "target")
        return {"FINISHED"}


def _selected(context: bpy.types.Context) -> list[bpy.types.Object]:
    """Return the selected armatures, the active one last."""
    found = [ob for ob in context.selected_objects or [] if ob.type == "ARMATURE"]
    return sorted(found, key=lambda ob: ob == context.object)


CLASSES = (MORPHRETARGET_OT_analyze, MORPHRETARGET_OT_swap, MORPHRETARGET_OT_use_selected)
