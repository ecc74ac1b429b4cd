"""Joint limits as animators set them on pose bones: honoured live, baked and followed, as by Blender's own IK."""

from collections.abc import Sequence
from pathlib import Path

import bpy
import numpy as np
import pytest
from mathutils import Matrix

from morph_retarget.blender import joint_limits, rig
from morph_retarget.blender.io import load
from morph_retarget.blender.morph import analyses, cast
from morph_retarget.blender.properties import of_rig
from morph_retarget.core import quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.morph.channels import Channel, TargetKind
from morph_retarget.core.morph.context import Context, Side
from morph_retarget.core.morph.movement import Movement, ScaleMode
from morph_retarget.core.solve.limits import swing_and_twist
from tests.blender import acting, acts, results, scenes
from tests.blender.acts import Act
from tests.blender.command import Command

SIZED = Movement(scale=ScaleMode.LIMB_LENGTH)
FOOT = Channel("Foot", Context(Capability.FOOT, side=Side.LEFT), SIZED)
HAND = Channel("Hand", Context(Capability.GRASPER, side=Side.LEFT), poses_position=False)
STEP = Channel("Step", Context(Capability.FOOT, side=Side.LEFT), Movement(secondary_relative=True), TargetKind.EXTERNAL)
FRAMES = np.arange(1.0, 20.01, 0.5).tolist()
KNEE, THIGH = "LowerLeg.L", "UpperLeg.L"
NEAR = 0.01
"""What angles are off by [deg]: Blender's poses are single precision."""

pytestmark = pytest.mark.usefixtures("registered")


def _limit(bone: bpy.types.PoseBone, **ranges: tuple[float, float]) -> None:
    """Limit the axes of a bone that are named [deg], and lock those whose range is empty."""
    for axis, (least, most) in ranges.items():
        setattr(bone, f"use_ik_limit_{axis}", least != most)
        setattr(bone, f"lock_ik_{axis}", least == most)
        setattr(bone, f"ik_min_{axis}", np.radians(least))
        setattr(bone, f"ik_max_{axis}", np.radians(most))
    bpy.context.view_layer.update()


def _own(ob: bpy.types.Object, bone: str, frames: Sequence[float]) -> Array:
    """Return how a bone turns from rest against its parent about its own axes, as it is limited [deg], (frame, 3)."""
    own, parent = ob.data.bones[bone], ob.data.bones[bone].parent
    rest = parent.matrix_local.inverted() @ own.matrix_local
    turns = [
        (rest.inverted() @ Matrix(above).inverted() @ Matrix(turned)).to_quaternion()
        for above, turned in scenes.evaluated(ob, [parent.name, bone], frames)
    ]
    x, twist, z = swing_and_twist(np.array(turns)).T
    return np.degrees(np.stack([2.0 * np.arcsin(x), twist, 2.0 * np.arcsin(z)], axis=-1))


def _kick() -> Act:
    """Return a body that lifts its foot to where its knee is bent by a right angle and more, and turns its hand."""
    act = acts.act([acting.creature("biped")], FOOT, HAND)
    for frame, share in ((1, 0.0), (10, 1.0), (20, 0.2)):
        act.key(frame, "Foot", position=(0.0, 0.0, 0.6 * share))
        act.key(frame, "Hand", rotation=(0.7, 0.7 * share, 0.3 * share, 0.5 * share))
    return act


def test_a_rig_without_limits_has_none() -> None:
    ob = acting.creature("biped")
    assert joint_limits.read(ob, rig.read(ob)) is None
    ob.pose.bones[KNEE].ik_max_x = 0.5
    assert joint_limits.read(ob, rig.read(ob)) is None, "a range counts where it is used"
    assert cast.member(acts.act([ob], FOOT).obs[0]).part.pose.limited is None


