"""A pose in the making: how the leaders of a plan are turned, and where forward kinematics has them then."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from .. import quat, rotation
from ..arrays import Array
from .constraints import TINY
from .goals import Goals
from .plan import NONE, Plan

_STILL = rotation.IDENTITY[None]


@dataclass(frozen=True, eq=False)
class State:
    """Rotations and places of the leaders, as far as they have been asked for or decided, from the root outward.

    Rotations and places are found when they are asked for, and kept. So what is decided for a leader, by `turn` and
    `draw`, has to be told before anything is asked of what it carries.
    """

    plan: Plan
    goals: Goals
    shift: Array
    """How far the root moved from where it rests [m], shape (frame or 1, 3)."""
    _wanted: Array
    """The goals' turns as matrices, shape (frame, goal, 3, 3)."""
    _rotations: dict[int, Array]
    _places: dict[int, Array]
    _drawn: dict[int, Array]
    """How far joints are moved from where what carries them holds them, in the frame of that [m]."""

    @classmethod
    def of(cls, plan: Plan, goals: Goals) -> "State":
        """Return the root where its goal wants it, and all else as the goals for turns say."""
        shift, rows = np.zeros((1, 3)), np.flatnonzero(goals.bodies == plan.root)
        if len(rows):
            influence = goals.position_influence[:, rows[0], None]
            shift = influence * (goals.positions[:, rows[0]] - plan.rest[plan.root])
        out = cls(plan, goals, shift, quat.to_matrix(goals.turns), {}, {}, {})
        # The body does not follow what happens to carry its root: a snake's head may.
        out.turn(plan.root, out.wanted(plan.root, _STILL))
        return out

    def __len__(self) -> int:
        return len(self.goals)

    # --- asking ---

    def wanted(self, body: int, carried: Array) -> Array:
        """Return the rotation of a body, shape (frame or 1, 3, 3): as far as it is wanted, else as it is carried."""
        plan = self.plan
        goal = plan.turned.get(body)
        if goal is not None and self._is_whole:
            return self._wanted[:, goal]
        if body in plan.level:
            carried = toward(carried, _STILL, self.goals.position_influence[:, plan.level[body]])
        if goal is None:
            return carried
        return toward(carried, self._wanted[:, goal], self.goals.rotation_influence[:, goal])

    def held(self, body: int, turned: Array) -> Array:
        """Return the rotation of a body within its limits."""
        limited = self.plan.limited
        return turned if limited is None else limited.held(body, self.rotation(self.plan.holders[body]), turned)

    def rotation(self, leader: int) -> Array:
        """Return how a leader is turned, shape (frame or 1, 3, 3)."""
        if leader == NONE:
            return _STILL
        if leader not in self._rotations:
            self._rotations[leader] = self.held(leader, self.wanted(leader, self.rotation(self.plan.above[leader])))
        return self._rotations[leader]

    def place(self, leader: int) -> Array:
        """Return where a leader is [m], shape (frame or 1, 3)."""
        if leader not in self._places:
            plan = self.plan
            above = plan.above[leader]
            if leader == plan.root:
                self._places[leader] = plan.rest[leader] + self.shift
            elif above == NONE:
                self._places[leader] = plan.rest[leader][None]
            else:
                way = plan.ways[leader]
                if leader in self._drawn:
                    way = way + self._drawn[leader]
                self._places[leader] = self.place(above) + rotation.apply(self.rotation(above), way)
        return self._places[leader]

    @property
    def rotations(self) -> Array:
        """Of all leaders, shape (frame, leader, 3, 3)."""
        return stacked([self.rotation(leader) for leader in self.plan.order], len(self))

    @property
    def stretched(self) -> Array | None:
        """How far the leaders' joints are moved, shape (frame, leader, 3), None where none may move."""
        if not self.plan.stretched:
            return None
        none = np.zeros((1, 3))
        return stacked([self._drawn.get(leader, none) for leader in self.plan.order], len(self))

    @property
    def shift_from_parent(self) -> Array:
        """How far the root moved from where its parents hold it, turned as they are, shape (frame or 1, 3)."""
        plan, above = self.plan, self.plan.above[self.plan.root]
        if above == NONE:
            return self.shift
        turned = self.rotation(above)
        held = self.place(above) + rotation.apply(turned, plan.rest[plan.root] - plan.rest[above])
        return rotation.apply(rotation.transposed(turned), self.place(plan.root) - held)

    @cached_property
    def _is_whole(self) -> bool:
        """Whether all goals for turns count in full."""
        return bool((self.goals.rotation_influence == 1.0).all())

    # --- deciding ---

    def turn(self, joint: int, turned: Array) -> None:
        """Turn a joint, shape (frame, 3, 3)."""
        self._rotations[joint] = turned

    def draw(self, joint: int, end: int, factor: Array, segment: Array) -> None:
        """Move the joint to which a bone leads as the bone gets longer or shorter.

        Args:
            joint: Where the bone starts.
            end: The body whose joint it leads to.
            factor: By what factor it is longer, shape (frame,).
            segment: The bone at rest [m], shape (3,).
        """
        longer, above = (factor - 1.0)[:, None] * segment, self.plan.above[end]
        if above != joint:
            own = np.matmul(rotation.transposed(self.rotation(above)), self.rotation(joint))
            longer = rotation.apply(own, longer)
        self._drawn[end] = longer

    def bring(self, body: int, place: Array, most: Array | float) -> None:
        """Move the joint of a body toward a place, from where its limb has brought it.

        Args:
            body: The body.
            place: Where it shall be [m], shape (frame, 3).
            most: How far it moves at most [m], shape (frame,) or one for all.
        """
        plan, above = self.plan, self.plan.above[body]
        drawn = self._drawn.get(body, np.zeros((1, 3)))
        held = plan.rest[body] - plan.rest[above] + drawn
        way = rotation.apply(rotation.transposed(self.rotation(above)), place - self.place(above)) - held
        self._drawn[body] = drawn + np.minimum(most / np.maximum(quat.length(way), TINY), 1.0)[:, None] * way

    # --- other states ---

    def moved(self, way: Array) -> "State":
        """Return the state with the root moved on [m], shape (frame, 3)."""
        return replace(self, shift=self.shift + way, _places={})

    def supposing(self, turns: dict[int, Array]) -> "State":
        """Return the state with joints turned that may still turn further: what is asked of it is not kept here."""
        return replace(self, _rotations=self._rotations | turns, _places=dict(self._places))


def stacked(parts: Sequence[Array], frames: int) -> Array:
    """Return arrays of which some hold for all frames as one, shapes (frame or 1, ...) to (frame, part, ...)."""
    out = np.empty((frames, len(parts), *parts[0].shape[1:]))
    for i, part in enumerate(parts):
        out[:, i] = part
    return out


def toward(carried: Array, wanted: Array, share: Array) -> Array:
    """Return rotations part of the way to others, shape (frame, ..., 3, 3); those at an end are it to the bit."""
    part = share[..., None, None]
    ends = np.where(part == 0.0, carried, wanted)
    between = (share != 0.0) & (share != 1.0)
    if not between.any():
        return ends
    mixed = quat.to_matrix(quat.slerp(quat.from_matrix(carried), quat.from_matrix(wanted), share))
    return np.where(between[..., None, None], mixed, ends)
