"""Bone maps of other tools, in the window and on the command line."""

import json
from collections.abc import Mapping
from pathlib import Path

import bpy
import pytest

from morph_retarget.blender import bone_maps
from morph_retarget.blender.batch import jobs_file
from morph_retarget.blender.properties import of_rig
from morph_retarget.core.arrays import Array
from morph_retarget.core.character import families
from morph_retarget.core.errors import FileError
from tests.blender import results, scenes, window
from tests.blender.command import Command, Refused, contents
from tests.blender.files import Files
from tools.figure import blender, vrm

ops = bpy.ops.morph_retarget
PRESETS = {"map": "Unity Humanoid", "source-map": "VRM"}
ARM = ("UpperArm", "LowerArm", "Hand")


def _keemap(path: Path, joints: Mapping[str, str]) -> Path:
    """Write a map of KeeMap from the walker's bones to those of the sprout, for joints of one and of the other."""
    bones = [{"SourceBoneName": vrm(a), "DestinationBoneName": blender(b)} for a, b in joints.items()]
    path.write_text(json.dumps({"bones": bones}), encoding="utf-8")
    return path


def _preset(path: Path, slots: Mapping[str, str]) -> Path:
    """Write a preset of Expy Kit."""
    lines = ["import bpy", "skeleton = bpy.context.object.data.expykit_retarget", ""]
    lines += [f"skeleton.{slot} = {bone!r}" for slot, bone in slots.items()]
    path.write_text("\n".join(lines), encoding="utf-8")
    return path


def _given(ob: bpy.types.Object) -> dict[str, str]:
    return {joint.name: joint.bone for joint in of_rig(ob).joints if joint.by == "preset"}


def _crossed() -> dict[str, str]:
    sides = ("left", "right")
    return {a + part: b + part for a, b in (sides, sides[::-1]) for part in ARM}


# --- the window ---


@pytest.mark.usefixtures("registered")
def test_a_map_of_pairs_gives_the_target_its_joints(tmp_path: Path) -> None:
    _, _, target = window.pair()
    path = _keemap(tmp_path / "map.json", _crossed() | {"hips": "ghost"})
    assert ops.import_map(rig=target.name, filepath=str(path)) == {"FINISHED"}
    assert _given(target) == {ours: blender(theirs) for ours, theirs in _crossed().items()}


