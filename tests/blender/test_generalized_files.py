"""Generalized actions in files: saved, loaded, appended, linked, overridden, undone; and what is wrong with them."""

from dataclasses import replace
from pathlib import Path

import bpy
import numpy as np
import pytest

from morph_retarget.blender import actions
from morph_retarget.blender.morph import cast, definitions, keys, perform, telling
from morph_retarget.blender.morph.properties import of_action
from morph_retarget.blender.properties import of_rig
from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.errors import MotionError
from morph_retarget.core.morph.channels import Channel, TargetKind
from morph_retarget.core.morph.context import Context, Side
from morph_retarget.core.morph.movement import Movement, ScaleMode
from tests.blender import acts, scenes
from tests.blender.acts import Act

ops = bpy.ops.morph_retarget
LIMB = Movement(scale=ScaleMode.LIMB_LENGTH)
REACH = Channel("Reach", Context(Capability.GRASPER, side=Side.LEFT), Movement(secondary_relative=True))
HEAD = Channel("Head", Context(Capability.HEAD), poses_position=False)
BONES = ["Hand.L", "Hand.R", "Head"]
FRAMES = (1, 7, 20)

pytestmark = pytest.mark.usefixtures("registered")


def _reach(*names: str) -> Act:
    """Return creatures that reach for a fruit with the left hand and shake their heads."""
    channel = replace(REACH, target=TargetKind.EXTERNAL)
    act = acts.act([acts.creature(name) for name in names or ("biped", "lopside")], channel, HEAD)
    fruit = acts.empty_object("Fruit", (0.4, -0.5, 0.9))
    for i in range(len(act.obs)):
        act.values(i).target = fruit
    for frame, x in ((1, 0.0), (20, 1.0)):
        act.key(frame, position=(x, 0.1, 0.0))
        act.key(frame, "Head", rotation=(0.8, 0.0, 0.0, 0.6 - 1.2 * x))
    return act


def _poses(obs: list[bpy.types.Object]) -> np.ndarray:
    """Return where hands and heads are over some frames, shape (character, frame, bone, 4, 4)."""
    return np.array([scenes.evaluated(ob, BONES, FRAMES) for ob in obs])


def _named(*names: str) -> list[bpy.types.Object]:
    return [bpy.data.objects[name] for name in names]


def _saved(path: Path) -> Path:
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


def _values(ob: bpy.types.Object) -> list[object]:
    return [
        (i.name, tuple(i.position), tuple(i.rotation), i.weight, i.target and i.target.name, i.active_body)
        for i in of_rig(ob).channels
    ]


def _definitions(action: bpy.types.Action) -> list[object]:
    return [definitions.read(action), [item.keyed_in for item in of_action(action).channels]]


# --- files ---


def test_a_loaded_file_has_all_channels_curves_values_and_targets_and_plays(tmp_path: Path) -> None:
    act = _reach()
    act.values(0, "Head").weight = 0.5
    act.values(1).active_body = "Hand.L"
    act.channel("Head").priority = 3
    was = [_poses(act.obs), _definitions(act.action), scenes.keys_of(act.action), [_values(ob) for ob in act.obs]]
    path = _saved(tmp_path / "act.blend")
    scenes.empty()
    bpy.ops.wm.open_mainfile(filepath=str(path))
    obs, action = _named("Biped", "Lopside"), bpy.data.actions["Act"]
    bpy.context.scene.frame_set(20)
    assert np.abs(_poses(obs) - was[0]).max() < 1e-5
    assert _definitions(action) == was[1]
    assert scenes.keys_of(action) == was[2]
    bpy.context.scene.frame_set(20)
    assert [_values(ob) for ob in obs] == was[3]
    assert [telling.tell(ob) for ob in obs] == [[], []]


def _load(path: Path, link: bool, **names: list[str]) -> None:
    with bpy.data.libraries.load(str(path), link=link) as (_, wanted):
        for kind, found in names.items():
            setattr(wanted, kind, found)


