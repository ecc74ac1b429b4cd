"""Foot paths: the flight of feet as curves that an animator draws in the Graph Editor."""

from pathlib import Path

import bpy
import numpy as np
import pytest

from morph_retarget.blender import actions
from morph_retarget.blender.locomotion import foot_path, walks
from morph_retarget.blender.morph import query
from morph_retarget.blender.properties import of_rig
from morph_retarget.blender.ui import locomotion_panel
from morph_retarget.core.arrays import Array
from morph_retarget.core.errors import MotionError
from morph_retarget.core.locomotion.foot_path import ARC
from morph_retarget.core.locomotion.settings import GaitSettings
from morph_retarget.core.locomotion.stepping.gait import Gait
from tests.blender import acting, acts, scenes
from tests.blender.layouts import drawn

ops = bpy.ops.morph_retarget
WHOLE = [1, 9, 33, 47, 60]
NEAR = 1e-6
PANEL = locomotion_panel.MORPHRETARGET_PT_gait_details

pytestmark = pytest.mark.usefixtures("registered")


@pytest.fixture(autouse=True)
def _frames() -> None:
    bpy.context.scene.frame_end = 60


def _walker(kind: str = "biped") -> bpy.types.Object:
    """Return a creature that walks and has a foot path."""
    ob = acts.creature(kind)
    ops.add_locomotion(character=ob.name)
    assert ops.new_foot_path(character=ob.name) == {"FINISHED"}
    return ob


def _path(ob: bpy.types.Object) -> bpy.types.Object:
    return of_rig(ob).gait.foot_path


def _curve(empty: bpy.types.Object, name: str) -> bpy.types.FCurve:
    return actions.curves(*actions.assigned(empty))[foot_path.CURVES[name]]


def _stretch(empty: bpy.types.Object, name: str, factor: float) -> None:
    """Reshape a curve as the Graph Editor does it: keys with their handles."""
    for point in _curve(empty, name).keyframe_points:
        point.co_ui[1] *= factor
    _curve(empty, name).update()
    bpy.context.view_layer.update()


