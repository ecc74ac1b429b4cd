"""What each bone of a humanoid is: names, tree and shape joined into one decision (Feng 2013 §3, Algorithms 1-3).

The paper walks the tree with rules and falls back on keywords. Here every candidate for hips, chest, legs, arms,
neck and head is scored by all three kinds of evidence at once, and the best complete body wins, so that a misleading
name, a twist bone, wings or a sword on the back cost their candidates points but never end the search.
"""

from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from ..arrays import Array
from . import limbs
from .anatomy import Body
from .joint_names import is_extra
from .joint_search import NO_SHOULDER, WORST, Choice, Search
from .limbs import Triples
from .words import Sense

NO_TOES = -0.3


@dataclass(frozen=True)
class Found:
    """One joint of the decision."""

    bone: int
    margin: float
    """Log-odds of this bone over the best other choice."""
    by: str
    """The evidence that decided: "name", "topology" or "geometry"."""


@dataclass
class Decision:
    """The best reading of a rig as a humanoid."""

    joints: dict[str, Found] = field(default_factory=dict[str, Found])
    """Unsided trunk joints, and limb joints with "left" or "right" in front; left is the trial frame's."""
    score: float = WORST
    shape: float = 0.0
    """Mean shape score of legs and arms: above 0 the rest pose looks like a body, far below it does not."""
    spine: list[int] = field(default_factory=list[int])
    """Bones above the hips up to the chest that carry the arms, helpers and folded bones left out."""


def decide(body: Body, trust: float = 1.0) -> Decision:
    """Return the best complete humanoid in ``body``.

    Args:
        body: The rig in a trial frame.
        trust: Weight of shapes against names, 0 … 1.
    """
    candidates = limbs.units(body)
    legs = limbs.triples(body, candidates, ("UpperLeg", "LowerLeg", "Foot"), limbs.leg_shape, trust)
    arms = limbs.triples(body, candidates, ("UpperArm", "LowerArm", "Hand"), limbs.arm_shape, trust)
    if not len(legs.score) or not len(body.midline):
        return Decision()
    search = Search(body, candidates, legs, arms, trust)
    best = search.best()
    return Decision() if best is None else _Writer(search, best).write()


