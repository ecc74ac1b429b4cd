"""Capabilities and limbs of any body: what each bone can do, and where its legs, arms, wings and fins are.

The capabilities are those of Hecker 2008 §1.2; the paper's players tag bodies by the parts they choose, we read the
tags from names, from the tree and from where limbs end.
"""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from . import branches as branching
from . import trunk
from .anatomy import Body, Evidence
from .branches import LEG_SENSES, Branch
from .joint_names import is_extra
from .trunk import Trunk
from .words import DIGITS, Sense


class Capability(StrEnum):
    """What a bone is to the animation system."""

    ROOT = "root"
    SPINE = "spine"
    NECK = "neck"
    HEAD = "head"
    MOUTH = "mouth"
    EYE = "eye"
    EAR = "ear"
    GRASPER = "grasper"
    FOOT = "foot"
    LIMB = "limb"
    TAIL = "tail"
    WING = "wing"
    FIN = "fin"
    FINGER = "finger"


class LimbKind(StrEnum):
    """What a limb is for."""

    LEG = "leg"
    ARM = "arm"
    WING = "wing"
    FIN = "fin"
    TENTACLE = "tentacle"


@dataclass(frozen=True)
class Limb:
    """A leg, arm, wing or fin: bones from the trunk outward to the foot or hand."""

    kind: LimbKind
    side: int
    """+1 left, -1 right, 0 on the middle."""
    row: int
    """Counted from the front among limbs of the same kind, 0 first."""
    bones: tuple[int, ...]
    digits: tuple[int, ...] = ()
    """Bones beyond the last of ``bones``: toes or fingers."""

    @property
    def end(self) -> int:
        """The foot, hand or tip."""
        return self.bones[-1]


_KINDS: Mapping[LimbKind, tuple[Sense, ...]] = {
    LimbKind.WING: (Sense.WING,),
    LimbKind.FIN: (Sense.FIN,),
    LimbKind.TENTACLE: (Sense.TENTACLE,),
    LimbKind.LEG: LEG_SENSES,
    LimbKind.ARM: (
        Sense.ARM, Sense.UPPER_ARM, Sense.LOWER_ARM, Sense.ELBOW, Sense.WRIST, Sense.HAND, *DIGITS, Sense.FINGER,
    ),
}  # fmt: skip
_NOT_LIMBS = (
    Sense.EAR,
    Sense.EYE,
    Sense.FACE,
    Sense.MOUTH,
    Sense.JAW,
    Sense.ANTENNA,
    Sense.FLESH,
    Sense.HAIR,
    Sense.CLOTH,
)

FOOT_HEIGHT = 0.055
"""The foot is the first bone of a leg that starts lower than this share of the leg's attachment."""
NAMED_FOOT_HEIGHT = 0.25
"""The same for a bone that is called foot or paw, above one that is called neither toe nor foot …"""
FOOT_ABOVE_TOE_HEIGHT = 0.10
"""… and above one that is called toe: a high "foot" over a toe is a hock."""
NO_FOOT_HEIGHT = 0.25
"""A last bone that starts higher than this is a shank, and the marker of its end on the ground is the foot: so it is
with legs that end in a point, as those of spiders do."""


@dataclass(frozen=True)
class Morphology:
    """Trunk and limbs of a body."""

    trunk: Trunk
    limbs: tuple[Limb, ...]

    def of(self, kind: LimbKind) -> list[Limb]:
        """Return all limbs of one kind, front row first, left before right."""
        return sorted((m for m in self.limbs if m.kind is kind), key=lambda m: (m.row, -m.side))


def find(body: Body, left_is_x: bool) -> Morphology:
    """Return the trunk and limbs of ``body``.

    Args:
        body: The rig in its trial frame.
        left_is_x: Whether the trial frame's +X is the character's left.
    """
    branches = branching.find(body, left_is_x)
    kinds = _kinds(body, branches)
    limbs: list[Limb] = []
    for kind in LimbKind:
        chosen = [b for b, k in zip(branches, kinds, strict=True) if k is kind]
        limbs.extend(_rows(body, kind, chosen, left_is_x))
    attachments = [b.attachment for b, k in zip(branches, kinds, strict=True) if k is not None]
    legs = [b.attachment for b, k in zip(branches, kinds, strict=True) if k is LimbKind.LEG]
    rows = len({m.row for m in limbs if m.kind is LimbKind.LEG})
    in_middle = {b for limb in limbs if limb.kind is LimbKind.LEG and limb.side == 0 for b in limb.bones}
    return Morphology(trunk.find(body, attachments, legs, rows, in_middle), tuple(limbs))


