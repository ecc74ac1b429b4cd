"""Legs: what a character walks on, found on real rigs, on our own creatures, and on bodies of up to 24 legs."""

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from morph_retarget.core import quat
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.character.character import Character
from morph_retarget.core.character.frame import Placement
from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.locomotion.stepping import legs
from morph_retarget.core.locomotion.stepping.legs import LEAST_HEIGHT, NONE, Leg, Legs
from tests.morph_bodies import real_characters
from tests.skeletons import skeleton_of
from tools.creatures import CREATURES
from tools.figure import CHIBI, Bone, Build, humanoid, moved

few = settings(max_examples=12)
seeds = st.integers(0, 10_000)
FEET = {"biped": 2, "hound": 4, "beetle": 6, "spider": 8, "bird": 2, "snake": 0, "asura": 2, "lopside": 2}


def _creature(name: str) -> Character:
    return analyze(skeleton_of(CREATURES[name]()))


def _crawler(sizes: Sequence[float], splay: float = 0.5) -> Character:
    """Return a body with a row of two legs for each size, from the rear to the front, on one level."""
    count, deepest = len(sizes), max(sizes)
    ys = 0.5 * (count - 1) - np.arange(count)
    bones = [Bone("root", None, (0.0, ys[0] + 0.3, 1.1 * deepest), (0.0, ys[0], 1.1 * deepest))]
    for i, y in enumerate([*ys, ys[-1] - 0.8]):
        name = "head" if i == count else f"spine{i}"
        bones.append(Bone(name, bones[-1].name, (0.0, y, 1.1 * deepest), (0.0, y - 0.5, 1.1 * deepest)))
    for i, (y, size) in enumerate(zip(ys, sizes, strict=True)):
        for side, sign in (("L", 1.0), ("R", -1.0)):
            points = [
                (sign * (0.15 + reach * splay * size), float(y) + ahead * size, height * size)
                for reach, ahead, height in ((0.0, 0.0, 1.0), (0.6, -0.05, 0.6), (1.0, 0.0, 0.08), (1.0, -0.2, 0.01))
            ]
            parent = f"spine{i}"
            for part, start, end in zip(("thigh", "shin", "foot"), points[:-1], points[1:], strict=True):
                bones.append(Bone(f"{part}{i}.{side}", parent, start, end))
                parent = bones[-1].name
    return analyze(skeleton_of(bones))


def _forked() -> Character:
    """Return a body on two thighs that carry two shins each."""
    bones = [
        Bone("hips", None, (0.0, 0.0, 1.1), (0.0, 0.0, 1.3)),
        Bone("spine", "hips", (0.0, 0.0, 1.3), (0.0, 0.0, 1.6)),
        Bone("head", "spine", (0.0, 0.0, 1.6), (0.0, 0.0, 1.9)),
    ]
    for side, sign in (("L", 1.0), ("R", -1.0)):
        bones.append(Bone(f"thigh.{side}", "hips", (sign * 0.15, 0.0, 1.05), (sign * 0.4, 0.0, 0.7)))
        for way, ahead in (("fore", -0.35), ("hind", 0.35)):
            knee, ankle = (sign * 0.4, 0.0, 0.7), (sign * 0.5, ahead, 0.08)
            bones.append(Bone(f"{way}shin.{side}", f"thigh.{side}", (knee[0], 0.2 * ahead, knee[2]), ankle))
            bones.append(Bone(f"{way}foot.{side}", f"{way}shin.{side}", ankle, (ankle[0], ahead - 0.1, 0.0)))
    return analyze(skeleton_of(bones))


def _names(character: Character, bones: Sequence[int]) -> list[str]:
    return [character.skeleton.names[bone] for bone in bones]


def _check(character: Character, found: Legs) -> None:
    """Check what is true of all legs."""
    together = [leg for group in found.groups for leg in group.legs]
    assert sorted(together) == list(range(len(found.legs)))
    for group in found.groups:
        own = [found.legs[leg] for leg in group.legs]
        order = [(-leg.row, -leg.side) for leg in own]
        assert order == sorted(order)
        assert group.ratio >= 1
        assert group.ratio.denominator <= 3
        assert group.height >= LEAST_HEIGHT * group.length > 0.0
        assert found.sides(group) == tuple(leg.side for leg in own)
    heights = [group.height for group in found.groups]
    assert heights == sorted(heights, reverse=True)
    assert not found.groups or found.groups[0].ratio == 1
    rest = character.local_to_character.points(character.skeleton.rest_positions)
    for leg in found.legs:
        assert leg.path[-1] == leg.foot
        assert (leg.hip == rest[leg.path[0]]).all()
        assert (leg.home == rest[leg.foot]).all()
        way = float(np.linalg.norm(np.diff(rest[list(leg.path)], axis=0), axis=-1).sum())
        assert np.isclose(leg.length, way)
        assert np.isfinite([*leg.heel, *leg.tip]).all()
        assert leg.heel[2] == leg.tip[2]
        assert leg.carrier not in leg.path
        assert leg.ball == NONE or leg.ball in character.skeleton.tree.below(leg.foot)


# --- any character ---


