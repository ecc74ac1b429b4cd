"""The buttons, called as scripts call them."""

import json
from pathlib import Path

import bpy
import numpy as np
import pytest

from morph_retarget.blender import actions
from morph_retarget.blender.operators import retargeting
from morph_retarget.blender.properties import of_rig
from morph_retarget.core.character.joints import PARENTS
from tests.blender import scenes, window

ops = bpy.ops.morph_retarget

pytestmark = pytest.mark.usefixtures("registered")


def _snapshot(ob: bpy.types.Object, action: bpy.types.Action) -> list[object]:
    keys = [
        [tuple(point.co) for point in curve.keyframe_points]
        for curve in actions.curves(action, action.slots[0]).values()
    ]
    bones = [tuple(map(tuple, bone.matrix_local)) for bone in ob.data.bones]
    return [keys, bones, tuple(map(tuple, ob.matrix_world))]


# --- analysis and corrections ---


def test_analysis_lists_all_joints_with_what_was_found() -> None:
    _, _, target = window.pair()
    ops.analyze(rig=target.name)
    joints = of_rig(target).joints
    assert [joint.name for joint in joints] == list(PARENTS)
    assert joints["leftFoot"].bone == "Foot.L"
    assert joints["leftFoot"].confidence > 0.9
    assert joints["leftFoot"].by == "name"
    assert not joints["jaw"].bone


def test_corrections_outlive_a_new_analysis_and_can_be_taken_back() -> None:
    _, _, target = window.pair()
    ops.analyze(rig=target.name)
    joints = of_rig(target).joints
    joints["neck"].bone = ""
    joints["head"].bone = "Neck"
    ops.analyze(rig=target.name)
    assert joints["head"].bone == "Neck"
    assert joints["head"].by == "user"
    assert not joints["neck"].bone
    ops.reset_joints(rig=target.name)
    assert joints["head"].bone == "Head"
    assert joints["neck"].bone == "Neck"


def test_a_picked_bone_leaves_the_joint_that_had_it() -> None:
    _, _, target = window.pair()
    ops.analyze(rig=target.name)
    ops.pick_bone(rig=target.name, joint="leftHand", bone="LowerArm.L")
    joints = of_rig(target).joints
    assert joints["leftHand"].bone == "LowerArm.L"
    assert not joints["leftLowerArm"].bone


def test_the_selected_bone_is_picked() -> None:
    _, _, target = window.pair()
    ops.analyze(rig=target.name)
    bpy.context.view_layer.objects.active = target
    target.data.bones.active = target.data.bones["Neck"]
    of_rig(target).active_joint = list(PARENTS).index("jaw")
    ops.pick_bone(rig=target.name)
    assert of_rig(target).joints["jaw"].bone == "Neck"


@pytest.mark.parametrize("numbered", [False, True], ids=["by name", "by place"])
def test_a_joint_is_mirrored_to_the_other_side(numbered: bool) -> None:
    _, _, target = window.pair()
    if numbered:
        for i, bone in enumerate(target.data.bones):
            bone.name = f"joint{i}"
    ops.analyze(rig=target.name)
    joints = of_rig(target).joints
    wanted = joints["rightLowerArm"].bone
    assert wanted
    joints["rightLowerArm"].bone = ""
    ops.mirror_joint(rig=target.name, joint="leftLowerArm")
    assert joints["rightLowerArm"].bone == wanted


def test_what_cannot_be_corrected_is_said_in_one_line() -> None:
    _, source, target = window.pair()
    with pytest.raises(RuntimeError, match="Analyze a rig first"):
        ops.clear_joint(rig=source.name, joint="hips")
    ops.analyze(rig=target.name)
    with pytest.raises(RuntimeError, match="analyze it first"):
        ops.clear_joint(rig=source.name, joint="hips")
    with pytest.raises(RuntimeError, match="has no bone 'Nose'"):
        ops.pick_bone(rig=target.name, joint="head", bone="Nose")
    with pytest.raises(RuntimeError, match="other side"):
        ops.mirror_joint(rig=target.name, joint="head")
    with pytest.raises(RuntimeError, match="use VRM"):
        ops.clear_joint(rig=target.name, joint="elbow")
    with pytest.raises(RuntimeError, match="no armature 'Nobody'"):
        ops.analyze(rig="Nobody")


# --- presets ---


