"""How a hand lies that reaches, touches, points or grasps, and what its fingers do, if that counts in full.

A hand goes along with its forearm. So where it has to be, and how the arm brings it there, are found in turn.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ... import quat
from ...arrays import Array
from ...locomotion.moving import eased
from . import fingers
from .arms import Arm
from .behaviour import Scene
from .handling import GRASP, POINT, TOUCH, Step
from .hands import PALM, Hand
from .posture import Posture

ROUNDS = 4
"""How often a hand's place is found anew, from how the arm has turned it."""
POINTING = 0.96
"""Share of its length to which an arm stretches to point."""
SMALL = 0.02
"""Radius of what is grasped whose size nobody tells, in heights of the body."""
WRIST = np.radians(75.0)
"""Most that a hand bends against its forearm for what it takes hold of [rad]."""
LOOSE = np.radians(35.0)
"""How far fingers bend that neither point nor touch [rad]."""
BEHIND, ACROSS = np.radians(115.0), np.radians(60.0)
"""How far round an arm points: to behind on its own side, and over to the other one [rad]."""
LEVEL, LOW = 0.35, 0.8
"""How far down a target is, as the sine of the angle, where the palm begins to look down, and where it does."""
UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, eq=False)
class Way:
    """What a hand does in one step, if that counts in full."""

    place: Array
    """Of its joint [m], shape (n, 3)."""
    wrist: Array
    """How it turns against the forearm, beyond how the motion has it, as rotation vectors, shape (n, 3)."""
    grip: Mapping[int, Array]
    """Turns of finger bones against the hand from rest, shapes (4,)."""


def way_of(arm: Arm, scene: Scene, posture: Posture, step: Step) -> Way | None:
    """Return what a hand does in a step, None where it goes back."""
    if step.behaviour is None:
        return None
    target = scene.track(step.values).at(scene.times)
    if step.behaviour is POINT:
        return _pointing(arm, posture, target)
    if step.behaviour is GRASP:
        return _grasping(arm, scene, posture, target, step)
    hand, grip = arm.hand, dict[int, Array]()
    contact = hand.middle + hand.thickness * hand.palm
    if step.behaviour is TOUCH and hand.pointer is not None:
        grip = _one_finger(hand, LOOSE)
        contact = hand.pointer.points[0] + hand.pointer.length * hand.along
    elif step.behaviour is TOUCH:
        contact = hand.middle / PALM
    place, turned = target, posture.turns[:, hand.body]
    for _ in range(ROUNDS):
        turned = _natural(arm, posture, place)
        place = target - quat.rotate(turned, np.broadcast_to(contact, target.shape))
    return Way(place, _wrist(_natural(arm, posture, place), turned), grip)


def _natural(arm: Arm, posture: Posture, place: Array) -> Array:
    """Return how a hand is turned that goes along with its forearm to a place, shape (n, 4)."""
    whole = arm.turns(posture, place, np.ones(len(place)))
    return quat.multiply(whole, posture.turns[:, arm.hand.body])


def _one_finger(hand: Hand, others: float) -> dict[int, Array]:
    """Return a hand with its pointer straight along it, and the other fingers bent by an angle [rad]."""
    grip = fingers.curled(hand, others).turns
    return grip if hand.pointer is None else grip | fingers.straight(hand.pointer, hand.along)


def _wrist(natural: Array, turned: Array) -> Array:
    """Return how a hand turns beyond how it goes along with its forearm, rotation vectors, shape (n, 3)."""
    return quat.to_rotation_vector(quat.multiply(quat.conjugate(natural), turned))


def _pointing(arm: Arm, posture: Posture, target: Array) -> Way:
    """Return an arm that is stretched toward a target, its finger in line with that."""
    hand, shoulder = arm.hand, arm.shoulder(posture)
    away = _turned_to(arm, posture, target - shoulder)
    far = quat.length(away)[:, None]
    length = np.clip(far - 1.3 * hand.length, 0.35 * arm.length, POINTING * arm.length)
    place = shoulder + length * quat.unit(away)
    target = shoulder + away
    base = np.zeros(3) if hand.pointer is None else hand.pointer.points[0]
    natural = _natural(arm, posture, place)
    turned = natural
    for _ in range(2 * ROUNDS):
        ahead = target - place - quat.rotate(turned, np.broadcast_to(base, target.shape))
        along = quat.rotate(natural, np.broadcast_to(hand.along, target.shape))
        turned = quat.multiply(quat.between(along, ahead), natural)
    return Way(place, _wrist(natural, turned), _one_finger(hand, 0.9 * fingers.MOST))


