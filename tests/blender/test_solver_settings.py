"""Solver settings of characters and of their limbs, as the panel has them: followed at once, kept in files, undone."""

from pathlib import Path

import bpy
import numpy as np
import pytest

from morph_retarget.blender.morph import cast, solver_properties, telling
from morph_retarget.blender.morph.solver_properties import SHARED, MORPHRETARGET_PG_solver
from morph_retarget.blender.properties import of_rig
from morph_retarget.blender.ui import solver_panel
from morph_retarget.core.arrays import Array
from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.morph.channels import Channel
from morph_retarget.core.morph.context import Context
from morph_retarget.core.morph.movement import Movement, ScaleMode
from morph_retarget.core.solve.limb_settings import LimbSettings
from morph_retarget.core.solve.settings import DEFAULT, SolverSettings
from tests.blender import acting, acts, results, scenes
from tests.blender.acts import Act
from tests.blender.command import Command
from tests.blender.layouts import drawn

ops = bpy.ops.morph_retarget
SIZED = Movement(scale=ScaleMode.LIMB_LENGTH)
FEET, HANDS = (Channel(c.value.title(), Context(c), SIZED) for c in (Capability.FOOT, Capability.GRASPER))
ARM = ["UpperArm.L", "LowerArm.L"]
NEAR = 1e-5

pytestmark = pytest.mark.usefixtures("registered")


@pytest.fixture
def act() -> Act:
    """Return a body that lowers its hands."""
    return _act()


def _act() -> Act:
    act = acts.act([acting.creature("biped")], FEET, HANDS)
    for frame, z in ((1, -0.2), (20, -0.6)):
        act.key(frame, "Grasper", position=(-0.1, -0.1, z))
    bpy.context.scene.frame_set(20)
    return act


def _solver(act: Act) -> MORPHRETARGET_PG_solver:
    return of_rig(act.obs[0]).solver


def _heads(ob: bpy.types.Object) -> dict[str, Array]:
    """Return where the bones are that Blender shows now [m]."""
    bpy.context.view_layer.update()
    names = ob.pose.bones.keys()
    return dict(zip(names, acts.pose(ob)[:, :3, 3], strict=True))


def _moved(before: dict[str, Array], after: dict[str, Array]) -> set[str]:
    return {name for name in before if np.abs(after[name] - before[name]).max() > NEAR}


# --- what the core gets ---


def test_untouched_settings_are_those_of_the_core(act: Act) -> None:
    """To the bit, although Blender keeps fewer digits: no pose changes for those who set nothing."""
    assert _solver(act).settings(()) == DEFAULT
    assert cast.member(act.obs[0]).solver == DEFAULT
    assert _solver(act).add("Hand.L").settings() == LimbSettings()


def test_each_setting_arrives(act: Act) -> None:
    own = _solver(act)
    groups = {own: SolverSettings(), own.add("Hand.L"): LimbSettings()}
    for group, plain in groups.items():
        for name, prop in group.bl_rna.properties.items():
            if prop.type not in {"FLOAT", "INT"} or name == "active_limb":
                continue
            assert not prop.is_animatable, "a clip is solved as a whole"
            was, value = getattr(group, name), prop.hard_min + 0.3 * (prop.hard_max - prop.hard_min)
            setattr(group, name, int(value) if prop.type == "INT" else value)
            told = own.settings(["Hand.L"])
            found = getattr(told if group == own else told.limbs["Hand.L"], name)
            wanted = np.degrees(value) if prop.subtype == "ANGLE" else value
            assert found == pytest.approx(int(wanted) if prop.type == "INT" else wanted, abs=1e-4)
            assert found != getattr(plain, name)
            setattr(group, name, was)


# --- live ---


def test_a_swivel_is_followed_at_once_and_moves_one_elbow(act: Act) -> None:
    ob = act.obs[0]
    before = _heads(ob)
    item = _solver(act).add("Hand.L")
    assert _moved(before, _heads(ob)) == set()
    item.swivel = np.radians(40.0)
    out = _heads(ob)
    assert "LowerArm.L" in _moved(before, out)
    assert "Hand.L" not in _moved(before, out), "the hand stays at its goal"
    assert not any(name.endswith(".R") for name in _moved(before, out))
    item.swivel = np.radians(-40.0)
    assert "LowerArm.L" in _moved(out, _heads(ob))
    _solver(act).remove(0)
    assert _moved(before, _heads(ob)) == set()


