"""The particle IK solver, Hecker 2008 §4.3: from pose goals to the pose that meets them, as well as it can.

    root -> root-relative rest pose -> spine phase -> limb phase -> the goals' own turns

Goals for turns pose the bodies by forward kinematics: that is the rest pose from which the spine and the limbs set out.
Where a goal for a place decides where a bone points, one for its turn is left to decide its twist. The pose depends on
the goals of its frame alone, so all frames are one batch.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .. import quat, rotation
from ..arrays import Array
from . import (
    base_phase,
    branching,
    collision,
    constraints,
    detached,
    limb_phase,
    limit_phase,
    spine_phase,
    stretching,
)
from .collision import Obstacles
from .constraints import TINY
from .goals import Goals
from .plan import NONE, Nudge, Plan, Trunk, Wave
from .planning import prepare
from .spine import Rest
from .state import State, stacked, toward

ROUNDS = 2
"""How often bodies that several goals are delegated to are looked at anew, as they have been turned."""

__all__ = ["NONE", "BodyPose", "Plan", "prepare", "solve"]


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
    (frame, leader, 3); None where none may move."""

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
        steps[:, plan.anchors] = plan.anchored
        steps[:, plan.led_by[plan.root]] += self.moved
        return np.matmul(plan.lines, steps)

    @cached_property
    def positions(self) -> Array:
        """Of the bodies' joints [m], shape (frame, body, 3)."""
        plan = self.plan
        away = rotation.apply(self.rotations.take(plan.led_by, axis=1), plan.away)
        return self.places.take(plan.led_by, axis=1) + away

    @cached_property
    def shifts(self) -> Array | None:
        """How far `Plan.stretched` are moved from where their parents hold them, in the frames of these [m].

        Shape (frame, n, 3); None where none may move.
        """
        plan = self.plan
        if self.stretched is None:
            return None
        out = self.stretched.take(plan.led_by[list(plan.stretched)], axis=1)
        for body, parent in plan.detached.items():
            away, rest = self.positions[:, body], plan.rest[body]
            if parent != NONE:
                back = rotation.transposed(self.rotations[:, plan.led_by[parent]])
                away, rest = rotation.apply(back, away - self.positions[:, parent]), rest - plan.rest[parent]
            out[:, plan.stretched.index(body)] = away - rest
        return out


def solve(plan: Plan, goals: Goals) -> BodyPose:
    """Return the pose that meets the goals."""
    state = State.of(plan, goals.with_means(plan.means))
    if plan.nudge is not None:
        state = _nudged(state, plan.nudge)
    if plan.trunk is not None:
        _bend(state, plan.trunk)
    for wave in plan.waves:
        _reach(state, wave)
    shift = np.broadcast_to(state.shift_from_parent, (len(goals), 3))
    return BodyPose(state.rotations, state.shift, shift, plan, state.stretched)


# --- the root ---


def _nudged(state: State, nudge: Nudge) -> State:
    """Let the root go a little of the way that limbs which hang on it fall short of."""
    root, goals = state.plan.root, state.goals
    starts = rotation.apply(state.rotation(root)[:, None], nudge.starts) + state.place(root)[:, None]
    away = goals.positions.take(nudge.goals, axis=1) - starts
    distance = quat.length(away)
    error = np.maximum(distance - nudge.reach, 0.0) + np.minimum(distance - nudge.least, 0.0)
    share = goals.position_influence.take(nudge.goals, axis=1) * error / np.maximum(distance, TINY)
    way = constraints.together(share[..., None] * away)
    return state.moved(way / (1.0 + quat.length(way) / nudge.most)[:, None])


# --- the spine ---


