"""The one orchestrator: evaluates whole clips in a batch.

sampled source pose -> transfer -> feet and hands -> root motion -> basis rotations and locations of target bones
"""

from dataclasses import dataclass, replace

import numpy as np

from . import quat
from .arrays import Array, Flags, Indices
from .ground import Ground
from .mocap import feet, kinematics, mirroring, planting, root_motion, transfer, twist
from .mocap.links import NONE
from .mocap.motion import Motion, SourceMotion
from .mocap.plan import Plan
from .mocap.root_motion import RootMotion, Travel
from .skeleton import Pose


@dataclass(frozen=True, eq=False)
class Result:
    """A transferred clip, ready to be keyed."""

    bones: Indices
    """Target bones that get rotation keys, shape (n,)."""
    basis: Array
    """Their rotations in their own rest frames, shape (frame, n, 4)."""
    moved: Indices
    """Target bones that get location keys, the hips first, shape (m,)."""
    shifts: Array
    """How far their heads move from where their parents at rest hold them, armature space, shape (frame, m, 3)."""
    root_motion: RootMotion
    """Where the travel goes."""
    travel: Travel | None
    """What was taken from the hips, for a root bone or the object, target's character frame."""
    source: SourceMotion
    """What was read from the source."""
    motion: Motion
    """What the target does, travel included."""

    def resampled(self, places: Array) -> "Result":
        """Return the keys at ``places`` between frames, shape (n,), interpolated; the motions stay as they are."""
        low = np.minimum(places.astype(np.intp), len(self.basis) - 1)
        high = np.minimum(low + 1, len(self.basis) - 1)
        part = places - low
        travel = self.travel
        if travel is not None:
            points = travel.points[low] + part[:, None] * (travel.points[high] - travel.points[low])
            travel = Travel(quat.slerp(travel.turns[low], travel.turns[high], part), points)
        return replace(
            self,
            basis=quat.slerp(self.basis[low], self.basis[high], part[:, None]),
            shifts=self.shifts[low] + part[:, None, None] * (self.shifts[high] - self.shifts[low]),
            travel=travel,
        )


def evaluate(
    plan: Plan,
    pose: Pose,
    seconds_per_frame: float,
    standing: Flags | None = None,
    ground: Ground | None = None,
    ankles: Array | None = None,
) -> Result:
    """Return a clip of the source as the target plays it.

    Args:
        plan: Of the pair.
        pose: The source over the clip, armature space.
        seconds_per_frame: Time between frames [s].
        standing: The user's own plants, shape (frame, foot); found from the motion when None.
        ground: Terrain under the target, its character frame; flat when None, and where there is none.
        ankles: Where the feet of the plan's legs are instead of where the pose has them, source's character frame [m],
            shape (frame, foot, 3), NaN where the pose counts: blended by themselves (Feng 2013 §5.2).
    """
    source = SourceMotion.read(plan, pose, seconds_per_frame, standing, ankles)
    if plan.settings.mirror:
        source = mirroring.mirrored(source, plan.links, plan.transfer.post)
    meant = transfer.target_turns(plan.transfer, source.turns)
    turns = meant
    if plan.directions:
        turns = kinematics.follow_curve(plan.links, turns, source.points, plan.target_rest)
    if plan.plants:
        turns = feet.flatten(
            plan.links.legs, source.steps, source.turns, turns, plan.transfer.post, plan.source.rest_is_pose
        )
    motion = Motion(turns, kinematics.target_points(plan.target_rest, turns, plan.tree))
    motion = planting.follow_root(plan, source, motion)
    if plan.plants:
        motion = planting.plant_feet(plan, source, motion, ground)
    if plan.settings.reach_hands and plan.links.arms:
        motion = planting.reach_hands(plan, source, motion)
    return _keyed(plan, source, meant, motion)


def _keyed(plan: Plan, source: SourceMotion, meant: Array, motion: Motion) -> Result:
    """Return a motion as basis rotations and shifts of bones, its travel taken out unless the hips keep it."""
    kind, travel, kept = plan.settings.root_motion, None, motion
    if kind is not RootMotion.HIPS and len(motion.turns) > 1:
        travel = root_motion.find_travel(motion.points[:, 0], motion.turns[:, 0], source.seconds_per_frame)
        if kind is RootMotion.IN_PLACE:
            travel = Travel(quat.identity(len(motion.turns)), travel.points)
        kept = Motion(
            quat.multiply(quat.conjugate(travel.turns)[:, None], motion.turns),
            root_motion.without(travel, motion.points, plan.target_rest[0]),
        )
    bones, basis = twist.share(plan.target, plan.links, plan.transfer, kept.turns, _basis(plan, source, meant, kept))
    loose = np.flatnonzero(plan.transfer.carrier == NONE)
    own = plan.links.target[loose]
    places = plan.target.local_to_character.inverse().points(kept.points[:, loose])
    shifts = places - plan.target.skeleton.rest_positions[own]
    moved = np.array([own[0], *(_mover(plan, int(bone)) for bone in own[1:])], dtype=np.intp)
    return Result(bones, basis, moved, shifts, kind, travel, source, motion)


def _mover(plan: Plan, bone: int) -> int:
    """Return the bone that moves in place of one that hangs on none of the links: the topmost that carries no other.

    Feet of baked inverse kinematics may hang on bones of their own, which have skin as well.
    """
    tree, linked = plan.target.skeleton.tree, [int(other) for other in plan.links.target]
    others = [other for other in linked if other != bone and not tree.is_below(bone, other)]
    top = bone
    for above in tree.ancestors[bone]:
        if above in others or any(tree.is_below(above, other) for other in others):
            break
        top = above
    return top


def _basis(plan: Plan, source: SourceMotion, meant: Array, motion: Motion) -> Array:
    """Return the basis rotations of the links' bones: by eqs 1 and 2, or anew where later steps have changed them."""
    turner = plan.transfer.turner
    touched = (motion.turns != meant).any(axis=(0, 2))
    touched |= (turner != NONE) & touched[turner]
    kept, anew = np.flatnonzero(~touched), np.flatnonzero(touched)
    out = np.empty_like(meant)
    out[:, kept] = transfer.apply(plan.transfer, source.turns, kept)
    out[:, anew] = transfer.basis_from_turns(plan.transfer, motion.turns, anew)
    return out
