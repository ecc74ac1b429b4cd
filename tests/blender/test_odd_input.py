"""Odd inputs that must work: strange names, linked rigs and overrides, armatures in strange places."""

import json
from pathlib import Path

import bpy
import numpy as np
import pytest

from morph_retarget.blender.io import load
from morph_retarget.blender.io.load import Request
from tests.blender import scenes
from tests.blender.command import Command, Refused
from tests.blender.files import Files

# --- names ---


def _nasty(joint: str) -> str:
    return f"{joint} {scenes.NASTY}"


@pytest.mark.parametrize("kind", ["blend", "glb", "fbx", "bvh"])
def test_names_may_hold_quotes_brackets_emoji_and_backslashes(
    cli: Command, out: Path, tmp_path: Path, kind: str
) -> None:
    scenes.figure(scenes.NASTY, seed=3, names=_nasty)
    rig = scenes.save(tmp_path / "rig [1] 'x' 😀.blend")
    scenes.empty()
    scenes.walker(scenes.NASTY, names=_nasty, action=scenes.NASTY)
    clip = scenes.save(tmp_path / 'clip\'s [2] "y" 😀.blend')

    said = cli("map", rig, "--json")
    assert said.status == 0
    assert said.errors == []
    found = json.loads(said.out)
    assert found["rig"] == scenes.NASTY
    assert found["joints"]["leftFoot"]["bone"] == _nasty("leftFoot")

    template = out / f"{{source}} on {{target}}.{kind}"
    report = out / "report.json"
    said = cli("retarget", f"{clip}#{scenes.NASTY}", rig, "-o", template, "--report", report)
    assert said.status == 0
    assert said.errors == []
    assert json.loads(report.read_text(encoding="utf-8"))[0]["target"] == str(rig)
    (result,) = [path for path in out.iterdir() if path != report]
    (ob,) = load.load(Request(result))
    if kind == "blend":
        assert ob.name == scenes.NASTY
        assert ob.animation_data.action.name == f"{scenes.NASTY} on {scenes.NASTY}"[:63]
    if kind != "bvh":
        assert _nasty("leftFoot") in ob.pose.bones
    hips = next(bone.name for bone in ob.pose.bones if bone.name.startswith("hips"))
    way = np.ptp(scenes.heads(ob, [hips], scenes.over_action(ob, 5))[:, 0], axis=0)
    assert way[1] == pytest.approx(1.0, abs=0.1)


def test_a_map_of_nasty_names_is_a_map(cli: Command, files: Files, out: Path, tmp_path: Path) -> None:
    scenes.figure("Rig", seed=3, names=_nasty)
    rig = scenes.save(tmp_path / "rig.blend")
    table = tmp_path / "map.json"
    table.write_text(cli("map", rig, "--json").out, encoding="utf-8")
    assert cli("retarget", files.clip("blend"), rig, "-o", out / "o.blend", "--map", table).status == 0


def test_bones_of_the_longest_names_are_keyed(cli: Command, files: Files, out: Path, tmp_path: Path) -> None:
    def long(joint: str) -> str:
        return f"{joint} {'x' * 63}"[:63]

    scenes.figure("x" * 63, names=long)
    rig = scenes.save(tmp_path / "rig.blend")
    assert cli("retarget", files.clip("blend"), rig, "-o", out / "o.blend").status == 0
    load.load(Request(out / "o.blend"))
    ob = scenes.only_armature()
    assert ob.pose.bones[long("hips")].path_from_id("location") in {path for path, _ in scenes.curves_of(ob)}


# --- linked rigs ---