def _bend(state: State, trunk: Trunk) -> None:
    """Pose the spine."""
    carried = state.rotation(state.plan.above[trunk.joints[0]])
    base = _as_carried(state, trunk, carried)
    back = rotation.transposed(carried[:, None])
    rest = trunk.spine.still
    if any(joint in state.plan.turned for joint in trunk.joints):
        rest = Rest(trunk.spine, np.matmul(back, stacked([base[j] for j in trunk.joints], len(state))))
    wanted = _wanted_of(state, trunk, rest, base, back)
    bent = spine_phase.solve(rest, wanted)
    turns = np.matmul(carried[:, None], bent.turns)
    for _ in range(ROUNDS if trunk.shares else 0):
        base |= {joint: turns[:, i] for i, joint in enumerate(trunk.joints)}
        wanted = _wanted_of(state, trunk, rest, base, back)
        bent = spine_phase.solve(rest, wanted)
        turns = np.matmul(carried[:, None], bent.turns)
    for i, joint in enumerate(trunk.joints):
        turned = turns[:, i]
        if wanted.counts is not None:
            # What nothing is wanted of is carried along, as beyond the spine's end. What counts in part has been made
            # little of as a place, so that here it may count for more.
            alone = state.wanted(joint, state.rotation(state.plan.above[joint]))
            turned = toward(alone, turned, 1.0 - (1.0 - wanted.count_of_bone(trunk.spine, i)) ** 2)
        state.turn(joint, state.held(joint, turned))
    if bent.factors is not None:
        for body, i in trunk.drawn.items():
            state.draw(trunk.joints[i], body, bent.factors[:, i], trunk.spine.segments[i])


def _as_carried(state: State, trunk: Trunk, carried: Array) -> dict[int, Array]:
    """Return the rotations of the spine's bodies by the goals for turns alone, each (frame or 1, 3, 3)."""
    base: dict[int, Array] = {}
    for joint in (*trunk.joints, *([] if trunk.last == NONE else [trunk.last])):
        carried = base[joint] = state.wanted(joint, carried)
    return base


def _wanted_of(state: State, trunk: Trunk, rest: Rest, base: Mapping[int, Array], back: Array) -> spine_phase.Wanted:
    """Return what goals want of the spine, in the frame of what carries it; ``back`` leads to that."""
    goals, plan, start = state.goals, state.plan, state.place(trunk.joints[0])
    nodes, frames = len(trunk.spine.nodes), len(goals)
    pins, pinned = np.zeros((frames, nodes, 3)), np.zeros((frames, nodes))
    for node, own in trunk.pinned.items():
        # A goal that is delegated stands off what it is given to, turned as that shall be.
        places = [goals.positions[:, pin.goal] - rotation.apply(base[pin.body], pin.offset) - start for pin in own]
        counts = goals.position_influence[:, [pin.goal for pin in own]]
        parts = constraints.shares(counts)[..., None]
        pins[:, node] = places[0] if len(own) == 1 else (parts * np.stack(places, axis=1)).sum(axis=1)
        pinned[:, node] = counts.max(axis=1)
    pulls, counts, held = list(trunk.pulls), trunk.spine.counts, np.zeros(frames)
    if trunk.last in plan.turned:
        held = goals.rotation_influence[:, plan.turned[trunk.last]]
    weights = counts * goals.position_influence[:, pulls]
    return spine_phase.Wanted(
        rest.drawn_near(rotation.apply(back, pins), pinned),
        pinned,
        rest.drawn_in(rotation.apply(back, goals.positions[:, pulls] - start[:, None]), weights),
        weights,
        held,
        _counts(trunk, pinned, weights),
    )


def _counts(trunk: Trunk, pinned: Array, weights: Array) -> Array | None:
    """Return how much anything wants of each branch point or of those beyond it; None where all counts in full.

    Arguments as in `spine_phase.Wanted`; shape (frame, node).
    """
    out = pinned.copy()
    for i, pull in enumerate(trunk.spine.pulls):
        out[:, pull.node] = np.maximum(out[:, pull.node], weights[:, i])
    out = np.maximum.accumulate(out[:, ::-1], axis=1)[:, ::-1]
    return None if (out[:, 1:] == 1.0).all() else out


# --- limbs ---


