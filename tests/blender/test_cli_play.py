"""`play`: generalized actions from files onto characters in files, all outputs or none."""

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np
import pytest

from morph_retarget.blender.cli import data as extension
from morph_retarget.blender.io.load import Request, load
from morph_retarget.blender.morph import cast, definitions
from morph_retarget.blender.properties import of_rig
from morph_retarget.core.morph.branch import Answer
from tests.blender import acting, results, scenes, window
from tests.blender.acting import FEET, REACH
from tests.blender.command import Command, Refused, contents

ROOT = Path(__file__).resolve().parents[2]


@dataclass(frozen=True)
class Stage:
    """Files to play with."""

    actions: Path
    """Holds "Dip" with the event "low" at 11, "Kick" for characters with feet, "Pick", and "Plain", an ordinary one;
    25 frames a second; an object "Apple"."""
    one: Path
    """Holds one generalized action, and one that is not."""
    hound: Path
    snake: Path
    pair: Path
    """A .blend at 50 frames a second with the armatures "Ann" and "Bob"."""


@pytest.fixture(scope="session")
def stage(tmp_path_factory: pytest.TempPathFactory) -> Stage:
    folder = tmp_path_factory.mktemp("stage")
    with extension.known():
        scenes.empty(25)
        ann = scenes.figure("Ann")
        acting.dip(ann).pose_markers.new("low").frame = 11
        scenes.save(folder / "one.blend")
        kick = acting.action("Kick", [FEET])
        kick.morph_retarget.has_feet = Answer.TRUE
        acting.play(kick, ann, keyed={"Feet": {1: (0, 0, 0), 5: (0, -0.2, 0.2)}})
        acting.play(acting.action("Pick", [REACH]), ann, keyed={"Reach": {1: (0, 0, 0), 11: (1, 0, 0)}})
        bpy.data.actions.new("Plain").use_fake_user = True
        scenes.empty_object("Apple").location = (-0.4, -0.3, 1.5)
        scenes.save(folder / "actions.blend")
        for kind in ("hound", "snake"):
            scenes.empty()
            acting.creature(kind)
            scenes.save(folder / f"{kind}.blend")
        scenes.empty(50)
        scenes.figure("Ann")
        scenes.figure("Bob", height=1.2)
        scenes.save(folder / "pair.blend")
        cast.forget(rig=True)
    files = ("actions", "one", "hound", "snake", "pair")
    return Stage(*(folder / f"{name}.blend" for name in files))


@pytest.fixture
def known() -> Iterator[None]:
    with extension.known():
        yield
        cast.forget(rig=True)


def _report(path: Path) -> list[dict[str, object]]:
    return json.loads(path.read_text(encoding="utf-8"))


def test_help_has_examples(cli: Command) -> None:
    said = cli("play", "--help")
    assert (said.status, said.errors) == (0, [])
    assert "morph_retarget play " in said.out.partition("examples:")[2]


# --- results ---


@pytest.mark.parametrize("kind", ["blend", "glb", "fbx", "bvh"])
def test_an_action_is_baked_into_files_of_every_kind(
    cli: Command, stage: Stage, tall_glb: Path, out: Path, kind: str
) -> None:
    made = out / f"tall_Dip.{kind}"
    said = cli("play", f"{stage.actions}#Dip", tall_glb, "-o", out / ("{target}_{action}." + kind))
    assert (said.status, said.out, said.errors) == (0, "", [])
    assert list(contents(out)) == [made.name]
    ob = results.reload(made)
    assert ob.animation_data.action is not None
    assert scenes.seconds_of(ob) == pytest.approx(20.0 / 25.0, abs=0.02)
    places = scenes.heads(ob, ["leftHand"], scenes.over_action(ob, 3))
    assert places[1, 0, 2] < places[0, 0, 2] - 0.1
    assert places[2, 0, 2] == pytest.approx(places[0, 0, 2], abs=1e-3)


@pytest.fixture
def tall_glb(files: object) -> Path:
    return files.tall_glb


