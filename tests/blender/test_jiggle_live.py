"""Jiggles of characters that play generalized actions: a function of the frame, shown live as they are baked."""

from collections.abc import Sequence
from pathlib import Path

import bpy
import numpy as np
import pytest

from morph_retarget.blender import actions
from morph_retarget.blender.morph import cast, jiggles, keys, perform
from morph_retarget.blender.properties import of_rig
from morph_retarget.core.arrays import Array
from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.morph.channels import Channel, TargetKind
from morph_retarget.core.morph.context import Context
from morph_retarget.core.morph.movement import Movement, ScaleMode
from tests.blender import acting, acts, scenes
from tests.blender.acts import Act

SIZE = Movement(scale=ScaleMode.CREATURE_SIZE)
BODY = Channel("Body", Context(Capability.ROOT), SIZE)
TAILS = Channel("Tails", Context(Capability.TAIL), poses_position=False)
LOOK = Channel("Look", Context(Capability.HEAD), Movement(look_at=True), TargetKind.EXTERNAL, poses_position=False)
FRAMES = [1, 4, 7.5, 10, 12, 14.25, 17, 22, 30]
TAIL = [f"Tail.00{i}" for i in range(1, 6)]

pytestmark = pytest.mark.usefixtures("registered")


def _leap(obs: Sequence[bpy.types.Object], *more: Channel, jiggle: bool = True) -> Act:
    """Return characters that leap, turn and stop, from frame 1 to 20."""
    act = acts.act(obs, BODY, *more, name="Leap")
    for frame, height, turn in ((1, 0.0, 0.0), (6, 0.3, 0.2), (12, -0.1, 0.5), (20, 0.0, 0.5)):
        act.key(frame, "Body", position=(0.3 * turn, 0.2 * height, height), rotation=(1.0 - 0.5 * turn, 0, 0, turn))
    for ob in obs:
        of_rig(ob).jiggles.enabled = jiggle
    return act


def _shown(ob: bpy.types.Object, frames: Sequence[float] = FRAMES, bones: Sequence[str] = ()) -> Array:
    """Return bones of a character in the world, all without names, shape (frame, bone, 4, 4)."""
    return scenes.evaluated(ob, list(bones) or ob.pose.bones.keys(), frames)


def _tip(ob: bpy.types.Object, frames: Sequence[float] = FRAMES) -> Array:
    """Return the place of a hound's last tail bone, which has gone through all lags, shape (frame, 3)."""
    return _shown(ob, frames, TAIL[-1:])[:, 0, :3, 3]


def test_tail_and_ears_follow_and_the_posed_body_stays_as_it_was() -> None:
    hound = acts.creature("hound")
    _leap([hound], jiggle=False)
    stiff = _shown(hound)
    of_rig(hound).jiggles.enabled = True
    loose = _shown(hound)
    moved = {n for i, n in enumerate(hound.pose.bones.keys()) if scenes.difference(loose[:, i], stiff[:, i]) > 1e-6}
    assert moved == {*TAIL, "Ear.L", "Ear.R"}
    size = max(hound.dimensions)
    assert np.linalg.norm(loose[..., :3, 3] - stiff[..., :3, 3], axis=-1).max() > 0.02 * size


@pytest.mark.parametrize("kind", ["hound", "bird", "snake", "beetle"])
def test_what_is_shown_depends_on_the_frame_alone(kind: str) -> None:
    ob = acts.creature(kind)
    _leap([ob])
    forward = _shown(ob)
    order = np.random.default_rng(1).permutation(len(FRAMES))
    assert scenes.difference(_shown(ob, [FRAMES[i] for i in order]), forward[order]) == 0.0
    perform.forget()
    cast.forget(rig=True)
    assert scenes.difference(_shown(ob, FRAMES[4:5]), forward[4:5]) < 1e-6
    assert np.isfinite(forward).all()