@pytest.mark.usefixtures("registered")
def test_presets_of_families_are_offered_and_loaded_by_their_names(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("morph_retarget.blender.presets._folder", [tmp_path])
    settings, source, _ = window.pair()
    settings.shown = "SOURCE"
    ops.load_preset(rig=source.name, name="VRM")
    own = families.named("VRM").joints
    assert _given(source) == {joint: bone for joint, bone in own.items() if bone in source.data.bones}
    with pytest.raises(RuntimeError, match="fits no bone of this rig"):
        ops.load_preset(rig=source.name, name="MikuMikuDance")
    ops.save_preset(rig=source.name, name="VRM")
    ops.pick_bone(rig=source.name, joint="head", bone="neck")
    ops.load_preset(rig=source.name, name="VRM")
    assert of_rig(source).joints["head"].bone == "head", "one's own preset of that name counts"


@pytest.mark.usefixtures("registered")
@pytest.mark.parametrize("form", ["OURS", "KEEMAP", "ROKOKO"])
def test_what_the_window_writes_for_a_tool_it_reads_again(tmp_path: Path, form: str) -> None:
    _, source, target = window.pair()
    ops.analyze(rig=target.name)
    ops.pick_bone(rig=target.name, joint="leftHand", bone="Hand.R")
    joints = {joint.name: joint.bone for joint in of_rig(target).joints if joint.bone}
    path = tmp_path / "map.json"
    ops.export_map(rig=target.name, filepath=str(path), form=form)
    ops.reset_joints(rig=target.name)
    ops.import_map(rig=target.name, filepath=str(path))
    known = {"OURS": joints, "ROKOKO": set(joints) - {"upperChest"}, "KEEMAP": set(source.data.bones.keys())}[form]
    assert _given(target) == {joint: bone for joint, bone in joints.items() if joint in known}
    assert of_rig(target).joints["leftHand"].bone == "Hand.R"


@pytest.mark.usefixtures("registered")
def test_a_map_for_two_rigs_wants_both(tmp_path: Path) -> None:
    settings, _, target = window.pair()
    ops.analyze(rig=target.name)
    settings.source = None
    with pytest.raises(RuntimeError, match="a KeeMap map pairs two rigs: choose both Source and Target"):
        ops.export_map(rig=target.name, filepath=str(tmp_path / "map.json"), form="KEEMAP")
    assert contents(tmp_path) == {}


@pytest.mark.usefixtures("registered")
def test_a_map_that_is_refused_changes_nothing(tmp_path: Path) -> None:
    _, _, target = window.pair()
    ops.analyze(rig=target.name)
    before = [(joint.bone, joint.by) for joint in of_rig(target).joints]
    path = tmp_path / "preset.py"
    path.write_text("import bpy\nbpy.data.objects['Sprout'].name = 'Gone'\n")
    with pytest.raises(RuntimeError, match="line 2 gives no name to a bone"):
        ops.import_map(rig=target.name, filepath=str(path))
    _preset(path, {"spine.hips": "Ghost"})
    with pytest.raises(RuntimeError, match="fits no bone of this rig"):
        ops.import_map(rig=target.name, filepath=str(path))
    assert [(joint.bone, joint.by) for joint in of_rig(target).joints] == before
    assert target.name == "Sprout", "nothing of it was run"


@pytest.mark.usefixtures("registered")
def test_names_of_controls_become_the_controls_of_joints(rigify_file: Path, tmp_path: Path) -> None:
    bpy.ops.wm.open_mainfile(filepath=str(rigify_file))
    slots = {"spine.hips": "torso", "left_arm.arm": "upper_arm_fk.L", "right_leg.foot": "DEF-foot.R"}
    ops.import_map(rig="rig", filepath=str(_preset(tmp_path / "preset.py", slots)))
    joints = of_rig(bpy.data.objects["rig"]).joints
    assert {joint.name: joint.control for joint in joints if joint.control} == {
        "hips": "torso",
        "leftUpperArm": "upper_arm_fk.L",
    }
    assert joints["leftUpperArm"].bone == "DEF-upper_arm.L"
    assert _given(bpy.data.objects["rig"]) == {"rightFoot": "DEF-foot.R"}


# --- the command line ---


def test_a_map_of_another_tool_decides_which_bone_follows_which(
    cli: Command, files: Files, out: Path, tmp_path: Path, expected: Array
) -> None:
    table = _keemap(tmp_path / "map.json", _crossed() | {"hips": "hips", "head": "ghost"})
    said = cli("retarget", files.clip("blend"), files.sprout, "-o", out / "o.blend", "--map", table)
    assert said.status == 0
    (warning,) = [line for line in said.errors if "bone map" in line]
    assert "1 of its entries left out: " in warning
    assert blender("ghost") in warning
    found = results.directions(out / "o.blend")
    left = scenes.SEGMENTS.index(("leftUpperArm", "leftLowerArm"))
    right = scenes.SEGMENTS.index(("rightUpperArm", "rightLowerArm"))
    assert scenes.angle(found[:, right], expected[:, left]) < 1.0


def test_maps_are_turned_from_one_form_into_another(cli: Command, files: Files, tmp_path: Path) -> None:
    wanted = json.loads(cli("map", files.sprout, "--form", "joints").out)["joints"]
    for form in ("keemap", "rokoko"):
        path = tmp_path / f"{form}.json"
        said = cli("map", files.sprout, "--form", form, "--source", files.clip("blend"))
        path.write_text(said.out, encoding="utf-8")
        again = json.loads(cli("map", files.sprout, "--map", path, "--form", "joints").out)["joints"]
        assert again == wanted
    assert "--source" in cli("map", files.sprout, "--form", "keemap").errors[0]


def test_presets_can_be_named_where_maps_are_read(cli: Command, files: Files, tmp_path: Path) -> None:
    said = cli("map", files.clip("blend"), "--map", "vrm", "--json")
    assert said.status == 0
    assert {entry["by"] for entry in json.loads(said.out)["joints"].values()} == {"user"}
    assert "named as VRM" in cli("map", files.clip("blend")).out
    path = tmp_path / "mixamo.json"
    path.write_text(families.named("Mixamo").path.read_text(encoding="utf-8"), encoding="utf-8")
    said = cli("map", files.clip("blend"), "--map", path)
    assert said.status == 2
    assert "joint hips is mapped to bone 'mixamorig:Hips'" in said.errors[0]


def test_jobs_name_presets_as_well(files: Files, tmp_path: Path) -> None:
    jobs = tmp_path / "jobs.toml"
    job = (
        f'[[job]]\nsource = "{files.clip()}"\ntarget = "{files.sprout}"\nmap = "Unity Humanoid"\nsource-map = "{{}}"\n'
    )
    jobs.write_text(job.format("vrm"), encoding="utf-8")
    (wish,) = jobs_file.read(jobs)
    assert wish.options == {key: str(families.named(name).path) for key, name in PRESETS.items()}
    assert bone_maps.find(wish.options["map"]) == families.named("Unity Humanoid")
    jobs.write_text(job.format("VRN"), encoding="utf-8")
    (refused,) = jobs_file.read(jobs)
    assert f"{tmp_path / 'VRN'}: no such file: check the path" in str(refused)


@pytest.mark.parametrize(
    ("name", "text", "word"),
    [
        ("map.json", '{"bones": [{"SourceBoneName": "hips"}]}', "bones[0] has no DestinationBoneName"),
        ("map.json", '{"mappings": [{"source": "Becken", "target": "Ghost"}]}', "'Ghost' is not in the rig"),
        ("map.json", '{"rokoko_custom_names": true, "bones": []}', "has no table 'bones'"),
        ("map.py", "import bpy\nimport os\nos.remove('map.py')\n", "line 2 gives no name to a bone"),
        ("map.py", "skeleton.spine.hips = 'Ghost'\n", "'Ghost' for hips is not in the rig"),
        ("map.blend-retarget", '{"mappings": [\n{"source": 1}]}', "mappings[0].source is 1"),
    ],
)
def test_what_cannot_be_used_is_refused_in_one_line_that_names_it(
    refused: Refused, files: Files, out: Path, tmp_path: Path, name: str, text: str, word: str
) -> None:
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    message = refused("retarget", files.clip("blend"), files.sprout, "-o", out / "o.blend", "--map", path, names=word)
    assert name in message
    assert path.exists(), "nothing of it was run"


def test_a_file_of_many_megabytes_is_no_bone_map(tmp_path: Path) -> None:
    path = tmp_path / "map.json"
    with path.open("wb") as file:
        file.truncate(100 * 1024**2)
    with pytest.raises(FileError, match="has 100 MB, which no bone map has: choose another file"):
        bone_maps.load(path)