def test_several_characters_share_a_blend_with_what_they_play(
    cli: Command, stage: Stage, tall_glb: Path, out: Path
) -> None:
    said = cli("play", stage.actions, stage.hound, tall_glb, "-o", out / "all.blend")
    assert said.status == 2, "which of three actions is meant is not said"
    said = cli(
        "play", f"{stage.actions}#Kick", stage.hound, tall_glb, "-o", out / "all.blend", "--report", out / "r.json"
    )
    assert said.status == 0
    assert set(contents(out)) == {"all.blend", "r.json"}
    load(Request(out / "all.blend"))
    playing = {ob.name: ob.animation_data.action.name for ob in bpy.data.objects if ob.type == "ARMATURE"}
    assert playing == {"Hound": "Kick on Hound", "Tall": "Kick on Tall"}
    assert bpy.data.actions["Kick"].use_fake_user
    first, second = _report(out / "r.json")
    assert first["source"] == f"{stage.actions}#Kick"
    assert (first["target"], second["target"]) == (str(stage.hound), str(tall_glb))
    assert len(first["channels"]["Feet"]["bodies"]) == 4
    assert len(second["channels"]["Feet"]["bodies"]) == 2


@pytest.mark.usefixtures("known")
def test_live_keeps_the_generalized_action_on_all_of_them(
    cli: Command, stage: Stage, tall_glb: Path, out: Path
) -> None:
    said = cli("play", stage.one, stage.hound, tall_glb, "-o", out / "live.blend", "--live")
    assert said.status == 0
    load(Request(out / "live.blend"))
    found = cast.performers(bpy.context.scene)
    assert {ob.name for ob in found} == {"Hound", "Tall"}
    assert len({ob.animation_data.action for ob in found}) == 1
    assert [c.name for c in definitions.read(found[0].animation_data.action).channels] == ["Hands"]
    assert found[0].animation_data.action_slot == found[1].animation_data.action_slot
    outcome = acting.baked(*found)
    assert all(one.take.binds for one in outcome if one.take.member.rig.name == "Tall")


def test_the_report_has_the_documented_keys(cli: Command, stage: Stage, tall_glb: Path, out: Path) -> None:
    cli("play", stage.one, tall_glb, "-o", out / "x.glb", "--report", out / "r.json")
    (report,) = _report(out / "r.json")
    assert list(report) == [
        "source", "target", "frames", "seconds_per_stage", "channels", "variant", "variants", "ground_penetration_m",
        "events", "problems", "warnings",
    ]  # fmt: skip
    assert report["frames"] == 21
    assert report["events"] == [{"name": "low", "frame": 11.0}]
    assert report["problems"] == []


# --- choices ---


def test_frames_and_rate_can_be_chosen(cli: Command, stage: Stage, tall_glb: Path, out: Path) -> None:
    said = cli(
        "play",
        stage.one,
        tall_glb,
        "-o",
        out / "x.blend",
        "--frames",
        "5:11",
        "--fps",
        "50",
        "--report",
        out / "r.json",
    )
    assert said.status == 0
    (report,) = _report(out / "r.json")
    assert report["frames"] == 13
    ob = results.reload(out / "x.blend")
    scene = bpy.context.scene
    assert scene.render.fps / scene.render.fps_base == 50.0
    assert list(ob.animation_data.action.frame_range) == [5.0, 17.0]
    assert (scene.frame_start, scene.frame_end) == (5, 17)


def test_a_scene_keeps_its_frame_rate_and_the_action_its_duration(cli: Command, stage: Stage, out: Path) -> None:
    said = cli("play", stage.one, stage.pair, "--armature", "Bob", "-o", out / "x.blend")
    assert said.status == 0
    load(Request(out / "x.blend"))
    ob = bpy.data.objects["Bob"]
    assert scenes.seconds_of(ob) == pytest.approx(20.0 / 25.0)
    assert bpy.context.scene.render.fps == 50


@pytest.mark.parametrize(("wanted", "hand"), [("0", 0), ("1", 1), ("nearest", None)])
def test_the_variant_is_chosen_by_number_or_by_its_target(
    cli: Command, stage: Stage, tall_glb: Path, out: Path, wanted: str, hand: int | None
) -> None:
    said = cli(
        "play", f"{stage.actions}#Pick", tall_glb, "-o", out / "x.blend", "--report", out / "r.json",
        "--target", "Reach=Apple", "--variant", wanted,
    )  # fmt: skip
    assert (said.status, said.errors) == (0, [])
    (report,) = _report(out / "r.json")
    assert report["variants"] == 2
    (body,) = report["channels"]["Reach"]["bodies"]
    assert hand is None or report["variant"] == hand
    if hand is None:
        assert body == "rightHand", "the apple of the action's file is on the right"
    ob = results.reload(out / "x.blend")
    apple = bpy.data.objects["Apple"].matrix_world.translation
    place = scenes.heads(ob, [body], [11])[0, 0]
    assert (apple - apple.__class__(place)).length < (0.6 if body == "leftHand" else 0.01)


