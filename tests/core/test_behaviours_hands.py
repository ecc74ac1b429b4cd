"""Hands that reach, touch, point and grasp: where they come to once the solver has brought them there."""

import numpy as np
import pytest

from morph_retarget.core import quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.clips.behaviours import fingers
from morph_retarget.core.clips.behaviours.handling import REACHING
from morph_retarget.core.clips.behaviours.hands import Hand, hands_of, mouth_of
from morph_retarget.core.clips.track import Track
from tests.behaving import RATE, Shown, Subject, creature, figure, reset, start, stop
from tools.figure import Build

HANDED = {
    "figure": figure(),
    "hanging arms": figure(Build(fingers=5, arms_down=75.0)),
    "twist bones": figure(Build(fingers=4, twists=2, arms_down=40.0)),
    "no fingers": figure(Build(fingers=0, arms_down=40.0)),
    "biped": creature("biped"),
}
each = pytest.mark.parametrize("subject", HANDED.values(), ids=HANDED)
MET = 1e-3
"""Targets in reach are met to this share of the character's height: less than 2 mm on a human."""
ON_LINE = 2.0
"""A finger points past its target by this at most [deg]."""
ON_SURFACE = 0.02
"""Tips of fingers lie on what they grasp to this share of the hand."""
SIDES = {1: "left", -1: "right"}


def _target(subject: Subject, hand: Hand, rng: np.random.Generator) -> Array:
    """Return a place in front of a body in reach of an arm."""
    arm = subject.arm(hand)
    way = quat.unit(np.array([hand.side * rng.uniform(-0.2, 0.6), -1.0, rng.uniform(-0.8, 0.4)]))
    return arm.shoulder(subject.standing(1))[0] + rng.uniform(0.5, 0.85) * arm.length * way


def _palm(hand: Hand) -> Array:
    """Return the place of a hand's skin in the middle of its palm, from its joint at rest."""
    return hand.middle + hand.thickness * hand.palm


def _bone(shown: Shown, hand: Hand) -> tuple[Array, Array]:
    """Return where the pointing finger starts and where its last bone points, shapes (n, 3)."""
    finger = hand.pointer
    assert finger is not None
    last = quat.unit(finger.points[-1] - finger.points[-2])
    return shown.posture.positions[:, finger.bones[0]], shown.posture.seen(finger.bones[-1], last)


@each
def test_a_palm_comes_to_what_is_in_reach_at_its_stroke(subject: Subject) -> None:
    rng = np.random.default_rng(1)
    for hand in subject.hands:
        for _ in range(2):
            target = _target(subject, hand, rng)
            shown = subject.act([start(0.3, "reach", target="it", side=SIDES[hand.side], stroke=1.2)], {"it": target})
            off = quat.length(shown.point(hand, _palm(hand)) - target) / subject.actor.height
            assert off[shown.frame(1.5) :].max() < MET
            assert off[shown.frame(1.0)] > MET


@each
def test_a_finger_touches_what_is_in_reach(subject: Subject) -> None:
    rng = np.random.default_rng(2)
    for hand in subject.hands:
        target = _target(subject, hand, rng)
        shown = subject.act([start(0.0, "touch", target="it", side=SIDES[hand.side], stroke=1.0)], {"it": target})
        finger = hand.pointer
        if finger is None:
            tip = shown.point(hand, hand.middle / 0.6)
        else:
            bone = finger.bones[-1]
            tip = shown.posture.point(bone, finger.points[-1] - finger.points[-2])
        assert quat.length(tip - target)[-1] / subject.actor.height < MET


@each
def test_a_finger_points_at_its_target(subject: Subject) -> None:
    rng = np.random.default_rng(3)
    for hand in subject.hands:
        if hand.pointer is None:
            continue
        for far in (1.0, 4.0, 50.0):
            target = subject.arm(hand).shoulder(subject.standing(1))[0] + far * subject.actor.height * quat.unit(
                np.array([hand.side * rng.uniform(-0.2, 1.0), -1.0, rng.uniform(-0.6, 0.6)])
            )
            shown = subject.act([start(0.0, "point", target="it", side=SIDES[hand.side])], {"it": target})
            base, along = _bone(shown, hand)
            away = target - base[-1]
            off = np.degrees(np.arctan2(np.linalg.norm(np.cross(along[-1], away)), along[-1] @ away))
            assert off < ON_LINE


