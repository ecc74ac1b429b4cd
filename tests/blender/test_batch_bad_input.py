"""Batches of inputs that are none, of odd ones, and of places that give out: each costs its own job and no other."""

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import bpy
import pytest

from tests.blender import scenes
from tests.blender.command import Command
from tests.blender.files import Files
from tools.figure import Build

LINUX = pytest.mark.skipif(sys.platform != "linux", reason="limits of memory hold on Linux")


def _jobs(out: Path) -> dict[str, dict[str, object]]:
    return {entry["name"]: entry for entry in json.loads((out / "report.json").read_text())["jobs"]}


def test_what_is_no_motion_costs_its_own_job(cli: Command, files: Files, tmp_path: Path) -> None:
    clips, out = tmp_path / "clips", tmp_path / "out"
    clips.mkdir()
    shutil.copy(files.clip(), clips / "walk.bvh")
    shutil.copy(files.clip(), clips / os.fsdecode(b"gel\xe4uf.bvh"))  # named by a system of another encoding
    shutil.copy(files.sprout, clips / "still.blend")
    (clips / "picture.glb").write_bytes(b"\x89PNG\r\n\x1a\n" + bytes(200))
    (clips / "letter.bvh").write_text("Dear motion,\n")
    (clips / "noise.fbx").write_bytes(bytes(range(256)) * 9)
    shutil.copy(files.clip(), clips / "a film.glb")
    bpy.ops.mesh.primitive_cube_add()
    scenes.save(clips / "cube.blend")
    (clips / "empty.bvh").touch()
    said = cli("batch", clips, "--on", files.tall, "--out", out, "--files", "{source}.bvh")
    assert said.status == 1
    jobs = _jobs(out)
    good = ["gel\udce4uf.bvh", "walk.bvh"]
    assert sorted(name for name, entry in jobs.items() if entry["status"] == "ok") == good
    assert all(entry["status"] == "failed" for name, entry in jobs.items() if name not in good)
    for name, entry in jobs.items():
        if name not in good:
            assert "\n" not in entry["error"], entry
            assert str(entry["source"]) in entry["error"], entry
    assert sum(line.startswith("morph_retarget: failed: ") for line in said.errors) == len(jobs) - 2
    page = (out / "index.html").read_text(encoding="utf-8")
    assert page.count("<svg") == 2
    assert page.index("Failed (7)") < page.index("Ok (2)")


def test_requests_that_cannot_be_meant_cost_themselves_alone(cli: Command, files: Files, tmp_path: Path) -> None:
    shutil.copy(files.clip(), tmp_path / "walk.bvh")
    shutil.copy(files.sprout, tmp_path / "rig.blend")
    out = tmp_path / "out"
    good = '[[job]]\nsource = "walk.bvh"\nout = "{source}.bvh"\n'
    (tmp_path / "jobs.toml").write_text(
        f'[defaults]\ntarget = "rig.blend"\n{good}{good}[[job]]\nsource = "none*.bvh"\n[[job]]\nsource = "walk.bvh"\n'
        'speed = 3\n[[job]]\nsource = "walk.bvh"\nout = "../{source}.glb"\n'
    )
    said = cli("batch", tmp_path / "jobs.toml", "--out", out)
    assert said.status == 1
    assert {name: entry["status"] for name, entry in _jobs(out).items()} == {
        "walk.bvh": "ok",
        "jobs.toml: job 2: walk.bvh on rig.blend": "failed",
        "jobs.toml: job 3: none*.bvh": "failed",
        "jobs.toml: job 4": "failed",
        "jobs.toml: job 5: walk.bvh on rig.blend": "failed",
    }
    assert sum("jobs.toml:" in line for line in said.errors) == 4
    assert sorted(path.name for path in tmp_path.iterdir()) == ["jobs.toml", "out", "rig.blend", "walk.bvh"]


