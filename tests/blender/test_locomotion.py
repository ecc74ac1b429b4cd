"""Characters that go over the ground: as they are shown, as they are baked, and as the window offers it."""

from collections.abc import Sequence
from pathlib import Path

import bpy
import numpy as np
import pytest
from mathutils import Matrix

from morph_retarget.blender import actions
from morph_retarget.blender.locomotion import properties, walks
from morph_retarget.blender.locomotion.properties import MORPHRETARGET_PG_gait
from morph_retarget.blender.morph import analyses, cast, definitions, keys, paths, perform, stage
from morph_retarget.blender.properties import of_rig
from morph_retarget.blender.ui import locomotion_panel
from morph_retarget.core import play
from morph_retarget.core.arrays import Array
from morph_retarget.core.locomotion.settings import GaitSettings
from tests.blender import acting, acts, scenes
from tests.blender.layouts import drawn

ops = bpy.ops.morph_retarget
FRAMES = [1, 2, 7.5, 31, 32, 60, 100, 180]
WHOLE = [1, 2, 31, 32, 60, 100, 180]
NEAR = 1e-6

pytestmark = pytest.mark.usefixtures("registered")


@pytest.fixture(autouse=True)
def _frames() -> None:
    bpy.context.scene.frame_end = 180


def _walker(kind: str = "biped", **settings: object) -> bpy.types.Object:
    """Return a creature that goes over the ground."""
    ob = acts.creature(kind)
    bpy.context.view_layer.objects.active = ob
    ops.add_locomotion(character=ob.name)
    for name, value in settings.items():
        setattr(_gait(ob), name, value)
    return ob


def _gait(ob: bpy.types.Object) -> MORPHRETARGET_PG_gait:
    return of_rig(ob).gait


def _shown(ob: bpy.types.Object, frames: Sequence[float] = FRAMES) -> Array:
    return acting.shown(ob, frames)


def _root(ob: bpy.types.Object, frames: Sequence[float] = FRAMES) -> Array:
    """Return where the root of a creature is in the world, shape (frame, 3)."""
    _, _, bodies = analyses.of(ob)
    return scenes.heads(ob, [bodies.names[play.root_of(bodies)]], frames)[:, 0]


def _seconds(frames: Sequence[float]) -> Array:
    return (np.array(frames) - 1.0) / scenes.FPS


def _path(points: Sequence[Sequence[float]], kind: str = "POLY", cyclic: bool = False) -> bpy.types.Object:
    """Return a curve through some points."""
    curve = bpy.data.curves.new("Path", "CURVE")
    curve.dimensions = "3D"
    spline = curve.splines.new(kind)
    spline.use_cyclic_u = cyclic
    if kind == "BEZIER":
        spline.bezier_points.add(len(points) - 1)
        for point, place in zip(spline.bezier_points, points, strict=True):
            point.co, point.handle_left_type, point.handle_right_type = place, "AUTO", "AUTO"
    else:
        spline.points.add(len(points) - 1)
        for point, place in zip(spline.points, points, strict=True):
            point.co = (*place, 1.0)
    return _object("Path", curve)


def _object(name: str, data: bpy.types.ID | None) -> bpy.types.Object:
    ob = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(ob)
    bpy.context.view_layer.update()
    return ob


def _plane(size: float, height: float, slope: float = 0.0) -> bpy.types.Object:
    """Return a mesh whose height rises by ``slope`` along -Y."""
    mesh = bpy.data.meshes.new("Hill")
    corners = [(x, y, height - slope * y) for x, y in ((-size, -size), (size, -size), (size, size), (-size, size))]
    mesh.from_pydata(corners, [], [(0, 1, 2, 3)])
    return _object("Hill", mesh)


# --- going ---


@pytest.mark.parametrize("kind", ["biped", "hound", "beetle", "snake"])
def test_a_character_goes_ahead_at_its_speed_on_average(kind: str) -> None:
    ob = _walker(kind, speed=0.5)
    way = _root(ob, [61, 121])
    assert -(way[1] - way[0])[1] == pytest.approx(0.5 * 60 / scenes.FPS, rel=0.1)
    assert not walks.problems
    assert not cast.problems


