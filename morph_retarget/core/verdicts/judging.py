"""Judging a performance: all verdicts, and what each lets pass.

performance ─► goals  grounding  sliding  popping  hinges  crossing  lengths ─► verdicts by name
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields

from ..errors import MotionError, listed
from . import crossing, goals, grounding, hinges, lengths, popping, sliding
from .performance import Performance
from .verdict import Found, Verdict


@dataclass(frozen=True)
class Limits:
    """The most that each verdict lets pass."""

    goals: float = 0.03
    """Distance from a goal that can be reached [limb lengths]. Limbs slow down over the last 2 % of their length, so
    that they are never quite straight; the rest is a hundredth, less than a finger on a human arm."""
    ground: float = 0.02
    """Depth of a joint or a sole below the ground [shares of the size]. Flesh gives way by about so much; deeper, a
    knee, a hand or a mouth is seen to go through the floor."""
    slide: float = 0.1
    """Speed of standing feet [leg lengths a second]. Contacts in captured motion move by up to twice that; at half a
    centimetre a frame a slide begins to show."""
    pop: float = 10.0
    """Turn of a bone in one frame beyond twice that of its neighbours, and beyond what its goals ask for [degrees].
    What moves as it shall stays below six; snaps of knees and flips of wrists are far above."""
    hyperextension: float = 10.0
    """Bend of a knee or an elbow against its rest [degrees]. Human knees and elbows go 5 to 10 beyond straight."""
    crossing: float = 0.5
    """Depth of a limb in the body or another limb [shares of both radii]. The radii come from a rule and not from a
    mesh, and arms that rest on a body press into it; at half of both, bones come nearer to each other than either is
    thick."""
    lengths: float = 1e-4
    """Change of a bone's length [shares of the size], beyond what the character's settings allow. Keys are exact to
    about 1e-6; nothing else may change it."""

    def with_(self, given: Mapping[str, float]) -> "Limits":
        """Return these with others in their place.

        Raises:
            MotionError: There is no such verdict.
        """
        names = [field.name for field in fields(self)]
        for name in given:
            if name not in names:
                raise MotionError(f"there is no verdict {name!r}: choose one of {listed(names, 20)}")
        return Limits(**{name: given.get(name, getattr(self, name)) for name in names})


_JUDGES: Mapping[str, tuple[Callable[[Performance], Found], str]] = {
    "goals": (goals.missed, "limb lengths"),
    "ground": (grounding.sunk, "of its size"),
    "slide": (sliding.slid, "leg lengths/s"),
    "pop": (popping.popped, "deg"),
    "hyperextension": (hinges.overextended, "deg"),
    "crossing": (crossing.crossed, "of both radii"),
    "lengths": (lengths.changed, "of its size"),
}
VERDICTS = tuple(_JUDGES)
"""Names of all verdicts, those of `Limits`."""
DEFAULT = Limits()


def judge(performance: Performance, limits: Limits = DEFAULT) -> dict[str, Verdict]:
    """Return all verdicts on a performance, by name."""
    return {
        name: Verdict(measure(performance), getattr(limits, name), unit) for name, (measure, unit) in _JUDGES.items()
    }
