"""Jiggles on ordinary actions: keyed in a copy, where the action leaves something loose; all else stays as it was."""

from collections.abc import Sequence
from pathlib import Path

import bpy
import numpy as np
import pytest

from morph_retarget.blender import actions, jiggle_bake
from morph_retarget.blender.io import load
from morph_retarget.blender.properties import of_rig
from morph_retarget.blender.rig import scene_of
from morph_retarget.core.arrays import Array
from tests.blender import acting, acts, scenes
from tools import armatures
from tools.figure import Bone

ops = bpy.ops.morph_retarget
FRAMES = [1, 5, 9, 12, 15, 18, 24]
TAIL = [f"Tail.00{i}" for i in range(1, 6)]

pytestmark = pytest.mark.usefixtures("registered")


def _turning(kind: str = "hound", mode: str = "QUATERNION") -> bpy.types.Object:
    """Return a creature that runs on and turns from frame 1 to 24, its root moved by keys."""
    ob = acts.creature(kind)
    for bone in ob.pose.bones:
        bone.rotation_mode = mode
    root = ob.pose.bones[0]
    for frame, turn in ((1, 0.0), (6, 0.2), (14, 1.6), (24, 1.6)):
        root.rotation_mode = "XYZ"
        root.rotation_euler = (0.1 * turn, 0.2 * turn, turn)
        root.location = (0.2 * turn, 0.3 * turn, 0.1 * turn)
        for path in ("rotation_euler", "location"):
            root.keyframe_insert(path, frame=frame)
    ob.animation_data.action.name = "Turn"
    return ob


def _shown(ob: bpy.types.Object, frames: Sequence[float] = FRAMES) -> Array:
    return scenes.evaluated(ob, ob.pose.bones.keys(), frames)


def _moved(ob: bpy.types.Object, a: Array, b: Array) -> set[str]:
    return {n for i, n in enumerate(ob.pose.bones.keys()) if np.abs(a[:, i] - b[:, i]).max() > 1e-5}


@pytest.mark.parametrize("mode", ["QUATERNION", "YZX", "AXIS_ANGLE"])
def test_what_the_action_leaves_loose_follows_and_the_rest_is_untouched(mode: str) -> None:
    hound = _turning(mode=mode)
    before = _shown(hound)
    old = hound.animation_data.action
    kept = scenes.keys_of(old)
    assert ops.bake_jiggles(character="Hound") == {"FINISHED"}
    assert _moved(hound, before, _shown(hound)) == {*TAIL, "Ear.L", "Ear.R"}
    assert hound.animation_data.action.name == "Turn with Jiggles"
    assert scenes.keys_of(old) == kept
    assert old.use_fake_user
    assert list(hound.animation_data.action.frame_range) == [1.0, 24.0]


def test_a_held_pose_of_the_tail_stays_below_the_jiggles() -> None:
    hound = _turning()
    tail = hound.pose.bones["Tail.002"]
    tail.rotation_quaternion = (0.9, 0.3, 0.2, 0.1)
    for frame in (1, 12, 24):
        tail.keyframe_insert("rotation_quaternion", frame=frame)
    before = _shown(hound)
    ops.bake_jiggles(character="Hound")
    after = _shown(hound)
    assert "Tail.002" in _moved(hound, before, after)
    place = hound.pose.bones.keys().index("Tail.002")
    assert np.abs(before[0, place] - after[0, place]).max() < 0.02, "it begins where it was held"
    assert np.abs(before[:, place, :3, :3] - after[:, place, :3, :3]).max() < 0.9


def test_undo_takes_it_back_and_a_second_baking_finds_nothing_loose() -> None:
    _turning()
    bpy.ops.ed.undo_push(message="before")
    ops.bake_jiggles(character="Hound")
    bpy.ops.ed.undo_push(message="baked")
    with pytest.raises(RuntimeError, match="moves them already"):
        ops.bake_jiggles(character="Hound")
    bpy.ops.ed.undo()
    hound = bpy.data.objects["Hound"]
    assert hound.animation_data.action.name == "Turn"
    assert "Turn with Jiggles" not in bpy.data.actions


