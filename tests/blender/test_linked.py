"""Characters of other files: library overrides as targets, linked armatures as sources."""

from pathlib import Path

import bpy
import numpy as np
import pytest

from morph_retarget.blender import actions
from morph_retarget.blender.controls.task import Onto
from morph_retarget.blender.laying import Lay
from morph_retarget.blender.retarget import Options, Source
from morph_retarget.core.errors import RigError
from tests.blender import scenes
from tests.blender.command import Command
from tests.blender.files import Files


@pytest.fixture
def library(tmp_path: Path) -> Path:
    scenes.empty()
    scenes.sprout()
    path = scenes.save(tmp_path / "library.blend")
    scenes.empty()
    return path


@pytest.mark.parametrize("lay", list(Lay))
def test_a_library_override_is_given_motion_that_is_saved_with_its_file(
    walk: Source, library: Path, tmp_path: Path, lay: Lay
) -> None:
    ob = scenes.link(library, "Sprout").override_create(remap_local_usages=True)
    ob.override_library.is_system_override = False
    scenes.give(walk, ob, Options(lay=lay))
    if lay is Lay.STASH:
        ob.animation_data.nla_tracks[-1].mute = False
    before = scenes.played(ob)
    bpy.ops.wm.open_mainfile(filepath=str(scenes.save(tmp_path / "shot.blend")))
    again = next(o for o in bpy.data.objects if o.type == "ARMATURE" and o.override_library)
    assert again.library is None
    assert scenes.apart(scenes.played(again), before) < 1e-5
    if lay is not Lay.ADD:
        assert scenes.apart(scenes.played(again), scenes.played_plainly(walk)) < 2e-4


def test_an_override_of_a_rig_with_controls_gets_them(walk: Source, rigify_file: Path) -> None:
    ob = scenes.link(rigify_file, "rig").override_create(remap_local_usages=True)
    ob.override_library.is_system_override = False
    outcome = scenes.give(walk, ob)
    assert outcome.report["controls"]["deform_error_deg"]["max"] < 0.01


@pytest.mark.parametrize("onto", [Onto.FK, Onto.IK])
def test_an_overridden_collection_with_a_rigify_rig_keeps_its_motion_and_switches_when_it_is_opened_again(
    walk: Source, rigify_file: Path, tmp_path: Path, onto: Onto
) -> None:
    bpy.ops.wm.open_mainfile(filepath=str(rigify_file))
    group = bpy.data.collections.new("Hero")
    bpy.context.scene.collection.children.link(group)
    group.objects.link(scenes.only_armature())
    path = scenes.save(tmp_path / "hero.blend")
    scenes.empty()
    with bpy.data.libraries.load(str(path), link=True) as (_, wanted):
        wanted.collections = ["Hero"]
    linked = wanted.collections[0]
    bpy.context.scene.collection.children.link(linked)
    linked.override_hierarchy_create(bpy.context.scene, bpy.context.view_layer)
    ob = next(o for o in bpy.data.objects if o.type == "ARMATURE" and o.override_library)
    if ob.override_library.is_system_override:
        with pytest.raises(RigError, match="library override that cannot be edited"):
            scenes.give(walk, ob)
        ob.override_library.is_system_override = False
    outcome = scenes.give(walk, ob, Options(onto=onto))
    assert outcome.report["controls"]["deform_error_deg"]["mean"] < 1.0
    deforms = [bone.name for bone in ob.data.bones if bone.use_deform]
    before = scenes.evaluated(ob, deforms, scenes.SHOWN)
    bpy.ops.wm.open_mainfile(filepath=str(scenes.save(tmp_path / "shot.blend")))
    again = next(o for o in bpy.data.objects if o.type == "ARMATURE" and o.override_library)
    assert np.abs(scenes.evaluated(again, deforms, scenes.SHOWN) - before).max() < 1e-5
    keyed = {path for path, _ in scenes.curves_of(again)}
    switches = ["IK_FK", *(["IK_parent", "pole_parent", "pole_vector"] if onto is Onto.IK else [])]
    for limb in ("thigh", "upper_arm"):
        assert {f'pose.bones["{limb}_parent.L"]["{prop}"]' for prop in switches} <= keyed
    seen = again.evaluated_get(bpy.context.evaluated_depsgraph_get())
    assert seen.pose.bones["thigh_parent.L"]["IK_FK"] == float(onto is Onto.FK)


def test_what_is_linked_or_an_override_of_blenders_own_is_no_target(walk: Source, library: Path) -> None:
    ob = scenes.link(library, "Sprout")
    with pytest.raises(RigError, match=r"linked from .*library\.blend"):
        scenes.give(walk, ob)
    own = ob.override_create(remap_local_usages=True)
    own.override_library.is_system_override = True
    with pytest.raises(RigError, match="'Sprout' is a library override that cannot be edited"):
        scenes.give(walk, own)


@pytest.mark.parametrize("stepped", [False, True], ids=["by its curves", "frame by frame"])
def test_a_linked_source_gives_its_motion(walk: Source, tmp_path: Path, stepped: bool) -> None:
    scenes.empty()
    walker = scenes.walker(seed=2)
    if stepped:
        walker.pose.bones["leftHand"].constraints.new("LIMIT_SCALE")
    path = scenes.save(tmp_path / "clip.blend")
    scenes.empty()
    source, target = scenes.link(path, "Walker"), scenes.sprout()
    clip = scenes.source_of(source)
    assert bool(clip.clip.stepped) == stepped
    scenes.give(clip, target)
    assert scenes.apart(scenes.played(target), scenes.played_plainly(walk)) < 2e-4


def test_of_several_armatures_in_a_file_each_is_given_its_own_motion(walk: Source) -> None:
    first, second, third = scenes.sprout("First"), scenes.sprout("Second"), scenes.sprout("Third")
    still = scenes.played(third)
    for ob in (first, second):
        scenes.give(walk, ob)
    assert actions.assigned(first)[0] != actions.assigned(second)[0]
    assert scenes.apart(scenes.played(first), scenes.played(second)) < 1e-6
    assert scenes.apart(scenes.played(third), still) < 1e-9


def test_the_command_line_writes_onto_controls_mirrors_and_stashes(
    cli: Command, files: Files, out: Path, rigify_file: Path
) -> None:
    clip = files.clip("blend")
    said = cli("retarget", clip, rigify_file, "-o", out / "o.blend", "--controls", "ik", "--mirror", "--lay", "stash")
    assert said.status == 0, said.errors
    bpy.ops.wm.open_mainfile(filepath=str(out / "o.blend"))
    ob = scenes.only_armature()
    assert actions.assigned(ob)[0] is None
    (track,) = ob.animation_data.nla_tracks
    assert track.mute
    keyed = {path for path, _ in actions.curves(track.strips[0].action, track.strips[0].action_slot)}
    assert 'pose.bones["foot_ik.L"].location' in keyed


def test_a_named_bone_that_is_not_there_is_refused(cli: Command, files: Files, out: Path) -> None:
    said = cli("retarget", files.clip("blend"), files.sprout, "-o", out / "o.blend", "--bones", "Head, Nobody")
    assert said.status == 2
    assert "no bone 'Nobody'" in said.errors[-1]
