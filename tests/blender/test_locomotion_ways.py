"""Where characters go: along paths, over the ground, and where their own objects are moved."""

import bpy
import numpy as np
import pytest

from morph_retarget.blender.locomotion import walks
from morph_retarget.core.arrays import Array
from tests.blender import acting, acts, scenes, walking
from tests.blender.walking import WHOLE

ops = bpy.ops.morph_retarget
NEAR = 1e-6

pytestmark = pytest.mark.usefixtures("registered", "walked")


@pytest.mark.parametrize("kind", ["POLY", "BEZIER", "NURBS"])
def test_it_goes_along_a_curve_wherever_both_are(kind: str) -> None:
    path = walking.path([(0, 0, 0), (0, -4, 0), (0, -8, 0), (0, -16, 0)], kind)
    path.location, path.rotation_euler = (3.0, 1.0, 0.0), (0.0, 0.0, 0.5)
    ob = walking.walker(speed=1.0, source="PATH", path=path)
    ob.location = (-1.0, 0.5, 0.0)
    ob.rotation_euler = (0.0, 0.0, 1.0)
    bpy.context.view_layer.update()
    places = walking.root(ob, [1, 61, 121])
    inside = (np.linalg.inv(np.array(path.matrix_world)) @ np.append(places, np.ones((3, 1)), axis=1).T).T
    assert np.abs(inside[:, 0]).max() < 0.15
    assert -np.diff(inside[:, 1]) == pytest.approx([2.0, 2.0], abs=0.2)


def test_a_curve_with_thickness_is_the_same_path() -> None:
    path = walking.path([(0, 0, 0), (1, -3, 0), (0, -9, 0)], "BEZIER")
    ob = walking.walker(speed=1.0, source="PATH", path=path)
    before = walking.root(ob)
    path.data.bevel_depth = 0.2
    bpy.context.view_layer.update()
    assert scenes.difference(walking.root(ob), before) < 1e-3


def test_an_edited_path_is_followed_at_once() -> None:
    path = walking.path([(0, 0, 0), (0, -9, 0)])
    ob = walking.walker(speed=1.0, source="PATH", path=path)
    bpy.context.scene.frame_set(61)
    before = _shown_now(ob)
    path.location.x = 2.0
    bpy.context.view_layer.update()
    moved = _shown_now(ob)
    assert moved[:, 0] - before[:, 0] == pytest.approx(np.full(len(moved), 2.0), abs=1e-4)
    path.data.splines[0].points[1].co = (9.0, 0.0, 0.0, 1.0)
    path.data.update_tag()
    bpy.context.view_layer.update()
    assert _shown_now(ob)[0, 0] > moved[0, 0] + 1.0
    live = walking.shown(ob, WHOLE)
    acting.baked(ob)
    assert scenes.difference(walking.shown(ob, WHOLE), live) < NEAR


def test_a_path_that_moves_counts_as_it_is_at_the_first_frame() -> None:
    path = walking.path([(0, 0, 0), (0, -9, 0)])
    for frame, x in ((1, 1.0), (100, 9.0)):
        path.location.x = x
        path.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_set(50)
    ob = walking.walker(speed=1.0, source="PATH", path=path)
    assert walking.root(ob, [61, 121])[:, 0] == pytest.approx([1.0, 1.0], abs=0.1)


def _shown_now(ob: bpy.types.Object) -> Array:
    """Return where the bones are in the world that Blender shows now, but for the one that carries all."""
    return acts.heads(ob, ob.pose.bones.keys()[1:])


def test_it_goes_up_a_hill_that_is_edited() -> None:
    ob = walking.walker(speed=1.0, ground=walking.plane(20.0, 0.0, 0.2))
    climbed = np.diff(walking.root(ob, [31, 151])[:, 2])
    assert climbed == pytest.approx([0.2 * 4.0], abs=0.1)
    ground = walking.gait(ob).ground
    bpy.context.scene.frame_set(151)
    before = _shown_now(ob)
    ground.location.z = 0.3
    bpy.context.view_layer.update()
    assert (_shown_now(ob) - before)[:, 2] == pytest.approx(np.full(len(before), 0.3), abs=0.05)
    ground.location.z = 0.0
    ground.data.vertices[0].co.z += 1.0
    ground.data.update()
    bpy.context.view_layer.update()
    assert scenes.difference(_shown_now(ob), before) > 0.01


def test_hills_higher_than_the_character_carry_it() -> None:
    ob = walking.walker(speed=2.0, ground=walking.plane(40.0, 0.0, 2.0))
    assert np.diff(walking.root(ob, [31, 151])[:, 2])[0] > 10.0


@pytest.mark.parametrize("how", ["keys", "parent"])
def test_feet_stay_where_they_are_put_while_the_object_moves(how: str) -> None:
    ob = walking.walker(source="OWN")
    mover = ob
    if how == "parent":
        mover = walking.added("Cart", None)
        ob.parent = mover
    for frame, y in ((1, 0.0), (180, -6.0)):
        mover.location.y = y
        mover.keyframe_insert("location", frame=frame)
    bpy.context.view_layer.update()
    frames = np.arange(60.0, 120.0)
    way = np.diff(walking.root(ob, [60, 119]), axis=0)[0]
    assert way == pytest.approx([0.0, -1.5 * 6.0 * 59.0 / 179.0, 0.0], abs=0.2), "keys are eased"
    assert not walks.problems
    walk = walks.known(ob, bpy.context.scene)
    assert walk.is_carried
    stands = walk.gait.contacts(walk.clock.times(frames))
    feet = [walk.gait.character.skeleton.names[leg.foot] for leg in walk.gait.legs.legs]
    steps = np.linalg.norm(np.diff(scenes.heads(ob, feet, frames), axis=0)[..., :2], axis=-1)
    both = stands[1:] & stands[:-1]
    assert steps[both].mean() < 0.35 * 6.0 / 179.0
    live = walking.shown(ob, WHOLE)
    acting.baked(ob)
    assert scenes.difference(walking.shown(ob, WHOLE), live) < 1e-5


def test_an_object_that_a_constraint_moves_goes_when_it_is_baked() -> None:
    path = walking.path([(0, 0, 0), (0, -9, 0)])
    path.data.use_path, path.data.path_duration = True, 180
    ob = walking.walker(source="OWN")
    constraint = ob.constraints.new("FOLLOW_PATH")
    constraint.target, constraint.use_fixed_location = path, True
    for frame, share in ((1, 0.0), (180, 1.0)):
        constraint.offset_factor = share
        constraint.keyframe_insert("offset_factor", frame=frame)
    walking.shown(ob, [60])
    assert "what moves its object cannot be followed live" in walks.problems[ob.session_uid]
    bpy.context.scene.frame_set(42)
    (outcome,) = acting.baked(ob)
    assert bpy.context.scene.frame_current == 42
    assert outcome.take.walk is not None
    assert outcome.take.walk.frames is not None
    stands = outcome.take.walk.walk.gait.contacts(outcome.take.walk.walk.clock.times(np.arange(60.0, 120.0)))
    assert not stands.all()
