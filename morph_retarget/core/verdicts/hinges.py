"""Whether knees and elbows bend the way they bend at rest.

Which way that is goes with the upper bone of the joint, its twist included. A limb that is straight at rest bends as
limbs of its kind do: knees forward, elbows back.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from .. import quat
from ..arrays import Array
from ..character.morphology import LimbKind
from ..solve.limb_phase import BENT
from ..solve.wave_planning import HINTS
from .performance import Performance
from .verdict import Found

JUDGED = (LimbKind.LEG, LimbKind.ARM)
"""Wings, fins and tentacles have no side to which they must not bend."""


@dataclass(frozen=True, eq=False)
class Hinge:
    """A joint between two bones of a limb."""

    upper: int
    """The bone that carries it."""
    joint: int
    end: int
    """Where the bone beyond it leads."""
    axis: Array
    """About which it bends, at rest, unit vector, shape (3,)."""


def overextended(performance: Performance) -> Found:
    """Return by what angle a knee or an elbow is bent beyond straight, against its bend at rest [deg]."""
    found = list(hinges(performance))
    bends = [np.maximum(-_bend(performance, hinge), 0.0) for hinge in found]
    names = [performance.names[hinge.joint] for hinge in found]
    return Found.worst(np.degrees(np.stack(bends, axis=-1)), names) if found else Found(0.0)


def hinges(performance: Performance) -> Iterator[Hinge]:
    """Yield the knees and elbows of a character; of other joints nobody knows which way they must not bend."""
    rest, character = performance.rest, performance.character
    for limb in character.limbs:
        if limb.kind not in JUDGED:
            continue
        line = performance.hierarchy.hinged(limb.bones)
        for upper, joint, end in zip(line, line[1:], line[2:], strict=False):
            before, after = quat.unit(rest[joint] - rest[upper]), quat.unit(rest[end] - rest[joint])
            axis = quat.cross(before, after)
            if np.arctan2(quat.length(axis), quat.dot(before, after)) < BENT:
                if not character.humanoid:
                    continue
                axis = quat.cross(HINTS[limb.kind], quat.unit(rest[end] - rest[upper]))
            if quat.length(axis) > 0.0:
                yield Hinge(upper, joint, end, quat.unit(axis))


def _bend(performance: Performance, hinge: Hinge) -> Array:
    """Return by what angle a joint is bent the way that it bends at rest [rad], shape (frame,).

    A joint that folds up altogether bends by half a turn, and by a little more where bones pass each other: so angles
    go from half a turn less to half a turn more than at rest.
    """
    places, rest = performance.places, performance.rest
    before = places[:, hinge.joint] - places[:, hinge.upper]
    after = places[:, hinge.end] - places[:, hinge.joint]
    axis = quat.rotate(performance.turns[:, hinge.upper], hinge.axis)
    bend = np.arctan2(quat.dot(quat.cross(before, after), axis), quat.dot(before, after))
    before, after = rest[hinge.joint] - rest[hinge.upper], rest[hinge.end] - rest[hinge.joint]
    at_rest = np.arctan2(quat.dot(quat.cross(before, after), hinge.axis), quat.dot(before, after))
    return at_rest + np.remainder(bend - at_rest + np.pi, 2.0 * np.pi) - np.pi
