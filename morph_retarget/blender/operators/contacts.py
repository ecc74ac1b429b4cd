"""Finding and editing when the source's feet stand."""

from collections.abc import Generator

import bpy
from bpy.props import IntProperty, StringProperty

from ...core.errors import MotionError
from .. import collect, contacts
from ..changes import together
from ..contacts import Contact
from ..properties import of_rig, of_scene
from ..rig_properties import MORPHRETARGET_PG_rig
from .manners import PLACE, Status, place_meant, refuse, reporting, scene_in
from .stepping import Stepping


def _source(context: bpy.types.Context) -> bpy.types.Object | None:
    return of_scene(scene_in(context)).source


class MORPHRETARGET_OT_detect_contacts(Stepping, bpy.types.Operator):
    bl_idname = "morph_retarget.detect_contacts"
    bl_label = "Detect Contacts"
    bl_description = "Find when the source's feet stand in its present action, and list it for editing"
    bl_options = {"REGISTER", "UNDO"}
    doing = "Watching the feet"

    source: StringProperty(name="Source", description="Armature object; the panel's source when empty")

    @classmethod
    def poll(cls, _: bpy.types.Context) -> bool:
        return len(bpy.data.armatures) > 0 or refuse(cls, "There is no armature in this file")

    def start(self, context: bpy.types.Context) -> Generator[float, None, tuple[bpy.types.Object, str, list[Contact]]]:
        ob = collect.chosen(self.source, _source(context), "source")
        self.source = ob.name
        action, slot = collect.actions_of(ob)[0]
        return _watched(ob, action, slot, scene_in(context))

    def finish(self, _: bpy.types.Context, result: tuple[bpy.types.Object, str, list[Contact]]) -> Status:
        ob, action, found = result
        settings = of_rig(ob)
        with together():
            settings.contacts.clear()
            settings.contacts_action = action
            for contact in found:
                item = settings.contacts.add()
                item.name, item.start, item.end = contact.foot, round(contact.start), round(contact.end)
        self.report({"INFO"}, f"{len(found)} contacts found in {action!r}")
        return {"FINISHED"}


def _watched(
    ob: bpy.types.Object, action: bpy.types.Action, slot: bpy.types.ActionSlot, scene: bpy.types.Scene
) -> Generator[float, None, tuple[bpy.types.Object, str, list[Contact]]]:
    """Find in steps when the feet of an armature stand in an action."""
    source = yield from collect.source_of(ob, action, slot, scene)
    return ob, action.name, list(contacts.found(source.character, source.clip))


class _OnList(bpy.types.Operator):
    """What acts on the contacts that are listed for the panel's source."""

    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        ob = _source(context)
        return (ob is not None and len(of_rig(ob).contacts) > 0) or refuse(cls, "No contacts are listed")

    def _rig(self, context: bpy.types.Context) -> MORPHRETARGET_PG_rig:
        ob = _source(context)
        assert ob is not None, "poll has checked that there is a source"
        return of_rig(ob)


class MORPHRETARGET_OT_clear_contacts(_OnList):
    bl_idname = "morph_retarget.clear_contacts"
    bl_label = "Clear Contacts"
    bl_description = "Forget the listed contacts; the feet are watched again at each retarget"

    def execute(self, context: bpy.types.Context) -> Status:
        rig = self._rig(context)
        rig.contacts.clear()
        rig.contacts_action = ""
        return {"FINISHED"}


class MORPHRETARGET_OT_add_contact(bpy.types.Operator):
    bl_idname = "morph_retarget.add_contact"
    bl_label = "Add Contact"
    bl_description = "Add a contact at the current frame, for the foot of the active one"
    bl_options = {"REGISTER", "UNDO"}

    foot: StringProperty(name="Foot", description="Bone of the foot; that of the active contact when empty")
    start: IntProperty(name="Start", description="First frame; the current one when 0")
    end: IntProperty(name="End", description="Last frame; ten after the current one when 0")

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return _source(context) is not None or refuse(cls, "Choose a source first")

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        ob = _source(context)
        assert ob is not None, "poll has checked that there is a source"
        settings = of_rig(ob)
        if not self.foot and not settings.contacts:
            raise MotionError("no foot is known yet: detect contacts first, or name the bone of the foot")
        foot = self.foot or settings.contacts[settings.active_contact].name
        now = scene_in(context).frame_current
        item = settings.contacts.add()
        self.foot, self.start, self.end = foot, self.start or now, self.end or now + 10
        item.name, item.start, item.end = self.foot, self.start, self.end
        settings.active_contact = len(settings.contacts) - 1
        settings.contacts_action = collect.actions_of(ob)[0][0].name
        return {"FINISHED"}


class MORPHRETARGET_OT_remove_contact(_OnList):
    bl_idname = "morph_retarget.remove_contact"
    bl_label = "Remove Contact"
    bl_description = "Remove the active contact from the list"

    place: PLACE

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        rig = self._rig(context)
        missing = "there is no such contact: choose one in the list"
        rig.contacts.remove(place_meant(self, len(rig.contacts), rig.active_contact, missing))
        rig.active_contact = max(min(rig.active_contact, len(rig.contacts) - 1), 0)
        return {"FINISHED"}


CLASSES = (
    MORPHRETARGET_OT_detect_contacts,
    MORPHRETARGET_OT_clear_contacts,
    MORPHRETARGET_OT_add_contact,
    MORPHRETARGET_OT_remove_contact,
)
