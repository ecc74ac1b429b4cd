"""Where results go: in place of a target's own animation, beside it or over it, for all bones or some."""

from pathlib import Path

import bpy
import numpy as np
import pytest

from morph_retarget.blender import actions
from morph_retarget.blender.laying import Lay
from morph_retarget.blender.properties import of_scene
from morph_retarget.blender.retarget import Options, Source
from morph_retarget.core import quat
from morph_retarget.core.errors import RigError
from tests.blender import scenes, window

ARM = ("UpperArm.L", "LowerArm.L", "Hand.L")


def nod(ob: bpy.types.Object, bones: tuple[str, ...] = ("Head", "UpperLeg.L")) -> bpy.types.Action:
    """Let an armature turn some bones, and return the action that it plays then."""
    turns = quat.from_rotation_vector(np.linspace([0.0, 0.0, 0.0], [0.5, 0.2, 0.1], scenes.COUNT))
    return scenes.key(ob, "Nod", {ob.pose.bones[name].path_from_id("rotation_quaternion"): turns for name in bones})


def turns(ob: bpy.types.Object, bone: str) -> np.ndarray:
    """Return how a bone is turned by itself, over the usual clip, shape (frame, 4)."""
    out = []
    for frame in scenes.SHOWN:
        bpy.context.scene.frame_set(frame)
        seen = ob.evaluated_get(bpy.context.evaluated_depsgraph_get())
        out.append(np.array(seen.pose.bones[bone].rotation_quaternion))
    return np.array(out)


def test_a_stashed_result_waits_while_the_target_plays_on(walk: Source) -> None:
    ob = scenes.sprout()
    own = nod(ob)
    before = scenes.played(ob)
    outcome = scenes.give(walk, ob, Options(lay=Lay.STASH))
    assert actions.assigned(ob) == (own, own.slots[0])
    assert scenes.apart(scenes.played(ob), before) < 1e-6
    (track,) = ob.animation_data.nla_tracks
    assert track.mute
    assert track.strips[0].action == outcome.action
    actions.assign(ob, None, None)
    track.mute = False
    assert scenes.apart(scenes.played(ob), scenes.played_plainly(walk)) < 2e-4


def test_an_added_result_changes_what_the_target_plays_by_what_it_does_from_its_first_frame_on(walk: Source) -> None:
    alone, plain, ob = scenes.sprout("Alone"), scenes.sprout("Plain"), scenes.sprout()
    scenes.give(walk, plain)
    for each in (alone, ob):
        nod(each)
    scenes.give(walk, ob, Options(lay=Lay.ADD))
    for bone in ("Head", "UpperLeg.L", "UpperArm.R"):
        walked = turns(plain, bone)
        expected = quat.multiply(turns(alone, bone), quat.multiply(quat.conjugate(walked[:1]), walked))
        assert quat.angle_between(turns(ob, bone), expected).max() < 1e-3, bone


def test_added_results_turn_bones_of_every_rotation_mode(walk: Source) -> None:
    for mode in ("XYZ", "AXIS_ANGLE"):
        ob = scenes.sprout(mode)
        for bone in ob.pose.bones:
            bone.rotation_mode = mode
        plain = scenes.played(ob)[:1]
        scenes.give(walk, ob, Options(lay=Lay.ADD))
        assert scenes.apart(scenes.played(ob)[:1], plain) < 1e-5
        assert scenes.apart(scenes.played(ob)[5:6], plain) > 0.02


def test_chosen_bones_move_and_all_others_keep_their_animation(walk: Source) -> None:
    ob, plain, alone = scenes.sprout(), scenes.sprout("Plain"), scenes.sprout("Alone")
    scenes.give(walk, plain)
    nod(ob)
    nod(alone)
    scenes.give(walk, ob, Options(only=frozenset(ARM)))
    for bone in ARM:
        assert quat.angle_between(turns(ob, bone), turns(plain, bone)).max() < 1e-4
    for bone in ("Head", "UpperLeg.L", "UpperArm.R", "Spine"):
        assert quat.angle_between(turns(ob, bone), turns(alone, bone)).max() < 1e-4
    with pytest.raises(RigError, match="no bone 'Nobody'"):
        scenes.give(walk, ob, Options(only=frozenset({"Nobody"})))
    with pytest.raises(RigError, match="none of the bones of 'Sprout' that were chosen"):
        scenes.give(walk, ob, Options(only=frozenset(b.name for b in ob.pose.bones if "Thumb" in b.name)))


def test_of_a_rig_with_controls_a_chosen_arm_moves_alone(walk: Source, rigify_file: Path) -> None:
    bpy.ops.wm.open_mainfile(filepath=str(rigify_file))
    ob = scenes.only_armature()
    arm = {"upper_arm_fk.L", "forearm_fk.L", "hand_fk.L"}
    scenes.give(walk, ob, Options(only=frozenset({"DEF-upper_arm.L", "forearm_fk.L", "DEF-hand.L"})))
    keyed = {path.split('"')[1] for path, _ in scenes.curves_of(ob)}
    assert keyed == {*arm, "upper_arm_parent.L"}


def test_a_target_whose_strip_is_tweaked_is_refused(walk: Source) -> None:
    ob = scenes.sprout()
    scenes.give(walk, ob, Options(lay=Lay.STASH))
    data = ob.animation_data
    data.nla_tracks[0].mute = False
    data.nla_tracks[0].strips[0].select = True
    data.nla_tracks.active = data.nla_tracks[0]
    data.use_tweak_mode = True
    assert data.use_tweak_mode
    with pytest.raises(RigError, match="a strip of armature 'Sprout' is being tweaked"):
        scenes.give(walk, ob)


# --- through the operator ---


def test_the_window_moves_selected_bones_only() -> None:
    with window.registered():
        _, _, target = window.pair()
        settings = of_scene(bpy.context.scene)
        settings.selected_only = True
        for bone in target.pose.bones:
            holder = bone if hasattr(bone, "select") else bone.bone
            holder.select = bone.name in ARM
        bpy.ops.morph_retarget.retarget()
        assert {path.split('"')[1] for path, _ in scenes.curves_of(target)} == set(ARM)
        for bone in target.pose.bones:
            (bone if hasattr(bone, "select") else bone.bone).select = False
        with pytest.raises(RuntimeError, match="no bone of 'Sprout' is selected"):
            bpy.ops.morph_retarget.retarget()


@pytest.mark.parametrize("lay", ["stash", "add"])
def test_work_that_fails_leaves_tracks_and_actions_as_they_were(lay: str) -> None:
    with window.registered():
        settings, source, target = window.pair()
        own = nod(target)
        settings.lay, settings.all_actions = lay, True
        walked = source.animation_data.action
        broken = bpy.data.actions.new("Broken")
        curve = broken.layers.new("Layer").strips.new(type="KEYFRAME")
        bag = curve.channelbag(broken.slots.new("OBJECT", source.name), ensure=True)
        bag.fcurves.new('pose.bones["hips"].location', index=0).keyframe_points.insert(1.0, float("nan"))
        known = set(bpy.data.actions)
        with pytest.raises(RuntimeError, match="no numbers"):
            bpy.ops.morph_retarget.retarget()
        assert source.animation_data.action == walked
        assert set(bpy.data.actions) == known
        assert actions.assigned(target)[0] == own
        assert len(target.animation_data.nla_tracks) == 0
        assert target.animation_data.action_blend_type == "REPLACE"
