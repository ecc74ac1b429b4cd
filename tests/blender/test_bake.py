"""Baking: the ordinary action shows what the generalized one showed live, and nothing else has changed."""

import bpy
import numpy as np
import pytest

from morph_retarget.blender import actions, retarget
from morph_retarget.blender.morph import bake, cast, clip, keys
from morph_retarget.blender.morph.bake import Options
from morph_retarget.blender.properties import of_rig
from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.errors import MotionError
from morph_retarget.core.morph.branch import Answer
from morph_retarget.core.morph.channels import Channel
from morph_retarget.core.morph.context import Context
from tests.blender import acting, scenes
from tests.blender.acting import FEET, HANDS, REACH

ops = bpy.ops.morph_retarget
FRAMES = range(1, 22, 2)

pytestmark = pytest.mark.usefixtures("registered")


@pytest.mark.parametrize("mode", ["QUATERNION", "XYZ", "AXIS_ANGLE"])
def test_it_shows_what_was_shown_live(mode: str) -> None:
    ann, asura, hound = scenes.sprout("Ann"), acting.creature("asura"), acting.creature("hound")
    asura.location, asura.rotation_euler = (3.0, 1.0, 0.5), (0.0, 0.0, 2.0)
    for ob in (ann, asura, hound):
        for bone in ob.pose.bones:
            bone.rotation_mode = mode
    acting.dip(ann, asura, hound)
    live = [acting.shown(ob, FRAMES) for ob in (ann, asura, hound)]
    outcomes = acting.baked(ann, asura, hound)
    for ob, before, outcome in zip((ann, asura, hound), live, outcomes, strict=True):
        assert acting.apart(acting.shown(ob, FRAMES), before) < 1e-4
        assert ob.animation_data.action == outcome.action
        assert outcome.action.name == f"Dip on {ob.name}"
        assert list(outcome.action.frame_range) == [1.0, 21.0]
    assert acting.apart(live[0][0], live[0][5]) > 0.1, "the hands move"


def test_the_generalized_action_and_everything_else_stay() -> None:
    ann = scenes.figure("Ann")
    made = acting.dip(ann)
    made.use_fake_user = False
    other = bpy.data.actions.new("Other")
    before = scenes.keys_of(made)
    acting.baked(ann)
    assert made.use_fake_user
    assert scenes.keys_of(made) == before
    assert {action.name for action in bpy.data.actions} == {"Dip", "Other", "Dip on Ann"}
    assert scenes.keys_of(other) == {}
    assert [c.name for c in of_rig(ann).channels] == ["Hands"]


def test_plain_curves_of_the_generalized_action_are_taken_over_and_its_own_are_not() -> None:
    ann = scenes.figure("Ann")
    made = acting.dip(ann)
    ann["glow"] = 0.0
    bag = keys.bag_of(made)
    for path in ('["glow"]', "location"):
        bag.fcurves.new(path, index=0).keyframe_points.insert(5, 2.0)
    (outcome,) = acting.baked(ann)
    paths = {path for path, _ in actions.curves(outcome.action, outcome.slot)}
    assert '["glow"]' in paths
    assert not any("morph_retarget" in path for path in paths)


def test_deforms_become_curves_of_shape_keys_and_custom_properties() -> None:
    ann = scenes.figure("Ann")
    mesh = bpy.data.meshes.new("Skin")
    mesh.from_pydata([(0, 0, 0)], [], [])
    skin = bpy.data.objects.new("Skin", mesh)
    bpy.context.scene.collection.objects.link(skin)
    skin.parent = ann
    for name in ("Basis", "open", "other"):
        skin.shape_key_add(name=name)
    mesh.shape_keys.key_blocks["other"].keyframe_insert("value", frame=3)
    old = mesh.shape_keys.animation_data.action
    ann["open"], ann.pose.bones["leftHand"]["open"] = 0.0, 0.0
    acting.dip(ann)
    item = of_rig(ann).channels["Hands"]
    item.deforms.add().name = "open"
    for frame, value in ((1, 0.0), (11, 1.0)):
        item.deforms["open"].value = value
        item.deforms["open"].keyframe_insert("value", frame=frame)
    keys.by_name(ann.animation_data.action, ann)
    (outcome,) = acting.baked(ann)
    (more,) = outcome.more
    assert mesh.shape_keys.animation_data.action == more
    assert old.users > 0, "what the shape keys played before is kept"
    bpy.context.scene.frame_set(11)
    graph = bpy.context.evaluated_depsgraph_get()
    seen = ann.evaluated_get(graph)
    assert seen["open"] == pytest.approx(1.0)
    assert seen.pose.bones["leftHand"]["open"] == pytest.approx(1.0)
    assert skin.evaluated_get(graph).data.shape_keys.key_blocks["open"].value == pytest.approx(1.0)
    paths = {path for path, _ in actions.curves(more, mesh.shape_keys.animation_data.action_slot)}
    assert paths == {'key_blocks["open"].value', 'key_blocks["other"].value'}


