"""A motion as it is seen in a mirror, left and right changed over, before a target plays it."""

import re
from dataclasses import replace

import numpy as np

from .. import quat
from ..arrays import Array, Indices
from . import further
from .links import Links
from .motion import SourceMotion

_SIDES = (("left", "right"), ("right", "left"), ("Left ", "Right "), ("Right ", "Left "))
_LETTER = re.compile(r"\.([lr])(?=\[|$)")
_SEEN = np.array([-1.0, 1.0, 1.0])
_TURNED = np.array([1.0, 1.0, -1.0, -1.0])
"""What a mirror makes of places, and of rotations, whose axes are no arrows."""


def other_side(name: str) -> str:
    """Return what a link or limb is called on the other side: "rightHand", "leg0.r[1]" for "leftHand", "leg0.l[1]"."""
    for side, other in _SIDES:
        if name.startswith(side):
            return other + name[len(side) :]
    return _LETTER.sub(lambda found: ".r" if found[1] == "l" else ".l", name)


def partners(links: Links) -> Indices:
    """Return for each link that of the other side, or itself where there is none, shape (link,)."""
    place = {name: i for i, name in enumerate(links.names)}
    # A further bone follows the joint of the other side itself.
    sides = [(other_side(name), other_side(further.joint_of(name))) for name in links.names]
    found = [place.get(other, place.get(joint, i)) for i, (other, joint) in enumerate(sides)]
    return np.array(found, dtype=np.intp)


def mirrored(source: SourceMotion, links: Links, post: Array) -> SourceMotion:
    """Return a motion mirrored in the plane of symmetry.

    The target's rest is taken to be its own mirror image; that of the source, which may be no pose of a body, need not.

    Args:
        source: What the source does.
        links: Of the pair.
        post: What leads from turns of the source to those of the target, shape (link, 4).
    """
    other = partners(links)
    turns = quat.multiply(source.turns[:, other], post[other]) * _TURNED
    by_end = {leg.end: i for i, leg in enumerate(links.legs)}
    feet = [by_end.get(int(other[leg.end]), i) for i, leg in enumerate(links.legs)]
    steps = source.steps
    return replace(
        source,
        turns=quat.multiply(turns, quat.conjugate(post)),
        points=source.points[:, other] * _SEEN,
        steps=replace(
            steps,
            ankle=steps.ankle[:, feet],
            ball=steps.ball[:, feet],
            ankle_floor=steps.ankle_floor[feet],
            ball_floor=steps.ball_floor[feet],
        ),
    )
