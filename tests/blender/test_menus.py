"""Menus: what is of use without a list in the panel can be found by searching, and stands where it belongs."""

import bpy
import pytest

from morph_retarget.blender import registration
from morph_retarget.blender.ui import graph_panels, menus
from tests.blender import acting, scenes
from tests.blender.layouts import Layout, drawn

ops = bpy.ops.morph_retarget
OF_LISTS = {
    "activate_character",
    "add_channel",
    "add_command",
    "add_contact",
    "add_deform",
    "add_gait_style",
    "add_jiggle_settings",
    "add_parameter",
    "clear_contacts",
    "clear_joint",
    "delete_channels",
    "delete_preset",
    "duplicate_channel",
    "load_channels",
    "load_preset",
    "mirror_joint",
    "move_channel",
    "move_command",
    "remove_channel",
    "remove_command",
    "remove_contact",
    "remove_deform",
    "remove_gait_style",
    "remove_jiggle_settings",
    "remove_limb_settings",
    "remove_parameter",
    "reset_joints",
    "save_channels",
    "save_preset",
    "select_joint",
}
"""What edits a list that a panel shows, and stands beside it."""

pytestmark = pytest.mark.usefixtures("registered")


def _operators(layout: Layout) -> set[str]:
    return {button.kind.identifier.removeprefix("MORPH_RETARGET_OT_") for button in layout.buttons}


def test_all_operators_can_be_searched_for_but_those_that_edit_a_list() -> None:
    own = {cls.bl_idname.split(".")[1] for cls in registration.CLASSES if issubclass(cls, bpy.types.Operator)}
    found = _operators(drawn(*menus.CLASSES))
    assert own - found == OF_LISTS


def test_our_menus_stand_in_those_of_blender_and_leave_with_the_extension() -> None:
    missing = [name for name, _ in menus.PLACES if not hasattr(bpy.types, name)]
    assert not missing, "menus that this Blender does not have"
    for name, draw in menus.PLACES:
        assert draw in getattr(bpy.types, name)._dyn_ui_initialize()
    menus.detach()
    for name, draw in menus.PLACES:
        assert draw not in getattr(bpy.types, name)._dyn_ui_initialize()
    menus.attach()


def test_the_graph_editor_shows_the_channel_that_is_edited() -> None:
    panels = graph_panels.CLASSES
    assert not drawn(*panels).props, "nothing plays yet"
    ann = scenes.figure("Ann")
    bpy.context.view_layer.objects.active = ann
    acting.dip(ann)
    found = drawn(*panels)
    assert {"key_channel", "rest_channel", "edit_specialized"} <= _operators(found)
    assert {"position", "rotation", "weight", "scale", "remap"} <= {name for name, _ in found.props}
