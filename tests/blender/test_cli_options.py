"""The command line: what each option of `retarget` does, seen in the files it writes."""

import json
from itertools import pairwise
from pathlib import Path

import bpy
import numpy as np
import pytest

from morph_retarget.blender import actions
from morph_retarget.core.arrays import Array
from tests.blender import results, scenes
from tests.blender.command import Command, contents
from tests.blender.files import KINDS, LONG, Files
from tools import gait
from tools.figure import blender

# --- which clip ---


def test_the_action_that_a_source_plays_is_the_clip_and_others_are_mentioned(
    cli: Command, files: Files, out: Path
) -> None:
    said = cli("retarget", files.clips, files.sprout, "-o", out / "o.blend")
    assert said.status == 0
    assert len(said.errors) == 1
    assert "March" in said.errors[0]
    assert "Stroll" in said.errors[0]
    assert scenes.seconds_of(results.reload(out / "o.blend")) == pytest.approx(LONG, abs=0.02)


@pytest.mark.parametrize("how", ["hash", "option"])
def test_an_action_can_be_named(cli: Command, files: Files, out: Path, how: str) -> None:
    asked = [f"{files.clips}#Stroll"] if how == "hash" else [files.clips, "--action", "Stroll"]
    said = cli("retarget", *asked, files.sprout, "-o", out / "{source}_{action}.blend")
    assert said.status == 0
    assert said.errors == []
    assert list(contents(out)) == ["clips_Stroll.blend"]
    ob = results.reload(out / "clips_Stroll.blend")
    assert ob.animation_data.action.name == "Stroll on Sprout"
    assert scenes.seconds_of(ob) == pytest.approx(scenes.STEP, abs=0.002)


def test_a_hash_in_a_files_own_name_names_no_action(cli: Command, files: Files, out: Path, tmp_path: Path) -> None:
    odd = tmp_path / "take#2.bvh"
    odd.write_bytes(files.clip("bvh").read_bytes())
    assert cli("retarget", odd, files.sprout, "-o", out / "{source}.blend").status == 0
    assert list(contents(out)) == ["take#2.blend"]


def test_the_new_action_is_called_as_asked(cli: Command, files: Files, out: Path) -> None:
    name = "{target}: {action} ({source})"
    assert cli("retarget", files.clip("blend"), files.sprout, "-o", out / "o.blend", "--name", name).status == 0
    assert results.reload(out / "o.blend").animation_data.action.name == "Sprout: Walk (Walker)"


def test_all_actions_go_into_one_blend(cli: Command, files: Files, out: Path) -> None:
    report = out / "r.json"
    said = cli("retarget", files.clips, files.sprout, "-o", out / "o.blend", "--all-actions", "--report", report)
    assert said.status == 0
    ob = results.reload(out / "o.blend")
    found = {a.name: a for a in bpy.data.actions if a.name.endswith(" on Sprout")}
    assert set(found) == {"Stroll on Sprout", "March on Sprout"}
    for name, seconds in (("Stroll", scenes.STEP), ("March", LONG)):
        action = found[f"{name} on Sprout"]
        actions.assign(ob, action, action.slots[0])
        assert scenes.seconds_of(ob) == pytest.approx(seconds, abs=0.02)
        assert np.ptp(scenes.heads(ob, ["Hips"], scenes.over_action(ob, 5))[..., 1]) > 0.3
    named = {entry["source"] for entry in json.loads(report.read_text(encoding="utf-8"))}
    assert named == {f"{files.clips}#Stroll", f"{files.clips}#March"}


@pytest.mark.parametrize("kind", ["glb", "fbx", "bvh"])
def test_each_of_all_actions_is_written_whole(cli: Command, files: Files, out: Path, kind: str) -> None:
    said = cli("retarget", files.clips, files.sprout, "-o", out / f"{{action}}.{kind}", "--all-actions")
    assert said.status == 0
    assert sorted(contents(out)) == [f"March.{kind}", f"Stroll.{kind}"]
    for name, seconds in (("Stroll", scenes.STEP), ("March", LONG)):
        assert scenes.seconds_of(results.reload(out / f"{name}.{kind}")) == pytest.approx(seconds, abs=0.02), name


