"""Carrying a motion from deform bones to the controls that pose them.

A control turns as the bone turns that follows it, so where it shall be is known: its place in the neutral pose, turned
and moved like the bone. What its channels must hold depends on what carries it, which mechanisms between controls may
decide in any way. That is seen rather than modelled: Blender evaluates the channels, and where a control came to lie
tells what carried it. With the carriers known, and what copies whose turn, the first answer is exact on plain trees; on
others each further one settles at least one more level.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from .. import quat
from ..arrays import Array, Flags, Indices
from ..character.frame import Placement
from ..skeleton import Skeleton
from . import copying, root_motion
from .copying import Copy
from .links import NONE, Links
from .motion import Motion
from .plan import Plan
from .root_motion import Travel

STRAIGHT = 0.05
"""A limb whose middle joint lies nearer to its line than this share of its length lets its rest say where it bends."""


@dataclass(frozen=True)
class Handle:
    """One control and what it follows."""

    control: int
    """Bone."""
    link: int
    """The link whose turn it has."""
    aim: int = NONE
    """The link that it points to, where it turns several bones on the way there; NONE otherwise."""
    placed: bool = False
    """Whether it is moved too, so that the bone of its link comes to its place."""
    limb: tuple[int, int, int] | None = None
    """For what a middle joint points to the three links of its limb: it is moved alone."""


@dataclass(frozen=True, eq=False)
class Seen:
    """Where bones are as Blender evaluates them, armature space."""

    rotations: Array
    """Of the handles' controls, shape (frame, handle, 4)."""
    positions: Array
    """Their heads, shape (frame, handle, 3)."""
    turned: Array
    """Rotations of the links' bones, shape (frame, link, 4)."""
    points: Array
    """Heads of the links' bones, shape (frame, link, 3)."""


@dataclass(frozen=True, eq=False)
class Values:
    """What the channels of controls hold."""

    rotations: Array
    """Relative to what carries the control, in its own rest frame, shape (frame, handle, 4)."""
    locations: Array
    """Along the axes of its location, shape (frame, handle, 3)."""


@dataclass(frozen=True, eq=False)
class Handling:
    """What is prepared once for a rig with controls."""

    handles: tuple[Handle, ...]
    carrier: Indices
    """Handle that carries each handle, NONE where none does, shape (handle,)."""
    turns_along: Flags
    """Whether a handle turns as what carries it does, or is only moved by that, shape (handle,)."""
    axes: Array
    """Along which locations count in the neutral pose, shape (handle, 4)."""
    neutral: Seen
    """One frame of the rig with all controls at rest and all switches set."""
    copies: Mapping[int, Copy] = field(default_factory=dict[int, Copy])
    """What handles copy of the turns of others."""

    def start(self, frames: int) -> Values:
        """Return the channels of the neutral pose."""
        count = len(self.handles)
        return Values(quat.identity(frames, count), np.zeros((frames, count, 3)))

    @property
    def placed(self) -> Flags:
        """Which handles are moved, shape (handle,)."""
        return np.array([handle.placed or handle.limb is not None for handle in self.handles], dtype=bool)


@dataclass(frozen=True, eq=False)
class Goal:
    """Where controls shall be, armature space."""

    rotations: Array
    """Shape (frame, handle, 4)."""
    positions: Array
    """Shape (frame, handle, 3)."""
    points: Array
    """Where the links' bones shall be, shape (frame, link, 3)."""


def without(motion: Motion, travel: Travel, pivot: Array) -> Motion:
    """Return a motion as it is seen by something that travels along; ``pivot`` is the place of the hips at rest."""
    turns = quat.multiply(quat.conjugate(travel.turns)[:, None], motion.turns)
    return Motion(turns, root_motion.without(travel, motion.points, pivot), motion.unreached)


def along(motion: Motion, travel: Travel, pivot: Array) -> Motion:
    """Return the opposite of `without`."""
    ground = pivot * np.array([1.0, 1.0, 0.0])
    points = ground + travel.points[:, None] + quat.rotate(travel.turns[:, None], motion.points - ground)
    return Motion(quat.multiply(travel.turns[:, None], motion.turns), points, motion.unreached)


def at(motion: Motion, places: Array) -> Motion:
    """Return a motion at ``places`` between its frames, shape (n,)."""
    low = np.minimum(places.astype(np.intp), len(motion.turns) - 1)
    high = np.minimum(low + 1, len(motion.turns) - 1)
    part = (places - low)[:, None]
    points = motion.points[low] + part[..., None] * (motion.points[high] - motion.points[low])
    return replace(motion, turns=quat.slerp(motion.turns[low], motion.turns[high], part), points=points)


def aims(links: Links, controlled: Flags) -> Indices:
    """Return for each link that has a control the next one that has, where links between them have none.

    Args:
        links: Of the pair.
        controlled: Which links have controls, shape (link,).

    Returns:
        NONE for all others, shape (link,).
    """
    out = np.full(len(links), NONE)
    for i in np.flatnonzero(controlled):
        after, steps = int(links.after[i]), 0
        while after != NONE and not controlled[after]:
            after, steps = int(links.after[after]), steps + 1
        out[i] = after if steps else NONE
    return out


