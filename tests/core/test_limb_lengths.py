"""Lengths of limbs: the same for what hangs on its limb and for what is brought to its end."""

from collections.abc import Collection
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.morph.bodies import Bodies
from tests.morph_bodies import Body, bodies_of, real_characters
from tests.skeletons import skeleton_of
from tools.figure import Build, humanoid

ENDS = ("leftFoot", "rightFoot", "leftHand", "rightHand")


def _bodies(detached: Collection[str] = ()) -> Bodies:
    bones = humanoid(build=Build(fingers=2, root=True))
    bones = [replace(bone, parent="root") if bone.name in detached else bone for bone in bones]
    return Bodies.of(analyze(skeleton_of(bones, np.random.default_rng(0))))


@pytest.mark.parametrize("detached", [ENDS[:2], ENDS[2:], ENDS], ids=["feet", "hands", "both"])
def test_feet_and_hands_that_hang_elsewhere_have_the_length_of_their_limbs(detached: tuple[str, ...]) -> None:
    whole, loose = _bodies(), _bodies(detached)
    for name, length, segment in zip(whole.names, whole.limb_lengths, whole.spine_segments, strict=True):
        own = loose.names.index(name)
        assert loose.limb_lengths[own] == pytest.approx(length)
        assert loose.names[loose.spine_segments[own]] == whole.names[segment]


def test_legs_that_hang_beside_the_hips_are_measured_from_the_hips() -> None:
    spine = (Capability.SPINE,)
    rows = [
        Body("control", (0.0, 0.0, 0.0)),
        Body("body", (0.0, 0.3, 1.0), (), "control"),
        Body("hips", (0.0, 0.0, 1.0), (*spine, Capability.ROOT), "body"),
        Body("chest", (0.0, 0.0, 1.5), spine, "hips"),
        Body("thigh", (0.1, 0.0, 1.0), (), "body"),
        Body("foot", (0.1, 0.0, 0.1), (Capability.FOOT,), "thigh"),
    ]
    found = bodies_of(rows)
    segments = [found.names[segment] for segment in found.spine_segments]
    assert segments == ["hips", "hips", "hips", "chest", "hips", "hips"]
    assert found.limb_lengths[4:] == pytest.approx([0.1, 1.0])


def test_feet_of_all_real_rigs_have_limbs_as_long_as_the_way_to_them(data: Path) -> None:
    for name, character in real_characters(data).items():
        bodies = Bodies.of(character)
        for limb in character.limbs:
            steps = np.diff(bodies.positions[list(limb.bones)], axis=0)
            assert bodies.limb_lengths[limb.end] > 0.99 * np.linalg.norm(steps, axis=1).sum(), (name, limb)