def test_it_turns_to_its_left_and_goes_where_it_is_told_to() -> None:
    ob = _walker(speed=1.0, turn_rate=np.pi / 2.0)
    quarter = _root(ob, [1, 1 + scenes.FPS])
    assert quarter[1] == pytest.approx(quarter[0] + np.array([2.0, -2.0, 0.0]) / np.pi, abs=0.1)
    _gait(ob).turn_rate, _gait(ob).direction = 0.0, np.pi / 2.0
    side = _root(ob, [31, 61])
    assert (side[1] - side[0])[:2] == pytest.approx([1.0, 0.0], abs=0.1)


@pytest.mark.parametrize("kind", ["biped", "snake"])
def test_what_is_shown_depends_on_the_frame_alone(kind: str) -> None:
    ob = _walker(kind, turn_rate=0.5)
    forward = _shown(ob)
    order = np.random.default_rng(3).permutation(len(FRAMES))
    assert scenes.difference(_shown(ob, [FRAMES[i] for i in order]), forward[order]) == 0.0
    perform.forget()
    cast.forget(rig=True)
    assert scenes.difference(_shown(ob, FRAMES[3:4]), forward[3:4]) < NEAR


@pytest.mark.parametrize("kind", ["biped", "hound", "beetle", "snake"])
def test_baked_keys_are_what_was_shown_live(kind: str) -> None:
    ob = _walker(kind, turn_rate=0.3)
    ob.location, ob.rotation_euler = (2.0, -1.0, 0.4), (0.0, 0.0, 2.0)
    live = _shown(ob, WHOLE)
    acting.baked(ob)
    assert not definitions.is_generalized(ob.animation_data.action)
    assert scenes.difference(_shown(ob, WHOLE), live) < NEAR


def test_a_bake_lasts_as_long_as_the_scene() -> None:
    ob = _walker()
    assert ops.bake_action(character=ob.name) == {"FINISHED"}
    assert tuple(ob.animation_data.action.frame_range) == (1.0, 180.0)


def test_standing_feet_do_not_slide_whatever_the_speed_does() -> None:
    ob = _walker()
    for frame, speed in ((1, 0.0), (40, 2.0), (90, 0.5)):
        _key(ob, "speed", frame, speed)
    frames = np.arange(1.0, 120.0)
    _shown(ob, [1])
    walk = walks.known(ob, bpy.context.scene)
    stands = walk.gait.contacts(walk.clock.times(frames))
    feet = [walk.gait.character.skeleton.names[leg.foot] for leg in walk.gait.legs.legs]
    places = scenes.heads(ob, feet, frames)
    both = stands[1:] & stands[:-1]
    assert both.any(axis=0).all()
    # A foot that rolls goes on over its heel and ball with its ankle, yet never as fast as the body.
    steps = np.linalg.norm(np.diff(places, axis=0)[..., :2], axis=-1)
    body = np.linalg.norm(np.diff(_root(ob, frames), axis=0)[:, :2], axis=-1)
    assert steps[both].mean() < 0.35 * body.mean()


def _key(ob: bpy.types.Object, name: str, frame: float, value: float) -> None:
    setattr(_gait(ob), name, value)
    ob.keyframe_insert(f"morph_retarget.gait.{name}", frame=frame)


# --- keys ---


def test_keys_of_the_speed_are_followed_live_and_when_they_are_moved() -> None:
    ob = _walker(speed=1.0)
    steady = _root(ob, [180])
    for frame, speed in ((1, 1.0), (60, 1.0), (61, 2.0)):
        _key(ob, "speed", frame, speed)
    fast = _root(ob, [180])
    assert -(fast - steady)[0, 1] == pytest.approx(120 / scenes.FPS, rel=0.1)
    curve = keys.curves(cast.action_of(ob))["morph_retarget.gait.speed", 0]
    for point in curve.keyframe_points:
        point.co_ui[1] = 1.0
    curve.update()
    bpy.context.view_layer.update()
    assert scenes.difference(_root(ob, [180]), steady) < 1e-4


