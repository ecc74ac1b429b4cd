"""The panels of directing: what they show, and that showing changes nothing."""

from pathlib import Path
from types import SimpleNamespace

import bpy
import pytest

from morph_retarget.blender.morph import analyses
from morph_retarget.blender.operators import directing as operators
from morph_retarget.blender.ui import directing_panel, motion_tree
from morph_retarget.core.clips.motions import library_file
from morph_retarget.core.directing import starter
from tests.blender import acts, directed, window
from tests.blender.directed import own
from tests.blender.layouts import Layout, drawn

ops = bpy.ops.morph_retarget
PANELS = [directing_panel.MORPHRETARGET_PT_directing, motion_tree.MORPHRETARGET_PT_motion_tree]
MENUS = [
    directing_panel.MORPHRETARGET_MT_add_command,
    directing_panel.MORPHRETARGET_MT_add_parameter,
    directing_panel.MORPHRETARGET_MT_commands,
]

pytestmark = pytest.mark.usefixtures("registered")


@pytest.fixture
def ob() -> bpy.types.Object:
    """Return a creature that is the active object and does what it is told."""
    return directed.biped()


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Return the file of a small library for that creature."""
    with window.registered():
        _, character, _ = analyses.of(acts.creature("biped"))
        path = tmp_path_factory.mktemp("library") / "small.npz"
        library_file.save(starter.starter(character, ["idle", "walk", "run"]), path)
    return str(path)


def _operators(layout: Layout) -> list[str]:
    return [button.kind.identifier.removeprefix("MORPH_RETARGET_OT_") for button in layout.buttons]


def test_without_directing_the_panel_offers_it() -> None:
    assert not drawn(*PANELS).buttons
    acts.creature("biped")
    found = drawn(*PANELS)
    assert _operators(found) == ["direct"]


def test_the_panel_lists_commands_and_what_is_said_about_the_active_one(ob: bpy.types.Object) -> None:
    ball = acts.empty_object("Ball", (0, 0, 1))
    bpy.context.view_layer.objects.active = ob
    own(ob).command(60, "stop", "walk")
    own(ob).command(10, "start", "gaze", target=ball, odd=(1, 2, 3), also="x", on=True, by=ob.pose.bones["Head"])
    found = drawn(*PANELS)
    assert "gaze  target Ball, odd (1, 2, 3), also x, on yes, by Biped : Head" in found.texts
    assert {"PLAY", "PAUSE"} <= set(found.icons)
    shown = [name for name, _ in found.props]
    assert shown.count("frame") == 1
    assert [text for text in found.texts if text.isdigit()] == ["60", "10"]
    assert {"target", "place", "text", "switch", "target_bone", "kind", "obstacles"} <= set(shown)


def test_a_list_is_shown_in_order_of_time_and_can_be_searched(ob: bpy.types.Object) -> None:
    for frame, model in ((30, "walk"), (10, "run"), (20, "walk")):
        own(ob).command(frame, "start", model)
    bits = SimpleNamespace(filter_name="", bitflag_filter_item=4)
    arrange = directing_panel.MORPHRETARGET_UL_commands.filter_items
    flags, places = arrange(bits, bpy.context, own(ob), "commands")
    assert (list(flags), places) == ([], [2, 0, 1])
    bits.filter_name = "wal"
    flags, _ = arrange(bits, bpy.context, own(ob), "commands")
    assert [bool(flag & 4) for flag in flags] == [True, False, True]


def test_menus_offer_what_the_library_has_and_what_can_be_said(ob: bpy.types.Object, library: str) -> None:
    own(ob).library = library
    own(ob).command(1, "start", "walk", speed=1.0)
    bpy.context.scene.frame_set(5)
    found = drawn(directing_panel.MORPHRETARGET_MT_add_command)
    assert {"idle", "run", "walk", "gaze"} <= set(found.texts)
    assert "jump" not in found.texts
    offered = drawn(directing_panel.MORPHRETARGET_MT_add_parameter).texts
    assert {"turn", "direction", "Other"} <= set(offered)
    assert "speed" not in offered, "it is said already"
    assert _operators(drawn(directing_panel.MORPHRETARGET_MT_commands))[-1] == "export_commands"


def test_a_parameter_that_is_known_has_its_usual_value_and_its_tooltip(ob: bpy.types.Object, library: str) -> None:
    own(ob).library = library
    item = own(ob).command(1, "start", "walk")
    bpy.context.scene.frame_set(5)
    ops.add_parameter(name="speed")
    assert 0.3 < item.parameters["speed"].number < 3.0
    ops.add_parameter()
    item.parameters["parameter"].name = "turn"
    assert item.parameters["turn"].kind == "NUMBER"
    add = operators.MORPHRETARGET_OT_add_parameter
    said = add.description(bpy.context, SimpleNamespace(name="speed", model="walk"))
    assert said.startswith("How fast it goes")
    assert add.description(bpy.context, SimpleNamespace(name="", model="walk")) == add.bl_description


def test_the_motion_tree_shows_what_the_present_frame_is_made_from(ob: bpy.types.Object, library: str) -> None:
    assert drawn(motion_tree.MORPHRETARGET_PT_motion_tree).texts[0] == "idle"
    own(ob).library = library
    own(ob).command(10, "start", "walk")
    own(ob).command(60, "start", "run")
    seen: dict[int, list[str]] = {}
    for frame in (30, 120):
        bpy.context.scene.frame_set(frame)
        seen[frame] = drawn(motion_tree.MORPHRETARGET_PT_motion_tree).texts
    assert seen[30][:4] == ["idle", "from 0", "walk", "from 10"]
    assert "run" in seen[120]
    assert "walk" not in seen[120], "it has gone over"


def test_what_keeps_a_character_from_obeying_is_told(ob: bpy.types.Object, library: str, tmp_path: Path) -> None:
    own(ob).library = library
    own(ob).command(10, "start", "dance")
    bpy.context.scene.frame_set(5)
    assert "dance" in " ".join(drawn(*PANELS).texts)
    own(ob).library = str(tmp_path / "none.npz")
    bpy.context.scene.frame_set(6)
    assert "none.npz" in " ".join(drawn(*PANELS).texts).replace(" ", "")


def test_drawing_changes_nothing(ob: bpy.types.Object) -> None:
    own(ob).command(10, "start", "walk", speed=1.0)
    before = repr(own(ob).commands_of(bpy.context.scene))
    for _ in range(2):
        drawn(*PANELS, *MENUS)
    assert repr(own(ob).commands_of(bpy.context.scene)) == before
