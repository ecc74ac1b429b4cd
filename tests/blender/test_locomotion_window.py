"""Locomotion as the window offers it and files keep it."""

from pathlib import Path

import bpy
import numpy as np
import pytest

from morph_retarget.blender.locomotion import walks
from morph_retarget.blender.morph import cast, definitions
from morph_retarget.blender.ui import locomotion_panel
from tests.blender import acting, acts, scenes, walking
from tests.blender.layouts import drawn
from tests.blender.walking import WHOLE

ops = bpy.ops.morph_retarget
NEAR = 1e-6

pytestmark = pytest.mark.usefixtures("registered", "walked")


# --- the window ---


def test_locomotion_comes_and_goes_with_undo() -> None:
    def ob() -> bpy.types.Object:
        return bpy.data.objects["Biped"]

    acts.creature("biped")
    bpy.context.view_layer.objects.active = ob()
    bpy.context.scene.frame_set(60)
    bpy.ops.ed.undo_push(message="start")
    rest = acts.pose(ob())
    ops.add_locomotion(character="Biped")
    bpy.context.view_layer.update()
    bpy.ops.ed.undo_push(message="add")
    going = acts.pose(ob())
    assert scenes.difference(going, rest) > 0.5
    walking.gait(ob()).speed = 2.0
    bpy.context.view_layer.update()
    bpy.ops.ed.undo_push(message="speed")
    fast = acts.pose(ob())
    bpy.ops.ed.undo()
    assert scenes.difference(acts.pose(ob()), going) < NEAR
    bpy.ops.ed.undo()
    assert not walking.gait(ob()).enabled
    assert scenes.difference(acts.pose(ob()), rest) < NEAR
    bpy.ops.ed.redo()
    bpy.ops.ed.redo()
    assert scenes.difference(acts.pose(ob()), fast) < NEAR


def test_removing_it_puts_the_character_back_and_keeps_the_settings() -> None:
    ob = walking.walker(stride=0.7)
    bpy.context.scene.frame_set(60)
    assert ops.remove_locomotion(character=ob.name) == {"FINISHED"}
    bpy.context.view_layer.update()
    assert cast.action_of(ob) is None
    rest = np.array([bone.matrix_local for bone in ob.data.bones])
    assert scenes.difference(acts.pose(ob), rest) < 1e-5
    assert round(walking.gait(ob).stride, 3) == 0.7
    with pytest.raises(RuntimeError, match="No character has locomotion"):
        ops.remove_locomotion(character=ob.name)


def test_removing_it_leaves_the_action_that_plays() -> None:
    ob = acts.creature("biped")
    acting.dip(ob)
    before = walking.shown(ob, [11])
    ops.add_locomotion(character=ob.name)
    ops.remove_locomotion(character=ob.name)
    assert cast.action_of(ob).name == "Dip"
    assert scenes.difference(walking.shown(ob, [11]), before) < NEAR


def test_several_share_an_action_and_each_has_settings_of_its_own() -> None:
    pair = [acts.creature("biped"), acts.creature("hound")]
    for ob in pair:
        ob.select_set(True)
    ops.add_locomotion()
    assert cast.action_of(pair[0]) == cast.action_of(pair[1])
    walking.gait(pair[0]).speed = 0.3
    ways = [walking.root(ob, [31, 91]) for ob in pair]
    lengths = [float(np.linalg.norm(np.diff(way, axis=0)[:, :2])) for way in ways]
    assert lengths == pytest.approx([0.6, 2.4], rel=0.15)


def test_the_panel_draws_what_belongs_to_the_source() -> None:
    panels = [*locomotion_panel.CLASSES[1:]]
    ob = acts.creature("hound")
    bpy.context.view_layer.objects.active = ob
    found = drawn(*panels)
    assert [button.kind.identifier for button in found.buttons] == ["MORPH_RETARGET_OT_add_locomotion"]
    ops.add_locomotion(character=ob.name)
    bpy.context.scene.frame_set(20)
    names = dict(drawn(*panels).props).keys()
    assert {"speed", "turn_rate", "ground", "stride", "foot_roll", "movement"} <= names
    assert "path" not in names
    walking.gait(ob).source = "PATH"
    names = dict(drawn(*panels).props).keys()
    assert "path" in names
    assert "turn_rate" not in names
    ops.add_gait_style(character=ob.name, style="limp", group=1)
    found = drawn(*panels)
    assert {"Limp", "Legs 1"} <= set(found.texts)
    assert {"weight", "group"} <= dict(found.props).keys()


def test_the_diagram_shows_when_each_foot_stands() -> None:
    walking.walker("hound", style="trot", speed=1.5)
    bpy.context.scene.frame_set(40)
    texts = drawn(locomotion_panel.MORPHRETARGET_PT_locomotion).texts
    feet = [texts.index(name) for name in ("FrontPaw.L", "FrontPaw.R", "HindPaw.L", "HindPaw.R")]
    rows = [texts[i + 1].translate(str.maketrans("▓▒", "█░")) for i in feet]
    assert all(set(row) == {"█", "░"} for row in rows)
    assert rows[0] == rows[3] != rows[1] == rows[2], "a trot has diagonal pairs"


def test_drawing_changes_nothing() -> None:
    ob = walking.walker()
    walks.forget()
    drawn(*locomotion_panel.CLASSES[1:])
    assert walks.known(ob, bpy.context.scene) is None


# --- files ---


def test_files_keep_it_and_show_the_same_after_loading(tmp_path: Path) -> None:
    ob = walking.walker("hound", speed=1.4, turn_rate=0.2)
    walking.gait(ob).add("limp").weight = 0.5
    live = walking.shown(ob, WHOLE)
    path = scenes.save(tmp_path / "hound.blend")
    bpy.ops.wm.open_mainfile(filepath=str(path))
    ob = bpy.data.objects["Hound"]
    assert definitions.is_generalized(ob.animation_data.action)
    assert walking.gait(ob).layers[0].style == "limp"
    assert scenes.difference(walking.shown(ob, WHOLE[::-1])[::-1], live) < NEAR


def test_characters_that_are_overridden_have_their_own(tmp_path: Path) -> None:
    walking.walker("biped", speed=1.0)
    library = scenes.save(tmp_path / "library.blend")
    scenes.empty()
    bpy.context.scene.frame_end = 180
    ob = scenes.link(library, "Biped").override_create(remap_local_usages=True)
    slow = walking.root(ob, [100])
    walking.gait(ob).speed = 2.0
    walking.gait(ob).add("sneak").weight = 0.5
    fast = walking.shown(ob, [100])
    assert scenes.difference(walking.root(ob, [100]), slow) > 1.0
    path = scenes.save(tmp_path / "scene.blend")
    scenes.empty()
    bpy.ops.wm.open_mainfile(filepath=str(path))
    (ob,) = [ob for ob in bpy.context.scene.objects if ob.type == "ARMATURE"]
    assert ob.override_library is not None
    assert walking.gait(ob).layers[0].style == "sneak"
    assert scenes.difference(walking.shown(ob, [100]), fast) < NEAR


def test_a_linked_character_goes_as_its_library_says(tmp_path: Path) -> None:
    live = walking.shown(walking.walker("biped", speed=1.0), WHOLE)
    library = scenes.save(tmp_path / "library.blend")
    scenes.empty()
    bpy.context.scene.frame_end = 180
    with bpy.data.libraries.load(str(library), link=True) as (_, wanted):
        wanted.objects = ["Biped"]
    ob = bpy.data.objects["Biped"]
    bpy.context.scene.collection.objects.link(ob)
    assert scenes.difference(walking.shown(ob, WHOLE), live) < NEAR
