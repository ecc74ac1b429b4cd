"""The particle IK solver, Hecker 2008 §4.3: from pose goals to the pose that meets them, as well as it can.

    root -> root-relative rest pose -> spine phase -> limb phase -> the goals' own turns

Goals for turns pose the bodies by forward kinematics: that is the rest pose from which the spine and the limbs set out.
Where a goal for a place decides where a bone points, one for its turn is left to decide its twist. The pose depends on
the goals of its frame alone, so all frames are one batch.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .. import quat, rotation
from ..arrays import Array
from . import branching, collision, constraints, limb_phase, limit_phase, spine_phase, stretching
from .collision import Obstacles
from .constraints import TINY
from .goals import Goals
from .plan import NONE, Nudge, Plan, Trunk, Wave
from .planning import prepare
from .spine import Rest

__all__ = ["NONE", "BodyPose", "Plan", "prepare", "solve"]


_STILL = rotation.IDENTITY[None]


@dataclass(frozen=True, eq=False)
class BodyPose:
    """A character's pose over a clip, character frame."""

    rotations: Array
    """Turn of each leader of the plan from its rest, as matrices, shape (frame, leader, 3, 3)."""
    moved: Array
    """How far the root moved from where it rests [m], shape (frame or 1, 3)."""
    shift: Array
    """How far the root moved from where its parents hold it, in their frame [m], shape (frame, 3)."""
    plan: Plan
    stretched: Array | None = None
    """How far the leaders' joints are moved from where what carries them holds them, in the frame of that [m], shape
    (frame, leader, 3); None where no bone may stretch."""

    @cached_property
    def turns(self) -> Array:
        """Turn of each body from its rest, shape (frame, body, 4)."""
        return quat.from_matrix(self.rotations)[:, self.plan.led_by]

    @cached_property
    def places(self) -> Array:
        """Of the leaders' joints [m], shape (frame, leader, 3)."""
        plan = self.plan
        # From what carries it to each leader; the root is where it was brought, whatever carries it.
        offsets = plan.offsets if self.stretched is None else plan.offsets + self.stretched
        steps = rotation.apply(self.rotations.take(plan.carriers, axis=1), offsets)
        steps[:, plan.anchors] = plan.rest[[plan.order[i] for i in plan.anchors]]
        steps[:, plan.order.index(plan.root)] += self.moved
        return np.matmul(plan.lines, steps)

    @cached_property
    def positions(self) -> Array:
        """Of the bodies' joints [m], shape (frame, body, 3)."""
        plan = self.plan
        away = rotation.apply(self.rotations[:, plan.led_by], plan.rest - plan.rest[plan.leaders])
        return self.places[:, plan.led_by] + away


def solve(plan: Plan, goals: Goals) -> BodyPose:
    """Return the pose that meets the goals."""
    state = _State(plan, goals)
    if plan.nudge is not None:
        state.give_way(plan.nudge)
    if plan.trunk is not None:
        state.bend(plan.trunk)
    for wave in plan.waves:
        state.reach(wave)
    frames = len(goals)
    rotations = _together([state.rotation(leader) for leader in plan.order], frames)
    shift = np.broadcast_to(state.shift_from_parent(), (frames, 3))
    return BodyPose(rotations, state.shift, shift, plan, state.stretched())


def _together(parts: Sequence[Array], frames: int) -> Array:
    """Return arrays of which some hold for all frames as one, shapes (frame or 1, ...) to (frame, part, ...)."""
    out = np.empty((frames, len(parts), *parts[0].shape[1:]))
    for i, part in enumerate(parts):
        out[:, i] = part
    return out