def test_a_baking_that_is_cancelled_leaves_everything_as_it_was() -> None:
    hound = _turning()
    hound.pose.bones["Chest"].constraints.new("LIMIT_ROTATION").owner_space = "LOCAL"  # so that frames are stepped
    bpy.context.scene.frame_set(7)
    action, slot = actions.assigned(hound)
    steps = jiggle_bake.bake(hound, action, slot, scene_of())
    next(steps)
    steps.close()
    assert [a.name for a in bpy.data.actions] == ["Turn"]
    assert bpy.context.scene.frame_current == 7
    assert actions.assigned(hound) == (action, slot)


def test_stepped_and_read_motions_jiggle_alike() -> None:
    hound = _turning()
    ops.bake_jiggles(character="Hound")
    read = _shown(hound)
    other = _turning()
    other.pose.bones["Chest"].constraints.new("LIMIT_ROTATION").owner_space = "LOCAL"
    ops.bake_jiggles(character=other.name)
    assert np.abs(_shown(other) - read).max() < 1e-4


def test_frame_rates_show_the_same_motion_in_time() -> None:
    tips = []
    for fps in (24, 48):
        scenes.empty(fps)
        hound = acts.creature("hound")
        for time, way in ((0.0, 0.0), (0.5, 0.0), (0.75, 0.6), (1.5, 0.6)):
            hound.location.x = way
            hound.keyframe_insert("location", frame=1.0 + time * fps)
        ops.bake_jiggles(character="Hound")
        there = [1.0 + time * fps for time in (0.5, 0.625, 0.75, 0.875, 1.0, 1.25)]
        tips.append(scenes.evaluated(hound, TAIL[-1:], there)[:, 0, :3, 3])
    assert np.abs(tips[0] - tips[1]).max() < 0.01
    assert np.ptp(tips[0][:, 0]) > 0.5


def test_an_object_that_jumps_takes_its_tail_along() -> None:
    hound = acts.creature("hound")
    for frame, way in ((1, 0.0), (10, 0.0), (11, 30.0), (24, 30.0)):
        hound.location.y = way
        hound.keyframe_insert("location", frame=frame)
    for curve in actions.curves(*actions.assigned(hound)).values():
        for key in curve.keyframe_points:
            key.interpolation = "LINEAR"
    before = _shown(hound, range(1, 25))
    ops.bake_jiggles(character="Hound")
    assert np.abs(_shown(hound, range(1, 25)) - before).max() < 1e-3


def test_a_scaled_and_mirrored_object_jiggles_as_its_image() -> None:
    found = []
    for scale in ((1.0, 1.0, 1.0), (100.0, 100.0, 100.0), (-1.0, 1.0, 1.0)):
        scenes.empty(24)
        hound = acts.creature("hound")
        hound.scale = scale
        bpy.context.view_layer.update()
        root = hound.pose.bones[0]
        for frame, turn in ((1, 0.0), (6, 0.2), (14, 1.6), (24, 1.6)):
            root.rotation_quaternion = (1.0, 0.3 * turn, 0.1 * turn, 0.2 * turn)
            root.keyframe_insert("rotation_quaternion", frame=frame)
        ops.bake_jiggles(character="Hound")
        inverse = np.linalg.inv(np.array(hound.matrix_world))
        found.append(inverse @ scenes.evaluated(hound, TAIL, FRAMES))
    assert np.abs(found[1] - found[0]).max() < 1e-3
    assert np.abs(found[2] - found[0]).max() < 1e-3


def test_markers_ranges_and_other_curves_come_along() -> None:
    hound = _turning()
    old = hound.animation_data.action
    old.pose_markers.new("Bark").frame = 9
    old.use_frame_range, old.frame_start, old.frame_end, old.use_cyclic = True, 2, 20, True
    hound["mood"] = 0.5
    hound.keyframe_insert('["mood"]', frame=3)
    ops.bake_jiggles(character="Hound")
    new = hound.animation_data.action
    assert [(m.name, m.frame) for m in new.pose_markers] == [("Bark", 9)]
    assert (new.use_frame_range, new.frame_start, new.frame_end, new.use_cyclic) == (True, 2, 20, True)
    assert ('["mood"]', 0) in actions.curves(*actions.assigned(hound))