@pytest.fixture(params=["a still library", "a library with an action"])
def library(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """Return a .blend with the armature "Sprout", which other files link."""
    ob = scenes.sprout()
    if request.param == "a library with an action":
        scenes.key(ob, "Idle", {ob.pose.bones["Head"].path_from_id("location"): [[0, 0, 0], [0, 0, 1]]})
    path = scenes.save(tmp_path / "library.blend")
    scenes.empty()
    return path


def test_a_linked_armature_needs_an_override_and_the_message_says_how(
    refused: Refused, files: Files, out: Path, tmp_path: Path, library: Path
) -> None:
    scenes.link(library, "Sprout")
    shot = scenes.save(tmp_path / "shot.blend")
    message = refused("retarget", files.clip("blend"), shot, "-o", out / "o.blend", names=shot)
    assert "Sprout" in message
    assert "Library Override" in message


def test_a_linked_armature_can_be_a_source(cli: Command, files: Files, out: Path, tmp_path: Path) -> None:
    scenes.link(files.clip("blend"), "Walker")
    shot = scenes.save(tmp_path / "shot.blend")
    said = cli("retarget", shot, files.tall, "-o", out / "o.blend")
    assert said.status == 0
    load.load(Request(out / "o.blend"))
    ob = scenes.only_armature()
    assert np.ptp(scenes.heads(ob, ["hips"], scenes.over_action(ob, 5))[..., 1]) > 0.5


@pytest.mark.parametrize("alone", [True, False], ids=["override alone", "beside the linked one"])
def test_a_library_override_is_given_the_motion(
    cli: Command, files: Files, out: Path, tmp_path: Path, library: Path, alone: bool
) -> None:
    linked = scenes.link(library, "Sprout")
    own = linked.override_create(remap_local_usages=alone)
    if not alone:
        bpy.context.scene.collection.objects.link(own)
    own.override_library.is_system_override = False
    shot = scenes.save(tmp_path / "shot.blend")
    before = library.read_bytes()
    said = cli("retarget", files.clip("blend"), shot, "-o", out / "o.blend")
    assert said.status == 0
    assert said.errors == []
    assert library.read_bytes() == before
    load.load(Request(out / "o.blend"))
    own = next(ob for ob in bpy.data.objects if ob.override_library is not None)
    assert own.animation_data.action.library is None
    assert own.animation_data.action_slot is not None
    assert np.ptp(scenes.heads(own, ["Hips"], scenes.over_action(own, 5))[..., 1]) > 0.3


def test_linked_bones_on_an_own_object_are_given_the_motion(
    cli: Command, files: Files, out: Path, tmp_path: Path, library: Path
) -> None:
    with bpy.data.libraries.load(str(library), link=True) as (_, ours):
        ours.armatures = ["Sprout"]
    ob = bpy.data.objects.new("Mine", ours.armatures[0])
    bpy.context.scene.collection.objects.link(ob)
    shot = scenes.save(tmp_path / "shot.blend")
    assert cli("retarget", files.clip("blend"), shot, "-o", out / "o.blend").status == 0
    load.load(Request(out / "o.blend"))
    own = scenes.only_armature()
    assert own.name == "Mine"
    assert np.ptp(scenes.heads(own, ["Hips"], scenes.over_action(own, 5))[..., 1]) > 0.3


# --- odd bodies ---


def test_two_targets_of_one_name_share_a_file(cli: Command, files: Files, out: Path, tmp_path: Path) -> None:
    scenes.sprout(height=2.0)
    twin = scenes.save(tmp_path / "twin.blend")
    assert cli("retarget", files.clip("blend"), files.sprout, twin, "-o", out / "both.blend").status == 0
    found = load.load(Request(out / "both.blend"))
    assert len(found) == 2
    ways = [np.ptp(scenes.heads(ob, ["Hips"], scenes.over_action(ob, 5))[..., 1]) for ob in found]
    assert max(ways) == pytest.approx(2.0 / 1.1 * min(ways), rel=0.02)


def test_an_armature_in_no_collection_of_the_scene_is_refused_or_written(
    cli: Command, files: Files, out: Path, tmp_path: Path
) -> None:
    """A result without the rig would be worse than none."""
    ob = scenes.sprout()
    aside = bpy.data.collections.new("Aside")
    bpy.context.scene.collection.children.link(aside)
    aside.objects.link(ob)
    bpy.context.scene.collection.objects.unlink(ob)
    bpy.context.view_layer.layer_collection.children["Aside"].exclude = True
    rig = scenes.save(tmp_path / "aside.blend")
    for kind in ("glb", "fbx", "bvh"):
        path = out / f"o.{kind}"
        said = cli("retarget", files.clip("blend"), rig, "-o", path)
        if said.status == 0:
            (found,) = load.load(Request(path))
            assert np.ptp(scenes.heads(found, ["Hips"], scenes.over_action(found, 5))[..., 1]) > 0.3
        else:
            assert len(said.errors) == 1
            assert "Sprout" in said.errors[0]
            assert not path.exists()