# --- kinds ---


def _kinds(body: Body, branches: Sequence[Branch]) -> list[LimbKind | None]:
    """Return what each branch is, None for ears, eyes, hair and the like."""
    grounded = _grounded(body, branches)
    said = [_said(body.evidence, b) for b in branches]
    standing = any(g and s in (LimbKind.LEG, None, LimbKind.ARM) for g, s in zip(grounded, said, strict=True))
    kinds = [_kind(body, b, g, s, standing) for b, g, s in zip(branches, grounded, said, strict=True)]
    if LimbKind.LEG in kinds:
        # What swims is a wing on a body that walks (a penguin).
        return [LimbKind.WING if k is LimbKind.FIN and b.side else k for k, b in zip(kinds, branches, strict=True)]
    flippers = [
        k is LimbKind.FIN and b.side != 0 and _is_flipper(body.evidence, b)
        for k, b in zip(kinds, branches, strict=True)
    ]
    if sum(flippers) >= 4:
        return [
            LimbKind.LEG if f else k for f, k in zip(flippers, kinds, strict=True)
        ]  # a turtle walks on its flippers
    return kinds


def _grounded(body: Body, branches: Sequence[Branch]) -> list[bool]:
    """Return which branches stand on the ground, or would: a rest that walks has lifted one foot of a pair."""
    standing = {b.bones[0] for b in branches if branching.is_grounded(body, b)}
    return [bool(standing & {b.bones[0], int(body.partner[b.bones[0]])}) for b in branches]


def _is_flipper(evidence: Evidence, branch: Branch) -> bool:
    return any({"flipper", "flippers"} & set(evidence.readings[b].words) for b in branch.bones)


def _said(evidence: Evidence, branch: Branch) -> LimbKind | str | None:
    votes: Counter[LimbKind | str] = Counter()
    for bone in (*branch.bones, *branch.digits):
        reading = evidence.readings[bone]
        if reading.has(*_NOT_LIMBS):
            votes["other"] += 1
        for kind, senses in _KINDS.items():
            if reading.has(*senses):
                votes[kind] += 1
                break
    return votes.most_common(1)[0][0] if votes else None


def _kind(body: Body, branch: Branch, grounded: bool, said: LimbKind | str | None, standing: bool) -> LimbKind | None:
    evidence = body.evidence
    if branch.in_middle:
        return LimbKind.LEG if said in (LimbKind.LEG, None) else None
    if said in (LimbKind.WING, LimbKind.FIN, LimbKind.TENTACLE):
        return LimbKind(said)
    if any(
        evidence.readings[b].has(Sense.HEAD) for b in (branch.attachment, *evidence.tree.ancestors[branch.attachment])
    ):
        return None  # what grows on a head is an ear, an antler or hair
    if said == "other" or evidence.readings[branch.bones[0]].has(Sense.TAIL):
        return None
    length = branching.reach_of(evidence, branch.bones[0]) / body.size
    if said is LimbKind.LEG:
        return LimbKind.LEG if grounded or not standing else LimbKind.ARM
    if said is LimbKind.ARM:
        return LimbKind.LEG if grounded and not _ends_in_hand_above_ground(body, branch) else LimbKind.ARM
    if any(evidence.readings[b].known for b in branch.bones) and not _says_shoulder(evidence, branch):
        return None
    if len(branch.bones) < 2 or length < 0.2:
        return None
    return LimbKind.LEG if grounded else LimbKind.ARM


def _says_shoulder(evidence: Evidence, branch: Branch) -> bool:
    return any(evidence.readings[b].has(Sense.SHOULDER, Sense.CLAVICLE, Sense.HIP, Sense.HIPS) for b in branch.bones)


