"""Binding (Hecker 2008 §3.2.3, §4.1): variants, mirroring, ownership, branches, and what is told when it fails."""

from dataclasses import replace
from itertools import permutations
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.morph.bind import NONE, Binding, GeneralizedAction, bind
from morph_retarget.core.morph.bodies import Bodies
from morph_retarget.core.morph.branch import Answer, Branch, choose, has_upright_spine
from morph_retarget.core.morph.channels import Channel, MirrorRule, SideConstraint, TargetKind
from morph_retarget.core.morph.context import Context, LimbModifier, Side
from morph_retarget.core.morph.movement import Movement
from morph_retarget.core.morph.variants import Group, variant_product
from tests.morph_bodies import Body, bodies_of, names_of, real_bodies, shuffled

GRASPER, MOUTH, SPINE = Capability.GRASPER, Capability.MOUTH, Capability.SPINE
PLACES = {"A": (0.3, 0, 2.0), "B": (-0.3, 0, 2.0), "1": (0.6, 0, 1.0), "2": (-0.6, 0, 1.4), "3": (-0.6, 0, 1.0)}
"""Figure 4: A and B on top, 1 on one side, 2 and 3 on the other."""


def _figure_4(graspers: str = "", mouths: str = "") -> Bodies:
    tags = {name: [*[GRASPER] * (name in graspers), *[MOUTH] * (name in mouths)] for name in PLACES}
    trunk = [
        Body("hips", (0, 0, 0.6), (Capability.ROOT, SPINE)),
        Body("left shoulder", (0.1, 0, 1.2), (SPINE,), "hips"),
        Body("right shoulder", (-0.1, 0, 1.2), (SPINE,), "hips"),
    ]
    sides = {1.0: "left shoulder", -1.0: "right shoulder"}
    rows = [Body(n, p, tuple(tags[n]), sides[1.0 if p[0] > 0 else -1.0]) for n, p in PLACES.items()]
    return bodies_of([*trunk, *rows], low=(-0.7, -0.3, 0.0), high=(0.7, 0.3, 2.1))


def _one(name: str, capability: Capability = GRASPER, **settings: object) -> Channel:
    """Return a channel that plays on one of its bodies at a time."""
    return Channel(name, Context(capability), varies=True, **settings)


def _every(name: str, capability: Capability = GRASPER, **settings: object) -> Channel:
    """Return a channel that plays on all of its bodies."""
    return Channel(name, Context(capability), **settings)


def _bind(bodies: Bodies, *channels: Channel, **options: object) -> Binding:
    return bind(GeneralizedAction("action", channels), bodies, **options)


def _variants(bodies: Bodies, *channels: Channel) -> list[str]:
    return ["".join(names_of(bodies, variant)) for variant in _bind(bodies, *channels).variants]


def _owners(binding: Binding, what: str) -> dict[str, list[str]]:
    """Return for each body the channels that pose it."""
    out: dict[str, list[str]] = {}
    for entry in binding.entries:
        if getattr(entry, what):
            channel = binding.action.channels[entry.channel].name
            out.setdefault(binding.bodies.names[entry.body], []).append(channel)
    return out


# --- the paper's variants, figure 4 ---


def test_five_graspers_give_five_variants_of_one_channel() -> None:
    assert _variants(_figure_4("AB123"), _one("grab")) == ["A", "B", "1", "2", "3"]


def test_two_graspers_hand_over_in_two_ways() -> None:
    assert _variants(_figure_4("AB"), _one("give"), _one("take")) == ["AB", "BA"]


def test_the_second_hands_from_b_to_a_by_mirroring() -> None:
    give, take = _one("give", mirror=MirrorRule.LEFT), _one("take", mirror=MirrorRule.VARIANT)
    for variant, expected in ((0, [("A", False), ("B", False)]), (1, [("B", True), ("A", True)])):
        found = _bind(_figure_4("AB"), give, take, variant=variant)
        assert [(found.bodies.names[e.body], e.mirrored) for e in found.entries] == expected