def _reach(state: State, wave: Wave) -> None:
    """Pose limbs."""
    goals, starts, frames = state.goals, [limb.joints[0] for limb in wave.limbs], len(state)
    carried = stacked([state.rotation(state.plan.above[start]) for start in starts], frames)
    places = stacked([state.place(start) for start in starts], frames)
    influence = goals.position_influence.take(wave.goals, axis=1)
    whole = rotation.apply(rotation.transposed(carried), goals.positions.take(wave.goals, axis=1) - places)
    bases, along, factors = base_phase.of_wave(state, wave), whole, None
    is_whole = base_phase.are_whole(bases, wave)
    is_posed = is_whole and base_phase.are_all(bases, wave)
    if is_posed:
        turned = np.broadcast_to(rotation.IDENTITY, (*whole.shape[:2], wave.chains.segments.shape[1], 3, 3))
    else:
        along = _counted(wave, whole, influence)
        own, factors = _solved(wave, along, influence)
        turned = np.matmul(carried[:, :, None], own)
    if bases:
        alone = turned if is_whole else _twisted(state, wave, turned)
        turned, factors = base_phase.brought(bases, wave, carried, whole, influence, alone, factors)
    if wave.obstacles is not None:
        turned = _freed(state, wave, wave.obstacles, places, turned, factors)
    if not is_posed:
        turned = base_phase.kept(bases, turned, _twisted(state, wave, turned))
    if wave.limited is not None:
        turned = limit_phase.hold(wave.limited, carried, turned, factors)
    for joint, limb, i in wave.joints:
        is_astray = wave.limited is not None and joint in state.plan.astray
        state.turn(joint, state.held(joint, turned[:, limb, i]) if is_astray else turned[:, limb, i])
    for base in bases:
        base_phase.take_along(state, base, turned[base.place])
    if wave.elastic is not None and factors is not None:
        for link in wave.elastic.links:
            segment = wave.chains.segments[link.limb, link.place]
            state.draw(link.joint, link.end, factors[:, link.limb, link.place], segment)
    posed = {limb for base in bases for limb in base.limbs.tolist()}
    for i, body in enumerate(wave.ends):
        if body in state.plan.detached:
            # One that was posed goes from there, so what its limb leaves to it counts as far as its goal does.
            way, most = (whole, influence[:, i]) if i in posed else (along, 1.0)
            wanted = places[:, i] + rotation.apply(carried[:, i], way[:, i])
            state.bring(body, wanted, most * detached.GAP * wave.chains.full[i])


def _counted(wave: Wave, along: Array, influence: Array) -> Array:
    """Return the ways to goals as far as these count; a stem weighs those of its branches itself.

    Args:
        wave: The limbs, or the one stem.
        along: From where they start to their goals, in the frames of what carries them [m], shape (frame, goal, 3).
        influence: How far the goals count, shape (frame, goal).
    """
    if wave.stem is not None or not (influence != 1.0).any():
        return along
    rest, part = wave.chains.segments.sum(axis=1), influence[..., None]
    return np.where(part == 1.0, along, rest + part * (along - rest))


def _solved(wave: Wave, along: Array, influence: Array) -> tuple[Array, Array | None]:
    """Return how joints turn from where they are carried, and by what factors bones are longer, None if none may.

    Arguments as for `_counted`, which returns the ways.
    """
    if wave.stem is not None:
        own = (branching.settle if wave.rigid else branching.solve)(wave.stem, along, influence)
        if wave.elastic is None:
            return own, None
        return own, stretching.of_stem(wave.elastic, wave.stem, own, along, influence)
    if wave.elastic is None:
        return limb_phase.solve(wave.chains, along, influence), None
    return stretching.solve(wave.elastic, along, influence)


def _freed(
    state: State, wave: Wave, obstacles: Obstacles, starts: Array, turned: Array, factors: Array | None
) -> Array:
    """Return limbs out of what they collide with."""
    # Where that is may still change within its limits, so what is found out about it here is not kept.
    state = state.supposing({joint: turned[:, limb, i] for joint, limb, i in wave.joints})
    around, plan = obstacles.around, state.plan
    ends = np.empty((2, len(turned), len(around.bodies), 3))
    for i, leader in enumerate(plan.leaders[around.bodies].tolist()):
        for end, points in zip(ends, (around.starts, around.ends), strict=True):
            away = rotation.apply(state.rotation(leader), points[i] - plan.rest[leader])
            end[:, i] = state.place(leader) + away
    if factors is None:
        return collision.free(obstacles, starts, turned, (ends[0], ends[1]))
    # Longer bones are where larger turns lead.
    longer = factors[..., None, None]
    return collision.free(obstacles, starts, longer * turned, (ends[0], ends[1])) / longer


def _twisted(state: State, wave: Wave, turned: Array) -> Array:
    """Return limbs whose joints with turns of their own twist as these say, and point where they were solved to."""
    own = [place for place in wave.joints if place[0] in state.plan.turned]
    if not own:
        return turned
    limbs, places = [limb for _, limb, _ in own], [place for _, _, place in own]
    solved = turned[:, limbs, places]
    wanted = stacked([state.wanted(joint, solved[:, i]) for i, (joint, _, _) in enumerate(own)], len(turned))
    along = wave.chains.directions[limbs, places]
    bent = rotation.between(rotation.apply(wanted, along), rotation.apply(solved, along))
    out = turned.copy()
    out[:, limbs, places] = np.matmul(bent, wanted)
    return out