def test_every_foot_of_a_real_rig_ends_one_leg_of_one_group(data: Path) -> None:
    for character in real_characters(data).values():
        found = legs.find(character)
        assert len(found.legs) == len(character.legs)
        _check(character, found)


@pytest.mark.parametrize("name", FEET)
def test_a_creature_has_as_many_legs_as_it_was_made_with_in_one_group(name: str) -> None:
    found = legs.find(_creature(name))
    _check(_creature(name), found)
    assert len(found.legs) == FEET[name]
    assert len(found.groups) == (FEET[name] > 0)


@pytest.mark.parametrize("pairs", range(1, 13))
def test_bodies_of_up_to_24_legs_go_in_one_group_from_the_rear_to_the_front(pairs: int) -> None:
    character = _crawler([1.0] * pairs)
    found = legs.find(character)
    _check(character, found)
    assert len(found.groups) == 1
    feet = [found.legs[leg].foot for leg in found.groups[0].legs]
    assert _names(character, feet) == [f"foot{i}.{side}" for i in range(pairs) for side in "LR"]


def test_a_character_without_feet_has_neither_legs_nor_groups() -> None:
    found = legs.find(_creature("snake"))
    assert found.legs == found.groups == ()


@few
@given(seeds)
def test_legs_do_not_depend_on_how_the_armature_is_placed_and_scaled(seed: int) -> None:
    rng = np.random.default_rng(seed)
    turn = quat.to_matrix(quat.from_rotation_vector(np.array([np.pi / 2, 0.0, rng.uniform(-3.0, 3.0)])))
    placement = Placement(turn, float(10.0 ** rng.uniform(-2.0, 0.0)), rng.normal(size=3) * [1.0, 1.0, 0.0])
    back = np.eye(4)
    inverse = placement.inverse()
    back[:3, :3], back[:3, 3] = inverse.scale * inverse.rotation, inverse.translation
    bones = humanoid(build=Build(fingers=2))
    there = analyze(skeleton_of(moved(bones, back), rng), placement)
    here, there = (legs.find(character).legs for character in (analyze(skeleton_of(bones)), there))
    for a, b in zip(here, there, strict=True):
        assert a.path == b.path
        assert np.isclose(a.length, b.length)
        for name in ("hip", "home", "heel", "tip"):
            assert np.allclose(getattr(a, name), getattr(b, name), atol=1e-6)


# --- one leg ---


def _mirrored(point: np.ndarray) -> np.ndarray:
    return point * np.array([-1.0, 1.0, 1.0])


@pytest.mark.parametrize("name", ["biped", "hound", "beetle", "bird", "asura"])
def test_mirror_legs_are_mirror_images(name: str) -> None:
    found = legs.find(_creature(name))
    for left, right in zip(found.legs[::2], found.legs[1::2], strict=True):
        assert (left.side, right.side, left.row) == (1, -1, right.row)
        assert np.isclose(left.length, right.length)
        for part in ("hip", "home", "heel", "tip"):
            assert np.allclose(getattr(left, part), _mirrored(getattr(right, part)), atol=1e-6)


@pytest.mark.parametrize("build", [Build(), Build(toes=False), Build(twists=2, root=True), Build(spine=1)])
@pytest.mark.parametrize("small", [False, True])
def test_a_human_foot_rolls_from_behind_the_ankle_over_the_ball(build: Build, small: bool) -> None:
    bones = humanoid(1.1, CHIBI, build) if small else humanoid(build=build)
    character = analyze(skeleton_of(bones))
    for leg in legs.find(character).legs:
        assert leg.foot in {character.bone("leftFoot"), character.bone("rightFoot")}
        assert leg.path[0] in {character.bone("leftUpperLeg"), character.bone("rightUpperLeg")}
        assert (leg.ball != NONE) == build.toes
        assert leg.heel[1] > 0.0 > leg.tip[1]
        assert np.isclose(leg.sole, 0.0)
        if leg.ball != NONE:
            ball = character.local_to_character.points(character.skeleton.rest_positions[leg.ball])
            assert np.allclose((leg.home + leg.tip)[:2], ball[:2])


def test_feet_of_humans_are_their_ankles_on_all_rigs_that_stand(data: Path) -> None:
    for name, character in real_characters(data).items():
        if not character.humanoid or not character.rest_is_pose:
            continue
        for leg in legs.find(character).legs:
            share = np.linalg.norm(leg.tip[:2]) / leg.length
            assert 0.04 < share < 0.4, name
            assert leg.heel[1] > 0.0 > leg.tip[1], name
            assert 0.8 < leg.height / leg.length < 1.6, name


def test_a_spider_stands_on_the_tips_of_its_legs(data: Path) -> None:
    character = real_characters(data)["m2m_spider"]
    found = legs.find(character)
    assert len(found.groups) == 1
    for leg in found.legs:
        assert "tip" in character.skeleton.names[leg.foot]
        assert (leg.heel == leg.tip).all()
        assert leg.home[2] < 0.05 * leg.length