def test_two_mouths_and_three_graspers_give_six_variants() -> None:
    bodies = _figure_4("123", "AB")
    assert _variants(bodies, _one("hand"), _one("mouth", MOUTH)) == ["1A", "1B", "2A", "2B", "3A", "3B"]


@pytest.mark.parametrize(
    ("side", "expected"),
    [
        (SideConstraint.SAME, ["23", "32"]),
        (SideConstraint.OPPOSITE, ["12", "13", "21", "31"]),
        (SideConstraint.ANY, ["12", "13", "21", "23", "31", "32"]),
    ],
)
def test_sides_constrain_a_handover_among_three_graspers(side: SideConstraint, expected: list[str]) -> None:
    assert _variants(_figure_4("123"), _one("give"), _one("take", side=side)) == expected


def test_a_shoulder_that_varies_with_its_grasper_gives_no_further_variants() -> None:
    bodies = _figure_4("123")
    shoulder = Channel(
        "shoulder", Context(GRASPER, modifier=LimbModifier.SPINE_SEGMENT), varies=True, variant_group="arm"
    )
    hand = _one("hand", variant_group="arm")
    assert _variants(bodies, hand, shoulder) == ["1", "2", "3"]
    for variant, pair in enumerate((("1", "left shoulder"), ("2", "right shoulder"), ("3", "right shoulder"))):
        found = _bind(bodies, hand, shoulder, variant=variant)
        assert [names_of(bodies, own) for own in found.selected] == [[pair[0]], [pair[1]]]


def test_channels_that_vary_together_over_other_bodies_take_those_in_the_same_place() -> None:
    bodies, hand = _figure_4("12", "AB"), _one("hand", variant_group="arm")
    for variant, pair in enumerate((["1", "A"], ["2", "B"])):
        found = _bind(bodies, hand, _one("mouth", MOUTH, variant_group="arm"), variant=variant)
        assert [names_of(bodies, own) for own in found.selected] == [[pair[0]], [pair[1]]]


def test_there_is_no_limit_of_arity() -> None:
    bodies = _figure_4("AB123")
    three = _variants(bodies, *(_one(n) for n in "xyz"))
    assert three == ["".join(p) for p in permutations("AB123", 3)]
    assert len(_variants(bodies, *(_one(n) for n in "vwxyz"))) == 120


@given(st.lists(st.lists(st.integers(0, 7), unique=True, max_size=5), min_size=1, max_size=4))
def test_the_variant_product_uses_no_body_twice_and_leaves_nothing_out(groups: list[list[int]]) -> None:
    found = variant_product([Group(tuple(bodies)) for bodies in groups], [0] * 8)
    assert len(set(found)) == len(found)
    for variant in found:
        assert len(set(variant)) == len(groups)
        assert all(body in own for body, own in zip(variant, groups, strict=True))
    expected = 0
    for choice in permutations(range(8), len(groups)):
        expected += all(body in own for body, own in zip(choice, groups, strict=True))
    assert len(found) == expected


def test_bodies_in_the_middle_are_on_one_side_with_each_other_and_opposite_none() -> None:
    groups = [Group((0, 1, 2)), Group((0, 1, 2), SideConstraint.SAME)]
    assert variant_product(groups, [0, 0, 1]) == [(0, 1), (1, 0)]
    assert variant_product([groups[0], Group((0, 1, 2), SideConstraint.OPPOSITE)], [0, 0, 1]) == []


def test_variants_are_counted_round() -> None:
    bodies = _figure_4("AB")
    assert _bind(bodies, _one("grab"), variant=3).selected == _bind(bodies, _one("grab"), variant=1).selected


@pytest.mark.parametrize("order", [("hand", "shoulder"), ("shoulder", "hand")])
def test_a_varying_channel_never_plays_on_more_than_one_body(order: tuple[str, str]) -> None:
    channels = {
        "hand": _one("hand", variant_group="arm"),
        "shoulder": Channel("shoulder", Context(SPINE), varies=True, variant_group="arm"),
    }
    for graspers in ("", "1", "23", "AB123"):
        for side in SideConstraint:
            own = [*(channels[name] for name in order), _one("other", side=side)]
            found = _bind(_figure_4(graspers), *own)
            assert all(len(selected) <= 1 for selected in found.selected), (graspers, side)