@pytest.mark.parametrize("link", [False, True], ids=["appended", "linked"])
def test_an_action_from_another_file_plays_on_the_characters_here(tmp_path: Path, link: bool) -> None:
    act = _reach()
    was, defined = _poses(act.obs), _definitions(act.action)
    path = _saved(tmp_path / "act.blend")
    scenes.empty()
    obs = [acts.creature(name) for name in ("lopside", "biped")]
    fruit = acts.empty_object("Apple", (0.4, -0.5, 0.9))
    _load(path, link, actions=["Act"])
    action = bpy.data.actions["Act"]
    assert (action.library is not None) == link
    assert _definitions(action) == defined
    for ob in obs:
        cast.add(ob, action)
        of_rig(ob).channels["Reach"].target = fruit
    assert np.abs(_poses(obs[::-1]) - was).max() < 1e-5
    assert [telling.tell(ob) for ob in obs] == [[], []]
    path = _saved(tmp_path / "mine.blend")
    scenes.empty()
    bpy.ops.wm.open_mainfile(filepath=str(path))
    assert np.abs(_poses(_named("Biped", "Lopside")) - was).max() < 1e-5


def test_a_linked_action_that_has_no_slot_is_refused(tmp_path: Path) -> None:
    action = bpy.data.actions.new("Bare")
    definitions.add(action, HEAD)
    action.use_fake_user = True
    path = _saved(tmp_path / "bare.blend")
    scenes.empty()
    ob = acts.creature("biped")
    _load(path, True, actions=["Bare"])
    with pytest.raises(MotionError, match=r"'Bare' is linked from a library where nobody plays it: make it local"):
        cast.add(ob, bpy.data.actions["Bare"])
    assert ob.animation_data is None or ob.animation_data.action is None


def test_characters_of_a_library_play_without_being_overridden(tmp_path: Path) -> None:
    act = _reach()
    was = _poses(act.obs)
    path = _saved(tmp_path / "act.blend")
    scenes.empty()
    _load(path, True, objects=["Biped", "Lopside"])
    obs = _named("Biped", "Lopside")
    for ob in obs:
        bpy.context.scene.collection.objects.link(ob)
    assert np.abs(_poses(obs) - was).max() < 1e-5
    assert [telling.tell(ob) for ob in obs] == [[], []]


def test_overridden_characters_play_a_local_action_toward_their_own_target(tmp_path: Path) -> None:
    acts.creature("biped")
    library = _saved(tmp_path / "biped.blend")
    scenes.empty()
    _load(library, True, objects=["Biped"])
    linked = bpy.data.objects["Biped"]
    bpy.context.scene.collection.objects.link(linked)
    ob = linked.override_create(remap_local_usages=True)
    act = acts.act([ob], replace(REACH, target=TargetKind.EXTERNAL), HEAD)
    act.values().target = acts.empty_object("Fruit", (0.4, -0.5, 0.9))
    for frame, x in ((1, 0.0), (20, 1.0)):
        act.key(frame, position=(x, 0.1, 0.0))
    was = _poses([ob])
    assert np.abs(was[0, 2, 0, :3, 3] - (0.4, -0.5, 0.9)).max() < 0.2
    assert act.tell() == ""
    path = _saved(tmp_path / "scene.blend")
    scenes.empty()
    bpy.ops.wm.open_mainfile(filepath=str(path))
    (again,) = [ob for ob in bpy.context.scene.objects if ob.type == "ARMATURE"]
    assert again.override_library is not None
    assert np.abs(_poses([again]) - was).max() < 1e-5
    assert of_rig(again).channels["Reach"].target == bpy.data.objects["Fruit"]


def test_overridden_performers_keep_their_changes(tmp_path: Path) -> None:
    act = _reach("biped")
    act.channel().varies = True
    library = _saved(tmp_path / "act.blend")
    scenes.empty()
    _load(library, True, objects=["Biped"])
    linked = bpy.data.objects["Biped"]
    bpy.context.scene.collection.objects.link(linked)
    ob = linked.override_create(remap_local_usages=True)
    apple = acts.empty_object("Apple", (0.2, -0.4, 1.1))
    of_rig(ob).channels["Reach"].target = apple
    bpy.context.scene.frame_set(20)
    was = _poses([ob])
    path = _saved(tmp_path / "scene.blend")
    scenes.empty()
    bpy.ops.wm.open_mainfile(filepath=str(path))
    (again,) = [ob for ob in bpy.context.scene.objects if ob.type == "ARMATURE"]
    assert of_rig(again).channels["Reach"].target == bpy.data.objects["Apple"]
    assert np.abs(_poses([again]) - was).max() < 1e-5


# --- undo ---


def _push(message: str) -> None:
    bpy.ops.ed.undo_push(message=message)


