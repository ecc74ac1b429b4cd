"""Fingers: which chain below a hand is which digit, and which of its bones are the VRM joints.

Names decide where they speak ("Index1", "Finger21", "finger2-1"); otherwise the thumb is the branch that leaves the
wrist first and sideways, and the rest follow from it across the palm.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .. import quat
from ..arrays import Array
from .anatomy import Evidence
from .joint_names import is_extra
from .names import Reading
from .words import DIGITS, Sense

THUMB_JOINTS = ("Metacarpal", "Proximal", "Distal")
FINGER_JOINTS = ("Proximal", "Intermediate", "Distal")
LABELS = {
    Sense.THUMB: "Thumb",
    Sense.INDEX: "Index",
    Sense.MIDDLE: "Middle",
    Sense.RING: "Ring",
    Sense.LITTLE: "Little",
}
ORDER = ("Thumb", "Index", "Middle", "Ring", "Little")


@dataclass(frozen=True)
class Chain:
    """One branch below the hand, from its first own bone to its tip."""

    bones: tuple[int, ...]
    digit: str | None
    """"Thumb" … "Little" when names tell."""
    number: int | None
    """Number of the finger when names only count them."""


def find(evidence: Evidence, hand: int, forward: Array) -> dict[str, tuple[int, str]]:
    """Return the finger joints below ``hand``: unsided joint ("IndexProximal") to bone and kind of evidence.

    Args:
        evidence: The rig.
        hand: Bone of the hand.
        forward: The character's forward direction, world space; orders nameless fingers when the thumb is unclear.
    """
    chains = _chains(evidence, hand)
    digits = _by_name(chains) if any(c.digit or c.number is not None for c in chains) else {}
    by = "name"
    if not digits:
        digits, by = _by_place(evidence, hand, chains, forward), "geometry"
    else:
        digits |= _fill(digits, _by_place(evidence, hand, chains, forward), chains)
    palms = _starts_with_palm(evidence, hand, [c for d, c in digits.items() if d != "Thumb"])
    out: dict[str, tuple[int, str]] = {}
    for digit, chain in digits.items():
        bones = _bending(evidence, chain, thumb=digit == "Thumb")
        if palms and digit != "Thumb" and len(bones) >= 4:
            bones = bones[1:]
        joints = THUMB_JOINTS if digit == "Thumb" else FINGER_JOINTS
        for joint, bone in zip(joints, bones[:3], strict=False):
            out[digit + joint] = (bone, by)
    return out


def _chains(evidence: Evidence, hand: int) -> list[Chain]:
    """Return the branches below the hand; a palm bone that carries several fingers is passed through."""
    out: list[Chain] = []

    def follow(start: int) -> None:
        """Collect the lines of bones from ``start`` to their ends, a new one for each finger on a palm."""
        line = [start]
        while True:
            reading = evidence.readings[line[-1]]
            below = [
                c
                for c in evidence.tree.children[line[-1]]
                if not evidence.thing[c] and not _is_side_helper(evidence, c)
            ]
            if not below:
                break
            if len(below) > 1:
                palm = reading.has(Sense.PALM, Sense.HAND) or not reading.known or len(line) == 1
                if palm and not reading.has(*DIGITS):
                    for child in below:
                        follow(child)
                    return
                below = [max(below, key=lambda c: _depth(evidence, c))]
            line.append(below[0])
        if not all(_is_hand_end(evidence.readings[b]) for b in line):
            out.append(_labelled(evidence, line))

    for child in (*evidence.tree.children[hand], *_digits_beside(evidence, hand)):
        if not evidence.thing[child]:
            follow(child)
    return out


def _digits_beside(evidence: Evidence, hand: int) -> list[int]:
    """Return fingers that hang on the wrist next to the hand (the thumb of Acclaim skeletons)."""
    parent = int(evidence.tree.parents[hand])
    beside = evidence.tree.children[parent] if parent >= 0 else ()
    return [b for b in beside if b != hand and evidence.readings[b].has(*DIGITS)]


def _is_hand_end(reading: Reading) -> bool:
    """Return whether a bone only marks where a hand ends, or is a second bone of the hand itself."""
    of_hand = reading.has(Sense.HAND, Sense.WRIST) and not reading.has(*DIGITS, Sense.FINGER)
    return is_extra(reading) or of_hand


def _is_side_helper(evidence: Evidence, bone: int) -> bool:
    return evidence.readings[bone].has(Sense.TWIST, Sense.HELPER) and not evidence.tree.children[bone]


def _depth(evidence: Evidence, bone: int) -> int:
    return 1 + max((_depth(evidence, c) for c in evidence.tree.children[bone]), default=0)


def _labelled(evidence: Evidence, line: Sequence[int]) -> Chain:
    digit, number = None, None
    for bone in line:
        reading = evidence.readings[bone]
        named = [s for s in DIGITS if s in reading.senses and not _is_place(s, reading)]
        if (named or "fore" in reading.words) and not reading.has(Sense.TOE):
            digit = LABELS[named[0] if named else Sense.INDEX]
            break
        if reading.has(Sense.FINGER) and number is None:
            number = _number(reading)
    return Chain(tuple(line), digit, None if digit else number)


def _is_place(digit: Sense, reading: Reading) -> bool:
    """Return whether a digit's word tells a bone's place in its finger: the middle phalanx."""
    return digit is Sense.MIDDLE and bool({"phalanx", "phalange"} & set(reading.words))


def _number(reading: Reading) -> int | None:
    """Return which finger a name like "Finger0", "Finger21", "finger2-1" or "fingB" counts, None if it does not."""
    letters = [w for w in reading.words if w in "abcde"]
    if letters:
        return "abcde".index(letters[0])
    first = next(iter(reading.numbers), None)
    if first is None:
        return None
    # The first digit counts the fingers, the rest their joints.
    return int(first) if len(reading.numbers) > 1 else int(first[0])


def _by_name(chains: Sequence[Chain]) -> dict[str, tuple[int, ...]]:
    out: dict[str, tuple[int, ...]] = {}
    for chain in chains:
        if chain.digit and len(chain.bones) > len(out.get(chain.digit, ())):
            out[chain.digit] = chain.bones
    numbered = sorted((c for c in chains if c.number is not None), key=lambda c: c.number or 0)
    if numbered:
        distinct = len({c.number for c in numbered}) == len(numbered)
        # Counting starts at the thumb, unless the thumb has a name of its own.
        names = ORDER if "Thumb" not in out else ORDER[1:]
        if distinct:
            for name, chain in zip((n for n in names if n not in out), numbered, strict=False):
                out[name] = chain.bones
    elif not out:
        generic = [c for c in chains if c.bones]
        out = {"Index": generic[0].bones} if len(generic) == 1 else {}
    if "Index" not in out and len(out) <= 1:
        # One nameless "fingers" bone beside a named thumb moves like an index finger.
        rest = [c for c in chains if not c.digit and c.number is None]
        if len(rest) == 1:
            out["Index"] = rest[0].bones
    return out


def _fill(
    named: dict[str, tuple[int, ...]], placed: dict[str, tuple[int, ...]], chains: Sequence[Chain]
) -> dict[str, tuple[int, ...]]:
    """Return digits for fingers whose names say nothing, where the order across the palm agrees with the named ones."""
    silent = [c.bones for c in chains if not c.digit and c.number is None and len(c.bones) >= 2]
    if any(placed.get(digit) != bones for digit, bones in named.items()):
        return {}
    return {digit: bones for digit, bones in placed.items() if digit not in named and bones in silent}


def _by_place(evidence: Evidence, hand: int, chains: Sequence[Chain], forward: Array) -> dict[str, tuple[int, ...]]:
    """Name the branches by their places: the thumb first, then across the palm."""
    if sum(len(c.bones) >= 2 for c in chains) >= 2:
        chains = [c for c in chains if len(c.bones) >= 2]  # single bones beside real fingers hold a weapon
    if len(chains) < 2:
        return {"Index": chains[0].bones} if chains and len(chains[0].bones) >= 2 else {}
    wrist = evidence.positions[hand]
    starts = np.stack([_knuckle(evidence, c) for c in chains]) - wrist
    tips = np.stack([evidence.positions[c.bones[-1]] for c in chains]) - wrist
    along = quat.unit(tips.mean(axis=0))
    across = tips - (tips @ along)[:, None] * along
    # Across the palm: the direction in which the finger tips spread most.
    _, _, vt = np.linalg.svd(across - across.mean(axis=0))
    side = tips @ vt[0]
    short = -(tips @ along)
    near = -(starts @ along)
    front = across @ forward  # a thumb points forward, whether the palm faces down or to the side
    ends = [int(np.argmin(side)), int(np.argmax(side))]
    scale = max(float(np.ptp(tips @ along)), 1e-9), max(float(np.ptp(starts @ along)), 1e-9)
    reach = max(float(np.abs(front).max()), 1e-9)
    thumb = max(ends, key=lambda i: short[i] / scale[0] + near[i] / scale[1] + 0.8 * front[i] / reach)
    order = sorted(range(len(chains)), key=lambda i: abs(side[i] - side[thumb]))
    return {name: chains[i].bones for name, i in zip(ORDER, order, strict=False)}


def _knuckle(evidence: Evidence, chain: Chain) -> Array:
    return evidence.positions[chain.bones[0]]


def _bending(evidence: Evidence, chain: Sequence[int], thumb: bool = False) -> list[int]:
    """Return the bones of a chain that bend: no named palm bone, no marker at the end."""
    bones = [b for b in chain if thumb or not evidence.readings[b].has(Sense.PALM)]
    bones = [b for b in bones if not is_extra(evidence.readings[b])] or bones[:1]
    if thumb:
        return bones  # its metacarpal bends
    # A bone that names the digit beats one that only says "finger" (a common base of all fingers).
    named = [
        b for b in bones if any(evidence.readings[b].has(d) and not _is_place(d, evidence.readings[b]) for d in DIGITS)
    ]
    return named or bones


def _starts_with_palm(evidence: Evidence, hand: int, chains: Sequence[Sequence[int]]) -> bool:
    """Return whether nameless finger chains begin in the palm: four bones, the first of them near the wrist."""
    wrist = evidence.positions[hand]
    starts: list[float] = []
    for chain in chains:
        bones = _bending(evidence, chain)
        if len(bones) >= 4:
            first, tip = evidence.positions[bones[0]] - wrist, evidence.positions[bones[-1]] - wrist
            starts.append(float(np.linalg.norm(first)) / max(float(np.linalg.norm(tip)), 1e-9))
    return bool(starts) and float(np.median(starts)) < 0.34
