"""Rigs with controls that follow a source while frames change: what is live is what would be keyed."""

from pathlib import Path

import bpy
import numpy as np
import pytest

from morph_retarget.blender import live
from morph_retarget.blender.properties import of_rig, of_scene
from morph_retarget.blender.scene_properties import MORPHRETARGET_PG_scene
from morph_retarget.core.arrays import Array
from tests.blender import scenes

ops = bpy.ops.morph_retarget
FRAMES = [1, 2, 5, 9, 12, 7.5]
LAST = 12

pytestmark = pytest.mark.usefixtures("registered")


def opened(path: Path) -> tuple[MORPHRETARGET_PG_scene, bpy.types.Object, bpy.types.Object]:
    """Return the panel's settings, a walking source and a rig with controls, chosen in them."""
    bpy.ops.wm.open_mainfile(filepath=str(path))
    bpy.context.scene.render.fps = scenes.FPS
    target, settings = scenes.only_armature(), of_scene(bpy.context.scene)
    settings.source, settings.target = scenes.walker(), target
    settings.use_range, settings.frame_end = True, LAST
    return settings, settings.source, target


def deformed(ob: bpy.types.Object, frames: list[float] = FRAMES) -> Array:
    """Return the world matrices of the deform bones, shape (frame, bone, 4, 4)."""
    return scenes.evaluated(ob, [bone.name for bone in ob.data.bones if bone.use_deform], frames)


def play_other(ob: bpy.types.Object) -> None:
    """Let a rig play an action that switches its legs to inverse kinematics and lifts its body and a tweak."""
    away = np.tile([0.2, 0.1, 0.3], (2, 1))
    moved = {ob.pose.bones[name].path_from_id("location"): away for name in ("torso", "tweak_spine.001")}
    switches = {f'pose.bones["thigh_parent.{side}"]["IK_FK"]': np.zeros((2, 1)) for side in "LR"}
    scenes.key(ob, "Other", moved | switches)


@pytest.mark.parametrize(("kind", "onto"), [("human", "fk"), ("human", "ik"), ("horse", "auto")])
def test_the_live_pose_of_controls_is_the_baked_pose(rigify_file: Path, horse_file: Path, kind: str, onto: str) -> None:
    settings, _, target = opened(rigify_file if kind == "human" else horse_file)
    settings.onto = onto
    ops.live_start()
    followed = deformed(target)
    assert target.animation_data is None or target.animation_data.action is None
    assert len(bpy.data.scenes) == 1
    ops.live_stop()
    ops.retarget()
    assert np.abs(followed - deformed(target)).max() < 1e-4


def test_what_a_target_plays_besides_does_not_show(rigify_file: Path) -> None:
    _, _, target = opened(rigify_file)
    ops.live_start()
    alone = deformed(target)
    ops.live_stop()
    play_other(target)
    ops.live_start()
    assert np.abs(deformed(target) - alone).max() < 1e-4
    assert target.animation_data.action.name == "Other"


def test_switches_are_set_when_it_begins_and_as_settings_change_and_taken_back_by_undo(rigify_file: Path) -> None:
    settings, _, target = opened(rigify_file)
    leg = target.pose.bones["thigh_parent.L"]
    leg["IK_FK"] = 0.25
    bpy.ops.ed.undo_push(message="before")
    ops.live_start()
    assert leg["IK_FK"] == 1.0
    settings.onto = "ik"
    assert leg["IK_FK"] == 0.0
    leg["IK_FK"] = 0.5
    bpy.context.scene.frame_set(LAST)
    assert leg["IK_FK"] == 0.5, "it is set once, not at each frame"
    bpy.ops.ed.undo_push(message="live")
    bpy.ops.ed.undo()
    target = bpy.data.objects["rig"]
    assert of_rig(target).live_source is None
    assert target.pose.bones["thigh_parent.L"]["IK_FK"] == 0.25


def test_undo_keeps_a_rig_with_controls_following(rigify_file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    _, _, target = opened(rigify_file)
    ops.live_start()
    there = deformed(target, [10])
    bpy.ops.ed.undo_push(message="live")
    scenes.empty_object()
    bpy.ops.ed.undo_push(message="something else")
    monkeypatch.setattr(live.writing, "written", None)  # nothing is to be found out again
    bpy.ops.ed.undo()
    target = bpy.data.objects["rig"]
    assert np.abs(deformed(target, [10]) - there).max() < 1e-5
    assert of_rig(target).live_source is not None


def test_a_loaded_file_follows_again_on_its_controls(rigify_file: Path, tmp_path: Path) -> None:
    _, _, target = opened(rigify_file)
    ops.live_start()
    there = deformed(target, [10])
    bpy.ops.wm.open_mainfile(filepath=str(scenes.save(tmp_path / "live.blend")))
    target = bpy.data.objects["rig"]
    assert np.abs(deformed(target, [10]) - there).max() < 1e-5
    assert of_rig(target).live_source is not None


def test_an_override_that_was_made_because_live_asked_for_it_follows_again_in_its_file(
    rigify_file: Path, tmp_path: Path
) -> None:
    linked = scenes.link(rigify_file, "rig")
    settings = of_scene(bpy.context.scene)
    settings.source, settings.target = scenes.walker(), linked
    settings.use_range, settings.frame_end = True, LAST
    with pytest.raises(RuntimeError, match="make a library override of it first"):
        ops.live_start()
    target = linked.override_create(remap_local_usages=True)
    target.override_library.is_system_override = False
    settings.target = target
    ops.live_start()
    there = deformed(target, [10])
    bpy.ops.wm.open_mainfile(filepath=str(scenes.save(tmp_path / "shot.blend")))
    target = next(ob for ob in bpy.data.objects if ob.type == "ARMATURE" and ob.override_library)
    assert np.abs(deformed(target, [10]) - there).max() < 1e-5
    assert of_rig(target).live_source is not None
    assert target.pose.bones["thigh_parent.L"]["IK_FK"] == 1.0


def test_controls_rest_again_when_it_ends(rigify_file: Path) -> None:
    _, _, target = opened(rigify_file)
    rest = deformed(target, [1])
    ops.live_start()
    bpy.context.scene.frame_set(10)
    ops.live_stop()
    assert np.abs(deformed(target, [10]) - rest).max() < 1e-5


def test_work_that_is_closed_before_its_end_leaves_a_rig_with_controls_as_it_was(rigify_file: Path) -> None:
    settings, source, target = opened(rigify_file)
    settings.use_range = False
    before = deformed(target, [1])
    steps = live.starting(bpy.context.scene, source, target)
    for _ in range(5):
        next(steps)
    steps.close()
    assert of_rig(target).live_source is None
    assert np.abs(deformed(target, [9]) - before).max() < 1e-6
    assert target.pose.bones["thigh_parent.L"]["IK_FK"] == 0.0


def test_another_action_of_the_source_is_followed_when_live_is_switched_on_again(rigify_file: Path) -> None:
    _, source, target = opened(rigify_file)
    ops.live_start()
    scenes.walk(source, scenes.gait.walk(scenes.STEP, scenes.FPS, 1.0), "Slow")
    bpy.context.scene.frame_set(5)
    assert "switch Live on again" in live.problems[target.session_uid]
    ops.live_start()
    assert of_rig(target).live_source == source
