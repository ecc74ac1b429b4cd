"""Frames that are known again: shown as they were played, and played anew as soon as anything about them is other."""

import bpy
import numpy as np
import pytest

from morph_retarget.blender.morph import perform, replay
from morph_retarget.core import play
from morph_retarget.core.arrays import Array
from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.morph.channels import Channel, TargetKind
from morph_retarget.core.morph.context import Context, Side
from morph_retarget.core.morph.movement import Movement, ScaleMode
from tests.blender import acts, scenes
from tests.blender.acts import Act

HANDS = Channel("Hands", Context(Capability.GRASPER), Movement(scale=ScaleMode.LIMB_LENGTH))
LOOK = Channel("Look", Context(Capability.HEAD), Movement(look_at=True), TargetKind.EXTERNAL, poses_position=False)
REACH = Channel(
    "Reach", Context(Capability.GRASPER, side=Side.LEFT), Movement(secondary_relative=True), TargetKind.EXTERNAL
)
FRAMES = [1, 5, 12.5, 20]

pytestmark = pytest.mark.usefixtures("registered")


@pytest.fixture
def solved(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Count the frames that are solved."""
    found: list[int] = []
    real = play.evaluate

    def evaluate(*arguments: object) -> object:
        found.append(1)
        return real(*arguments)

    monkeypatch.setattr(play, "evaluate", evaluate)
    return found


def _act() -> Act:
    act = acts.act([acts.creature("biped")], HANDS)
    for frame, share in ((1, 0.0), (10, 1.0), (20, -0.5)):
        act.key(frame, "Hands", position=(0.1 * share, -0.3 * share, 0.1))
    return act


def _shown(ob: bpy.types.Object, frames: list[float] | None = None) -> Array:
    return scenes.evaluated(ob, ob.pose.bones.keys(), FRAMES if frames is None else frames)


def test_a_second_round_solves_nothing_and_shows_the_same(solved: list[int]) -> None:
    [ob] = (act := _act()).obs
    first, count = _shown(ob), len(solved)
    assert np.array_equal(_shown(ob), first)
    assert np.array_equal(_shown(ob, FRAMES[::-1])[::-1], first)
    assert len(solved) == count
    act.key(10, "Hands", position=(0.2, -0.1, 0.1))
    assert np.abs(_shown(ob)[2] - first[2]).max() > 0.01
    assert len(solved) > count


def test_a_bone_that_is_pulled_off_its_place_comes_back() -> None:
    [ob] = _act().obs
    first = _shown(ob)
    ob.pose.bones["Hand.L"].location = (0.3, 0.0, 0.0)
    ob.pose.bones["Hand.L"].rotation_quaternion = (0.0, 1.0, 0.0, 0.0)
    assert np.array_equal(_shown(ob), first)


def test_another_rotation_mode_shows_the_same_pose() -> None:
    [ob] = _act().obs
    first = _shown(ob)
    for mode in ("XYZ", "AXIS_ANGLE", "QUATERNION"):
        for name in ("UpperArm.L", "LowerArm.L"):
            ob.pose.bones[name].rotation_mode = mode
        assert np.abs(_shown(ob) - first).max() < 1e-5


def test_a_target_that_moves_is_followed_in_the_second_round() -> None:
    act = acts.act([acts.creature("biped")], REACH, LOOK)
    [ob] = act.obs
    target = bpy.data.objects.new("Target", None)
    bpy.context.scene.collection.objects.link(target)
    act.key(1, "Reach", position=(1.0, 0.0, 0.0))
    for name in ("Reach", "Look"):
        act.values(0, name).target = target
    target.location = (0.3, -0.5, 1.2)
    before = _shown(ob, [1, 2])
    target.location = (0.1, -0.5, 0.9)
    after = _shown(ob, [1, 2])
    assert np.abs(after - before).max() > 0.05
    target.location = (0.3, -0.5, 1.2)
    assert np.array_equal(_shown(ob, [1, 2]), before)


def test_a_character_that_is_moved_away_from_its_target_turns_to_it() -> None:
    act = acts.act([acts.creature("biped")], LOOK)
    [ob] = act.obs
    target = bpy.data.objects.new("Target", None)
    bpy.context.scene.collection.objects.link(target)
    act.values(0, "Look").target = target
    act.key(1, "Look", rotation=(1.0, 0.0, 0.0, 0.0))
    target.location = (1.0, -3.0, 1.5)
    before = _shown(ob, [1])
    ob.location.x = 2.0
    moved = _shown(ob, [1])
    moved[..., 0, 3] -= 2.0
    assert np.abs(moved - before).max() > 0.05


def test_no_more_frames_are_kept_than_are_worth_it(monkeypatch: pytest.MonkeyPatch, solved: list[int]) -> None:
    monkeypatch.setattr(replay, "MOST", 2)
    [ob] = _act().obs
    first = _shown(ob, [1, 5, 10])
    count = len(solved)
    assert np.array_equal(_shown(ob, [5, 10]), first[1:])
    assert len(solved) == count
    assert np.array_equal(_shown(ob, [1]), first[:1])
    assert len(solved) == count + 1


def test_what_is_forgotten_is_solved_anew(solved: list[int]) -> None:
    [ob] = _act().obs
    first, count = _shown(ob, [5]), len(solved)
    perform.forget(ob)
    assert np.array_equal(_shown(ob, [5]), first)
    assert len(solved) > count
