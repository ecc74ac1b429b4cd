"""Specializing and blending (Hecker 2008 §3.2.3): channels that share bodies, weights and deforms."""

from collections.abc import Mapping

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from morph_retarget.core import play, quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.morph import specialize
from morph_retarget.core.morph.bind import Binding, GeneralizedAction, bind
from morph_retarget.core.morph.bodies import Bodies
from morph_retarget.core.morph.channels import Channel, TargetKind, Values
from morph_retarget.core.morph.context import Context, Side
from morph_retarget.core.morph.movement import Movement, PositionMode, RotationMode
from morph_retarget.core.solve.goals import Goals
from tests.morph_bodies import Body, bodies_of
from tests.skeletons import skeleton_of
from tools.figure import Build, humanoid

GRASPER, MOUTH = Capability.GRASPER, Capability.MOUTH
ABSOLUTE = Movement(PositionMode.ABSOLUTE, RotationMode.ABSOLUTE)
REACH = Movement(secondary_relative=True)


def _body() -> Bodies:
    return bodies_of(
        [
            Body("hips", (0, 0, 1), (Capability.ROOT, Capability.SPINE)),
            Body("hand", (0.5, -0.2, 1.2), (GRASPER,), "hips"),
            Body("mouth", (0, -0.1, 1.6), (MOUTH,), "hips"),
        ],
        low=(-0.5, -0.2, 0),
    )


def _hand(name: str, movement: Movement = ABSOLUTE, **settings: object) -> Channel:
    return Channel(name, Context(GRASPER), movement, blend_group="hand", **settings)


def _bound(*channels: Channel) -> Binding:
    found = bind(GeneralizedAction("action", channels), _body())
    assert not found.problems
    return found


def _values(
    frames: int, channels: int, places: Array | float = 0.0, weights: Array | float = 1.0, turns: Array | None = None
) -> Values:
    """Return values; arrays broadcast to shape (frame, channel, …)."""
    return Values(
        np.broadcast_to(places, (frames, channels, 3)).copy(),
        np.broadcast_to(quat.IDENTITY if turns is None else turns, (frames, channels, 4)).copy(),
        np.broadcast_to(weights, (frames, channels)).copy(),
    )


def _goals(binding: Binding, values: Values, external: Mapping[int, Array] | None = None) -> Goals:
    return specialize.goals_of(binding, values, specialize.frames_of(binding, external or {}))


def test_crossing_weights_lead_continuously_from_one_channel_to_the_other() -> None:
    binding = _bound(_hand("a"), _hand("b"))
    t = np.linspace(0.0, 1.0, 101)
    a, b = np.array([0.1, 0.2, 0.3]), np.array([-0.4, 0.5, 1.6])
    turn = quat.from_rotation_vector(np.array([0.0, 1.0, 0.5]))
    values = _values(101, 2, np.stack([a, b]), np.stack([1.0 - t, t], axis=-1), np.stack([quat.IDENTITY, turn]))
    goals = _goals(binding, values)
    assert goals.bodies.tolist() == [1]
    assert np.allclose(goals.positions[:, 0], a + t[:, None] * (b - a))
    # The weighted mean of quaternions stays on the arc and hurries a little in its middle.
    angles, whole = quat.angle_between(quat.IDENTITY, goals.turns[:, 0]), float(quat.angle_between(quat.IDENTITY, turn))
    assert np.allclose(angles + quat.angle_between(goals.turns[:, 0], turn), whole)
    assert (np.diff(angles) > 0.0).all()
    assert np.abs(angles - t * whole).max() < 0.02 * whole
    assert np.allclose(goals.position_influence, 1.0)
    assert np.allclose(goals.rotation_influence, 1.0)


def test_equal_weights_average() -> None:
    places = np.random.default_rng(1).normal(size=(3, 3))
    for weight in (1.0, 0.4, 1 / 3):
        goals = _goals(_bound(*(_hand(n) for n in "abc")), _values(2, 3, places, weight))
        assert np.allclose(goals.positions[:, 0], places.mean(axis=0))
        assert np.allclose(goals.position_influence, 1.0)


@given(st.lists(st.floats(0.0, 1.0), min_size=3, max_size=3))
def test_the_mean_is_weighted_and_influence_is_the_sum_of_weights_up_to_1(weights: list[float]) -> None:
    places = np.random.default_rng(2).normal(size=(3, 3))
    goals = _goals(_bound(*(_hand(n) for n in "abc")), _values(1, 3, places, np.array(weights)))
    assert goals.position_influence[0, 0] == pytest.approx(min(sum(weights), 1.0))
    if sum(weights) > 1e-3:
        assert np.allclose(goals.positions[0, 0], np.array(weights) @ places / sum(weights), atol=1e-9)


def test_weight_0_leaves_a_body_alone() -> None:
    goals = _goals(_bound(_hand("a"), _hand("b")), _values(1, 2, 5.0, 0.0))
    assert goals.position_influence.max() == 0.0
    assert goals.rotation_influence.max() == 0.0
    assert _goals(_bound(_hand("a")), _values(1, 1, 5.0, -1.0)).position_influence.max() == 0.0


def test_weight_0_takes_no_part_in_a_blend() -> None:
    places = np.array([[9.0, 9.0, 9.0], [0.1, 0.2, 0.3]])
    for order in (places, places[::-1]):
        weights = np.where(order[:, 0] > 1.0, 0.0, 0.5)
        goals = _goals(_bound(_hand("a"), _hand("b")), _values(1, 2, order, weights))
        assert np.allclose(goals.positions[0, 0], places[1])
        assert goals.position_influence[0, 0] == pytest.approx(0.5)


