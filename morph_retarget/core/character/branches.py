"""Branches off the trunk that could be limbs: those beside the middle, and legs that stand in it."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Array, Flags
from . import trunk
from .anatomy import Body, Evidence
from .mirror import ALONE
from .words import Sense

LEG_SENSES = (
    Sense.LEG, Sense.UPPER_LEG, Sense.LOWER_LEG, Sense.KNEE, Sense.ANKLE, Sense.FOOT, Sense.PAW, Sense.TOE,
)  # fmt: skip
GROUNDED = 0.13
"""A limb whose lowest bone is nearer to the ground than this share of its attachment's height stands on it."""
ON_MIDDLE = 0.03
"""A bone without a partner lies on the middle when it is no further off than this [heights]."""
STARTS_HIGH = 0.5
"""A leg of the middle starts over this share of its attachment's height: what starts lower only lies on the ground."""
MOST_BEYOND = 0.6
"""What hangs on its foot reaches no further than this share of the leg's length."""
MOST_WAY = 1.6
"""Without names it is no longer than so many times what it goes down: a tail that lies on the ground is …"""
UNDER = 0.1
"""… and beside other legs its foot is under what carries it, to this much [heights]: a tail that hangs is behind …"""
BEHIND = 0.05
"""… and no further behind the feet of legs that hang on the same bone than this [heights]."""


@dataclass(frozen=True)
class Branch:
    """A branch off the trunk before it is judged."""

    bones: tuple[int, ...]
    digits: tuple[int, ...]
    side: int
    attachment: int
    in_middle: bool = False
    """Whether it hangs in the plane of symmetry, as a third leg does, and the leg of a body that hops on one."""


def find(body: Body, left_is_x: bool) -> list[Branch]:
    """Return every branch of bones that could be a limb.

    Args:
        body: The rig in its trial frame.
        left_is_x: Whether the trial frame's +X is the character's left.
    """
    aside = _aside(body, left_is_x)
    legs = _in_middle(body, aside)
    taken = {b for leg in legs for b in leg.bones}
    return [*(b for b in aside if b.attachment not in taken), *legs]


def is_grounded(body: Body, branch: Branch) -> bool:
    """Return whether a branch stands on the ground."""
    heights = body.points[list(branch.bones) + list(branch.digits), 2]
    start = _start(body, branch)
    return bool(heights.min() < GROUNDED * max(start, 0.1)) and start > 0.08


def reach_of(evidence: Evidence, bone: int) -> float:
    """Return the longest way from a bone's parent to an end below it [m]."""
    own = float(np.linalg.norm(evidence.positions[bone] - evidence.positions[evidence.tree.parents[bone]]))
    return own + max((reach_of(evidence, c) for c in evidence.tree.children[bone]), default=0.0)


def _start(body: Body, branch: Branch) -> float:
    return max(float(body.points[branch.bones[0], 2]), float(body.points[branch.attachment, 2]))


# --- beside the middle ---


