r"""Bone presets of Expy Kit: Python files of assignments such as ``skeleton.left_arm.arm = 'upper_arm.L'``.

They are read line by line as text and never run. A file with any other statement is refused, so that nobody takes
what was left out for read.
"""

import ast
import re
from collections.abc import Mapping

from ...errors import MappingError
from ..joints import SIDES
from .bone_map import EXPY_KIT, BoneMap

_SPINE = ("spine", "spine1", "spine2")
"""From the hips upward; rigs with fewer bones leave some out."""
_FINGER = {"a": "Proximal", "b": "Intermediate", "c": "Distal"}
_THUMB = {"a": "Metacarpal", "b": "Proximal", "c": "Distal"}
_STRING = r"'(?:[^'\\\n]|\\.)*'|\"(?:[^\"\\\n]|\\.)*\""
_SLOT = re.compile(r"skeleton((?:\.\w+)+)\s*=\s*(.+)")
_NAME = re.compile(rf"({_STRING})")
_CHOICE = re.compile(rf"({_STRING})\s+if\s+(?:{_STRING})\s+in\s+[\w.]+\s+else\s+({_STRING})")
_COMMENT = re.compile(rf"((?:[^#'\"\n]|{_STRING})*?)\s*#.*")
_IDLE = re.compile(r"import bpy|skeleton\s*=\s*[\w.]+|pass")
"""Lines that every preset begins with, and which say nothing of bones."""
_PLAIN = re.compile(r"True|False|None|-?[\d.]+")
LONGEST = 400
"""Characters of a line; no name of a bone needs as many."""


def looks_like(text: str) -> bool:
    """Return whether a text is meant for a preset of Expy Kit."""
    return re.search(r"^\s*(?:import\s+\w|skeleton\s*[.=])", text, re.MULTILINE) is not None


def read(text: str, origin: str) -> BoneMap:
    """Return what a preset says.

    Raises:
        MappingError: A line of it is something else than an assignment of a name.
    """
    slots: dict[str, tuple[str, ...]] = {}
    for number, line in enumerate(text.splitlines(), 1):
        bare = line.strip() if len(line) <= LONGEST else line[:LONGEST]
        if not bare or bare.startswith("#") or _IDLE.fullmatch(bare):
            continue
        slot = _SLOT.fullmatch(bare)
        names = None if slot is None or len(line) > LONGEST else _names(_COMMENT.sub(r"\1", slot[2]))
        if slot is None or names is None:
            raise MappingError(
                f"{origin}: line {number} gives no name to a bone of the skeleton ({bare[:40]!r}): "
                "take it out; presets are read and never run"
            )
        slots[slot[1].removeprefix(".")] = names
    return BoneMap(EXPY_KIT, origin, _joints({slot: names for slot, names in slots.items() if names}))


def _names(value: str) -> tuple[str, ...] | None:
    """Return the names that a slot may be given, none where it is no name, None where that cannot be read."""
    if _PLAIN.fullmatch(value):
        return ()
    found = _NAME.fullmatch(value) or _CHOICE.fullmatch(value)
    if found is None:
        return None
    try:
        return tuple(name for name in (str(ast.literal_eval(part)) for part in found.groups()) if name)
    except (SyntaxError, ValueError):  # an escape that means nothing
        return None


def _joints(slots: Mapping[str, tuple[str, ...]]) -> dict[str, tuple[str, ...]]:
    """Return joint to names; slots for IK, twist and metacarpal bones have no joint."""
    places = {f"spine.{own}": own for own in ("hips", "neck", "head")} | {"face.jaw": "jaw"}
    spine = [f"spine.{own}" for own in _SPINE if f"spine.{own}" in slots]
    places |= dict(zip(spine, ("spine", "chest", "upperChest"), strict=False))
    for side in SIDES:
        places[f"face.{side}_eye"] = f"{side}Eye"
        places |= {f"{side}_arm.{own}": side + joint for own, joint in _ARM.items()}
        places |= {f"{side}_leg.{own}": side + joint for own, joint in _LEG.items()}
        for digit, joint in _DIGITS.items():
            parts = _THUMB if digit == "thumb" else _FINGER
            places |= {f"{side}_fingers.{digit}.{own}": side + joint + part for own, part in parts.items()}
    return {joint: slots[slot] for slot, joint in places.items() if slot in slots}


_ARM = {"shoulder": "Shoulder", "arm": "UpperArm", "forearm": "LowerArm", "hand": "Hand"}
_LEG = {"upleg": "UpperLeg", "leg": "LowerLeg", "foot": "Foot", "toe": "Toes"}
_DIGITS = {"thumb": "Thumb", "index": "Index", "middle": "Middle", "ring": "Ring", "pinky": "Little"}