def _reaching(moving: bool) -> tuple[bpy.types.Object, bpy.types.Object]:
    """Return a character that reaches for an object, with the hand on it at frame 11, and the object."""
    ann, apple = scenes.figure("Ann"), scenes.empty_object("Apple")
    apple.location = (0.4, -0.35, 1.3)
    if moving:
        for frame, x in ((1, 0.2), (21, 0.5)):
            apple.location.x = x
            apple.keyframe_insert("location", frame=frame)
    made = acting.action("Pick", [REACH])
    acting.play(made, ann, keyed={"Reach": {1: (0, 0, 0), 11: (1, 0, 0), 21: (0, 0, 0)}})
    of_rig(ann).channels["Reach"].target = apple
    return ann, apple


@pytest.mark.parametrize("moving", [False, True], ids=["a still target", "a moving target"])
def test_external_targets_are_met(moving: bool) -> None:
    ann, apple = _reaching(moving)
    scene = bpy.context.scene
    scene.frame_set(7)
    live = acting.shown(ann, FRAMES)
    scene.frame_set(7)
    steps = clip.clip_of(cast.member(ann), ann, scene, np.arange(1.0, 22.0))
    found = retarget.run(steps)
    assert found.stepped == (("target 'Apple'",) if moving else ())
    assert scene.frame_current == 7
    (outcome,) = acting.baked(ann)
    assert scene.frame_current == 7
    assert acting.apart(acting.shown(ann, FRAMES), live) < 1e-4
    scene.frame_set(11)
    hand = ann.matrix_world @ ann.pose.bones["leftHand"].head
    assert (hand - apple.matrix_world.translation).length < 0.01
    assert outcome.report["variants"] == 2


def test_two_who_reach_for_each_other_are_baked_as_they_are_live() -> None:
    ann, bob = scenes.figure("Ann"), scenes.figure("Bob")
    bob.location, bob.rotation_euler = (0.0, -0.9, 0.0), (0.0, 0.0, np.pi)
    made = acting.action("Shake", [REACH])
    acting.play(made, ann, bob, keyed={"Reach": {1: (0, 0, 0), 11: (0.5, 0, 0)}})
    for one, other in ((ann, bob), (bob, ann)):
        values = of_rig(one).channels["Reach"]
        values.target, values.target_bone = other, "rightHand"
    live = [acting.shown(ob, range(1, 12)) for ob in (ann, bob)]
    acting.baked(ann, bob)
    for ob, before in zip((ann, bob), live, strict=True):
        assert acting.apart(acting.shown(ob, range(1, 12)), before) < 1e-4


def test_strips_are_baked_where_they_lie() -> None:
    ann = scenes.figure("Ann")
    made = acting.dip(ann)
    slot = ann.animation_data.action_slot
    actions.assign(ann, None, None)
    strip = ann.animation_data.nla_tracks.new().strips.new("Dip", 31, made)
    strip.action_slot = slot
    live = acting.shown(ann, range(31, 52, 4))
    (outcome,) = acting.baked(ann)
    assert outcome.take.clip.stepped == ("NLA strips",)
    assert list(outcome.action.frame_range) == [31.0, 51.0]
    assert acting.apart(acting.shown(ann, range(31, 52, 4)), live) < 1e-4


def test_drivers_of_values_count() -> None:
    ann = scenes.figure("Ann")
    acting.dip(ann)
    ann["high"] = -0.4
    driver = ann.driver_add('morph_retarget.channels["Hands"].weight').driver
    driver.type = "SUM"
    variable = driver.variables.new()
    variable.targets[0].id, variable.targets[0].data_path = ann, '["half"]'
    ann["half"] = 0.5
    live = acting.shown(ann, FRAMES)
    (outcome,) = acting.baked(ann)
    assert outcome.take.clip.stepped == ("drivers",)
    assert acting.apart(acting.shown(ann, FRAMES), live) < 1e-4


