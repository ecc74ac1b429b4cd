"""The action that a retarget makes: its name, slot and times, and what becomes of the old one."""

import bpy
import numpy as np
import pytest

from morph_retarget.blender import actions
from morph_retarget.blender.retarget import Options, Source
from morph_retarget.core import quat
from morph_retarget.core.errors import MotionError
from tests.blender import scenes
from tools.figure import Bone


def _dressed() -> tuple[bpy.types.Object, bpy.types.Action]:
    """Return a small body with an antenna, and its old action, which moves both and a property."""
    antenna = Bone('Antenna "1"', "Head", (0.0, 0.1, 1.0), (0.0, 0.1, 1.2))
    ob = scenes.sprout(extra=[antenna])
    bone = ob.pose.bones[antenna.name]
    bone["glow"] = 0.0
    turns = quat.from_rotation_vector(np.linspace(0.0, 1.0, 10)[:, None] * np.array([0.5, 0.2, -0.3]))
    action = scenes.key(
        ob,
        "Old",
        {
            bone.path_from_id("rotation_quaternion"): turns,
            f'{bone.path_from_id()}["glow"]': np.linspace(0.0, 5.0, 10)[:, None],
            ob.pose.bones["Hips"].path_from_id("location"): np.ones((10, 3)),
            "location": np.ones((10, 3)),
        },
        first=5,
    )
    for curve in scenes.curves_of(ob).values():
        for i, key in enumerate(curve.keyframe_points):
            key.interpolation = ("BEZIER", "CONSTANT", "ELASTIC")[i % 3]
            key.handle_left_type = key.handle_right_type = "FREE"
            key.handle_right = key.co[0] + 0.4, key.co[1] + 0.1
        curve.update()
    other = action.slots.new(id_type="OBJECT", name="Somebody else")
    bag = action.layers[0].strips[0].channelbag(other, ensure=True)
    bag.fcurves.new("location", index=2).keyframe_points.insert(3.0, 7.0)
    return ob, action


def test_the_old_action_is_left_as_it_is_and_kept(walk: Source) -> None:
    ob, old = _dressed()
    before = scenes.keys_of(old)
    assert any("Somebody else" in slot for slot, _, _ in before)
    outcome = scenes.give(walk, ob)
    assert scenes.keys_of(old) == before
    assert old.name == "Old"
    assert old.use_fake_user
    assert outcome.action != old
    assert ob.animation_data.action == outcome.action
    assert ob.animation_data.action_slot == outcome.slot


def test_an_old_action_that_others_play_needs_no_fake_user(walk: Source) -> None:
    ob, old = _dressed()
    other = scenes.empty_object()
    actions.assign(other, old, old.slots[1])
    scenes.give(walk, ob)
    assert other.animation_data.action == old
    assert not old.use_fake_user


def test_what_the_clip_does_not_move_keeps_its_old_curves(walk: Source) -> None:
    ob, old = _dressed()
    before = {(path, index): keys for (slot, path, index), keys in scenes.keys_of(old).items() if "Sprout" in slot}
    outcome = scenes.give(walk, ob)
    after = {(path, index): keys for (_, path, index), keys in scenes.keys_of(outcome.action).items()}
    kept = {place for place in before if "Antenna" in place[0]}
    assert len(kept) == 5
    assert all(after[place] == before[place] for place in kept)
    # The object's own motion and the hips' are the body's: they would move it twice.
    assert ("location", 0) not in after
    hips = scenes.curves_of(ob)[ob.pose.bones["Hips"].path_from_id("location"), 0]
    assert len(hips.keyframe_points) == scenes.COUNT


def test_curves_that_are_kept_keep_their_modifiers_and_samples(walk: Source) -> None:
    ob, _ = _dressed()
    path = ob.pose.bones['Antenna "1"'].path_from_id("rotation_quaternion")
    noisy, baked = (scenes.curves_of(ob)[path, i] for i in (1, 2))
    noisy.modifiers.new("CYCLES")
    noise = noisy.modifiers.new("NOISE")
    noise.strength, noise.use_influence, noise.influence = 0.3, True, 0.5
    baked.convert_to_samples(5, 14)
    frames = np.linspace(0.0, 30.0, 50)
    before = [[curve.evaluate(frame) for frame in frames] for curve in (noisy, baked)]
    scenes.give(walk, ob)
    after = [[scenes.curves_of(ob)[path, i].evaluate(frame) for frame in frames] for i in (1, 2)]
    assert np.abs(np.array(after) - before).max() < 1e-5