def _aside(body: Body, left_is_x: bool) -> list[Branch]:
    """Return every branch of bones off the middle that could be a limb."""
    evidence = body.evidence
    off_middle = _off_middle(body)
    out: list[Branch] = []

    def start(bone: int, attachment: int, above: tuple[int, ...]) -> None:
        """Collect the branch that begins with ``above`` and ``bone`` and hangs on ``attachment``."""
        line, reach = [*above, bone], 0.0
        while True:
            below = [c for c in evidence.tree.children[line[-1]] if not evidence.thing[c] and not _is_spur(evidence, c)]
            if not below:
                break
            if len(below) > 1:
                lengths = [reach_of(evidence, c) for c in below]
                long = [c for c, length in zip(below, lengths, strict=True) if length > max(reach, 0.25 * body.size)]
                if len(long) > 1 and not _is_extremity(evidence, line[-1]):
                    for child in long:
                        start(child, attachment, ())
                    return
                if _is_extremity(evidence, line[-1]) or len(below) > 2 or max(lengths) < 0.5 * reach:
                    break
                below = [below[int(np.argmax(lengths))]]
            reach += float(np.linalg.norm(evidence.positions[below[0]] - evidence.positions[line[-1]]))
            line.append(below[0])
        digits = evidence.tree.below(line[-1])
        side = evidence.readings[bone].side or int(np.sign(body.points[bone, 0])) * (1 if left_is_x else -1)
        if body.partner[bone] >= 0 and abs(body.points[bone, 0]) > 0.02:
            side = int(np.sign(body.points[bone, 0])) * (1 if left_is_x else -1)
        if side == 0:  # it starts on the middle, and leads away from it
            lean = float(body.points[line, 0].mean()) or float(body.partner[bone] - bone)
            side = int(np.sign(lean)) * (1 if left_is_x else -1)
        out.append(Branch(tuple(line), tuple(digits), side, attachment))

    for bone in range(len(evidence)):
        parent = int(evidence.tree.parents[bone])
        if off_middle[bone] and not evidence.thing[bone] and parent >= 0 and not off_middle[parent]:
            start(bone, parent, ())
    return out


def _off_middle(body: Body) -> Flags:
    """Return which bones lie beside the middle, shape (bone,).

    What carries both bones of a pair is of the middle, however far a rest that leans to the side has it.
    """
    ancestors = body.evidence.tree.ancestors
    carriers = {b for left, right in body.pairs for b in {*ancestors[int(left)]} & {*ancestors[int(right)]}}
    alone = (body.partner == ALONE) & (np.abs(body.points[:, 0]) > ON_MIDDLE)
    alone[list(carriers)] = False
    return (body.partner >= 0) | alone


# --- in the middle ---


def _in_middle(body: Body, aside: Sequence[Branch]) -> list[Branch]:
    """Return the legs that stand in the middle: those that names call so, and nameless ones that look like it.

    Args:
        body: The rig in its trial frame.
        aside: The branches beside the middle.
    """
    head, _ = trunk.find_head(body)
    named = [b for b in _called_legs(body, head) if _stands(body, b)]
    if head is None:
        return named
    found = [b for b in _nameless(body, head) if _stands(body, b) and _is_steep(body, b)]
    taken = {bone for leg in (*named, *found) for bone in leg.bones}
    others = [*named, *(b for b in aside if b.attachment not in taken and is_grounded(body, b))]
    return [*named, *(b for b in found if not others or _is_under(body, b, head, others))]


def _called_legs(body: Body, head: int | None) -> Iterator[Branch]:
    """Yield branches of the middle from the first bone on that is called a part of a leg."""
    evidence, off_middle = body.evidence, _off_middle(body)
    for bone, reading in enumerate(evidence.readings):
        parent = int(evidence.tree.parents[bone])
        first = parent >= 0 and reading.has(*LEG_SENSES) and not evidence.readings[parent].has(*LEG_SENSES)
        if not first or off_middle[bone] or off_middle[parent] or evidence.thing[bone]:
            continue
        branch = _down(body, bone, off_middle)
        if not any(evidence.readings[b].has(Sense.TAIL) for b in branch.bones) and not _of_head(evidence, bone, head):
            yield branch


def _nameless(body: Body, head: int) -> Iterator[Branch]:
    """Yield branches of the middle without names that hang on the bones from the root up to the neck."""
    evidence, off_middle = body.evidence, _off_middle(body)
    # What hangs on the bone before the head may be a trunk or a beard.
    for parent in evidence.tree.ancestors[head][1:]:
        for bone in evidence.tree.children[parent]:
            if off_middle[bone] or off_middle[parent] or _of_head(evidence, bone, head):
                continue
            branch = _down(body, bone, off_middle)
            if not any(evidence.readings[b].known for b in branch.bones):
                yield branch