class _State:
    """A pose in the making: rotations and places of the leaders, from the root outward."""

    def __init__(self, plan: Plan, goals: Goals) -> None:
        self.plan = plan
        self.goals = goals
        self._wanted = quat.to_matrix(goals.turns)
        self._whole = bool((goals.rotation_influence == 1.0).all())
        self._rotations: dict[int, Array] = {}
        self._places: dict[int, Array] = {}
        self._drawn: dict[int, Array] = {}
        """How far joints are moved from where what carries them holds them, in the frame of that."""
        self.shift = np.zeros((1, 3))
        rows = np.flatnonzero(goals.bodies == plan.root)
        if len(rows):
            influence = goals.position_influence[:, rows[0], None]
            self.shift = influence * (goals.positions[:, rows[0]] - plan.rest[plan.root])
        # The body does not follow what happens to carry its root: a snake's head may.
        self._rotations[plan.root] = self._turned(plan.root, _STILL)

    def give_way(self, nudge: Nudge) -> None:
        """Let the root go a little of the way that limbs which hang on it fall short of."""
        root, goals = self.plan.root, self.goals
        starts = rotation.apply(self._rotations[root][:, None], nudge.starts) + self.place(root)[:, None]
        away = goals.positions.take(nudge.goals, axis=1) - starts
        distance = quat.length(away)
        error = np.maximum(distance - nudge.reach, 0.0) + np.minimum(distance - nudge.least, 0.0)
        share = goals.position_influence.take(nudge.goals, axis=1) * error / np.maximum(distance, TINY)
        way = constraints.together(share[..., None] * away)
        self.shift = self.shift + way / (1.0 + quat.length(way) / nudge.most)[:, None]
        self._places.clear()

    def bend(self, trunk: Trunk) -> None:
        """Pose the spine."""
        goals, first = self.goals, trunk.joints[0]
        carried = self.rotation(self.plan.above[first])
        outer = carried[:, None]
        base: dict[int, Array] = {}
        for joint in (*trunk.joints, *([] if trunk.last == NONE else [trunk.last])):
            carried = base[joint] = self._turned(joint, carried)
        back = rotation.transposed(outer)
        rest = trunk.spine.still
        if any(joint in self.plan.turned for joint in trunk.joints):
            rest = Rest(trunk.spine, np.matmul(back, _together([base[j] for j in trunk.joints], len(goals))))
        nodes, frames = len(trunk.spine.nodes), len(goals)
        pins, pinned = np.zeros((frames, nodes, 3)), np.zeros((frames, nodes))
        start = self.place(first)
        for pin in trunk.pins:
            # A goal that is delegated stands off what it is given to, turned as that shall be.
            pins[:, pin.node] = goals.positions[:, pin.goal] - rotation.apply(base[pin.body], pin.offset) - start
            pinned[:, pin.node] = goals.position_influence[:, pin.goal]
        pulls, counts, held = list(trunk.pulls), trunk.spine.counts, np.zeros(frames)
        if trunk.last in self.plan.turned:
            held = goals.rotation_influence[:, self.plan.turned[trunk.last]]
        wanted = spine_phase.Wanted(
            rotation.apply(back, pins),
            pinned,
            rest.drawn_in(rotation.apply(back, goals.positions[:, pulls] - start[:, None])),
            counts * goals.position_influence[:, pulls],
            held,
        )
        bent = spine_phase.solve(rest, wanted)
        turns = np.matmul(outer, bent.turns)
        for i, joint in enumerate(trunk.joints):
            self._rotations[joint] = self._held(joint, turns[:, i])
        if bent.factors is not None:
            for body, i in trunk.drawn.items():
                self._draw(trunk.joints[i], body, bent.factors[:, i], trunk.spine.segments[i])

    def reach(self, wave: Wave) -> None:
        """Pose limbs."""
        goals, starts, frames = self.goals, [limb.joints[0] for limb in wave.limbs], len(self.goals)
        carried = _together([self.rotation(self.plan.above[start]) for start in starts], frames)
        places = _together([self.place(start) for start in starts], frames)
        along = rotation.apply(rotation.transposed(carried), goals.positions.take(wave.goals, axis=1) - places)
        influence = goals.position_influence.take(wave.goals, axis=1)
        factors = None
        if wave.stem is not None:
            own = branching.solve(wave.stem, along, influence)
            if wave.elastic is not None:
                factors = stretching.of_stem(wave.elastic, wave.stem, own, along, influence)
        else:
            if (influence != 1.0).any():
                rest = wave.chains.segments.sum(axis=1)
                part = influence[..., None]
                along = np.where(part == 1.0, along, rest + part * (along - rest))
            if wave.elastic is None:
                own = limb_phase.solve(wave.chains, along, influence)
            else:
                own, factors = stretching.solve(wave.elastic, along, influence)
        turned = np.matmul(carried[:, :, None], own)
        if wave.obstacles is not None:
            turned = self._freed(wave, wave.obstacles, places, turned, factors)
        for limb, first, i in wave.joints:
            self._rotations[limb] = turned[:, first, i]
        self._twist(wave, turned)
        if wave.limited is not None:
            for joint, limb, i in wave.joints:
                turned[:, limb, i] = self._rotations[joint]
            turned = limit_phase.hold(wave.limited, carried, turned, factors)
            for joint, limb, i in wave.joints:
                own = turned[:, limb, i]
                self._rotations[joint] = self._held(joint, own) if joint in self.plan.astray else own
        if wave.elastic is not None and factors is not None:
            for link in wave.elastic.links:
                segment = wave.chains.segments[link.limb, link.place]
                self._draw(link.joint, link.end, factors[:, link.limb, link.place], segment)

    def _draw(self, joint: int, end: int, factor: Array, segment: Array) -> None:
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

    def stretched(self) -> Array | None:
        """Return how far the leaders' joints are moved, shape (frame, leader, 3), None where no bone may stretch."""
        if not self.plan.stretched:
            return None
        none = np.zeros((1, 3))
        return _together([self._drawn.get(leader, none) for leader in self.plan.order], len(self.goals))

    def _freed(self, wave: Wave, obstacles: Obstacles, starts: Array, turned: Array, factors: Array | None) -> Array:
        """Return limbs out of what they collide with."""
        # Where that is may still change within its limits, so what is found out about it here is not kept.
        rotations, places = self._rotations, self._places
        self._rotations = rotations | {joint: turned[:, limb, i] for joint, limb, i in wave.joints}
        self._places = dict(places)
        around, rest = obstacles.around, self.plan.rest
        ends = np.empty((2, len(turned), len(around.bodies), 3))
        for i, leader in enumerate(self.plan.leaders[around.bodies].tolist()):
            for end, points in zip(ends, (around.starts, around.ends), strict=True):
                away = rotation.apply(self.rotation(leader), points[i] - rest[leader])
                end[:, i] = self.place(leader) + away
        self._rotations, self._places = rotations, places
        if factors is None:
            return collision.free(obstacles, starts, turned, (ends[0], ends[1]))
        # Longer bones are where larger turns lead.
        longer = factors[..., None, None]
        return collision.free(obstacles, starts, longer * turned, (ends[0], ends[1])) / longer

    def _twist(self, wave: Wave, turned: Array) -> None:
        """Let joints with turns of their own twist as these say, and point where they were solved to."""
        own = [place for place in wave.joints if place[0] in self.plan.turned]
        if not own:
            return
        limbs, places = [limb for _, limb, _ in own], [place for _, _, place in own]
        solved = turned[:, limbs, places]
        wanted = _together([self._turned(joint, solved[:, i]) for i, (joint, _, _) in enumerate(own)], len(turned))
        along = wave.chains.directions[limbs, places]
        bent = rotation.between(rotation.apply(wanted, along), rotation.apply(solved, along))
        twisted = np.matmul(bent, wanted)
        for i, (joint, _, _) in enumerate(own):
            self._rotations[joint] = twisted[:, i]

    def _turned(self, body: int, carried: Array) -> Array:
        """Return the rotation of a body: as it is wanted, as far as it is, else as it is carried."""
        plan = self.plan
        goal = plan.turned.get(body)
        if goal is not None and self._whole:
            return self._wanted[:, goal]
        if body in plan.level:
            carried = _toward(carried, _STILL, self.goals.position_influence[:, plan.level[body]])
        if goal is None:
            return carried
        return _toward(carried, self._wanted[:, goal], self.goals.rotation_influence[:, goal])

    def shift_from_parent(self) -> Array:
        """Return how far the root moved from where its parents hold it, turned as they are, shape (frame or 1, 3)."""
        plan, above = self.plan, self.plan.above[self.plan.root]
        if above == NONE:
            return self.shift
        turned = self.rotation(above)
        held = self.place(above) + rotation.apply(turned, plan.rest[plan.root] - plan.rest[above])
        return rotation.apply(rotation.transposed(turned), self.place(plan.root) - held)

    def rotation(self, leader: int) -> Array:
        """Return how a leader is turned, shape (frame or 1, 3, 3)."""
        if leader == NONE:
            return _STILL
        if leader not in self._rotations:
            self._rotations[leader] = self._held(leader, self._turned(leader, self.rotation(self.plan.above[leader])))
        return self._rotations[leader]

    def _held(self, body: int, turned: Array) -> Array:
        """Return the rotation of a body within its limits."""
        limited = self.plan.limited
        return turned if limited is None else limited.held(body, self.rotation(self.plan.above[body]), turned)

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
                rest = plan.rest[leader] - plan.rest[above]
                away = rotation.apply(self.rotation(above), rest + self._drawn.get(leader, 0.0))
                self._places[leader] = self.place(above) + away
        return self._places[leader]


def _toward(carried: Array, wanted: Array, share: Array) -> Array:
    """Return rotations part of the way to others, shape (frame, 3, 3); those at an end are it to the bit."""
    part = share[:, None, None]
    ends = np.where(part == 0.0, carried, wanted)
    between = (share != 0.0) & (share != 1.0)
    if not between.any():
        return ends
    mixed = quat.to_matrix(quat.slerp(quat.from_matrix(carried), quat.from_matrix(wanted), share))
    return np.where(between[:, None, None], mixed, ends)
