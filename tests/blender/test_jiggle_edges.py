"""Where users meet jiggles besides poses: the panel, the first play of an action, and the command line."""

from pathlib import Path

import bpy
import numpy as np
import pytest

from morph_retarget.blender import actions
from morph_retarget.blender.cli import data as extension
from morph_retarget.blender.io.load import Request, load
from morph_retarget.blender.morph import cast
from morph_retarget.blender.properties import of_rig
from morph_retarget.blender.ui import jiggle_panel
from tests.blender import acting, scenes
from tests.blender.command import Command
from tests.blender.layouts import drawn

PANELS = (jiggle_panel.MORPHRETARGET_PT_jiggles, jiggle_panel.MORPHRETARGET_PT_jiggle_parts)
ops = bpy.ops.morph_retarget


# --- the window ---


@pytest.mark.usefixtures("registered")
def test_who_plays_for_the_first_time_jiggles_and_others_keep_what_they_have() -> None:
    hound = acting.creature("hound")
    assert not of_rig(hound).jiggles.enabled
    ops.new_action(name="One", character="Hound")
    assert of_rig(hound).jiggles.enabled
    of_rig(hound).jiggles.enabled = False
    ops.new_action(name="Two", character="Hound")
    assert not of_rig(hound).jiggles.enabled


@pytest.mark.usefixtures("registered")
def test_the_panel_has_few_knobs_and_a_button_for_ordinary_actions() -> None:
    hound = acting.creature("hound")
    bpy.context.view_layer.objects.active = hound
    plain = drawn(*PANELS)
    knobs = ["amount", "half_life", "stiffness", "gravity", "ground", "loop"]
    assert [name for name, _ in plain.props] == knobs
    assert [b.kind.identifier for b in plain.buttons][:1] == ["MORPH_RETARGET_OT_bake_jiggles"]
    ops.new_action(name="One", character="Hound")
    of_rig(hound).jiggles.enabled = False
    playing = drawn(*PANELS)
    assert not any(active for _, active in playing.props)
    assert "MORPH_RETARGET_OT_bake_jiggles" not in [b.kind.identifier for b in playing.buttons]
    ops.add_jiggle_settings(kind="ear")
    shown = drawn(*PANELS)
    assert "Ear" in shown.texts
    assert [name for name, _ in shown.props][6:] == ["amount", "half_life", "stiffness"]


@pytest.mark.usefixtures("registered")
def test_settings_of_a_kind_begin_as_the_kind_was() -> None:
    hound = acting.creature("hound")
    bpy.context.view_layer.objects.active = hound
    own = of_rig(hound).jiggles
    before = own.settings()
    ops.add_jiggle_settings(kind="ear")
    ops.add_jiggle_settings(kind="ear")
    assert len(own.overrides) == 1
    assert own.overrides[0].half_life == pytest.approx(0.5 * before.half_life)
    own.active_override = 7
    with pytest.raises(RuntimeError, match="no such settings"):
        ops.remove_jiggle_settings()


# --- the command line ---


@pytest.fixture
def stage(tmp_path: Path) -> Path:
    """Return a folder with an action and a hound, both saved before anything jiggled."""
    with extension.known():
        scenes.empty(25)
        acting.dip(scenes.figure("Ann"))
        scenes.save(tmp_path / "one.blend")
        scenes.empty(25)
        acting.creature("hound")
        scenes.save(tmp_path / "hound.blend")
        cast.forget(rig=True)
    return tmp_path


@pytest.mark.parametrize(("option", "jiggles"), [((), True), (("--jiggles",), True), (("--no-jiggles",), False)])
def test_play_includes_jiggles_unless_they_are_switched_off(
    cli: Command, stage: Path, out: Path, option: tuple[str, ...], jiggles: bool
) -> None:
    made = out / "hound.blend"
    said = cli("play", stage / "one.blend", stage / "hound.blend", "-o", made, *option)
    assert (said.status, said.errors) == (0, [])
    load(Request(made))
    ob = scenes.only_armature()
    paths = {path for path, _ in actions.curves(*actions.assigned(ob))}
    assert any("Ear.L" in path for path in paths) == jiggles


def test_the_rate_of_a_result_does_not_change_how_it_jiggles(cli: Command, stage: Path, out: Path) -> None:
    tails = []
    for fps in (25, 50):
        made = out / f"{fps}.blend"
        cli("play", stage / "one.blend", stage / "hound.blend", "-o", made, "--fps", fps, "--jiggles")
        load(Request(made))
        ob = scenes.only_armature()
        first = ob.animation_data.action.frame_range[0]
        frames = [first + time * fps for time in np.arange(5) * 0.16]
        tails.append(scenes.heads(ob, ["Ear.L", "Ear.R", "Tail.005"], frames))
    assert np.abs(tails[0] - tails[1]).max() < 0.005