def test_settings_of_the_character_are_followed_at_once(act: Act) -> None:
    ob = act.obs[0]
    of_rig(ob).bends_spine = True
    act.values(0, "Grasper").position = (0.5, -0.5, 0.9)
    pulled = _heads(ob)
    rest = {bone.name: np.array(bone.head_local) for bone in ob.data.bones}
    assert {"Chest", "Neck", "Head"} <= _moved(rest, pulled)
    _solver(act).pull = 0.0
    assert not _moved(rest, _heads(ob)) & {"Chest", "Neck", "Head"}


def test_a_new_limb_has_the_settings_of_the_character(act: Act) -> None:
    own = _solver(act)
    own.slow_down, own.pull, own.outer_iterations = 0.7, 0.3, 9
    item = own.add("Foot.R")
    assert all(getattr(item, name) == getattr(own, name) for name in SHARED)
    assert item.swivel == 0.0
    assert own.add("Foot.R") == item
    assert [item.name for item in own.limbs] == ["Foot.R"]


def test_settings_read_for_one_frame_are_kept_for_the_next(act: Act, monkeypatch: pytest.MonkeyPatch) -> None:
    read: list[int] = []
    plain = MORPHRETARGET_PG_solver.settings
    monkeypatch.setattr(MORPHRETARGET_PG_solver, "settings", lambda own, names: (read.append(1), plain(own, names))[1])
    _solver(act).twist = 0.5
    bpy.context.view_layer.update()
    for frame in range(1, 11):
        bpy.context.scene.frame_set(frame)
    assert len(read) == 1


def test_a_bake_takes_them_over(act: Act) -> None:
    ob = act.obs[0]
    _solver(act).add("Hand.L").swivel = 0.8
    live = scenes.heads(ob, ARM, [1, 7, 20])
    acting.baked(ob)
    assert acting.apart(scenes.heads(ob, ARM, [1, 7, 20]), live) < 1e-4


def test_a_limb_that_is_none_of_the_character_is_told_and_the_rest_plays(act: Act) -> None:
    own = _solver(act)
    own.add("Tentacle").swivel = 1.0
    own.add("Hand.L").swivel = 1.0
    assert telling.tell(act.obs[0]) == ["'Tentacle' has solver settings and is no bone of 'Biped': remove these"]
    assert cast.member(act.obs[0]).solver.limbs.keys() == {"Hand.L"}
    assert not cast.problems


# --- buttons ---


def test_buttons_add_and_remove_limbs(act: Act) -> None:
    own = _solver(act)
    assert ops.add_limb_settings(character="Biped", bone="Hand.R") == {"FINISHED"}
    act.obs[0].data.bones.active = act.obs[0].data.bones["Foot.L"]
    assert ops.add_limb_settings() == {"FINISHED"}
    assert [item.name for item in own.limbs] == ["Hand.R", "Foot.L"]
    assert own.active_limb == 1
    assert ops.remove_limb_settings() == {"FINISHED"}
    assert [item.name for item in own.limbs] == ["Hand.R"]
    with pytest.raises(RuntimeError, match="no bone 'Fluke'"):
        ops.add_limb_settings(bone="Fluke")
    ops.remove_limb_settings()
    with pytest.raises(RuntimeError, match="no such settings"):
        ops.remove_limb_settings()


def test_the_panel_shows_switches_limbs_and_their_settings(act: Act) -> None:
    panels = [*solver_panel.CLASSES[2:], solver_panel.MORPHRETARGET_MT_limbs]
    found = drawn(*panels)
    assert {"bends_spine", "use_joint_limits", "slow_down"} <= dict(found.props).keys()
    assert "swivel" not in dict(found.props)
    assert [text for text in found.texts if "." in text] == ["Foot.L", "Foot.R", "Hand.L", "Hand.R"]
    own = _solver(act)
    for name in ("Head", "Fluke", "Hand.L"):
        own.add(name)
    found = drawn(*panels)
    assert {"Not Posed", "No Bone"} <= set(found.texts)
    assert found.texts.count("Hand.L") == 1, "it is in the list, and no more in the menu"
    props = dict(found.props)
    assert props["swivel"]
    assert not props["pull"], "it needs a spine that bends"
    of_rig(act.obs[0]).bends_spine = True
    assert dict(drawn(*panels).props)["pull"]