def goal(handling: Handling, plan: Plan, motion: Motion) -> Goal:
    """Return where controls shall be.

    Args:
        handling: Of the rig.
        plan: Of the pair.
        motion: Of the target, without what its root bone or object carries if those are not to be seen.
    """
    back, links, skeleton = plan.target.local_to_character.inverse(), plan.links, plan.target.skeleton
    turns, points = back.turns(motion.turns), back.points(motion.points)
    rest, neutral = back.points(plan.target_rest), handling.neutral
    shape = (len(turns), len(handling.handles))
    rotations, positions = np.empty((*shape, 4)), np.empty((*shape, 3))
    # What the neutral pose has turned already is no part of a turn from rest.
    back_to_rest = quat.multiply(skeleton.rest_rotations[links.target], quat.conjugate(neutral.turned[0]))
    for i, handle in enumerate(handling.handles):
        turn = turns[:, handle.link]
        if handle.aim != NONE:
            along = quat.rotate(turn, rest[handle.aim] - rest[handle.link])
            turn = quat.multiply(quat.between(along, points[:, handle.aim] - points[:, handle.link]), turn)
        turn = quat.multiply(turn, back_to_rest[handle.link])
        rotations[:, i] = quat.multiply(turn, neutral.rotations[0, i])
        away = neutral.positions[0, i] - neutral.points[0, handle.link]
        positions[:, i] = points[:, handle.link] + quat.rotate(turn, away)
        if handle.limb is not None:
            positions[:, i] = _pole(points[:, handle.limb], turn, neutral.points[0, handle.limb], away)
            rotations[:, i] = neutral.rotations[0, i]
    turned = quat.multiply(rotations, quat.conjugate(neutral.rotations))
    for i, handle in enumerate(handling.handles):
        if handle.placed:
            positions[:, i] = points[:, handle.link] - _held(handling, turned, i)
    return Goal(rotations, positions, points)


def _held(handling: Handling, turned: Array, top: int) -> Array:
    """Return the way from a placed control to the bone that shall come to a place, shape (frame, 3).

    What turns that bone by itself may hang on the control over others, which bend the way.

    Args:
        handling: Of the rig.
        turned: Turns of the controls from the neutral pose, shape (frame, handle, 4).
        top: The control.
    """
    link, neutral = handling.handles[top].link, handling.neutral
    turning = [i for i, h in enumerate(handling.handles) if h.link == link and i != top and h.limb is None]
    line = turning[:1]
    while line and line[-1] != top and handling.carrier[line[-1]] != NONE and len(line) <= len(handling.handles):
        line.append(int(handling.carrier[line[-1]]))
    if not line or line[-1] != top:
        line = [top]
    ends = [neutral.points[0, link], *(neutral.positions[0, i] for i in line)]
    steps = [quat.rotate(turned[:, i], end - start) for i, end, start in zip(line, ends[:-1], ends[1:], strict=True)]
    return np.sum(steps, axis=0)


def _pole(limb: Array, turn: Array, rest: Array, away: Array) -> Array:
    """Return where a middle joint shall point to, shape (frame, 3).

    Args:
        limb: Places of its three joints, shape (frame, 3, 3).
        turn: Of its upper bone, shape (frame, 4).
        rest: Places of the joints in the neutral pose, shape (3, 3).
        away: From the upper joint to what it points to there, shape (3,).
    """
    line = quat.unit(limb[:, 2] - limb[:, 0])
    bend = _bend(limb, line)
    usual = quat.rotate(turn, away + rest[0] - rest[1])
    usual = quat.unit(usual - quat.dot(usual, line)[:, None] * line)
    sure = _sure(limb, bend)[:, None]
    way = quat.unit(sure * quat.unit(bend) + (1.0 - sure) * usual)
    return limb[:, 1] + np.linalg.norm(away + rest[0] - rest[1]) * way


def solve(handling: Handling, goal: Goal, values: Values, seen: Seen) -> Values:
    """Return channels that bring controls nearer to their goal: to it, if what carries them is as it seems.

    Args:
        handling: Of the rig.
        goal: Where controls shall be.
        values: Channels that were evaluated.
        seen: Where that has led.
    """
    carried = quat.multiply(seen.rotations, quat.conjugate(values.rotations))
    turned, positions = carried.copy(), seen.positions.copy()
    ours = np.flatnonzero(handling.carrier != NONE)
    above = handling.carrier[ours]
    moves = quat.multiply(goal.rotations[:, above], quat.conjugate(seen.rotations[:, above]))
    turned[:, ours] = np.where(
        handling.turns_along[ours][:, None], quat.multiply(moves, carried[:, ours]), carried[:, ours]
    )
    starts = seen.positions[:, above]
    ends = np.where(handling.placed[above][:, None], goal.positions[:, above], starts)
    positions[:, ours] = ends + quat.rotate(moves, seen.positions[:, ours] - starts)
    rotations = quat.multiply(quat.conjugate(turned), goal.rotations)
    for i, handle in enumerate(handling.handles):
        if handle.limb is not None:
            rotations[:, i] = quat.IDENTITY
    rotations = copying.parted(handling.copies, values.rotations, rotations)
    start = quat.multiply(turned, quat.conjugate(handling.neutral.rotations))
    axes = quat.multiply(start, handling.axes)
    steps = quat.rotate(quat.conjugate(axes), goal.positions - positions)
    locations = np.where(handling.placed[:, None], values.locations + steps, values.locations)
    return Values(rotations, locations)