def test_channels_weigh_position_and_rotation_apart() -> None:
    binding = _bound(_hand("a", position_weight=0.25), _hand("b", position_weight=0.75, rotation_weight=0.0))
    places, turn = np.array([[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]]), quat.from_rotation_vector(np.array([1.0, 0.0, 0.0]))
    goals = _goals(binding, _values(1, 2, places, 1.0, np.stack([quat.IDENTITY, turn])))
    assert np.allclose(goals.positions[0, 0], 0.75)
    assert quat.angle_between(goals.turns[0, 0], quat.IDENTITY) < 1e-9


def test_a_body_without_a_place_of_its_own_has_none() -> None:
    goals = _goals(_bound(_hand("turn", poses_position=False)), _values(1, 1, 5.0))
    assert goals.position_influence.max() == 0.0
    assert goals.rotation_influence.min() == 1.0


def test_rotations_are_turns_from_rest_whatever_the_bodys_own_axes() -> None:
    """Identity is rest in rest-relative mode; in absolute mode it turns the body's own axes to the character's."""
    bones = humanoid(build=Build(fingers=2))
    bodies = Bodies.of(analyze(skeleton_of(bones, np.random.default_rng(3))))
    for movement, expected in ((Movement(), np.zeros(3)), (ABSOLUTE, None)):
        binding = bind(GeneralizedAction("a", (Channel("hands", Context(GRASPER), movement),)), bodies)
        goals = _goals(binding, _values(1, 1))
        turned = quat.multiply(goals.turns[0], bodies.axes[goals.bodies])
        target = quat.identity(2) if expected is None else bodies.axes[goals.bodies]
        assert quat.angle_between(turned, target).max() < 1e-9


def test_deforms_are_blended_by_weight() -> None:
    binding = _bound(_hand("a"), _hand("b"))
    values = _values(3, 2, 0.0, np.array([[1.0, 0.0], [0.5, 0.5], [0.25, 0.25]]))
    curves = {(0, "open"): np.array([1.0, 1.0, 1.0]), (1, "open"): np.array([0.0, 0.5, 1.0]), (1, "fist"): np.ones(3)}
    found = specialize.deforms_of(binding, Values(values.positions, values.rotations, values.weights, curves))
    assert set(found) == {(1, "open"), (1, "fist")}
    # Weights that add up to less than 1 leave the rest to the rest shape.
    assert np.allclose(found[1, "open"], [1.0, 0.75, 0.5])
    assert np.allclose(found[1, "fist"], [0.0, 0.5, 0.25])


def test_every_body_of_a_channel_deforms() -> None:
    bodies = Bodies.of(analyze(skeleton_of(humanoid(build=Build(fingers=2)))))
    binding = bind(GeneralizedAction("a", (Channel("hands", Context(GRASPER)),)), bodies)
    values = _values(2, 1)
    found = specialize.deforms_of(
        binding, Values(values.positions, values.rotations, values.weights, {(0, "fist"): np.array([0.0, 1.0])})
    )
    assert sorted(bodies.names[body] for body, _ in found) == ["leftHand", "rightHand"]
    assert all(np.allclose(curve, [0.0, 1.0]) for curve in found.values())


def test_a_hand_takes_a_fruit_and_puts_it_into_the_mouth_in_one_movement() -> None:
    """Channels relative to an external target and to a body of its own, blended over time."""
    character = analyze(skeleton_of(humanoid(build=Build(fingers=2, arms_down=60.0)), np.random.default_rng(4)))
    left = Context(GRASPER, side=Side.LEFT)
    grab = Channel("grab", left, REACH, TargetKind.EXTERNAL, poses_rotation=False, blend_group="hand")
    eat = Channel("eat", left, REACH, TargetKind.CONTEXT, Context(MOUTH), poses_rotation=False, blend_group="hand")
    nod = Channel("nod", Context(Capability.HEAD), poses_position=False)
    bodies = Bodies.of(character)
    binding = bind(GeneralizedAction("eat", (grab, eat, nod)), bodies)
    assert not binding.problems
    part = play.prepare(character, binding)
    frames = 241
    t = np.linspace(0.0, 2.0, frames)
    weights = np.stack([np.clip(2.0 - t, 0, 1), np.clip(t - 1.0, 0, 1), np.ones(frames)], axis=-1)
    places, turns = np.zeros((frames, 3, 3)), quat.identity(frames, 3)
    places[:, 0, 0], places[:, 1, 0] = np.clip(t, 0, 1), 1.0
    turns[:, 2] = quat.from_rotation_vector(np.outer(0.3 * np.sin(2.0 * t), [1.0, 0.0, 0.0]))
    fruit = np.array([0.4, -0.35, 1.3]) + 0.05 * np.sin(t)[:, None]
    played = play.evaluate(part, Values(places, turns, weights), {0: fruit})
    hand, mouth = character.bone("leftHand"), bodies.with_capability(MOUTH)[0]
    way = played.pose.positions[:, hand]
    assert np.abs(way[0] - bodies.positions[hand]).max() < 1e-6
    half = frames // 2
    assert np.abs(way[half] - fruit[half]).max() < 2e-3
    assert np.abs(way[-1] - played.pose.positions[-1, mouth]).max() < 2e-3
    # The path has no corners that the weights do not make, and no jump.
    assert np.linalg.norm(np.diff(way, axis=0), axis=-1).max() < 0.02
    goal = played.goals.positions[:, played.goals.bodies.tolist().index(hand)]
    assert np.linalg.norm(np.diff(goal, axis=0), axis=-1).max() < 0.02
