"""Commands in files: saved, loaded, linked and overridden."""

from pathlib import Path

import bpy
import pytest

from morph_retarget.blender.morph import cast
from tests.blender import acts, directed, scenes
from tests.blender.directed import own

ops = bpy.ops.morph_retarget

pytestmark = pytest.mark.usefixtures("registered")


def _words(ob: bpy.types.Object) -> list[str]:
    return [f"{command.time * scenes.FPS:g} {command}" for command in own(ob).commands_of(bpy.context.scene)]


def _directed() -> bpy.types.Object:
    """Return a creature with two commands, in a new file."""
    ob = directed.biped()
    own(ob).command(9, "start", "gaze", target=acts.empty_object("Ball", (1, 2, 3)), speed=2)
    own(ob).command(4, "start", "walk", at=(1, 2, 3), on=True, style="sneak")
    return ob


WAS = ["4 start walk at (1.0, 2.0, 3.0) on True style sneak", "9 start gaze target Ball speed 2.0"]


def _saved(path: Path) -> Path:
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


def _opened(path: Path) -> bpy.types.Object:
    """Open a file and return its character."""
    scenes.empty()
    bpy.ops.wm.open_mainfile(filepath=str(path))
    (ob,) = [ob for ob in bpy.context.scene.objects if ob.type == "ARMATURE"]
    return ob


def _linked(path: Path) -> bpy.types.Object:
    """Link the character of a file into a new one."""
    scenes.empty()
    return scenes.link(path, "Biped")


def test_a_loaded_file_has_all_commands(tmp_path: Path) -> None:
    _directed()
    ob = _opened(_saved(tmp_path / "act.blend"))
    assert _words(ob) == WAS
    assert own(ob).enabled
    assert own(ob).targets == {"Ball": (bpy.data.objects["Ball"], "")}


def test_commands_of_a_linked_character_are_read_and_not_changed(tmp_path: Path) -> None:
    _directed()
    ob = _linked(_saved(tmp_path / "act.blend"))
    assert _words(ob) == WAS
    with pytest.raises(RuntimeError, match="make a library override of it first"):
        ops.add_command(character=ob.name)
    with pytest.raises(RuntimeError, match="make a library override of it first"):
        ops.direct(character=ob.name)


def test_markers_of_a_linked_action_are_left_alone(tmp_path: Path) -> None:
    ob = _directed()
    cast.action_of(ob).use_fake_user = True
    path = _saved(tmp_path / "act.blend")
    scenes.empty()
    with bpy.data.libraries.load(str(path), link=True) as (_, wanted):
        wanted.actions = ["Directing"]
    mine = acts.creature("biped")
    cast.add(mine, bpy.data.actions["Directing"])
    for operator in (ops.commands_to_markers, ops.markers_to_commands):
        with pytest.raises(RuntimeError, match=r"action 'Directing' is linked from .*: make it local first"):
            operator(character=mine.name)


def test_an_override_adds_commands_to_those_of_its_library_and_mutes_them(tmp_path: Path) -> None:
    _directed()
    linked = _linked(_saved(tmp_path / "act.blend"))
    ob = linked.override_create(remap_local_usages=True)
    own(ob).command(20, "stop", "walk")
    own(ob).command(30, "start", "wave", side="left", speed=1.5)
    own(ob).commands[0].mute = True
    with pytest.raises(RuntimeError, match="comes from its library: mute it instead"):
        ops.remove_command(character=ob.name, place=0)
    mine = ["20 stop walk", "30 start wave side left speed 1.5"]
    assert _words(ob) == [WAS[0], *mine]
    again = _opened(_saved(tmp_path / "scene.blend"))
    assert again.override_library is not None
    assert _words(again) == [WAS[0], *mine]
    assert ops.remove_command(character=again.name, place=3) == {"FINISHED"}
    assert _words(again) == [WAS[0], mine[0]]


def test_an_override_changes_what_the_commands_of_its_library_say(tmp_path: Path) -> None:
    _directed()
    linked = _linked(_saved(tmp_path / "act.blend"))
    ob = linked.override_create(remap_local_usages=True)
    own(ob).commands[0].set("speed", 3.0)
    own(ob).commands[0].set("target", acts.empty_object("Apple", (0, 0, 1)))
    own(ob).commands[1].frame = 5
    own(ob).commands[1].set("turn", 0.5)
    said = ["5 start walk at (1.0, 2.0, 3.0) on True style sneak turn 0.5", "9 start gaze target Apple speed 3.0"]
    assert _words(ob) == said
    assert _words(_opened(_saved(tmp_path / "scene.blend"))) == said
