"""Bodies in two trees: a rig whose front half hangs on nothing moves as if it hung on the rear half."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from morph_retarget.core import pipeline, quat
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.character.character import Character
from morph_retarget.core.locomotion.stepping import legs
from morph_retarget.core.mocap.plan import RetargetSettings, prepare
from tests import gait_courses, gait_measures
from tests.gait_courses import Size, Trial
from tests.gait_measures import Walked
from tests.goal_sets import Subject
from tests.skeletons import play, skeleton_of, wild
from tools.creatures import CREATURES
from tools.figure import Bone, Build, humanoid

NEAR = 0.03
"""Bones of the two halves are where those of the whole body are, to this share of its height."""


def _bones(apart: str | None) -> list[Bone]:
    """Return the hound without the bone on its ground, one of its bones a root."""
    bones = [Bone(b.name, b.parent, b.head, b.tail) for b in CREATURES["hound"]() if b.name != "Root"]
    return [replace(b, parent=None) if b.name in (apart, "Hips") else b for b in bones]


@cache
def _hound(apart: str | None = None) -> Character:
    return analyze(skeleton_of(_bones(apart), np.random.default_rng(3)))


@pytest.mark.parametrize("apart", ["Spine", "Spine.001", "Chest"])
def test_halves_of_a_body_stay_together(apart: str) -> None:
    whole, halves = _hound(), _hound(apart)
    pose = wild(whole.skeleton, 30, np.random.default_rng(5), reach=0.15)
    result = pipeline.evaluate(prepare(whole, halves, RetargetSettings(plant_feet=False)), pose, 1 / 30)
    assert len(set(result.bones.tolist())) == len(result.bones), "a bone is keyed twice"
    assert len(set(result.moved.tolist())) == len(result.moved), "a bone is keyed twice"
    own = play(halves, result)
    order = [halves.skeleton.index[name] for name in whole.skeleton.names]
    apart_by = np.linalg.norm(own.positions[:, order] - pose.positions, axis=-1).max(axis=0)
    assert apart_by.max() < NEAR * whole.frame.height, whole.skeleton.names[int(apart_by.argmax())]
    turned = quat.angle_between(own.rotations[:, order], pose.rotations).max(axis=0)
    assert np.degrees(turned).max() < 8.0, whole.skeleton.names[int(turned.argmax())]


@pytest.mark.parametrize("apart", ["Spine", "Spine.001", "Chest"])
def test_the_legs_of_both_halves_are_legs(apart: str) -> None:
    def legs(body: Character) -> set[tuple[object, ...]]:
        return {(leg.row, leg.side, *(body.skeleton.names[b] for b in leg.bones)) for leg in body.legs}

    assert legs(_hound(apart)) == legs(_hound())


@cache
def _person(apart: str | None = None) -> Character:
    """Return a human, one of its bones a root."""
    bones = humanoid(build=Build(arms_down=40.0))
    bones = [replace(b, parent=None) if b.name == apart else b for b in bones]
    return analyze(skeleton_of(bones, np.random.default_rng(3)))


def _walked(body: Character) -> Walked:
    trial = Trial(gait_courses.circle(Size.of(legs.find(body)), 0.3), steady=True)
    return gait_measures.walk(Subject(body), trial)


@pytest.mark.parametrize("apart", ["Spine", "Spine.001", "Chest"])
def test_halves_of_a_body_walk_together(apart: str) -> None:
    _walk_alike(_hound(), _hound(apart))


@pytest.mark.parametrize("apart", ["spine", "chest", "upperChest"])
def test_an_upper_body_in_a_tree_of_its_own_goes_with_the_legs(apart: str) -> None:
    _walk_alike(_person(), _person(apart))


def _walk_alike(whole: Character, halves: Character) -> None:
    """Assert that a body in two trees walks as the same body in one."""
    walked, apart = _walked(whole), _walked(halves)
    order = [halves.skeleton.index[name] for name in whole.skeleton.names]
    assert np.allclose(apart.places[:, order], walked.places, atol=1e-9)
    assert np.allclose(np.abs((apart.turns[:, order] * walked.turns).sum(axis=-1)), 1.0)


@pytest.mark.parametrize("apart", [None, "Spine", "Chest"])
def test_paws_of_both_halves_end_their_legs_though_they_hang_on_nothing(apart: str | None) -> None:
    bones = [replace(b, parent=None) if "Paw" in b.name else b for b in _bones(apart)]
    body = analyze(skeleton_of(bones, np.random.default_rng(3)))
    assert {body.skeleton.names[leg.end] for leg in body.legs} == {b.name for b in bones if "Paw" in b.name}