def test_the_report_tells_what_was_played() -> None:
    ann = scenes.figure("Ann")
    made = acting.action("Dip", [HANDS, Channel("Sink", Context(Capability.ROOT))])
    acting.play(made, ann, keyed=acting.DIP | {"Sink": {1: (0.0, 0.0, 0.0), 11: (0.0, 0.0, -0.3)}})
    for name, frame in (("hit", 11), ("before", 0), ("last", 21), ("after", 22)):
        made.pose_markers.new(name).frame = frame
    (outcome,) = acting.baked(ann)
    report = outcome.report
    assert list(report) == [
        "source", "target", "frames", "seconds_per_stage", "channels", "variant", "variants", "ground_penetration_m",
        "events", "problems", "warnings",
    ]  # fmt: skip
    assert (report["source"], report["target"], report["frames"]) == ("Dip", "Ann", 21)
    assert set(report["seconds_per_stage"]) == {"bind", "sample", "evaluate", "write"}
    toes = ann.data.bones["leftToes"].head_local.z
    assert report["channels"]["Hands"]["bodies"] == ["leftHand", "rightHand"]
    missed = report["channels"]["Hands"]["goal_error_m"]
    assert 0.0 <= missed["mean"] <= missed["max"] < 0.3
    assert report["events"] == [{"name": "hit", "frame": 11.0}, {"name": "last", "frame": 21.0}]
    assert report["ground_penetration_m"]["max"] == pytest.approx(0.3 - toes, abs=1e-3)
    assert [marker.name for marker in outcome.action.pose_markers] == ["hit", "last"]


@pytest.mark.parametrize("rate", [2.0, 0.5])
def test_another_frame_rate_keeps_the_duration(rate: float) -> None:
    ann = scenes.figure("Ann")
    made = acting.dip(ann)
    made.pose_markers.new("hit").frame = 11
    low = acting.shown(ann, [11])
    (outcome,) = acting.baked(ann, options=Options(rate=rate))
    end = 1.0 + 20.0 / rate
    assert list(outcome.action.frame_range) == [1.0, end]
    assert outcome.report["events"] == [{"name": "hit", "frame": 1.0 + 10.0 / rate}]
    assert acting.apart(acting.shown(ann, [1.0 + 10.0 / rate]), low) < 1e-4


def test_frames_can_be_chosen_and_a_manual_range_counts() -> None:
    ann = scenes.figure("Ann")
    made = acting.dip(ann)
    (outcome,) = acting.baked(ann, options=Options(frames=(5, 9)))
    assert list(outcome.action.frame_range) == [5.0, 9.0]
    made.use_frame_range, made.frame_start, made.frame_end = True, 3, 30
    cast.add(ann, made)
    (outcome,) = acting.baked(ann)
    assert list(outcome.action.frame_range) == [3.0, 30.0]


def test_what_plays_nothing_or_has_no_keys_cannot_be_baked() -> None:
    ann = scenes.figure("Ann")
    with pytest.raises(MotionError, match="plays no generalized action"):
        acting.baked(ann)
    acting.play(acting.action("Empty", [HANDS]), ann)
    with pytest.raises(MotionError, match="'Empty' has no keys"):
        acting.baked(ann)


def test_it_is_all_or_nothing() -> None:
    ann, bob = scenes.figure("Ann"), scenes.figure("Bob")
    made = acting.dip(ann, bob)
    with pytest.raises(MotionError, match="no other braces"):
        acting.baked(ann, bob, options=Options(name="{clip}"))
    scene = bpy.context.scene
    picker, apple = _reaching(moving=True)
    work = bake.bake([picker], scene, Options())
    next(work)
    work.close()
    assert {action.name for action in bpy.data.actions} == {"Dip", "Pick", apple.animation_data.action.name}
    assert ann.animation_data.action == bob.animation_data.action == made


# --- the button ---


def test_one_or_all_characters_are_baked_by_the_button() -> None:
    ann, bob = scenes.figure("Ann"), scenes.figure("Bob")
    acting.dip(ann, bob)
    bpy.context.view_layer.objects.active = ann
    assert ops.bake_action() == {"FINISHED"}
    assert ann.animation_data.action.name == "Dip on Ann"
    assert bob.animation_data.action.name == "Dip"
    assert ops.bake_action(all_characters=True) == {"FINISHED"}
    assert bob.animation_data.action.name == "Dip on Bob"
    assert not ops.bake_action.poll(), "nobody plays a generalized action any more"


def test_the_button_says_why_it_cannot_and_leaves_out_who_does_not_fit() -> None:
    ann, rex = scenes.figure("Ann"), acting.creature("snake")
    made = acting.action("Kick", [FEET])
    made.morph_retarget.has_feet = Answer.TRUE
    acting.play(made, ann, rex, keyed={"Feet": {1: (0, 0, 0), 5: (0, -0.2, 0.2)}})
    with pytest.raises(RuntimeError, match=f"nothing of the action plays on '{rex.name}'.*lacks feet"):
        ops.bake_action(character=rex.name)
    assert ops.bake_action(all_characters=True) == {"FINISHED"}
    assert ann.animation_data.action.name == "Kick on Ann"
    assert rex.animation_data.action == made
