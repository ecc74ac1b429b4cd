"""What bones are by their names alone, where only names are known: the other rig of a map.

Names of a common family say it outright. Others are read word by word, as the analysis does, without tree and shape.
"""

from collections.abc import Sequence

from .. import families
from ..fingers import FINGER_JOINTS, LABELS, THUMB_JOINTS
from ..joint_names import LIKELY, is_extra, joint_scores
from ..joints import PARENTS
from ..names import Reading, read_names

MOST_OF = 0.7
"""Names are taken for those of a family when it knows at least this share of them."""
_LEVELS = ("spine", "chest", "upperChest")
_SIDES = {1: "left", -1: "right"}
_Numbered = tuple[tuple[int, ...], int, str]
"""Numbers in a name, its place in the map, and the name: what orders bones of one finger or spine."""


def joints_of(names: Sequence[str]) -> dict[str, str]:
    """Return the joints that names stand for, name to joint; no joint comes twice.

    Args:
        names: Without repetition, in the order of the map.
    """
    return _by_family(names) or _by_words(names)


def _by_family(names: Sequence[str]) -> dict[str, str]:
    found = [families.placed(family, names) for family in families.shipped()]
    # Of families that know as many, one that knows the lowest bone of the spine: others count from another bone on.
    best = max(found, key=lambda joints: (len(joints), "spine" in joints))
    return {bone: joint for joint, bone in best.items()} if len(best) >= MOST_OF * len(names) else {}


def _by_words(names: Sequence[str]) -> dict[str, str]:
    claims: list[tuple[float, str, str]] = []
    spine: list[_Numbered] = []
    digits: dict[str, list[_Numbered]] = {}
    for i, (name, reading) in enumerate(zip(names, read_names(names), strict=True)):
        own = (tuple(int(number) for number in reading.numbers), i, name)
        digit = _digit(reading)
        scores = _sided_scores(reading)
        if digit is not None:
            digits.setdefault(digit, []).append(own)
        elif max(scores, key=lambda joint: scores[joint], default="") in _LEVELS:
            spine.append(own)
        else:
            claims += [(score, name, joint) for joint, score in scores.items() if score > LIKELY - 1.0]
    out = _settled(claims)
    out |= _in_turn(spine, _levels(len(spine)))
    for digit, found in digits.items():
        parts = THUMB_JOINTS if digit.endswith("Thumb") else FINGER_JOINTS
        out |= _in_turn(found, [digit + part for part in parts])
    return out


def _settled(claims: Sequence[tuple[float, str, str]]) -> dict[str, str]:
    """Return name to joint, the clearest claims first, each name and each joint once."""
    out: dict[str, str] = {}
    for _, name, joint in sorted(claims, key=lambda claim: -claim[0]):
        if name not in out and joint not in out.values():
            out[name] = joint
    return out


def _digit(reading: Reading) -> str | None:
    """Return the digit that a name is of, with its side, None for other bones."""
    labels = [label for sense, label in LABELS.items() if reading.has(sense)]
    if len(labels) != 1 or not reading.side or is_extra(reading):
        return None
    scores = joint_scores(reading)
    return None if any(joint for joint in scores) else _SIDES[reading.side] + labels[0]


def _sided_scores(reading: Reading) -> dict[str, float]:
    """Return log-odds of joints with their sides; a name without a side tells nothing of joints that come in pairs."""
    side = _SIDES.get(reading.side, "")
    found = {joint if joint in PARENTS else side + joint: score for joint, score in joint_scores(reading).items()}
    return {joint: score for joint, score in found.items() if joint in PARENTS}


def _levels(count: int) -> list[str]:
    """Return what the bones between hips and neck are called from the lowest up, by their number."""
    if count <= len(_LEVELS):
        return list(_LEVELS[:count])
    out = [""] * count
    out[0], out[count // 2], out[-1] = _LEVELS
    return out


def _in_turn(found: list[_Numbered], joints: Sequence[str]) -> dict[str, str]:
    """Return bones that are numbered, or stand in order, with joints in that order."""
    bones = [name for _, _, name in sorted(found)]
    return {name: joint for name, joint in zip(bones, joints, strict=False) if joint}
