"""Girdles: arms swing about where their girdles end, whether names say what these are or not."""

from pathlib import Path

import numpy as np
import pytest

from morph_retarget.core.character import girdles
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.character.character import Character
from morph_retarget.core.solve import posing
from tests import goal_sets
from tests.goal_sets import Subject
from tests.morph_bodies import real_characters
from tests.skeletons import skeleton_of
from tools.figure import Build, humanoid


def _found(character: Character) -> set[str]:
    rest = Subject(character).bodies.positions
    return {character.skeleton.names[bone] for bone in girdles.find(character, rest)}


def test_collar_bones_are_girdles_and_upper_arms_are_not() -> None:
    shoulders = {"leftShoulder", "rightShoulder"}
    for build in (Build(), Build(twists=2, arms_down=70.0), Build(clavicles=False), Build(clavicles=False, twists=2)):
        found = _found(analyze(skeleton_of(humanoid(build=build), np.random.default_rng(1))))
        assert found == (shoulders if build.clavicles else set())


@pytest.mark.parametrize(
    ("rig", "names"),
    [
        ("m2m_kaiju", {"Front_Leg_Shoulder_L", "Front_Leg_Shoulder_R"}),
        ("quaternius_trex", {"FrontLeg.L", "FrontLeg.R"}),
        ("m2m_fox", set[str]()),
        ("quaternius_wolf", set[str]()),
    ],
)
def test_girdles_of_beasts_with_arms_are_known_by_where_they_lie(data: Path, rig: str, names: set[str]) -> None:
    """Front legs on the ground are no arms: their first bones take steps."""
    assert _found(real_characters(data)[rig]) == names


def test_creatures_have_no_other_girdles_than_shoulders() -> None:
    for name, character in goal_sets.creatures().items():
        assert _found(character) <= {"Shoulder.L", "Shoulder.R"}, name


def test_a_girdle_stays_with_the_trunk_when_its_hand_goes_to_a_goal(data: Path) -> None:
    subject = Subject(real_characters(data)["m2m_kaiju"])
    hands = [i for i, limb in enumerate(subject.character.limbs) if limb.kind == "arm"]
    ends = [subject.character.limbs[i].end for i in hands]
    wanted = [(subject.root, True, True), *((end, True, False) for end in ends)]
    plan = posing.prepare(subject.character, subject.bodies.positions, subject.root, wanted)
    inside = girdles.find(subject.character, subject.bodies.positions)
    assert inside
    assert inside.isdisjoint(joint for end in ends for joint in plan.joints_of(end))