def _ends_in_hand_above_ground(body: Body, branch: Branch) -> bool:
    """Return whether an arm that reaches down is still an arm: both hands hang above other, lower limbs."""
    end = branch.bones[-1]
    hands = [end, int(body.partner[end])] if body.partner[end] >= 0 else [end]
    return float(body.points[hands, 2].min()) > 0.2


# --- limbs ---


def _rows(body: Body, kind: LimbKind, branches: Sequence[Branch], left_is_x: bool) -> list[Limb]:
    """Return the limbs of one kind, numbered from the front; partners share a row, and a leg between them does."""
    front = -1.0 if left_is_x else 1.0
    pairs: dict[int, float] = {}
    for branch in branches:
        key = _pair(body, branch, branches)
        pairs[key] = max(pairs.get(key, -np.inf), _place(body, branch) * front)
    order = {key: row for row, key in enumerate(sorted(pairs, key=lambda k: -pairs[k]))}
    out: list[Limb] = []
    for branch in branches:
        key = _pair(body, branch, branches)
        bones, digits = branch.bones, branch.digits
        if kind is LimbKind.LEG:
            bones, digits = _end_at_foot(body, branch)
        elif kind in (LimbKind.ARM, LimbKind.WING):
            bones, digits = _end_at_hand(body.evidence, branch)
        out.append(Limb(kind, branch.side, order[key], bones, digits))
    return out


def _pair(body: Body, branch: Branch, branches: Sequence[Branch]) -> int:
    """Return the first bone of a branch or its partner, the lower of both; in the middle that of the pair beside it."""
    beside = [b for b in branches if branch.in_middle and not b.in_middle and b.attachment == branch.attachment]
    if beside:
        branch = min(beside, key=lambda b: abs(_place(body, b) - _place(body, branch)))
    partner = int(body.partner[branch.bones[0]])
    return min(branch.bones[0], partner) if partner >= 0 else branch.bones[0]


def _place(body: Body, branch: Branch) -> float:
    """Return how far back a branch is, in heights of the rig."""
    return float(np.mean(body.points[[*branch.bones, *branch.digits], 1]))


def _end_at_foot(body: Body, branch: Branch) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Cut a leg at the bone that meets the ground."""
    evidence = body.evidence
    line = [b for b in branch.bones if not evidence.readings[b].has(Sense.END)] or list(branch.bones)
    height = max(float(body.points[branch.attachment, 2]), float(body.points[line[0], 2]), 0.05)
    rise = body.points[line, 2] / height
    low = [i for i in range(1, len(line)) if rise[i] < FOOT_HEIGHT]
    foot = low[0] if low else len(line) - 1
    named = [evidence.readings[b].has(Sense.FOOT, Sense.PAW) and not evidence.readings[b].has(Sense.TOE) for b in line]
    limit = FOOT_ABOVE_TOE_HEIGHT if evidence.readings[line[foot]].has(Sense.TOE) else NAMED_FOOT_HEIGHT
    while foot > 1 and named[foot - 1] and rise[foot - 1] < limit:
        foot -= 1
    if rise[foot] > NO_FOOT_HEIGHT:
        ends = [b for b in evidence.tree.children[line[foot]] if b in branch.bones or b in branch.digits]
        reaching = [b for b in ends if float(body.points[b, 2]) < FOOT_HEIGHT * float(body.points[line, 2].max())]
        if len(reaching) == 1:
            line = [*line[: foot + 1], *reaching]
            foot += 1
    own = line[: foot + 1]
    beyond = (*line[foot + 1 :], *(b for b in branch.bones if b not in line), *branch.digits)
    return tuple(own), tuple(bone for bone in beyond if bone not in own)


def _end_at_hand(evidence: Evidence, branch: Branch) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Cut an arm at its hand: the bone of that name, or the last before markers and single fingers."""
    line = list(branch.bones)
    hands = [i for i, b in enumerate(line) if evidence.readings[b].has(Sense.HAND, Sense.WRIST)]
    hands = [i for i in hands if not evidence.readings[line[i]].has(*DIGITS, Sense.FINGER, Sense.END)]
    last = hands[-1] if hands else len(line) - 1
    while not hands and last > 0 and is_extra(evidence.readings[line[last]]):
        last -= 1
    return tuple(line[: last + 1]), (*line[last + 1 :], *branch.digits)
