"""The command line: the files that `retarget` writes, loaded again."""

import json
from pathlib import Path

import bpy
import numpy as np
import pytest

from morph_retarget.blender.io import load
from morph_retarget.blender.io.load import Request
from morph_retarget.core.arrays import Array
from tests.blender import results, scenes
from tests.blender.command import Command, contents
from tests.blender.files import KINDS, Files
from tools.figure import Bone, blender


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_of_clip_gives_the_same_motion(
    cli: Command, files: Files, out: Path, expected: Array, kind: str
) -> None:
    result = out / "walk.blend"
    assert cli("retarget", files.clip(kind), files.sprout, "-o", result).status == 0
    found = results.directions(result)
    assert scenes.angle(found[:, results.ARMS], expected[:, results.ARMS]) < 0.5
    # Times are rounded in files, which may move the edge of a step by a frame.
    assert scenes.angle(found, expected) < 1.5


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_of_result_holds_the_same_motion(
    cli: Command, files: Files, out: Path, expected: Array, kind: str
) -> None:
    result = out / f"walk.{kind}"
    said = cli("retarget", files.clip("blend"), files.sprout, "-o", result)
    assert said.status == 0
    assert said.out == ""
    assert said.errors == []
    assert list(contents(out)) == [f"walk.{kind}"]
    ob = results.reload(result)
    frames = scenes.over_action(ob, scenes.COUNT)
    assert scenes.angle(scenes.directions(ob, frames, blender), expected) < 0.5
    assert scenes.seconds_of(ob) == pytest.approx(scenes.STEP, abs=0.002)
    way = np.diff(scenes.heads(ob, ["Hips"], frames[[0, -1]])[:, 0], axis=0)[0]
    assert way @ [0, -1, 0] > 0.3
    assert abs(way @ [1, 0, 0]) < 0.05


@pytest.mark.parametrize("kind", ["glb", "fbx", "bvh"])
@pytest.mark.parametrize(
    "place",
    [
        scenes.matrix(scale=0.01),
        scenes.matrix(scale=100.0),
        scenes.matrix(turn=(90, 0, 0), scale=0.01),
        scenes.matrix(turn=(0, 0, 120)),
    ],
    ids=["centimetres", "hectometres", "lying centimetres", "turned"],
)
def test_results_are_the_same_wherever_the_object_stands(
    cli: Command, files: Files, out: Path, tmp_path: Path, expected: Array, kind: str, place: Array
) -> None:
    scenes.sprout(place=place)
    rig = scenes.save(tmp_path / "rig.blend")
    assert cli("retarget", files.clip("blend"), rig, "-o", out / f"walk.{kind}").status == 0
    assert scenes.angle(results.directions(out / f"walk.{kind}"), expected) < 0.5
    hips = results.places(out / f"walk.{kind}", 2)[:, 0]
    assert np.linalg.norm(hips[1] - hips[0]) == pytest.approx(0.5, abs=0.2)


@pytest.mark.parametrize("kind", ["glb", "fbx", "bvh"])
def test_a_hidden_armature_is_written_like_any_other(
    cli: Command, files: Files, out: Path, tmp_path: Path, expected: Array, kind: str
) -> None:
    scenes.sprout().hide_set(True)
    rig = scenes.save(tmp_path / "hidden.blend")
    assert cli("retarget", files.clip("blend"), rig, "-o", out / f"walk.{kind}").status == 0
    assert scenes.angle(results.directions(out / f"walk.{kind}"), expected) < 0.5


@pytest.mark.parametrize("mode", ["EDIT", "POSE"])
def test_a_file_may_have_been_saved_in_any_mode(
    cli: Command, files: Files, out: Path, tmp_path: Path, expected: Array, mode: str
) -> None:
    bpy.context.view_layer.objects.active = scenes.sprout()
    bpy.ops.object.mode_set(mode=mode)
    rig = scenes.save(tmp_path / "rig.blend")
    assert cli("retarget", files.clip("blend"), rig, "-o", out / "walk.glb").status == 0
    assert scenes.angle(results.directions(out / "walk.glb"), expected) < 0.5


@pytest.mark.parametrize("kind", KINDS)
def test_a_result_lasts_as_long_as_the_clip_whatever_the_target_did_before(
    cli: Command, files: Files, out: Path, tmp_path: Path, kind: str
) -> None:
    antenna = Bone("Antenna", "Head", (0.0, 0.1, 1.0), (0.0, 0.1, 1.2))
    ob = scenes.sprout(extra=[antenna])
    scenes.key(ob, "Sway", {ob.pose.bones["Antenna"].path_from_id("rotation_quaternion"): [[1, 0, 0, 0]] * 100})
    rig = scenes.save(tmp_path / "rig.blend")
    assert cli("retarget", files.clip("blend"), rig, "-o", out / f"walk.{kind}").status == 0
    assert scenes.seconds_of(results.reload(out / f"walk.{kind}")) == pytest.approx(scenes.STEP, abs=0.002)


