"""Inputs that cannot be used: status 2, one line that says what is wrong and names it, and nothing written."""

import base64
import json
import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import bpy
import numpy as np
import pytest

from morph_retarget.blender import actions
from tests.blender import scenes
from tests.blender.command import Refused
from tests.blender.files import Files
from tools import armatures
from tools.figure import Bone, humanoid

# --- files that are no rigs ---

NOISE = np.random.default_rng(11).bytes(4000)
KINDS = (".bvh", ".fbx", ".glb", ".gltf", ".vrm", ".blend")


def _missing(_: Files, path: Path) -> Path:
    return path / "missing.bvh"


def _folder(_: Files, path: Path) -> Path:
    (path / "folder.glb").mkdir()
    return path / "folder.glb"


def _unknown_kind(_: Files, path: Path) -> Path:
    (path / "clip.txt").write_text("HIERARCHY")
    return path / "clip.txt"


def _file(name: str, content: bytes) -> Callable[[Files, Path], Path]:
    def make(_: Files, path: Path) -> Path:
        (path / name).write_bytes(content)
        return path / name

    return make


def _cut(kind: str, share: float) -> Callable[[Files, Path], Path]:
    """Return a maker of a file that ends early."""

    def make(files: Files, path: Path) -> Path:
        whole = (files.sprout if kind == "blend" else files.clip(kind)).read_bytes()
        (path / f"cut.{kind}").write_bytes(whole[: int(share * len(whole))])
        return path / f"cut.{kind}"

    return make


def _bvh(name: str, change: Callable[[str], str]) -> Callable[[Files, Path], Path]:
    """Return a maker of a changed BVH file."""

    def make(files: Files, path: Path) -> Path:
        whole = files.clip("bvh").read_text(encoding="utf-8")
        changed = change(whole)
        assert changed != whole
        (path / name).write_text(changed, encoding="utf-8")
        return path / name

    return make


