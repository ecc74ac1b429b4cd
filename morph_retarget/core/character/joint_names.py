"""From the senses of a name to the joints it may stand for: the evidence of names (Feng 2013 §3).

Scores are log-odds. A name speaks for several joints when usage differs between conventions ("LeftShoulder" is the
clavicle in one rig and the upper arm in the next); chains and shapes decide among them in `joint_map`.
"""

from collections.abc import Mapping

from .names import Reading
from .words import DIGITS, SENSES, Sense

SURE = 5.0
LIKELY = 3.0
POSSIBLE = 1.5
FAINT = 0.5
CONTRADICTED = -4.0
"""A name that is clear about one joint speaks against all others."""

NOT_A_JOINT = -6.0
"""Controls, hair, clothes and props."""

_THINGS = (Sense.HAIR, Sense.CLOTH, Sense.FLESH, Sense.PROP, Sense.CONTROL, Sense.MECHANISM)
_CREATURE = (Sense.TAIL, Sense.WING, Sense.FEATHER, Sense.FIN, Sense.TENTACLE, Sense.ANTENNA)


def is_thing(reading: Reading) -> bool:
    """Return whether the name says that this bone is no part of the body: hair, cloth, a prop, a control."""
    return reading.has(*_THINGS)


def is_extra(reading: Reading) -> bool:
    """Return whether the name says that this bone only helps another: twist, helper, end marker."""
    return reading.has(Sense.TWIST, Sense.HELPER, Sense.END)


def joint_scores(reading: Reading) -> Mapping[str, float]:
    """Return log-odds for each unsided joint ("UpperArm", "hips") that the name may mean.

    The key ``""`` holds the score of all joints that are not listed: zero when the name says nothing.
    """
    if is_thing(reading):
        return {"": NOT_A_JOINT}
    scores = dict(_limb_scores(reading) if reading.side or not _is_trunk(reading) else _trunk_scores(reading))
    if not scores and (not reading.known or reading.senses <= {Sense.NOISE, Sense.CENTER, Sense.BIG}):
        return {"": 0.0}
    if is_extra(reading):
        # A twist bone in the chain is often the only bone there is (NeckTwist01); an end marker hardly ever.
        penalty = 2.5 if reading.has(Sense.TWIST, Sense.HELPER) else 4.5
        scores = {joint: score - penalty for joint, score in scores.items()}
    scores[""] = CONTRADICTED
    return scores


def _is_trunk(reading: Reading) -> bool:
    return reading.has(
        Sense.HIPS, Sense.HIP, Sense.BODY, Sense.ABDOMEN, Sense.SPINE, Sense.CHEST, Sense.NECK, Sense.HEAD, Sense.ROOT,
        Sense.JAW, Sense.MOUTH, Sense.FACE,
    )  # fmt: skip


def _trunk_scores(r: Reading) -> Mapping[str, float]:
    if r.has(Sense.JAW):
        return {"jaw": SURE}
    if r.has(*_CREATURE):
        return {}
    if r.has(Sense.FACE, Sense.MOUTH, Sense.EYE, Sense.EAR):
        return {"jaw": POSSIBLE} if r.has(Sense.MOUTH) or "chin" in r.words else {}
    if r.has(Sense.HEAD, Sense.NECK) and r.has(Sense.HEAD) == r.has(Sense.NECK):
        # "head neck lower" and "head neck upper" are neck and head of one convention.
        return {"neck": LIKELY, "head": POSSIBLE} if r.has(Sense.LOWER) else {"head": LIKELY, "neck": POSSIBLE}
    if r.has(Sense.HEAD):
        return {"head": SURE}
    if r.has(Sense.NECK):
        return {"neck": SURE, "head": FAINT}
    if r.has(Sense.HIPS):
        return {"hips": SURE, "spine": FAINT}
    if r.has(Sense.CHEST):
        return {"chest": LIKELY, "upperChest": LIKELY + (1.0 if r.has(Sense.UPPER) else 0.0), "spine": FAINT}
    if r.has(Sense.HIP):
        return {"hips": LIKELY}
    if r.has(Sense.ABDOMEN):
        return {"spine": LIKELY, "chest": POSSIBLE, "hips": FAINT}
    if r.has(Sense.SPINE):
        trunk = {"spine": LIKELY, "chest": LIKELY, "upperChest": LIKELY, "hips": FAINT, "neck": FAINT, "head": 0.0}
        if r.has(Sense.UPPER):
            trunk["chest"] += 0.5
        return trunk
    if r.has(Sense.BODY):
        lower, upper = r.has(Sense.LOWER), r.has(Sense.UPPER)
        return {
            "hips": LIKELY if lower else POSSIBLE,
            "spine": POSSIBLE if upper else FAINT,
            "chest": LIKELY if upper else POSSIBLE,
            "upperChest": POSSIBLE,
        }
    return {"hips": 0.0}  # a root: the hips of some rigs, and nothing else


