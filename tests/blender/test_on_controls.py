"""Generalized actions on rigs with controls: deform bones do what they would do alone, live and baked."""

from pathlib import Path

import bpy
import numpy as np
import pytest

from morph_retarget.blender import actions, retarget
from morph_retarget.blender.controls import reading
from morph_retarget.blender.morph import bake, cast, jiggles, perform
from morph_retarget.blender.properties import of_rig, of_scene
from morph_retarget.blender.retarget import Source
from morph_retarget.core import keyed
from morph_retarget.core.arrays import Array
from morph_retarget.core.errors import MappingError
from tests.blender import acting, acts, control_rigs, scenes
from tools import acting as tools_acting
from tools import acts as samples
from tools.figure import blender

ops = bpy.ops.morph_retarget
HANDS = ("DEF-hand.L", "DEF-hand.R")
FRAMES = (1, 6, 11, 13.5, 16, 21)
SAME = 1e-4
"""Places that are no further apart are the same [m]."""

pytestmark = pytest.mark.usefixtures("registered")


@pytest.fixture
def human(rigify_file: Path) -> bpy.types.Object:
    """Return a person that Rigify has generated."""
    bpy.ops.wm.open_mainfile(filepath=str(rigify_file))
    bpy.context.scene.render.fps = scenes.FPS
    ob = scenes.only_armature()
    bpy.context.view_layer.objects.active = ob
    return ob


def _wanted(ob: bpy.types.Object) -> tuple[list[str], list[float], Array]:
    """Return the deform bones, the frames of an action, and where these are when the bones play it alone."""
    taken = retarget.run(bake.take(ob, bpy.context.scene, bake.Options()))
    skeleton = taken.member.character.skeleton
    return list(skeleton.names), taken.clip.frames.tolist(), keyed.played(skeleton, taken.played).positions


def _keyed_bones(ob: bpy.types.Object) -> set[str]:
    action, slot = actions.assigned(ob)
    paths = [path for path, _ in actions.curves(action, slot)]
    return {path.split('"')[1] for path in paths if path.startswith("pose.bones")}


@pytest.mark.parametrize("onto", ["auto", "ik"])
def test_hands_that_dip_are_where_they_are_without_controls(human: bpy.types.Object, onto: str) -> None:
    of_scene(bpy.context.scene).onto = onto
    acting.dip(human)
    names, frames, wanted = _wanted(human)
    assert np.ptp(wanted[:, names.index("DEF-hand.L")], axis=0).max() > 0.1, "they dip"
    assert acting.apart(scenes.heads(human, names, frames), wanted) < SAME
    assert human.name not in cast.problems
    acting.baked(human)
    ends = [names.index(f"DEF-{part}.{side}") for part in ("hand", "foot") for side in "LR"]
    compared = ends if onto == "ik" else list(range(len(names)))
    own = scenes.heads(human, [names[i] for i in compared], frames)
    assert acting.apart(own, wanted[:, compared]) < (2e-3 if onto == "ik" else SAME)


def test_only_controls_are_keyed_and_what_was_there_besides_is_kept(human: bpy.types.Object) -> None:
    acting.dip(human)
    [outcome] = acting.baked(human)
    assert not {name for name in _keyed_bones(human) if name.startswith(("DEF-", "ORG-"))}
    assert {"hand_fk.L", "torso"} <= _keyed_bones(human)
    assert outcome.action != bpy.data.actions["Dip"]
    assert not [w for w in outcome.take.warnings if "no control" in w]


def test_a_person_walks_on_its_controls(human: bpy.types.Object) -> None:
    bpy.context.scene.frame_end = 30
    ops.add_locomotion()
    names, frames, wanted = _wanted(human)
    assert acting.apart(scenes.heads(human, names, frames), wanted) < SAME
    ops.bake_action()
    assert cast.action_of(human) is None
    assert acting.apart(scenes.heads(human, names, frames), wanted) < SAME


def test_a_control_that_is_turned_by_hand_moves_the_hands_of_all_characters(human: bpy.types.Object) -> None:
    other = scenes.figure("Ann")
    acting.dip(human, other)
    bpy.context.scene.frame_set(1)
    before, others = acts.heads(human, HANDS), acts.heads(other, ["leftHand"])
    bpy.context.view_layer.objects.active = human
    human.select_set(True)
    bpy.ops.object.mode_set(mode="POSE")
    control = human.pose.bones["upper_arm_fk.L"]
    human.data.bones.active = control.bone
    control.rotation_mode = "QUATERNION"
    control.rotation_quaternion = (0.9, 0.3, 0.2, 0.1)
    pulled = np.array(control.rotation_quaternion)
    bpy.context.view_layer.update()
    bpy.context.view_layer.update()
    assert np.abs(np.array(control.rotation_quaternion) - pulled).max() < 1e-6, "what is held stays in the hand"
    moved = np.linalg.norm(acts.heads(human, HANDS) - before, axis=-1)
    assert moved.min() > 0.05, "both hands have moved"
    assert acting.apart(acts.heads(other, ["leftHand"]), others) > 0.05, "and those of others"
    now = acts.heads(human, HANDS)
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.context.view_layer.update()
    perform.show_frame(bpy.context.scene)
    bpy.context.view_layer.update()
    assert acting.apart(acts.heads(human, HANDS), now) < 1e-3, "it is played as it was pulled"


def test_a_file_that_is_opened_plays_on_controls(human: bpy.types.Object, tmp_path: Path) -> None:
    acting.dip(human)
    before = scenes.heads(human, ["DEF-hand.L", "DEF-foot.L"], FRAMES)
    bpy.ops.wm.open_mainfile(filepath=str(scenes.save(tmp_path / "dip.blend")))
    assert acting.apart(scenes.heads(scenes.only_armature(), ["DEF-hand.L", "DEF-foot.L"], FRAMES), before) < 1e-5