def test_a_preset_gives_its_joints_to_another_rig_of_the_same_bones(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("morph_retarget.blender.presets._folder", [tmp_path])
    settings, _, target = window.pair()
    ops.analyze(rig=target.name)
    ops.pick_bone(rig=target.name, joint="head", bone="Neck")
    ops.save_preset(rig=target.name, name="Sprouts")
    other = scenes.sprout("Other")
    settings.target = other
    ops.load_preset(rig=other.name, name="Sprouts")
    assert of_rig(other).joints["head"].bone == "Neck"
    assert of_rig(other).joints["head"].by == "preset"
    ops.delete_preset(name="Sprouts")
    with pytest.raises(RuntimeError, match="no preset 'Sprouts'"):
        ops.load_preset(rig=other.name, name="Sprouts")


def test_a_map_goes_to_a_file_and_back_and_a_wrong_one_changes_nothing(tmp_path: Path) -> None:
    _, source, target = window.pair()
    ops.analyze(rig=target.name)
    path = tmp_path / "map.json"
    ops.export_map(rig=target.name, filepath=str(path))
    assert json.loads(path.read_text())["joints"]["leftFoot"] == "Foot.L"
    ops.import_map(rig=target.name, filepath=str(path))
    assert of_rig(target).joints["leftFoot"].by == "preset"
    ops.analyze(rig=source.name)
    before = [(joint.bone, joint.by) for joint in of_rig(source).joints]
    with pytest.raises(RuntimeError, match="Hips"):
        ops.import_map(rig=source.name, filepath=str(path))
    assert [(joint.bone, joint.by) for joint in of_rig(source).joints] == before


# --- retargeting ---


def test_retargeting_makes_a_new_action_and_leaves_everything_else() -> None:
    _, source, target = window.pair()
    clip = source.animation_data.action
    before = _snapshot(source, clip)
    frame = bpy.context.scene.frame_current
    ops.retarget()
    made = target.animation_data.action
    assert made.name == "Walk on Sprout"
    assert target.animation_data.action_slot.identifier.endswith("Sprout")
    assert made != clip
    assert _snapshot(source, clip) == before
    assert bpy.context.scene.frame_current == frame
    report = retargeting.latest(target)
    assert report is not None
    assert report["frames"] == 34


def test_all_actions_of_the_source_are_retargeted_in_one_go() -> None:
    _, source, target = window.pair()
    second = source.animation_data.action.copy()
    second.name = "Stroll"
    ops.retarget(all_actions=True)
    names = {action.name for action in bpy.data.actions}
    assert {"Walk on Sprout", "Stroll on Sprout"} <= names
    assert target.animation_data.action.name in {"Walk on Sprout", "Stroll on Sprout"}


def test_a_retarget_that_is_stopped_half_way_leaves_nothing() -> None:
    settings, source, target = window.pair()
    source.animation_data.action.copy().name = "Stroll"
    scenes.empty_object("Ball")
    before = set(bpy.data.actions), actions.assigned(target)
    chosen = actions.of_armature(source)
    assert len(chosen) == 2
    work = retargeting.steps(bpy.context.scene, source, target, chosen)
    next(work)
    assert set(bpy.data.actions) != before[0]
    work.close()
    assert (set(bpy.data.actions), actions.assigned(target)) == before
    del settings


def test_a_retarget_that_fails_half_way_leaves_nothing() -> None:
    _, source, target = window.pair()
    bad = source.animation_data.action.copy()
    for curve in actions.curves(bad, bad.slots[0]).values():
        curve.keyframe_points[3].co[1] = float("nan")
    before = set(bpy.data.actions)
    with pytest.raises(RuntimeError, match="no numbers"):
        ops.retarget(all_actions=True)
    assert set(bpy.data.actions) == before
    assert target.animation_data is None or target.animation_data.action is None


def test_settings_of_the_panel_count() -> None:
    settings, source, target = window.pair()
    settings.use_range, settings.frame_start, settings.frame_end = True, 5, 20
    settings.name_template = "{target} does {action}"
    settings.root_motion = "in-place"
    ops.retarget()
    made = target.animation_data.action
    assert made.name == "Sprout does Walk"
    assert tuple(made.frame_range) == (5.0, 20.0)
    hips = scenes.heads(target, ["Hips"], [5, 20])[:, 0]
    assert abs(hips[1, 1] - hips[0, 1]) < 0.05
    del source


def test_bad_requests_are_reported_and_change_nothing() -> None:
    settings, source, target = window.pair()
    before = set(bpy.data.actions)
    with pytest.raises(RuntimeError, match="no action 'Fly'"):
        ops.retarget(action="Fly")
    with pytest.raises(RuntimeError, match="both 'Walker'"):
        ops.retarget(source=source.name, target=source.name)
    settings.name_template = "{nobody}"
    with pytest.raises(RuntimeError, match="nobody"):
        ops.retarget()
    settings.name_template = "{action}"
    source.animation_data.action = None
    with pytest.raises(RuntimeError, match="plays no action"):
        ops.retarget()
    settings.source = target
    with pytest.raises(RuntimeError, match="same armature"):
        ops.retarget()
    assert set(bpy.data.actions) == before


# --- contacts ---


def test_contacts_are_found_edited_and_used() -> None:
    _, source, target = window.pair(seconds=2 * scenes.STEP)
    ops.detect_contacts()
    rig = of_rig(source)
    assert {item.name for item in rig.contacts} == {"leftFoot", "rightFoot"}
    ops.retarget()
    free = scenes.heads(target, ["Foot.L"], range(1, 60))
    # One long plant of the left foot in place of those found: it must not move any more.
    rig.contacts.clear()
    ops.add_contact(foot="leftFoot", start=3, end=9)
    ops.retarget()
    held = scenes.heads(target, ["Foot.L"], range(1, 60))
    assert np.abs(np.ptp(held[4:8, 0, :2], axis=0)).max() < 0.002
    assert np.abs(held - free).max() > 0.001
    ops.remove_contact()
    assert not rig.contacts


def test_a_contact_of_an_unknown_foot_is_named() -> None:
    window.pair()
    ops.add_contact(foot="Paw", start=1, end=9)
    with pytest.raises(RuntimeError, match="Paw"):
        ops.retarget()


# --- undo ---


def test_what_was_undone_is_told_of_no_more() -> None:
    window.pair()
    bpy.ops.ed.undo_push(message="Before")
    ops.retarget()
    bpy.ops.ed.undo_push(message="Retarget")
    assert retargeting.latest(bpy.data.objects["Sprout"]) is not None
    bpy.ops.ed.undo()
    assert retargeting.latest(bpy.data.objects["Sprout"]) is None


# --- choosing rigs ---


def test_swapping_and_selecting_choose_the_rigs() -> None:
    settings, source, target = window.pair()
    ops.swap()
    assert (settings.source, settings.target) == (target, source)
    for ob in (source, target):
        ob.select_set(True)
    bpy.context.view_layer.objects.active = target
    ops.use_selected()
    assert (settings.source, settings.target) == (source, target)
