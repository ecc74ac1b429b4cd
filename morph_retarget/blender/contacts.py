"""Plants of a source's feet as users see and edit them: bone and frames, in place of rows of a batch."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..core import contacts
from ..core.arrays import Flags
from ..core.character.character import Character
from ..core.contacts import Plant
from ..core.errors import MotionError, listed
from ..core.mocap.motion import SourceMotion
from ..core.mocap.plan import Plan, prepare
from .sampling import Clip


@dataclass(frozen=True)
class Contact:
    """An interval in which a foot of the source stands."""

    foot: str
    """Bone of the foot."""
    start: float
    """First frame."""
    end: float
    """Last frame, included."""


def feet_of(plan: Plan) -> list[str]:
    """Return the source's foot bones, in the order in which a plan counts feet."""
    links = plan.links
    ends = [leg.end for leg in links.legs]
    return [plan.source.skeleton.names[links.source[end, round(float(links.weight[end]))]] for end in ends]


def found(source: Character, clip: Clip) -> list[Contact]:
    """Return the contacts that are found from the source's motion alone."""
    plan = prepare(source, source)
    motion = SourceMotion.read(plan, clip.pose, clip.seconds_per_frame, None)
    feet = feet_of(plan)
    return [
        Contact(feet[plant.foot], float(clip.frames[plant.start]), float(clip.frames[plant.end]))
        for plant in contacts.plants(motion.steps.standing)
    ]


def standing(plan: Plan, clip: Clip, given: Sequence[Contact]) -> Flags:
    """Return contacts as flags, shape (frame, foot).

    Raises:
        MotionError: A contact names a bone that is no foot of the source.
    """
    feet = feet_of(plan)
    plants: list[Plant] = []
    for contact in given:
        if contact.foot not in feet:
            raise MotionError(
                f"a contact names {contact.foot!r}, which is no foot of the source: use {listed(feet) or 'none'}"
            )
        rows = np.searchsorted(clip.frames, [contact.start, contact.end + 1e-6])
        plants.append(Plant(feet.index(contact.foot), int(rows[0]), int(rows[1]) - 1))
    return contacts.from_plants(plants, len(clip.frames), len(feet))
