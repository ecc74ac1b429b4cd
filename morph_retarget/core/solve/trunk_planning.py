"""The trunk's part of a plan: the spine that bends for goals and limbs, and the limbs that may move the root.

The spine has a particle only where something branches off (Hecker 2008 §4.3.1): at bodies of the trunk with goals, and
where limbs are carried, which pull at it.
"""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from .. import quat
from ..arrays import Array, Flags
from .allotment import Allotment
from .plan import NONE, Limb, Nudge, Pin, Trunk
from .settings import SolverSettings
from .spine import Spine
from .spine_pulls import Pull


@dataclass(frozen=True)
class _Hanging:
    """A limb that a bone of the line carries."""

    limb: Limb
    joint: int
    """The place of that bone's body in the line."""
    point: int
    """The point of the line that it pulls, 0 when it pulls none."""


def trunk_of(allotment: Allotment, settings: SolverSettings, fixed: Collection[int]) -> Trunk | None:
    """Return the spine that bends and what bends it, None when nothing does.

    Args:
        allotment: Of the goals.
        settings: Of the solver.
        fixed: Bodies whose joints cannot move off where their parents hold them.
    """
    line, rest = allotment.asked.line, allotment.hierarchy.rest
    if not line or not settings.bends_spine:
        return None
    points = _points(allotment)
    hanging = list(_hanging(allotment, points))
    pinned = [_pinned(allotment, tip.owner, tip.body) for tip in allotment.tips]
    nodes = (0, *sorted({point for point in (*(own.point for own in hanging), *pinned) if point > 0}))
    if len(nodes) < 2:
        return None
    last = nodes[-1]
    node_of = {point: node for node, point in enumerate(nodes)}
    pulling = [own for own in hanging if own.point > 0 and own.joint < last]
    pulls = tuple(_pull(allotment, own, node_of[own.point], settings) for own in pulling)
    pins = [
        Pin(node_of[point], tip.goal, tip.owner, tip.body, rest[tip.owner] - points[point])
        for tip, point in zip(allotment.tips, pinned, strict=True)
        if point > 0
    ]
    return Trunk(
        Spine(np.array(points[: last + 1]), nodes, pulls, settings, _free(line, nodes, settings, fixed)),
        line[:last],
        tuple(pins),
        tuple(own.limb.goal for own in pulling),
        line[last] if last < len(line) else NONE,
    )


def nudge_of(allotment: Allotment, settings: SolverSettings) -> Nudge | None:
    """Return the limbs that hang on the root, if they may move it."""
    hierarchy = allotment.hierarchy
    own = [limb for limb in allotment.limbs if allotment.carrier(limb) == hierarchy.root]
    if not own or settings.nudge <= 0.0:
        return None
    lengths = np.array([hierarchy.lengths(limb.path, limb.body) for limb in own])
    starts = hierarchy.rest[[limb.path[0] for limb in own]]
    chords = quat.length(hierarchy.rest[[limb.body for limb in own]] - starts)
    slow_down = [settings.of_limb(hierarchy.names[limb.body]).slow_down for limb in own]
    return Nudge(
        np.array([limb.goal for limb in own], dtype=np.intp),
        starts - hierarchy.rest[hierarchy.root],
        np.maximum(slow_down * lengths[:, 0], chords),
        lengths[:, 1],
        settings.nudge * float(lengths[:, 0].mean()),
    )


# --- points of the line ---


def _points(allotment: Allotment) -> list[Array]:
    """Return the joints of the line and, when something is beyond the last one, where its bone ends [m]."""
    line, rest = allotment.asked.line, allotment.hierarchy.rest
    beyond = [tip.owner for tip in allotment.tips if _is_beyond(allotment, tip.owner, tip.body)]
    beyond = beyond or [limb.path[0] for limb in allotment.limbs if allotment.carrier(limb) == line[-1]]
    return [*(rest[body] for body in line), *([np.mean(rest[beyond], axis=0)] if beyond else [])]


def _is_beyond(allotment: Allotment, owner: int, body: int) -> bool:
    """Return whether the last bone of the line is to end where the owners of delegated goals are.

    Not if one has a turn: it is the bone's then, and together they say where its joint is.
    """
    owners = [tip.owner for tip in allotment.tips if tip.body == body]
    return body == allotment.asked.line[-1] and body != owner and allotment.asked.turned.keys().isdisjoint(owners)


def _pinned(allotment: Allotment, owner: int, body: int) -> int:
    """Return the point that is brought to a goal: the last bone's end, or the joint of the body that has the goal."""
    line = allotment.asked.line
    return len(line) if _is_beyond(allotment, owner, body) else line.index(body)


def _hanging(allotment: Allotment, points: Sequence[Array]) -> Iterator[_Hanging]:
    """Yield the limbs that the line carries; each pulls the nearer end of the bone that carries it."""
    where = {body: joint for joint, body in enumerate(allotment.asked.line)}
    for limb in allotment.limbs:
        joint = where.get(allotment.carrier(limb))
        if joint is not None:
            start = allotment.hierarchy.rest[limb.path[0]]
            yield _Hanging(limb, joint, _nearest(start, joint, points))


def _nearest(start: Array, joint: int, points: Sequence[Array]) -> int:
    """Return the nearer end of a bone; 0, where the line starts, cannot be pulled."""
    ends = [point for point in (joint, joint + 1) if 0 < point < len(points)]
    return min(ends, key=lambda point: float(np.linalg.norm(points[point] - start)), default=0)


# --- the spine ---


def _pull(allotment: Allotment, hanging: _Hanging, node: int, settings: SolverSettings) -> Pull:
    hierarchy, limb = allotment.hierarchy, hanging.limb
    start = hierarchy.rest[limb.path[0]]
    return Pull(
        node,
        hanging.joint,
        start - hierarchy.rest[allotment.asked.line[hanging.joint]],
        float(np.linalg.norm(hierarchy.rest[limb.body] - start)),
        *hierarchy.lengths(limb.path, limb.body),
        hierarchy.is_foot(limb.body),
        settings.of_limb(hierarchy.names[limb.body]),
    )


def _free(line: Sequence[int], nodes: Sequence[int], settings: SolverSettings, fixed: Collection[int]) -> Flags | None:
    """Return which bones of the line may stretch, shape (joint,), None when none may.

    What hangs on the last body of the line is not moved off it, so that this one keeps its length.
    """
    if not settings.allows_stretch:
        return None
    free = np.zeros(nodes[-1], dtype=np.bool_)
    for first, last in pairwise(nodes):
        ends = line[first + 1 : last + 1]
        free[first : first + len(ends)] = not any(body in fixed for body in ends)
    return free