def test_a_result_replaces_an_older_one_and_leaves_its_inputs(cli: Command, files: Files, out: Path) -> None:
    before = contents(files.folder)
    (out / "walk.blend").write_text("old")
    assert cli("retarget", files.clip("blend"), files.sprout, "-o", out / "walk.blend").status == 0
    assert results.reload(out / "walk.blend").animation_data.action is not None
    assert contents(files.folder) == before
    assert list(contents(out)) == ["walk.blend"]


def test_each_target_gets_the_file_that_the_template_says(cli: Command, files: Files, out: Path) -> None:
    said = cli("retarget", files.clip("blend"), files.sprout, files.tall, "-o", out / "{source}_on_{target}.glb")
    assert said.status == 0
    assert sorted(contents(out)) == ["walk_on_sprout.glb", "walk_on_tall.glb"]
    assert "UpperArm.L" in results.reload(out / "walk_on_sprout.glb").data.bones
    tall = results.reload(out / "walk_on_tall.glb")
    assert "leftUpperArm" in tall.data.bones
    assert np.ptp(scenes.heads(tall, ["hips"], scenes.over_action(tall, 5))[..., 1]) > 0.5


def test_several_targets_share_one_blend(cli: Command, files: Files, out: Path, expected: Array) -> None:
    said = cli("retarget", files.clip("blend"), files.sprout, files.tall, "-o", out / "both.blend")
    assert said.status == 0
    load.load(Request(out / "both.blend"))
    sprout, tall = bpy.data.objects["Sprout"], bpy.data.objects["Tall"]
    assert sprout.animation_data.action != tall.animation_data.action
    frames = scenes.over_action(sprout, scenes.COUNT)
    assert scenes.angle(scenes.directions(sprout, frames, blender), expected) < 0.5
    assert scenes.angle(scenes.directions(tall, frames, segments=scenes.ARMS), expected[:, results.ARMS]) < 0.5


def test_targets_that_share_a_file_all_keep_the_clips_duration(cli: Command, files: Files, out: Path) -> None:
    scene = scenes.empty(24)
    scenes.sprout()
    slow = scenes.save(out.parent / "slow.blend")
    assert scene.render.fps == 24
    assert cli("retarget", files.clip("blend"), slow, files.tall_glb, "-o", out / "both.blend").status == 0
    load.load(Request(out / "both.blend"))
    for ob in (ob for ob in bpy.data.objects if ob.type == "ARMATURE"):
        assert scenes.seconds_of(ob) == pytest.approx(scenes.STEP, abs=0.002), ob.name


def test_a_target_in_the_open_file_is_given_the_clip_there(
    cli: Command, files: Files, out: Path, expected: Array
) -> None:
    ob = scenes.sprout()
    said = cli("retarget", files.clip("blend"), "Sprout", "-o", out / "open.blend")
    assert said.status == 0
    assert [ob.name for ob in bpy.data.objects] == ["Sprout"]
    assert scenes.angle(scenes.directions(ob, scenes.over_action(ob, scenes.COUNT), blender), expected) < 0.5
    assert scenes.angle(results.directions(out / "open.blend"), expected) < 0.5


@pytest.mark.parametrize("kind", KINDS)
def test_a_clip_for_the_open_file_keeps_its_duration(cli: Command, files: Files, out: Path, kind: str) -> None:
    scenes.empty(24)
    ob = scenes.sprout()
    assert cli("retarget", files.clip(kind), "Sprout", "-o", out / "open.blend").status == 0
    assert bpy.context.scene.render.fps == 24
    assert scenes.seconds_of(ob) == pytest.approx(scenes.STEP, abs=0.002)


def test_the_report_has_the_documented_keys(cli: Command, files: Files, out: Path) -> None:
    report = out / "report.json"
    said = cli(
        "retarget", files.clip("blend"), files.sprout, files.tall, "-o", out / "{target}.blend", "--report", report
    )
    assert said.status == 0
    entries = json.loads(report.read_text(encoding="utf-8"))
    assert [entry["target"] for entry in entries] == [str(files.sprout), str(files.tall)]
    for entry in entries:
        assert entry["source"] == str(files.clip("blend"))
        assert entry["frames"] == scenes.COUNT
        assert entry["joints_mapped"] > 15
        assert set(entry["bone_direction_error_deg"]) >= {"mean", "p95", "max"}
        assert set(entry["foot_slide_m_per_s"]) == {"source", "target"}
        assert set(entry["ground_penetration_m"]) == {"max"}
        assert "max" in entry["pose_jump_deg"]
        assert entry["seconds_per_stage"]
        assert all(seconds >= 0.0 for seconds in entry["seconds_per_stage"].values())
        assert entry["warnings"] == []