def test_what_cannot_be_baked_is_said() -> None:
    hound = acts.creature("hound")
    with pytest.raises(RuntimeError, match="'Hound' plays no action"):
        ops.bake_jiggles(character="Hound")
    acting.dip(acts.creature("beetle"))
    with pytest.raises(RuntimeError, match="generalized action: switch its jiggles on"):
        ops.bake_jiggles(character="Beetle")
    with pytest.raises(RuntimeError, match="no armature 'Nobody'"):
        ops.bake_jiggles(character="Nobody")
    biped = acts.creature("biped")
    biped.pose.bones["Head"].keyframe_insert("location", frame=1)
    with pytest.raises(RuntimeError, match="nothing jiggles on 'Biped'"):
        ops.bake_jiggles(character="Biped")
    assert hound.animation_data is None or hound.animation_data.action is None


def _line(name: str, bones: Sequence[str]) -> bpy.types.Object:
    """Return an armature whose bones stand in one line, the first of which moves from frame 1 to 9."""
    places = [(0.0, 0.3 * i, 1.0) for i in range(len(bones) + 1)]
    made = [Bone(b, bones[i - 1] if i else None, places[i], places[i + 1]) for i, b in enumerate(bones)]
    ob = armatures.build(name, made)
    for frame, way in ((1, 0.0), (5, 0.3), (9, -0.2)):
        ob.pose.bones[0].location.x = way
        ob.pose.bones[0].keyframe_insert("location", frame=frame)
    return ob


def test_the_smallest_and_the_oddest_rigs_are_solved_or_refused() -> None:
    _line("One", ["Bone"])
    with pytest.raises(RuntimeError, match="one bone, 'Bone'"):
        ops.bake_jiggles(character="One")
    names = ["root", f"{scenes.NASTY} tail", f"{scenes.NASTY} tail 2"]
    odd = _line("Odd", names)
    before = _shown(odd, [1, 3, 5, 9])
    assert ops.bake_jiggles(character="Odd") == {"FINISHED"}
    assert _moved(odd, before, _shown(odd, [1, 3, 5, 9])) == set(odd.pose.bones.keys()[1:])


@pytest.mark.parametrize(
    ("file", "action", "words", "bones"),
    [
        ("khronos_fox.glb", "Walk", ("Tail",), 3),
        ("quaternius_wolf.glb", "Gallop", ("Tail", "Ear"), 16),
        ("m2m_kaiju_anim.glb", "Walk", ("Tail",), 5),
    ],
)
def test_real_rigs_get_a_tail_that_follows_their_own_walk(
    data: Path, file: str, action: str, words: tuple[str, ...], bones: int
) -> None:
    ob = load.add(load.Request(data / "rigs" / file))[0]
    own, slot = next(pair for pair in actions.of_armature(ob) if pair[0].name.endswith(action))
    for bag in own.layers[0].strips[0].channelbags:
        for curve in list(bag.fcurves):
            if any(word in curve.data_path for word in words):
                bag.fcurves.remove(curve)
    actions.assign(ob, own, slot)
    first, last = (int(f) for f in own.frame_range)
    frames = np.linspace(first, last, 9).round().tolist()
    before = _shown(ob, frames)
    (outcome,) = [_run(ob, own, slot)]
    after = _shown(ob, frames)
    assert len(outcome.bones) == bones
    assert all(any(word in bone for word in words) for bone in outcome.bones)
    moved = _moved(ob, before, after)
    ends = {child.name for name in moved for child in ob.pose.bones[name].children_recursive}
    assert moved <= {*outcome.bones, *ends}
    assert moved & set(outcome.bones)
    assert np.isfinite(after).all()
    loops = np.abs(before[0, :, :3, :3] - before[-1, :, :3, :3]).max() < 1e-3
    if loops:
        assert np.abs(after[0, :, :3, :3] - after[-1, :, :3, :3]).max() < 0.02 * np.abs(before[0]).max()


def _run(ob: bpy.types.Object, action: bpy.types.Action, slot: bpy.types.ActionSlot) -> jiggle_bake.Outcome:
    steps = jiggle_bake.bake(ob, action, slot, scene_of())
    while True:
        try:
            next(steps)
        except StopIteration as end:
            return end.value


def test_settings_of_the_armature_count(tmp_path: Path) -> None:
    hound = _turning()
    of_rig(hound).jiggles.amount = 0.0
    before = _shown(hound)
    ops.bake_jiggles(character="Hound")
    assert _moved(hound, before, _shown(hound)) == set()
    assert tmp_path.exists()
