"""The trunk of any body: head, pelvis, spine, neck and tails, from names first and from the shape where they fail."""

from collections.abc import Sequence, Set
from dataclasses import dataclass

import numpy as np

from .anatomy import Body, Evidence
from .joint_names import is_extra
from .words import Sense

_FACE = (Sense.EYE, Sense.EAR, Sense.JAW, Sense.MOUTH, Sense.FACE)
_SPINE = (Sense.SPINE, Sense.HIPS, Sense.CHEST, Sense.BODY)


@dataclass(frozen=True)
class Trunk:
    """Bones of the middle of a body, each list from the pelvis outward."""

    root: int
    spine: tuple[int, ...]
    neck: tuple[int, ...]
    head: int | None
    head_by: str
    tails: tuple[tuple[int, ...], ...]


def find(
    body: Body,
    attachments: Sequence[int],
    leg_attachments: Sequence[int],
    leg_rows: int,
    in_legs: Set[int] = frozenset(),
) -> Trunk:
    """Return the trunk of ``body``.

    Args:
        body: The rig in its trial frame.
        attachments: Bones on which arms, legs and wings hang.
        leg_attachments: Those on which legs hang.
        leg_rows: Pairs of legs; bodies with three and more have no neck.
        in_legs: Bones of legs that stand in the middle, where tails are.
    """
    evidence = body.evidence
    head, head_by = find_head(body)
    pelvis = _pelvis(body, head, leg_attachments or attachments)
    line = _line(evidence, pelvis, head) if head is not None else [pelvis]
    while evidence.tree.parents[line[0]] >= 0 and _is_spine(evidence, int(evidence.tree.parents[line[0]])):
        line.insert(0, int(evidence.tree.parents[line[0]]))
    tails = [tail for tail in _tails(body, line, head) if not in_legs & {*tail}]
    line = [line[0], *(b for b in line[1:] if not _is_tail(evidence, b))]
    in_tail = {b for tail in tails for b in tail}
    neck = _neck(evidence, line, attachments) if leg_rows < 3 else ()
    spine = [b for b in line if b not in neck and b != head and b not in in_tail]
    if not attachments:
        spine, neck = _legless(evidence, head)
        if not tails and len(spine) > 3:
            tails = [tuple(spine[len(spine) // 2 :])]  # a snake's tail is where nobody says otherwise
    off_line = [b for b in range(len(evidence)) if _is_spine(evidence, b) and b not in (*line, *in_tail)]
    spine += [b for b in off_line if head is None or not evidence.tree.is_below(head, b)]
    if not spine:
        spine = [b for b in range(len(evidence)) if evidence.readings[b].has(*_SPINE) and not evidence.thing[b]]
    root = (evidence.tree.ancestors[pelvis] or [pelvis])[-1]
    return Trunk(root, tuple(dict.fromkeys(spine)), tuple(neck), head, head_by, tuple(tails))


def find_head(body: Body) -> tuple[int | None, str]:
    """Return the bone of the (first) head and the evidence for it; None where no bone stands out."""
    evidence = body.evidence
    named = [b for b in range(len(evidence)) if evidence.score(b, "head") >= 4.0 and not is_extra(evidence.readings[b])]
    named = [b for b in named if not evidence.readings[b].side] or named
    if named:
        return min(named, key=lambda b: (len(evidence.tree.ancestors[b]), b)), "name"
    face = [b for b in range(len(evidence)) if evidence.readings[b].has(*_FACE) and not evidence.thing[b]]
    if len(face) >= 2:
        top = evidence.tree.meeting(face)
        if top is not None:
            reading = evidence.readings[top]
            return (int(evidence.tree.parents[top]), "topology") if reading.has(Sense.FACE) else (top, "topology")
    return _front_end(body), "geometry"


def _front_end(body: Body) -> int | None:
    """Return the end of the middle line that lies highest."""
    evidence = body.evidence
    middle = [int(b) for b in body.midline]
    ends = [b for b in middle if not any(c in middle for c in evidence.tree.children[b])]
    ends = [
        b for b in ends if len(evidence.tree.ancestors[b]) >= 2 and not evidence.thing[b] and not _is_tail(evidence, b)
    ]
    if not ends:
        return None
    best = max(ends, key=lambda b: float(body.points[b, 2]))
    return int(evidence.tree.parents[best]) if is_extra(evidence.readings[best]) else best


def _pelvis(body: Body, head: int | None, attachments: Sequence[int]) -> int:
    evidence = body.evidence
    named = [b for b in range(len(evidence)) if evidence.score(b, "hips") >= 3.0 and not evidence.readings[b].side]
    if attachments:
        # Of all bones with legs the one farthest from the head carries the hind legs.
        line = [b for b in attachments if b in body.midline and not _is_tail(evidence, b)] or list(attachments)
        if head is None:
            return line[0]
        return max(line, key=lambda b: float(np.linalg.norm(body.points[b] - body.points[head])))
    if named:
        return named[0]
    return (
        int(evidence.tree.children[evidence.tree.order[0]][0])
        if evidence.tree.children[evidence.tree.order[0]]
        else evidence.tree.order[0]
    )


def _line(evidence: Evidence, pelvis: int, head: int) -> list[int]:
    """Return the bones from the pelvis to the head, over their common ancestor when one is not above the other."""
    direct = evidence.tree.path(pelvis, head)
    if direct:
        return direct
    if evidence.tree.is_below(head, pelvis):
        return evidence.tree.path(head, pelvis)[::-1]
    top = evidence.tree.meeting([pelvis, head])
    if top is None:
        return [
            pelvis,
            *evidence.tree.path(evidence.tree.ancestors[head][-1] if evidence.tree.ancestors[head] else head, head),
        ]
    return [pelvis, *evidence.tree.path(top, head)[1:]]


def _is_spine(evidence: Evidence, bone: int) -> bool:
    reading = evidence.readings[bone]
    if reading.side or evidence.thing[bone] or is_extra(reading) or reading.has(Sense.TAIL, Sense.NECK, Sense.ROOT):
        return False
    # A body bone at the very root stands for the whole character, not for a vertebra.
    only_body = not reading.has(Sense.SPINE, Sense.HIPS, Sense.CHEST)
    return reading.has(*_SPINE) and not (
        only_body and evidence.tree.parents[bone] < 0 and len(evidence.tree.children[bone]) > 0
    )


def _is_tail(evidence: Evidence, bone: int) -> bool:
    return evidence.readings[bone].has(Sense.TAIL)


def _neck(evidence: Evidence, line: Sequence[int], attachments: Sequence[int]) -> tuple[int, ...]:
    """Return the bones between the foremost limbs and the head: all of them, or from the first that says neck."""
    last = max((i for i, b in enumerate(line[:-1]) if b in attachments), default=0)
    between = [b for b in line[last + 1 : -1] if not evidence.thing[b]]
    named = [i for i, b in enumerate(between) if evidence.readings[b].has(Sense.NECK)]
    return tuple(between[named[0] :] if named else between)


def _tails(body: Body, line: Sequence[int], head: int | None) -> list[tuple[int, ...]]:
    """Return chains of the middle that are called tail, or lead away from the head behind the pelvis."""
    evidence = body.evidence
    out: list[tuple[int, ...]] = []
    for start in range(len(evidence)):
        parent = int(evidence.tree.parents[start])
        if start in line or (parent >= 0 and _is_tail(evidence, parent)) or evidence.thing[start]:
            continue
        named = _is_tail(evidence, start) and not is_extra(evidence.readings[start])
        named = named and not evidence.readings[start].has(Sense.FIN)
        if named or (parent in line[:2] and _leads_back(body, start, line, head)):
            out.append(_chain(evidence, start))
    return out


def _leads_back(body: Body, start: int, line: Sequence[int], head: int | None) -> bool:
    evidence = body.evidence
    if head is None or body.partner[start] >= 0 or len(line) < 2 or evidence.readings[start].has(Sense.FLESH):
        return False
    chain = _chain(evidence, start)
    if any(body.partner[b] >= 0 for b in chain) or (len(chain) < 2 and not _to_tail(evidence, start)):
        return False
    if any(evidence.by_name[b] >= 0 or evidence.readings[b].has(Sense.NECK, Sense.HEAD) for b in chain):
        return False  # a rest that is bent may have a leg behind, or look like an animal from behind
    forward = body.points[head] - body.points[line[0]]
    back = body.points[max(chain, key=lambda b: len(evidence.tree.ancestors[b]))] - body.points[line[0]]
    level = forward[:2] @ back[:2] < 0.0 and np.linalg.norm(back[:2]) > 0.1
    return bool(level) and not evidence.readings[start].has(Sense.FACE)


def _to_tail(evidence: Evidence, start: int) -> bool:
    return any(_is_tail(evidence, c) for c in evidence.tree.children[start])


def _chain(evidence: Evidence, start: int) -> tuple[int, ...]:
    """Return ``start`` and its line of descendants, without end markers."""
    line = [start]
    while evidence.tree.children[line[-1]]:
        below = [c for c in evidence.tree.children[line[-1]] if not evidence.readings[c].side]
        if not below:
            break
        line.append(max(below, key=lambda c: _length(evidence, c)))
    kept = [b for b in line if not evidence.readings[b].has(Sense.END) or b == start]
    # "Tail_End" with a tip below it is a tail bone like the others.
    return tuple(line[: line.index(kept[-1]) + 1]) if kept[-1] == line[-1] or len(line) < 3 else tuple(line[:-1])


def _length(evidence: Evidence, bone: int) -> int:
    return 1 + max((_length(evidence, c) for c in evidence.tree.children[bone]), default=0)


def _legless(evidence: Evidence, head: int | None) -> tuple[list[int], tuple[int, ...]]:
    """Return spine and neck of a body without limbs: the longest way from its head through the tree."""
    if head is None:
        return [], ()
    way = max(
        (evidence.tree.way(head, b) for b in range(len(evidence)) if _may_end(evidence, head, b)),
        key=len,
        default=[head],
    )
    line = [b for b in way[1:] if not evidence.readings[b].has(Sense.END)]
    if len(line) < 3:
        return [], ()
    return line, tuple(b for b in line if evidence.readings[b].has(Sense.NECK))


def _may_end(evidence: Evidence, head: int, bone: int) -> bool:
    reading = evidence.readings[bone]
    return (
        bone != head
        and evidence.by_name[bone] < 0  # what names call left or right is a limb that was not seen
        and not evidence.thing[bone]
        and not reading.has(Sense.MOUTH, Sense.FACE, Sense.EYE, Sense.JAW, Sense.ROOT)
    )