def test_undo_and_redo_bring_channels_curves_values_and_poses_back() -> None:
    _reach("biped", "asura")
    bpy.context.scene.frame_set(20)

    def state() -> list[object]:
        bpy.context.view_layer.update()
        action = bpy.data.actions["Act"]
        obs = _named("Biped", "Asura")
        return [_definitions(action), scenes.keys_of(action), [_values(ob) for ob in obs]]

    def poses() -> np.ndarray:
        return np.concatenate([acts.pose(ob) for ob in _named("Biped", "Asura")])

    _push("start")
    states, shown = [state()], [poses()]
    for message, edit in (
        ("key", lambda: keys.insert(bpy.data.objects["Biped"], "Reach", ["weight"], 20)),
        ("value", lambda: setattr(of_rig(bpy.data.objects["Biped"]).channels["Head"], "weight", 0.3)),
        ("mode", lambda: setattr(of_action(bpy.data.actions["Act"]).channels["Reach"], "directional_only", True)),
        ("rename", lambda: setattr(of_action(bpy.data.actions["Act"]).channels["Reach"], "name", "Grab")),
        ("channel", lambda: ops.add_channel(action="Act", capability="foot")),
        ("removed", lambda: ops.remove_channel(action="Act", channel="Head")),
    ):
        edit()
        bpy.context.view_layer.update()
        _push(message)
        states.append(state())
        shown.append(poses())
    steps = len(states)
    for place in range(steps - 2, -1, -1):
        bpy.ops.ed.undo()
        assert state() == states[place]
        assert np.abs(poses() - shown[place]).max() < 1e-5
    for place in range(1, steps):
        bpy.ops.ed.redo()
        assert state() == states[place]
        assert np.abs(poses() - shown[place]).max() < 1e-5


def test_a_drag_is_undone_at_once() -> None:
    act = _reach("biped")
    ob = act.obs[0]
    ob.select_set(True)
    bpy.ops.object.mode_set(mode="POSE")
    bpy.context.view_layer.update()
    _push("before")
    rest = acts.heads(bpy.data.objects["Biped"], BONES)
    ob = bpy.data.objects["Biped"]
    ob.data.bones.active = ob.data.bones["Head"]
    ob.pose.bones["Head"].rotation_quaternion = (0.8, 0.6, 0.0, 0.0)
    bpy.context.view_layer.update()
    assert of_rig(ob).channels["Head"].rotation[0] != 1.0
    _push("turned")
    bpy.ops.ed.undo()
    assert np.abs(acts.heads(bpy.data.objects["Biped"], BONES) - rest).max() < 1e-5


# --- what is wrong ---


def _plays_on(act: Act, bone: str = "Head", i: int = 0) -> None:
    """Check that a bone still moves over the clip."""
    found = scenes.evaluated(act.obs[i], [bone], FRAMES)
    assert np.abs(found[0] - found[2]).max() > 0.05


def test_an_action_of_a_newer_version_is_refused_and_keeps_everything(tmp_path: Path) -> None:
    act = _reach()
    was = [scenes.keys_of(act.action), [_values(ob) for ob in act.obs]]
    of_action(act.action).version = 999
    perform.definition_changed(act.action)
    bpy.context.scene.frame_set(7)
    told = act.tell()
    assert "'Act' was made by a newer version of Morph Retarget: update the extension" in told
    with pytest.raises(MotionError, match="newer version"):
        cast.member(act.obs[0])
    path = _saved(tmp_path / "new.blend")
    scenes.empty()
    bpy.ops.wm.open_mainfile(filepath=str(path))
    action = bpy.data.actions["Act"]
    assert of_action(action).version == 999
    assert [item.name for item in of_action(action).channels] == ["Reach", "Head"]
    bpy.context.scene.frame_set(1)
    assert "newer version" in "".join(telling.tell(bpy.data.objects["Biped"]))
    of_action(action).version = 1
    perform.definition_changed(action)
    assert scenes.keys_of(action) == was[0]
    bpy.context.scene.frame_set(20)
    assert telling.tell(bpy.data.objects["Biped"]) == []


def _raw(item: bpy.types.PropertyGroup) -> object:
    """Return the data of a group as files have it."""
    return item.bl_system_properties_get(do_create=True) if hasattr(item, "bl_system_properties_get") else item


