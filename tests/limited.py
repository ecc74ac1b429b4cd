"""Characters with joint limits such as animators set: hinges for knees and elbows, ranges for hips and shoulders."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from morph_retarget.core import quat
from morph_retarget.core.arrays import Array, Indices
from morph_retarget.core.solve import posing
from morph_retarget.core.solve.goals import Goals
from morph_retarget.core.solve.limits import JointLimits, swing_and_twist
from morph_retarget.core.solve.plan import Plan
from morph_retarget.core.solve.posing import BodyPose
from tests import goal_sets
from tests.goal_sets import Sets, Subject

FOLD = np.radians(100.0)
"""Most by which a hinge bends, less than solvers without limits would."""
LEAST, MOST = np.radians([-60.0, -35.0, -40.0]), np.radians([45.0, 40.0, 50.0])
"""Of the first joints of limbs on the left; X is the axis of the hinge."""
_FLIP = np.array([1.0, -1.0, -1.0])


@dataclass(frozen=True, eq=False)
class Limbed:
    """A character with limits for the joints of its limbs."""

    subject: Subject
    """Its bones that have limits lie along their Y axes, and bend about X."""
    limits: JointLimits

    @property
    def axes(self) -> Array:
        """Rest axes of all bodies, character frame, shape (body, 4)."""
        character = self.subject.character
        return character.local_to_character.turns(character.skeleton.rest_rotations)

    @property
    def ends(self) -> Indices:
        """The root and the ends of the limbs."""
        found = dict.fromkeys(hinged.limb.end for hinged in self.subject.limbs)
        return np.array([self.subject.root, *found], dtype=np.intp)

    def plan(self, limits: JointLimits | None) -> Plan:
        """Return how goals for the places of the limbs' ends are met."""
        return _plan(self.subject, tuple(self.ends.tolist()), limits)

    def told(self, pose: BodyPose) -> Array:
        """Return swings and twists of all bodies against their parents, shape (frame, body, 3)."""
        return swing_and_twist(self.own(pose.turns))

    def own(self, turns: Array) -> Array:
        """Return turns of all bodies as those against their parents, in their own rest axes, (frame, body, 4)."""
        above = np.where((self._parents >= 0)[:, None], turns[:, self._parents], quat.IDENTITY)
        return quat.multiply(self._back, quat.multiply(quat.multiply(quat.conjugate(above), turns), self.axes))

    def reachable(self, rng: np.random.Generator, count: int) -> Sets:
        """Return goals from random poses of limbs, all within the limits."""
        sets = goal_sets.random_sets(self.subject, rng, count)
        moved = {b for hinged in self.subject.limbs for b in (hinged.first, *hinged.hinges)}
        turns = quat.multiply(quat.multiply(self._back, sets.own), self.axes)
        own = quat.multiply(quat.multiply(self.axes, self.limits.clamped(turns)), self._back)
        still = [body for body in range(len(self.axes)) if body not in moved]
        own[:, still] = quat.IDENTITY
        own[:, self.subject.root] = sets.own[:, self.subject.root]
        return replace(sets, own=own)

    def goals(self, sets: Sets) -> Goals:
        """Return where the ends of limbs are in sets."""
        places, turns = sets.pose
        return goal_sets.goals_of(self.ends, places[:, self.ends], turns[:, self.ends])

    @property
    def _parents(self) -> Indices:
        return self.subject.bodies.parents

    @property
    def _back(self) -> Array:
        return quat.conjugate(self.axes)


@lru_cache(maxsize=64)
def _plan(subject: Subject, ends: tuple[int, ...], limits: JointLimits | None) -> Plan:
    wanted = [(body, True, body == subject.root) for body in ends]
    return posing.prepare(subject.character, subject.bodies.positions, subject.root, wanted, limits=limits)


def limbed(subject: Subject) -> Limbed:
    """Return a character with bones that are turned as animators like them, and with limits."""
    character, rest = subject.character, subject.bodies.positions
    axes = character.local_to_character.rotation @ quat.to_matrix(character.skeleton.rest_rotations)
    free = JointLimits.free(len(rest))
    least, most = free.least.copy(), free.most.copy()
    for hinged in subject.limbs:
        line = subject.bodies.tree.path(hinged.first, hinged.limb.end)
        for body, angle, axis in zip(hinged.hinges, hinged.angles, hinged.axes, strict=True):
            axes[body] = _axes(rest, line, body, axis)
            least[body], most[body] = [-angle, 0.0, 0.0], [max(FOLD - angle, 0.0), 0.0, 0.0]
        first = hinged.first
        axes[first] = _axes(rest, line, first, hinged.axes[0] if len(hinged.axes) else np.array([1.0, 0.0, 0.0]))
        left = hinged.limb.side >= 0
        least[first] = LEAST if left else np.minimum(LEAST * _FLIP, MOST * _FLIP)
        most[first] = MOST if left else np.maximum(LEAST * _FLIP, MOST * _FLIP)
    local = quat.from_matrix(character.local_to_character.rotation.T @ axes)
    skeleton = replace(character.skeleton, rest_rotations=local)
    return Limbed(Subject(replace(character, skeleton=skeleton)), JointLimits(least, most))


def _axes(rest: Array, line: Sequence[int], body: int, axis: Array) -> Array:
    """Return axes of a bone that leads to the next one of its line, in columns."""
    along = quat.unit(rest[line[line.index(body) + 1]] - rest[body])
    side = quat.unit(axis - (axis @ along) * along)
    return np.stack([side, along, np.cross(side, along)], axis=-1)
