"""What a motion is an example of, told from its footfalls, its pace and its hands."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ... import quat
from ...arrays import Array, Flags
from ...character.morphology import LimbKind
from ...runs import runs
from ..character_model import CharacterModel
from ..travel import turned
from .footfalls import Footfalls

WALK, RUN, TURN, JUMP = "walk", "run", "turn", "jump"
IDLE, GESTURE, OTHER = "idle", "gesture", "other"
GOING = (WALK, RUN)
"""Kinds that go over the ground, step by step."""

PACE = 0.3
"""A body that goes faster over the ground is on its way [leg lengths/s] …"""
LEAST_PACE, FAR = 0.1, 0.5
"""… and one that is at least this fast, if it comes this far [leg lengths]: it starts or stops in between."""
DUTY = 0.5
"""A foot of a runner stands for less than this share of the time (Hecker 2008 §4.2) …"""
FROUDE = 0.35
"""… and the square of its speed over leg length and gravity is more than this (Alexander & Jayes 1983)."""
FASTEST_WALK = 0.55
"""What is faster by the same measure runs, however long its feet stand; bodies of all sizes begin to at about 0.5."""
MOSTLY = 0.9
"""The speed that a body does not pass for this share of the time is that of its gait."""
GRAVITY = 9.81
"""[m/s²]"""
PLAUSIBLE = 0.05, 2.5
"""Legs of these lengths are taken at their word [m]; in files of odd units they are taken to be `USUAL_LEG`."""
USUAL_LEG = 0.9
"""[m]"""
FLIGHT = 0.1
"""A jump takes all feet off the ground for longer than this [s] …"""
TOGETHER = 0.35
"""… and all of them stand within this time before or after [s]."""
LIFTED, RISEN = 0.06, 0.03
"""In a jump all feet come this far off the ground, and the hips this far above where they stand [leg lengths]."""
TURNS = 0.3
"""A body that steps on the spot and turns faster than this turns [rad/s]."""
CALM = 0.18
"""Hands, head and chest that stay within this distance of their mean place only breathe [leg lengths]."""
STANDS = 0.75
"""In a gesture the feet stand for at least this share of the time."""
LEAST_TURN, LEAST_SHARE = np.radians(10.0), 0.25
"""Parts of the body whose joints turn by this, and by this share of what those of any part do, matter to a gesture."""
ONE_SIDED = 2.0
"""A gesture is done with one side if its limb moves farther than the other by this factor."""


@dataclass(frozen=True, eq=False)
class Judged:
    """A motion with all that tells its kind."""

    model: CharacterModel
    footfalls: Footfalls

    @cached_property
    def drift(self) -> Array:
        """Mean velocity over the ground as the body sees it [m/s], shape (2,); what sways to and fro has none."""
        return turned(self.footfalls.velocity, -self.footfalls.way.headings).mean(axis=0)

    @cached_property
    def pace(self) -> float:
        """Mean speed over the ground [leg lengths/s]."""
        return float(np.hypot(*self.drift)) / self.footfalls.seen.size

    @property
    def goes(self) -> bool:
        """Whether it is on its way, or at least has gone some way."""
        far = self.pace * (len(self.footfalls.seen) - 1) * self.footfalls.seen.step
        return self.pace > PACE or (self.pace > LEAST_PACE and far > FAR)

    @cached_property
    def turn_rate(self) -> float:
        """Mean change of the heading [rad/s]."""
        lasts, headings = (len(self.footfalls.seen) - 1) * self.footfalls.seen.step, self.footfalls.way.headings
        return float(headings[-1] - headings[0]) / lasts if lasts > 0.0 else 0.0

    @cached_property
    def kind(self) -> str:
        """One of the names above."""
        stands = self.footfalls.stands
        if not stands.shape[1]:
            return OTHER if self.goes or self.is_lively else IDLE
        if self._jumps(stands):
            return JUMP
        if self.goes and len(self.footfalls.strikes) > 1:
            light = float(stands.mean()) < DUTY and self._froude > FROUDE
            return RUN if light or self._froude > FASTEST_WALK else WALK
        if not self.goes and len(self.footfalls.strikes) > 1 and abs(self.turn_rate) > TURNS:
            return TURN
        if self.goes or float(stands.mean()) < STANDS:
            return OTHER
        if not self.is_lively:
            return IDLE
        return GESTURE if self.reach.max(initial=0.0) > CALM else OTHER

    @cached_property
    def hands(self) -> tuple[int, ...]:
        """Joints that gestures are made with: the ends of arms, or of what else is no leg."""
        limbs = self.model.character.limbs
        arms = [limb.end for limb in limbs if limb.kind is LimbKind.ARM]
        return tuple(arms or [limb.end for limb in limbs if limb.kind is not LimbKind.LEG])

    @cached_property
    def reach(self) -> Array:
        """How far each hand moves from its mean place beside the body [leg lengths], shape (hand,)."""
        seen = self.footfalls.seen
        own = seen.shape[:, list(self.hands)]
        return quat.length(own - own.mean(axis=0)).max(axis=0, initial=0.0) / seen.size

    @property
    def is_lively(self) -> bool:
        """Whether it moves farther than a body that breathes."""
        seen, body = self.footfalls.seen, self.model.character
        ends = [*self.hands, *body.spine[-1:], *(() if body.head is None else (body.head,))]
        own = seen.shape[:, ends or slice(None)]
        return float(quat.length(own - own.mean(axis=0)).max(initial=0.0)) > CALM * seen.size

    @cached_property
    def side(self) -> str:
        """Which side a gesture is done with, empty for both."""
        far = {1: 0.0, -1: 0.0}
        ends = {limb.end: limb.side for limb in self.model.character.limbs}
        for hand, reach in zip(self.hands, self.reach.tolist(), strict=True):
            if ends[hand] in far:
                far[ends[hand]] = max(far[ends[hand]], reach)
        if max(far.values()) <= ONE_SIDED * min(far.values()):
            return ""
        return "left" if far[1] > far[-1] else "right"

    @cached_property
    def parts(self) -> tuple[str, ...]:
        """Parts of the body that matter: what carries it on its way, what moves in a gesture; empty for all."""
        names = [name for name in self.model.parts if name not in _groups(self.model)]
        if self.kind in (*GOING, TURN, IDLE):
            return tuple(name for name in names if name == "trunk" or name.endswith(" leg"))
        if self.kind != GESTURE:
            return ()
        turns = _turns(self.footfalls)
        most = {name: float(turns[self.model.parts[name]].max(initial=0.0)) for name in names}
        least = max(LEAST_TURN, LEAST_SHARE * max(most.values()))
        return tuple(name for name in names if most[name] > least)

    @cached_property
    def _froude(self) -> float:
        # A body that sets out or stops has its own speed only for a part of the time.
        leg = self.footfalls.seen.size
        pace = float(np.quantile(np.hypot(*self.footfalls.velocity.T), MOSTLY)) / leg
        low, high = PLAUSIBLE
        return pace**2 * (leg if low < leg < high else USUAL_LEG) / GRAVITY

    def _jumps(self, stands: Flags) -> bool:
        """Return whether the body leaves the ground from all feet, or comes back to it on all of them."""
        seen, standing = self.footfalls.seen, stands.sum(axis=1)
        reach, together = max(round(TOGETHER / seen.step), 1), standing == stands.shape[1]
        hips = seen.places[:, seen.root, 2]
        usual = float(np.median(hips[together])) if together.any() else np.inf
        for first, last in runs(standing == 0):
            flight, near = slice(first, last + 1), together[max(first - reach, 0) : last + 1 + reach]
            lifted = self.footfalls.heights[flight].min(axis=1).max() > LIFTED
            risen = hips[flight].max() > usual + RISEN * seen.size
            if (last - first + 1) * seen.step > FLIGHT and near.any() and lifted and risen:
                return True
        return False


def _turns(footfalls: Footfalls) -> Array:
    """Return how far each joint turns against its parent from its mean [rad], shape (joint,)."""
    seen = footfalls.seen
    parents = seen.character.skeleton.parents
    rotations = seen.pose.rotations
    own = quat.multiply(quat.conjugate(rotations[:, np.maximum(parents, 0)]), rotations)
    own[:, parents < 0] = rotations[:, parents < 0]
    usual = np.broadcast_to(own[len(own) // 2], own.shape)
    away = quat.angle_between(own, usual)
    return 0.5 * (away.max(axis=0) + np.median(away, axis=0))


def _groups(model: CharacterModel) -> Sequence[str]:
    """Return the names of parts that are made of others."""
    return [name for name in model.parts if name in {"upper", "lower", "all"} or name.endswith("s")]
