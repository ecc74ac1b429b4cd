"""Arms that are brought to places by the solver itself: what the body will do, asked before it does it.

A hand is turned as its forearm turns, so how it lies is known only when the arm is solved. The posture gives all bodies
their turns, as it will when the pose is solved in the end, so both come to the same.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from ... import quat
from ...arrays import Array, Indices
from ...solve import posing
from ...solve.goals import Goals
from ...solve.plan import Plan
from ...solve.settings import DEFAULT, SolverSettings
from .actor import Actor
from .hands import Hand, hands_of
from .posture import Posture


@dataclass(frozen=True, eq=False)
class Arm:
    """A hand, and the limb that brings it to places."""

    actor: Actor
    hand: Hand
    settings: SolverSettings = DEFAULT

    @cached_property
    def bodies(self) -> Indices:
        """Those that carry the hand, from the root on, and the hand itself, shape (n,): no others matter to it."""
        return np.array(self.actor.tree.path(self.actor.root, self.hand.body), dtype=np.intp)

    @cached_property
    def plan(self) -> Plan:
        """How the solver brings the hand to its place."""
        own = self.actor
        wanted = [(int(body), body in (own.root, self.hand.body), True) for body in self.bodies]
        return posing.prepare(own.character, own.rest, own.root, wanted, self.settings)

    @cached_property
    def joints(self) -> tuple[int, ...]:
        """Those that the solver turns; none where it cannot bring the hand anywhere."""
        return self.plan.joints_of(self.hand.body) if len(self.bodies) > 1 else ()

    @cached_property
    def length(self) -> float:
        """From the first joint to the hand when it is stretched [m]."""
        line = [*self.joints, self.hand.body]
        return float(quat.length(np.diff(self.actor.rest[line], axis=0)).sum())

    def shoulder(self, posture: Posture) -> Array:
        """Return where it starts [m], shape (n, 3)."""
        return posture.positions[:, self.joints[0]]

    def turns(self, posture: Posture, places: Array, influence: Array) -> Array:
        """Return how the last joint before the hand turns on from the posture, shape (n, 4).

        Args:
            posture: Without any goal.
            places: Of the hand [m], shape (n, 3).
            influence: How far they count, shape (n,).
        """
        last = self.joints[-1]
        pose = posing.solve(self.plan, self.goals(posture, places, influence))
        return quat.multiply(pose.turns[:, last], quat.conjugate(posture.turns[:, last]))

    def goals(self, posture: Posture, places: Array, influence: Array) -> Goals:
        """Return what the solver is asked for."""
        turns = posture.turns[:, self.bodies]
        positions = posture.positions[:, self.bodies].copy()
        counts = np.zeros(turns.shape[:2])
        positions[:, -1], counts[:, -1], counts[:, 0] = places, influence, 1.0
        return Goals(self.bodies, positions, turns, counts, np.ones_like(counts))


@lru_cache(maxsize=16)
def arms_of(actor: Actor, settings: SolverSettings = DEFAULT) -> tuple[Arm, ...]:
    """Return the limbs of all hands of a character, in their order; kept, as it is told one thing after another."""
    return tuple(Arm(actor, hand, settings) for hand in hands_of(actor))
