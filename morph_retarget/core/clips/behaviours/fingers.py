"""Fingers that curl: straight, into a fist, and until each meets the surface of what a hand grasps.

A finger bends all its joints by angles of one proportion, in the plane in which it curls toward the palm. Everything is
seen from the hand's joint, in the frame of the rest pose.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ... import quat
from ...arrays import Array
from .hands import Finger, Hand

MOST = np.radians(85.0)
"""Most that the joints of a finger bend [rad] …"""
THUMB_MOST = np.radians(60.0)
"""… and those of a thumb."""
PROPORTION = (1.0, 1.1, 0.8)
"""How far the joints of a finger bend, from the hand outward."""
STEPS = 64
"""Angles that are tried for one that meets a surface …"""
HALVINGS = 30
"""… and how often the way between two of them is halved then."""

Distance = Callable[[Array], Array]
"""How far points are outside of a surface [m], below 0 inside, shape (n, 3) to (n,)."""


@dataclass(frozen=True, eq=False)
class Grip:
    """How the fingers of a hand are bent."""

    turns: dict[int, Array]
    """Of each bone against the hand, from rest, shapes (4,)."""
    tips: Array
    """Of the fingers [m], from the hand's joint, rest frame of the hand, shape (finger, 3)."""
    meets: tuple[bool, ...]
    """Which fingers meet the surface that they close on."""


def sphere(middle: Array, radius: float) -> Distance:
    """Return the distance from a ball; ``middle`` from the hand's joint [m], shape (3,)."""
    return lambda points: quat.length(points - middle) - radius


def cloud(surface: Array) -> Distance:
    """Return the distance from a surface that is known by points [m], shape (point, 3).

    What is farther from the middle than the points about it is outside. It is as exact as the points are dense.
    """
    middle = surface.mean(axis=0)
    ways = quat.unit(surface - middle)
    sizes = quat.length(surface - middle)

    def distance(points: Array) -> Array:
        away = points - middle
        along = quat.unit(away) @ ways.T
        near = np.maximum(along - along.max(axis=1, keepdims=True) + NEARBY, 0.0) + 1e-12
        return quat.length(away) - (near * sizes).sum(axis=1) / near.sum(axis=1)

    return distance


NEARBY = 0.02
"""Points of a surface count for a direction up to this much in the cosine farther from it than the nearest."""


def straight(finger: Finger, along: Array) -> dict[int, Array]:
    """Return the turns against the hand that lay the bones of a finger along a direction, unit vector (3,)."""
    bones = np.diff(finger.points, axis=0)
    return {bone: quat.between(bones[i], along) for i, bone in enumerate(finger.bones)}


def curled(hand: Hand, angle: float) -> Grip:
    """Return a hand whose fingers all bend by an angle [rad]: 0 as at rest, `MOST` a fist."""
    bent = [_bent(hand, finger, np.array([angle * _most(finger) / MOST])) for finger in hand.fingers]
    turns = {
        bone: own[0][0, i]
        for finger, own in zip(hand.fingers, bent, strict=True)
        for i, bone in enumerate(finger.bones)
    }
    tips = np.array([own[1][0] for own in bent]).reshape(-1, 3)
    return Grip(turns, tips, (False,) * len(bent))


def closed(hand: Hand, distance: Distance) -> Grip:
    """Return a hand each of whose fingers has closed until its tip meets a surface, or as near to it as it comes."""
    turns: dict[int, Array] = {}
    tips, meets = np.zeros((len(hand.fingers), 3)), list[bool]()
    for k, finger in enumerate(hand.fingers):
        tried = np.linspace(0.0, _most(finger), STEPS)
        away = distance(_bent(hand, finger, tried)[1])
        inside = np.flatnonzero(away <= 0.0)
        if len(inside) and inside[0] > 0:
            low, high = tried[inside[0] - 1], tried[inside[0]]
            for _ in range(HALVINGS):
                middle = 0.5 * (low + high)
                is_out = distance(_bent(hand, finger, np.array([middle]))[1])[0] > 0.0
                low, high = (middle, high) if is_out else (low, middle)
            angle = low
        else:
            angle = tried[int(np.argmin(np.abs(away)))]
        own, tip = _bent(hand, finger, np.array([angle]))
        turns |= {bone: own[0, i] for i, bone in enumerate(finger.bones)}
        tips[k] = tip[0]
        meets.append(bool(len(inside)))
    return Grip(turns, tips, tuple(meets))


def _most(finger: Finger) -> float:
    return THUMB_MOST if finger.is_thumb else MOST


def _bent(hand: Hand, finger: Finger, angles: Array) -> tuple[Array, Array]:
    """Return how the bones of a finger turn that bends by angles, (n, bone, 4), and where its tip is, (n, 3)."""
    count = len(finger.bones)
    axis = _axis(hand, finger)
    # A thumb's first bone lies in the palm and turns little.
    proportion = np.array([PROPORTION[min(i, 2)] for i in range(count)])
    if finger.is_thumb and count > 2:
        proportion[0] *= 0.5
    total = angles[:, None] * np.cumsum(proportion)
    turns = quat.from_axis_angle(axis, total)
    bones = quat.rotate(turns, np.diff(finger.points, axis=0))
    return turns, finger.points[0] + bones.sum(axis=1)


def _axis(hand: Hand, finger: Finger) -> Array:
    """Return the axis about which a finger curls, unit vector, shape (3,)."""
    toward = hand.palm
    if finger.is_thumb:
        toward = hand.middle + 0.5 * hand.length * hand.palm + 0.2 * hand.length * hand.along - finger.points[0]
    axis = quat.cross(finger.along[None], toward[None])[0]
    return quat.unit(axis) if np.linalg.norm(axis) > 1e-9 * max(hand.length, 1e-9) else np.array([0.0, 0.0, 1.0])
