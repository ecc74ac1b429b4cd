"""What the solver worked with in a pose, to be looked at: goals, particles and constraints (Hecker 2008 §4.3).

All of it is read off a plan, its goals and the pose that was found; the solver itself keeps nothing for it.
"""

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from .. import quat, rotation
from ..arrays import Array, Flags, Indices
from .goals import Goals
from .plan import NONE, Plan, Trunk
from .posing import BodyPose

TOLERANCE = 0.001 / 1.75
"""Goals count as met up to this share of the character's size: a millimetre on a human body."""
WHOLE = 1.0 - 1e-6
"""An influence from here on is a whole one: weights that are added up are rounded."""


@dataclass(frozen=True, eq=False)
class Workings:
    """Goals, particles and constraints of a pose, character frame.

    At each frame a goal that asks for a place is in one of four states: `met`, `missed`, `blended` or `fixed`.
    """

    bodies: Indices
    """Of the goals, each once, shape (goal,)."""
    asked: Array
    """Where the goals want them [m], shape (frame, goal, 3)."""
    came: Array
    """Where they came to [m], shape (frame, goal, 3)."""
    shares: Array
    """How far the goals count for places, 0 for those that ask for a turn alone, shape (frame, goal)."""
    movable: Flags
    """Whether anything brings them to their places, shape (goal,)."""
    tolerance: float
    """Errors up to this one do not count [m]."""
    joints: Array
    """Particles of the limbs, their ends among them [m], shape (frame, joint, 3)."""
    bones: Array
    """Constraints of the limbs: both ends of their bones [m], shape (frame, bone, 2, 3)."""
    branches: Array
    """Particles of the spine that bends: its branch points [m], shape (frame, branch, 3); none without one."""
    spine: Array
    """Constraints between neighbouring branch points [m], shape (frame, branch - 1, 2, 3)."""
    pulls: Array
    """Simplified limbs, from the branch points that they pull to their goals [m], shape (frame, pull, 2, 3)."""

    @cached_property
    def errors(self) -> Array:
        """How far the bodies are from where they are wanted [m], shape (frame, goal)."""
        return quat.length(self.came - self.asked)

    @cached_property
    def met(self) -> Flags:
        """Goals whose bodies are where they are wanted, shape (frame, goal)."""
        return (self.shares > 0.0) & (self.errors <= self.tolerance)

    @cached_property
    def missed(self) -> Flags:
        """Goals that were to be met in full and are not, shape (frame, goal)."""
        return self._off & self.movable & (self.shares >= WHOLE)

    @cached_property
    def blended(self) -> Flags:
        """Goals that count in part, so that their bodies need not come all the way, shape (frame, goal)."""
        return self._off & self.movable & (self.shares < WHOLE)

    @cached_property
    def fixed(self) -> Flags:
        """Goals of bodies that nothing brings to their places, where these are elsewhere, shape (frame, goal)."""
        return self._off & ~self.movable

    @property
    def _off(self) -> Flags:
        return (self.shares > 0.0) & (self.errors > self.tolerance)


def workings_of(plan: Plan, goals: Goals, pose: BodyPose) -> Workings:
    """Return what is to be seen of a pose.

    Args:
        plan: How goals are met on the character.
        goals: What was asked for.
        pose: What the solver made of it.
    """
    # Limbs may share a stem, which is drawn once.
    lines = [(*limb.path, limb.body) for wave in plan.waves for limb in wave.limbs]
    particles = list(dict.fromkeys(body for line in lines for body in line))
    ends = list(dict.fromkeys(bone for line in lines for bone in pairwise(line)))
    bones: Indices = np.array(ends, dtype=np.intp).reshape(-1, 2)
    movable = [body == plan.root or len(plan.joints_of(body)) > 0 for body in goals.bodies.tolist()]
    branches = np.zeros((len(goals), 0, 3)) if plan.trunk is None else _branches(plan, plan.trunk, pose)
    nodes = [] if plan.trunk is None else [pull.node for pull in plan.trunk.spine.pulls]
    pulling = [] if plan.trunk is None else list(plan.trunk.pulls)
    return Workings(
        goals.bodies,
        goals.positions,
        pose.positions[:, goals.bodies],
        goals.position_influence,
        np.array(movable, dtype=np.bool_),
        TOLERANCE * float(np.ptp(plan.rest, axis=0).max()),
        pose.positions[:, particles],
        pose.positions[:, bones],
        branches,
        np.stack([branches[:, :-1], branches[:, 1:]], axis=2),
        np.stack([branches[:, nodes], goals.positions[:, pulling]], axis=2),
    )


def _branches(plan: Plan, trunk: Trunk, pose: BodyPose) -> Array:
    """Return where the branch points of a spine are [m], shape (frame, branch, 3)."""
    # Each is where a joint is, but for the last one, which may be where the last bone leads.
    last = trunk.joints[-1]
    bone = trunk.spine.points[-1] - trunk.spine.points[-2]
    end = pose.positions[:, last] + rotation.apply(pose.rotations[:, plan.led_by[last]], bone)
    if trunk.last != NONE:  # a bone that has stretched leads on to it
        end = pose.positions[:, trunk.last]
    line = np.concatenate([pose.positions[:, trunk.joints], end[:, None]], axis=1)
    return line[:, trunk.spine.nodes]
