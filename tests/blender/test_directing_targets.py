"""Targets of commands: where they are over all frames, without stepping through these where keys tell."""

from collections.abc import Sequence

import bpy
import numpy as np
import pytest

from morph_retarget.blender.directing import reading, tracking
from morph_retarget.blender.morph import stage
from morph_retarget.core.arrays import Array
from morph_retarget.core.errors import MotionError
from tests.blender import acting, acts, directed, scenes
from tests.blender.directed import own

ops = bpy.ops.morph_retarget
FRAMES = (1.0, 13.0, 30.0, 55.0)
NEAR = 1e-4

pytestmark = pytest.mark.usefixtures("registered")


@pytest.fixture(autouse=True)
def _frames() -> None:
    bpy.context.scene.frame_end = 60


@pytest.fixture
def ob() -> bpy.types.Object:
    """Return a creature that does what it is told."""
    return directed.biped()


def _places(ob: bpy.types.Object, target: bpy.types.Object, bone: str, frames: Sequence[float] = FRAMES) -> Array:
    graph = bpy.context.evaluated_depsgraph_get()
    return tracking.places(ob, (target, bone), np.array(frames), graph)


def _stepped(target: bpy.types.Object, bone: str, frames: Sequence[float] = FRAMES) -> Array:
    """Return where Blender shows a bone [m], world space, shape (frame, 3)."""
    return scenes.heads(target, [bone], frames)[:, 0]


def test_a_bone_of_an_ordinary_action_is_where_its_keys_bring_it(ob: bpy.types.Object) -> None:
    walker = scenes.walker(seconds=2.0, names=str)
    walker.location, walker.rotation_euler = (2.0, -1.0, 0.3), (0.0, 0.0, 1.0)
    for frame, x in ((1, 2.0), (60, 4.0)):
        walker.location.x = x
        walker.keyframe_insert("location", frame=frame)
    bpy.context.view_layer.update()
    assert _places(ob, walker, "head") == pytest.approx(_stepped(walker, "head"), abs=NEAR)


def test_a_bone_of_another_character_is_where_its_own_motion_brings_it(ob: bpy.types.Object) -> None:
    other = acts.creature("hound")
    acting.play(acting.action("Paws", [acting.HANDS]), other, keyed={"Hands": {1: (0, 0, 0), 30: (0, -0.2, 0.1)}})
    ops.add_locomotion(character=other.name)
    other.location = (3.0, 0.0, 0.0)
    bpy.context.view_layer.update()
    assert not tracking.reason_to_step(ob, (other, "Head"))
    assert _places(ob, other, "Head") == pytest.approx(_stepped(other, "Head"), abs=NEAR)


def test_a_bone_of_another_directed_character_is_followed(ob: bpy.types.Object) -> None:
    other = acts.creature("biped")
    ops.direct(character=other.name)
    own(other).command(10, "start", "walk")
    own(ob).command(1, "start", "gaze", target=other.pose.bones["Head"])
    seen = _stepped(other, "Head")
    assert seen[-1, 1] < seen[0, 1] - 0.3, "it walks"
    assert _places(ob, other, "Head") == pytest.approx(seen, abs=NEAR)
    names = {block.name for block in reading.watched(ob)}
    assert {other.name, other.animation_data.action.name} <= names


def test_two_that_follow_each_other_are_told_to_be_baked(ob: bpy.types.Object) -> None:
    other = acts.creature("biped")
    ops.direct(character=other.name)
    own(ob).command(1, "start", "gaze", target=other.pose.bones["Head"])
    own(other).command(1, "start", "gaze", target=ob.pose.bones["Head"])
    assert tracking.behind(ob) == tracking.behind(other) == {ob, other}
    for one, its in ((ob, other), (other, ob)):
        assert tracking.reason_to_step(one, (its, "Head")) == "it follows the character itself"
        with pytest.raises(MotionError, match="so it is followed when"):
            _places(one, its, "Head")


def test_a_bone_that_constraints_move_needs_stepping(ob: bpy.types.Object) -> None:
    walker = scenes.walker(names=str)
    constraints = walker.pose.bones["head"].constraints
    constraints.new("COPY_ROTATION").target = ob
    assert "constraints" in tracking.reason_to_step(ob, (walker, "head"))
    constraints.remove(constraints[0])
    assert not tracking.reason_to_step(ob, (walker, "head"))


def test_a_bone_that_rests_is_read_once(ob: bpy.types.Object) -> None:
    still = acts.creature("hound")
    found = _places(ob, still, "Head")
    assert found.shape == (1, 3)
    assert found[0] == pytest.approx(stage.place_of(still, "Head", bpy.context.evaluated_depsgraph_get()), abs=NEAR)


# --- surfaces ---


def test_a_surface_is_seen_from_its_origin_along_the_axes_of_the_world() -> None:
    bpy.ops.mesh.primitive_cube_add(size=2.0, location=(1, 2, 3), rotation=(0, 0, np.pi / 2.0))
    cube = bpy.context.object
    cube.scale.x = 3.0
    bpy.context.view_layer.update()
    points = tracking.surface_of(cube, 1.0, bpy.context.evaluated_depsgraph_get())
    assert points.min(axis=0) == pytest.approx([-1.0, -3.0, -1.0], abs=1e-6)
    assert points.max(axis=0) == pytest.approx([1.0, 3.0, 1.0], abs=1e-6)
    on = np.isclose(np.abs(points), [1.0, 3.0, 1.0]).any(axis=1)
    assert on.all()
    assert 200 < len(points) < tracking.MOST_POINTS


def test_a_surface_of_many_triangles_has_not_many_more_points() -> None:
    rng = np.random.default_rng(4)
    assert len(tracking.spread(rng.normal(size=(5000, 3, 3)))) < 4 * tracking.MOST_POINTS
    assert len(tracking.spread(rng.normal(size=(1, 3, 3)))) < tracking.MOST_POINTS


def test_only_what_is_grasped_has_a_surface(ob: bpy.types.Object) -> None:
    bpy.ops.mesh.primitive_ico_sphere_add(radius=0.1, location=(0.3, -0.4, 1.0))
    ball = bpy.context.object
    item = own(ob).command(1, "start", "touch", target=ball)
    clock, graph = reading.Clock.of(bpy.context.scene, {}), bpy.context.evaluated_depsgraph_get()
    turned = np.diag([-1.0, -1.0, 1.0, 1.0])
    assert reading.read(ob, clock, graph, turned, 1.7).targets["Icosphere"].surface is None
    item.model = "grasp"
    surface = reading.read(ob, clock, graph, turned, 1.7).targets["Icosphere"].surface
    assert np.linalg.norm(surface, axis=1) == pytest.approx(np.full(len(surface), 0.1), rel=0.2)
    assert tracking.surface_of(acts.empty_object("Nothing", (0, 0, 0)), 1.0, graph) is None