@each
def test_the_arm_that_points_is_straight_and_the_other_fingers_are_bent(subject: Subject) -> None:
    hand = subject.hands[0]
    arm = subject.arm(hand)
    target = np.array([0.3 * hand.side, -20.0, 1.0])
    shown = subject.act([start(0.0, "point", target="it", side=SIDES[hand.side])], {"it": target})
    stretched = quat.length(shown.posture.positions[-1, hand.body] - shown.posture.positions[-1, arm.joints[0]])
    assert stretched > 0.94 * arm.length
    for finger in hand.fingers:
        ahead = shown.posture.seen(finger.bones[-1], finger.along)[-1] @ shown.posture.seen(hand.body, hand.along)[-1]
        is_pointer = hand.pointer is not None and finger.bones == hand.pointer.bones
        assert is_pointer or finger.is_thumb or ahead < 0.3


@each
@pytest.mark.parametrize("size", [0.02, 0.035])
def test_fingers_close_on_a_ball(subject: Subject, size: float) -> None:
    rng = np.random.default_rng(4)
    radius = size * subject.actor.height
    for hand in subject.hands:
        target = _target(subject, hand, rng)
        command = start(0.0, "grasp", target="it", side=SIDES[hand.side], stroke=1.0, radius=radius)
        shown = subject.act([command], {"it": target})
        middle = _palm(hand) + radius * hand.palm
        assert quat.length(shown.point(hand, middle) - target)[-1] / subject.actor.height < MET
        grip = fingers.closed(hand, fingers.sphere(middle, radius))
        assert not hand.fingers or sum(grip.meets) >= min(len(hand.fingers), 3) - 1
        for finger, meets in zip(hand.fingers, grip.meets, strict=True):
            tip = shown.posture.point(finger.bones[-1], finger.points[-1] - finger.points[-2])[-1]
            off = abs(np.linalg.norm(tip - target) - radius)
            assert not meets or off < ON_SURFACE * hand.length


def test_fingers_close_on_a_surface_of_points() -> None:
    subject = HANDED["figure"]
    hand, radius = subject.hands[0], 0.04
    ways = quat.unit(np.random.default_rng(5).normal(size=(4000, 3)))
    target = _target(subject, hand, np.random.default_rng(6))
    ball = Track(np.zeros(1), target[None], radius * ways)
    shown = subject.act([start(0.0, "grasp", target="it", side=SIDES[hand.side], stroke=1.0)], {"it": ball})
    tips = [
        shown.posture.point(finger.bones[-1], finger.points[-1] - finger.points[-2])[-1]
        for finger in hand.fingers
        if not finger.is_thumb
    ]
    off = np.abs(quat.length(np.array(tips) - target) - radius)
    assert off.max() < ON_SURFACE * hand.length


def test_hands_are_open_until_they_are_there_and_hold_until_they_are_told() -> None:
    subject = HANDED["figure"]
    hand = subject.hands[0]
    target = _target(subject, hand, np.random.default_rng(7))
    commands = [start(0.5, "grasp", target="it", side="left", stroke=1.0), stop(3.0, "grasp")]
    shown = subject.act(commands, {"it": target}, 5.0)
    finger = hand.fingers[1].bones[-1]
    bent = quat.angle_between(
        quat.multiply(quat.conjugate(shown.posture.turns[:, hand.body]), shown.posture.turns[:, finger]), quat.IDENTITY
    )
    assert bent[shown.frame(1.0)] < 0.01
    assert bent[shown.frame(2.0)] > 0.5
    assert np.ptp(bent[shown.frame(2.0) : shown.frame(2.9)]) < 1e-9
    assert bent[-1] < 1e-6
    (held,) = shown.acted.held
    assert (held.target, held.body, held.end) == ("it", hand.body, 3.0)
    assert abs(held.start - 1.5) < 1e-9


