"""The panels of generalized actions: what they show, and that showing changes nothing."""

import bpy
import pytest

from morph_retarget.blender.morph import cast, keys
from morph_retarget.blender.morph.properties import MORPHRETARGET_PG_action, of_action
from morph_retarget.blender.properties import of_rig
from morph_retarget.blender.ui import channel_binding, channel_panels, channel_values, generalized
from tests.blender import scenes
from tests.blender.layouts import Layout, drawn
from tools import armatures, creatures

ops = bpy.ops.morph_retarget
PANELS = [
    generalized.MORPHRETARGET_PT_generalized,
    generalized.MORPHRETARGET_MT_actions,
    *channel_panels.CLASSES,
    *channel_values.CLASSES,
    *channel_binding.CLASSES,
]

pytestmark = pytest.mark.usefixtures("registered")


@pytest.fixture
def ann() -> bpy.types.Object:
    """Return a humanoid that is the active object."""
    return scenes.figure("Ann")


@pytest.fixture
def wave(ann: bpy.types.Object) -> MORPHRETARGET_PG_action:
    """Return the definitions of a new action that Ann plays."""
    ops.new_action(name="Wave", character=ann.name)
    return of_action(ann.animation_data.action)


def _text(layout: Layout | None = None) -> str:
    return " ".join((layout or drawn(*PANELS)).texts)


def _operators(layout: Layout) -> set[str]:
    return {button.kind.identifier.removeprefix("MORPH_RETARGET_OT_") for button in layout.buttons}


def test_without_characters_the_panel_offers_to_begin() -> None:
    found = drawn(*PANELS)
    assert "Select an armature" in _text(found)
    assert _operators(found) == {"new_action"}
    scenes.figure("Ann")
    assert "Ann plays no generalized action" in _text()


def test_an_ordinary_action_is_none_of_its_business() -> None:
    scenes.walker()
    assert "Walker plays no generalized action" in _text()


def test_it_lists_characters_and_channels_in_plain_words(wave: MORPHRETARGET_PG_action) -> None:
    ops.add_character(character=scenes.sprout("Bob").name, action="Wave")
    bpy.context.view_layer.objects.active = bpy.data.objects["Ann"]
    item = wave.channels[0]
    item.context.side, item.context.depth = "left", "any"
    item.ground_relative = True
    found = drawn(*PANELS)
    assert "Selects the graspers on the left" in _text(found)
    assert "z 1 is the ground" in _text(found)
    assert {"Ann: leftHand", "Bob: Hand.L"} <= set(found.texts)
    assert {"add_character", "remove_character", "select_bodies", "key_channel", "edit_specialized"} <= _operators(
        found
    )


def test_an_object_that_is_no_character_leaves_the_panel_on_the_first_one(wave: MORPHRETARGET_PG_action) -> None:
    bpy.context.view_layer.objects.active = scenes.empty_object("Fruit")
    assert {"name", "capability"} <= {name for name, _ in drawn(*PANELS).props}
    del wave


def test_settings_without_effect_are_grey(wave: MORPHRETARGET_PG_action) -> None:
    item = wave.channels[0]
    shown = dict(drawn(channel_panels.MORPHRETARGET_PT_movement).props)
    assert shown["sagittal_relative"]
    assert not shown["secondary_relative"]
    item.target, item.secondary_relative = "external", True
    shown = dict(drawn(channel_panels.MORPHRETARGET_PT_movement).props)
    assert shown["secondary_relative"]
    assert not shown["sagittal_relative"]


@pytest.mark.parametrize("setting", [("position", "absolute"), ("rotation", "absolute"), ("look_at", True)])
def test_modes_that_do_not_keep_the_rest_pose_say_so(
    wave: MORPHRETARGET_PG_action, setting: tuple[str, object]
) -> None:
    assert "rest pose" not in _text()
    wave.channels[0].target = "external"
    setattr(wave.channels[0], *setting)
    assert "rest pose" in _text()


def test_targets_are_chosen_as_their_kind_wants(wave: MORPHRETARGET_PG_action, ann: bpy.types.Object) -> None:
    panel, item = channel_panels.MORPHRETARGET_PT_target, wave.channels[0]
    assert [name for name, _ in drawn(panel).props] == ["target"]
    item.target = "context"
    assert "No movement mode uses it" in _text(drawn(panel))
    item.secondary_relative = True
    assert "nearest of the graspers" in _text(drawn(panel))
    item.target = "external"
    assert "Of Ann" in _text(drawn(panel))
    of_rig(ann).channels[item.name].target = ann
    assert "target_bone" in dict(drawn(panel).props)
    assert "has no target" not in _text()
    of_rig(ann).channels[item.name].target = None
    assert "has no target" in _text()


def test_variants_are_counted_per_character(wave: MORPHRETARGET_PG_action) -> None:
    assert "choose_variant" not in _operators(drawn(*PANELS))
    wave.channels[0].varies = True
    assert "1/2" in _text()
    ops.choose_variant(choice="NEXT")
    assert "2/2" in _text()
    assert "one at a time" in _text()


def test_what_is_wrong_stands_with_its_character(wave: MORPHRETARGET_PG_action) -> None:
    armatures.build("Rex", creatures.hound())
    ops.add_character(character="Rex", action="Wave")
    wave.channels[0].context.capability = "wing"
    found = drawn(*PANELS)
    assert _text(found).count("selects nothing") == 1, "in full for the active character, the others have a number"
    assert "Rex: no bodies" in found.texts
    wave.version = 999
    cast.forget()
    assert "newer version" in _text()


def test_values_say_whether_they_are_keyed_here_or_elsewhere(
    wave: MORPHRETARGET_PG_action, ann: bpy.types.Object
) -> None:
    name = wave.channels[0].name
    scene = bpy.context.scene

    def signs() -> list[str]:
        found = drawn(channel_values.MORPHRETARGET_PT_values)
        return [icon for icon in found.icons if icon.startswith("DECORATE")]

    ops.add_deform(name="open")
    assert signs() == ["DECORATE"] * 4
    keys.insert(ann, name, ["position", "deforms"], 7)
    scene.frame_set(3)
    assert signs() == ["DECORATE_ANIMATE", "DECORATE", "DECORATE", "DECORATE_ANIMATE"]
    scene.frame_set(7)
    assert signs() == ["DECORATE_KEYFRAME", "DECORATE", "DECORATE", "DECORATE_KEYFRAME"]


def test_specialized_curves_are_started_and_finished_from_the_same_place(wave: MORPHRETARGET_PG_action) -> None:
    panel = channel_values.MORPHRETARGET_PT_values
    assert "edit_specialized" in _operators(drawn(panel))
    ops.edit_specialized(character="Ann")
    assert "finish_specialized" in _operators(drawn(panel))
    assert "edit_specialized" not in _operators(drawn(panel))
    del wave


def test_the_menu_offers_actions_and_movements(wave: MORPHRETARGET_PG_action) -> None:
    menu = generalized.MORPHRETARGET_MT_actions
    assert drawn(menu).texts == ["Wave", "None"]
    wave.movement = "Greet"
    assert drawn(menu).texts == ["Wave", "The Branch That Fits", "Greet", "None"]


def test_drawing_changes_nothing(wave: MORPHRETARGET_PG_action, ann: bpy.types.Object) -> None:
    of_rig(ann).channels.clear()
    cast.forget()
    drawn(*PANELS)
    assert not of_rig(ann).channels
    del wave