def test_limits_are_read_by_bone_and_axis() -> None:
    ob = acting.creature("biped")
    _limit(ob.pose.bones[KNEE], x=(-10.0, 120.0), y=(0.0, 0.0))
    own = rig.read(ob)
    found = joint_limits.read(ob, own)
    assert found is not None
    knee = own.skeleton.index[KNEE]
    assert np.allclose(np.degrees(found.least[knee]), [-10.0, 0.0, -np.inf])
    assert np.allclose(np.degrees(found.most[knee]), [120.0, 0.0, np.inf])
    assert np.flatnonzero(found.limited).tolist() == [knee]


def test_limits_of_pose_bones_are_kept_live_and_in_a_bake() -> None:
    act = _kick()
    ob = act.obs[0]
    assert _own(ob, KNEE, FRAMES)[:, 0].max() > 90.0
    _limit(ob.pose.bones[KNEE], x=(0.0, 70.0), y=(0.0, 0.0), z=(0.0, 0.0))
    _limit(ob.pose.bones["Hand.L"], x=(-20.0, 20.0), y=(-30.0, 30.0), z=(-25.0, 25.0))
    for step in range(2):
        knee, hand = _own(ob, KNEE, FRAMES), _own(ob, "Hand.L", FRAMES)
        assert knee[:, 0].min() > -NEAR
        assert 60.0 < knee[:, 0].max() < 70.0 + NEAR
        assert np.abs(knee[:, 1:]).max() < NEAR
        assert (np.abs(hand).max(axis=0) < np.array([20.0, 30.0, 25.0]) + NEAR).all()
        assert np.abs(hand).max() > 19.0
        if step == 0:
            acting.baked(ob)


def test_the_foot_still_comes_to_goals_that_the_knee_allows() -> None:
    """The thigh makes up for a knee that only bends about its own axis, once this is a little off."""
    act = acts.act([acting.creature("biped")], FOOT)
    act.key(1, position=(0.1, -0.15, 0.15))
    ob = act.obs[0]
    _limit(ob.pose.bones[KNEE], x=(0.0, 120.0), y=(0.0, 0.0), z=(0.0, 0.0))
    _limit(ob.pose.bones[THIGH], x=(-90.0, 30.0), y=(-2.0, 2.0), z=(-45.0, 45.0))
    bpy.context.scene.frame_set(2)
    thigh = _own(ob, THIGH, [2.0])[0]
    assert abs(thigh[1]) < 2.0 + NEAR
    goal = acts.in_world(ob, act.shown().positions[0, 0])
    assert np.abs(goal - acts.heads(ob, ["Foot.L"])[0]).max() < 1e-3


def test_an_edited_limit_is_followed_at_once() -> None:
    act = _kick()
    ob, knee = act.obs[0], act.obs[0].pose.bones[KNEE]
    bpy.context.scene.frame_set(10)
    free = acts.pose(ob)
    analysed = analyses.of(ob)
    for most in (70.0, 40.0, 85.0):
        _limit(knee, x=(0.0, most), y=(0.0, 0.0), z=(0.0, 0.0))
        shown = acts.pose(ob)
        bend = quat.angle_between(*(quat.from_matrix(m[:3, :3]) for m in (_local(ob, shown), _local(ob, None))))
        assert abs(np.degrees(bend) - most) < NEAR
    assert analyses.of(ob) is analysed, "what the rig is has not changed"
    of_rig(ob).use_joint_limits = False
    bpy.context.view_layer.update()
    assert np.abs(acts.pose(ob) - free).max() < 1e-6
    of_rig(ob).use_joint_limits = True
    knee.use_ik_limit_x = knee.lock_ik_y = knee.lock_ik_z = False
    bpy.context.view_layer.update()
    assert np.abs(acts.pose(ob) - free).max() < 1e-6


def _local(ob: bpy.types.Object, pose: Array | None) -> Array:
    """Return the knee against the thigh, in a pose or at rest, shape (4, 4)."""
    names = ob.pose.bones.keys()
    if pose is None:
        pose = np.array([bone.matrix_local for bone in ob.data.bones])
    return np.linalg.inv(pose[names.index(THIGH)]) @ pose[names.index(KNEE)]


