"""What users say of how a hand or foot of a control rig is brought to its place, where nothing else tells."""

import re
from dataclasses import dataclass

from ..errors import MappingError

ENDS = ("leftHand", "rightHand", "leftFoot", "rightFoot")
"""Joints of which that can be said."""
FIELDS = ("reach", "pole", "switch")
"""Of a joint in a map, in the order of `Reaching`."""

_SWITCH = re.compile(
    r"""^(?:pose\.bones\[)?(["']?)(?P<bone>.+?)\1\]?\[(["'])(?P<prop>.+?)\3\]\s*(?:=\s*(?P<value>[-+.\d]+))?$""",
)


@dataclass(frozen=True)
class Reaching:
    """The controls of one limb, and what switches it; each is found by itself where it is empty."""

    control: str = ""
    """Brings its end to a place."""
    pole: str = ""
    """Its middle joint points to it."""
    switch: str = ""
    """Data path of a custom property of a bone and the value at which it reaches, 1 if none is said:
    ``Properties["ik_left_arm"] = 1``."""


def switch_of(text: str, joint: str) -> tuple[str, str, float]:
    """Return the bone, the property and the value that a switch names.

    Args:
        text: As `Reaching` describes it; Blender's own data path is understood too.
        joint: Whose it is, for messages.

    Raises:
        MappingError: It is no data path of a custom property of a bone, or its value is no number.
    """
    found = _SWITCH.match(text.strip())
    try:
        value = float((found and found["value"]) or 1.0)
    except ValueError:
        found, value = None, 1.0
    if found is None:
        raise MappingError(f'the switch of {joint} is {text!r}: name a bone and its property, as Properties["ik"] = 1')
    bone, prop = (re.sub(r"\\(.)", r"\1", found[name]) for name in ("bone", "prop"))
    return bone, prop, value