def test_sides_that_no_bodies_fit_are_told_and_nothing_else_is_said() -> None:
    give, take = _one("give"), _one("take", side=SideConstraint.SAME)
    found = _bind(_figure_4("12"), give, take, _every("hips", SPINE))
    assert found.problems == (
        "channels 'give', 'take' find no bodies that fit together: loosen their side constraints",
    )
    assert found.selected[:2] == ((), ())
    assert {entry.channel for entry in found.entries} == {2}


# --- mirroring ---


@pytest.mark.parametrize(
    ("rule", "mirrored"),
    [
        (MirrorRule.NEVER, set()),
        (MirrorRule.LEFT, {"B", "2", "3"}),
        (MirrorRule.RIGHT, {"A", "1"}),
        (MirrorRule.VARIANT, set()),
    ],
)
def test_rules_say_which_bodies_are_mirrored(rule: MirrorRule, mirrored: set[str]) -> None:
    found = _bind(_figure_4("AB123"), _every("wave", mirror=rule))
    assert {found.bodies.names[e.body] for e in found.entries if e.mirrored} == mirrored


@pytest.mark.parametrize(("rule", "turned"), [(MirrorRule.LEFT, "23B"), (MirrorRule.RIGHT, "1A")])
def test_a_whole_action_is_mirrored_with_its_variant(rule: MirrorRule, turned: str) -> None:
    bodies = _figure_4("AB123")
    for variant, name in enumerate("AB123"):
        found = _bind(
            bodies, _one("grab", mirror=rule), _every("lean", SPINE, mirror=MirrorRule.VARIANT), variant=variant
        )
        assert {e.mirrored for e in found.entries} == {name in turned}


def test_a_body_in_the_middle_is_not_mirrored() -> None:
    for rule in MirrorRule:
        assert not any(e.mirrored for e in _bind(_figure_4(), _every("x", Capability.ROOT, mirror=rule)).entries)


# --- ownership ---


def test_the_first_channel_to_select_a_body_owns_it() -> None:
    first, second = _every("first"), _every("second")
    found = _bind(_figure_4("12"), first, second)
    assert _owners(found, "position") == {"1": ["first"], "2": ["first"]}
    assert len(found.problems) == 1
    assert "channel 'second' loses the position of '1' to 'first'" in found.problems[0]
    assert found.problems[0].endswith("give both the same blend group to share")


def test_channels_of_one_blend_group_share_a_body() -> None:
    channels = [_every("a", blend_group="arms"), _every("b"), _every("c", blend_group="arms")]
    found = _bind(_figure_4("1"), *channels)
    assert _owners(found, "position") == _owners(found, "rotation") == {"1": ["a", "c"]}


def test_channels_without_a_blend_group_do_not_share() -> None:
    found = _bind(_figure_4("1"), _every("a", blend_group=""), _every("b", blend_group=""))
    assert _owners(found, "position") == {"1": ["a"]}


def test_each_degree_of_freedom_is_owned_for_itself() -> None:
    turn = _every("turn", poses_position=False)
    found = _bind(_figure_4("1"), turn, _every("both"))
    assert _owners(found, "rotation") == {"1": ["turn"]}
    assert _owners(found, "position") == {"1": ["both"]}
    assert "loses the rotation of '1' to 'turn'" in found.problems[0]
    # With what it does not want, nobody is in the way.
    assert not _bind(_figure_4("1"), turn, _every("place", poses_rotation=False)).problems


def test_channels_of_higher_priority_select_first() -> None:
    low, high = _every("low"), _every("high", priority=2)
    assert _owners(_bind(_figure_4("1"), low, high), "position") == {"1": ["high"]}
    assert _owners(_bind(_figure_4("1"), low, replace(high, priority=0)), "position") == {"1": ["low"]}


def test_only_the_bodies_that_overlap_are_lost() -> None:
    left = Channel("left", Context(GRASPER, side=Side.LEFT))
    found = _bind(_figure_4("12"), left, _every("all"))
    assert _owners(found, "position") == {"1": ["left"], "2": ["all"]}