def test_the_button_keys_the_speed_in_the_action_that_all_share() -> None:
    ob = _walker(speed=1.5)
    bpy.context.scene.frame_set(10)
    assert ops.key_locomotion(character=ob.name) == {"FINISHED"}
    ops.key_locomotion(character=ob.name, setting="weight")
    found = actions.curves(*actions.assigned(ob))
    assert {path for path, _ in found} == {"morph_retarget.gait.speed", "morph_retarget.gait.weight"}
    assert found["morph_retarget.gait.speed", 0].keyframe_points[0].co[:] == pytest.approx((10.0, 1.5))


def test_a_weight_that_is_keyed_fades_the_gait_live_and_baked() -> None:
    ob = _walker(speed=1.0)
    whole = _root(ob, [60])
    for frame, weight in ((1, 1.0), (59, 1.0), (60, 0.5), (61, 0.0)):
        _key(ob, "weight", frame, weight)
    rest = scenes.heads(ob, ["Hips"], [61])
    live = _shown(ob, [30, 60, 61])
    half = _root(ob, [60])
    assert half[0, 1] == pytest.approx(0.5 * whole[0, 1], rel=0.1)
    assert rest[0, 0] == pytest.approx(np.array(ob.data.bones["Hips"].head_local), abs=1e-5)
    acting.baked(ob)
    assert scenes.difference(_shown(ob, [30, 60, 61]), live) < NEAR


def test_speeds_that_drivers_give_are_baked_and_told_of_live() -> None:
    ob = _walker()
    driver = ob.driver_add("morph_retarget.gait.speed").driver
    driver.expression = "0.02 * frame"
    bpy.context.scene.frame_set(5)
    assert "drivers of its locomotion cannot be followed live" in walks.problems[ob.session_uid]
    assert scenes.difference(_root(ob, [100]), _root(ob, [1])) < 1e-6, "it stands meanwhile"
    acting.baked(ob)
    way = -_root(ob, [181])[0, 1] + _root(ob, [1])[0, 1]
    assert way > 1.0


# --- paths, the ground, its own motion ---


@pytest.mark.parametrize("kind", ["POLY", "BEZIER", "NURBS"])
def test_it_goes_along_a_curve_wherever_both_are(kind: str) -> None:
    path = _path([(0, 0, 0), (0, -4, 0), (0, -8, 0), (0, -16, 0)], kind)
    path.location, path.rotation_euler = (3.0, 1.0, 0.0), (0.0, 0.0, 0.5)
    ob = _walker(speed=1.0, source="PATH", path=path)
    ob.location = (-1.0, 0.5, 0.0)
    ob.rotation_euler = (0.0, 0.0, 1.0)
    bpy.context.view_layer.update()
    places = _root(ob, [1, 61, 121])
    inside = (np.linalg.inv(np.array(path.matrix_world)) @ np.append(places, np.ones((3, 1)), axis=1).T).T
    assert np.abs(inside[:, 0]).max() < 0.15
    assert -np.diff(inside[:, 1]) == pytest.approx([2.0, 2.0], abs=0.2)


def test_a_curve_with_thickness_is_the_same_path() -> None:
    path = _path([(0, 0, 0), (1, -3, 0), (0, -9, 0)], "BEZIER")
    ob = _walker(speed=1.0, source="PATH", path=path)
    before = _root(ob)
    path.data.bevel_depth = 0.2
    bpy.context.view_layer.update()
    assert scenes.difference(_root(ob), before) < 1e-3


def test_an_edited_path_is_followed_at_once() -> None:
    path = _path([(0, 0, 0), (0, -9, 0)])
    ob = _walker(speed=1.0, source="PATH", path=path)
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
    live = _shown(ob, WHOLE)
    acting.baked(ob)
    assert scenes.difference(_shown(ob, WHOLE), live) < NEAR


def test_a_path_that_moves_counts_as_it_is_at_the_first_frame() -> None:
    path = _path([(0, 0, 0), (0, -9, 0)])
    for frame, x in ((1, 1.0), (100, 9.0)):
        path.location.x = x
        path.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_set(50)
    ob = _walker(speed=1.0, source="PATH", path=path)
    assert _root(ob, [61, 121])[:, 0] == pytest.approx([1.0, 1.0], abs=0.1)