@pytest.mark.parametrize("name", ["scale", "target", "variant_side", "mirror", "capability", "depth", "has_feet"])
def test_a_setting_that_this_version_does_not_know_is_told_and_kept(name: str) -> None:
    act = _reach("biped", "lopside")
    second = acts.act([acts.creature("asura")], HEAD, name="Second")
    second.key(1, rotation=(1.0, 0.0, 0.0, 0.0))
    second.key(20, rotation=(0.0, 1.0, 0.0, 0.0))
    item = act.channel()
    owner = {"capability": item.context, "depth": item.context, "has_feet": of_action(act.action)}.get(name, item)
    _raw(owner)[name] = 77
    perform.definition_changed(act.action)
    bpy.context.scene.frame_set(7)
    told = act.tell()
    assert "does not know" in told
    assert ("'Act'" if name == "has_feet" else "'Reach'") in told
    assert "choose it again" in told
    assert _raw(owner)[name] == 77
    _plays_on(second)
    if name != "has_feet":  # of such an action nothing is played
        _plays_on(act)
    item.ground_relative = True  # another setting can still be changed, and nothing breaks
    setattr(owner, name, owner.bl_rna.properties[name].enum_items[0].identifier)
    bpy.context.scene.frame_set(1)
    assert "does not know" not in act.tell()


def test_a_deleted_target_is_told_and_the_rest_plays() -> None:
    act = _reach()
    bpy.data.objects.remove(bpy.data.objects["Fruit"])
    bpy.context.scene.frame_set(3)
    assert act.tell() == "channel 'Reach' has no target on this character: choose one"
    _plays_on(act)
    found = scenes.evaluated(act.obs[0], ["Hand.R"], FRAMES)
    assert np.abs(found[0] - found[2]).max() < 1e-5
    act.values().target = acts.empty_object("Pear", (0.4, -0.5, 0.9))
    bpy.context.scene.frame_set(20)
    assert act.tell(0) == ""
    assert "'Reach'" in act.tell(1)
    _plays_on(act, "Hand.L")


@pytest.mark.parametrize("how", ["hidden", "excluded", "in no collection"])
def test_a_target_that_blender_does_not_evaluate_counts_where_it_was_put(how: str, tmp_path: Path) -> None:
    act = _reach()
    was = _poses(act.obs)
    fruit, scene = bpy.data.objects["Fruit"], bpy.context.scene
    fruit.use_fake_user = True
    if how == "hidden":
        fruit.hide_viewport = True
    else:
        scene.collection.objects.unlink(fruit)
    if how == "excluded":
        away = bpy.data.collections.new("Away")
        scene.collection.children.link(away)
        away.objects.link(fruit)
        bpy.context.view_layer.layer_collection.children["Away"].exclude = True
    path = _saved(tmp_path / "act.blend")
    scenes.empty()
    bpy.ops.wm.open_mainfile(filepath=str(path))
    assert np.abs(_poses(_named("Biped", "Lopside")) - was).max() < 1e-5


def test_a_target_bone_that_is_gone_is_told() -> None:
    act = _reach("biped", "lopside")
    act.values().target, act.values().target_bone = act.obs[1], "Head"
    bpy.context.scene.frame_set(2)
    assert act.tell() == ""
    act.obs[1].data.bones["Head"].name = "Skull"
    act.values().target_bone = "Head"
    bpy.context.scene.frame_set(3)
    assert act.tell() == "channel 'Reach' has no target on this character: choose one"


def test_a_channel_that_selects_nothing_is_told_and_the_rest_plays() -> None:
    act = acts.act([acts.creature("snake")], Channel("Feet", Context(Capability.FOOT), LIMB), HEAD)
    act.key(1, "Head", rotation=(1.0, 0.0, 0.0, 0.0))
    act.key(20, "Head", rotation=(0.8, 0.6, 0.0, 0.0))
    assert act.tell() == "channel 'Feet' selects nothing on this character: change the context if that is wrong"
    _plays_on(act)


def test_two_channels_that_fight_for_a_body_are_told_and_the_first_wins() -> None:
    hands = [Channel(name, Context(Capability.GRASPER), LIMB) for name in ("One", "Two")]
    act = acts.act([acts.creature("biped")], *hands, HEAD)
    act.values(0, "One").position, act.values(0, "Two").position = (0.0, -0.2, 0.0), (0.0, 0.4, 0.0)
    bpy.context.view_layer.update()
    assert "channel 'Two' loses" in act.tell()
    assert act.tell().endswith("give both the same blend group to share")
    bodies, goals = cast.member(act.obs[0]).bodies, act.shown()
    hand = [bodies.names[body] for body in goals.bodies].index("Hand.L")
    assert goals.positions[0, hand][1] < bodies.positions[goals.bodies[hand]][1]