def test_variants_decide_who_meets_whom() -> None:
    """A varying channel that owns the first grasper leaves the second to the other channel."""
    found = _bind(_figure_4("12"), _one("grab"), _every("idle"), variant=1)
    assert _owners(found, "position") == {"2": ["grab"], "1": ["idle"]}


# --- targets ---


def _to(kind: TargetKind, secondary: Context | None = None, **settings: object) -> Channel:
    movement = Movement(secondary_relative=True)
    return _every("reach", movement=movement, target=kind, secondary=secondary, **settings)


def test_each_body_takes_the_nearest_body_of_its_secondary_context() -> None:
    found = _bind(_figure_4("123", "AB"), _to(TargetKind.CONTEXT, Context(MOUTH)))
    names = found.bodies.names
    assert {names[e.body]: names[e.target] for e in found.entries} == {"1": "A", "2": "B", "3": "B"}


@given(st.integers(0, 100))
def test_of_targets_equally_near_the_same_is_taken_whatever_the_order_of_bones(seed: int) -> None:
    bodies = shuffled(_figure_4("1", "23"), np.random.default_rng(seed))
    found = _bind(bodies, replace(_to(TargetKind.CONTEXT, Context(MOUTH)), context=Context(SPINE)))
    targets = {bodies.names[e.body]: bodies.names[e.target] for e in found.entries}
    # Two and three lie as far above one shoulder as below it.
    assert targets["left shoulder"] == targets["right shoulder"] == "2"


def test_no_body_is_its_own_target() -> None:
    found = _bind(_figure_4("12"), _to(TargetKind.CONTEXT, Context(GRASPER)))
    names = found.bodies.names
    assert {names[e.body]: names[e.target] for e in found.entries} == {"1": "2", "2": "1"}


def test_a_target_that_varies_is_the_body_of_the_variant() -> None:
    """The fruit is put into the mouth that the variant names, not into the nearest one."""
    bodies = _figure_4("123", "AB")
    hand = replace(_to(TargetKind.CONTEXT, Context(MOUTH)), varies=True)
    for variant in range(6):
        found = _bind(bodies, hand, _one("mouth", MOUTH), variant=variant)
        reach = next(e for e in found.entries if e.channel == 0)
        assert (reach.body, reach.target) == found.variants[variant]


def test_external_targets_are_no_bodies() -> None:
    found = _bind(_figure_4("12"), _to(TargetKind.EXTERNAL))
    assert [e.target for e in found.entries] == [NONE, NONE]
    assert not found.problems


# --- problems ---


@pytest.mark.parametrize(
    ("channel", "options", "problem"),
    [
        (
            _every("claw", Capability.FIN),
            {},
            "channel 'claw' selects nothing on this character: change the context if that is wrong",
        ),
        (
            _to(TargetKind.NONE),
            {},
            "channel 'reach' moves relative to a target and has none: choose its kind",
        ),
        (
            _to(TargetKind.EXTERNAL),
            {"missing": {0}},
            "channel 'reach' has no target on this character: choose one",
        ),
        (_to(TargetKind.CONTEXT, Context(MOUTH)), {}, "channel 'reach' finds no target for '1'"),
        (_to(TargetKind.CONTEXT, None), {}, "channel 'reach' finds no target for '1'"),
    ],
)
def test_what_cannot_play_is_told_and_the_rest_plays(
    channel: Channel, options: dict[str, object], problem: str
) -> None:
    found = _bind(_figure_4("1"), channel, _every("hips", Capability.ROOT), **options)
    assert found.problems == (problem,)
    assert [(e.channel, found.bodies.names[e.body]) for e in found.entries] == [(1, "hips")]


def test_a_channel_that_cannot_play_owns_nothing() -> None:
    found = _bind(_figure_4("1"), _to(TargetKind.EXTERNAL), _every("idle"), missing={0})
    assert _owners(found, "position") == {"1": ["idle"]}


def test_a_channel_that_varies_over_nothing_leaves_the_others_their_variants() -> None:
    found = _bind(_figure_4("12"), _one("mouth", MOUTH), _one("grab"))
    assert found.variants == ((found.bodies.names.index("1"),), (found.bodies.names.index("2"),))
    assert [e.channel for e in found.entries] == [1]