def test_no_result_takes_the_place_of_another(cli: Command, files: Files, out: Path, tmp_path: Path) -> None:
    scenes.walker(action="up/down").animation_data.action.use_fake_user = True
    ob = scenes.only_armature()
    scenes.walk(ob, gait.walk(scenes.STEP, scenes.FPS), "up:down")
    clips = scenes.save(tmp_path / "clips.blend")
    said = cli("retarget", clips, files.sprout, "-o", out / "{action}.glb", "--all-actions")
    assert said.status == 2
    assert len(said.errors) == 1
    assert "up_down.glb" in said.errors[0]
    assert contents(out) == {}


def test_frames_cut_the_clip(cli: Command, files: Files, out: Path, expected: Array) -> None:
    said = cli(
        "retarget", files.clip("blend"), files.sprout, "-o", out / "o.blend", "--frames", "5:20", "--no-plant-feet"
    )
    assert said.status == 0
    ob = results.reload(out / "o.blend")
    assert tuple(ob.animation_data.action.frame_range) == (5.0, 20.0)
    found = scenes.directions(ob, range(5, 21), blender, scenes.ARMS)
    assert scenes.angle(found, expected[4:20, results.ARMS]) < 0.5


# --- times ---


def test_the_result_has_the_clips_frame_rate_unless_the_target_has_one(cli: Command, files: Files, out: Path) -> None:
    cli("retarget", files.clip("blend"), files.tall_glb, "-o", out / "o.blend")
    assert results.reload(out / "o.blend").animation_data.action.frame_range[1] == scenes.COUNT
    assert bpy.context.scene.render.fps == scenes.FPS
    scenes.empty(24)
    scenes.sprout()
    rig = scenes.save(out.parent / "film.blend")
    cli("retarget", files.clip("blend"), rig, "-o", out / "o.blend")
    ob = results.reload(out / "o.blend")
    assert bpy.context.scene.render.fps == 24
    assert scenes.seconds_of(ob) == pytest.approx(scenes.STEP, abs=0.002)


@pytest.mark.parametrize("rate", [24.0, 60.0, 29.97])
@pytest.mark.parametrize("kind", KINDS)
def test_another_frame_rate_keeps_motion_and_duration(
    cli: Command, files: Files, out: Path, expected: Array, kind: str, rate: float
) -> None:
    result = out / f"o.{kind}"
    assert cli("retarget", files.clip("blend"), files.sprout, "-o", result, "--fps", rate).status == 0
    ob = results.reload(result)
    if kind in ("blend", "bvh"):
        render = bpy.context.scene.render
        assert render.fps / render.fps_base == pytest.approx(rate, rel=1e-3)
    # Formats that hold whole frames may end up to one frame early or late.
    assert scenes.seconds_of(ob) == pytest.approx(scenes.STEP, abs=1.0 / rate + 0.002)
    middle = scenes.over_action(ob, scenes.COUNT)[5:-5]
    found = scenes.directions(ob, middle, blender, scenes.ARMS)
    assert scenes.angle(found, expected[5:-5, results.ARMS]) < 4.0


def test_resampling_keys_whole_frames_of_the_same_motion(
    cli: Command, files: Files, out: Path, expected: Array
) -> None:
    cli("retarget", files.clip("blend"), files.sprout, "-o", out / "o.blend", "--fps", 24, "--resample")
    ob = results.reload(out / "o.blend")
    for curve in scenes.curves_of(ob).values():
        times = [key.co[0] for key in curve.keyframe_points]
        assert all(time == round(time) for time in times)
        assert all(b - a == 1.0 for a, b in pairwise(times))
    frames = np.arange(*ob.animation_data.action.frame_range)
    # Where the rates meet, at every fourth and fifth frame, the poses are the clip's own.
    found = scenes.directions(ob, frames[::4], blender)
    assert scenes.angle(found, expected[::5][: len(found)]) < 0.1