def test_what_is_held_goes_along_with_the_hand_and_stays_where_it_is_let_go() -> None:
    subject = HANDED["figure"]
    hand = subject.hands[0]
    rng = np.random.default_rng(12)
    targets = {"it": _target(subject, hand, rng), "there": _target(subject, hand, rng)}
    commands = [start(0.2, "grasp", target="it", side="left", stroke=1.0, radius=0.03)]
    commands += [start(2.0, "reach", target="there", side="left", stroke=1.0)]
    shown = subject.act(commands, targets, 4.0)
    (held,) = shown.acted.held
    own = (shown.posture.positions[:, hand.body], shown.posture.turns[:, hand.body])
    places, turns = held.carried(Track.at_place(targets["it"]), shown.scene.times, *own)
    assert np.abs(places[: shown.frame(1.2)] - targets["it"]).max() < 1e-9
    away = quat.rotate(quat.conjugate(own[1]), places - own[0])
    kept = slice(shown.frame(1.2), shown.frame(2.0))
    assert np.ptp(away[kept], axis=0).max() < 1e-9
    assert np.abs(np.diff(places[shown.frame(2.1) :], axis=0)).max() < 1e-9
    assert np.isfinite(turns).all()


@each
def test_without_a_command_hands_do_what_the_motion_does(subject: Subject) -> None:
    commands = [start(1.0, "reach", target="it"), stop(2.0, "reach")]
    shown = subject.act(commands, {"it": np.array([0.3, -0.4, 1.0])}, 5.0)
    alone = subject.act([], seconds=5.0)
    for frames in (slice(0, 30), slice(shown.frame(4.5), None)):
        assert np.abs(shown.posture.positions[frames] - alone.posture.positions[frames]).max() < 1e-9


def test_a_hand_moves_with_the_smallest_jerk() -> None:
    """Its speed rises and falls like a bell, and it stands still before and after."""
    subject = HANDED["figure"]
    hand = subject.hands[0]
    target = _target(subject, hand, np.random.default_rng(8))
    shown = subject.act([start(0.5, "reach", target="it", side="left", stroke=1.0)], {"it": target}, 2.5)
    speed = quat.length(np.diff(shown.posture.positions[:, hand.body], axis=0)) * RATE
    assert speed[: shown.frame(0.5)].max() < 1e-9
    assert speed[shown.frame(1.5) + 1 :].max() < 1e-6
    top = int(np.argmax(speed))
    assert shown.frame(0.8) <= top <= shown.frame(1.2)
    rising, falling = np.diff(speed[: top + 1]), np.diff(speed[top:])
    assert rising.min() > -0.05 * speed.max()
    assert falling.max() < 0.05 * speed.max()


def test_a_hand_goes_over_to_another_target_without_a_jump() -> None:
    subject = HANDED["biped"]
    rng, hand = np.random.default_rng(9), subject.hands[0]
    targets = {name: _target(subject, hand, rng) for name in "ab"}
    commands = [
        start(0.2, "reach", target="a", side="left"),
        start(0.6, "reach", target="b"),
        start(1.8, "point", target="a", side="left"),
        stop(2.6, "point"),
    ]
    shown = subject.act(commands, targets, 4.0)
    places = shown.posture.positions
    assert quat.length(np.diff(places, axis=0)).max() * RATE < 4.0 * subject.actor.height
    off = quat.length(shown.point(hand, _palm(hand)) - targets["b"])
    assert off[shown.frame(1.75)] < MET * subject.actor.height


def test_the_nearer_hand_takes_it_unless_a_side_is_told() -> None:
    subject = HANDED["figure"]
    for hand in subject.hands:
        target = _target(subject, hand, np.random.default_rng(10)) + np.array([0.2 * hand.side, 0.0, 0.0])
        shown = subject.act([start(0.0, "touch", target="it")], {"it": target})
        assert shown.acted.bodies.tolist() == [hand.body]


