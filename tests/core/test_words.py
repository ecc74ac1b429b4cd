"""Channels in plain words, and the choice of the nearest variant."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.morph import movement
from morph_retarget.core.morph.channels import Channel, TargetKind
from morph_retarget.core.morph.context import Context, Depth, Extent, Height, LimbModifier, Side, Space
from morph_retarget.core.morph.movement import Movement, PositionMode, RotationMode, ScaleMode
from morph_retarget.core.morph.variants import nearest
from morph_retarget.core.morph.words import (
    caveats,
    context_in_words,
    movement_in_words,
    target_in_words,
    without_effect,
)
from tests.morph_bodies import random_bodies

GRASPER = Capability.GRASPER
HANDS = Channel("Hands", Context(GRASPER))
CONTEXTS = st.builds(
    Context,
    st.sampled_from(Capability),
    *(st.sampled_from(kind) for kind in (Depth, Side, Height, Space, Space, Space, Extent, LimbModifier)),
)
MODES = st.builds(
    Movement,
    st.sampled_from(PositionMode),
    st.sampled_from(RotationMode),
    st.sampled_from(ScaleMode),
    *(st.booleans() for _ in range(5)),
)


@pytest.mark.parametrize(
    ("context", "words"),
    [
        (Context(GRASPER), "the graspers"),
        (Context(GRASPER, Depth.FRONT, Side.LEFT), "the front graspers on the left"),
        (Context(Capability.FOOT, height=Height.BOTTOM, side=Side.CENTER), "the lower feet in the middle"),
        (Context(Capability.EYE, extent=Extent.LEFT_MOST), "the leftmost eye"),
        (
            Context(Capability.FOOT, Depth.BACK, extent=Extent.RIGHT_MOST),
            "the rightmost of the rear feet",
        ),
        (
            Context(GRASPER, side=Side.RIGHT, modifier=LimbModifier.SPINE_SEGMENT),
            "the spine segments that carry the graspers on the right",
        ),
        (
            Context(GRASPER, Depth.FRONT, Side.LEFT, depth_space=Space.SETSPACE),
            "the front graspers on the left, counted front to back among the graspers",
        ),
    ],
)
def test_a_context_reads_as_one_would_say_it(context: Context, words: str) -> None:
    assert context_in_words(context) == words


@given(CONTEXTS, CONTEXTS)
def test_contexts_that_can_find_different_bodies_read_differently(one: Context, other: Context) -> None:
    def told(context: Context) -> Context:
        zones = {"depth": context.depth, "side": context.side, "height": context.height}
        unused = {f"{name}_space": Space.BOUNDS for name, zone in zones.items() if zone.value == "any"}
        return replace(context, **unused)

    assert (context_in_words(one) == context_in_words(other)) == (told(one) == told(other))


@pytest.mark.parametrize(
    ("modes", "words"),
    [
        (Movement(), "Position from rest, in meters; rotation from rest"),
        (
            Movement(scale=ScaleMode.LIMB_LENGTH, ground_relative=True),
            "Position from rest, scaled by limb length; z 1 is the ground; rotation from rest",
        ),
        (
            Movement(scale=ScaleMode.CREATURE_SIZE, sagittal_relative=True),
            "Position from rest, scaled by the character's size; x 1 is the plane of symmetry; rotation from rest",
        ),
        (
            Movement(secondary_relative=True, look_at=True),
            "Position toward the target, x 0 at rest and 1 at the target, y and z in meters; "
            "rotation from rest, added to looking at the target",
        ),
        (
            Movement(PositionMode.ABSOLUTE, RotationMode.ABSOLUTE),
            "Position from the ground under the root, in meters; rotation as the character stands",
        ),
    ],
)
def test_a_movement_reads_as_one_would_say_it(modes: Movement, words: str) -> None:
    assert movement_in_words(replace(HANDS, movement=modes)) == words


def test_what_a_channel_does_not_pose_is_not_told() -> None:
    assert movement_in_words(replace(HANDS, poses_position=False)) == "Rotation from rest"
    neither = replace(HANDS, poses_position=False, poses_rotation=False)
    assert movement_in_words(neither) == "Neither position nor rotation"


def test_a_target_reads_as_one_would_say_it() -> None:
    assert target_in_words(HANDS) == "nothing"
    mouth = replace(HANDS, target=TargetKind.CONTEXT, secondary=Context(Capability.MOUTH))
    assert target_in_words(mouth) == "for each body the nearest of the mouths"
    assert "each character" in target_in_words(replace(HANDS, target=TargetKind.EXTERNAL))


def test_modes_that_do_not_keep_the_rest_pose_say_so() -> None:
    assert not caveats(HANDS)
    assert "rest pose" in caveats(replace(HANDS, movement=Movement(PositionMode.ABSOLUTE)))[0]
    assert "rest pose" in caveats(replace(HANDS, movement=Movement(rotation=RotationMode.ABSOLUTE)))[0]
    looking = replace(HANDS, movement=Movement(look_at=True), target=TargetKind.EXTERNAL)
    assert "looking at the target" in caveats(looking)[0]
    reaching = Movement(PositionMode.ABSOLUTE, secondary_relative=True)
    assert not caveats(replace(HANDS, movement=reaching, target=TargetKind.EXTERNAL))


def _others(modes: Movement, name: str) -> list[Movement]:
    value = getattr(modes, name)
    choices = (True, False) if isinstance(value, bool) else type(value)
    return [replace(modes, **{name: choice}) for choice in choices]


@given(MODES, st.integers(0, 1000))
def test_settings_that_are_said_to_have_no_effect_have_none(modes: Movement, seed: int) -> None:
    rng = np.random.default_rng(seed)
    bodies, chosen = random_bodies(rng), np.arange(5)
    positions, turns = rng.normal(size=(1, 5, 3)), rng.normal(size=(1, 5, 4))
    targets = rng.normal(size=(1, 5, 3))
    channel = replace(HANDS, movement=modes, target=TargetKind.EXTERNAL)

    def shown(mode: Movement) -> list[np.ndarray]:
        found = movement.frames(bodies, chosen, [mode] * 5, np.zeros(5, dtype=bool)).toward(targets)
        return list(movement.specialize(found, positions, turns))

    for name in without_effect(channel):
        for other in _others(modes, name):
            for a, b in zip(shown(modes), shown(other), strict=True):
                np.testing.assert_array_equal(a, b)


def test_what_leans_on_a_target_has_no_effect_without_one() -> None:
    assert without_effect(HANDS) == {"secondary_relative", "directional_only", "look_at"}
    still = replace(HANDS, poses_position=False, target=TargetKind.EXTERNAL)
    assert {"scale", "ground_relative"} < without_effect(still)
    assert "look_at" not in without_effect(still)
    assert "rotation" in without_effect(replace(HANDS, poses_rotation=False))


def test_the_variant_with_the_shortest_way_to_its_targets_is_the_nearest() -> None:
    places = np.array([[[1.0, 0, 0], [0, 0, 1]], [[0.2, 0, 0], [0, 0, 0.3]], [[0.1, 0, 0], [0, 0, 5]]])
    assert nearest(places, np.zeros_like(places), 1e-3) == 1


def test_of_equally_near_variants_the_first_is_taken_and_incomplete_ones_last() -> None:
    places = np.array([[[1.0, 0, 0]], [[-0.9999999, 0, 0]]])
    assert nearest(places, np.zeros_like(places), 1e-3) == 0
    places[0] = np.nan
    assert nearest(places, np.zeros_like(places), 1e-3) == 1
    assert nearest(np.full((2, 1, 3), np.nan), np.zeros((2, 1, 3)), 1e-3) == 0
