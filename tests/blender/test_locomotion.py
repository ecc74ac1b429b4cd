"""Characters that go over the ground: as they are shown and baked, by keys and settings, and what cannot be."""

import bpy
import numpy as np
import pytest

from morph_retarget.blender import actions
from morph_retarget.blender.locomotion import properties, walks
from morph_retarget.blender.locomotion.properties import MORPHRETARGET_PG_gait
from morph_retarget.blender.morph import cast, definitions, keys, perform
from morph_retarget.blender.ui import locomotion_panel
from morph_retarget.core.locomotion.settings import GaitSettings
from tests.blender import acting, acts, scenes, walking
from tests.blender.layouts import drawn
from tests.blender.walking import FRAMES, WHOLE

ops = bpy.ops.morph_retarget
NEAR = 1e-6

pytestmark = pytest.mark.usefixtures("registered", "walked")


# --- going ---


@pytest.mark.parametrize("kind", ["biped", "hound", "beetle", "snake"])
def test_a_character_goes_ahead_at_its_speed_on_average(kind: str) -> None:
    ob = walking.walker(kind, speed=0.5)
    way = walking.root(ob, [61, 121])
    assert -(way[1] - way[0])[1] == pytest.approx(0.5 * 60 / scenes.FPS, rel=0.1)
    assert not walks.problems
    assert not cast.problems


def test_it_turns_to_its_left_and_goes_where_it_is_told_to() -> None:
    ob = walking.walker(speed=1.0, turn_rate=np.pi / 2.0)
    quarter = walking.root(ob, [1, 1 + scenes.FPS])
    assert quarter[1] == pytest.approx(quarter[0] + np.array([2.0, -2.0, 0.0]) / np.pi, abs=0.1)
    walking.gait(ob).turn_rate, walking.gait(ob).direction = 0.0, np.pi / 2.0
    side = walking.root(ob, [31, 61])
    assert (side[1] - side[0])[:2] == pytest.approx([1.0, 0.0], abs=0.1)


@pytest.mark.parametrize("kind", ["biped", "snake"])
def test_what_is_shown_depends_on_the_frame_alone(kind: str) -> None:
    ob = walking.walker(kind, turn_rate=0.5)
    forward = walking.shown(ob)
    order = np.random.default_rng(3).permutation(len(FRAMES))
    assert scenes.difference(walking.shown(ob, [FRAMES[i] for i in order]), forward[order]) == 0.0
    perform.forget()
    cast.forget(rig=True)
    assert scenes.difference(walking.shown(ob, FRAMES[3:4]), forward[3:4]) < NEAR


@pytest.mark.parametrize("kind", ["biped", "hound", "beetle", "snake"])
def test_baked_keys_are_what_was_shown_live(kind: str) -> None:
    ob = walking.walker(kind, turn_rate=0.3)
    ob.location, ob.rotation_euler = (2.0, -1.0, 0.4), (0.0, 0.0, 2.0)
    live = walking.shown(ob, WHOLE)
    acting.baked(ob)
    assert not definitions.is_generalized(ob.animation_data.action)
    assert scenes.difference(walking.shown(ob, WHOLE), live) < NEAR


def test_a_bake_lasts_as_long_as_the_scene() -> None:
    ob = walking.walker()
    assert ops.bake_action(character=ob.name) == {"FINISHED"}
    assert tuple(ob.animation_data.action.frame_range) == (1.0, 180.0)


def test_standing_feet_do_not_slide_whatever_the_speed_does() -> None:
    ob = walking.walker()
    for frame, speed in ((1, 0.0), (40, 2.0), (90, 0.5)):
        _key(ob, "speed", frame, speed)
    frames = np.arange(1.0, 120.0)
    walking.shown(ob, [1])
    walk = walks.known(ob, bpy.context.scene)
    stands = walk.gait.contacts(walk.clock.times(frames))
    feet = [walk.gait.character.skeleton.names[leg.foot] for leg in walk.gait.legs.legs]
    places = scenes.heads(ob, feet, frames)
    both = stands[1:] & stands[:-1]
    assert both.any(axis=0).all()
    # A foot that rolls goes on over its heel and ball with its ankle, yet never as fast as the body.
    steps = np.linalg.norm(np.diff(places, axis=0)[..., :2], axis=-1)
    body = np.linalg.norm(np.diff(walking.root(ob, frames), axis=0)[:, :2], axis=-1)
    assert steps[both].mean() < 0.35 * body.mean()