def test_a_body_leans_for_what_its_arm_is_too_short_for() -> None:
    subject = HANDED["figure"]
    hand = subject.hands[0]
    arm = subject.arm(hand)
    target = arm.shoulder(subject.standing(1))[0] + np.array([0.1, -1.25 * arm.length, -0.2])
    off = {}
    for lean in (True, False):
        shown = subject.act([start(0.0, "reach", target="it", side="left", lean=lean)], {"it": target}, 4.0)
        off[lean] = quat.length(shown.point(hand, _palm(hand)) - target)[-1]
    assert off[True] < MET * subject.actor.height
    assert off[False] > 0.05


def test_both_hands_work_at_the_same_time() -> None:
    subject = HANDED["biped"]
    rng = np.random.default_rng(11)
    left, right = subject.hands
    targets = {"a": _target(subject, left, rng), "b": _target(subject, right, rng)}
    commands = [
        start(0.0, "reach", target="a", side="left"),
        start(0.3, "grasp", target="b", side="right", radius=0.03),
    ]
    shown = subject.act(commands, targets)
    assert quat.length(shown.point(left, _palm(left)) - targets["a"])[-1] < MET * subject.actor.height
    own = _palm(right) + 0.03 * right.palm
    assert quat.length(shown.point(right, own) - targets["b"])[-1] < MET * subject.actor.height


@pytest.mark.parametrize("model", [behaviour.name for behaviour in REACHING])
@pytest.mark.parametrize("name", ["hanging arms", "no fingers", "biped"])
def test_targets_anywhere_leave_finite_poses_with_hands_above_the_ground(name: str, model: str) -> None:
    subject = HANDED[name]
    joint = subject.arm(subject.hands[0]).shoulder(subject.standing(1))[0]
    places = [
        joint,
        np.zeros(3),
        joint * [1.0, -1.0, 1.0],
        np.array([0.0, 2.0, 0.5]),
        np.full(3, 1e6),
        np.array([0, 0, -5.0]),
    ]
    for place in places:
        shown = subject.act([start(0.2, model, target="it"), reset(1.0, model)], {"it": np.asarray(place)}, 1.3)
        assert np.isfinite(shown.posture.positions).all()
        assert np.isfinite(shown.posture.turns).all()
        assert shown.posture.positions[:, shown.acted.bodies, 2].min() > 0.0
    assert np.abs(shown.posture.turns[-1] - shown.base.turns[-1]).max() < 1e-9


def test_a_hand_is_known_by_its_palm() -> None:
    """In a T-pose palms look down, and beside hanging arms to the body."""
    for name, palm in (("figure", np.array([0.0, 0.0, -1.0])), ("hanging arms", None)):
        for hand in HANDED[name].hands:
            wanted = np.array([-hand.side, 0.0, 0.0]) if palm is None else palm
            assert hand.palm @ wanted > 0.8
            assert abs(hand.palm @ hand.along) < 1e-9
            assert sum(finger.is_thumb for finger in hand.fingers) == 1


def test_creatures_take_things_with_what_they_have() -> None:
    hound, asura, snake = (creature(name) for name in ("hound", "asura", "snake"))
    assert mouth_of(hound.actor) is not None
    assert all(not hand.is_taking for hand in hands_of(hound.actor))
    assert len(hands_of(asura.actor)) == 4
    assert not hands_of(snake.actor)
    target = np.array([0.15, -0.65, 0.35]) * hound.actor.bodies.size
    mouth = mouth_of(hound.actor)
    shown = hound.act([start(0.0, "reach", target="it")], {"it": target})
    before, after = (quat.length(p.positions[-1, mouth] - target) for p in (shown.base, shown.posture))
    assert after < before
    paw = hound.act([start(0.0, "touch", target="it", side="left")], {"it": target})
    assert len(paw.acted.bodies) == 1