def test_a_spider_has_the_feet_that_it_stands_on_in_actions_as_well(data: Path) -> None:
    character = real_characters(data)["m2m_spider"]
    names = {name for name, tags in character.capabilities.items() if Capability.FOOT in tags}
    assert names == {character.skeleton.names[leg.foot] for leg in legs.find(character).legs}
    assert len(names) == 8


def test_animals_on_their_toes_have_no_ball_and_stand_on_the_ground(data: Path) -> None:
    for name in ("m2m_fox", "khronos_fox", "rigify_cat", "rigify_basic_quadruped"):
        found = legs.find(real_characters(data)[name])
        assert [len(group.legs) for group in found.groups] == [4], name
        for leg in found.legs:
            assert leg.ball == NONE, name
            assert abs(leg.sole) < 1e-9, name
            assert leg.tip[1] <= leg.heel[1] <= 0.1 * leg.length, name


def test_bones_that_lie_in_the_pelvis_are_no_part_of_the_leg(data: Path) -> None:
    for name, thigh in (
        ("cmu_cgspeed_bvh", "LeftUpLeg"),
        ("m2m_fox", "Back_Leg_Upper_L"),
        ("quaternius_trex", "BackUpLeg.L"),
    ):
        character = real_characters(data)[name]
        starts = _names(character, [leg.path[0] for leg in legs.find(character).legs])
        assert thigh in starts, name


def test_a_foot_that_hangs_on_something_else_still_ends_its_leg(data: Path) -> None:
    character = real_characters(data)["quaternius_cyberpunk_ikfeet"]
    left = legs.find(character).legs[0]
    assert _names(character, left.path) == ["UpperLeg.L", "LowerLeg.L", "Foot.L"]
    assert 0.9 < left.height / left.length < 1.2
    assert left.loose
    assert not any(leg.loose for leg in legs.find(real_characters(data)["m2m_fox"]).legs)


def test_legs_that_branch_share_their_upper_bones() -> None:
    character = _forked()
    found = legs.find(character)
    _check(character, found)
    assert len(found.legs) == 4
    left = [leg for leg in found.legs if leg.side > 0]
    assert left[0].path[0] == left[1].path[0]
    assert left[0].foot != left[1].foot
    assert all(leg.carrier == character.skeleton.index["hips"] for leg in found.legs)


# --- groups ---


def test_legs_of_two_lengths_go_in_two_groups_the_longest_first() -> None:
    found = legs.find(_crawler([0.5, 0.5, 1.0]))
    assert [len(group.legs) for group in found.groups] == [2, 4]
    assert [group.ratio for group in found.groups] == [1, 2]


def test_legs_that_differ_a_little_go_together() -> None:
    found = legs.find(_crawler([1.0, 0.9, 0.8, 0.7]))
    assert [len(group.legs) for group in found.groups] == [8]


def test_legs_of_a_row_stay_together_however_they_differ() -> None:
    found = legs.find(_creature("lopside"))
    left, right = found.legs
    assert left.length > 1.05 * right.length
    assert [len(group.legs) for group in found.groups] == [2]


def test_a_body_between_sprawling_legs_steps_as_if_it_stood_higher() -> None:
    found = legs.find(_crawler([1.0, 1.0], splay=4.0))
    group = found.groups[0]
    assert found.legs[0].height < LEAST_HEIGHT * group.length
    assert np.isclose(group.height, LEAST_HEIGHT * group.length)


@pytest.mark.parametrize(
    ("ratio", "simple"), [(1.0, 1), (1.1, 1), (1.3, Fraction(4, 3)), (1.52, Fraction(3, 2)), (2.1, 2), (7.4, 7)]
)
def test_ratios_are_harmonized_to_small_rational_numbers(ratio: float, simple: Fraction) -> None:
    assert legs.harmonized(ratio) == simple


@few
@given(st.floats(1.0, 20.0))
def test_a_harmonized_ratio_is_near_what_it_stands_for(ratio: float) -> None:
    assert abs(float(legs.harmonized(ratio)) - ratio) <= 0.5
    assert legs.harmonized(ratio) >= 1


def test_the_height_of_a_leg_counts_from_the_ground_under_it() -> None:
    for leg in legs.find(_creature("hound")).legs:
        assert isinstance(leg, Leg)
        assert np.isclose(leg.height, leg.hip[2])


@pytest.mark.parametrize("paw", ["FrontPaw.L", "FrontPaw.R", "HindPaw.L", "HindPaw.R"])
def test_a_leg_that_is_lifted_at_rest_is_a_leg(paw: str) -> None:
    body, lifted = CREATURES["hound"](), (0.0, 0.0, 0.2)
    low = {paw, *(b.parent for b in body if b.name == paw)}

    def up(bone: Bone) -> Bone:
        head = tuple(np.add(bone.head, lifted)) if bone.name == paw else bone.head
        return Bone(bone.name, bone.parent, head, tuple(np.add(bone.tail, lifted)) if bone.name in low else bone.tail)

    def found(bones: Sequence[Bone]) -> set[tuple[object, ...]]:
        character = analyze(skeleton_of(bones))
        return {(leg.row, leg.side, *(character.skeleton.names[b] for b in leg.bones)) for leg in character.legs}

    assert found([up(bone) for bone in body]) == found(body)
