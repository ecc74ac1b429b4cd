"""Mending a rig's tree: whatever its bones are called, it stays a tree."""

import numpy as np
import pytest

from morph_retarget.core.character import joint_names, mending
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.character.names import read_names
from morph_retarget.core.skeleton import Skeleton, Tree
from tests.skeletons import skeleton_of
from tools.figure import Bone, Build, humanoid

COUNTED = ((2, 8), (3, 0), (4, 0), (7, 3), (8, 0), (9, 5), (5, 4))
"""Bones of a face by number, and the numbers of the helpers that carry some of them: they go round in a ring."""


def _mended(skeleton: Skeleton) -> Tree:
    readings = read_names(skeleton.names)
    scores = [joint_names.joint_scores(r) for r in readings]
    heads, tails = skeleton.rest_positions, skeleton.rest_tails
    return Tree(mending.mend(skeleton, heads, tails, readings, scores))


def _with_face(bones: list[Bone]) -> list[Bone]:
    """Return a body with bones in its face that say nothing but a number, on helpers that bear other ones' numbers."""
    head = next(b for b in bones if b.name == "head")
    out = list(bones)
    for number, helper in COUNTED:
        x, y, z = np.add(head.head, (0.01 * number - 0.05, -0.08, 0.05))
        above = out[-1].name
        if helper:
            out.append(Bone(f"dummy{helper:02}", "head", (x, y, z), (x, y - 0.01, z)))
            above = out[-1].name
        out.append(Bone(f"bone{number:02}", above, (x, y, z), (x, y - 0.02, z)))
    return out


def test_a_number_makes_no_twins() -> None:
    skeleton = skeleton_of(_with_face(humanoid(build=Build(fingers=2))))
    for bone, parent in enumerate(_mended(skeleton).parents):
        assert parent == skeleton.tree.parents[bone] or parent in skeleton.tree.ancestors[bone], skeleton.names[bone]


def test_a_numbered_face_changes_no_joint() -> None:
    bones = humanoid(build=Build(fingers=2))
    found, plain = analyze(skeleton_of(_with_face(bones))), analyze(skeleton_of(bones))
    assert {j: m.bone for j, m in found.joints.items()} == {j: m.bone for j, m in plain.joints.items()}


@pytest.mark.parametrize("seed", range(20))
def test_whatever_bones_are_called_they_stay_a_tree(seed: int) -> None:
    rng = np.random.default_rng(seed)
    bones = humanoid(build=Build(fingers=2, twists=1))
    words = [f"{kind}{part}" for kind in ("", "MCH-", "dummy_") for part in ("arm", "leg", "face")]
    names = {b.name: f"{words[rng.integers(len(words))]}{'.' * i}" for i, b in enumerate(bones)}  # dots: one each
    named = [Bone(names[b.name], names.get(b.parent or ""), b.head, b.tail) for b in bones]
    tree = _mended(skeleton_of(named))
    assert sorted(tree.order) == list(range(len(bones)))
