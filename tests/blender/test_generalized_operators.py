"""Generalized actions through their buttons, called as scripts call them."""

import bpy
import numpy as np
import pytest

from morph_retarget.blender import actions
from morph_retarget.blender.morph import cast, definitions, keys, query
from morph_retarget.blender.morph.properties import MORPHRETARGET_PG_action, of_action
from morph_retarget.blender.properties import of_rig
from morph_retarget.blender.rig_properties import MORPHRETARGET_PG_rig
from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.morph.channels import Channel, TargetKind
from morph_retarget.core.morph.context import Context, Extent, Side
from morph_retarget.core.morph.movement import Movement
from tests.blender import scenes
from tools import armatures, creatures

ops = bpy.ops.morph_retarget
HANDS = ["leftHand", "rightHand"]

pytestmark = pytest.mark.usefixtures("registered")


@pytest.fixture
def ann() -> bpy.types.Object:
    """Return a humanoid, selected and active, without any action."""
    ob = scenes.figure("Ann")
    scenes.select(ob)
    return ob


@pytest.fixture
def wave(ann: bpy.types.Object) -> bpy.types.Action:
    """Return a new generalized action that Ann plays."""
    ops.new_action(name="Wave")
    return ann.animation_data.action


def _hound() -> bpy.types.Object:
    ob = armatures.build("Rex", creatures.hound())
    scenes.select(ob)
    return ob


def _names(action: bpy.types.Action) -> list[str]:
    return [item.name for item in of_action(action).channels]


def _chosen(ob: bpy.types.Object) -> set[str]:
    """Return the bones that are selected on an armature."""
    if "select" in bpy.types.PoseBone.bl_rna.properties:
        return {bone.name for bone in ob.pose.bones if bone.select}
    return {bone.name for bone in ob.data.bones if bone.select}


def _key(ob: bpy.types.Object, channel: str, frame: int, position: tuple[float, float, float]) -> None:
    of_rig(ob).channels[channel].position = position
    keys.insert(ob, channel, ["position"], frame)


# --- actions and characters ---


def test_a_new_action_has_a_channel_plays_on_the_selected_armatures_and_is_not_lost() -> None:
    ann, rex = scenes.figure("Ann"), _hound()
    scenes.select(ann, rex)
    ops.new_action(name="Wave")
    action = bpy.data.actions["Wave"]
    assert action.use_fake_user
    assert _names(action) == ["Graspers"]
    assert cast.playing(bpy.context.scene, action) == [ann, rex]
    assert ann.animation_data.action_slot == rex.animation_data.action_slot is not None
    assert "Graspers" in of_rig(rex).channels


def test_a_named_character_gets_the_new_action_alone_and_keeps_what_it_played_before() -> None:
    walker, ann = scenes.walker(), scenes.figure("Ann")
    scenes.select(ann)
    walk = walker.animation_data.action
    ops.new_action(name="Wave", character=walker.name)
    assert walker.animation_data.action.name == "Wave"
    assert ann.animation_data is None
    assert walk.use_fake_user


def test_a_new_action_without_a_character_leaves_nothing_behind() -> None:
    scenes.figure("Ann")
    scenes.select()
    bare = bpy.data.objects.new("Bare", bpy.data.armatures.new("Bare"))
    bpy.context.scene.collection.objects.link(bare)
    with pytest.raises(RuntimeError, match="no character is selected"):
        ops.new_action()
    with pytest.raises(RuntimeError, match="has no bones"):
        ops.new_action(character="Bare")
    with pytest.raises(RuntimeError, match="no armature 'Nobody'"):
        ops.new_action(character="Nobody")
    assert not bpy.data.actions


def test_without_an_armature_there_is_no_new_action() -> None:
    with pytest.raises(RuntimeError, match="needs an armature"):
        ops.new_action()


def test_selected_armatures_are_added_to_the_action_of_the_active_one(wave: bpy.types.Action) -> None:
    ann, rex = bpy.data.objects["Ann"], _hound()
    scenes.select(rex, ann)
    ops.add_character()
    assert cast.playing(bpy.context.scene, wave) == [ann, rex]
    with pytest.raises(RuntimeError, match="already: select others"):
        ops.add_character()


def test_an_active_armature_without_an_action_joins_the_selected_one(wave: bpy.types.Action) -> None:
    ann, rex = bpy.data.objects["Ann"], _hound()
    scenes.select(ann, rex)
    ops.add_character()
    assert cast.playing(bpy.context.scene, wave) == [ann, rex]


