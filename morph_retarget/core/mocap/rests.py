"""What rests tell of limbs: where knees and elbows point, and how feet stand that a stance has turned.

People rest with straight legs, toes to the front and soles flat, and what a clip does is taken relative to that. A rest
that is a stance, as of a fighter or of one who crouches, is none of it: its own bends tell where its joints point, and
feet are first brought to where they would be on one who stands.
"""

from collections.abc import Sequence

import numpy as np

from .. import quat
from ..arrays import Array
from ..character.character import Character

Direction = tuple[float, float, float]
Turn = tuple[float, float, float, float]
KNEE: Direction = (0.0, -1.0, 0.0)
ELBOW: Direction = (0.0, 1.0, 0.0)
"""Where the middle joints of people's legs and arms point, character frame."""
UNTURNED: Turn = (1.0, 0.0, 0.0, 0.0)
BENT = 0.02
"""A leg whose middle joint lies this far off its line at rest shows which way it bends, in shares of the line."""
CROUCHED = np.radians(30.0)
"""People's limbs that are bent by more than this at rest show it …"""
RAISED = np.radians(45.0)
"""… and the knees of thighs that are raised by more than this point up."""
TURNED = np.radians(20.0)
"""Feet that are turned by more than this against the other body's at rest are turned by a stance."""
STEEP = np.sin(np.radians(75.0))
"""A foot that points up or down more steeply than this points to nowhere."""


def knee(target: Character, bones: Sequence[int]) -> Direction:
    """Return where the first bend of a leg points at rest: forward on people who stand, as it is built on animals.

    An animal's leg that is straight at rest is taken for an arm when it is a front leg.

    Args:
        target: Whose leg it is.
        bones: Of the leg, from the hip outward.
    """
    if len(bones) < 3:
        return KNEE
    if target.humanoid:
        return _of_people(target, bones, KNEE)
    top, middle, bottom = _places(target, bones[:3])
    line = quat.unit(bottom - top)
    off = middle - top - ((middle - top) @ line) * line
    if quat.length(off) < BENT * quat.length(bottom - top):
        rows = [leg.row for leg in target.legs if bones[0] in leg.bones]
        return ELBOW if rows == [0] and target.legs[-1].row > 0 else KNEE
    return _direction(off)


def elbow(target: Character, bones: Sequence[int]) -> Direction:
    """Return where the elbow of an arm points at rest: back, or as it is bent.

    Args:
        target: Whose arm it is.
        bones: Of the arm, from the shoulder outward.
    """
    return ELBOW if len(bones) != 3 or not target.humanoid else _of_people(target, bones, ELBOW)


def _of_people(target: Character, bones: Sequence[int], usual: Direction) -> Direction:
    top, middle, bottom = _places(target, bones[:3])
    upper, lower = quat.unit(middle - top), quat.unit(bottom - middle)
    if upper @ lower < np.cos(CROUCHED):
        return _direction((lower @ upper) * upper - lower)
    if usual is KNEE and 0.0 < -upper[2] < np.cos(RAISED):
        return _direction(quat.rotate(quat.between(np.array([0.0, 0.0, -1.0]), upper), np.array(usual)))
    return usual


def foot(source: Character, target: Character, bones: tuple[int, int], theirs: tuple[int, int]) -> Turn:
    """Return the turn of a foot from the target's rest to how it stands on one who stands as the source rests.

    Args:
        source: Whose motion it is.
        target: Whose foot it is.
        bones: Its foot and its toes on the target …
        theirs: … and on the source.
    """
    own, wanted = _way(target, *bones), _way(source, *theirs)
    if max(abs(float(own[2])), abs(float(wanted[2]))) > STEEP:
        return UNTURNED
    angle = np.arctan2(quat.cross(own, wanted)[2], own[:2] @ wanted[:2])
    turn = quat.from_axis_angle(np.array([0.0, 0.0, 1.0]), angle if abs(angle) > TURNED else 0.0)
    w, x, y, z = (float(v) for v in turn)
    return w, x, y, z


def _way(body: Character, ankle: int, ball: int) -> Array:
    first, second = _places(body, (ankle, ball))
    return quat.unit(second - first)


def _places(body: Character, bones: Sequence[int]) -> Array:
    return body.local_to_character.points(body.skeleton.rest_positions[list(bones)])


def _direction(way: Array) -> Direction:
    x, y, z = (float(v) for v in quat.unit(way))
    return x, y, z