# --- how ---


def test_a_frame_of_the_clip_can_stand_for_the_targets_rest(cli: Command, files: Files, out: Path) -> None:
    options = ["--no-plant-feet", "--matching", "as-they-stand"]
    rest = scenes.shape(scenes.directions(results.reload(files.sprout), [1], blender))
    for frame in (1, 12):
        cli("retarget", files.clip("blend"), files.sprout, "-o", out / "o.blend", *options, "--reference", frame)
        ob = results.reload(out / "o.blend")
        found = scenes.shape(scenes.directions(ob, [frame, frame + 8], blender))
        assert scenes.apart(found[0], rest[0]) < 1e-4
        assert scenes.apart(found[1], rest[0]) > 0.1


def test_the_rest_is_the_reference_of_a_rig_whose_rest_is_a_pose(cli: Command, files: Files, out: Path) -> None:
    for name in ("rest", "auto"):
        cli("retarget", files.clip("blend"), files.sprout, "-o", out / f"{name}.blend", "--reference", name)
    found = [results.directions(out / f"{name}.blend") for name in ("rest", "auto")]
    assert scenes.angle(*found) < 1e-3


BODY = ("hips", "head", "leftHand", "rightHand", "leftFoot", "rightFoot")


@pytest.mark.parametrize("kind", ["blend", "glb", "fbx", "bvh"])
@pytest.mark.parametrize("carrier", ["root", "object"])
def test_whatever_carries_the_travel_the_body_moves_alike(
    cli: Command, files: Files, out: Path, carrier: str, kind: str
) -> None:
    cli("retarget", files.clip("blend"), files.sprout, "-o", out / "hips.blend")
    cli("retarget", files.clip("blend"), files.sprout, "-o", out / f"{carrier}.{kind}", "--root", carrier)
    own, other = (
        results.places(out / "hips.blend", scenes.COUNT, BODY),
        results.places(out / f"{carrier}.{kind}", scenes.COUNT, BODY),
    )
    assert scenes.apart(own, other) < 0.002


@pytest.mark.parametrize(("carrier", "moving"), [("root", "Root"), ("object", None), ("hips", "Hips")])
def test_the_travel_is_keyed_where_it_was_asked_for(
    cli: Command, files: Files, out: Path, carrier: str, moving: str | None
) -> None:
    cli("retarget", files.clip("blend"), files.sprout, "-o", out / "o.blend", "--root", carrier)
    ob = results.reload(out / "o.blend")
    ways: dict[str, float] = {}
    for (path, _), curve in scenes.curves_of(ob).items():
        if path.endswith("location"):
            ways[path] = max(ways.get(path, 0.0), np.ptp([key.co[1] for key in curve.keyframe_points]))
    path = "location" if moving is None else ob.pose.bones[moving].path_from_id("location")
    assert max(ways, key=ways.get) == path
    if carrier == "hips":
        assert list(ways) == [path]


def test_in_place_the_body_stays_over_its_spot(cli: Command, files: Files, out: Path) -> None:
    cli("retarget", files.clip("blend"), files.sprout, "-o", out / "o.blend", "--root", "in-place")
    assert np.ptp(results.places(out / "o.blend")[..., 1]) < 0.1
    cli("retarget", files.clip("blend"), files.sprout, "-o", out / "o.blend")
    assert np.ptp(results.places(out / "o.blend")[..., 1]) > 0.3


def test_root_motion_needs_a_bone_above_the_hips(cli: Command, files: Files, out: Path) -> None:
    said = cli("retarget", files.clip("blend"), files.tall, "-o", out / "o.blend", "--root", "root")
    assert said.status == 2
    assert len(said.errors) == 1
    assert "tall.blend" in said.errors[0]
    assert contents(out) == {}


