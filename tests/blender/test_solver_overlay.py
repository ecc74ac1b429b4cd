"""The solver as the viewport draws it: where the pose is, for the active character, in every state of the file."""

from collections.abc import Callable, Iterator
from pathlib import Path

import bpy
import numpy as np
import pytest

from morph_retarget.blender.morph import cast, perform
from morph_retarget.blender.morph.properties import of_action
from morph_retarget.blender.properties import of_rig, of_scene
from morph_retarget.blender.ui import generalized, overlay, strokes
from morph_retarget.blender.ui.strokes import BLENDED, FIXED, LIMB, LOOSE, MET, MISSED, SPINE, Color, Stroke
from morph_retarget.core.arrays import Array
from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.morph.channels import Channel
from morph_retarget.core.morph.context import Context, Side
from morph_retarget.core.solve.workings import Workings, workings_of
from tests.blender import acts, scenes, window
from tests.blender.acts import Act
from tests.blender.layouts import drawn

MOVED = scenes.matrix((20, -35, 60), 1.7, (3, -2, 1))
CORNERS = 24
"""Points that the mark of one goal takes."""


@pytest.fixture(autouse=True)
def _registered() -> Iterator[None]:
    with window.registered():
        own = of_scene(bpy.context.scene)
        own.show_paths, own.show_solver = False, True
        yield


@pytest.fixture
def reach() -> Act:
    """Return two characters, with heads that are brought somewhere and a left hand that is asked for too much."""
    heads = Channel("Heads", Context(Capability.HEAD))
    hands = Channel("Hand", Context(Capability.GRASPER, side=Side.LEFT))
    found = acts.act([acts.creature("asura"), acts.creature("biped")], heads, hands)
    of_rig(found.obs[0]).bends_spine = True
    found.key(1, "Heads", position=(0.02, -0.03, -0.02))
    found.key(1, "Hand", position=(0.0, -3.0, 0.0))
    bpy.context.scene.frame_set(2)
    return found


def _strokes() -> list[Stroke]:
    found = overlay.strokes_now(bpy.context)
    assert all(len(stroke.places) and np.isfinite(stroke.places).all() for stroke in found)
    return found


def _places(color: Color, kind: str = "LINES") -> Array:
    """Return all that is drawn in a colour, shape (n, 3)."""
    found = [stroke.places for stroke in _strokes() if stroke.color == color and stroke.kind == kind]
    return np.concatenate([np.zeros((0, 3)), *found])


def _workings(ob: bpy.types.Object) -> Workings:
    shown = perform.shown(ob)
    assert shown is not None
    return workings_of(shown.member.part.pose, shown.played.goals, shown.played.pose)


def _check(ob: bpy.types.Object) -> None:
    """Check that all of a character's pose is drawn where it is in the world."""
    found = _workings(ob)
    assert found.met.any()
    assert found.missed.any()
    for color, kind, points in (
        (LIMB, "POINTS", found.joints),
        (LIMB, "LINES", found.bones),
        (SPINE, "POINTS", found.branches),
        (SPINE, "LINES", found.spine),
    ):
        np.testing.assert_allclose(_places(color, kind), acts.in_world(ob, points.reshape(-1, 3)), atol=1e-5)
    asked = acts.in_world(ob, found.asked)
    met = _places(MET).reshape(-1, CORNERS, 3).mean(axis=1)
    np.testing.assert_allclose(met, asked[found.met], atol=1e-5)
    count = int(found.missed.sum())
    missed = _places(MISSED)
    marks = missed[: count * CORNERS].reshape(-1, CORNERS, 3).mean(axis=1)
    np.testing.assert_allclose(marks, asked[found.missed], atol=1e-5)
    came = acts.in_world(ob, found.came[found.missed])
    ways = np.stack([asked[found.missed], came], axis=1).reshape(-1, 3)
    np.testing.assert_allclose(missed[count * CORNERS :], ways, atol=1e-5)


def test_what_is_drawn_is_where_the_pose_is_in_the_world(reach: Act) -> None:
    _check(reach.obs[0])


@pytest.mark.parametrize("place", [MOVED, scenes.matrix((0, 0, 40), (-1, 1, 1), (0, 5, 0))], ids=["moved", "mirrored"])
def test_it_goes_where_the_object_goes(reach: Act, place: Array) -> None:
    parent = scenes.empty_object("Parent")
    scenes.stand(parent, scenes.matrix((10, 0, 0), 1.0, (0, 0, 2)))
    scenes.stand(reach.obs[0], place, parent)
    _check(reach.obs[0])


def test_joints_are_where_blender_has_the_bones(reach: Act) -> None:
    ob = reach.obs[0]
    scenes.stand(ob, MOVED)
    bpy.context.scene.frame_set(3)
    heads = acts.heads(ob, ob.pose.bones.keys())
    for points in (_places(LIMB, "POINTS"), _places(SPINE, "POINTS")):
        apart = np.linalg.norm(points[:, None] - heads, axis=-1).min(axis=1)
        assert apart.max() < 1e-4