def test_frames_far_beyond_the_first_simulation_continue_it() -> None:
    hound = acts.creature("hound")
    act = _leap([hound])
    act.key(300, "Body", position=(0.0, 0.0, 0.0))
    act.key(305, "Body", position=(0.0, 0.5, 0.3))
    of_rig(hound).jiggles.loop = False
    far = _tip(hound, [303, 306, 308])
    perform.forget()
    assert scenes.difference(_tip(hound, [308, 303, 306]), far[[2, 0, 1]]) < 1e-6


@pytest.mark.parametrize("loop", [True, False])
def test_far_behind_the_end_of_an_action_the_beginning_is_left_out_and_nobody_can_tell(loop: bool) -> None:
    hound = acts.creature("hound")
    act = _leap([hound])
    act.key(31, "Body", position=(0.0, 0.0, 0.0), rotation=(1.0, 0.0, 0.0, 0.0))
    for curve in keys.curves(act.action).values():
        curve.modifiers.new("CYCLES")
    of_rig(hound).jiggles.loop = loop
    frames = [6000, 6003.5, 6010]
    live = _tip(hound, frames)
    of_rig(hound).jiggles.enabled = False
    assert scenes.difference(_tip(hound, frames), live) > 0.01, "it still jiggles"
    of_rig(hound).jiggles.enabled = True
    assert scenes.difference(_tip(hound, [2, *frames])[1:], live) == 0.0
    acting.baked(hound, options=acting.Options(frames=(6000, 6010)))  # simulated from the first frame on
    assert scenes.difference(_tip(hound, frames[::2]), live[::2]) < 1e-5


@pytest.mark.parametrize("kind", ["hound", "bird", "snake"])
def test_baked_keys_show_what_was_shown_live_also_between_frames(kind: str) -> None:
    ob = acts.creature(kind)
    ob.location, ob.rotation_euler = (2.0, -1.0, 0.4), (0.0, 0.1, 2.0)
    _leap([ob])
    frames = [f for f in FRAMES if f <= 20]
    live = _shown(ob, frames)
    whole = [i for i, f in enumerate(frames) if f == int(f)]
    acting.baked(ob)
    there = _shown(ob, frames)
    assert scenes.difference(there[whole], live[whole]) < 1e-5
    if kind == "hound":  # the root's own path between frames is curved live and straight when baked
        tail = [ob.pose.bones.keys().index(name) for name in TAIL]
        assert scenes.difference(there[:, tail, :3, :3], live[:, tail, :3, :3]) < 0.02


def test_a_part_of_an_action_is_baked_as_a_part_of_the_whole() -> None:
    hound = acts.creature("hound")
    _leap([hound])
    live = _tip(hound, [10, 12, 14])
    acting.baked(hound, options=acting.Options(frames=(10, 14)))
    assert scenes.difference(_tip(hound, [10, 12, 14]), live) < 1e-5


def test_a_tail_that_the_action_poses_is_left_to_it() -> None:
    hound = acts.creature("hound")
    act = _leap([hound], TAILS, jiggle=False)
    act.key(1, "Tails", rotation=(1.0, 0.0, 0.0, 0.0))
    act.key(10, "Tails", rotation=(0.95, 0.0, 0.0, 0.3))
    stiff = _shown(hound, bones=TAIL)
    of_rig(hound).jiggles.enabled = True
    assert scenes.difference(_shown(hound, bones=TAIL), stiff) == 0.0
    assert scenes.difference(_shown(hound, bones=["Ear.L"]), _shown(hound, [1] * len(FRAMES), ["Ear.L"])) > 0.01


def test_a_bone_that_plain_curves_or_constraints_move_does_not_jiggle() -> None:
    hound = acts.creature("hound")
    _leap([hound])
    hound.pose.bones["Ear.L"].constraints.new("COPY_ROTATION").target = acting.creature("bird")
    hound.pose.bones["Tail.003"].keyframe_insert("rotation_euler", frame=1)
    hound.pose.bones["Tail.003"].rotation_euler = (0.5, 0.0, 0.0)
    hound.pose.bones["Tail.003"].keyframe_insert("rotation_euler", frame=9)
    perform.forget()
    bpy.context.scene.frame_set(8)
    shown = perform.shown(hound)
    assert shown is not None
    names = {shown.member.rig.skeleton.names[bone] for bone in shown.played.bones}
    assert names & {"Tail.004", "Tail.005", "Ear.R", "Ear.L", "Tail.001"} == {"Tail.004", "Tail.005", "Ear.R"}