def _shown_now(ob: bpy.types.Object) -> Array:
    """Return where the bones are in the world that Blender shows now, but for the one that carries all."""
    return acts.heads(ob, ob.pose.bones.keys()[1:])


def test_it_goes_up_a_hill_that_is_edited() -> None:
    ob = _walker(speed=1.0, ground=_plane(20.0, 0.0, 0.2))
    climbed = np.diff(_root(ob, [31, 151])[:, 2])
    assert climbed == pytest.approx([0.2 * 4.0], abs=0.1)
    ground = _gait(ob).ground
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
    ob = _walker(speed=2.0, ground=_plane(40.0, 0.0, 2.0))
    assert np.diff(_root(ob, [31, 151])[:, 2])[0] > 10.0


@pytest.mark.parametrize("how", ["keys", "parent"])
def test_feet_stay_where_they_are_put_while_the_object_moves(how: str) -> None:
    ob = _walker(source="OWN")
    mover = ob
    if how == "parent":
        mover = _object("Cart", None)
        ob.parent = mover
    for frame, y in ((1, 0.0), (180, -6.0)):
        mover.location.y = y
        mover.keyframe_insert("location", frame=frame)
    bpy.context.view_layer.update()
    frames = np.arange(60.0, 120.0)
    way = np.diff(_root(ob, [60, 119]), axis=0)[0]
    assert way == pytest.approx([0.0, -1.5 * 6.0 * 59.0 / 179.0, 0.0], abs=0.2), "keys are eased"
    assert not walks.problems
    walk = walks.known(ob, bpy.context.scene)
    assert walk.is_carried
    stands = walk.gait.contacts(walk.clock.times(frames))
    feet = [walk.gait.character.skeleton.names[leg.foot] for leg in walk.gait.legs.legs]
    steps = np.linalg.norm(np.diff(scenes.heads(ob, feet, frames), axis=0)[..., :2], axis=-1)
    both = stands[1:] & stands[:-1]
    assert steps[both].mean() < 0.35 * 6.0 / 179.0
    live = _shown(ob, WHOLE)
    acting.baked(ob)
    assert scenes.difference(_shown(ob, WHOLE), live) < 1e-5


def test_an_object_that_a_constraint_moves_goes_when_it_is_baked() -> None:
    path = _path([(0, 0, 0), (0, -9, 0)])
    path.data.use_path, path.data.path_duration = True, 180
    ob = _walker(source="OWN")
    constraint = ob.constraints.new("FOLLOW_PATH")
    constraint.target, constraint.use_fixed_location = path, True
    for frame, share in ((1, 0.0), (180, 1.0)):
        constraint.offset_factor = share
        constraint.keyframe_insert("offset_factor", frame=frame)
    _shown(ob, [60])
    assert "what moves its object cannot be followed live" in walks.problems[ob.session_uid]
    bpy.context.scene.frame_set(42)
    (outcome,) = acting.baked(ob)
    assert bpy.context.scene.frame_current == 42
    assert outcome.take.walk is not None
    assert outcome.take.walk.frames is not None
    stands = outcome.take.walk.walk.gait.contacts(outcome.take.walk.walk.clock.times(np.arange(60.0, 120.0)))
    assert not stands.all()


# --- with an action ---


def test_a_generalized_action_plays_on_top() -> None:
    ob = acts.creature("biped")
    acting.dip(ob)
    still = scenes.heads(ob, ["Hand.L", "Hips"], [11])[0]
    ops.add_locomotion(character=ob.name)
    assert cast.action_of(ob).name == "Dip"
    going = scenes.heads(ob, ["Hand.L", "Hips", "Foot.L"], [11])[0]
    assert scenes.difference((going[0] - going[1])[2:], (still[0] - still[1])[2:]) < 0.1, (
        "the hand is lowered with the body"
    )
    assert going[1, 1] < still[1, 1] - 0.2
    live = _shown(ob, [1, 5, 11, 21, 60])
    acting.baked(ob)
    assert scenes.difference(_shown(ob, [1, 5, 11, 21, 60]), live) < NEAR


