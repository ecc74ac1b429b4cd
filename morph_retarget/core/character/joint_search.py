"""Searching for the best complete body: every candidate for hips, chest, legs, arms, neck and head scored together."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..arrays import Array, Indices
from . import limbs
from .anatomy import BODY_HOP, Body
from .joint_names import LIKELY, NOT_A_JOINT, POSSIBLE, SURE
from .limbs import Triples, Units, bell

DETACHED = -5.0
"""A limb or chest that does not descend from the trunk bone it belongs to."""
BESIDE = -2.0
"""The same, when both hang on one bone (a hips bone that is a sibling of the thighs)."""
NO_SHOULDER = -0.6
NO_NECK = -0.8
NO_SPINE = -2.0
NO_ARMS = -8.0
NO_HEAD = -6.0
FOOT_OF_TOES = 4.0
"""What toes say, by their name, for the foot that carries them."""
HAND_FAN = (0.0, 0.0, 1.2, 2.0, 2.5)
"""What 0, 1, 2, 3, 4 or more branches say for a hand (the paper maps a joint with five children to the wrist)."""
HOPELESS = 25.0
"""Hips that score so much below the best are not tried with every chest."""
MOST_ARMS = 64
BEST_HEAD = 2 * SURE + 5.0
"""More than neck and head can ever add; bounds the search."""
WORST = -1e9


@dataclass(frozen=True)
class Choice:
    """One complete body: hips and chest as places in the midline, limbs as triples, neck and head as bones.

    -1 stands for arms, a neck or a head that are missing.
    """

    score: float
    hips: int
    chest: int
    leg: int
    arm: int
    neck: int
    head: int


class Search:
    """Scores of all candidates, trunk bones against limbs, and the best body among them."""

    def __init__(self, body: Body, candidates: Units, legs: Triples, arms: Triples, trust: float) -> None:
        self.body = body
        self.evidence = body.evidence
        self.units = candidates
        self.trust = trust
        self.legs = self._with_toes(legs)
        self.arms = arms
        self.fan = np.array([self._fan(u) for u in range(len(candidates))])
        self.arm_scores = self._with_hands(arms)
        self.middle = [int(b) for b in body.midline]
        self.leg_table = self._attachments(self.legs, self.legs.score)
        scores, self.shoulder_of = self._shoulders()
        if len(self.arm_scores):
            self.arm_scores = self.arm_scores + scores
        self.arm_table = self._attachments(self.arms, self.arm_scores, self.shoulder_of)
        self._heads: dict[tuple[int, int], tuple[int, int, float]] = {}
        self._crowns: dict[int, float] = {}

    def _fan(self, unit: int) -> float:
        """Return how many branches start at a unit (fingers at a hand)."""
        return float(sum(1 for c in self.evidence.tree.children[self.units.main(unit)] if not self.evidence.thing[c]))

    def _with_hands(self, arms: Triples) -> Array:
        if not len(arms.score):
            return arms.score
        fan = np.append(self.fan, 0.0)
        inner = np.maximum(fan[arms.upper], fan[arms.lower]) >= 3
        deeper = np.append([max((fan[v] for v in self.units.below[u]), default=0.0) for u in range(len(fan) - 1)], 0.0)
        early = (deeper[arms.end] >= 3) & (fan[arms.end] < 3)
        hand = np.array(HAND_FAN)[np.minimum(fan[arms.end], 4).astype(int)]
        return arms.score + self.trust * (hand - 1.5 * inner - 2.0 * early)

    def _with_toes(self, legs: Triples) -> Triples:
        """Favour ends from which a bone leads on along the ground, and those called foot with one called toe below."""
        points = self.units.points
        flat, named = np.zeros(len(self.units) + 1), np.zeros(len(self.units) + 1)
        foot, toes = (
            [limbs.unit_score(self.body, self.units, unit, joint) >= LIKELY for unit in range(len(self.units))]
            for joint in ("Foot", "Toes")
        )
        for unit, below in enumerate(self.units.below):
            named[unit] = FOOT_OF_TOES * (foot[unit] and any(toes[toe] for toe in below))
            for toe in below:
                step = points[toe] - points[unit]
                if 0.015 < abs(step[1]) < 0.25 and abs(step[1]) > 0.4 * abs(step[2]):
                    flat[unit] = 0.8
        return replace(legs, score=legs.score + self.trust * flat[legs.end] + named[legs.end])

    def best(self) -> Choice | None:
        """Return the best hips, chest, legs, arms, neck and head together, None when nothing fits."""
        arm_table = self.arm_table
        choices = [self._hips_choice(h) for h in range(len(self.middle))]
        promising = max(score for score, _ in choices) - HOPELESS
        ranked = [np.argsort(row)[::-1][:MOST_ARMS] for row in arm_table]
        likely_arm = arm_table.max(initial=NO_ARMS) - HOPELESS
        best: Choice | None = None
        for h, hips in enumerate(self.middle):
            hips_score, leg = choices[h]
            if hips_score < promising:
                continue
            for t, chest in enumerate(self.middle):
                if not len(arm_table[t]) or arm_table[t, ranked[t][0]] < likely_arm:
                    continue
                link = self._spine_link(hips, chest)
                if link <= WORST:
                    continue
                arm, arm_score = self._arm_beside(arm_table[t], ranked[t], leg)
                total = hips_score + link + self._chest_name(chest, hips) + arm_score
                if best is not None and total + BEST_HEAD < best.score:
                    continue
                neck, head, head_score = self._neck_and_head(chest, arm)
                if best is None or total + head_score > best.score:
                    best = Choice(total + head_score, h, t, leg, arm, neck, head)
        return best

    # --- tables ---

    def _attachments(self, limb: Triples, scores: Array, tops: Indices | None = None) -> Array:
        """Return scores of every triple on every midline bone, shape (midline, triple)."""
        if not len(scores):
            return np.zeros((len(self.middle), 0))
        starts = limb.upper if tops is None else np.where(tops >= 0, tops, limb.upper)
        hang = np.full((len(self.middle), len(self.units)), WORST)
        for unit in np.unique(starts):
            main = self.units.main(int(unit))
            above = self.evidence.tree.ancestors[main]
            for m, bone in enumerate(self.middle):
                hang[m, unit] = self._hang(bone, main, above)
        return scores[None, :] + hang[:, starts]

    def _hang(self, bone: int, main: int, above: Sequence[int]) -> float:
        """Return what a limb that starts at ``main`` loses on a trunk bone, given the bones above the limb."""
        if bone in above:
            return -self.evidence.hops(bone, main)
        for steps, shared in enumerate(self.evidence.tree.ancestors[bone]):
            if shared in above:
                beside = BESIDE - BODY_HOP * steps - self.evidence.hops(shared, main)
                return max(beside, DETACHED)
        return DETACHED - 3.0 * float(np.linalg.norm(self.body.points[bone] - self.body.points[main]))

    def _shoulders(self) -> tuple[Array, Indices]:
        """Return for every arm the best clavicle above it: score and unit (NONE without one), shape (triple,)."""
        score = np.full(len(self.arms.score), NO_SHOULDER)
        unit = np.full(len(self.arms.score), -1)
        for upper in map(int, np.unique(self.arms.upper)):
            best, chosen = NO_SHOULDER, -1
            for above in self.units.ancestors[upper]:
                value = self.shoulder_score(above, upper)
                if value > best:
                    best, chosen = value, above
            here = self.arms.upper == upper
            score[here], unit[here] = best, chosen
        return score, unit

    def shoulder_score(self, unit: int, upper: int) -> float:
        """Return how much a unit looks like the clavicle of an arm that starts at the unit ``upper``."""
        name = limbs.unit_score(self.body, self.units, unit, "Shoulder")
        a, b = self.units.points[unit], self.units.points[upper]
        length = float(np.linalg.norm(b - a))
        # A clavicle starts near the middle of the body and is short.
        form = bell(float(abs(a[0]) / max(abs(b[0]), 1e-6)), 0.15, 0.3, -2.0)
        form += bell(float(length), 0.09, 0.06, -2.0)
        hop = self.evidence.hops(self.units.main(unit), self.units.main(upper))
        return name + self.trust * 0.5 * form - hop

    # --- terms ---

    def _hips_choice(self, h: int) -> tuple[float, int]:
        """Return the score of a midline bone as hips with its best leg, and that leg."""
        leg = int(np.argmax(self.leg_table[h]))
        hips = self.middle[h]
        return self.evidence.score(hips, "hips") + float(self.leg_table[h, leg]) + self._hips_place(hips, leg), leg

    def _hips_place(self, hips: int, leg: int) -> float:
        upper = self.units.points[self.legs.upper[leg]]
        point = self.body.points[hips]
        near = bell(float(point[2] - upper[2]), 0.02, 0.08, -3.0)
        return self.trust * (near + bell(float(point[1] - upper[1]), 0.0, 0.08, -1.0))

    def _spine_link(self, hips: int, chest: int) -> float:
        if hips == chest:
            return NO_SPINE
        if self.evidence.tree.is_below(hips, chest):
            return -0.05 * self.evidence.hops(hips, chest)
        if self.evidence.tree.is_below(chest, hips):
            return WORST
        beside = int(self.evidence.tree.parents[hips])
        if beside >= 0 and self.evidence.tree.is_below(beside, chest):
            return BESIDE - 0.05 * self.evidence.hops(beside, chest)
        return DETACHED

    def _chest_name(self, chest: int, hips: int) -> float:
        if chest == hips:
            return 0.0
        # That a name says "spine" more or less clearly tells little about where the arms are.
        return min(max(self.evidence.score(chest, j) for j in ("upperChest", "chest", "spine")), POSSIBLE)

    def _arm_beside(self, row: Array, ranked: Indices, leg: int) -> tuple[int, float]:
        """Return the best arm that shares no bone with the leg, and its score; -1 when there is none."""
        taken = {int(self.legs.upper[leg]), int(self.legs.lower[leg]), int(self.legs.end[leg])} - {-1}
        for arm in ranked:
            if not taken & {int(self.arms.upper[arm]), int(self.arms.lower[arm]), int(self.arms.end[arm])}:
                value = float(row[arm])
                return (int(arm), value) if value > NO_ARMS else (-1, NO_ARMS)
        return -1, NO_ARMS

    def _neck_and_head(self, chest: int, arm: int) -> tuple[int, int, float]:
        """Return the best neck and head above ``chest`` (-1 for a missing one) and their score."""
        shoulder_bone = self.units.main(int(self.arms.upper[arm])) if arm >= 0 else chest
        key = chest, shoulder_bone
        if key not in self._heads:
            self._heads[key] = self._search_head(chest, float(self.body.points[shoulder_bone, 2]))
        return self._heads[key]

    def _search_head(self, chest: int, shoulder: float) -> tuple[int, int, float]:
        best, score = (-1, -1), NO_HEAD
        for head in self.middle:
            name = self.evidence.score(head, "head")
            if name <= NOT_A_JOINT or not self.evidence.tree.is_below(chest, head):
                continue
            rise = float(self.body.points[head, 2]) - shoulder
            base = name + self.trust * (bell(rise, 0.08, 0.05, -2.0) + self._crown(head))
            for neck in (-1, *self.evidence.tree.path_between(chest, head)):
                value = base + self._neck_score(neck, chest, head, shoulder)
                if value > score:
                    best, score = (neck, head), value
        return *best, score

    def _neck_score(self, neck: int, chest: int, head: int, shoulder: float) -> float:
        if neck < 0:
            return NO_NECK - 0.3 * self.evidence.hops(chest, head)
        skipped = self.evidence.hops(chest, neck) + 0.3 * self.evidence.hops(neck, head)
        rise = float(self.body.points[neck, 2]) - shoulder
        form = bell(float(rise), 0.02, 0.04, -1.5)
        first = 0.25 * len(self.evidence.tree.path_between(chest, neck))  # of several alike the lowest is the neck
        return self.evidence.score(neck, "neck") + self.trust * 0.6 * form - 0.5 * skipped - first

    def _crown(self, head: int) -> float:
        """Return how much what hangs on a bone looks like a face: mirror pairs are good, a long chain is not."""
        if head not in self._crowns:
            self._crowns[head] = self._judge_crown(head)
        return self._crowns[head]

    def _judge_crown(self, head: int) -> float:
        children = self.evidence.tree.children[head]
        while len(children) == 1 and self._coincide(head, children[0]):
            children = self.evidence.tree.children[children[0]]
        if any(self.body.partner[c] >= 0 for c in children):
            return 1.0
        lengths = [np.linalg.norm(self.body.points[c] - self.body.points[head]) for c in children]
        back = float(np.linalg.norm(self.body.points[head] - self.body.points[self.evidence.tree.parents[head]]))
        # The bone above the head only marks its top, and lies farther off than the neck is long.
        return 0.5 if not lengths or max(lengths) > back else -0.5

    def _coincide(self, a: int, b: int) -> bool:
        return float(np.linalg.norm(self.body.points[a] - self.body.points[b])) < 0.01