def test_an_edited_curve_shows_with_the_next_frame_and_a_setting_at_once() -> None:
    hound = acts.creature("hound")
    act = _leap([hound])
    before = _tip(hound, [13])
    curve = act.curve("position", 2, "Body")
    curve.keyframe_points[1].co_ui[1] += 0.4
    curve.update()
    bpy.context.view_layer.update()
    after = _tip(hound, [13])
    perform.forget()
    assert scenes.difference(after, before) > 1e-3, "it has leapt higher before"
    assert scenes.difference(_tip(hound, [13]), after) < 1e-6
    of_rig(hound).jiggles.amount = 0.0
    bpy.context.view_layer.update()
    still = acts.pose(hound)
    of_rig(hound).jiggles.enabled = False
    bpy.context.view_layer.update()
    assert scenes.difference(acts.pose(hound), still) < 1e-6


def test_switched_off_the_parts_go_back_to_rest() -> None:
    hound = acts.creature("hound")
    _leap([hound])
    bpy.context.scene.frame_set(12)
    assert abs(hound.pose.bones["Tail.003"].rotation_quaternion[0]) < 1.0 - 1e-5
    of_rig(hound).jiggles.enabled = False
    bpy.context.view_layer.update()
    assert list(hound.pose.bones["Tail.003"].rotation_quaternion) == [1.0, 0.0, 0.0, 0.0]


def test_settings_of_a_kind_and_of_a_bone_are_their_own() -> None:
    hound = acts.creature("hound")
    _leap([hound])
    assert bpy.ops.morph_retarget.add_jiggle_settings(character=hound.name, kind="tail") == {"FINISHED"}
    assert bpy.ops.morph_retarget.add_jiggle_settings(character=hound.name, kind="bone", bone="Ear.L") == {"FINISHED"}
    own = of_rig(hound).jiggles
    assert [item.name for item in own.overrides] == ["Tail", "Ear.L"]
    own.overrides[0].amount = own.overrides[1].amount = 0.0
    bpy.context.scene.frame_set(12)
    angles = {name: hound.pose.bones[name].rotation_quaternion.angle for name in (*TAIL, "Ear.L", "Ear.R")}
    assert angles["Ear.R"] > 0.01
    assert max(angle for name, angle in angles.items() if name != "Ear.R") == 0.0
    assert bpy.ops.morph_retarget.remove_jiggle_settings(character=hound.name) == {"FINISHED"}
    assert [item.name for item in own.overrides] == ["Tail"]
    with pytest.raises(RuntimeError, match="no bone 'Fluke'"):
        bpy.ops.morph_retarget.add_jiggle_settings(character=hound.name, kind="bone", bone="Fluke")


def test_files_keep_the_settings_and_show_the_same_after_loading(tmp_path: Path) -> None:
    hound = acts.creature("hound")
    _leap([hound])
    own = of_rig(hound).jiggles
    own.half_life, own.gravity, own.ground = 0.3, 0.1, True
    own.add("bone", "Ear.R").stiffness = 5.0
    live = _shown(hound)
    path = scenes.save(tmp_path / "hound.blend")
    bpy.ops.wm.open_mainfile(filepath=str(path))
    hound = bpy.data.objects["Hound"]
    own = of_rig(hound).jiggles
    assert (round(own.half_life, 3), round(own.gravity, 3), own.ground) == (0.3, 0.1, True)
    assert own.settings().bones["Ear.R"].stiffness == 5.0
    assert scenes.difference(_shown(hound, FRAMES[::-1])[::-1], live) < 1e-6


