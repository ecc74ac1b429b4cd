"""Rests that are bent, as where a clip's first frame was taken for it: names say what is a leg and what a tail, and
hips and shoulders where the body faces."""

import numpy as np
import pytest

from morph_retarget.core import quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.skeleton import pose_from_basis
from tests.skeletons import skeleton_of
from tests.stances import STANCES, stand
from tools.figure import CHIBI, Bone, Build, blender, humanoid


def _bent(bones: list[Bone], degrees: float, rng: np.random.Generator) -> list[Bone]:
    """Return a body as it stands after each bone has turned by up to ``degrees`` about each axis."""
    skeleton = skeleton_of(bones)
    turns = quat.from_rotation_vector(np.radians(rng.uniform(-degrees, degrees, (1, len(bones), 3))))
    pose = pose_from_basis(skeleton, turns, np.zeros((1, len(bones), 3)))
    own = skeleton.rest_tails - skeleton.rest_positions
    tails: Array = pose.positions[0] + quat.rotate(pose.rotations[0], own)
    heads = pose.positions[0]
    return [Bone(b.name, b.parent, tuple(h), tuple(t)) for b, h, t in zip(bones, heads, tails, strict=True)]


@pytest.mark.parametrize("seed", range(30))
def test_what_has_a_left_and_a_right_is_no_tail(seed: int) -> None:
    bones = _bent(humanoid(build=Build(fingers=2), names=blender), 40.0, np.random.default_rng(seed))
    found = analyze(skeleton_of(bones))
    tails = {bone for bone, tags in found.capabilities.items() if Capability.TAIL in tags}
    assert not {bone for bone in tails if bone.endswith((".L", ".R"))}
    assert not tails & {"Head", "Neck"}


def _anatomist(joint: str) -> str:
    """Name bones in words that every rig's maker might choose, and that no family of rigs has."""
    words = {"hips": "Pelvis", "upperChest": "Ribs", "head": "Skull", "UpperArm": "Bicep", "LowerArm": "Forearm"}
    words |= {"Hand": "Wrist", "UpperLeg": "Thigh", "LowerLeg": "Shin", "Foot": "Ankle", "Toes": "Ball"}
    for side in ("left", "right"):
        if joint.startswith(side):
            part = joint.removeprefix(side)
            return f"{words.get(part, part)}_{side[0]}"
    return words.get(joint, joint)


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("stance", STANCES)
def test_people_are_known_and_face_somewhere_in_any_stance(stance: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    build = Build(
        spine=int(rng.integers(1, 4)),
        clavicles=bool(rng.integers(2)),
        toes=bool(rng.integers(2)),
        fingers=int(rng.choice([0, 5])),
        root=bool(rng.integers(2)),
        arms_down=float(rng.choice([0.0, 45.0, 70.0])),
    )
    shape, names = (None, CHIBI)[seed % 3 == 0], (blender, _anatomist)[seed % 2]
    facing = float(rng.choice([0.0, 90.0, 180.0]))
    skeleton = stand(humanoid(proportions=shape, build=build, names=names), stance, names, facing, rng)
    found = analyze(skeleton)
    assert found.humanoid
    assert found.frame.up @ [0.0, 0.0, 1.0] > 0.99
    assert found.frame.forward @ [np.sin(np.radians(facing)), -np.cos(np.radians(facing)), 0.0] > 0.9
    parts = ("UpperArm", "LowerArm", "Hand", "UpperLeg", "LowerLeg", "Foot", *(("Toes",) if build.toes else ()))
    for joint in ("hips", "head", *(side + part for side in ("left", "right") for part in parts)):
        assert found.joints[joint].bone == names(joint)
