"""Feet that hang on the root bone, as baked inverse kinematics leaves them: moved live and in bakes."""

from pathlib import Path

import bpy
import numpy as np
import pytest
from mathutils import Matrix, Vector

from morph_retarget.blender.io import load
from morph_retarget.blender.morph import cast
from morph_retarget.core.arrays import Array
from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.morph.channels import Channel
from morph_retarget.core.morph.context import Context, Side
from morph_retarget.core.morph.movement import Movement, ScaleMode
from tests.blender import acting, acts, scenes
from tests.blender.acts import Act

FOOT = Channel("Foot", Context(Capability.FOOT, side=Side.LEFT), Movement(scale=ScaleMode.CREATURE_SIZE))
ROOT = Channel("Root", Context(Capability.ROOT), Movement(scale=ScaleMode.CREATURE_SIZE))
LEGS = {
    "quaternius_cyberpunk.glb": ("UpperLeg.L", "LowerLeg.L", "Foot.L"),
    "quaternius_trex.glb": ("BackUpLeg.L", "BackLowLeg.L", "BackFoot.L"),
}
FRAMES = [float(frame) for frame in range(1, 21)]
NEAR = 1e-5
"""What places are off by, as a share of the character's size: Blender's poses are single precision."""

pytestmark = pytest.mark.usefixtures("registered")


def _standing(data: Path, file: str) -> Act:
    """Return a character at rest that plays an action without keys."""
    ob = load.add(load.Request(data / "rigs" / file))[0]
    ob.animation_data_clear()
    for bone in ob.pose.bones:
        bone.matrix_basis.identity()
    return acts.act([ob], FOOT, ROOT)


def _moving(data: Path, file: str) -> Act:
    """Return one that lifts its left foot up and ahead, and lowers its body a little."""
    act = _standing(data, file)
    for frame, share in ((1, 0.0), (10, 1.0), (20, 0.3)):
        act.key(frame, "Foot", position=(0.0, -0.08 * share, 0.1 * share))
        act.key(frame, "Root", position=(0.0, 0.0, -0.02 * share))
    return act


def _apart(ob: bpy.types.Object, leg: tuple[str, ...], frames: list[float]) -> Array:
    """Return how far the foot is from where its shin would carry it [m], shape (frame,)."""
    seen = scenes.evaluated(ob, leg[1:], frames)
    shin, foot = (np.array(ob.data.bones[name].matrix_local) for name in leg[1:])
    step = np.array((Matrix(shin).inverted() @ Matrix(foot)).translation)
    carried = seen[:, 0, :3, 3] + seen[:, 0, :3, :3] @ step
    return np.linalg.norm(seen[:, 1, :3, 3] - carried, axis=-1)


@pytest.mark.parametrize("file", LEGS)
def test_a_foot_comes_to_its_goal_with_its_leg_live_and_in_a_bake(data: Path, file: str) -> None:
    act, leg = _moving(data, file), LEGS[file]
    ob, size = act.obs[0], max(act.obs[0].dimensions)
    assert leg[1] not in [bone.name for bone in ob.data.bones[leg[2]].parent_recursive]
    live = scenes.heads(ob, leg, FRAMES)
    rest = np.array([ob.matrix_world @ ob.data.bones[bone].head_local for bone in leg])
    assert np.abs(live[0] - rest).max() < NEAR * size
    bpy.context.scene.frame_set(10)
    goals = act.shown()
    member = cast.member(ob)
    place = [member.bodies.names[body] for body in goals.bodies].index(leg[2])
    assert np.linalg.norm(live[9, 2] - acts.in_world(ob, goals.positions[0, place])) < NEAR * size
    assert np.linalg.norm(live[9, 2] - rest[2]) > 0.05 * size
    assert np.linalg.norm(live[9, 1] - rest[1]) > 0.01 * size, "the knee bends"
    assert _apart(ob, leg, FRAMES).max() < 1e-3 * size / 1.75
    (outcome,) = acting.baked(ob)
    assert not outcome.take.warnings
    assert np.abs(scenes.heads(ob, leg, FRAMES) - live).max() < NEAR * size
    assert _apart(ob, leg, FRAMES).max() < 1e-3 * size / 1.75
    keyed = {path for path, _ in scenes.curves_of(ob)}
    above = [bone.name for bone in ob.data.bones[leg[0]].parent_recursive]
    beside = member.bodies.names[member.root] not in above  # then the hips take it along
    for bone, moves in zip(leg, (beside, False, True), strict=True):
        assert (ob.pose.bones[bone].path_from_id("location") in keyed) == moves, bone


@pytest.mark.parametrize("file", LEGS)
def test_a_foot_that_is_moved_by_hand_takes_its_leg_along(data: Path, file: str) -> None:
    act, leg = _standing(data, file), LEGS[file]
    ob, size = act.obs[0], max(act.obs[0].dimensions)
    ob.select_set(True)
    bpy.ops.object.mode_set(mode="POSE")
    ob.data.bones.active = ob.data.bones[leg[2]]
    start, way = acts.heads(ob, leg), np.array([0.0, -0.05, 0.1]) * size
    to_local = ob.matrix_world.to_3x3().inverted()
    ob.pose.bones[leg[2]].matrix = Matrix.Translation(to_local @ Vector(way)) @ ob.pose.bones[leg[2]].matrix
    bpy.context.view_layer.update()
    bpy.context.scene.frame_set(2)
    moved = acts.heads(ob, leg) - start
    assert np.abs(moved[2] - way).max() < NEAR * size
    assert np.linalg.norm(moved[1]) > 0.01 * size, "the knee bends"
    assert _apart(ob, leg, [2.0]).max() < 1e-3 * size / 1.75
