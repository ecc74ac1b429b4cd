"""Allow Stretch on characters: joints move off their parents, live and baked, as far as Blender lets them."""

from collections.abc import Sequence
from pathlib import Path

import bpy
import numpy as np
import pytest
from mathutils import Matrix

from morph_retarget.blender.properties import of_rig
from morph_retarget.core.arrays import Array
from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.morph.channels import Channel, TargetKind
from morph_retarget.core.morph.context import Context, Side
from morph_retarget.core.morph.movement import Movement
from morph_retarget.core.solve.settings import DEFAULT
from tests.blender import acting, acts, results, scenes
from tests.blender.acts import Act
from tests.blender.command import Command

REACH = Channel(
    "Reach", Context(Capability.GRASPER, side=Side.LEFT), Movement(secondary_relative=True), TargetKind.EXTERNAL
)
HEAD = Channel("Head", Context(Capability.HEAD))
ARM = ("UpperArm.L", "LowerArm.L", "Hand.L")
FRAMES = np.arange(1.0, 20.01, 0.5).tolist()
FAR = 1.1
"""How far the target is from the shoulder, over the arm's length."""
NEAR = 1e-5
"""What lengths and places are off by [m]: Blender's poses are single precision."""

pytestmark = pytest.mark.usefixtures("registered")


def _rest(ob: bpy.types.Object, bones: Sequence[str] = ARM) -> Array:
    """Return where bones start at rest, in the world, shape (bone, 3)."""
    return np.array([ob.matrix_world @ ob.data.bones[bone].head_local for bone in bones])


def _lengths(places: Array) -> Array:
    """Return the distances from bone to bone [m], shape (..., bone - 1)."""
    return np.linalg.norm(np.diff(places, axis=-2), axis=-1)


def _reach(ob: bpy.types.Object, far: float = FAR) -> Act:
    """Return a character whose left hand goes to a target beyond its arm's length and half the way back."""
    rest = _rest(ob)
    way = np.array([0.3, -1.0, 0.2])
    place = rest[0] + far * _lengths(rest).sum() * way / np.linalg.norm(way)
    act = acts.act([ob], REACH)
    act.values().target = acts.empty_object("Target", place)
    for frame, share in ((1, 0.0), (10, 1.0), (20, 0.5)):
        act.key(frame, position=(share, 0.0, 0.0))
    of_rig(ob).allows_stretch = True
    bpy.context.view_layer.update()
    return act


def _connect(ob: bpy.types.Object, wanted: bool, *names: str) -> None:
    """Connect bones to their parents, or clear that, as animators do."""
    bpy.context.view_layer.objects.active = ob
    bpy.ops.object.mode_set(mode="EDIT")
    for name in names:
        bone = ob.data.edit_bones[name]
        bone.parent.tail = bone.head
        bone.use_connect = wanted
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.context.view_layer.update()


def _target() -> Array:
    return np.array(bpy.data.objects["Target"].matrix_world.translation)


def test_it_is_off_unless_the_user_wants_it() -> None:
    ob = _reach(acts.creature("biped")).obs[0]
    of_rig(ob).property_unset("allows_stretch")
    bpy.context.view_layer.update()
    assert not of_rig(ob).allows_stretch
    places = scenes.heads(ob, ARM, FRAMES)
    assert np.abs(_lengths(places) - _lengths(_rest(ob))).max() < NEAR
    assert np.linalg.norm(places[:, -1] - _target(), axis=-1).min() > 0.01


@pytest.mark.parametrize("setting", ["", "use_local_location", "use_inherit_rotation", "euler"])
@pytest.mark.parametrize("placed", [False, True])
def test_an_arm_stretches_to_its_target_live_and_in_a_bake(setting: str, placed: bool) -> None:
    ob = acts.creature("biped")
    if placed:
        ob.matrix_world = Matrix.Translation((1.0, 2.0, 0.0)) @ Matrix.Rotation(0.7, 4, "Z") @ Matrix.Scale(1.5, 4)
        bpy.context.view_layer.update()
    for name in ARM:
        if setting == "euler":
            ob.pose.bones[name].rotation_mode = "ZXY"
        elif setting:
            setattr(ob.data.bones[name], setting, False)
    _reach(ob)
    rest = _lengths(_rest(ob))
    live = scenes.heads(ob, ARM, FRAMES)
    factors = _lengths(live) / rest
    assert np.linalg.norm(live[FRAMES.index(10.0), -1] - _target()) < NEAR
    assert np.abs(factors[FRAMES.index(10.0)] - FAR).max() < 2e-3
    assert np.abs(np.ptp(factors, axis=1)).max() < 1e-4, "both bones stretch alike"
    assert np.abs(factors[0] - 1.0).max() < 1e-4
    outcome = acting.baked(ob)[0]
    assert np.abs(scenes.heads(ob, ARM, [float(f) for f in range(1, 21)]) - live[::2]).max() < 1e-4
    keyed = {path for path, _ in scenes.curves_of(ob)}
    for name, moves in (("UpperArm.L", False), ("LowerArm.L", True), ("Hand.L", True), ("Hand.R", False)):
        assert (ob.pose.bones[name].path_from_id("location") in keyed) == moves, name
    assert not outcome.take.warnings