def _limb_scores(r: Reading) -> Mapping[str, float]:
    if r.has(*_CREATURE):
        return {}
    if r.has(Sense.TOE):
        return {"Toes": SURE, "Foot": 0.0} if not r.has(*DIGITS[1:]) else {"Toes": 0.0}
    if r.has(*DIGITS, Sense.FINGER) and not r.has(Sense.LEG, Sense.FOOT):
        return {}  # `fingers` reads these
    if r.has(Sense.PALM) and not r.has(Sense.LEG, Sense.FOOT):
        return {} if r.numbers else {"Hand": POSSIBLE}
    if r.has(Sense.HEEL):
        return {}
    if r.has(Sense.EYE):
        return {"Eye": SURE} if not _face_details(r) else {}
    if r.has(Sense.FACE, Sense.EAR, Sense.JAW, Sense.MOUTH, Sense.HEAD):
        return {}
    return _arm_scores(r) or _leg_scores(r) or ({"UpperLeg": FAINT} if r.has(Sense.HIPS) else {})


def _face_details(r: Reading) -> list[str]:
    """Return the words for parts of the face other than eyes: lids, brows, lashes."""
    return [w for w in r.words if Sense.FACE in SENSES.get(w, ()) and w not in ("face", "facial")]


def _arm_scores(r: Reading) -> Mapping[str, float]:
    if r.has(Sense.UPPER_ARM):
        return {"UpperArm": SURE, "Shoulder": FAINT}
    if r.has(Sense.LOWER_ARM, Sense.ELBOW):
        return {"LowerArm": SURE}
    if r.has(Sense.ARM):
        if r.has(Sense.LOWER, Sense.FRONT):
            return {"LowerArm": SURE}
        if r.has(Sense.UPPER):
            return {"UpperArm": SURE, "Shoulder": FAINT}
        if r.has(Sense.SHOULDER):
            return {"UpperArm": LIKELY, "Shoulder": LIKELY}
        return {"UpperArm": LIKELY + 0.5, "LowerArm": POSSIBLE, "Hand": FAINT, "Shoulder": FAINT}
    if r.has(Sense.CLAVICLE):
        return {"Shoulder": SURE}
    if r.has(Sense.SHOULDER):
        return {"Shoulder": LIKELY, "UpperArm": LIKELY - 1.0}
    if r.has(Sense.WRIST):
        return {"Hand": LIKELY + 1.0, "LowerArm": -1.0}
    if r.has(Sense.HAND):
        return {"Hand": SURE}
    return {}


def _leg_scores(r: Reading) -> Mapping[str, float]:
    if r.has(Sense.UPPER_LEG):
        return {"UpperLeg": SURE}
    if r.has(Sense.LOWER_LEG, Sense.KNEE):
        return {"LowerLeg": SURE}
    if r.has(Sense.ANKLE):
        return {"Foot": LIKELY + 1.0}
    if r.has(Sense.FOOT, Sense.PAW):
        return {"Foot": LIKELY + 1.0, "Toes": FAINT}
    if r.has(Sense.LEG):
        if r.has(Sense.LOWER):
            return {"LowerLeg": SURE}
        if r.has(Sense.UPPER):
            return {"UpperLeg": SURE}
        return {"UpperLeg": LIKELY, "LowerLeg": LIKELY, "Foot": FAINT, "Toes": 0.0}
    if r.has(Sense.BUTTOCK):
        return {"UpperLeg": FAINT}
    if r.has(Sense.HIP):
        return {"UpperLeg": LIKELY - 0.5}
    return {}