def _with_value(text: str) -> Callable[[str], str]:
    """Return a change that puts ``text`` in place of one number in the middle of the motion."""

    def change(whole: str) -> str:
        lines = whole.splitlines()
        values = lines[-scenes.COUNT // 2].split()
        values[7] = text
        lines[-scenes.COUNT // 2] = " ".join(values)
        return "\n".join(lines) + "\n"

    return change


def _without_frames(whole: str) -> str:
    head = whole.partition("MOTION")[0]
    return f"{head}MOTION\nFrames: 0\nFrame Time: 0.033333\n"


def _without_armature(_: Files, path: Path) -> Path:
    bpy.ops.mesh.primitive_cube_add()
    return scenes.save(path / "cube.blend")


def _glb_without_armature(_: Files, path: Path) -> Path:
    bpy.ops.mesh.primitive_cube_add()
    bpy.ops.export_scene.gltf(filepath=str(path / "cube.glb"), export_format="GLB")
    return path / "cube.glb"


def _of_another_program(_: Files, path: Path) -> Path:
    """Return a glTF file that says it cannot be read without an extension that nobody has."""
    needs = {"asset": {"version": "2.0"}, "extensionsUsed": ["XYZ_secret"], "extensionsRequired": ["XYZ_secret"]}
    (path / "needs.gltf").write_text(json.dumps(needs))
    return path / "needs.gltf"


def _without_bones(_: Files, path: Path) -> Path:
    armatures.build("Boneless", [])
    return scenes.save(path / "boneless.blend")


UNUSABLE = {
    "missing": _missing,
    "a folder": _folder,
    "of an unknown kind": _unknown_kind,
    "without an armature": _without_armature,
    "a glb without an armature": _glb_without_armature,
    "a gltf that needs an unknown extension": _of_another_program,
    "an armature without bones": _without_bones,
    "a BVH cut in its skeleton": _bvh("cut.bvh", lambda text: text[:600]),
    "a BVH cut in its motion": _bvh("cut.bvh", lambda text: text[: len(text) * 3 // 4]),
    "a BVH cut in a line": _bvh("cut.bvh", lambda text: text.rstrip().rpartition(" ")[0]),
    "a BVH with a NaN": _bvh("nan.bvh", _with_value("nan")),
    "a BVH with an infinity": _bvh("inf.bvh", _with_value("-inf")),
    "a BVH with a word": _bvh("word.bvh", _with_value("zero")),
    "a BVH with a NaN in its skeleton": _bvh("rest.bvh", lambda t: t.replace("OFFSET ", "OFFSET nan ", 3)),
    "a BVH without frames": _bvh("still.bvh", _without_frames),
    "a BVH without a frame time": _bvh("time.bvh", lambda text: text.replace("Frame Time", "Frames Time")),
    "a BVH with a frame time of zero": _bvh(
        "zero.bvh", lambda text: "\n".join("Frame Time: 0.0" if "Time" in w else w for w in text.splitlines())
    ),
    "a BVH of words": _file("words.bvh", b"Lorem ipsum dolor sit amet"),
    **{f"an empty {kind}": _file(f"empty{kind}", b"") for kind in KINDS},
    **{f"noise called {kind}": _file(f"noise{kind}", NOISE) for kind in KINDS},
    **{f"half a {kind}": _cut(kind, 0.5) for kind in ("glb", "fbx", "blend")},
    **{f"nearly all of a {kind}": _cut(kind, 0.97) for kind in ("glb", "fbx", "blend")},
}


@pytest.mark.parametrize("make", UNUSABLE.values(), ids=UNUSABLE)
def test_a_file_that_is_no_rig_is_refused_by_name(
    refused: Refused, files: Files, out: Path, tmp_path: Path, make: Callable[[Files, Path], Path]
) -> None:
    path = make(files, tmp_path)
    assert refused("map", path, names=path)
    assert refused("retarget", path, files.tall, "-o", out / "o.blend", "--report", out / "r.json", names=path)
    assert refused("retarget", files.clip("blend"), path, "-o", out / "o.blend", "--report", out / "r.json", names=path)


def _compressed(extension: str) -> dict[str, object]:
    """Return a glTF file whose only mesh is compressed, with data that mean nothing."""
    uri = "data:application/octet-stream;base64," + base64.b64encode(bytes(64)).decode()
    views: list[dict[str, object]] = [{"buffer": 0, "byteLength": 64}]
    position: dict[str, object] = {"componentType": 5126, "count": 3, "type": "VEC3", "min": [0] * 3, "max": [1] * 3}
    primitive: dict[str, object] = {"attributes": {"POSITION": 0}, "indices": 1}
    if extension == "KHR_draco_mesh_compression":
        primitive["extensions"] = {extension: {"bufferView": 0, "attributes": {"POSITION": 0}}}
    else:
        packed = {"buffer": 0, "byteLength": 36, "byteStride": 12, "count": 3, "mode": "ATTRIBUTES"}
        views.append({"buffer": 0, "byteLength": 36, "extensions": {extension: packed}})
        position["bufferView"] = 1
    return {
        "asset": {"version": "2.0"},
        "extensionsUsed": [extension],
        "extensionsRequired": [extension],
        "buffers": [{"byteLength": 64, "uri": uri}],
        "bufferViews": views,
        "accessors": [position, {"componentType": 5123, "count": 3, "type": "SCALAR"}],
        "meshes": [{"primitives": [primitive]}],
        "nodes": [{"mesh": 0}],
        "scenes": [{"nodes": [0]}],
        "scene": 0,
    }


@pytest.mark.parametrize("extension", ["KHR_draco_mesh_compression", "EXT_meshopt_compression"])
def test_a_compressed_file_that_blender_cannot_read_is_refused_in_plain_words(
    refused: Refused, tmp_path: Path, extension: str
) -> None:
    path = tmp_path / "packed.gltf"
    path.write_text(json.dumps(_compressed(extension)))
    message = refused("map", path, names=path)
    if bpy.app.version >= (5, 2) and not bpy.app.binary_path:
        # The wheel comes without the libraries that other builds have.
        assert "compress" in message


# --- armatures that cannot be chosen or used ---


def test_of_several_armatures_one_must_be_chosen(refused: Refused, files: Files, out: Path, tmp_path: Path) -> None:
    scenes.figure("Twin A")
    scenes.figure("Twin B")
    both = scenes.save(tmp_path / "twins.blend")
    for arguments in (
        ["map", both],
        ["retarget", both, files.tall, "-o", out / "o.blend"],
        ["retarget", files.clip("blend"), both, "-o", out / "o.blend"],
    ):
        message = refused(*arguments, names=both)
        assert "--armature" in message
        assert "Twin A" in message
        assert "Twin B" in message


def test_a_rig_of_one_bone_tells_nothing(refused: Refused, files: Files, out: Path, tmp_path: Path) -> None:
    ob = armatures.build("Stick", [Bone("The Only One", None, (0, 0, 0), (0, 0, 1))])
    scenes.key(ob, "Nod", {ob.pose.bones[0].path_from_id("rotation_quaternion"): [[1, 0, 0, 0], [0, 1, 0, 0]]})
    stick = scenes.save(tmp_path / "stick.blend")
    for arguments in (
        ["map", stick],
        ["retarget", stick, files.tall, "-o", out / "o.blend"],
        ["retarget", files.clip("blend"), stick, "-o", out / "o.blend"],
    ):
        message = refused(*arguments, names=stick)
        assert "The Only One" in message


@pytest.mark.parametrize("walks", ["source", "target"])
def test_legs_cannot_walk_on_a_body_without_legs(
    refused: Refused, files: Files, out: Path, tmp_path: Path, walks: str
) -> None:
    bones = [bone for bone in humanoid() if not any(part in bone.name for part in ("Leg", "Foot", "Toes"))]
    ob = armatures.build("Ghost", bones)
    scenes.key(ob, "Nod", {ob.pose.bones["head"].path_from_id("rotation_quaternion"): [[1, 0, 0, 0], [0, 1, 0, 0]]})
    ghost = scenes.save(tmp_path / "ghost.blend")
    pair = [files.clip("blend"), ghost] if walks == "source" else [ghost, files.tall]
    message = refused("retarget", *pair, "-o", out / "o.blend", names=pair[1])
    assert "legs" in message
    assert ("target" if walks == "source" else "source") in message


def test_an_armature_scaled_to_nothing_is_refused(refused: Refused, files: Files, out: Path, tmp_path: Path) -> None:
    scenes.sprout().scale = (0.0, 1.0, 1.0)
    flat = scenes.save(tmp_path / "flat.blend")
    assert "scale" in refused("map", flat, names=flat)
    assert "scale" in refused("retarget", files.clip("blend"), flat, "-o", out / "o.blend", names=flat)


def test_an_armature_placed_by_no_number_is_refused(refused: Refused, tmp_path: Path) -> None:
    scenes.sprout().location = (0.0, float("nan"), 0.0)
    lost = scenes.save(tmp_path / "lost.blend")
    assert "clear its transform" in refused("map", lost, names=lost)


def test_a_bone_that_lies_at_no_number_is_refused_by_name(refused: Refused, tmp_path: Path) -> None:
    armatures.build("Lost", [replace(b, head=(np.nan, 0.0, 0.0)) if b.name == "neck" else b for b in humanoid()])
    lost = scenes.save(tmp_path / "lost.blend")
    assert "'neck'" in refused("map", lost, names=lost)


# --- motions that are none ---


def _no_action(ob: bpy.types.Object) -> None:
    actions.assign(ob, None, None)


def _no_keys(ob: bpy.types.Object) -> None:
    scenes.key(ob, "Nothing", {})


def _other_bones(ob: bpy.types.Object) -> None:
    scenes.key(ob, "Nothing", {'pose.bones["somebody else"].location': [[0, 0, 0], [0, 0, 1]]})


@pytest.mark.parametrize("change", [_no_action, _no_keys, _other_bones])
def test_a_source_must_move(
    refused: Refused, files: Files, out: Path, tmp_path: Path, change: Callable[[bpy.types.Object], None]
) -> None:
    ob = scenes.figure("Statue")
    change(ob)
    statue = scenes.save(tmp_path / "statue.blend")
    message = refused("retarget", statue, files.tall, "-o", out / "o.blend", names=statue)
    assert "Nothing" in message or "Statue" in message


def test_an_action_that_is_not_there_is_refused_with_the_choices(refused: Refused, files: Files, out: Path) -> None:
    for asked in ([f"{files.clips}#Swim", files.tall], [files.clips, files.tall, "--action", "Swim"]):
        message = refused("retarget", *asked, "-o", out / "o.blend", names=files.clips)
        for word in ("Swim", "Stroll", "March"):
            assert word in message


def test_an_action_with_a_value_that_is_no_number_is_refused(
    refused: Refused, files: Files, out: Path, tmp_path: Path
) -> None:
    ob = scenes.walker()
    curve = next(iter(scenes.curves_of(ob).values()))
    curve.keyframe_points[3].co[1] = float("nan")
    broken = scenes.save(tmp_path / "broken.blend")
    assert "Walk" in refused("retarget", broken, files.tall, "-o", out / "o.blend", names=broken)


def test_a_target_is_not_its_own_source(refused: Refused, files: Files, out: Path, tmp_path: Path) -> None:
    clip = files.clip("blend")
    (tmp_path / "link.blend").symlink_to(clip)
    for same in (clip, clip.parent / ".." / clip.parent.name / clip.name, tmp_path / "link.blend"):
        message = refused("retarget", clip, same, "-o", out / "o.blend", names=same)
        assert "same" in message
    refused("retarget", f"{clip}#Walk", clip, "-o", out / "o.blend", names=clip)


def test_an_armature_of_the_open_file_is_not_its_own_source(refused: Refused, out: Path) -> None:
    scenes.walker("Walker")
    scenes.figure("Other")
    assert "same" in refused("retarget", "Walker", "Walker", "-o", out / "o.blend", names="Walker")
    assert "same" in refused("retarget", "Walker", "Other", "Walker", "-o", out / "o.blend", names="Walker")
    assert bpy.data.objects["Other"].animation_data is None


# --- outputs that cannot be written ---


@pytest.mark.parametrize("option", ["-o", "--report"])
@pytest.mark.parametrize(
    "where",
    [
        "missing/o.blend",
        "older.blend/o.blend",
        ".",
        "folder.blend",
        pytest.param("/proc/o.blend", marks=pytest.mark.skipif(not Path("/proc/self").exists(), reason="no /proc")),
    ],
)
def test_a_place_that_cannot_be_written_is_refused_before_any_work(
    refused: Refused, files: Files, out: Path, where: str, option: str
) -> None:
    (out / "folder.blend").mkdir()
    path = out / where
    arguments = ["-o", path] if option == "-o" else ["-o", out / "o.blend", "--report", path]
    assert refused("retarget", files.clip("blend"), files.tall, *arguments, names=path if where != "." else out)


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_without_permission_is_refused(refused: Refused, files: Files, out: Path) -> None:
    closed = out / "closed"
    closed.mkdir(mode=0o500)
    assert refused("retarget", files.clip("blend"), files.tall, "-o", closed / "o.blend", names=closed / "o.blend")


@pytest.mark.parametrize("name", ["o", "o.txt", "o.vrm", "o.gltf", "blend"])
def test_an_unknown_kind_of_output_is_refused_with_the_choices(
    refused: Refused, files: Files, out: Path, name: str
) -> None:
    message = refused("retarget", files.clip("blend"), files.tall, "-o", out / name, names=out / name)
    for kind in (".blend", ".glb", ".fbx", ".bvh"):
        assert kind in message


def test_results_that_would_share_a_file_are_refused(refused: Refused, files: Files, out: Path, tmp_path: Path) -> None:
    pair = [files.sprout, files.tall]
    assert refused("retarget", files.clip("blend"), *pair, "-o", out / "o.bvh", names=out / "o.bvh")
    assert refused("retarget", files.clip("blend"), *pair, "-o", out / "{source}.blend", names="{source}.blend")
    assert refused("retarget", files.clips, files.tall, "--all-actions", "-o", out / "o.glb", names=out / "o.glb")
    twin = tmp_path / files.tall.name
    twin.write_bytes(files.tall.read_bytes())
    template = out / "{target}.blend"
    assert refused("retarget", files.clip("blend"), files.tall, twin, "-o", template, names=out / "tall.blend")


@pytest.mark.parametrize("template", ["both.blend", "{target}.blend", "{target}.glb"])
@pytest.mark.parametrize("second", ["cut", "boneless", "legless"])
def test_when_one_of_several_targets_fails_nothing_is_written(
    refused: Refused, files: Files, out: Path, tmp_path: Path, template: str, second: str
) -> None:
    if second == "cut":
        bad = _cut("glb", 0.5)(files, tmp_path)
    else:
        bones = [bone for bone in humanoid() if "Leg" not in bone.name and "Foot" not in bone.name]
        armatures.build("Bad", [] if second == "boneless" else [b for b in bones if "Toes" not in b.name])
        bad = scenes.save(tmp_path / "bad.blend")
    (out / "sprout.blend").write_text("an older result")
    arguments = [files.clip("blend"), files.sprout, bad, files.tall, "-o", out / template, "--report", out / "r.json"]
    assert refused("retarget", *arguments, names=bad)


def test_a_failure_leaves_the_open_file_without_half_an_action(refused: Refused, files: Files, out: Path) -> None:
    ob = scenes.figure("Rootless")
    scenes.key(ob, "Old", {ob.pose.bones["head"].path_from_id("location"): [[0, 0, 0], [0, 0, 1]]})
    before = {action.name for action in bpy.data.actions}
    arguments = [files.clip("glb"), "Rootless", "-o", out / "o.blend", "--root", "root"]
    refused("retarget", *arguments, names="Rootless")
    assert {action.name for action in bpy.data.actions} == before
    assert ob.animation_data.action.name == "Old"
    assert [o.name for o in bpy.data.objects] == ["Rootless"]
