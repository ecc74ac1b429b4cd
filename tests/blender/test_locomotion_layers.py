"""Characters that go over the ground while they play an action, jiggle, or are followed."""

import bpy
import numpy as np
import pytest
from mathutils import Matrix

from morph_retarget.blender.locomotion import walks
from morph_retarget.blender.morph import cast, paths, perform, stage
from morph_retarget.blender.properties import of_rig
from morph_retarget.core.arrays import Array
from tests.blender import acting, acts, scenes, walking
from tests.blender.walking import WHOLE

ops = bpy.ops.morph_retarget
NEAR = 1e-6

pytestmark = pytest.mark.usefixtures("registered", "walked")


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
    live = walking.shown(ob, [1, 5, 11, 21, 60])
    acting.baked(ob)
    assert scenes.difference(walking.shown(ob, [1, 5, 11, 21, 60]), live) < NEAR


def _carried(ob: bpy.types.Object, frames: Array) -> Array:
    """Return where the ground under the body has moved to, character frame, shape (frame, 3)."""
    layer = walks.over(cast.member(ob), bpy.context.scene, bpy.context.evaluated_depsgraph_get(), frames)
    assert layer is not None
    return layer.places


@pytest.mark.parametrize(("kind", "near"), [("biped", 0.17), ("hound", 0.08), ("beetle", 0.08), ("snake", 1e-3)])
def test_an_action_goes_up_a_hill_with_the_body(kind: str, near: float) -> None:
    ob = walking.walker(kind, speed=1.0, ground=walking.plane(20.0, 0.0, 0.3))
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
    walking.gait(ob).speed, walking.gait(ob).ground = 1.0, walking.plane(20.0, 0.0, slope)
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
    walking.gait(ob).turn_rate = 1.0
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
    hound = walking.walker("hound", speed=2.0)
    of_rig(hound).jiggles.enabled = True
    live = walking.shown(hound, WHOLE)
    assert scenes.difference(walking.shown(hound, WHOLE[::-1])[::-1], live) < NEAR
    of_rig(hound).jiggles.enabled = False
    assert scenes.difference(walking.shown(hound, WHOLE), live) > 0.005
    of_rig(hound).jiggles.enabled = True
    acting.baked(hound)
    assert scenes.difference(walking.shown(hound, WHOLE), live) < 1e-5


def test_who_follows_a_bone_of_one_that_goes_finds_it_where_it_is() -> None:
    leader = walking.walker("biped", speed=1.0)
    bpy.context.scene.frame_set(100)
    place = stage.place_of(leader, "Head", bpy.context.evaluated_depsgraph_get())
    assert place == pytest.approx(scenes.heads(leader, ["Head"], [100])[0, 0], abs=1e-4)
