"""Transitions: how long one motion takes to go over into another, found by itself (Grünvogel 2003 §8).

The paper prescribes it for each pair of motion models, and asks for a way that does without. Here it is the shortest
one in which no joint has to turn much faster than it does in the two motions anyway.
"""

import math

import numpy as np

from ... import quat
from ...arrays import Array
from ..character_model import RATE
from ..clip import Clip, ClipPrimitive
from ..operators.envelope import risen
from ..operators.section import Section
from .footed import Footed

LASTS = (4.0, 6.0, 8.0, 10.0, 12.0, 15.0, 18.0, 21.0, 25.0, 30.0, 37.0, 45.0, 60.0)
LONGEST = LASTS[-1]
"""How long transitions last, the shortest that will do [frames]."""
FASTER = 1.3
"""A joint may turn by this factor faster than in the fastest moment of either motion; 1.5 is what must hold …"""
SLOW = np.radians(30.0) / RATE
"""… where that is slower than this, it counts as this fast [rad per frame]."""
DEEPER = 3
"""A tree that is deeper than usual by more operators is sampled before it is blended once more."""
AROUND = 15.0
"""Frames before and after the transition that tell how fast the motions are."""
SAME_TURN, SAME_PLACE = 1e-6, 1e-6
"""Poses that differ by less are the same [rad, body heights]."""


def crossfade(before: Clip, after: Clip, first: float, last: float) -> Footed:
    """Return a clip that goes over from one clip to another between two frames while both go on at their own times."""
    return Footed(before.start, after.start, first, last, before, after)


def held_on(clip: Clip) -> Clip:
    """Return a clip that holds its last frame without end."""
    return Section(clip.start, np.inf, clip) if clip.is_finite else clip


def differ(before: Clip, after: Clip, frame: float) -> bool:
    """Return whether two clips show different poses at a frame."""
    at = np.array([frame])
    a, b = before.frame(at), after.frame(at)
    character = before.model.character
    moved = float(np.abs(a.translations - b.translations).max(initial=0.0)) * character.local_to_character.scale
    away = max(float(np.abs(a.feet - b.feet).max(initial=0.0)), moved) / character.frame.height
    return away > SAME_PLACE or float(quat.angle_between(a.rotations, b.rotations).max(initial=0.0)) > SAME_TURN


def transition(before: Clip, after: Clip, frame: float) -> Footed:
    """Return the shortest transition from one clip to another that starts at a frame and is not too fast.

    It is no shorter than feet need for their steps, if they have to take some, and no longer than `LONGEST`, or twice
    that where each leg has half of it.
    """
    times = frame + np.arange(-AROUND, LONGEST + AROUND + 1.0)
    a, b = before.frame(times).rotations, after.frame(times).rotations
    rows = slice(int(AROUND), None)
    most = np.maximum(_turning(a).max(axis=0), _turning(b[rows]).max(axis=0))
    allowed = FASTER * np.maximum(most, SLOW)
    last = next((last for last in LASTS if _suits(a[rows], b[rows], times[rows] - frame, last, allowed)), LONGEST)
    out = crossfade(before, after, frame, frame + last)
    while out.steps:
        within = frame + np.arange(math.ceil(last) + 2.0)
        slow = out.least <= last and (_turning(out.frame(within).rotations) <= allowed).all()
        if slow or last >= 2.0 * LONGEST:
            break
        last = max(1.25 * last, out.least)
        out = crossfade(before, after, frame, frame + last)
    return out


def _suits(before: Array, after: Array, since: Array, last: float, allowed: Array) -> bool:
    """Return whether no joint turns too fast in a transition that takes so long, shapes (n, joint, 4) and (n,)."""
    turned = quat.slerp(before, after, risen(since, 0.0, last)[:, None])
    return bool((_turning(turned) <= allowed).all())


def _turning(rotations: Array) -> Array:
    """Return how far joints turn from frame to frame [rad], shape (n, joint, 4) to (n - 1, joint)."""
    return quat.angle_between(rotations[1:], rotations[:-1])


def kept_small(clip: Clip, frame: float, lasts: float, usual: int) -> Clip:
    """Return a clip as it is, or if its tree has grown deep what it shows from a frame on.

    Trees grow where one blend begins before the last is over, again and again.

    Args:
        clip: Any.
        frame: From when on it is needed.
        lasts: For how long [frames].
        usual: How deep trees of its kind are.
    """
    if depth(clip) <= DEEPER + usual:
        return clip
    times = frame + np.arange(math.ceil(lasts) + 1.0)
    way = clip.travel(times)
    return ClipPrimitive("before", clip.model, clip.frame(times), way.since(way[:1]), clip.active, frame)


def depth(clip: Clip) -> int:
    """Return how many operators lie over the deepest primitive of a motion tree."""
    return max((1 + depth(part) for part in clip.parts), default=0)
