"""Scripts of commands in Blender: brought in from files and texts, and written to them."""

from pathlib import Path

import bpy
import numpy as np
import pytest

from morph_retarget.core.clips.commands.parameters import told
from tests.blender import acts, directed, scenes
from tests.blender.directed import own

ops = bpy.ops.morph_retarget

SCRIPT = """
library = "mine.npz"
[targets]
ball = [0.5, -2.0, 1.0]
cup = "Cup"
ghost = "Nobody"
[[command]]
at = 1.0
start = "walk"
speed = 1.2
[[command]]
do = "60f start gaze target=ball"
[[command]]
at = 3.0
start = "reach"
target = "cup"
at_place = [0.0, -1.0]
[[command]]
at = 4.0
start = "gaze"
target = "ghost"
[[command]]
start = "jump"
"""
MARKUP = """<?xml version="1.0"?>
<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b1" character="Biped">
  <head id="h1" lexeme="NOD" start="1" end="2"/>
</bml>
"""

pytestmark = pytest.mark.usefixtures("registered")


@pytest.fixture
def ob() -> bpy.types.Object:
    """Return a creature that is the active object, stands elsewhere, and does what it is told."""
    made = directed.biped()
    made.location, made.rotation_euler = (3.0, 0.0, 0.0), (0.0, 0.0, np.pi)
    bpy.context.view_layer.update()
    return made


def _words(ob: bpy.types.Object) -> list[tuple[float, str, str]]:
    told = own(ob)
    return [(told.commands[i].frame, told.commands[i].words, told.commands[i].how) for i in told.order]


def test_a_script_becomes_commands_empties_and_warnings(
    ob: bpy.types.Object, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "dance.toml"
    path.write_text(SCRIPT)
    cup = acts.empty_object("Cup", (1, 1, 1))
    assert ops.import_commands(filepath=str(path)) == {"FINISHED"}
    first = bpy.context.scene.frame_start
    assert _words(ob) == [
        (first + 30.0, "start walk", "speed 1.2"),
        (first + 60.0, "start gaze", "target ball"),
        (first + 90.0, "start reach", "target Cup, at_place (3, 1, 0)"),
        (first + 120.0, "start gaze", "target Nobody"),
    ]
    ball = bpy.data.objects["ball"]
    assert ball.type == "EMPTY"
    assert ball.location[:] == pytest.approx((2.5, 2.0, 1.0)), "as the character sees it"
    assert own(ob).commands[2].parameters["target"].target == cup
    assert Path(own(ob).library) == tmp_path / "mine.npz"
    assert "dance.toml, line " in capfd.readouterr().out


def test_what_is_wrong_with_a_command_is_told_with_its_line_in_the_script(ob: bpy.types.Object, tmp_path: Path) -> None:
    path = tmp_path / "dance.toml"
    path.write_text("[[command]]\nat = 1.0\nstart = 'fly'\n")
    ops.import_commands(filepath=str(path))
    [command] = own(ob).commands_of(bpy.context.scene)
    assert told(command, "there is none").startswith("dance.toml, line 1 (frame ")
    own(ob).command(5, "start", "fly")
    assert own(ob).commands_of(bpy.context.scene)[0].origin == "frame 5", "what was given here has no script"


def test_reading_a_script_again_moves_its_empties_and_may_replace_the_commands(
    ob: bpy.types.Object, tmp_path: Path
) -> None:
    path = tmp_path / "dance.toml"
    path.write_text(SCRIPT)
    ops.import_commands(filepath=str(path))
    path.write_text(SCRIPT.replace("0.5, -2.0, 1.0", "0.0, 0.0, 2.0"))
    ops.import_commands(filepath=str(path), replace=True)
    assert len(own(ob).commands) == 4
    assert bpy.data.objects["ball"].location[:] == pytest.approx((3.0, 0.0, 2.0))
    assert "ball.001" not in bpy.data.objects
    ops.import_commands(filepath=str(path))
    assert len(own(ob).commands) == 8


@pytest.mark.parametrize("text", ["", "Notes"], ids=["file", "text"])
def test_what_is_written_is_read_as_the_same_commands(ob: bpy.types.Object, tmp_path: Path, text: str) -> None:
    ball, path = acts.empty_object("Ball", (1, 2, 3)), str(tmp_path / "out.toml")
    own(ob).command(12.5, "start", "walk", speed=1.2, style="a b", on=True, place=(1.0, 2.0, 3.0))
    own(ob).command(20, "start", "reach", target=ball)
    own(ob).command(30, "stop", "walk")
    was = _words(ob)
    assert ops.export_commands(filepath=path, text=text) == {"FINISHED"}
    own(ob).clear()
    assert ops.import_commands(filepath=path, text=text) == {"FINISHED"}
    assert _words(ob) == was
    assert own(ob).commands[1].parameters["target"].target == ball


def test_markup_is_told_by_its_name_or_how_it_begins(ob: bpy.types.Object, tmp_path: Path) -> None:
    path = tmp_path / "talk.bml"
    path.write_text(MARKUP)
    assert ops.import_commands(filepath=str(path)) == {"FINISHED"}
    bpy.data.texts.new("Talk").from_string(MARKUP)
    assert ops.import_commands(text="Talk") == {"FINISHED"}
    words = [words for _, words, _ in _words(ob)]
    assert words.count("start nod") == 2


def test_files_that_are_no_scripts_are_told(ob: bpy.types.Object, tmp_path: Path) -> None:
    path = tmp_path / "broken.toml"
    path.write_text("[[command]\nat=")
    for given, said in (
        ({"filepath": str(path)}, "broken.toml"),
        ({"filepath": str(tmp_path / "none.toml")}, "cannot be read as a script of commands"),
        ({"text": "Missing"}, "there is no text 'Missing'"),
    ):
        with pytest.raises(RuntimeError, match=said):
            ops.import_commands(**given)
    assert not len(own(ob).commands)
    with pytest.raises(RuntimeError, match="has no commands to write"):
        ops.export_commands(filepath=str(tmp_path / "out.toml"))
    own(ob).command(1, "start", "walk")
    with pytest.raises(RuntimeError, match="cannot be written"):
        ops.export_commands(filepath=str(tmp_path / "nowhere" / "out.toml"))


def test_an_object_that_is_no_empty_is_the_target_where_it_is(
    ob: bpy.types.Object, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    other = acts.creature("snake")
    other.name = "ball"
    path = tmp_path / "dance.toml"
    path.write_text(SCRIPT)
    ops.import_commands(filepath=str(path), character=ob.name)
    assert other.location[:] == (0.0, 0.0, 0.0)
    assert "'ball' that is no empty" in capfd.readouterr().out
    assert own(ob).commands[1].parameters["target"].target == other


def test_scripts_count_from_the_first_frame_of_the_scene_at_its_own_rate(ob: bpy.types.Object) -> None:
    bpy.context.scene.frame_start, bpy.context.scene.render.fps = 101, 24
    bpy.data.texts.new("Go").from_string('[[command]]\nat = 2.0\nstart = "walk"\n')
    ops.import_commands(text="Go")
    assert own(ob).commands[0].frame == 101.0 + 48.0
    assert scenes.FPS != 24