def _carried(ob: bpy.types.Object, frames: Array) -> Array:
    """Return where the ground under the body has moved to, character frame, shape (frame, 3)."""
    layer = walks.over(cast.member(ob), bpy.context.scene, bpy.context.evaluated_depsgraph_get(), frames)
    assert layer is not None
    return layer.places


@pytest.mark.parametrize(("kind", "near"), [("biped", 0.17), ("hound", 0.08), ("beetle", 0.08), ("snake", 1e-3)])
def test_an_action_goes_up_a_hill_with_the_body(kind: str, near: float) -> None:
    ob = _walker(kind, speed=1.0, ground=_plane(20.0, 0.0, 0.3))
    places = _carried(ob, np.arange(31.0, 151.0, 0.5))
    assert np.ptp(places[:, 2]) > 1.0
    # What has feet rises with its steps, of which one of the biped climbs 0.17 m; the frame begins where the body does.
    assert np.ptp(places[:, 2] + 0.3 * places[:, 1]) < near


@pytest.mark.parametrize("slope", [0.0, 0.3])
def test_a_hand_stays_as_high_over_the_ground_as_its_action_says(slope: float) -> None:
    ob = acts.creature("biped")
    made = acting.action("Hands", [acting.LEFT_HAND])
    acting.play(made, ob, keyed={"Left hand": {1: (0.0, -0.3, 0.3)}})
    still = scenes.heads(ob, ["Hand.L"], [1])[0, 0, 2]
    bpy.context.view_layer.objects.active = ob
    ops.add_locomotion(character=ob.name)
    _gait(ob).speed, _gait(ob).ground = 1.0, _plane(20.0, 0.0, slope)
    frames = np.arange(31.0, 151.0, 7.0)
    hand, places = scenes.heads(ob, ["Hand.L"], frames)[:, 0, 2], _carried(ob, frames)
    assert hand == pytest.approx(places[:, 2] + still, abs=0.03), "its goal is in reach"
    # The body rises with its steps: it is off the slope by what half of a step climbs.
    assert hand == pytest.approx(still - slope * places[:, 1], abs=0.02 + 0.3 * slope)


def test_a_hand_that_is_moved_on_the_way_is_meant_as_if_the_body_stood() -> None:
    ob = acts.creature("biped")
    made = acting.action("Hands", [acting.HANDS])
    acting.play(made, ob)
    bpy.context.view_layer.objects.active = ob
    ops.add_locomotion(character=ob.name)
    _gait(ob).turn_rate = 1.0
    bpy.context.scene.frame_set(50)
    ob.select_set(True)
    bpy.ops.object.mode_set(mode="POSE")
    ob.data.bones.active = ob.data.bones["Hand.L"]
    bone = ob.pose.bones["Hand.L"]
    assert of_rig(ob).channels["Hands"].position[:] == (0.0, 0.0, 0.0)
    bone.matrix = Matrix.Translation((0.0, 0.0, 0.1)) @ bone.matrix
    bpy.context.view_layer.update()
    x, y, z = of_rig(ob).channels["Hands"].position
    bodies = cast.member(ob).bodies
    assert z == pytest.approx(0.1 / bodies.limb_lengths[bodies.names.index("Hand.L")], rel=0.5)
    assert np.hypot(x, y) < 0.1, "it has gone more than a metre meanwhile"


def test_the_motion_path_of_a_channel_goes_along() -> None:
    ob = acts.creature("biped")
    acting.dip(ob)
    bpy.context.view_layer.objects.active = ob
    ops.add_locomotion(character=ob.name)
    bpy.context.scene.frame_end = 21
    bpy.context.scene.frame_set(11)
    found = paths.path_of(ob, bpy.context.scene, bpy.context.evaluated_depsgraph_get())
    assert found is not None
    member, shown = cast.member(ob), perform.shown(ob)
    entry = paths.entry_shown(member, ob)
    assert entry is not None
    assert shown is not None
    goal = shown.played.goals.bodies.tolist().index(member.part.binding.entries[entry].body)
    wanted = member.character.local_to_character.inverse().points(shown.played.goals.positions[0, goal])
    assert found.line[10] == pytest.approx(wanted, abs=1e-5)
    assert found.line[-1, 1] - found.line[0, 1] == pytest.approx(-1.2 * 20 / scenes.FPS, abs=0.02)