def test_binding_is_pure() -> None:
    bodies, channels = _figure_4("AB123"), [_one("give"), _one("take"), _every("turn", SPINE)]
    assert _bind(bodies, *channels, variant=4).entries == _bind(bodies, *channels, variant=4).entries


# --- branches ---

_FACTS = {
    "upright_spine": "an upright spine",
    "has_graspers": "graspers",
    "has_feet": "feet",
    "has_mouth": "a mouth",
    "has_tail": "a tail",
    "has_wings": "wings",
}


def _all_of_it() -> Bodies:
    """Return an upright character that has everything which predicates ask for."""
    tags = (GRASPER, Capability.FOOT, MOUTH, Capability.TAIL, Capability.WING)
    hips = Body("hips", (0, 0, 1), (Capability.ROOT, SPINE))
    return bodies_of([hips, Body("chest", (0, 0.1, 2), (SPINE,), "hips"), Body("all", (0, 0, 0), tags, "hips")])


@pytest.mark.parametrize("predicate", _FACTS)
def test_predicates_have_three_values(predicate: str) -> None:
    whole, bare = _all_of_it(), bodies_of([Body("root", (0, 0, 0), (Capability.ROOT, SPINE)), Body("x", (0, 1, 0))])
    must, must_not, either = (Branch(**{predicate: answer}) for answer in (Answer.TRUE, Answer.FALSE, Answer.IGNORE))
    assert (must.refusals(whole), must.refusals(bare)) == ((), (f"it lacks {_FACTS[predicate]}",))
    assert (must_not.refusals(whole), must_not.refusals(bare)) == ((f"it has {_FACTS[predicate]}",), ())
    assert (either.refusals(whole), either.refusals(bare)) == ((), ())


def test_legs_can_be_counted() -> None:
    assert Branch(leg_count=1).refusals(_all_of_it()) == ()
    assert len(Branch(leg_count=4).refusals(_all_of_it())) == 1


def test_an_action_for_other_characters_does_not_bind_and_says_why() -> None:
    action = GeneralizedAction("grab", (_one("grab"),), Branch(has_graspers=Answer.TRUE, has_tail=Answer.TRUE))
    found = bind(action, _figure_4())
    assert found.entries == ()
    assert found.variants == ()
    assert found.selected == ((),)
    assert found.problems == (
        "the action is not for this character: it lacks graspers",
        "the action is not for this character: it lacks a tail",
    )


def test_the_first_branch_that_fits_is_chosen() -> None:
    with_hands, with_mouth = Branch(has_graspers=Answer.TRUE), Branch(has_graspers=Answer.FALSE, has_mouth=Answer.TRUE)
    branches = (with_hands, with_mouth)
    assert choose(branches, _figure_4("1", "A")) == 0
    assert choose(branches, _figure_4("", "A")) == 1
    assert choose(branches, _figure_4()) is None
    assert choose((*branches, Branch()), _figure_4()) == 2


def test_spines_of_real_humanoids_are_upright_and_those_of_quadrupeds_and_snakes_are_not(data: Path) -> None:
    upright = {name: has_upright_spine(bodies) for name, bodies in real_bodies(data).items()}
    humanoid = ["mixamo_mpfb", "rigify_metarig_human", "unreal_ue5_manny", "vroid_studio", "smplx", "cesium_man"]
    assert all(upright[name] for name in humanoid)
    prone = ["khronos_fox", "m2m_fox", "quaternius_wolf", "rigify_basic_quadruped", "rigify_cat", "m2m_snake"]
    assert not any(upright[name] for name in prone)


def test_every_real_humanoid_has_graspers_two_feet_and_an_upright_spine(data: Path) -> None:
    branch = Branch(Answer.TRUE, Answer.TRUE, Answer.TRUE, leg_count=2)
    humanoids = [n for n, bodies in real_bodies(data).items() if not branch.refusals(bodies)]
    assert len(humanoids) >= 30
    assert "m2m_snake" not in humanoids
