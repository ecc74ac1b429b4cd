"""Contexts (Hecker 2008 §3.1.1): which bodies a query finds."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.morph.context import Context, Depth, Extent, Height, LimbModifier, Side, Space, select
from tests.morph_bodies import (
    Body,
    bodies_of,
    mirrored,
    names_of,
    random_bodies,
    real_bodies,
    shuffled,
    symmetric_bodies,
)

GRASPER, SPINE = Capability.GRASPER, Capability.SPINE
seeds = st.integers(0, 10_000)
few = settings(max_examples=25)


def _found(context: Context, bodies: object) -> set[str]:
    return set(names_of(bodies, select(context, bodies)))


def _four_graspers() -> object:
    """Return a long body, four graspers all in its front half, two of them farther in front, and a mouth."""
    return bodies_of(
        [
            Body("hips", (0, 1.0, 1.0), (Capability.ROOT, SPINE)),
            Body("chest", (0, -0.5, 1.0), (SPINE,), "hips"),
            Body("left clavicle", (0.1, -0.5, 1.0), (SPINE,), "chest"),
            Body("left elbow", (0.4, -0.6, 1.0), (), "left clavicle"),
            Body("front left", (0.5, -1.0, 0.8), (GRASPER,), "left elbow"),
            Body("right shoulder", (-0.1, -0.5, 1.0), (), "chest"),
            Body("front right", (-0.5, -1.0, 1.2), (GRASPER,), "right shoulder"),
            Body("rear left", (0.5, -0.4, 0.8), (GRASPER,), "chest"),
            Body("rear right", (-0.5, -0.4, 1.2), (GRASPER,), "chest"),
            Body("mouth", (0, -1.0, 1.0), (Capability.MOUTH,), "chest"),
        ],
        low=(-0.6, -1.1, 0.0),
        high=(0.6, 1.1, 2.0),
    )


def test_front_of_the_bounds_chooses_all_graspers_of_the_papers_example_and_front_of_the_setspace_two() -> None:
    bodies = _four_graspers()
    all_four = {"front left", "front right", "rear left", "rear right"}
    assert _found(Context(GRASPER), bodies) == all_four
    assert _found(Context(GRASPER, Depth.FRONT), bodies) == all_four
    assert _found(Context(GRASPER, Depth.BACK), bodies) == set()
    setspace = {"depth_space": Space.SETSPACE}
    assert _found(Context(GRASPER, Depth.FRONT, **setspace), bodies) == {"front left", "front right"}
    assert _found(Context(GRASPER, Depth.BACK, **setspace), bodies) == {"rear left", "rear right"}


def test_constraints_intersect() -> None:
    bodies = _four_graspers()
    spaces = {"depth_space": Space.SETSPACE, "height_space": Space.SETSPACE}
    assert _found(Context(GRASPER, Depth.FRONT, Side.LEFT, **spaces), bodies) == {"front left"}
    assert _found(Context(GRASPER, Depth.FRONT, Side.RIGHT, Height.TOP, **spaces), bodies) == {"front right"}
    assert _found(Context(GRASPER, Depth.FRONT, Side.RIGHT, Height.BOTTOM, **spaces), bodies) == set()


@pytest.mark.parametrize(
    ("half", "other", "center"),
    [
        ({"depth": Depth.FRONT}, {"depth": Depth.BACK}, {"depth": Depth.CENTER}),
        ({"side": Side.LEFT}, {"side": Side.RIGHT}, {"side": Side.CENTER}),
        ({"height": Height.TOP}, {"height": Height.BOTTOM}, {"height": Height.CENTER}),
    ],
)
@pytest.mark.parametrize("space", Space)
@few
@given(seed=seeds)
def test_two_halves_make_a_whole_and_share_the_center_zone(
    half: dict[str, object], other: dict[str, object], center: dict[str, object], space: Space, seed: int
) -> None:
    bodies = random_bodies(np.random.default_rng(seed))
    spaces = dict.fromkeys(("depth_space", "side_space", "height_space"), space)
    one, two, middle = (_found(Context(GRASPER, **zone, **spaces), bodies) for zone in (half, other, center))
    assert one | two == _found(Context(GRASPER), bodies)
    assert one & two == middle


def test_the_center_zone_is_about_the_middle_of_what_it_divides() -> None:
    rows = [Body(f"{x}", (x, 0, 1), (GRASPER,)) for x in (-1.0, -0.21, -0.19, 0.0, 0.19, 0.21, 1.0)]
    assert _found(Context(GRASPER, side=Side.CENTER), bodies_of(rows)) == {"-0.19", "0.0", "0.19"}
    # Relative to the whole character's bounds, which reach farther to the left, they all lie on the right.
    wide = bodies_of([*rows, Body("wing", (9, 0, 1))])
    assert _found(Context(GRASPER, side=Side.LEFT), wide) == set()
    assert len(_found(Context(GRASPER, side=Side.LEFT, side_space=Space.SETSPACE), wide)) == 5


def test_bodies_abreast_are_not_told_apart_by_rounding() -> None:
    feet = [Body("left", (0.1, 1e-7, 0), (Capability.FOOT,)), Body("right", (-0.1, 0.0, 1e-7), (Capability.FOOT,))]
    bodies = bodies_of([*feet, Body("head", (0, -0.1, 1.7))])
    for depth in (Depth.FRONT, Depth.CENTER, Depth.BACK):
        assert _found(Context(Capability.FOOT, depth, depth_space=Space.SETSPACE), bodies) == {"left", "right"}


@pytest.mark.parametrize("extent", [e for e in Extent if e is not Extent.NONE])
@few
@given(seed=seeds)
def test_extents_select_none_or_the_farthest_one(extent: Extent, seed: int) -> None:
    bodies = random_bodies(np.random.default_rng(seed), 6)
    axis, way = {"front": (1, -1), "back": (1, 1), "left": (0, 1), "right": (0, -1), "top": (2, 1), "bottom": (2, -1)}[
        extent.value.removesuffix("_most")
    ]
    found, of_kind = select(Context(GRASPER, extent=extent), bodies), bodies.with_capability(GRASPER)
    assert len(found) == min(len(of_kind), 1)
    for body in found:
        out = way * bodies.positions[of_kind, axis]
        assert way * bodies.positions[body, axis] >= out.max() - 2e-3 * bodies.size


def test_extents_look_at_what_the_zones_leave_over() -> None:
    assert _found(Context(GRASPER, side=Side.RIGHT, extent=Extent.BACK_MOST), _four_graspers()) == {"rear right"}


@pytest.mark.parametrize("extent", [e for e in Extent if e is not Extent.NONE])
@few
@given(seed=seeds)
def test_ties_are_broken_the_same_way_whatever_the_order_of_bones(extent: Extent, seed: int) -> None:
    rng = np.random.default_rng(seed)
    bodies = random_bodies(rng, 10)
    # On so coarse a lattice, many are equally far out, and some in one place.
    coarse = np.round(2.0 * bodies.positions / bodies.size) * 0.5 * bodies.size
    bodies = replace(bodies, positions=coarse, low=coarse.min(axis=0), high=coarse.max(axis=0) + 1e-6 * bodies.size)
    context = Context(GRASPER, extent=extent)
    assert _found(context, shuffled(bodies, rng)) == _found(context, bodies)


def test_spine_segments_are_the_first_of_the_spine_above_a_selection() -> None:
    bodies = _four_graspers()
    walk_up = {"modifier": LimbModifier.SPINE_SEGMENT}
    assert _found(Context(GRASPER, side=Side.LEFT, **walk_up), bodies) == {"left clavicle", "chest"}
    assert _found(Context(GRASPER, side=Side.RIGHT, **walk_up), bodies) == {"chest"}
    # What is of the spine stays itself, and each is selected once.
    assert _found(Context(SPINE, **walk_up), bodies) == _found(Context(SPINE), bodies)
    assert len(select(Context(GRASPER, **walk_up), bodies)) == 2


@given(seed=seeds)
def test_nothing_of_the_spine_lies_between_a_body_and_its_spine_segment(seed: int) -> None:
    bodies = random_bodies(np.random.default_rng(seed))
    for body in range(len(bodies)):
        segment = int(bodies.spine_segments[body])
        line = bodies.tree.path(segment, body)
        assert line
        assert bodies.has(segment, SPINE)
        assert not any(bodies.has(b, SPINE) for b in line[1:])


@given(seed=seeds)
def test_selecting_is_pure(seed: int) -> None:
    bodies = random_bodies(np.random.default_rng(seed))
    before = bodies.positions.copy()
    context = Context(GRASPER, Depth.FRONT, Side.LEFT, extent=Extent.TOP_MOST, modifier=LimbModifier.SPINE_SEGMENT)
    assert select(context, bodies) == select(context, bodies)
    assert np.array_equal(bodies.positions, before)


@pytest.mark.parametrize("space", Space)
@few
@given(seed=seeds)
def test_left_of_a_character_is_right_of_its_mirror_image(space: Space, seed: int) -> None:
    bodies = random_bodies(np.random.default_rng(seed))
    swap = {Side.LEFT: Side.RIGHT, Side.RIGHT: Side.LEFT, Side.CENTER: Side.CENTER, Side.ANY: Side.ANY}
    for side, other in swap.items():
        context, swapped = (Context(GRASPER, side=s, side_space=space) for s in (side, other))
        assert _found(context, bodies) == _found(swapped, mirrored(bodies))
    leftmost, rightmost = (Context(GRASPER, extent=e) for e in (Extent.LEFT_MOST, Extent.RIGHT_MOST))
    assert _found(leftmost, bodies) == _found(rightmost, mirrored(bodies))


@given(seed=seeds)
def test_the_two_sides_of_a_symmetric_character_are_mirror_images(seed: int) -> None:
    bodies, partner = symmetric_bodies(np.random.default_rng(seed))
    for capability in Capability:
        left, right = (select(Context(capability, side=side), bodies) for side in (Side.LEFT, Side.RIGHT))
        assert {int(partner[b]) for b in left} == set(right)


@pytest.mark.parametrize("capability", Capability)
def test_every_capability_is_a_type_of_query(capability: Capability) -> None:
    rows = [Body(c.value, (0, 0, i), (c,)) for i, c in enumerate(Capability)]
    both = Body("both", (0, 1, 0), tuple(Capability))
    assert _found(Context(capability), bodies_of([*rows, both])) == {capability.value, "both"}
    assert select(Context(capability), bodies_of([Body("nothing", (0, 0, 0))])) == ()


def test_hands_and_feet_of_real_humanoids_have_sides(data: Path) -> None:
    bodies = real_bodies(data)["mixamo_mpfb"]
    assert _found(Context(GRASPER, side=Side.LEFT), bodies) == {"mixamorig:LeftHand"}
    assert _found(Context(Capability.FOOT, extent=Extent.RIGHT_MOST), bodies) == {"mixamorig:RightFoot"}
    shoulders = _found(Context(GRASPER, modifier=LimbModifier.SPINE_SEGMENT), bodies)
    assert shoulders <= _found(Context(SPINE), bodies)
