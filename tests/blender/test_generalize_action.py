"""Generalize Action: captured motions become generalized actions that bodies of any shape play."""

from collections.abc import Iterator
from pathlib import Path

import bpy
import numpy as np
import pytest

from morph_retarget.blender import actions, presets, retarget
from morph_retarget.blender.io import load
from morph_retarget.blender.io.load import Request
from morph_retarget.blender.morph import capture, cast, channel_presets, definitions, keys
from morph_retarget.blender.morph.capture import Options, Outcome
from morph_retarget.blender.morph.properties import of_action
from morph_retarget.core.arrays import Array
from morph_retarget.core.errors import FileError, MotionError
from morph_retarget.core.morph.capture import CaptureSettings
from tests.blender import acting, scenes, window
from tests.blender.imported import Imported

ops = bpy.ops.morph_retarget
WAVE = "fair1_wave_hello.bvh"
RAISED = (380.0, 620.0)
"""Frames between which the right arm of the wave is up."""


@pytest.fixture(autouse=True)
def _registered(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    with window.registered():
        monkeypatch.setattr(presets, "_folder", [tmp_path])
        yield


def _generalized(ob: bpy.types.Object, options: Options | None = None) -> Outcome:
    action, slot = actions.assigned(ob)
    steps = capture.generalize(
        ob, action, slot, bpy.context.scene, channel_presets.load(channel_presets.BIPED), options
    )
    return retarget.run(steps)


def _mocap(imported: Imported, data: Path, name: str) -> bpy.types.Object:
    return imported.open(data / "mocap" / name)[0]


def _played(data: Path, action: bpy.types.Action, rig: str, bones: list[str]) -> Array:
    """Return where bones of a real character are over an action, shape (frame, bone, 3), in its own space."""
    ob = load.add(Request(data / "rigs" / rig))[0]
    cast.add(ob, action)
    (outcome,) = acting.baked(ob)
    assert np.isfinite(outcome.take.played.basis).all()
    assert outcome.report["ground_penetration_m"]["max"] < 0.15 * outcome.take.member.bodies.size
    return outcome.take.played.pose.positions[:, [outcome.take.member.bodies.names.index(b) for b in bones]]


# --- on the performer ---


def test_a_generalized_walk_plays_on_its_performer_as_it_was_captured() -> None:
    ann = scenes.walker("Ann")
    bones = [s + j for s in ("left", "right") for j in ("Foot", "Hand")]
    before = scenes.heads(ann, bones, scenes.SHOWN)
    outcome = _generalized(ann, Options(CaptureSettings(in_place=False)))
    assert ann.animation_data.action.name == "Walk", "the captured action still plays"
    cast.add(ann, outcome.action)
    assert scenes.apart(scenes.heads(ann, bones, scenes.SHOWN), before) < 0.03


def test_the_new_action_has_the_channels_of_the_preset_and_a_key_on_every_frame() -> None:
    ann = scenes.walker("Ann")
    outcome = _generalized(ann)
    made = outcome.action
    assert made.name == "Walk generalized"
    assert made.use_fake_user
    names = [item.name for item in of_action(made).channels]
    assert names[:6] == ["Root", "Chest", "Head", "Mouth", "Left feet", "Right feet"]
    found = keys.curves(made)
    assert (keys.path("Left feet", "position"), 2) in found
    assert (keys.path("Head", "rotation"), 3) in found
    assert (keys.path("Head", "position"), 0) not in found, "its position counts for nothing"
    assert not any("Mouth" in path for path, _ in found)
    for curve in found.values():
        assert len(curve.keyframe_points) == scenes.COUNT
    for channel in names:
        quaternion = [found.get((keys.path(channel, "rotation"), i)) for i in range(4)]
        if all(quaternion):
            values = np.array([actions.sample(c, np.arange(1.0, scenes.COUNT + 1.0)) for c in quaternion]).T
            assert (np.sum(values[1:] * values[:-1], axis=-1) > 0.0).all(), "neighbours never jump to the antipode"
    assert definitions.read(made).channels == outcome.captured.channels


def test_way_that_was_left_out_is_told() -> None:
    ann = scenes.walker("Ann", seconds=6.0)
    (warning,) = [text for text in _generalized(ann).warnings if "in place" in text]
    assert "m of way" in warning


# --- real motions on unlike bodies ---


@pytest.mark.parametrize(
    ("rig", "hands", "higher"),
    [
        ("quaternius_modular_man.glb", ["Hand.R", "Hand.L"], 0.3),
        ("m2m_kaiju_anim.glb", ["Hand_R", "Hand_L"], 0.2),
        ("m2m_bird_anim.glb", ["wing_tip_R", "wing_tip_L"], 0.2),
    ],
)
def test_a_captured_wave_raises_the_right_hand_or_wing_and_not_the_left(
    data: Path, imported: Imported, rig: str, hands: list[str], higher: float
) -> None:
    outcome = _generalized(_mocap(imported, data, WAVE))
    places = _played(data, outcome.action, rig, hands)
    frames = np.arange(len(places)) + 1.0
    up = (frames > RAISED[0]) & (frames < RAISED[1])
    over = places[up, 0, 2] - places[up, 1, 2]
    reach = np.ptp(places[..., 2])
    assert over.max() > higher * reach
    assert over.max() > -2.0 * over.min(), "it is the right one that is raised"


@pytest.mark.parametrize("rig", ["m2m_spider_anim.glb", "quaternius_wolf.glb", "m2m_snake_anim.glb"])
def test_bodies_without_hands_take_part_in_a_dance_and_stay_whole(data: Path, imported: Imported, rig: str) -> None:
    outcome = _generalized(_mocap(imported, data, "rokoko_jesse_dance.bvh"), Options(frames=(1, 120)))
    ob = load.add(Request(data / "rigs" / rig))[0]
    cast.add(ob, outcome.action)
    (made,) = acting.baked(ob)
    rest, bodies = made.take.member.bodies.positions, made.take.member.bodies
    away = np.linalg.norm(made.take.played.pose.positions - rest, axis=-1)
    assert 0.05 * bodies.size < away.max() < bodies.size
    lengths = np.linalg.norm(np.diff(made.take.played.pose.positions, axis=0), axis=-1)
    assert lengths.max() < 0.2 * bodies.size, "nothing jumps from frame to frame"


def test_a_clip_that_stands_nowhere_and_faces_anywhere_is_captured_all_the_same(data: Path, imported: Imported) -> None:
    ob = _mocap(imported, data, WAVE)
    here = _generalized(ob, Options(frames=(1, 60))).captured.values
    ob.location, ob.rotation_euler = (300.0, -100.0, 20.0), (0.0, 0.0, 1.0)
    bpy.context.view_layer.update()
    there = _generalized(ob, Options(frames=(1, 60))).captured.values
    assert np.abs(here.positions - there.positions).max() < 1e-4


# --- errors ---


def test_what_is_generalized_already_or_moves_nothing_is_refused() -> None:
    ann = scenes.figure("Ann")
    made = acting.dip(ann)
    with pytest.raises(MotionError, match="'Dip' is generalized already"):
        _generalized(ann)
    actions.assign(ann, None, None)
    with pytest.raises(RuntimeError, match="plays no action"):
        ops.generalize_action(character="Ann")
    with pytest.raises(RuntimeError, match="no action 'Run'"):
        ops.generalize_action(character="Ann", action="Run")
    with pytest.raises(RuntimeError, match="no armature 'Bob'"):
        ops.generalize_action(character="Bob")
    assert [action.name for action in bpy.data.actions] == [made.name]


# --- buttons and presets ---


def test_the_button_makes_the_action() -> None:
    ann = scenes.walker("Ann")
    bpy.context.view_layer.objects.active = ann
    assert ops.generalize_action() == {"FINISHED"}
    assert definitions.is_generalized(bpy.data.actions["Walk generalized"])
    bob = acting.creature("beetle")
    cast.add(bob, bpy.data.actions["Walk generalized"])
    assert acting.apart(acting.shown(bob, [1]), acting.shown(bob, [12])) > 0.02


def test_the_preset_can_be_changed_kept_and_used() -> None:
    ann = scenes.walker("Ann")
    made = acting.action("Mine", channel_presets.load(channel_presets.BIPED)[4:6])
    of_action(made).channels["Left feet"].name = "Hooves"
    assert channel_presets.names() == ["Biped Mocap"]
    ops.save_channels(action="Mine", name="Hooved")
    assert channel_presets.names() == ["Biped Mocap", "Hooved"]
    assert channel_presets.load("Hooved") == definitions.read(made).channels
    ops.generalize_action(character="Ann", preset="Hooved")
    found = bpy.data.actions["Walk generalized"]
    assert [item.name for item in of_action(found).channels] == ["Hooves", "Right feet"]
    ops.delete_channels(name="Hooved")
    assert channel_presets.names() == ["Biped Mocap"]
    cast.add(ann, made)


def test_a_preset_of_ones_own_takes_the_place_of_the_one_that_comes_along() -> None:
    made = acting.action("Mine", [acting.HANDS])
    channel_presets.save(made, channel_presets.BIPED)
    assert channel_presets.names() == [channel_presets.BIPED]
    assert channel_presets.load(channel_presets.BIPED) == (acting.HANDS,)
    channel_presets.delete(channel_presets.BIPED)
    assert len(channel_presets.load(channel_presets.BIPED)) > 5
    with pytest.raises(FileError, match="your own"):
        channel_presets.delete(channel_presets.BIPED)


def test_channels_of_a_preset_are_added_to_an_action_and_its_own_stay() -> None:
    ann = scenes.figure("Ann")
    made = acting.action("Mine", [acting.HANDS])
    acting.play(made, ann)
    ops.load_channels(action="Mine", name=channel_presets.BIPED)
    ops.load_channels(action="Mine", name=channel_presets.BIPED)
    names = [item.name for item in of_action(made).channels]
    assert names[:2] == ["Hands", "Root"]
    assert len(names) == len(set(names)) == len(channel_presets.load(channel_presets.BIPED)) + 1
    assert {c.name for c in ann.morph_retarget.channels} == set(names)


@pytest.mark.parametrize(("name", "words"), [("None", "there is no preset"), ("", "there is no preset")])
def test_a_preset_that_is_not_there_is_refused(name: str, words: str) -> None:
    acting.action("Mine", [acting.HANDS])
    with pytest.raises(RuntimeError, match=words):
        ops.load_channels(action="Mine", name=name)
    with pytest.raises(RuntimeError, match="preset name"):
        ops.save_channels(action="Mine", name="a/b")


def test_a_broken_preset_is_refused_by_name(tmp_path: Path) -> None:
    acting.action("Mine", [acting.HANDS])
    folder = tmp_path / channel_presets.KIND
    folder.mkdir()
    (folder / "Broken.json").write_text("{")
    with pytest.raises(RuntimeError, match=r"Broken\.json: line 1 is no JSON"):
        ops.load_channels(action="Mine", name="Broken")