class _Writer:
    """Turns the best body into named joints with their margins."""

    def __init__(self, search: Search, best: Choice) -> None:
        self.search = search
        self.best = best
        self.body = search.body
        self.evidence = search.evidence
        self.units = search.units
        self.out = Decision(score=best.score)

    def write(self) -> Decision:
        """Return the decision that the choice makes."""
        search, best = self.search, self.best
        hips, chest = search.middle[best.hips], search.middle[best.chest]
        self.out.joints["hips"] = Found(hips, self._hips_margin(best.hips), self._by(hips, "hips", "topology"))
        self._limb(search.legs, search.leg_table[best.hips], best.leg, ("UpperLeg", "LowerLeg", "Foot"))
        shapes = [float(search.legs.shape[best.leg])]
        if best.arm >= 0:
            self._limb(search.arms, search.arm_table[best.chest], best.arm, ("UpperArm", "LowerArm", "Hand"))
            shapes.append(float(search.arms.shape[best.arm]))
            shoulder = int(search.shoulder_of[best.arm])
            if shoulder >= 0:
                margin = search.shoulder_score(shoulder, int(search.arms.upper[best.arm])) - NO_SHOULDER
                self._unit("Shoulder", shoulder, margin)
        self._toes(int(search.legs.end[best.leg]))
        self.out.shape = sum(shapes) / len(shapes)
        if best.neck >= 0:
            self._trunk_joint("neck", best.neck, 1.0)
        if best.head >= 0:
            self._trunk_joint("head", best.head, 1.5)
        self._spine(hips, chest)
        return self.out

    def _trunk_joint(self, joint: str, bone: int, margin: float) -> None:
        self.out.joints[joint] = Found(
            bone, margin + self.evidence.score(bone, joint), self._by(bone, joint, "topology")
        )

    def _hips_margin(self, h: int) -> float:
        names = np.array([self.evidence.score(b, "hips") for b in self.search.middle])
        totals = self.search.leg_table.max(axis=1) + names
        others = np.delete(totals, h)
        return float(totals[h] - others.max()) if len(others) else 6.0

    def _limb(self, limb: Triples, row: Array, chosen: int, joints: tuple[str, str, str]) -> None:
        if (self.units.bones[limb.upper[chosen]] < 0).any():
            self._single_limbs(limb, row, joints)
            return
        for column, joint in zip((limb.upper, limb.lower, limb.end), joints, strict=True):
            if column[chosen] >= 0:
                others = row[column != column[chosen]]
                margin = float(row[chosen] - others.max()) if len(others) else 6.0
                self._unit(joint, int(column[chosen]), margin)

    def _single_limbs(self, limb: Triples, row: Array, joints: tuple[str, str, str]) -> None:
        for side in (0, 1):
            there = (self.units.bones[limb.upper, side] >= 0) & (self.units.bones[limb.upper, 1 - side] < 0)
            if not there.any() or row[there].max() < row.max() - 6.0:
                continue
            chosen = int(np.flatnonzero(there)[np.argmax(row[there])])
            for column, joint in zip((limb.upper, limb.lower, limb.end), joints, strict=True):
                if column[chosen] >= 0:
                    self._unit(joint, int(column[chosen]), 1.0)

    def _unit(self, joint: str, unit: int, margin: float) -> None:
        for side, bone in zip(("left", "right"), self.units.bones[unit], strict=True):
            if bone >= 0:
                self.out.joints[side + joint] = Found(int(bone), margin, self._by(int(bone), joint, "geometry"))

    def _toes(self, foot: int) -> None:
        if foot < 0:
            return
        best, chosen = NO_TOES, -1
        for unit in range(len(self.units)):
            if foot not in self.units.ancestors[unit]:
                continue
            a, b = self.units.points[foot], self.units.points[unit]
            flat = abs(float(b[2] - a[2])) < 0.12 and float(b[2]) < 0.1
            ahead = float(a[1] - b[1]) > 0.01
            form = 1.0 * flat + 1.0 * ahead - 1.0
            hop = self.evidence.hops(self.units.main(foot), self.units.main(unit))
            value = limbs.unit_score(self.body, self.units, unit, "Toes") + self.search.trust * form - hop
            # Of several toes side by side the first, the biggest, stands for all.
            value += 0.3 * bool(self.evidence.readings[self.units.main(unit)].has(Sense.BIG))
            if value > best + 1e-9:
                best, chosen = value, unit
        if chosen >= 0:
            self._unit("Toes", chosen, best - NO_TOES)

    def _spine(self, hips: int, chest: int) -> None:
        """Name the bones between hips and chest: one is the spine, two spine and chest, three or more all three."""
        if chest == hips:
            return
        path = self.evidence.tree.path(hips, chest)[1:] or self.evidence.tree.path(
            self.evidence.tree.top_of(chest, hips), chest
        )
        bones = self._rising(hips, [b for b in path if b == chest or not self._is_helper(b)])
        self.out.spine = bones
        last = len(bones) - 1
        names = {
            0: {"spine": 0},
            1: {"spine": 0, "chest": 1},
        }.get(last, {"spine": 0, "chest": (last + 1) // 2, "upperChest": last})
        if last == 0 and self._says_chest(bones[0]):
            names = {"chest": 0}
        for joint, i in names.items():
            bone = bones[i]
            self._trunk_joint(joint, bone, 1.5)

    def _says_chest(self, bone: int) -> bool:
        reading = self.evidence.readings[bone]
        return reading.has(Sense.CHEST) or (reading.has(Sense.UPPER) and not reading.has(Sense.SPINE))

    def _is_helper(self, bone: int) -> bool:
        return is_extra(self.evidence.readings[bone]) or bool(self.evidence.thing[bone])

    def _rising(self, hips: int, path: list[int]) -> list[int]:
        """Return the bones of a spine that lead on: some rigs fold spare bones back onto the ones before."""
        points, chest = self.body.points, path[-1]
        whole = points[chest] - points[hips]
        along = (points[path] - points[hips]) @ whole / max(float(whole @ whole), 1e-12)
        kept: list[int] = []
        reached = -0.5 if along[0] < 0.02 else 0.02
        for bone, place in zip(path, along, strict=True):
            if place > reached + 0.02:
                kept.append(bone)
                reached = place
        if len(kept) < 2 and self.search.trust < 1.0:
            return path
        return [*(b for b, k in pairwise(kept) if k), chest] if kept else [chest]

    def _by(self, bone: int, joint: str, otherwise: str) -> str:
        return "name" if self.evidence.score(bone, joint) >= 1.5 else otherwise