def _turned_to(arm: Arm, posture: Posture, away: Array) -> Array:
    """Return ways to a target that an arm can point along: as far round as it gets."""
    hand = arm.hand
    if not hand.is_arm or not hand.side:
        return away
    carrier = int(arm.actor.tree.parents[arm.joints[0]])
    frame = posture.turns[:, carrier] if carrier >= 0 else quat.identity(len(away))
    own = quat.rotate(quat.conjugate(frame), away)
    level = np.hypot(own[:, 0], own[:, 1])
    out = np.arctan2(hand.side * own[:, 0], -own[:, 1])
    # What is behind is nearer to the outside than to the other side up to a point opposite of the middle.
    middle = 0.5 * (BEHIND - ACROSS)
    out = middle + (out - middle + np.pi) % (2.0 * np.pi) - np.pi
    out = np.clip(out, -ACROSS, BEHIND)
    turned = np.column_stack([hand.side * level * np.sin(out), -level * np.cos(out), own[:, 2]])
    return quat.rotate(frame, turned)


def _grasping(arm: Arm, scene: Scene, posture: Posture, target: Array, step: Step) -> Way:
    """Return a hand whose palm lies at what it takes hold of, and whose fingers have closed on that."""
    hand = arm.hand
    radius = step.cue.number("radius", GRASP.parameters)
    surface = scene.track(step.values).surface if not radius else None
    size = radius or SMALL * arm.actor.height
    place, contact, local = target, hand.middle, np.zeros((0, 3))
    natural = turned = posture.turns[:, hand.body]
    stroke = int(np.argmin(np.abs(scene.times - step.at)))
    for _ in range(ROUNDS):
        natural = _natural(arm, posture, place)
        turned = _gripping(arm, posture, natural, target)
        if surface is not None and len(surface):
            local = quat.rotate(quat.conjugate(turned[stroke]), surface)
            size = float(np.max(local @ -hand.palm))
        contact = hand.middle + (size + hand.thickness) * hand.palm
        place = target - quat.rotate(turned, np.broadcast_to(contact, target.shape))
    outside = fingers.cloud(local + contact) if len(local) else fingers.sphere(contact, size)
    grip = fingers.closed(hand, outside).turns if hand.fingers else {}
    return Way(place, _wrist(_natural(arm, posture, place), turned), grip)


def _gripping(arm: Arm, posture: Posture, natural: Array, target: Array) -> Array:
    """Return how a hand is turned to take hold of a target: thumb up, and over what is low; shape (n, 4)."""
    hand = arm.hand
    if not hand.is_arm:
        return natural
    carrier = int(arm.actor.tree.parents[arm.joints[0]])
    frame = posture.turns[:, carrier] if carrier >= 0 else quat.identity(len(target))
    inward = quat.rotate(frame, np.broadcast_to([-float(hand.side), 0.0, 0.0], target.shape))
    away = quat.unit(target - arm.shoulder(posture))
    low = eased((-away[:, 2:] - LEVEL) / (LOW - LEVEL))
    palm = quat.unit(inward - low * (inward + UP))
    along = away - quat.dot(away, palm)[:, None] * palm
    turned = quat.between(np.broadcast_to(hand.along, along.shape), along)
    now = quat.rotate(turned, np.broadcast_to(hand.palm, along.shape))
    ahead = quat.unit(along)
    sine = quat.dot(ahead, quat.cross(now, palm))
    turned = quat.multiply(quat.from_axis_angle(ahead, np.arctan2(sine, quat.dot(now, palm))), turned)
    bend = _wrist(natural, turned)
    size = quat.length(bend)
    share = np.minimum(WRIST / np.maximum(size, 1e-9), 1.0)[:, None]
    return quat.multiply(natural, quat.from_rotation_vector(share * bend))
