"""Rests that are bent, as where a clip's first frame was taken for it: names say what is a leg and what a tail."""

import numpy as np
import pytest

from morph_retarget.core import quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.skeleton import pose_from_basis
from tests.skeletons import skeleton_of
from tools.figure import Bone, Build, blender, humanoid


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