def test_what_cannot_be_added_is_said_in_one_line(wave: bpy.types.Action) -> None:
    scenes.walker()
    with pytest.raises(RuntimeError, match="no action 'Fly'"):
        ops.add_character(action="Fly")
    with pytest.raises(RuntimeError, match="'Walk' has no channels"):
        ops.add_character(character="Walker", action="Walk")
    of_action(wave).version = 999
    with pytest.raises(RuntimeError, match="newer version"):
        ops.add_character(character="Walker", action="Wave")
    assert bpy.data.objects["Walker"].animation_data.action.name == "Walk"


def test_without_a_generalized_action_there_is_nothing_to_add_to(ann: bpy.types.Object) -> None:
    del ann
    with pytest.raises(RuntimeError, match="no generalized action yet"):
        ops.add_character()
    with pytest.raises(RuntimeError, match="No character in the scene"):
        ops.remove_character()


def test_a_removed_character_plays_no_more_and_keeps_its_values(wave: bpy.types.Action) -> None:
    ann = bpy.data.objects["Ann"]
    of_rig(ann).channels["Graspers"].position = (1, 2, 3)
    ops.remove_character(character="Ann")
    assert cast.playing(bpy.context.scene, wave) == []
    assert tuple(of_rig(ann).channels["Graspers"].position) == (1, 2, 3)
    ops.add_character(character="Ann", action="Wave")
    with pytest.raises(RuntimeError, match="select one that does"):
        ops.remove_character(character=scenes.figure("Bob").name)


@pytest.mark.parametrize("mode", ["OBJECT", "POSE"])
def test_a_character_is_made_the_active_one(wave: bpy.types.Action, mode: str) -> None:
    ann, rex = bpy.data.objects["Ann"], _hound()
    ops.add_character(character="Rex", action=wave.name)
    scenes.select(ann)
    bpy.ops.object.mode_set(mode=mode)
    ops.activate_character(character="Rex")
    assert bpy.context.view_layer.objects.active == rex
    assert {ann.mode, rex.mode} == {mode}
    scenes.select(ann)
    rex.hide_set(True)
    with pytest.raises(RuntimeError, match="is hidden"):
        ops.activate_character(character="Rex")


# --- branches ---


def _branch(name: str, movement: str, **settings: object) -> bpy.types.Action:
    action = bpy.data.actions.new(name)
    definitions.add(action, Channel("Heads", Context(Capability.HEAD)))
    of_action(action).movement = movement
    for key, value in settings.items():
        setattr(of_action(action), key, value)
    return action


def test_each_character_gets_the_branch_that_fits_it() -> None:
    ann, rex = scenes.figure("Ann"), _hound()
    _branch("Bow on Two", "Bow", upright_spine="true")
    _branch("Bow on Four", "Bow", leg_count=4)
    ops.play_movement(movement="Bow", character="Ann")
    assert ann.animation_data.action.name == "Bow on Two"
    scenes.select(ann, rex)
    ops.play_movement(movement="Bow")
    assert (ann.animation_data.action.name, rex.animation_data.action.name) == ("Bow on Two", "Bow on Four")
    ops.play_movement()
    assert rex.animation_data.action.name == "Bow on Four"


def test_a_character_that_no_branch_is_for_is_told_why() -> None:
    scenes.figure("Ann")
    with pytest.raises(RuntimeError, match="No action belongs to a movement"):
        ops.play_movement(movement="Bow", character="Ann")
    _branch("Bow on Four", "Bow", leg_count=4)
    _branch("Bow on Wings", "Bow", has_wings="true")
    with pytest.raises(RuntimeError, match=r"Bow on Four: it has 2 legs and not 4; Bow on Wings: it lacks wings"):
        ops.play_movement(movement="Bow", character="Ann")
    with pytest.raises(RuntimeError, match="'Jump': choose one of Bow"):
        ops.play_movement(movement="Jump", character="Ann")


# --- channels ---


@pytest.fixture
def own(wave: bpy.types.Action) -> MORPHRETARGET_PG_action:
    """Return the definitions of the new action, with three channels."""
    ops.add_channel(capability="foot")
    ops.add_channel(name="Gaze", capability="head")
    return of_action(wave)


def test_channels_are_added_moved_and_removed(own: MORPHRETARGET_PG_action) -> None:
    action = own.id_data
    assert _names(action) == ["Graspers", "Foot", "Gaze"]
    assert own.active_channel == 2
    ops.move_channel(direction="UP")
    assert _names(action) == ["Graspers", "Gaze", "Foot"]
    assert own.active_channel == 1
    ops.move_channel(channel="Graspers", direction="DOWN")
    assert _names(action) == ["Gaze", "Graspers", "Foot"]
    with pytest.raises(RuntimeError, match="end of the list"):
        ops.move_channel(channel="Foot", direction="DOWN")
    ops.remove_channel(channel="Foot")
    ops.remove_channel(action="Wave")
    assert _names(action) == ["Gaze"]
    assert own.active_channel == 0
    with pytest.raises(RuntimeError, match="last channel"):
        ops.remove_channel()
    with pytest.raises(RuntimeError, match="no channel 'Tail': choose one of Gaze"):
        ops.remove_channel(channel="Tail")