def test_feet_follow_the_ground_object(cli: Command, files: Files, out: Path, tmp_path: Path) -> None:
    scenes.sprout()
    bpy.ops.mesh.primitive_plane_add(size=40.0, location=(0, 0, 0.2))
    bpy.context.object.name = "Stage"
    rig = scenes.save(tmp_path / "stage.blend")
    cli("retarget", files.clip("blend"), rig, "-o", out / "flat.blend", "--armature", "Sprout")
    assert cli("retarget", files.clip("blend"), rig, "-o", out / "up.blend", "--ground", "Stage").status == 0
    feet = ("leftFoot", "rightFoot")
    rise = results.places(out / "up.blend", joints=feet) - results.places(out / "flat.blend", joints=feet)
    assert np.abs(rise[..., 2] - 0.2).max() < 0.005
    assert np.abs(rise[..., :2]).max() < 0.005


@pytest.mark.parametrize("name", ["Stairs", "Sprout"])
def test_the_ground_must_be_a_mesh_of_the_targets_file(
    cli: Command, files: Files, out: Path, tmp_path: Path, name: str
) -> None:
    scenes.sprout()
    bpy.ops.mesh.primitive_plane_add()
    bpy.context.object.name = "Stage"
    rig = scenes.save(tmp_path / "stage.blend")
    said = cli("retarget", files.clip("blend"), rig, "-o", out / "o.blend", "--ground", name)
    assert said.status == 2
    assert len(said.errors) == 1
    assert "stage.blend" in said.errors[0]
    assert name in said.errors[0]
    assert "Stage" in said.errors[0]
    assert contents(out) == {}


def test_hands_keep_the_sources_places_when_asked(cli: Command, files: Files, out: Path) -> None:
    """Scaled by leg lengths, the source's hands are where the small body's hands then are."""
    walk = results.reload(files.clip("blend"))
    hands = ("leftHand", "rightHand")
    theirs = scenes.heads(walk, hands, range(1, scenes.COUNT + 1))
    apart = []
    for options in ([], ["--hands"]):
        cli("retarget", files.clip("blend"), files.sprout, "-o", out / "o.blend", "--scale", 0.5, *options)
        ours = results.places(out / "o.blend", joints=hands)
        between = [places[:, 0] - places[:, 1] for places in (ours, 0.5 * theirs)]
        apart.append(np.abs(between[0] - between[1]).max())
    assert apart[1] < 0.02 < apart[0]


def test_scale_sets_how_far_the_target_goes(cli: Command, files: Files, out: Path) -> None:
    ways = []
    for scale in (0.4, 0.8):
        cli("retarget", files.clip("blend"), files.sprout, "-o", out / "o.blend", "--scale", scale)
        hips = results.places(out / "o.blend", 2)[:, 0]
        ways.append(hips[1] - hips[0])
    assert np.abs(2.0 * ways[0] - ways[1])[:2].max() < 0.01


def test_locked_feet_slide_less(cli: Command, files: Files, out: Path) -> None:
    slides = []
    for options in (["--lock", 1], ["--lock", 0], ["--no-plant-feet"]):
        cli("retarget", files.clip("blend"), files.sprout, "-o", out / "o.blend", "--report", out / "r.json", *options)
        slides.append(json.loads((out / "r.json").read_text(encoding="utf-8"))[0]["foot_slide_m_per_s"]["target"])
    assert slides[0] < slides[1] < slides[2]


def test_a_target_walks_where_it_is_said_to_face(cli: Command, files: Files, out: Path, tmp_path: Path) -> None:
    scenes.stand(scenes.sprout(), scenes.matrix(turn=(0, 0, 90)))
    rig = scenes.save(tmp_path / "rig.blend")
    for options in ([], ["--up=+Z", "--forward=+X"]):
        assert cli("retarget", files.clip("blend"), rig, "-o", out / "o.blend", *options).status == 0
        hips = results.places(out / "o.blend", 2)[:, 0]
        assert (hips[1] - hips[0])[0] == pytest.approx(0.35, abs=0.05)
    cli("retarget", files.clip("blend"), rig, "-o", out / "o.blend", "--forward=-X")
    hips = results.places(out / "o.blend", 2)[:, 0]
    assert (hips[1] - hips[0])[0] == pytest.approx(-0.35, abs=0.05)