def test_it_is_of_the_active_character(reach: Act) -> None:
    bpy.context.view_layer.objects.active = reach.obs[1]
    assert not len(_places(SPINE, "POINTS")), "this one does not bend its spine"
    joints = _workings(reach.obs[1]).joints.reshape(-1, 3)
    np.testing.assert_allclose(_places(LIMB, "POINTS"), acts.in_world(reach.obs[1], joints), atol=1e-5)


def test_it_follows_edits(reach: Act) -> None:
    assert len(_places(MISSED))
    reach.curve("position", 1, "Hand").keyframe_points[0].co.y = -0.1
    bpy.context.scene.frame_set(2)
    assert not len(_places(MISSED))
    reach.key(1, "Hand", weight=0.5)
    bpy.context.scene.frame_set(2)
    assert len(_places(BLENDED))


def test_jiggling_bones_are_drawn_where_blender_has_them() -> None:
    ob = acts.creature("hound")
    found = acts.act([ob], Channel("Root", Context(Capability.ROOT)))
    found.key(1, position=(0, 0, 0))
    found.key(5, position=(0, 0.5, 0))
    of_rig(ob).jiggles.enabled = True
    bpy.context.scene.frame_set(5)
    tips = _places(LOOSE, "POINTS")
    tails = np.array([ob.matrix_world @ bone.tail for bone in ob.pose.bones])
    assert len(tips)
    assert np.linalg.norm(tips[:, None] - tails, axis=-1).min(axis=1).max() < 1e-5
    of_rig(ob).jiggles.enabled = False
    bpy.context.scene.frame_set(6)
    assert not len(_places(LOOSE, "POINTS"))
    assert not len(_places(FIXED))


def _switch_off(_: Act) -> None:
    of_scene(bpy.context.scene).show_solver = False


def _mute(act: Act) -> None:
    of_rig(act.obs[0]).muted = True


def _edit(_: Act) -> None:
    bpy.ops.object.mode_set(mode="EDIT")


def _rest(act: Act) -> None:
    act.obs[0].data.pose_position = "REST"


def _hide(act: Act) -> None:
    act.obs[0].hide_viewport = True


def _unlink(act: Act) -> None:
    cast.remove(act.obs[0])


def _clear(act: Act) -> None:
    act.obs[0].animation_data_clear()


def _delete_action(act: Act) -> None:
    bpy.data.actions.remove(act.action)


def _delete_all(act: Act) -> None:
    for ob in act.obs:
        bpy.data.objects.remove(ob)


def _other(_: Act) -> None:
    scenes.figure("Ann")


def _empty(_: Act) -> None:
    scenes.empty()


def _newer(act: Act) -> None:
    of_action(act.action).version = 999
    cast.forget()


STATES: list[Callable[[Act], None]] = [
    _switch_off,
    _mute,
    _edit,
    _rest,
    _hide,
    _unlink,
    _clear,
    _delete_action,
    _delete_all,
    _other,
    _empty,
    _newer,
]


@pytest.mark.parametrize("state", STATES, ids=[state.__name__.strip("_") for state in STATES])
def test_where_no_pose_of_the_character_is_shown_nothing_is_drawn(reach: Act, state: Callable[[Act], None]) -> None:
    assert _strokes()
    state(reach)
    if state is not _switch_off:
        of_scene(bpy.context.scene).show_paths = False
        of_scene(bpy.context.scene).show_solver = True
    assert not _strokes()


def test_nothing_is_worked_out_when_it_is_off(reach: Act, monkeypatch: pytest.MonkeyPatch) -> None:
    of_scene(bpy.context.scene).show_solver = False
    monkeypatch.setattr(overlay.query, "active_character", lambda _: pytest.fail("nobody is looked for"))
    assert not overlay.strokes_now(bpy.context)
    del reach


def test_edits_of_bones_leave_it_with_the_pose(reach: Act) -> None:
    ob = reach.obs[0]
    bpy.ops.object.mode_set(mode="EDIT")
    ob.data.edit_bones.remove(next(bone for bone in ob.data.edit_bones if not bone.children))
    bpy.ops.object.mode_set(mode="OBJECT")
    _strokes()
    bpy.context.scene.frame_set(4)
    _check(ob)


def test_a_file_that_was_just_loaded_is_drawn_from_its_first_frame_on(reach: Act, tmp_path: Path) -> None:
    path = scenes.save(tmp_path / "saved.blend")
    before = _places(LIMB, "POINTS")
    bpy.ops.wm.open_mainfile(filepath=str(path))
    _strokes()
    bpy.context.scene.frame_set(bpy.context.scene.frame_current)
    np.testing.assert_allclose(_places(LIMB, "POINTS"), before, atol=1e-5)
    del reach


def test_paths_are_drawn_beside_it(reach: Act) -> None:
    own = of_scene(bpy.context.scene)
    own.show_solver, own.show_paths = False, True
    paths = _strokes()
    assert {stroke.color for stroke in paths} == {strokes.PATH}
    own.show_solver = True
    assert len(_strokes()) > len(paths)
    del reach


def test_the_switch_stands_beside_that_of_the_paths(reach: Act) -> None:
    names = [name for name, _ in drawn(generalized.MORPHRETARGET_PT_generalized).props]
    assert names.index("show_solver") == names.index("show_paths") + 1
    del reach