def _pull(empty: bpy.types.Object, name: str, value: float) -> None:
    """Move the middle key of a curve."""
    points = _curve(empty, name).keyframe_points
    points[len(points) // 2].co_ui[1] = value
    _curve(empty, name).update()
    bpy.context.view_layer.update()


def _feet(ob: bpy.types.Object, frames: Array) -> tuple[Array, Array]:
    """Return where the feet of a character are as its gait wants them, and whether they stand."""
    scene = bpy.context.scene
    scene.frame_set(1)
    walk = walks.known(ob, scene)
    assert walk is not None
    assert isinstance(walk.gait, Gait)
    times = walk.clock.times(frames)
    goals, bodies = walk.gait.evaluate(times), [leg.foot for leg in walk.gait.legs.legs]
    return goals.positions[:, [goals.bodies.tolist().index(b) for b in bodies]], walk.gait.contacts(times)


# --- what curves mean ---


def test_a_new_path_draws_the_flight_that_feet_have_without_one() -> None:
    ob = acts.creature("biped")
    ops.add_locomotion(character=ob.name)
    plain = acting.shown(ob, WHOLE)
    ops.new_foot_path(character=ob.name)
    found = foot_path.of(_path(ob))
    for name in ("along", "up", "side", "pitch"):
        assert scenes.difference(getattr(found, name), getattr(ARC, name)) < 0.02
    assert not found.swerves
    # Feet are lifted by a tenth of a leg or so, and go a metre on.
    assert scenes.difference(acting.shown(ob, WHOLE), plain) < 0.02
    assert not walks.problems


def test_keys_are_smooth_and_few() -> None:
    for name in foot_path.CURVES:
        points = _curve(_path(_walker()), name).keyframe_points
        assert len(points) <= 7
        assert {point.interpolation for point in points} == {"BEZIER"}
        assert (points[0].co[0], points[-1].co[0]) == (0.0, 100.0)


def test_a_higher_curve_lifts_feet_higher_and_they_stand_where_they_did() -> None:
    ob, frames = _walker(), np.arange(10.0, 60.0, 0.25)
    low, stands = _feet(ob, frames)
    _stretch(_path(ob), "height", 2.0)
    high, still = _feet(ob, frames)
    assert (stands == still).all()
    assert scenes.difference(high[stands], low[stands]) < NEAR
    rise = high.max(axis=0)[:, 2] - low.max(axis=0)[:, 2]
    assert (rise > 0.02).all()
    assert ((high - low)[..., 2] > -1e-3).all()


def test_the_side_is_outward_for_both_legs() -> None:
    ob, frames = _walker(), np.arange(10.0, 60.0, 0.25)
    plain, _ = _feet(ob, frames)
    _pull(_path(ob), "side", 0.2)
    wide, _ = _feet(ob, frames)
    away = (wide - plain)[..., 0]
    furthest = away[np.abs(away).argmax(axis=0), [0, 1]]
    assert np.sign(furthest).tolist() == np.sign(plain[..., 0].mean(axis=0)).tolist()
    assert (np.abs(furthest) > 0.05).all()


def test_the_pitch_lets_toes_hang() -> None:
    ob = _walker()
    _pull(_path(ob), "pitch", 0.6)
    assert foot_path.of(_path(ob)).pitch.max() == pytest.approx(0.6, abs=0.05)
    bpy.context.scene.frame_set(1)
    walk = walks.known(ob, bpy.context.scene)
    assert isinstance(walk.gait, Gait)
    assert walk.gait.settings.path.pitch.max() == pytest.approx(0.6, abs=0.05)


def test_curves_that_are_missing_or_muted_leave_the_flight_flat() -> None:
    empty = _path(_walker())
    _curve(empty, "height").mute = True
    found = foot_path.of(empty)
    assert not found.up.any()
    assert scenes.difference(found.along, ARC.along) < 0.02


def test_curves_that_are_alike_give_the_same_path_and_no_gait_is_prepared_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    ob = _walker()
    assert of_rig(ob).gait.settings() == of_rig(ob).gait.settings()
    made: list[int] = []
    plain = walks.Walk.of
    monkeypatch.setattr(walks.Walk, "of", lambda *given: (made.append(1), plain(*given))[1])
    bpy.context.scene.frame_set(2)
    made.clear()
    for frame in (1, 5, 9):
        bpy.context.scene.frame_set(frame)
    _path(ob).location.x = 1.0
    bpy.context.view_layer.update()
    # An exact copy is an edit that changes nothing; one that touches keys has Blender round their handles anew.
    before, other = of_rig(ob).gait.settings().path, actions.assigned(_path(ob))[0].copy()
    actions.assign(_path(ob), other, other.slots[0])
    bpy.context.view_layer.update()
    assert of_rig(ob).gait.settings().path is before
    assert not made
    _stretch(_path(ob), "height", 1.5)
    assert made == [1]


# --- live and baked ---


@pytest.mark.parametrize("linked", [True, False])
def test_a_key_that_is_moved_is_followed_live(linked: bool) -> None:
    ob = _walker()
    empty, scene = _path(ob), bpy.context.scene
    if not linked:
        scene.collection.objects.unlink(empty)
    scene.frame_set(47)
    before = acts.pose(ob)
    _stretch(empty, "height", 2.5)
    after = acts.pose(ob)
    assert scenes.difference(after, before) > 0.01
    scene.frame_set(1)
    scene.frame_set(47)
    assert scenes.difference(acts.pose(ob), after) < NEAR
    _stretch(empty, "height", 0.4)
    assert scenes.difference(acts.pose(ob), before) < 1e-4


def test_another_action_on_the_empty_is_followed() -> None:
    ob = _walker()
    empty, (action, _) = _path(ob), actions.assigned(_path(ob))
    bpy.context.scene.frame_set(47)
    before = acts.pose(ob)
    other = action.copy()
    actions.assign(empty, other, other.slots[0])
    bpy.context.view_layer.update()
    _stretch(empty, "height", 3.0)
    high = acts.pose(ob)
    assert scenes.difference(high, before) > 0.01
    actions.assign(empty, action, action.slots[0])
    bpy.context.view_layer.update()
    assert scenes.difference(acts.pose(ob), before) < NEAR


@pytest.mark.parametrize("kind", ["biped", "hound"])
def test_baked_keys_are_what_was_shown_live(kind: str) -> None:
    ob = _walker(kind)
    _stretch(_path(ob), "height", 2.0)
    _pull(_path(ob), "side", 0.1)
    live = acting.shown(ob, WHOLE)
    assert scenes.difference(acting.shown(ob, WHOLE[::-1])[::-1], live) < NEAR
    acting.baked(ob)
    assert scenes.difference(acting.shown(ob, WHOLE), live) < NEAR


def test_characters_share_a_path() -> None:
    ob, other = _walker(), acts.creature("hound")
    ops.add_locomotion(character=other.name)
    of_rig(other).gait.foot_path = _path(ob)
    scene = bpy.context.scene
    scene.frame_set(47)
    before = [acts.pose(ob), acts.pose(other)]
    _stretch(_path(ob), "height", 3.0)
    assert all(scenes.difference(acts.pose(own), was) > 0.01 for own, was in zip((ob, other), before, strict=True))
    assert ops.remove_foot_path(character=ob.name) == {"FINISHED"}
    assert _path(other) is not None, "the other still flies by it"


# --- making and removing ---


def test_a_new_path_is_selected_alone_beside_the_character_and_the_panel_stays_with_that() -> None:
    first = acts.creature("hound")
    ops.add_locomotion(character=first.name)
    ob = acts.creature("biped")
    ob.location = (3.0, 4.0, 5.0)
    bpy.context.view_layer.update()
    bpy.context.view_layer.objects.active = ob
    ob.select_set(True)
    ops.add_locomotion(character=ob.name)
    bpy.ops.object.mode_set(mode="POSE")
    assert ops.new_foot_path() == {"FINISHED"}
    empty = _path(ob)
    assert bpy.context.selected_objects == [empty]
    assert bpy.context.object == empty
    assert query.active_character(bpy.context) == ob
    bpy.context.view_layer.update()
    assert (empty.matrix_world.translation - ob.matrix_world.translation).length < 3.0
    with pytest.raises(RuntimeError, match="has the foot path 'Biped: Foot Path'"):
        ops.new_foot_path(character=ob.name)


def test_removing_a_path_puts_feet_back_and_leaves_nothing() -> None:
    ob = acts.creature("biped")
    ops.add_locomotion(character=ob.name)
    plain = acting.shown(ob, WHOLE)
    ops.new_foot_path(character=ob.name)
    _stretch(_path(ob), "height", 3.0)
    assert scenes.difference(acting.shown(ob, WHOLE), plain) > 0.01
    before = len(bpy.data.actions)
    assert ops.remove_foot_path(character=ob.name) == {"FINISHED"}
    bpy.context.view_layer.update()
    assert scenes.difference(acting.shown(ob, WHOLE), plain) < NEAR
    assert len(bpy.data.actions) == before - 1
    assert not [other for other in bpy.data.objects if other.type == "EMPTY"]
    with pytest.raises(RuntimeError, match="has no foot path"):
        ops.remove_foot_path(character=ob.name)


def test_a_path_that_something_else_uses_is_only_let_go() -> None:
    ob = _walker()
    empty = _path(ob)
    acts.empty_object("Child", (0.0, 0.0, 0.0)).parent = empty
    ops.remove_foot_path(character=ob.name)
    assert _path(ob) is None
    assert actions.assigned(empty)[0] is not None


def test_a_path_that_is_deleted_lets_feet_fly_as_their_style_wants() -> None:
    ob = acts.creature("biped")
    ops.add_locomotion(character=ob.name)
    plain = acting.shown(ob, WHOLE)
    ops.new_foot_path(character=ob.name)
    _stretch(_path(ob), "height", 3.0)
    bpy.data.objects.remove(_path(ob))
    bpy.context.view_layer.update()
    assert scenes.difference(acting.shown(ob, WHOLE), plain) < NEAR
    assert not walks.problems


def test_undo_takes_a_path_back_and_redo_brings_it() -> None:
    def ob() -> bpy.types.Object:
        return bpy.data.objects["Biped"]

    acts.creature("biped")
    ops.add_locomotion(character="Biped")
    bpy.context.scene.frame_set(47)
    bpy.ops.ed.undo_push(message="start")
    plain = acts.pose(ob())
    ops.new_foot_path(character="Biped")
    bpy.context.view_layer.update()
    bpy.ops.ed.undo_push(message="path")
    made = acts.pose(ob())
    _stretch(_path(ob()), "height", 3.0)
    bpy.ops.ed.undo_push(message="higher")
    high = acts.pose(ob())
    assert scenes.difference(high, plain) > 0.01
    bpy.ops.ed.undo()
    assert scenes.difference(acts.pose(ob()), made) < NEAR
    bpy.ops.ed.undo()
    assert _path(ob()) is None
    assert scenes.difference(acts.pose(ob()), plain) < NEAR
    bpy.ops.ed.redo()
    bpy.ops.ed.redo()
    assert scenes.difference(acts.pose(ob()), high) < NEAR


def test_the_panel_offers_what_can_be_done() -> None:
    ob = acts.creature("biped")
    ops.add_locomotion(character=ob.name)
    bpy.context.view_layer.objects.active = ob
    kinds = [button.kind.identifier for button in drawn(PANEL).buttons]
    assert kinds == ["MORPH_RETARGET_OT_new_foot_path"]
    ops.new_foot_path(character=ob.name)
    found = drawn(PANEL)
    assert [button.kind.identifier for button in found.buttons] == ["MORPH_RETARGET_OT_remove_foot_path"]
    assert "foot_path" in dict(found.props)


# --- what cannot be ---


def test_an_object_without_keys_is_told_and_the_character_stands() -> None:
    ob = _walker()
    bpy.context.scene.frame_set(47)
    of_rig(ob).gait.foot_path = acts.empty_object("Bare", (0.0, 0.0, 0.0))
    bpy.context.view_layer.update()
    assert "foot path 'Bare' has no keys" in walks.problems[ob.session_uid]
    rest = np.array([bone.matrix_local for bone in ob.data.bones])
    assert scenes.difference(acts.pose(ob), rest) < 1e-5
    assert "foot path 'Bare' has no keys" in " ".join(drawn(locomotion_panel.MORPHRETARGET_PT_locomotion).texts)
    with pytest.raises(RuntimeError, match="choose another object"):
        ops.bake_action(character=ob.name)
    of_rig(ob).gait.foot_path = None
    bpy.context.view_layer.update()
    assert not walks.problems
    assert scenes.difference(acts.pose(ob), rest) > 0.1


def test_a_way_that_is_missing_or_leads_nowhere_is_told_until_it_is_mended() -> None:
    ob = _walker()
    empty = _path(ob)
    bpy.context.scene.frame_set(47)
    _stretch(empty, "way", 0.0)
    standing = acts.pose(ob)
    assert f"foot path {empty.name!r}: the way of the foot path does not go forward" in walks.problems[ob.session_uid]
    for i, point in enumerate(_curve(empty, "way").keyframe_points):
        point.co_ui[1] = i
    _curve(empty, "way").update()
    bpy.context.view_layer.update()
    assert not walks.problems
    assert scenes.difference(acts.pose(ob), standing) > 0.5, "it goes again"
    _curve(empty, "way").mute = True
    with pytest.raises(MotionError, match=f"foot path {empty.name!r} has no curve for its way: key its Y location"):
        foot_path.of(empty)


def test_turns_that_are_no_angles_are_told() -> None:
    empty = _path(_walker())
    empty.rotation_mode = "QUATERNION"
    foot_path.of(empty)
    empty.keyframe_insert("rotation_quaternion", frame=0)
    with pytest.raises(MotionError, match="set its rotation mode to XYZ Euler"):
        foot_path.of(empty)


def test_an_untouched_character_has_the_cores_own_path() -> None:
    assert of_rig(acts.creature("biped")).gait.settings() == GaitSettings()


# --- files ---


@pytest.mark.parametrize("overridden", [False, True])
def test_a_linked_character_brings_its_path(tmp_path: Path, overridden: bool) -> None:
    ob = _walker()
    _stretch(_path(ob), "height", 3.0)
    live = acting.shown(ob, WHOLE)
    library = scenes.save(tmp_path / "library.blend")
    scenes.empty()
    bpy.context.scene.frame_end = 60
    ob = scenes.link(library, "Biped")
    if overridden:
        ob = ob.override_create(remap_local_usages=True)
    assert scenes.difference(acting.shown(ob, WHOLE), live) < NEAR
    if not overridden:
        of_rig(ob).gait.foot_path = None
        with pytest.raises(RuntimeError, match="make a library override of it first"):
            ops.new_foot_path(character=ob.name)
        return
    assert ops.remove_foot_path(character=ob.name) == {"FINISHED"}
    assert ops.new_foot_path(character=ob.name) == {"FINISHED"}
    assert _path(ob).library is None
    bpy.context.view_layer.update()
    assert scenes.difference(acting.shown(ob, WHOLE), live) > 0.01


def test_files_keep_it(tmp_path: Path) -> None:
    ob = _walker()
    _stretch(_path(ob), "height", 3.0)
    live = acting.shown(ob, WHOLE)
    path = scenes.save(tmp_path / "biped.blend")
    bpy.ops.wm.open_mainfile(filepath=str(path))
    assert scenes.difference(acting.shown(bpy.data.objects["Biped"], WHOLE), live) < NEAR