def test_jiggles_feel_the_way() -> None:
    hound = _walker("hound", speed=2.0)
    of_rig(hound).jiggles.enabled = True
    live = _shown(hound, WHOLE)
    assert scenes.difference(_shown(hound, WHOLE[::-1])[::-1], live) < NEAR
    of_rig(hound).jiggles.enabled = False
    assert scenes.difference(_shown(hound, WHOLE), live) > 0.005
    of_rig(hound).jiggles.enabled = True
    acting.baked(hound)
    assert scenes.difference(_shown(hound, WHOLE), live) < 1e-5


def test_who_follows_a_bone_of_one_that_goes_finds_it_where_it_is() -> None:
    leader = _walker("biped", speed=1.0)
    bpy.context.scene.frame_set(100)
    place = stage.place_of(leader, "Head", bpy.context.evaluated_depsgraph_get())
    assert place == pytest.approx(scenes.heads(leader, ["Head"], [100])[0, 0], abs=1e-4)


# --- settings ---


def test_untouched_settings_are_those_of_the_core() -> None:
    assert _gait(acts.creature("biped")).settings() == GaitSettings()


def test_layers_and_groups_of_legs_arrive() -> None:
    ob = _walker("hound", style="trot")
    ops.add_gait_style(character=ob.name, style="limp")
    _gait(ob).layers[0].weight = 0.4
    ops.add_gait_style(character=ob.name, style="pace", group=1)
    found = _gait(ob).settings()
    assert found.styles == (("trot", 1.0), ("limp", 0.4))
    assert found.of_group == {0: (("pace", 1.0),)}
    assert ops.remove_gait_style(character=ob.name) == {"FINISHED"}
    assert len(_gait(ob).layers) == 1
    ops.remove_gait_style(character=ob.name)
    with pytest.raises(RuntimeError, match="no such style"):
        ops.remove_gait_style(character=ob.name)


@pytest.mark.parametrize(
    ("name", "value"),
    [("style", "run"), ("stride", 0.5), ("step_height", 2.0), ("crouch", 0.2), ("width", 0.2), ("body", 0.0),
     ("arms", 0.0), ("foot_roll", 0.0), ("movement", "float"), ("speed", 0.3), ("turn_rate", 0.4), ("direction", 1.0)],
)  # fmt: skip
def test_a_setting_is_followed_at_once_and_back(name: str, value: object) -> None:
    ob = _walker()
    bpy.context.scene.frame_set(47)
    before, was = acts.pose(ob), getattr(_gait(ob), name)
    setattr(_gait(ob), name, value)
    bpy.context.view_layer.update()
    assert not cast.problems
    assert scenes.difference(acts.pose(ob), before) > 1e-4
    setattr(_gait(ob), name, was)
    bpy.context.view_layer.update()
    assert scenes.difference(acts.pose(ob), before) < NEAR