def test_characters_follow_the_list_at_once(own: MORPHRETARGET_PG_action) -> None:
    ann = bpy.data.objects["Ann"]
    ops.move_channel(channel="Gaze", direction="UP")
    member = cast.member(ann)
    assert [c.name for c in member.definition.channels] == ["Graspers", "Gaze", "Foot"]
    assert query.bodies_of_channel(ann, "Gaze") == ["head"]
    ops.remove_channel(channel="Gaze")
    assert [c.name for c in cast.member(ann).definition.channels] == ["Graspers", "Foot"]
    del own


def test_a_removed_channel_takes_its_keys_along(own: MORPHRETARGET_PG_action) -> None:
    ann, action = bpy.data.objects["Ann"], own.id_data
    own.channels["Gaze"].name = 'Gaze "up"'
    _key(ann, 'Gaze "up"', 1, (1, 2, 3))
    _key(ann, "Foot", 1, (1, 2, 3))
    ops.remove_channel(channel='Gaze "up"')
    assert {path for path, _ in keys.curves(action)} == {keys.path("Foot", "position")}


def test_a_duplicate_has_the_same_definition_keys_and_values(own: MORPHRETARGET_PG_action) -> None:
    ann, action = bpy.data.objects["Ann"], own.id_data
    item = own.channels["Foot"]
    item.ground_relative, item.context.side, item.secondary.capability = True, "left", "mouth"
    ops.add_deform(channel="Foot", name="open")
    values = of_rig(ann).channels["Foot"]
    values.target, values.deforms["open"].value = ann, 0.5
    for frame in (1, 9):
        _key(ann, "Foot", frame, (0, 0, frame))
    ops.duplicate_channel(channel="Foot")
    assert _names(action) == ["Graspers", "Foot", "Foot.001", "Gaze"]
    assert own.active_channel == 2
    made = own.channels["Foot.001"]
    assert (made.ground_relative, made.context.side, made.secondary.capability) == (True, "left", "mouth")
    copied = of_rig(ann).channels["Foot.001"]
    assert (copied.target, copied.deforms["open"].value) == (ann, 0.5)
    assert tuple(copied.position) == tuple(of_rig(ann).channels["Foot"].position)
    found, frames = keys.curves(action), np.linspace(1, 9, 17)
    old, new = (actions.sample(found[keys.path(name, "position"), 2], frames) for name in ("Foot", "Foot.001"))
    np.testing.assert_allclose(new, old, atol=1e-5)


def test_deforms_come_and_go_on_all_characters(own: MORPHRETARGET_PG_action) -> None:
    ann, rex = bpy.data.objects["Ann"], _hound()
    ops.add_character(character="Rex", action="Wave")
    ops.add_deform(channel="Gaze", name="open")
    ops.add_deform(channel="Gaze", name="open")
    assert [[d.name for d in of_rig(ob).channels["Gaze"].deforms] for ob in (ann, rex)] == [["open"], ["open"]]
    late = scenes.figure("Late")
    ops.add_character(character="Late", action="Wave")
    assert [d.name for d in of_rig(late).channels["Gaze"].deforms] == ["open"]
    keys.insert(ann, "Gaze", ["deforms"], 1)
    assert keys.curves(own.id_data)
    ops.remove_deform(channel="Gaze", name="open")
    assert not of_rig(rex).channels["Gaze"].deforms
    assert not keys.curves(own.id_data)
    with pytest.raises(RuntimeError, match="no deform 'open'"):
        ops.remove_deform(channel="Gaze", name="open")
    with pytest.raises(RuntimeError, match="needs a name"):
        ops.add_deform(name="")


# --- bodies ---


def test_bodies_of_a_channel_are_selected_on_all_its_characters(wave: bpy.types.Action) -> None:
    ann, bob = bpy.data.objects["Ann"], scenes.sprout("Bob")
    ops.add_character(character="Bob", action=wave.name)
    of_rig(ann).channels["Graspers"].active_body = "rightHand"
    ops.select_bodies()
    assert {ann.mode, bob.mode} == {"POSE"}
    assert (_chosen(ann), _chosen(bob)) == (set(HANDS), {"Hand.L", "Hand.R"})
    assert ann.data.bones.active.name == "rightHand"
    of_action(wave).channels[0].context.side = "left"
    ops.select_bodies(channel="Graspers", character="Ann")
    assert _chosen(ann) == {"leftHand"}
    assert ann.data.bones.active.name == "leftHand"
    assert bob.mode == "POSE"
    assert not _chosen(bob)