def test_a_bone_of_another_character_can_be_the_target(cli: Command, stage: Stage, out: Path) -> None:
    load(Request(stage.pair))
    said = cli("play", f"{stage.actions}#Pick", "Ann", "-o", out / "x.blend", "--target", "Reach=Bob:head")
    assert said.status == 0
    load(Request(out / "x.blend"))
    ann, bob = bpy.data.objects["Ann"], bpy.data.objects["Bob"]
    head = scenes.heads(bob, ["head"], [11])[0, 0]
    assert acting.apart(scenes.heads(ann, ["leftHand"], [11])[0, 0], head) < 0.6


def test_actions_and_characters_of_the_open_file(cli: Command, stage: Stage, tall_glb: Path, out: Path) -> None:
    with window.registered():
        for path in (stage.one, None):
            load(Request(stage.one if path else stage.actions))
            said = cli("play", "Dip", "Ann", "-o", out / "a.blend")
            assert (said.status, said.errors) == (0, [])
            assert bpy.data.objects["Ann"].animation_data.action.name.startswith("Dip on Ann")
        said = cli("play", "Dip", tall_glb, "-o", out / "b.glb")
        assert (said.status, said.errors) == (0, [])
    assert set(contents(out)) == {"a.blend", "b.glb"}


def test_an_action_in_the_character_s_own_file(cli: Command, stage: Stage, out: Path) -> None:
    said = cli("play", f"{stage.actions}#Dip", stage.actions, "-o", out / "x.blend")
    assert (said.status, said.errors) == (0, [])
    load(Request(out / "x.blend"))
    assert {"Dip", "Dip on Ann"} <= set(bpy.data.actions.keys())
    assert "Dip.001" not in bpy.data.actions


# --- what does not fit ---


def test_a_character_that_does_not_fit_is_a_warning(cli: Command, stage: Stage, tall_glb: Path, out: Path) -> None:
    template = out / "{target}.glb"
    said = cli("play", f"{stage.actions}#Kick", stage.snake, tall_glb, "-o", template, "--report", out / "r.json")
    assert said.status == 0
    (warning,) = said.errors
    assert warning.startswith("morph_retarget: warning: ")
    assert "snake" in warning
    assert "lacks feet" in warning
    assert set(contents(out)) == {"snake.glb", "tall.glb", "r.json"}
    first, second = _report(out / "r.json")
    assert "lacks feet" in first["problems"][0]
    assert second["problems"] == []


def test_when_nothing_plays_on_anybody_only_the_report_is_written(cli: Command, stage: Stage, out: Path) -> None:
    said = cli("play", f"{stage.actions}#Kick", stage.snake, "-o", out / "x.glb", "--report", out / "r.json")
    assert said.status == 1
    assert "lacks feet" in said.errors[0]
    assert "plays on none of the characters" in said.errors[1]
    assert list(contents(out)) == ["r.json"]


def test_a_channel_without_its_target_is_a_warning(cli: Command, stage: Stage, tall_glb: Path, out: Path) -> None:
    said = cli("play", f"{stage.actions}#Pick", tall_glb, "-o", out / "x.glb")
    assert said.status == 1
    assert "'Reach' has no target" in said.errors[0]
    assert contents(out) == {}