def test_the_way_of_the_object_and_of_what_it_hangs_on_is_felt() -> None:
    hound = acts.creature("hound")
    act = _leap([hound])
    of_rig(hound).jiggles.loop = False
    cart = scenes.empty_object("Cart")
    hound.parent = cart
    still = [hound.pose.bones["Ear.L"].rotation_quaternion.copy() for f in (28,) if not bpy.context.scene.frame_set(f)]
    for frame, way in ((1, 0.0), (24, 0.0), (28, 2.0)):
        cart.location.x = way
        cart.keyframe_insert("location", frame=frame)
    perform.forget()
    bpy.context.scene.frame_set(28)
    moving = hound.pose.bones["Ear.L"].rotation_quaternion
    assert still[0].rotation_difference(moving).angle > 0.05
    assert act.action.users


def _fly(ob: bpy.types.Object) -> bpy.types.Object:
    """Return what a character looks at: it crosses in front of it."""
    fly = acts.empty_object("Fly", (0.2, -2.0, 1.0))
    of_rig(ob).channels["Look"].target = fly
    for frame, place in ((1, -1.0), (8, 1.0)):
        fly.location.x = place
        fly.keyframe_insert("location", frame=frame)
    return fly


def test_ears_follow_a_head_that_looks_at_what_keys_move() -> None:
    hound = acts.creature("hound")
    _leap([hound], LOOK)
    _fly(hound)
    hound.parent = cart = scenes.empty_object("Cart")
    for frame, place in ((1, -0.2), (12, 0.3)):
        cart.location.y = place
        cart.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_set(1)
    live = _shown(hound, [2, 5, 9, 12])
    assert not jiggles.problems
    acting.baked(hound)
    assert scenes.difference(_shown(hound, [2, 5, 9, 12]), live) < 1e-4


def test_what_only_stepping_could_tell_is_said_and_comes_when_it_is_baked() -> None:
    hound = acts.creature("hound")
    act = _leap([hound], LOOK)
    fly = _fly(hound)
    fly.constraints.new("LIMIT_LOCATION")
    bpy.context.scene.frame_set(10)
    assert "'Fly' cannot be followed live" in jiggles.problems[hound.session_uid]
    (outcome,) = acting.baked(hound)
    assert any("Tail.003" in path for path, _ in actions.curves(outcome.action, outcome.slot))
    assert act.action.users


def test_renders_show_the_pose_of_the_viewport(tmp_path: Path) -> None:
    hound = acts.character("hound")
    _leap([hound])
    scenes.close_up(_tip(hound, [12])[0], 0.02)
    covered = []
    for jiggle in (True, False):
        of_rig(hound).jiggles.enabled = jiggle
        bpy.context.scene.frame_set(3)
        covered.append(scenes.covered(12, tmp_path, str(jiggle)).mean())
    assert covered[0] == 1.0
    assert covered[1] < 0.8


def test_undo_and_redo_show_the_jiggles_of_their_moment() -> None:
    hound = acts.creature("hound")
    _leap([hound])
    bpy.context.scene.frame_set(12)
    bpy.ops.ed.undo_push(message="before")
    there = _tip(hound, [12])
    of_rig(hound).jiggles.half_life = 0.6
    bpy.ops.ed.undo_push(message="after")
    slower = _tip(hound, [12])
    bpy.ops.ed.undo()
    hound = bpy.data.objects["Hound"]
    assert scenes.difference(_tip(hound, [12]), there) < 1e-6
    bpy.ops.ed.redo()
    hound = bpy.data.objects["Hound"]
    assert scenes.difference(_tip(hound, [12]), slower) < 1e-6
    assert scenes.difference(slower, there) > 1e-3


def test_an_action_without_keys_and_one_without_anything_loose_do_no_harm() -> None:
    hound, biped = acts.creature("hound"), acts.creature("biped")
    acts.act([hound, biped], BODY, name="Nothing")
    for ob in (hound, biped):
        of_rig(ob).jiggles.enabled = True
    before = [_shown(ob, [1, 30]) for ob in (hound, biped)]
    assert scenes.difference(before[0][0], before[0][1]) < 1e-6
    assert not cast.problems
