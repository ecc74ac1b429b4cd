"""Gaze: eyes, head, neck and spine that turn together to what they look at."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from morph_retarget.core import quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.clips.behaviours import gaze, sharing
from morph_retarget.core.clips.track import Track
from tests.behaving import RATE, Shown, Subject, creature, figure, start, stop

LOOKING = {"figure": figure(), **{name: creature(name) for name in ("biped", "hound", "bird", "beetle", "snake")}}
each = pytest.mark.parametrize("subject", LOOKING.values(), ids=LOOKING)
few = settings(max_examples=30, deadline=None)
HIT = 1.0
"""A target within the limits is hit to this angle [deg]."""
UP = np.array([0.0, 0.0, 1.0])


def _degrees(a: Array, b: Array) -> Array:
    """Return angles between vectors [deg]."""
    return np.degrees(np.arctan2(quat.length(quat.cross(a, b)), quat.dot(a, b)))


def _head_off(shown: Shown, target: Array) -> Array:
    """Return how far the head looks past a target [deg], shape (n,)."""
    actor = shown.subject.actor
    return _degrees(
        shown.posture.seen(actor.head, actor.forward), target - shown.posture.point(actor.head, actor.sight)
    )


def _off(shown: Shown, target: Array) -> Array:
    """Return how far what looks, eyes or head, looks past a target [deg], shape (n,)."""
    actor = shown.subject.actor
    if not actor.eyes:
        return _head_off(shown, target)
    forwards = actor.bodies.forwards
    own = [_degrees(shown.posture.seen(e, forwards[e]), target - shown.posture.positions[:, e]) for e in actor.eyes]
    return np.max(own, axis=0)


def _ahead(subject: Subject, yaw: float, rise: float, far: float) -> Array:
    """Return a place that is to be seen by turning from where a head looks [deg, deg, heights of the body]."""
    actor, base = subject.actor, subject.standing(1)
    forward = base.seen(actor.head, actor.forward)[0]
    left = quat.unit(np.cross(UP, forward))
    turned = quat.multiply(quat.from_axis_angle(UP, np.radians(yaw)), quat.from_axis_angle(left, np.radians(-rise)))
    return base.point(actor.head, actor.sight)[0] + far * actor.height * quat.rotate(turned, forward)


@each
def test_a_target_within_the_limits_is_hit(subject: Subject) -> None:
    rng = np.random.default_rng(1)
    for _ in range(6):
        target = _ahead(subject, rng.uniform(-60.0, 60.0), rng.uniform(-25.0, 25.0), rng.uniform(0.7, 5.0))
        shown = subject.act([start(0.2, "gaze", target="it", level="waist")], {"it": target})
        assert _off(shown, target)[-1] < HIT


@each
def test_without_a_command_nothing_turns(subject: Subject) -> None:
    shown = subject.act([start(1.0, "gaze", target="it"), stop(2.0, "gaze")], {"it": np.array([1.0, -1.0, 1.0])}, 5.0)
    for frames in (slice(0, 30), slice(shown.frame(3.5), None)):
        assert np.abs(shown.acted.posture.turns[frames] - shown.base.turns[frames]).max() < 1e-9


@each
def test_what_is_behind_is_looked_for_as_far_round_as_joints_turn(subject: Subject) -> None:
    actor = subject.actor
    target = _ahead(subject, 150.0, 0.0, 2.0)
    shown = subject.act([start(0.2, "gaze", target="it", level="waist")], {"it": target})
    turned = _degrees(
        shown.posture.seen(actor.head, actor.forward)[[-1]], shown.base.seen(actor.head, actor.forward)[[-1]]
    )
    assert 40.0 < turned[0] < 140.0
    assert np.isfinite(shown.posture.turns).all()


@each
@pytest.mark.parametrize("speed", [40.0, 180.0])
def test_no_head_turns_faster_than_it_may(subject: Subject, speed: float) -> None:
    """Not even where its target jumps from one side to the other."""
    actor, times = subject.actor, np.arange(200) / RATE
    sides = np.array([_ahead(subject, side * 60.0, 0.0, 2.0) for side in (1.0, -1.0)])
    jumping = Track(times, sides[(times * 0.7).astype(int) % 2])
    commands = [start(0.2, "gaze", target="it", speed=speed), stop(4.0, "gaze")]
    shown = subject.act(commands, {"it": jumping}, 6.0)
    looks = shown.acted.posture.seen(actor.head, actor.forward)
    assert (_degrees(looks[1:], looks[:-1]) * RATE).max() < 1.03 * speed


def test_a_moving_target_is_followed() -> None:
    subject, times = LOOKING["biped"], np.arange(181) / RATE
    path = np.array([_ahead(subject, 40.0 * np.sin(time), 10.0 * np.cos(time), 1.5) for time in times])
    shown = subject.act([start(0.0, "gaze", target="it", level="chest")], {"it": Track(times, path)}, 6.0)
    actor = subject.actor
    eye = actor.eyes[0]
    off = _degrees(shown.posture.seen(eye, actor.bodies.forwards[eye]), path - shown.posture.positions[:, eye])
    assert off[60:].max() < 2.0


def test_a_gaze_goes_over_from_one_target_to_another_without_a_jump() -> None:
    subject = LOOKING["biped"]
    targets = {"a": _ahead(subject, 50.0, 0.0, 2.0), "b": _ahead(subject, -50.0, 10.0, 2.0)}
    commands = [start(0.2, "gaze", target="a"), start(0.5, "gaze", target="b", speed=120.0), stop(2.5, "gaze")]
    shown = subject.act(commands, targets, 4.0)
    turns = shown.acted.posture.turns
    assert quat.angle_between(turns[1:], turns[:-1]).max() < np.radians(gaze.EYES_SPEED) / RATE * 1.1
    assert _off(shown, targets["b"])[shown.frame(2.4)] < HIT


def test_a_head_stays_upright_while_it_looks_to_the_side_and_up() -> None:
    subject = LOOKING["figure"]
    target = _ahead(subject, 55.0, 25.0, 2.0)
    actor = subject.actor
    shown = subject.act([start(0.2, "gaze", target="it", level="waist")], {"it": target})
    left = shown.posture.seen(actor.head, np.array([1.0, 0.0, 0.0]))[-1]
    assert abs(left[2]) < 1e-6


def test_eyes_alone_leave_the_head_where_it_is() -> None:
    subject = LOOKING["biped"]
    target = _ahead(subject, 15.0, 5.0, 2.0)
    shown = subject.act([start(0.2, "gaze", target="it", level="eyes")], {"it": target})
    head = subject.actor.head
    assert np.abs(shown.posture.turns[:, head] - shown.base.turns[:, head]).max() < 1e-9
    assert _off(shown, target)[-1] < HIT


@few
@given(
    seed=st.integers(0, 1000),
    angle=st.floats(-1.0, 1.0),
    count=st.integers(1, 7),
)
def test_the_shares_of_joints_add_up_to_what_they_turn_together(seed: int, angle: float, count: int) -> None:
    rng = np.random.default_rng(seed)
    weights, limits = rng.uniform(0.0, 1.0, count), rng.uniform(0.05, 0.5, count)
    weights[rng.integers(count)] = 1.0
    found = sharing.cumulated(np.array([angle]), weights, limits)[0]
    able = limits[weights > 0.0].sum()
    assert abs(found[-1] - np.clip(angle, -able, able)) < 1e-9
    shares = np.diff(np.concatenate([[0.0], found]))
    assert (np.abs(shares) <= limits + 1e-9).all()
    assert (shares * angle >= -1e-12).all()


@pytest.mark.parametrize("away", [0.0, 1e-9, 1e-3])
def test_a_target_at_the_eyes_is_ignored(away: float) -> None:
    subject = LOOKING["biped"]
    actor, base = subject.actor, subject.standing(1)
    target = base.point(actor.head, actor.sight)[0] + away
    shown = subject.act([start(0.0, "gaze", target="it")], {"it": target})
    assert np.isfinite(shown.posture.turns).all()
    assert quat.angle_between(shown.posture.turns[:, actor.head], shown.base.turns[:, actor.head]).max() < np.radians(
        70
    )
