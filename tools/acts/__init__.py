"""Sample actions: what contexts, movement modes, blending, variants and branches are for, each in a few keys.

All run from frame 1 on at 30 frames a second, and begin and end at rest unless they repeat. Positions are in the units
of their channel's modes: limb lengths, shares of the way to the ground (down is positive), to the plane of symmetry or
to a target. The root has no limb; for it a limb length is a twentieth of the character's size.

Whoever has no hands takes things with its mouth, so mouths are graspers too. Where only hands are meant, a channel
without weight takes the mouths first: what it owns stays with the head.
"""

from ..acting import Act
from .fruit import eat_fruit, punch
from .greetings import bow, bow_on_all_fours, look_and_nod, shake_hands, wave_by_hand, wave_by_paw, wave_by_wing
from .hands import clap, hand_to_mouth, paw_to_mouth, pick_up_by_hand, pick_up_by_mouth
from .whole_body import dance, jump, sit, sit_on_haunches

ACTS: tuple[Act, ...] = (
    wave_by_hand(), wave_by_paw(), wave_by_wing(), bow(), bow_on_all_fours(), look_and_nod(), shake_hands(),
    clap(), hand_to_mouth(), paw_to_mouth(), pick_up_by_hand(), pick_up_by_mouth(), eat_fruit(), punch(),
    jump(), sit(), sit_on_haunches(), dance(),
)  # fmt: skip
"""All of them."""


def named(name: str) -> Act:
    """Return an act by its name."""
    return next(act for act in ACTS if act.name == name)