def _key(ob: bpy.types.Object, name: str, frame: float, value: float) -> None:
    setattr(walking.gait(ob), name, value)
    ob.keyframe_insert(f"morph_retarget.gait.{name}", frame=frame)


# --- keys ---


def test_keys_of_the_speed_are_followed_live_and_when_they_are_moved() -> None:
    ob = walking.walker(speed=1.0)
    steady = walking.root(ob, [180])
    for frame, speed in ((1, 1.0), (60, 1.0), (61, 2.0)):
        _key(ob, "speed", frame, speed)
    fast = walking.root(ob, [180])
    assert -(fast - steady)[0, 1] == pytest.approx(120 / scenes.FPS, rel=0.1)
    curve = keys.curves(cast.action_of(ob))["morph_retarget.gait.speed", 0]
    for point in curve.keyframe_points:
        point.co_ui[1] = 1.0
    curve.update()
    bpy.context.view_layer.update()
    assert scenes.difference(walking.root(ob, [180]), steady) < 1e-4


def test_the_button_keys_the_speed_in_the_action_that_all_share() -> None:
    ob = walking.walker(speed=1.5)
    bpy.context.scene.frame_set(10)
    assert ops.key_locomotion(character=ob.name) == {"FINISHED"}
    ops.key_locomotion(character=ob.name, setting="weight")
    found = actions.curves(*actions.assigned(ob))
    assert {path for path, _ in found} == {"morph_retarget.gait.speed", "morph_retarget.gait.weight"}
    assert found["morph_retarget.gait.speed", 0].keyframe_points[0].co[:] == pytest.approx((10.0, 1.5))


def test_a_weight_that_is_keyed_fades_the_gait_live_and_baked() -> None:
    ob = walking.walker(speed=1.0)
    whole = walking.root(ob, [60])
    for frame, weight in ((1, 1.0), (59, 1.0), (60, 0.5), (61, 0.0)):
        _key(ob, "weight", frame, weight)
    rest = scenes.heads(ob, ["Hips"], [61])
    live = walking.shown(ob, [30, 60, 61])
    half = walking.root(ob, [60])
    assert half[0, 1] == pytest.approx(0.5 * whole[0, 1], rel=0.1)
    assert rest[0, 0] == pytest.approx(np.array(ob.data.bones["Hips"].head_local), abs=1e-5)
    acting.baked(ob)
    assert scenes.difference(walking.shown(ob, [30, 60, 61]), live) < NEAR


def test_speeds_that_drivers_give_are_baked_and_told_of_live() -> None:
    ob = walking.walker()
    driver = ob.driver_add("morph_retarget.gait.speed").driver
    driver.expression = "0.02 * frame"
    bpy.context.scene.frame_set(5)
    assert "drivers of its locomotion cannot be followed live" in walks.problems[ob.session_uid]
    assert scenes.difference(walking.root(ob, [100]), walking.root(ob, [1])) < 1e-6, "it stands meanwhile"
    acting.baked(ob)
    way = -walking.root(ob, [181])[0, 1] + walking.root(ob, [1])[0, 1]
    assert way > 1.0


# --- settings ---


def test_untouched_settings_are_those_of_the_core() -> None:
    assert walking.gait(acts.creature("biped")).settings() == GaitSettings()


def test_layers_and_groups_of_legs_arrive() -> None:
    ob = walking.walker("hound", style="trot")
    ops.add_gait_style(character=ob.name, style="limp")
    walking.gait(ob).layers[0].weight = 0.4
    ops.add_gait_style(character=ob.name, style="pace", group=1)
    found = walking.gait(ob).settings()
    assert found.styles == (("trot", 1.0), ("limp", 0.4))
    assert found.of_group == {0: (("pace", 1.0),)}
    assert ops.remove_gait_style(character=ob.name) == {"FINISHED"}
    assert len(walking.gait(ob).layers) == 1
    ops.remove_gait_style(character=ob.name)
    with pytest.raises(RuntimeError, match="no such style"):
        ops.remove_gait_style(character=ob.name)


