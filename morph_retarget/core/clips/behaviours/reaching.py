"""Reaching, touching, pointing and grasping over time: where a hand is on its way, and what its fingers do.

A hand leaves, arrives at its stroke and stays until it is told to stop, on a way of smallest jerk. It may be told of
another target at any time and goes over to that. What it does is found for the whole influence of its goal; the
solver brings it there as far as that counts (Feng 2013 §6.2, table 1).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ... import quat
from ...arrays import Array
from . import timing
from .arms import Arm
from .behaviour import Scene
from .handling import GRASP, QUICK, Step
from .hands import Hand
from .lying import Way, way_of
from .posture import Posture

FAST = 1.6
"""Peak speed of a hand that takes its own time, in heights of the body per second."""
SLOW = 3.0
"""No hand takes longer by itself [s]."""
FASTEST = 3.0
"""A hand follows no target faster than this, in heights of the body per second."""
CLOSES = 0.3
"""Fingers close in this share of the way to the stroke, before and after it."""
CLEAR = 0.02
"""A hand keeps as high over the ground, in heights of the body."""


@dataclass(frozen=True, eq=False)
class Reached:
    """What a hand is asked to do."""

    hand: Hand
    place: Array
    """Of its joint [m], shape (n, 3)."""
    influence: Array
    """How far that counts, shape (n,)."""
    arrives: tuple[float, ...]
    """When it is there in each step [s]."""


def perform(arm: Arm, scene: Scene, posture: Posture, steps: Sequence[Step]) -> tuple[Posture, Reached]:
    """Return a posture whose hand lies and whose fingers are bent as commands say, and where the hand shall be.

    Args:
        arm: Of the hand.
        scene: When, and where the targets are.
        posture: What the motion does, and other behaviours made of it.
        steps: What the hand does.
    """
    times, hand = scene.times, arm.hand
    ways = [_in_time(arm, scene, posture, steps, i) for i in range(len(steps))]
    starts, lasts = [step.at for step in steps], _lasting(arm, scene, posture, steps, ways)
    told = [None if way is None else np.column_stack([way.place, way.wrist]) for way in ways]
    values, influence = timing.passing(times, starts, lasts, told)
    values = timing.limited(values, range(3), FASTEST * arm.actor.height, timing.step_of(times))
    place = values[:, :3].copy()
    place[:, 2] = np.maximum(place[:, 2], scene.floor + CLEAR * arm.actor.height)
    carried = arm.turns(posture, place, influence)
    base = posture.turns[:, hand.body]
    wrist = quat.from_rotation_vector(influence[:, None] * values[:, 3:])
    turned = quat.multiply(quat.multiply(carried, base), wrist)
    changes = {hand.body: quat.multiply(turned, quat.conjugate(base))}
    bent = _bent(hand, times, posture, steps, lasts, ways)
    for bone, own in bent.items():
        changes[bone] = quat.multiply(quat.multiply(turned, own), quat.conjugate(posture.turns[:, bone]))
    return posture.turned(arm.actor.tree, changes), Reached(
        hand, place, influence, tuple(start + last for start, last in zip(starts, lasts, strict=True))
    )


def _lasting(
    arm: Arm, scene: Scene, posture: Posture, steps: Sequence[Step], ways: Sequence[Way | None]
) -> list[float]:
    """Return how long a hand is on its way in each step [s]."""
    times, now, out = scene.times, posture.positions[:, arm.hand.body], list[float]()
    for step, way in zip(steps, ways, strict=True):
        there = posture.positions[:, arm.hand.body] if way is None else way.place
        far = float(np.linalg.norm(timing.at(times, there - now, step.at)))
        own = min(max(timing.BELL * far / (FAST * arm.actor.height), QUICK), SLOW)
        out.append(0.0 if step.cue.sudden else step.stroke or own)
        now = there
    return out


def _bent(
    hand: Hand,
    times: Array,
    posture: Posture,
    steps: Sequence[Step],
    lasts: Sequence[float],
    ways: Sequence[Way | None],
) -> dict[int, Array]:
    """Return how finger bones are turned against the hand from rest over time, shapes (n, 4)."""
    back = quat.conjugate(posture.turns[:, hand.body])
    bones = {bone for way in ways if way is not None for bone in way.grip}
    base = {bone: quat.multiply(back, posture.turns[:, bone]) for bone in sorted(bones)}
    out = dict(base)
    for step, last, way in zip(steps, lasts, ways, strict=True):
        start, takes = step.at, last
        if step.behaviour is GRASP:
            start, takes = step.at + (1.0 - CLOSES) * last, 2.0 * CLOSES * last
        elif way is None:
            takes = 0.5 * last
        rise = timing.risen(times, start, takes)
        for bone in out:
            wanted = base[bone] if way is None else way.grip.get(bone, base[bone])
            out[bone] = quat.slerp(out[bone], np.broadcast_to(wanted, out[bone].shape), rise)
    return out


def _in_time(arm: Arm, scene: Scene, posture: Posture, steps: Sequence[Step], i: int) -> Way | None:
    """Return what a hand does in one of its steps, as long as that matters, and held before and after."""
    step, times = steps[i], scene.times
    if step.behaviour is None:
        return None
    until = np.inf
    if i + 1 < len(steps):
        until = steps[i + 1].at + max(steps[i + 1].stroke, SLOW)
    space = timing.step_of(times)
    rows = np.flatnonzero((times >= step.at - space) & (times <= until + space))
    if not len(rows):
        rows = np.array([np.argmin(np.abs(times - step.at))])
    floors = None if scene.floors is None else scene.floors[rows]
    own = way_of(arm, Scene(times[rows], scene.targets, floors), posture[rows], step)
    held = np.clip(np.arange(len(times)), rows[0], rows[-1]) - rows[0]
    return None if own is None else Way(own.place[held], own.wrist[held], own.grip)