def test_an_edited_armature_is_analysed_anew() -> None:
    act = _reach("biped")
    ob = act.obs[0]
    bpy.context.scene.frame_set(20)
    hands = [item for item in cast.member(ob).bodies.names if "Hand" in item]
    bpy.ops.object.mode_set(mode="EDIT")
    bones = ob.data.edit_bones
    bones["Head"].name = "Skull"
    added = bones.new("Horn")
    added.head, added.tail, added.parent = (0.0, 0.0, 1.9), (0.0, 0.0, 2.0), bones["Skull"]
    bones.remove(bones["Toes.R"])
    for bone in bones:
        bone.use_connect = False
    for name in ("UpperArm.L", "LowerArm.L", "Hand.L"):
        bones[name].tail.x += 0.3
    bones["LowerArm.L"].head.x += 0.2
    bones["Hand.L"].head.x += 0.3
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.context.view_layer.update()
    member = cast.member(ob)
    assert set(member.rig.skeleton.names) == set(ob.data.bones.keys())
    assert {"Skull", "Horn", *hands} <= set(member.bodies.names)
    bpy.context.scene.frame_set(7)
    assert act.tell() == ""
    bpy.context.scene.frame_set(20)
    place = [member.bodies.names[b] for b in act.shown().bodies].index("Hand.L")
    goal = acts.in_world(ob, act.shown().positions[0, place])
    assert np.abs(acts.heads(ob, ["Hand.L"])[0] - goal).max() < 0.05


def test_a_bone_renamed_in_pose_mode_is_analysed_anew() -> None:
    act = _reach("biped")
    ob = act.obs[0]
    ob.select_set(True)
    bpy.ops.object.mode_set(mode="POSE")
    ob.data.bones["Head"].name = "Skull"
    bpy.context.view_layer.update()
    bpy.context.scene.frame_set(7)
    assert "Skull" in cast.member(ob).bodies.names
    assert act.tell() == ""


def test_a_joint_corrected_by_the_user_counts_at_once() -> None:
    act = acts.act([acts.creature("biped")], Channel("Hands", Context(Capability.GRASPER), LIMB))
    ob = act.obs[0]
    assert len(act.shown().bodies) == 2
    ops.analyze(rig=ob.name)
    of_rig(ob).joints["leftHand"].bone = "LowerArm.L"
    bpy.context.view_layer.update()
    bpy.context.scene.frame_set(3)
    assert "LowerArm.L" in {cast.member(ob).bodies.names[body] for body in act.shown().bodies}


def test_an_armature_that_lost_all_its_bones_is_told_and_the_others_play() -> None:
    act = _reach()
    bpy.context.view_layer.objects.active = act.obs[0]
    bpy.ops.object.mode_set(mode="EDIT")
    for bone in list(act.obs[0].data.edit_bones):
        act.obs[0].data.edit_bones.remove(bone)
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.context.view_layer.update()
    bpy.context.scene.frame_set(3)
    assert act.tell() == "armature 'Biped' has no bones: choose one that has"
    _plays_on(act, "Hand.L", 1)


def test_an_armature_without_bones_cannot_be_added() -> None:
    act = _reach("biped")
    bare = bpy.data.objects.new("Bare", bpy.data.armatures.new("Bare"))
    bpy.context.scene.collection.objects.link(bare)
    with pytest.raises(RuntimeError, match="armature 'Bare' has no bones: choose one that has"):
        ops.add_character(character="Bare", action="Act")
    assert bare.animation_data is None or bare.animation_data.action is None
    actions.assign(bare, act.action, act.action.slots[0])  # by hand, in the Action editor
    bpy.context.scene.frame_set(3)
    assert "'Bare' has no bones" in "".join(telling.tell(bare))
    _plays_on(act, "Hand.L")


def test_a_character_that_gets_the_action_in_the_action_editor_plays_it() -> None:
    act = _reach("biped")
    ob = acts.creature("asura")
    actions.assign(ob, act.action, act.action.slots[0])
    bpy.context.scene.frame_set(20)
    assert telling.tell(ob) == ["channel 'Reach' has no target on this character: choose one"]
    _plays_on(Act(act.action, [ob]))


def test_a_muted_character_is_left_alone() -> None:
    act = _reach()
    of_rig(act.obs[0]).muted = True
    bone = act.obs[0].pose.bones["Head"]
    bone.rotation_quaternion = (0.6, 0.8, 0.0, 0.0)
    bpy.context.scene.frame_set(20)
    assert tuple(bone.rotation_quaternion) == pytest.approx((0.6, 0.8, 0.0, 0.0))
    _plays_on(act, "Hand.L", 1)
    of_rig(act.obs[0]).muted = False
    bpy.context.view_layer.update()
    assert tuple(bone.rotation_quaternion) != pytest.approx((0.6, 0.8, 0.0, 0.0))