def test_rigs_in_other_units_get_the_same_motion(cli: Command, files: Files, tmp_path: Path) -> None:
    """Rigs built in centimetres and scaled down to their size, or up, and some that are that small or large."""
    rigs, out, units = tmp_path / "rigs", tmp_path / "out", (0.01, 100.0)
    rigs.mkdir()
    options = {"seed": 3, "build": Build(fingers=2)}
    builds = {"plain": (1.7, 1.0)}
    for unit in units:
        builds |= {f"scaled {unit}": (1.7 / unit, unit), f"size {unit}": (1.7 * unit, 1.0)}
    for name, (height, scale) in builds.items():
        scenes.empty()
        scenes.figure("Rig", height=height, **options).scale = (scale,) * 3
        bpy.context.view_layer.update()
        scenes.save(rigs / f"{name}.blend")
    clips = tmp_path / "clips"
    clips.mkdir()
    shutil.copy(files.clip(), clips / "walk.bvh")
    said = cli("batch", clips, "--on", rigs / "*.blend", "--out", out, "--files", "{target}.blend")
    assert said.status == 0, said
    measures = {name: entry["measures"][0] for name, entry in _jobs(out).items()}
    plain = measures["plain.blend"]
    for name, size in [
        (f"{kind} {unit}", unit if kind == "size" else 1.0) for kind in ("scaled", "size") for unit in units
    ]:
        own = measures[f"{name}.blend"]
        for key in ("bone_direction_error_deg", "bone_twist_error_deg", "pose_jump_deg"):
            assert own[key]["max"] == pytest.approx(plain[key]["max"], abs=0.05), name
        slides = own["foot_slide_m_per_s"]["target"], size * plain["foot_slide_m_per_s"]["target"]
        assert slides[0] == pytest.approx(slides[1], rel=0.05, abs=1e-3 * size), name


# --- places that give out ---


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """Return a folder on a disk of 300 KB of its own."""
    folder = tmp_path / "disk"
    folder.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=300k,nr_inodes=64", "tmpfs", str(folder)]
    if sys.platform != "linux" or os.geteuid() != 0 or subprocess.call(mount, stderr=subprocess.DEVNULL):
        pytest.skip("a disk can be made by root on Linux alone, where that is allowed")
    try:
        yield folder
    finally:
        subprocess.run(["umount", str(folder)], check=True)


def test_a_result_that_the_disk_has_no_room_for_costs_its_own_job(
    cli: Command, files: Files, tmp_path: Path, small_disk: Path
) -> None:
    clips, out = tmp_path / "clips", small_disk / "out"
    clips.mkdir()
    for name in "ac":
        shutil.copy(files.clip(), clips / f"{name}.bvh")
    head, _, motion = files.clip().read_text().partition("Frame Time")
    rows = motion.splitlines()
    count, more = len(rows) - 1, 19
    longer = head.replace(f"Frames: {count}", f"Frames: {count * (more + 1)}")
    (clips / "b.bvh").write_text("\n".join([f"{longer}Frame Time{rows[0]}", *rows[1:] * (more + 1)]) + "\n")
    said = cli("batch", clips, "--on", files.tall, "--out", out, "--files", "{source}.bvh")
    assert said.status == 1, said
    jobs = _jobs(out)
    assert [entry["status"] for entry in jobs.values()] == ["ok", "failed", "ok"]
    told = str(jobs["b.bvh"]["error"])
    assert told.startswith(f"{out / 'b.bvh'}: cannot be written (")
    assert "No space left" in told
    assert "\n" not in told
    assert not (out / "b.bvh").exists()
    assert not list(out.glob(".[0-9]*"))


@LINUX
def test_a_job_that_needs_more_memory_than_there_is_costs_itself_alone(
    cli: Command, files: Files, tmp_path: Path
) -> None:
    resource = pytest.importorskip("resource")
    clips, out = tmp_path / "clips", tmp_path / "out"
    clips.mkdir()
    for name in "ac":
        shutil.copy(files.clip(), clips / f"{name}.bvh")
    with (clips / "b.bvh").open("wb") as stream:
        stream.truncate(500_000_000)
    own = int(Path("/proc/self/statm").read_text().split()[5]) * resource.getpagesize() // 1_000_000
    batch = ["batch", clips, "--on", files.tall, "--files", "{source}.bvh", "--out", out]
    assert cli(*batch, "--memory", min(own, 600) + 250).status == 1
    jobs = _jobs(out)
    assert [entry["status"] for entry in jobs.values()] == ["ok", "crashed", "ok"]
    assert "ran out of memory" in str(jobs["b.bvh"]["error"])
