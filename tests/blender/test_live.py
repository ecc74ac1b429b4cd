"""Targets that follow while frames change."""

import bpy
import numpy as np
import pytest

from morph_retarget.blender import live
from morph_retarget.blender.properties import of_rig
from tests.blender import scenes, window
from tools import bodies

ops = bpy.ops.morph_retarget
BONES = ["Hips", "Head", "Hand.L", "Foot.R"]
FRAMES = [1, 7, 20, 34]

pytestmark = pytest.mark.usefixtures("registered")


def test_the_live_pose_is_the_baked_pose() -> None:
    _, _, target = window.pair()
    ops.live_start()
    followed = scenes.evaluated(target, BONES, FRAMES)
    assert target.animation_data is None or target.animation_data.action is None
    ops.live_stop()
    ops.retarget()
    baked = scenes.evaluated(target, BONES, FRAMES)
    assert np.abs(followed - baked).max() < 1e-5


def _skin(body: bpy.types.Object) -> np.ndarray:
    """Return the vertices of a skinned mesh as they are shown, world space, shape (vertex, 3)."""
    seen = body.evaluated_get(bpy.context.evaluated_depsgraph_get())
    return np.array([seen.matrix_world @ vertex.co for vertex in seen.data.vertices])


@pytest.mark.parametrize("root", ["hips", "object"])
def test_a_skinned_mesh_follows_too(root: str) -> None:
    settings, _, target = window.pair()
    settings.root_motion = root
    body = bodies.clothe(target)
    ops.live_start()
    shown = []
    for frame in FRAMES:
        bpy.context.scene.frame_set(frame)
        shown.append(_skin(body))
    ops.live_stop()
    ops.retarget()
    for frame, followed in zip(FRAMES, shown, strict=True):
        bpy.context.scene.frame_set(frame)
        assert np.abs(followed - _skin(body)).max() < 1e-5


def test_a_source_that_blender_has_made_no_pose_for_is_refused() -> None:
    _, source, target = window.pair()
    nobody = bpy.data.objects.new("Nobody", source.data)
    nobody.animation_data_create().action = source.animation_data.action
    assert nobody.pose is None
    for operator in (ops.live_start, ops.retarget):
        with pytest.raises(RuntimeError, match="'Nobody' has no pose yet: link it to a scene"):
            operator(source="Nobody", target=target.name)
    assert not live.following(target)


@pytest.mark.parametrize("mode", ["XYZ", "AXIS_ANGLE"])
def test_every_rotation_mode_follows(mode: str) -> None:
    _, _, target = window.pair()
    ops.retarget()
    baked = scenes.evaluated(target, BONES, FRAMES)
    target.animation_data_clear()
    for bone in target.pose.bones:
        bone.rotation_mode = mode
    ops.live_start()
    assert np.abs(scenes.evaluated(target, BONES, FRAMES) - baked).max() < 1e-5


def test_what_is_shown_depends_on_the_frame_alone() -> None:
    _, _, target = window.pair()
    ops.live_start()
    there = scenes.evaluated(target, BONES, [20])
    scenes.evaluated(target, BONES, [3, 30, 11.5, 1])
    assert np.array_equal(scenes.evaluated(target, BONES, [20]), there)


def test_frames_between_frames_lie_between() -> None:
    _, _, target = window.pair()
    ops.live_start()
    low, middle, high = scenes.heads(target, ["Hips"], [10, 10.5, 11])[:, 0]
    assert np.abs(middle - 0.5 * (low + high)).max() < 1e-3


def test_a_change_of_settings_shows_at_once() -> None:
    settings, _, target = window.pair()
    bpy.context.scene.frame_set(30)
    ops.live_start()
    travelled = scenes.heads(target, ["Hips"], [30])[0, 0]
    settings.root_motion = "in-place"
    bpy.context.view_layer.update()
    stayed = np.array(target.pose.bones["Hips"].head)
    assert abs(travelled[1]) > abs(stayed[1]) + 0.05


def test_other_bones_keep_their_own_pose() -> None:
    _, _, target = window.pair()
    target.pose.bones["Root"].location = (0.5, 0.0, 0.0)
    thumb = target.pose.bones["ThumbDistal.L"]
    thumb.location = (0.0, 0.01, 0.0)
    ops.live_start()
    bpy.context.scene.frame_set(12)
    assert tuple(thumb.location) == pytest.approx((0.0, 0.01, 0.0))
    # The root is above the hips, so it belongs to the body and must rest.
    assert tuple(target.pose.bones["Root"].location) == (0.0, 0.0, 0.0)


def test_another_action_of_the_source_is_followed() -> None:
    _, source, target = window.pair()
    ops.live_start()
    before = scenes.heads(target, ["Hips"], [30])
    source.animation_data.action = None
    bpy.context.scene.frame_set(29)
    assert of_rig(target).live_source is None
    assert "plays no action" in live.problems[target.session_uid]
    scenes.walk(source, scenes.gait.walk(scenes.STEP, scenes.FPS, 1.0), "Slow")
    ops.live_start()
    assert np.abs(scenes.heads(target, ["Hips"], [30]) - before).max() > 0.05


def test_clearing_brings_the_rest_back() -> None:
    _, _, target = window.pair()
    ops.live_start()
    bpy.context.scene.frame_set(20)
    ops.live_stop()
    bpy.context.view_layer.update()
    away = [np.abs(np.array(bone.matrix_basis) - np.eye(4)).max() for bone in target.pose.bones]
    assert max(away) < 1e-6
    bpy.context.scene.frame_set(25)
    assert max(np.abs(np.array(bone.matrix_basis) - np.eye(4)).max() for bone in target.pose.bones) < 1e-6


def test_an_object_that_travels_is_put_back_and_never_strays() -> None:
    settings, _, target = window.pair()
    settings.root_motion = "object"
    target.location = (1.0, 2.0, 0.0)
    bpy.context.view_layer.update()
    ops.live_start()
    there = scenes.evaluated(target, BONES, [30])
    for lock in (0.5, 1.0):  # transferred anew, while the object is away
        settings.lock = lock
    assert np.abs(scenes.evaluated(target, BONES, [30]) - there).max() < 1e-5
    live.forget()
    assert np.abs(scenes.evaluated(target, BONES, [30]) - there).max() < 1e-5
    ops.live_stop()
    assert tuple(target.location) == pytest.approx((1.0, 2.0, 0.0), abs=1e-6)


def test_what_cannot_follow_says_why_and_stops() -> None:
    _, source, target = window.pair()
    ops.live_start()
    of_rig(target).joints.clear()
    ops.analyze(rig=target.name)
    of_rig(target).joints["hips"].bone = "Gone"
    bpy.context.scene.frame_set(10)
    assert of_rig(target).live_source is None
    assert "Gone" in live.problems[target.session_uid]
    del source


def test_a_loaded_file_follows_again(tmp_path: pytest.TempPathFactory) -> None:
    _, _, target = window.pair()
    ops.live_start()
    there = scenes.evaluated(target, BONES, [20])
    path = tmp_path / "live.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    bpy.ops.wm.open_mainfile(filepath=str(path))
    again = scenes.evaluated(bpy.data.objects["Sprout"], BONES, [20])
    assert np.abs(again - there).max() < 1e-5
    assert bpy.context.scene.morph_retarget.version == 1