def test_a_gait_is_prepared_once_while_nothing_is_edited(monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[int] = []
    plain = walks.Walk.of
    monkeypatch.setattr(walks.Walk, "of", lambda *given: (made.append(1), plain(*given))[1])
    ob = _walker(ground=_plane(20.0, 0.0))
    bpy.context.scene.frame_set(2)
    made.clear()
    for frame in (1, 5, 9, 33):
        bpy.context.scene.frame_set(frame)
    bpy.context.view_layer.update()
    _gait(ob).ground.select_set(True)
    bpy.context.view_layer.update()
    assert not made


def test_only_what_may_change_over_time_can_be_keyed() -> None:
    rna = MORPHRETARGET_PG_gait.bl_rna.properties
    assert {name for name, prop in rna.items() if prop.type == "FLOAT" and prop.is_animatable} == set(properties.KEYED)


def test_names_and_descriptions_say_what_settings_do() -> None:
    for group in properties.CLASSES:
        for name, prop in group.bl_rna.properties.items():
            if name not in {"rna_type", "name"}:
                assert prop.name
                assert len(prop.description) > 15
                assert not prop.description.endswith(".")


# --- what cannot be ---


def test_a_path_that_is_missing_or_leads_nowhere_is_told_and_the_rest_stands() -> None:
    ob = _walker(source="PATH")
    bpy.context.scene.frame_set(30)
    assert "goes along a path and has none" in walks.problems[ob.session_uid]
    assert "goes along a path and has none" in " ".join(drawn(locomotion_panel.MORPHRETARGET_PT_locomotion).texts)
    with pytest.raises(RuntimeError, match="choose a curve"):
        ops.bake_action(character=ob.name)
    _gait(ob).path = _path([(0, 0, 0), (0, 0, 0)])
    bpy.context.view_layer.update()
    assert "leads nowhere" in walks.problems[ob.session_uid]
    _gait(ob).path = _object("Nothing", bpy.data.curves.new("Nothing", "CURVE"))
    bpy.context.view_layer.update()
    assert "has no spline" in walks.problems[ob.session_uid]
    _gait(ob).path = _path([(0, 0, 0), (0, -9, 0)])
    bpy.context.view_layer.update()
    assert not walks.problems


def test_objects_of_the_wrong_kind_are_told() -> None:
    ob = _walker(source="PATH")
    _gait(ob).path = _plane(1.0, 0.0)
    bpy.context.scene.frame_set(3)
    assert "cannot be a path: choose a curve" in walks.problems[ob.session_uid]
    _gait(ob).source = "SPEED"
    _gait(ob).ground = _path([(0, 0, 0), (0, -9, 0)])
    bpy.context.view_layer.update()
    assert "cannot be the ground: choose a mesh" in walks.problems[ob.session_uid]


def test_a_path_that_is_deleted_leaves_the_character_standing() -> None:
    ob = _walker(source="PATH", path=_path([(0, 0, 0), (0, -9, 0)]))
    _shown(ob, [30])
    bpy.data.objects.remove(_gait(ob).path)
    bpy.context.view_layer.update()
    bpy.context.scene.frame_set(31)
    assert "has none" in walks.problems[ob.session_uid]


def test_speeds_beyond_all_measure_are_held() -> None:
    ob = _walker(speed=1e9)
    assert _gait(ob).speed == properties.FASTEST
    assert np.isfinite(_shown(ob)).all()


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
    _gait(ob()).speed = 2.0
    bpy.context.view_layer.update()
    bpy.ops.ed.undo_push(message="speed")
    fast = acts.pose(ob())
    bpy.ops.ed.undo()
    assert scenes.difference(acts.pose(ob()), going) < NEAR
    bpy.ops.ed.undo()
    assert not _gait(ob()).enabled
    assert scenes.difference(acts.pose(ob()), rest) < NEAR
    bpy.ops.ed.redo()
    bpy.ops.ed.redo()
    assert scenes.difference(acts.pose(ob()), fast) < NEAR


def test_removing_it_puts_the_character_back_and_keeps_the_settings() -> None:
    ob = _walker(stride=0.7)
    bpy.context.scene.frame_set(60)
    assert ops.remove_locomotion(character=ob.name) == {"FINISHED"}
    bpy.context.view_layer.update()
    assert cast.action_of(ob) is None
    rest = np.array([bone.matrix_local for bone in ob.data.bones])
    assert scenes.difference(acts.pose(ob), rest) < 1e-5
    assert round(_gait(ob).stride, 3) == 0.7
    with pytest.raises(RuntimeError, match="No character has locomotion"):
        ops.remove_locomotion(character=ob.name)


def test_removing_it_leaves_the_action_that_plays() -> None:
    ob = acts.creature("biped")
    acting.dip(ob)
    before = _shown(ob, [11])
    ops.add_locomotion(character=ob.name)
    ops.remove_locomotion(character=ob.name)
    assert cast.action_of(ob).name == "Dip"
    assert scenes.difference(_shown(ob, [11]), before) < NEAR


def test_several_share_an_action_and_each_has_settings_of_its_own() -> None:
    pair = [acts.creature("biped"), acts.creature("hound")]
    for ob in pair:
        ob.select_set(True)
    ops.add_locomotion()
    assert cast.action_of(pair[0]) == cast.action_of(pair[1])
    _gait(pair[0]).speed = 0.3
    ways = [_root(ob, [31, 91]) for ob in pair]
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
    _gait(ob).source = "PATH"
    names = dict(drawn(*panels).props).keys()
    assert "path" in names
    assert "turn_rate" not in names
    ops.add_gait_style(character=ob.name, style="limp", group=1)
    found = drawn(*panels)
    assert {"Limp", "Legs 1"} <= set(found.texts)
    assert {"weight", "group"} <= dict(found.props).keys()


def test_the_diagram_shows_when_each_foot_stands() -> None:
    _walker("hound", style="trot", speed=1.5)
    bpy.context.scene.frame_set(40)
    texts = drawn(locomotion_panel.MORPHRETARGET_PT_locomotion).texts
    feet = [texts.index(name) for name in ("FrontPaw.L", "FrontPaw.R", "HindPaw.L", "HindPaw.R")]
    rows = [texts[i + 1].translate(str.maketrans("▓▒", "█░")) for i in feet]
    assert all(set(row) == {"█", "░"} for row in rows)
    assert rows[0] == rows[3] != rows[1] == rows[2], "a trot has diagonal pairs"


def test_drawing_changes_nothing() -> None:
    ob = _walker()
    walks.forget()
    drawn(*locomotion_panel.CLASSES[1:])
    assert walks.known(ob, bpy.context.scene) is None


# --- files ---


def test_files_keep_it_and_show_the_same_after_loading(tmp_path: Path) -> None:
    ob = _walker("hound", speed=1.4, turn_rate=0.2)
    _gait(ob).add("limp").weight = 0.5
    live = _shown(ob, WHOLE)
    path = scenes.save(tmp_path / "hound.blend")
    bpy.ops.wm.open_mainfile(filepath=str(path))
    ob = bpy.data.objects["Hound"]
    assert definitions.is_generalized(ob.animation_data.action)
    assert _gait(ob).layers[0].style == "limp"
    assert scenes.difference(_shown(ob, WHOLE[::-1])[::-1], live) < NEAR


def test_characters_that_are_overridden_have_their_own(tmp_path: Path) -> None:
    _walker("biped", speed=1.0)
    library = scenes.save(tmp_path / "library.blend")
    scenes.empty()
    bpy.context.scene.frame_end = 180
    ob = scenes.link(library, "Biped").override_create(remap_local_usages=True)
    slow = _root(ob, [100])
    _gait(ob).speed = 2.0
    _gait(ob).add("sneak").weight = 0.5
    fast = _shown(ob, [100])
    assert scenes.difference(_root(ob, [100]), slow) > 1.0
    path = scenes.save(tmp_path / "scene.blend")
    scenes.empty()
    bpy.ops.wm.open_mainfile(filepath=str(path))
    (ob,) = [ob for ob in bpy.context.scene.objects if ob.type == "ARMATURE"]
    assert ob.override_library is not None
    assert _gait(ob).layers[0].style == "sneak"
    assert scenes.difference(_shown(ob, [100]), fast) < NEAR


def test_a_linked_character_goes_as_its_library_says(tmp_path: Path) -> None:
    live = _shown(_walker("biped", speed=1.0), WHOLE)
    library = scenes.save(tmp_path / "library.blend")
    scenes.empty()
    bpy.context.scene.frame_end = 180
    with bpy.data.libraries.load(str(library), link=True) as (_, wanted):
        wanted.objects = ["Biped"]
    ob = bpy.data.objects["Biped"]
    bpy.context.scene.collection.objects.link(ob)
    assert scenes.difference(_shown(ob, WHOLE), live) < NEAR
