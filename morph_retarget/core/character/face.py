"""Jaw and eyes: by name below the head, or by place where a head carries just one pair and one bone in front."""

import numpy as np

from .anatomy import Body, Evidence
from .joint_names import LIKELY, is_extra
from .words import Sense


def find(body: Body, head: int, rest_is_body: bool) -> dict[str, tuple[int, str]]:
    """Return jaw and eyes: "jaw", "leftEye", "rightEye" to bone and kind of evidence; sides are the trial frame's.

    Args:
        body: The rig in its trial frame.
        head: Bone of the head.
        rest_is_body: Whether places can be trusted.
    """
    evidence = body.evidence
    below = evidence.tree.below(head)
    out: dict[str, tuple[int, str]] = {}
    jaws = [b for b in below if evidence.readings[b].side == 0 and evidence.score(b, "jaw") >= LIKELY]
    jaws = [b for b in jaws if not evidence.readings[b].has(Sense.UPPER)]
    if jaws:
        out["jaw"] = (min(jaws, key=lambda b: (len(evidence.tree.ancestors[b]), _wordiness(evidence, b))), "name")
    pairs = [(int(a), int(b)) for a, b in body.pairs]
    eyes = [both for p, both in enumerate(pairs) if set(both) <= set(below) and body.pair_score(p, "Eye") >= LIKELY]
    if eyes:
        left, right = min(eyes, key=lambda e: (_wordiness(evidence, e[0]), len(evidence.tree.ancestors[e[0]])))
        out["leftEye"], out["rightEye"] = (left, "name"), (right, "name")
    elif rest_is_body:
        out |= _by_place(body, head, below)
    return out


def _wordiness(evidence: Evidence, bone: int) -> int:
    reading = evidence.readings[bone]
    return len(reading.words) + 3 * is_extra(reading)


def _by_place(body: Body, head: int, below: list[int]) -> dict[str, tuple[int, str]]:
    evidence = body.evidence
    if any(evidence.readings[b].known for b in below):
        return {}  # a face whose names we can read has no eyes among them
    top = head
    while len(evidence.tree.children[top]) == 1 and evidence.tree.children[evidence.tree.children[top][0]]:
        top = evidence.tree.children[top][0]
    leaves = [b for b in evidence.tree.children[top] if not evidence.tree.children[b]]
    pairs = [(int(a), int(b)) for a, b in body.pairs if a in leaves and b in leaves]
    if len(pairs) != 1:
        return {}
    left, right = pairs[0]
    ahead = abs(float(body.points[left, 1] - body.points[head, 1]))
    apart = float(np.linalg.norm(body.points[left] - body.points[right]))
    if not (0.02 < ahead < 0.2 and 0.01 < apart < 0.15):
        return {}
    out = {"leftEye": (left, "geometry"), "rightEye": (right, "geometry")}
    front = np.sign(body.points[left, 1] - body.points[head, 1])
    lower = [
        b
        for b in evidence.tree.children[top]
        if body.partner[b] < 0 and body.points[b, 2] < body.points[left, 2] - 0.005
    ]
    lower = [b for b in lower if front * (body.points[b, 1] - body.points[head, 1]) > -0.01]
    if len(lower) == 1:
        out["jaw"] = (lower[0], "geometry")
    return out
