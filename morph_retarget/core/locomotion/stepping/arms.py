"""Arms of walking humanoids: they hang from the shoulders and swing against the legs."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ... import quat
from ...arrays import Array
from ...character.character import Character
from ...solve import detached
from ..moving import LEFT, eased
from .legs import Leg
from .trunk import Trunk

OUTWARD = np.radians(9.0)
"""Hanging arms stand off the body by this."""
BENT = np.radians(14.0), np.radians(85.0)
"""How far elbows are bent in a slow walk and in a run."""
RUNS = 0.5, 1.0
"""Dimensionless speeds between which the elbows bend."""
AHEAD = 0.35
"""Elbows bend more as the arm swings forward, by this share of the swing."""


@dataclass(frozen=True, eq=False)
class Arm:
    """An arm that swings."""

    upper: int
    lower: int
    hand: int | None
    side: int
    carrier: int
    """What carries it, by its place in the trunk."""
    upper_way: Array
    """Where the upper arm points at rest, shape (3,)."""
    lower_way: Array
    """Where the forearm does."""
    leg: int
    """The leg of the same side that it swings against."""

    @property
    def bodies(self) -> tuple[int, ...]:
        """What is turned."""
        return (self.upper, self.lower) if self.hand is None else (self.upper, self.lower, self.hand)


def find(character: Character, rest: Array, trunk: Trunk, legs: Sequence[Leg]) -> list[Arm]:
    """Return the arms of a humanoid that hang beside its legs."""
    out: list[Arm] = []
    if not character.humanoid:
        return out
    ancestors = detached.carried(character, trunk.bodies[0]).ancestors
    for name, side in (("left", 1), ("right", -1)):
        upper, lower, hand = (character.bone(name + part) for part in ("UpperArm", "LowerArm", "Hand"))
        beside = [i for i, leg in enumerate(legs) if leg.side == side]
        if upper is None or lower is None or not beside:
            continue
        carrier = next((trunk.bodies.index(b) for b in ancestors[upper] if b in trunk.bodies), 0)
        along = quat.unit(rest[lower] - rest[upper])
        below = along if hand is None else quat.unit(rest[hand] - rest[lower])
        out.append(Arm(upper, lower, hand, side, carrier, along, below, beside[-1]))
    return out


def swung(arm: Arm, carried: Array, reach: Array, swing: Array, speed: Array) -> list[Array]:
    """Return the turns of an arm's bodies from rest, each (frame, 4).

    Args:
        arm: Which.
        carried: Turn of what carries it, shape (frame, 4).
        reach: How far each foot is ahead of its home [leg lengths], shape (frame, leg).
        swing: How far the arms swing [rad], shape (frame,).
        speed: Dimensionless, shape (frame,).
    """
    back = swing * np.clip(2.0 * reach[:, arm.leg], -1.0, 1.0)
    run = eased((speed - RUNS[0]) / (RUNS[1] - RUNS[0]))
    bent = BENT[0] + run * (BENT[1] - BENT[0]) + AHEAD * np.maximum(-back, 0.0)
    hanging = np.array([arm.side * np.sin(OUTWARD), 0.0, -np.cos(OUTWARD)])
    upper = quat.multiply(quat.from_axis_angle(LEFT, back), quat.between(arm.upper_way, hanging))
    # The forearm goes on as the upper arm points, and bends forward in front of the body.
    lower = quat.multiply(quat.from_axis_angle(LEFT, back - bent), quat.between(arm.lower_way, hanging))
    turns = [quat.multiply(carried, upper), quat.multiply(carried, lower)]
    return turns if arm.hand is None else [*turns, turns[1]]