def test_the_panel_is_for_characters_that_play_an_action() -> None:
    ob = acting.creature("biped")
    bpy.context.view_layer.objects.active = ob
    assert drawn(*solver_panel.CLASSES[2:3]).props == []


def test_drawing_changes_nothing(act: Act) -> None:
    of_rig(act.obs[0]).channels.clear()
    cast.forget()
    drawn(*solver_panel.CLASSES[1:])
    assert not of_rig(act.obs[0]).channels


# --- files ---


def _assert_kept(ob: bpy.types.Object) -> None:
    own = of_rig(ob).solver
    assert round(own.slow_down, 4) == 0.8
    assert [(item.name, round(item.swivel, 4)) for item in own.limbs] == [("Hand.L", 0.7)]


def test_files_keep_them_and_show_the_same_after_loading(act: Act, tmp_path: Path) -> None:
    _solver(act).slow_down = 0.8
    _solver(act).add("Hand.L").swivel = 0.7
    live = _heads(act.obs[0])
    path = scenes.save(tmp_path / "act.blend")
    bpy.ops.wm.open_mainfile(filepath=str(path))
    ob = bpy.data.objects["Biped"]
    _assert_kept(ob)
    assert _moved(live, _heads(ob)) == set()


def test_characters_that_are_overridden_have_their_own(act: Act, tmp_path: Path) -> None:
    library = scenes.save(tmp_path / "library.blend")
    scenes.empty()
    with bpy.data.libraries.load(str(library), link=True) as (_, wanted):
        wanted.objects = ["Biped"]
    linked = bpy.data.objects["Biped"]
    bpy.context.scene.collection.objects.link(linked)
    ob = linked.override_create(remap_local_usages=True)
    bpy.context.scene.frame_set(20)
    before = _heads(ob)
    of_rig(ob).solver.slow_down = 0.8
    of_rig(ob).solver.add("Hand.L").swivel = 0.7
    live = _heads(ob)
    assert "LowerArm.L" in _moved(before, live)
    path = scenes.save(tmp_path / "scene.blend")
    scenes.empty()
    bpy.ops.wm.open_mainfile(filepath=str(path))
    (ob,) = [ob for ob in bpy.context.scene.objects if ob.type == "ARMATURE"]
    assert ob.override_library is not None
    _assert_kept(ob)
    assert _moved(live, _heads(ob)) == set()
    del act


def test_undo_brings_settings_and_poses_back(act: Act) -> None:
    def ob() -> bpy.types.Object:
        return bpy.data.objects["Biped"]

    del act
    bpy.ops.ed.undo_push(message="start")
    states = [_heads(ob())]
    edits = (
        lambda: ops.add_limb_settings(character="Biped", bone="Hand.L"),
        lambda: setattr(of_rig(ob()).solver.limbs[0], "swivel", 0.9),
        lambda: setattr(of_rig(ob()).solver.limbs[0], "slow_down", 0.6),
        lambda: ops.remove_limb_settings(character="Biped"),
    )
    for edit in edits:
        edit()
        bpy.ops.ed.undo_push(message="edit")
        states.append(_heads(ob()))
    assert _moved(states[1], states[2])
    for state in reversed(states[:-1]):
        bpy.ops.ed.undo()
        assert _moved(state, _heads(ob())) == set()
    for state in states[1:]:
        bpy.ops.ed.redo()
        assert _moved(state, _heads(ob())) == set()


def test_the_command_line_plays_as_the_file_of_the_character_says(cli: Command, out: Path, act: Act) -> None:
    _solver(act).add("Hand.L").swivel = 0.7
    live = scenes.heads(act.obs[0], ARM, [1, 20])
    scenes.save(out / "act.blend")
    said = cli("play", f"{out / 'act.blend'}#Act", out / "act.blend", "-o", out / "x.blend")
    assert (said.status, said.errors) == (0, [])
    assert acting.apart(scenes.heads(results.reload(out / "x.blend"), ARM, [1, 20]), live) < 1e-4


def test_names_and_descriptions_say_what_settings_do() -> None:
    for group in solver_properties.CLASSES:
        for name, prop in group.bl_rna.properties.items():
            if name in {"rna_type", "name"}:
                continue
            assert prop.name
            assert len(prop.description) > 20
            assert not prop.description.endswith(".")