def test_a_knee_keeps_the_range_that_blenders_own_constraint_keeps() -> None:
    """The same target, closer than the knees can bend: both stop at the same angle."""
    target = acts.empty_object("Step", (0.12, -0.25, 0.75))
    ours, theirs = acting.creature("biped"), acting.creature("biped", "Rival")
    for ob in (ours, theirs):
        _limit(ob.pose.bones[KNEE], x=(0.0, 75.0), y=(0.0, 0.0), z=(0.0, 0.0))
    act = acts.act([ours], STEP)
    act.values().target = target
    act.key(1, position=(1.0, 0.0, 0.0))
    reach = theirs.pose.bones[KNEE].constraints.new("IK")
    reach.target, reach.chain_count = target, 2
    for place in ((0.12, -0.25, 0.75), (0.12, 0.2, 0.7), (0.12, -0.5, 0.4), (0.12, 0.0, 0.1)):
        target.location = place
        bpy.context.view_layer.update()
        bpy.context.scene.frame_set(2)
        mine, other = _own(ours, KNEE, [2.0])[0], _own(theirs, KNEE, [2.0])[0]
        for found in (mine, other):
            assert -NEAR < found[0] < 75.0 + NEAR
            assert np.abs(found[1:]).max() < NEAR
        assert abs(mine[0] - other[0]) < 2.0, place


def test_limits_of_a_real_rig_are_kept_wherever_its_object_stands(data: Path) -> None:
    """All its bones are limited; its object is turned, mirrored and scaled."""
    ob = load.load(load.Request(data / "rigs" / "quaternius_modular_man.glb"))[0]
    placed = Matrix.Translation((1.0, 2.0, 0.0)) @ Matrix.Rotation(0.7, 4, "Z") @ Matrix.Diagonal((-1.5, 1.5, 1.5, 1.0))
    ob.matrix_world = placed @ ob.matrix_world
    for bone in ob.pose.bones:
        _limit(bone, x=(-25.0, 15.0), y=(-10.0, 20.0), z=(-5.0, 30.0))
    channels = [Channel(c.value, Context(c), SIZED) for c in (Capability.FOOT, Capability.GRASPER, Capability.HEAD)]
    act = acts.act([ob], *channels, Channel("Back", Context(Capability.SPINE), poses_position=False))
    for i, channel in enumerate(channels):
        act.key(1, channel.name, position=(0.3, -0.4, 0.2 * i), rotation=(0.7, 0.4, 0.5, -0.3))
    act.key(1, "Back", rotation=(0.9, 0.3, 0.2, 0.1))
    own = rig.read(ob)
    limits = joint_limits.read(ob, own)
    assert limits is not None
    for bends in (False, True):
        of_rig(ob).bends_spine = bends
        bpy.context.scene.frame_set(2)
        basis = np.array([ob.pose.bones[name].matrix_basis.to_quaternion() for name in own.skeleton.names])
        told = swing_and_twist(basis)
        played = cast.member(ob).part.pose
        own_turns = [bone for bone in played.driven if bone != played.root]
        over = np.abs(limits.nearest(told) - told)[own_turns]
        assert over.max() < 1e-5
        assert quat.angle_between(basis, quat.IDENTITY)[own_turns].max() > np.radians(10.0)


@pytest.mark.parametrize(("option", "most"), [([], 70.0), (["--no-joint-limits"], 180.0)])
def test_the_command_line_keeps_them_unless_told_otherwise(
    cli: Command, out: Path, option: list[str], most: float
) -> None:
    ob = _kick().obs[0]
    _limit(ob.pose.bones[KNEE], x=(0.0, 70.0), y=(0.0, 0.0), z=(0.0, 0.0))
    scenes.save(out / "kick.blend")
    said = cli("play", f"{out / 'kick.blend'}#Act", out / "kick.blend", "-o", out / "x.blend", *option)
    assert (said.status, said.errors) == (0, [])
    bend = _own(results.reload(out / "x.blend"), KNEE, FRAMES)[:, 0].max()
    assert most - 90.0 < bend < most + NEAR
    assert (bend > 70.0 + NEAR) == bool(option)