def corrected(handling: Handling, goal: Goal, seen: Seen) -> Goal:
    """Return a goal that is moved by what the bones of placed controls were off when the controls were at ``seen``."""
    positions = goal.positions.copy()
    for i, handle in enumerate(handling.handles):
        if handle.placed:
            positions[:, i] = seen.positions[:, i] + goal.points[:, handle.link] - seen.points[:, handle.link]
        if handle.limb is not None:
            positions[:, i] = _swivelled(goal.points[:, handle.limb], seen.points[:, handle.limb], goal.positions[:, i])
    return replace(goal, positions=positions)


def _swivelled(wanted: Array, seen: Array, pole: Array) -> Array:
    """Return what a middle joint points to, turned about the limb's line as far as the joint is off, shape (frame, 3).

    Args:
        wanted: Where the limb's three joints shall be, shape (frame, 3, 3).
        seen: Where they are.
        pole: What the middle joint points to.
    """
    line, angles = _swivel(wanted, seen)
    return wanted[:, 0] + quat.rotate(quat.from_axis_angle(line, angles), pole - wanted[:, 0])


def _swivel(wanted: Array, seen: Array) -> tuple[Array, Array]:
    """Return the line of a limb, shape (frame, 3), and by how much its middle joint is off about it [rad].

    The angle, shape (frame,), is less for a limb that is nearly straight: then it means little.
    """
    line = quat.unit(wanted[:, 2] - wanted[:, 0])
    there, here = _bend(wanted, line), _bend(seen, line)
    angles = np.arctan2(quat.dot(quat.cross(here, there), line), quat.dot(here, there))
    return line, angles * _sure(wanted, there)


def _bend(limb: Array, line: Array) -> Array:
    """Return how far the middle joint of a limb is off a line through its first, shape (frame, 3)."""
    way = limb[:, 1] - limb[:, 0]
    return way - quat.dot(way, line)[:, None] * line


def _sure(limb: Array, bend: Array) -> Array:
    """Return how far a bend tells where a limb bends, 0 … 1, shape (frame,)."""
    length = quat.length(limb[:, 1] - limb[:, 0]) + quat.length(limb[:, 2] - limb[:, 1])
    return np.clip(quat.length(bend) / (STRAIGHT * length), 0.0, 1.0)


@dataclass(frozen=True)
class Miss:
    """How far controls are from where they shall be, at most."""

    turn: float
    """[rad]."""
    swivel: float
    """Middle joints of limbs, about the lines of these [rad]."""
    place: float
    """The bones whose controls are moved, in armature space."""


def miss(handling: Handling, goal: Goal, seen: Seen) -> Miss:
    """Return how far controls are from their goal."""
    turned = [i for i, handle in enumerate(handling.handles) if handle.limb is None]
    placed = [handle.link for handle in handling.handles if handle.placed]
    limbs = [handle.limb for handle in handling.handles if handle.limb is not None]
    turns = quat.angle_between(goal.rotations[:, turned], seen.rotations[:, turned])
    places = quat.length(goal.points[:, placed] - seen.points[:, placed])
    swivels = [np.abs(_swivel(goal.points[:, limb], seen.points[:, limb])[1]).max() for limb in limbs]
    return Miss(float(turns.max(initial=0.0)), float(max(swivels, default=0.0)), float(places.max(initial=0.0)))


def shown(plan: Plan, seen: Seen, moves: Array | None = None) -> Motion:
    """Return what was seen as a motion of the target.

    Args:
        plan: Of the pair.
        seen: Its bones.
        moves: How the object moved meanwhile, from its space to that space at rest, shape (frame, 4, 4).
    """
    skeleton: Skeleton = plan.target.skeleton
    ours: Placement = plan.target.local_to_character
    turns = quat.multiply(seen.turned, quat.conjugate(skeleton.rest_rotations[plan.links.target]))
    points = seen.points
    if moves is not None:
        turns = quat.multiply(quat.from_matrix(moves[:, :3, :3])[:, None], turns)
        points = np.einsum("fij,fbj->fbi", moves[:, :3, :3], points) + moves[:, None, :3, 3]
    return Motion(ours.turns(turns), ours.points(points))