def test_other_bones_can_be_left_out(walk: Source) -> None:
    ob, _ = _dressed()
    scenes.give(walk, ob, Options(keep_others=False))
    assert not any("Antenna" in path for path, _ in scenes.curves_of(ob))


def test_the_new_action_has_a_slot_of_its_own_and_the_name_that_was_asked_for(walk: Source) -> None:
    ob = scenes.sprout("Sprout")
    outcome = scenes.give(walk, ob)
    assert outcome.action.name == "Walk on Sprout"
    assert [(slot.target_id_type, slot.name_display) for slot in outcome.action.slots] == [("OBJECT", "Sprout")]
    named = scenes.give(walk, ob, Options(name="{source}/{target}/{action}"))
    assert named.action.name == "Walker/Sprout/Walk"
    again = scenes.give(walk, ob)
    assert again.action.name == "Walk on Sprout.001"
    assert {outcome.action, named.action} <= set(bpy.data.actions)


@pytest.mark.parametrize("template", ["{rig}", "{", "{0}", "{action.x}"])
def test_a_name_with_other_braces_is_refused(walk: Source, template: str) -> None:
    ob = scenes.sprout()
    with pytest.raises(MotionError, match=r"use \{action\}, \{source\} and \{target\}"):
        scenes.give(walk, ob, Options(name=template))
    assert not bpy.data.actions


def test_each_key_is_linear_and_each_bone_has_a_group(walk: Source) -> None:
    ob = scenes.sprout()
    scenes.give(walk, ob)
    found = scenes.curves_of(ob)
    assert {key.interpolation for curve in found.values() for key in curve.keyframe_points} == {"LINEAR"}
    assert {curve.group.name for curve in found.values()} <= set(ob.pose.bones.keys())


def test_nothing_of_the_rig_changes_but_its_action(walk: Source) -> None:
    ob = scenes.sprout(place=scenes.matrix(turn=(20, -50, 70), scale=0.3, place=(2, -1, 0)))
    rests = [np.array(bone.matrix_local) for bone in ob.data.bones]
    place = np.array(ob.matrix_world)
    scenes.give(walk, ob)
    bpy.context.scene.frame_set(20)
    assert np.array_equal(rests, [np.array(bone.matrix_local) for bone in ob.data.bones])
    assert np.array_equal(place, np.array(ob.matrix_world))


# --- times ---


@pytest.mark.parametrize("resample", [False, True], ids=["as they are", "resampled"])
@pytest.mark.parametrize("fps", [24, 30, 60, 120])
def test_keys_keep_the_clips_duration_at_every_frame_rate(walk: Source, fps: int, resample: bool) -> None:
    ob = scenes.sprout()
    bpy.context.scene.render.fps = fps
    outcome = scenes.give(walk, ob, Options(resample=resample))
    first, last = outcome.action.frame_range
    assert first == 1.0
    # Whole frames may end short of the clip by less than one.
    assert 0.0 <= scenes.STEP * fps - (last - first) < (1.0 if resample and fps == 24 else 1e-3)
    times = [key.co[0] for key in next(iter(scenes.curves_of(ob).values())).keyframe_points]
    if resample:
        assert times == list(range(1, int(last) + 1))
    else:
        assert len(times) == scenes.COUNT
    moments = [f for f in range(0, scenes.COUNT, 5) if not resample or (f * fps) % scenes.FPS == 0]
    found = scenes.heads(ob, ob.pose.bones.keys(), [1.0 + f * fps / scenes.FPS for f in moments])
    bpy.context.scene.render.fps = scenes.FPS
    plain = scenes.sprout("Plain")
    scenes.give(walk, plain)
    assert scenes.apart(found, scenes.heads(plain, plain.pose.bones.keys(), [1 + f for f in moments])) < 2e-4