def _of_head(evidence: Evidence, bone: int, head: int | None) -> bool:
    """Return whether a bone is, carries or hangs on the head."""
    return head is not None and (
        bone == head or evidence.tree.is_below(bone, head) or evidence.tree.is_below(head, bone)
    )


def _down(body: Body, bone: int, off_middle: Flags) -> Branch:
    """Return the branch of the middle that starts with a bone; where it parts it ends, but for a much longer way."""
    evidence, line = body.evidence, [bone]
    while True:
        below = [c for c in evidence.tree.children[line[-1]] if not evidence.thing[c] and not _is_spur(evidence, c)]
        ways = sorted((reach_of(evidence, c), c) for c in below)
        if not below or off_middle[below].any() or (len(ways) > 1 and ways[-2][0] > 0.5 * ways[-1][0]):
            break
        line.append(ways[-1][1])
    parent = int(evidence.tree.parents[bone])
    return Branch(tuple(line), tuple(evidence.tree.below(line[-1])), 0, parent, True)


def _foot(body: Body, branch: Branch) -> int:
    """Return the place in a branch of the first bone that is near the ground, of the last one if none is."""
    low = body.points[list(branch.bones), 2] < GROUNDED * _start(body, branch)
    return int(np.argmax(low)) if low.any() else len(low) - 1


def _stands(body: Body, branch: Branch) -> bool:
    """Return whether a branch goes from above down to the ground, and ends there."""
    evidence, foot = body.evidence, _foot(body, branch)
    starts_high = float(body.points[branch.bones[0], 2]) > STARTS_HIGH * _start(body, branch)
    if foot == 0 or not starts_high or not is_grounded(body, branch):
        return False
    beyond = max((reach_of(evidence, c) for c in evidence.tree.children[branch.bones[foot]]), default=0.0)
    return beyond < MOST_BEYOND * _way(body, branch) * body.size


def _way(body: Body, branch: Branch) -> float:
    """Return the length of a branch from its first bone to its foot, in heights."""
    points = body.points[list(branch.bones[: _foot(body, branch) + 1])]
    return float(np.linalg.norm(np.diff(points, axis=0), axis=-1).sum())


def _is_steep(body: Body, branch: Branch) -> bool:
    """Return whether a branch goes down to its foot, rather than along."""
    drop = (body.points[branch.bones[0]] - _foot_point(body, branch))[2]
    return _way(body, branch) < MOST_WAY * float(drop)


def _is_under(body: Body, branch: Branch, head: int, others: Sequence[Branch]) -> bool:
    """Return whether the foot of a branch is under what carries it, and not behind the other legs there."""
    tree, carrier = body.evidence.tree, branch.attachment
    step = (_foot_point(body, branch) - body.points[carrier])[:2]
    forward = np.sign(body.points[head, 1] - body.points[carrier, 1])
    # Legs nearer to the head say nothing: there may be one hind leg.
    beside = [b for b in others if not tree.is_below(carrier, b.attachment)]
    behind = [forward * (_foot_point(body, b) - _foot_point(body, branch))[1] for b in beside]
    return bool(np.linalg.norm(step) < UNDER and min(behind, default=0.0) < BEHIND)


def _foot_point(body: Body, branch: Branch) -> Array:
    """Return where the foot of a branch is, shape (3,)."""
    return body.points[branch.bones[_foot(body, branch)]]


# --- bones ---


def _is_spur(evidence: Evidence, bone: int) -> bool:
    """Return whether a bone only hangs on its parent: a feather, or a twist, heel or share bone without children."""
    reading = evidence.readings[bone]
    return reading.has(Sense.FEATHER) or (
        not evidence.tree.children[bone] and reading.has(Sense.TWIST, Sense.HELPER, Sense.HEEL)
    )


def _is_extremity(evidence: Evidence, bone: int) -> bool:
    return evidence.readings[bone].has(Sense.HAND, Sense.WRIST, Sense.PAW)