# --- joint maps ---


def test_what_map_prints_is_a_map_for_retarget(
    cli: Command, files: Files, out: Path, tmp_path: Path, expected: Array
) -> None:
    (tmp_path / "target.json").write_text(cli("map", files.sprout, "--json").out, encoding="utf-8")
    (tmp_path / "source.json").write_text(cli("map", files.clip("blend"), "--json").out, encoding="utf-8")
    maps = ["--map", tmp_path / "target.json", "--source-map", tmp_path / "source.json"]
    assert cli("retarget", files.clip("blend"), files.sprout, "-o", out / "o.blend", *maps).status == 0
    assert scenes.angle(results.directions(out / "o.blend"), expected) < 0.5


def test_a_target_map_decides_which_bone_follows_which(cli: Command, files: Files, out: Path, tmp_path: Path) -> None:
    table = tmp_path / "map.json"
    table.write_text(json.dumps({"leftHand": "", "rightHand": ""}), encoding="utf-8")
    wave = files.clip("blend")
    cli("retarget", wave, files.sprout, "-o", out / "o.blend", "--map", table)
    keyed = {path for path, _ in scenes.curves_of(results.reload(out / "o.blend"))}
    assert not any("Hand." in path for path in keyed)
    assert any("LowerArm.L" in path for path in keyed)


def test_a_source_map_decides_which_bone_is_followed(
    cli: Command, files: Files, out: Path, tmp_path: Path, expected: Array
) -> None:
    table = {}
    for joint in ("Shoulder", "UpperArm", "LowerArm", "Hand"):
        table |= {f"left{joint}": f"right{joint}", f"right{joint}": f"left{joint}"}
    crossed = tmp_path / "map.json"
    crossed.write_text(json.dumps({"joints": table}), encoding="utf-8")
    said = cli("retarget", files.clip("blend"), files.sprout, "-o", out / "o.blend", "--source-map", crossed)
    assert said.status == 0
    found = results.directions(out / "o.blend")
    left = scenes.SEGMENTS.index(("leftUpperArm", "leftLowerArm"))
    right = scenes.SEGMENTS.index(("rightUpperArm", "rightLowerArm"))
    assert scenes.angle(found[:, left], expected[:, right]) < 1.0


@pytest.mark.parametrize("option", ["--map", "--source-map"])
@pytest.mark.parametrize(
    ("text", "word"),
    [
        ('{"hips": "No Such Bone"}', "No Such Bone"),
        ('{"leftHoof": "Hips"}', "leftHoof"),
        ('{"joints": {"hips": {"bone": 7}}}', "hips"),
        ("not json", "map.json"),
        ("[]", "map.json"),
        ("", "map.json"),
    ],
    ids=["no such bone", "no such joint", "no bone", "no JSON", "no table", "empty"],
)
def test_a_wrong_map_is_refused_by_name(
    cli: Command, files: Files, out: Path, tmp_path: Path, option: str, text: str, word: str
) -> None:
    table = tmp_path / "map.json"
    table.write_text(text, encoding="utf-8")
    said = cli("retarget", files.clip("blend"), files.sprout, "-o", out / "o.blend", option, table)
    assert said.status == 2
    assert said.out == ""
    assert len(said.errors) == 1
    assert said.errors[0].startswith("morph_retarget: ")
    assert word in said.errors[0]
    assert contents(out) == {}


def test_a_map_that_cannot_be_read_is_refused_by_name(cli: Command, files: Files, out: Path, tmp_path: Path) -> None:
    (tmp_path / "binary.json").write_bytes(bytes(range(128, 256)))
    for table in (tmp_path / "missing.json", tmp_path, tmp_path / "binary.json"):
        said = cli("retarget", files.clip("blend"), files.sprout, "-o", out / "o.blend", "--map", table)
        assert said.status == 2
        assert len(said.errors) == 1
        assert said.errors[0].startswith(f"morph_retarget: {table}: ")
    assert contents(out) == {}