def test_controls_that_constraints_tell_of_are_found(tmp_path: Path) -> None:  # noqa: ARG001
    scenes.empty()
    ob = control_rigs.controlled(blender, lambda joint: f"Anim {blender(joint)}")
    acting.dip(ob)
    names, frames, wanted = _wanted(ob)
    assert not {name for name in names if name.startswith("Anim")}
    assert acting.apart(scenes.heads(ob, names, frames), wanted) < SAME


def test_a_control_that_is_gone_is_told_by_name_and_nothing_is_lost() -> None:
    scenes.empty()
    ob = control_rigs.controlled(blender, lambda joint: f"Anim {blender(joint)}")
    bpy.context.view_layer.objects.active = ob
    ops.analyze(rig=ob.name)
    of_rig(ob).joints["hips"].control = "Nobody"
    acting.dip(ob)
    scenes.heads(ob, ["Hips"], (1, 11))
    assert "'Nobody'" in cast.problems[ob.session_uid]
    with pytest.raises(MappingError, match="'Nobody'"):
        acting.baked(ob)
    assert cast.action_of(ob).name == "Dip"
    of_rig(ob).joints["hips"].control = ""
    names, frames, wanted = _wanted(ob)
    assert acting.apart(scenes.heads(ob, names, frames), wanted) < SAME
    assert ob.session_uid not in cast.problems


def test_the_legs_of_a_horse_are_baked_where_they_are_without_controls(horse_file: Path) -> None:
    bpy.ops.wm.open_mainfile(filepath=str(horse_file))
    ob = scenes.only_armature()
    dance = samples.named("Dance")
    tools_acting.play(ob, tools_acting.write(dance), dance)
    names, frames, wanted = _wanted(ob)
    legs = [i for i, name in enumerate(names) if any(part in name for part in ("hoof", "toe", "leg", "thigh", "arm"))]
    assert np.ptp(wanted[:, legs], axis=0).max() > 0.05, "they move"
    acting.baked(ob)
    own = scenes.heads(ob, [names[i] for i in legs], frames)
    assert acting.apart(own, wanted[:, legs]) < 2e-3


@pytest.mark.parametrize("name", ["Pick Up by Mouth", "Bow on All Fours"])
def test_a_horse_is_live_where_it_is_without_controls(horse_file: Path, name: str) -> None:
    """Its tail as well, each bone of which copies the turn of the one before, and which does not turn with the hips."""
    bpy.ops.wm.open_mainfile(filepath=str(horse_file))
    ob, act = scenes.only_armature(), samples.named(name)
    of_rig(ob).jiggles.enabled = False
    tools_acting.play(ob, tools_acting.write(act), act)
    names, frames, wanted = _wanted(ob)
    ours = [i for i, own in enumerate(names) if "ear" not in own]
    tail = [names.index(f"DEF-tail.{i:03}") for i in range(1, 6)]
    assert np.ptp(wanted[:, tail], axis=0).max() > 0.05, "it moves"
    assert acting.apart(scenes.heads(ob, [names[i] for i in ours], frames), wanted[:, ours]) < 2e-3


def test_bones_of_other_armatures_are_not_what_controls_copy(horse_file: Path) -> None:
    """They may have the same names."""
    bpy.ops.wm.open_mainfile(filepath=str(horse_file))
    ob = scenes.only_armature()
    graph, names = bpy.context.evaluated_depsgraph_get(), ["tail.001", "tail.002", "tail.003"]
    found = reading.copies(ob.evaluated_get(graph), names)
    assert {i: copy.source for i, copy in found.items()} == {1: 0, 2: 1}
    other = bpy.data.objects.new("Other", ob.data.copy())
    bpy.context.scene.collection.objects.link(other)
    for constraint in ob.pose.bones["tail.003"].constraints:
        constraint.target = other
    graph.update()
    assert set(reading.copies(ob.evaluated_get(graph), names)) == {1}


def test_a_rig_of_which_only_the_skirt_copies_others_is_posed_by_its_bones(walk: Source) -> None:
    scenes.empty()
    ob = scenes.figure("Ann")
    bpy.context.view_layer.objects.active = ob
    bpy.ops.object.mode_set(mode="EDIT")
    for i in range(12):
        hem = ob.data.edit_bones.new(f"Skirt{i}")
        hem.head, hem.tail, hem.parent = (0.02 * i, 0.1, 0.9), (0.02 * i, 0.1, 0.6), ob.data.edit_bones["hips"]
    handle = ob.data.edit_bones.new("Handle")
    handle.tail, handle.use_deform = (0.0, 0.0, 0.1), False
    bpy.ops.object.mode_set(mode="OBJECT")
    for i in range(12):
        copying = ob.pose.bones[f"Skirt{i}"].constraints.new("COPY_ROTATION")
        copying.target, copying.subtarget = ob, ("leftUpperLeg", "rightUpperLeg")[i % 2]
    assert "controls" not in scenes.give(walk, ob).report
    acting.dip(ob)
    assert np.ptp(scenes.heads(ob, ["leftHand"], FRAMES), axis=0).max() > 0.1
    assert ob.session_uid not in cast.problems


def test_what_follows_controls_does_not_jiggle(horse_file: Path) -> None:
    bpy.ops.wm.open_mainfile(filepath=str(horse_file))
    ob = scenes.only_armature()
    acting.play(acting.action("Feet", [acting.FEET]), ob, keyed={"Feet": {1: (0, 0, 0), 11: (0, 0, 0.1)}})
    of_rig(ob).jiggles.enabled = True
    scenes.heads(ob, [ob.data.bones[0].name], (1, 11))
    assert jiggles.is_still(cast.member(ob))