@pytest.mark.parametrize(
    ("action", "words"),
    [
        ("{actions}#Jump", ("has no action 'Jump'", "Dip, Kick, Pick")),
        ("{actions}#Plain", ("'Plain' is not generalized", "Dip, Kick, Pick")),
        ("{actions}", ("holds 3 generalized actions", "Dip, Kick, Pick", "FILE#ACTION")),
        ("{hound}", ("holds no generalized action",)),
        ("{folder}/none.blend#Dip", ("no such file",)),
        ("{folder}/broken.blend#Dip", ("is no blend file",)),
        ("{folder}/walk.bvh", ("only .blend files do",)),
        ("Dip", ("has no action 'Dip'", "holds no generalized action")),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_an_action_that_cannot_be_meant_is_refused(
    refused: Refused, stage: Stage, tall_glb: Path, out: Path, tmp_path: Path, action: str, words: tuple[str, ...]
) -> None:
    (tmp_path / "broken.blend").write_bytes(b"BLENDER" + bytes(200))
    (tmp_path / "walk.bvh").write_text("HIERARCHY")
    text = action.format(actions=stage.actions, hound=stage.hound, folder=tmp_path)
    message = refused(
        "play", text, tall_glb, "-o", out / "x.glb", names=text.partition("#")[0] if "/" in text else text
    )
    for word in words:
        assert word in message


def test_an_action_of_a_newer_version_is_refused(
    refused: Refused, stage: Stage, tall_glb: Path, out: Path, tmp_path: Path
) -> None:
    with extension.known():
        load(Request(stage.one))
        bpy.data.actions["Dip"].morph_retarget.version = 99
        newer = scenes.save(tmp_path / "newer.blend")
    message = refused("play", f"{newer}#Dip", tall_glb, "-o", out / "x.glb", names=newer)
    assert "newer version" in message


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--target", "Reach"], "CHANNEL=OBJECT"),
        (["--variant", "left"], "nearest"),
        (["--target", "Grab=Apple"], "Reach"),
        (["--target", "Reach=Pear"], "no object 'Pear'"),
        (["--target", "Reach=Apple:core"], "no bone 'core'"),
        (["--live"], ".blend"),
        (["--frames", "9:1"], "ends before"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_choices_that_cannot_be_meant_are_refused(
    cli: Command, stage: Stage, tall_glb: Path, out: Path, options: list[str], words: str
) -> None:
    said = cli("play", f"{stage.actions}#Pick", tall_glb, "-o", out / "x.glb", *options)
    assert said.status == 2
    assert len(said.errors) == 1
    assert words in said.errors[0]
    assert contents(out) == {}


def test_a_character_that_cannot_be_read_is_refused(refused: Refused, stage: Stage, out: Path, tmp_path: Path) -> None:
    scenes.empty_object("Nobody")
    nobody = scenes.save(tmp_path / "nobody.blend")
    assert "no armature" in refused("play", stage.one, nobody, "-o", out / "x.glb", names=nobody)
    refused("play", stage.one, tmp_path / "gone.glb", "-o", out / "x.glb", names="gone.glb")
    message = refused("play", stage.one, stage.pair, "-o", out / "x.glb", names=stage.pair)
    assert "--armature" in message


def test_deforms_come_with_the_action(cli: Command, out: Path, tmp_path: Path) -> None:
    with extension.known():
        ann = scenes.figure("Ann")
        made = acting.dip(ann)
        of_rig(ann).channels["Hands"].deforms.add().name = "open"
        bag = acting.keys.bag_of(made)
        curve = bag.fcurves.new(acting.keys.deform_path("Hands", "open"))
        curve.keyframe_points.insert(1, 0.0)
        curve.keyframe_points.insert(21, 1.0)
        source = scenes.save(tmp_path / "open.blend")
        scenes.empty()
        scenes.figure("Bob")["open"] = 0.0
        bob = scenes.save(tmp_path / "bob.blend")
        cast.forget(rig=True)
    said = cli("play", source, bob, "-o", out / "x.blend")
    assert (said.status, said.errors) == (0, [])
    ob = results.reload(out / "x.blend")
    bpy.context.scene.frame_set(21)
    assert ob["open"] == pytest.approx(1.0)


def _module(folder: Path, *arguments: object) -> subprocess.CompletedProcess[str]:
    """Run the module in a process of its own, where the extension is not switched on."""
    return subprocess.run(
        [sys.executable, "-m", "morph_retarget", *map(str, arguments)],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )


def test_the_module_plays_without_the_extension(stage: Stage, tall_glb: Path, tmp_path: Path) -> None:
    made = _module(tmp_path, "play", stage.one, tall_glb, "-o", "x.glb")
    assert (made.returncode, made.stdout, made.stderr) == (0, "", "")
    assert (tmp_path / "x.glb").stat().st_size > 1000
    assert not hasattr(bpy.types.Action, "morph_retarget"), "nothing is left registered here either"


def test_the_module_plays_scripts_without_the_extension_until_all_is_done(stage: Stage, tmp_path: Path) -> None:
    script = tmp_path / "script.toml"
    lines = ("0.0 start walk", "0.5 start jump", "1.0 stop walk", "1.2 start bow")
    script.write_text("\n".join(f'[[command]]\ndo = "{line}"' for line in lines))
    made = _module(tmp_path, "play", script, stage.hound, "-o", "x.blend", "--report", "r.json")
    assert (made.returncode, made.stdout) == (0, "")
    (report,) = _report(tmp_path / "r.json")
    assert [warning.partition(": ")[2].split(" for ")[1] for warning in report["warnings"]] == [
        "walk to end",
        "jump to end",
    ]
    ob = results.reload(tmp_path / "x.blend")
    seconds = scenes.seconds_of(ob)
    assert seconds > 1.2 + 3.0, "the clip lasts until what had to wait is over"
    last = seconds * bpy.context.scene.render.fps
    poses = scenes.heads(ob, ob.pose.bones.keys(), [last - 2.0, last])
    assert np.abs(poses[1] - poses[0]).max() < 0.01, "and it stands"
