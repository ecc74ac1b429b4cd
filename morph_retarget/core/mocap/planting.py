"""Bringing the root, the feet and the hands of a transferred motion to their places (Feng 2013 §4.2, §5.2)."""

import numpy as np

from ..arrays import Array
from ..ground import Ground, heights_on
from ..smoothing import upper_envelope
from . import constraints, feet, kinematics, soles
from .links import NONE, LimbLinks
from .motion import Motion, SourceMotion
from .plan import Plan

RISE_TIME = 0.05
"""A foot that would sink is raised, and let down again, over about this time [s]."""


def follow_root(plan: Plan, source: SourceMotion, motion: Motion) -> Motion:
    """Return the motion with its hip joints on the source's scaled path."""
    legs = plan.links.legs
    if not legs:
        lift = plan.target_rest[0, 2] + plan.target.floor - plan.scale * (_rest_height(plan) + plan.source.floor)
        return motion.shifted(plan.scale * source.points[:, 0] + np.array([0.0, 0.0, lift]) - motion.points[:, 0])
    roots = [leg.chain[0] for leg in legs]
    path = plan.scale * source.points[:, roots].mean(axis=1) + np.array([0.0, 0.0, _floor_lift(plan, source)])
    return motion.shifted(path - motion.points[:, roots].mean(axis=1))


def _rest_height(plan: Plan) -> float:
    rest = plan.source.skeleton.rest_positions[plan.links.source[0, 0]]
    return float(plan.source.local_to_character.points(rest)[2])


def _floor_lift(plan: Plan, source: SourceMotion) -> float:
    """Return what is added to scaled heights to bring the target's soles to its floor when the source's meet theirs.

    The source's floor is where its feet are found to stand; without planting it is where they stand at rest, so that
    a body on a box stays as high above the ground as it was.
    """
    ends = [leg.end for leg in plan.links.legs]
    ours = float(plan.target_rest[ends, 2].mean()) + plan.target.floor
    first = plan.source.skeleton.rest_positions[plan.links.source[ends, 0]]
    theirs = float(plan.source.local_to_character.points(first)[:, 2].mean()) + plan.source.floor
    found = float(source.steps.ankle_floor.mean())
    return ours - plan.scale * (theirs if plan.source.rest_is_pose and not plan.plants else found)


def plant_feet(plan: Plan, source: SourceMotion, motion: Motion, ground: Ground | None) -> Motion:
    """Return the motion with its feet at their places and its hips where these can be reached."""
    legs, rest = plan.links.legs, plan.target_rest
    standing, seconds_per_frame = source.steps.standing, source.seconds_per_frame
    paths = feet.plan_paths(
        legs,
        source.steps,
        source.points,
        motion.points,
        rest + np.array([0.0, 0.0, plan.target.floor]),
        motion.turns,
        plan.scale,
        plan.source_leg,
        plan.settings.feet,
        ground,
    )
    targets = _above_floor(plan, motion, paths.targets, seconds_per_frame, ground)
    # Feng 2013 §5.2: the root follows the lower foot, since bending a leg looks better than overstretching it.
    motion = motion.lifted(paths.terrain.min(axis=1))
    ankles = motion.points[:, [leg.end for leg in legs]]
    motion = motion.lifted(constraints.hips_follow(ankles, targets, standing, seconds_per_frame))
    hips = [leg.chain[0] for leg in legs]
    motion = motion.lifted(
        -constraints.hips_drop(legs, motion.points[:, hips], targets, standing, rest, seconds_per_frame)
    )
    targets = constraints.soften_reach(legs, motion.points[:, hips], targets, standing, rest, seconds_per_frame)
    return _enforced(plan, motion, legs, targets)


def _above_floor(plan: Plan, motion: Motion, targets: Array, seconds_per_frame: float, ground: Ground | None) -> Array:
    """Return ``targets`` raised where a sole would sink below the floor, or into the terrain on its way."""
    points = motion.points.copy()
    for f, leg in enumerate(plan.links.legs):
        for part in (leg.end, leg.ball):
            if part != NONE:
                points[:, part] += targets[:, f] - motion.points[:, leg.end]
    floor = np.full(targets.shape[:2], plan.target.floor)
    if ground is not None:
        floor += heights_on(ground, targets, 0.0)
    sunk = np.maximum(floor - soles.heights(soles.of_target(plan), motion.turns, points), 0.0)
    width = max(round(RISE_TIME / seconds_per_frame), 1)
    raised = targets.copy()
    for f in np.flatnonzero(sunk.any(axis=0)):
        raised[:, f, 2] += upper_envelope(sunk[:, f], width)
    return raised


def reach_hands(plan: Plan, source: SourceMotion, motion: Motion) -> Motion:
    """Return the motion with its hands at the source's scaled places."""
    arms = plan.links.arms
    lift = np.array([0.0, 0.0, _floor_lift(plan, source)]) if plan.links.legs else np.zeros(3)
    return _enforced(plan, motion, arms, plan.scale * source.points[:, [arm.end for arm in arms]] + lift)


def _enforced(plan: Plan, motion: Motion, limbs: tuple[LimbLinks, ...], targets: Array) -> Motion:
    height = plan.target.frame.height
    solved = constraints.enforce(
        limbs, motion.turns, motion.points, targets, plan.target_rest, plan.tree.parents, height, plan.settings.solver
    )
    below = {link for limb in limbs for link in plan.tree.below(limb.chain[0])}
    moved = np.array(sorted(below), dtype=np.intp)
    points = kinematics.place(motion.points, plan.target_rest, solved.turns, plan.tree, moved)
    return Motion(solved.turns, points, max(motion.unreached, float(solved.error.max(initial=0.0))))
