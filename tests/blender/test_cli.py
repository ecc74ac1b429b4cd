"""The command line: help, requests that cannot be meant, and `map`."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.blender import results, scenes
from tests.blender.command import Command, contents
from tests.blender.files import KINDS, Files
from tools.figure import Build

ROOT = Path(__file__).resolve().parents[2]


# --- help ---


@pytest.mark.parametrize("command", [[], ["map"], ["retarget"]], ids=["alone", "map", "retarget"])
def test_help_has_examples(cli: Command, command: list[str]) -> None:
    said = cli(*command, "--help")
    assert said.status == 0
    assert said.errors == []
    assert said.out.startswith("usage: morph_retarget")
    examples = said.out.partition("examples:")[2].strip().splitlines()
    assert len(examples) >= 2
    assert all(line.strip().startswith("morph_retarget ") for line in examples)


@pytest.mark.parametrize(
    "arguments",
    [
        [],
        ["dance"],
        ["map"],
        ["retarget", "walk.bvh"],
        ["retarget", "walk.bvh", "rig.glb"],
        ["retarget", "walk.bvh", "rig.glb", "-o", "o.glb", "--fps", "fast"],
        ["retarget", "walk.bvh", "rig.glb", "-o", "o.glb", "--fps", "0"],
        ["retarget", "walk.bvh", "rig.glb", "-o", "o.glb", "--fps", "nan"],
        ["retarget", "walk.bvh", "rig.glb", "-o", "o.glb", "--lock", "2"],
        ["retarget", "walk.bvh", "rig.glb", "-o", "o.glb", "--frames", "7"],
        ["retarget", "walk.bvh", "rig.glb", "-o", "o.glb", "--frames", "20:5"],
        ["retarget", "walk.bvh", "rig.glb", "-o", "o.glb", "--root", "tail"],
        ["retarget", "walk.bvh", "rig.glb", "-o", "o.glb", "--reference", "soon"],
        ["retarget", "walk.bvh", "rig.glb", "-o", "o.glb", "--name", "{rig}"],
        ["map", "rig.glb", "--up", "Q"],
        ["map", "rig.glb", "--up", "+Z", "--forward", "-Z"],
    ],
    ids=" ".join,
)
def test_a_request_that_cannot_be_meant_is_refused_in_one_line(
    cli: Command, files: Files, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[str]
) -> None:
    (tmp_path / "walk.bvh").write_bytes(files.clip().read_bytes())
    (tmp_path / "rig.glb").write_bytes(files.tall_glb.read_bytes())
    before = contents(tmp_path)
    monkeypatch.chdir(tmp_path)
    said = cli(*arguments)
    assert said.status == 2
    assert said.out == ""
    assert len(said.errors) == 1
    assert said.errors[0].startswith("morph_retarget")
    assert contents(tmp_path) == before


# --- map ---


def test_map_tells_people_what_a_rig_is(cli: Command, files: Files) -> None:
    said = cli("map", files.sprout)
    assert said.status == 0
    assert said.errors == []
    lines = [" ".join(line.split()) for line in said.out.splitlines()]
    assert lines[0].startswith("Sprout: ")
    assert "humanoid" in lines[0]
    assert lines[1] == "up +Z, forward -Y"
    assert any(line.startswith("leftUpperArm UpperArm.L ") and line.endswith(("%  name", "% name")) for line in lines)
    assert any(line.startswith("Foot.R: ") and "foot" in line for line in lines)


def test_map_json_has_the_documented_keys_and_stdout_nothing_else(cli: Command, files: Files) -> None:
    said = cli("map", files.sprout, "--json")
    assert said.status == 0
    assert said.errors == []
    found = json.loads(said.out)
    assert list(found) == ["rig", "bones", "frame", "joints", "capabilities", "unmapped"]
    assert found["rig"] == "Sprout"
    assert set(found["frame"]) == {"up", "forward", "height"}
    assert found["frame"]["up"] == [0, 0, 1]
    assert found["frame"]["forward"] == [0, -1, 0]
    assert all(set(match) == {"bone", "confidence", "by"} for match in found["joints"].values())
    assert found["joints"]["rightLowerLeg"]["bone"] == "LowerLeg.R"
    assert all(0.0 < match["confidence"] <= 1.0 for match in found["joints"].values())
    assert all(isinstance(tags, list) and tags for tags in found["capabilities"].values())
    assert isinstance(found["unmapped"], list)
    ob = results.reload(files.sprout)
    assert found["bones"] == len(ob.data.bones)
    named = {match["bone"] for match in found["joints"].values()} | set(found["capabilities"]) | set(found["unmapped"])
    assert named <= set(ob.data.bones.keys())


@pytest.mark.parametrize("kind", [*KINDS, "vrm"])
def test_a_rig_is_the_same_in_every_kind_of_file(cli: Command, files: Files, kind: str) -> None:
    said = cli("map", files.clip(kind), "--json")
    assert said.status == 0
    assert said.errors == []
    found, expected = json.loads(said.out), json.loads(cli("map", files.clip("blend"), "--json").out)
    assert {j: m["bone"] for j, m in found["joints"].items()} == {j: m["bone"] for j, m in expected["joints"].items()}
    assert found["frame"]["up"] == [0, 0, 1]
    assert found["frame"]["forward"] == [0, -1, 0]
    assert found["frame"]["height"] == pytest.approx(1.75, rel=0.1)


def test_an_armature_of_the_open_file_is_a_rig(cli: Command) -> None:
    scenes.figure("Standing", seed=1)
    said = cli("map", "Standing", "--json")
    assert said.status == 0
    assert json.loads(said.out)["rig"] == "Standing"
    assert scenes.only_armature().name == "Standing"


def test_up_and_forward_are_believed(cli: Command, files: Files) -> None:
    said = cli("map", files.sprout, "--json", "--up=+Z", "--forward=+Y")
    assert said.status == 0
    found = json.loads(said.out)
    assert found["frame"]["forward"] == [0, 1, 0]
    assert found["frame"]["up"] == [0, 0, 1]
    upside_down = json.loads(cli("map", files.sprout, "--json", "--up=-Z").out)
    assert upside_down["frame"]["up"] == [0, 0, -1]


def test_armature_chooses_one_of_several(cli: Command, tmp_path: Path) -> None:
    scenes.figure("Small", seed=1, height=1.0)
    scenes.figure("Big", seed=2, height=3.0, build=Build(fingers=5))
    both = scenes.save(tmp_path / "both.blend")
    for name in ("Small", "Big"):
        said = cli("map", both, "--json", "--armature", name)
        assert said.status == 0
        assert json.loads(said.out)["rig"] == name
    wrong = cli("map", both, "--armature", "Medium")
    assert wrong.status == 2
    assert len(wrong.errors) == 1
    for word in ("both.blend", "Medium", "Small", "Big"):
        assert word in wrong.errors[0]


def test_the_module_is_the_same_program(files: Files, tmp_path: Path) -> None:
    made = subprocess.run(
        [sys.executable, "-m", "morph_retarget", "map", str(files.clip("glb")), "--json"],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )
    assert made.returncode == 0
    assert made.stderr == ""
    assert json.loads(made.stdout)["joints"]["hips"]["bone"] == "hips"