def test_any_context_selects_bodies_whether_or_not_an_action_plays(ann: bpy.types.Object) -> None:
    ops.select_bodies(use_channel=False, capability="grasper", side="right")
    assert _chosen(ann) == {"rightHand"}
    ops.select_bodies(use_channel=False, capability="grasper", extent="left_most", character="Ann")
    assert _chosen(ann) == {"leftHand"}
    assert query.bodies_of(ann, Context(Capability.GRASPER, side=Side.RIGHT)) == ["rightHand"]


def test_what_cannot_be_selected_is_said_and_changes_no_selection(wave: bpy.types.Action) -> None:
    ann = bpy.data.objects["Ann"]
    ops.select_bodies()
    with pytest.raises(RuntimeError, match="selects nothing on Ann"):
        ops.select_bodies(use_channel=False, capability="tail")
    with pytest.raises(RuntimeError, match="plays no channel 'Tail'"):
        ops.select_bodies(channel="Tail")
    assert _chosen(ann) == set(HANDS)
    bpy.ops.object.mode_set(mode="EDIT")
    with pytest.raises(RuntimeError, match="leave the present mode"):
        ops.select_bodies()
    bpy.ops.object.mode_set(mode="OBJECT")
    ann.hide_set(True)
    with pytest.raises(RuntimeError, match="is hidden"):
        ops.select_bodies(character="Ann")
    del wave


# --- variants ---


@pytest.fixture
def rig(wave: bpy.types.Action) -> MORPHRETARGET_PG_rig:
    """Return the settings of Ann, who takes something with one hand."""
    of_action(wave).channels[0].varies = True
    return of_rig(bpy.data.objects["Ann"])


def test_variants_are_stepped_through_and_chosen_by_number(rig: MORPHRETARGET_PG_rig) -> None:
    ann = rig.id_data
    first = query.bodies_of_channel(ann, "Graspers")
    ops.choose_variant(choice="NEXT")
    assert rig.variant == 1
    assert {*first, *query.bodies_of_channel(ann, "Graspers")} == set(HANDS)
    ops.choose_variant(choice="NEXT")
    assert rig.variant == 0
    ops.choose_variant(choice="PREVIOUS", character="Ann")
    assert rig.variant == 1
    ops.choose_variant(variant=0)
    assert rig.variant == 0
    with pytest.raises(RuntimeError, match="choose one from 0 to 1"):
        ops.choose_variant(variant=2)


def test_the_variant_nearest_to_the_target_is_chosen(rig: MORPHRETARGET_PG_rig, wave: bpy.types.Action) -> None:
    ann, item, fruit = rig.id_data, of_action(wave).channels[0], scenes.empty_object("Fruit")
    with pytest.raises(RuntimeError, match="no channel has a target"):
        ops.choose_variant(choice="NEAREST")
    item.target, item.secondary_relative = TargetKind.EXTERNAL.value, True
    with pytest.raises(RuntimeError, match="no channel has a target"):
        ops.choose_variant(choice="NEAREST")
    rig.channels["Graspers"].target = fruit
    for side, hand in ((1.0, "leftHand"), (-1.0, "rightHand")):
        fruit.location = (side, -0.4, 1.2)
        ops.choose_variant(choice="NEAREST")
        assert query.bodies_of_channel(ann, "Graspers") == [hand]


def test_what_cannot_vary_is_said(wave: bpy.types.Action) -> None:
    with pytest.raises(RuntimeError, match="one way to play"):
        ops.choose_variant(choice="NEXT")
    with pytest.raises(RuntimeError, match="'Bob' plays no generalized action"):
        ops.choose_variant(character=scenes.figure("Bob").name)
    del wave


def test_own_bodies_can_be_the_targets_of_the_nearest_variant(wave: bpy.types.Action) -> None:
    of_action(wave).channels.clear()
    definitions.add(
        wave,
        Channel(
            "Scratch",
            Context(Capability.GRASPER),
            Movement(secondary_relative=True),
            TargetKind.CONTEXT,
            Context(Capability.FOOT, extent=Extent.RIGHT_MOST),
            varies=True,
        ),
    )
    ops.choose_variant(choice="NEAREST", character="Ann")
    assert query.bodies_of_channel(bpy.data.objects["Ann"], "Scratch") == ["rightHand"]