def test_what_hangs_on_a_hand_goes_with_it() -> None:
    ob = _reach(acts.creature("biped")).obs[0]
    bpy.context.scene.frame_set(10)
    found, rest = acts.heads(ob, [*ARM, "UpperArm.R"]), _rest(ob, [*ARM, "UpperArm.R"])
    assert np.abs(found[3] - rest[3]).max() < NEAR, "the rest of the body stays"
    children = [bone.name for bone in ob.data.bones["Hand.L"].children]
    hand = np.linalg.norm(acts.heads(ob, children) - found[2], axis=-1)
    assert np.abs(hand - np.linalg.norm(_rest(ob, children) - rest[2], axis=-1)).max(initial=0.0) < NEAR


def test_switched_off_it_puts_bones_back_to_where_their_parents_hold_them() -> None:
    ob = _reach(acts.creature("biped")).obs[0]
    bpy.context.scene.frame_set(10)
    assert ob.pose.bones["Hand.L"].location.length > 0.01
    of_rig(ob).allows_stretch = False
    bpy.context.view_layer.update()
    for name in ARM:
        assert ob.pose.bones[name].location.length == 0.0
    assert np.abs(_lengths(acts.heads(ob, ARM)) - _lengths(_rest(ob))).max() < NEAR
    of_rig(ob).allows_stretch = True
    bpy.context.view_layer.update()
    assert np.linalg.norm(acts.heads(ob, ARM)[-1] - _target()) < NEAR


def test_connected_bones_keep_their_lengths_and_say_what_to_do() -> None:
    """And stretch as soon as that is done."""
    ob = acts.creature("biped")
    _connect(ob, True, "LowerArm.L", "Hand.L")
    act = _reach(ob)
    bpy.context.scene.frame_set(10)
    assert np.abs(_lengths(acts.heads(ob, ARM)) - _lengths(_rest(ob))).max() < NEAR
    assert act.tell() == (
        "bones 'LowerArm.L', 'Hand.L' cannot stretch away from what they are connected to: clear Connected in Edit Mode"
    )
    _connect(ob, False, "LowerArm.L")
    bpy.context.scene.frame_set(10)
    assert act.tell().startswith("bone 'Hand.L' cannot stretch")
    _connect(ob, False, "Hand.L")
    bpy.context.scene.frame_set(10)
    assert act.tell() == ""
    assert np.linalg.norm(acts.heads(ob, ARM)[-1] - _target()) < NEAR
    _connect(ob, True, "Hand.L")
    of_rig(ob).allows_stretch = False
    bpy.context.view_layer.update()
    assert act.tell() == "", "nobody wants it to stretch"


def test_a_neck_stretches_where_the_spine_bends() -> None:
    ob = acts.creature("biped")
    of_rig(ob).bends_spine = of_rig(ob).allows_stretch = True
    act = acts.act([ob], HEAD)
    act.key(1, position=(0.0, 0.0, 0.05))
    bpy.context.scene.frame_set(2)
    goal = acts.in_world(ob, act.shown().positions[0, 0])
    assert np.abs(acts.heads(ob, ["Head"])[0] - goal).max() < 1e-4
    line = ("Spine", "Chest", "UpperChest", "Neck", "Head")
    factors = _lengths(acts.heads(ob, line)) / _lengths(_rest(ob, line))
    assert factors.max() > 1.01
    assert factors.max() < DEFAULT.stretch + 1e-4
    acting.baked(ob)
    bpy.context.scene.frame_set(2)
    assert np.abs(acts.heads(ob, ["Head"])[0] - goal).max() < 1e-4


@pytest.mark.parametrize("option", ["--allow-stretch", "--no-allow-stretch", ""])
def test_the_command_line_stretches_if_it_is_told_to_or_the_file_says_so(cli: Command, out: Path, option: str) -> None:
    ob = _reach(acts.creature("biped")).obs[0]
    of_rig(ob).allows_stretch = option != "--allow-stretch"
    rest, target = _rest(ob), _target()
    scenes.save(out / "reach.blend")
    given = ["--target", "Reach=Target", *([option] if option else [])]
    said = cli("play", f"{out / 'reach.blend'}#Act", out / "reach.blend", "-o", out / "x.blend", *given)
    assert (said.status, said.errors) == (0, [])
    places = scenes.heads(results.reload(out / "x.blend"), ARM, [10.0])[0]
    stretched = option != "--no-allow-stretch"
    assert (np.linalg.norm(places[-1] - target) < 1e-4) == stretched
    assert (np.abs(_lengths(places) / _lengths(rest) - FAR).max() < 2e-3) == stretched


def test_the_command_line_warns_of_connected_bones(cli: Command, out: Path) -> None:
    ob = acts.creature("biped")
    _connect(ob, True, "Hand.L")
    _reach(ob)
    scenes.save(out / "reach.blend")
    said = cli(
        "play", f"{out / 'reach.blend'}#Act", out / "reach.blend", "-o", out / "x.blend", "--target", "Reach=Target"
    )
    assert said.status == 0
    assert any("'Hand.L' cannot stretch" in line for line in said.errors)