@pytest.mark.parametrize(
    ("name", "value"),
    [("style", "run"), ("stride", 0.5), ("step_height", 2.0), ("crouch", 0.2), ("width", 0.2), ("body", 0.0),
     ("arms", 0.0), ("foot_roll", 0.0), ("movement", "float"), ("speed", 0.3), ("turn_rate", 0.4), ("direction", 1.0)],
)  # fmt: skip
def test_a_setting_is_followed_at_once_and_back(name: str, value: object) -> None:
    ob = walking.walker()
    bpy.context.scene.frame_set(47)
    before, was = acts.pose(ob), getattr(walking.gait(ob), name)
    setattr(walking.gait(ob), name, value)
    bpy.context.view_layer.update()
    assert not cast.problems
    assert scenes.difference(acts.pose(ob), before) > 1e-4
    setattr(walking.gait(ob), name, was)
    bpy.context.view_layer.update()
    assert scenes.difference(acts.pose(ob), before) < NEAR


def test_a_gait_is_prepared_once_while_nothing_is_edited(monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[int] = []
    plain = walks.Walk.of
    monkeypatch.setattr(walks.Walk, "of", lambda *given: (made.append(1), plain(*given))[1])
    ob = walking.walker(ground=walking.plane(20.0, 0.0))
    bpy.context.scene.frame_set(2)
    made.clear()
    for frame in (1, 5, 9, 33):
        bpy.context.scene.frame_set(frame)
    bpy.context.view_layer.update()
    walking.gait(ob).ground.select_set(True)
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
    ob = walking.walker(source="PATH")
    bpy.context.scene.frame_set(30)
    assert "goes along a path and has none" in walks.problems[ob.session_uid]
    assert "goes along a path and has none" in " ".join(drawn(locomotion_panel.MORPHRETARGET_PT_locomotion).texts)
    with pytest.raises(RuntimeError, match="choose a curve"):
        ops.bake_action(character=ob.name)
    walking.gait(ob).path = walking.path([(0, 0, 0), (0, 0, 0)])
    bpy.context.view_layer.update()
    assert "leads nowhere" in walks.problems[ob.session_uid]
    walking.gait(ob).path = walking.added("Nothing", bpy.data.curves.new("Nothing", "CURVE"))
    bpy.context.view_layer.update()
    assert "has no spline" in walks.problems[ob.session_uid]
    walking.gait(ob).path = walking.path([(0, 0, 0), (0, -9, 0)])
    bpy.context.view_layer.update()
    assert not walks.problems


def test_objects_of_the_wrong_kind_are_told() -> None:
    ob = walking.walker(source="PATH")
    walking.gait(ob).path = walking.plane(1.0, 0.0)
    bpy.context.scene.frame_set(3)
    assert "cannot be a path: choose a curve" in walks.problems[ob.session_uid]
    walking.gait(ob).source = "SPEED"
    walking.gait(ob).ground = walking.path([(0, 0, 0), (0, -9, 0)])
    bpy.context.view_layer.update()
    assert "cannot be the ground: choose a mesh" in walks.problems[ob.session_uid]


def test_a_path_that_is_deleted_leaves_the_character_standing() -> None:
    ob = walking.walker(source="PATH", path=walking.path([(0, 0, 0), (0, -9, 0)]))
    walking.shown(ob, [30])
    bpy.data.objects.remove(walking.gait(ob).path)
    bpy.context.view_layer.update()
    bpy.context.scene.frame_set(31)
    assert "has none" in walks.problems[ob.session_uid]


def test_speeds_beyond_all_measure_are_held() -> None:
    ob = walking.walker(speed=1e9)
    assert walking.gait(ob).speed == properties.FASTEST
    assert np.isfinite(walking.shown(ob)).all()
