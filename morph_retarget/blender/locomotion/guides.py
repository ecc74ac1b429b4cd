"""Guides: what leads characters whose source of motion is no part of locomotion itself, such as a list of commands.

A guide may ask where other characters are, and so how these go: it stands above locomotion, and is called from here.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import bpy

from ...core.arrays import Array
from ..morph.member import Member
from .going import Going
from .properties import Source
from .walk import Walk

Asked = tuple[tuple[object, ...], Callable[[], Walk]]
"""What a way depends on, and what makes the way of that."""


@dataclass(frozen=True)
class Guide:
    """How characters of one source are led."""

    source: Source
    ask: Callable[[Member, Going, bpy.types.Depsgraph, Mapping[str, Array] | None], Asked]
    """From a character, where it sets out, what is evaluated, and where its targets were at the frames of its clock,
    each shape (frame, 3), if these were stepped through. Raises MotionError where only stepping can tell."""
    told: Callable[[bpy.types.Object], tuple[object, ...]]
    """What Blender tells nobody of when it is edited, and has to be looked at with each frame."""
    watched: Callable[[bpy.types.Object], list[bpy.types.ID]]
    """What the way has to be found anew for when it is edited."""
    reasons_to_step: Callable[[bpy.types.Object], tuple[str, ...]]
    """Why only stepping through frames can tell the way, empty where it need not."""
    places_now: Callable[[bpy.types.Object, bpy.types.Depsgraph], Mapping[str, Array]]
    """Where the targets of a character are at the frame that is evaluated [m], world space, each shape (3,)."""


guides: list[Guide] = []
"""Those that there are."""


def guide_of(source: str) -> Guide | None:
    """Return what leads characters of a source, None for those that locomotion leads itself."""
    return next((guide for guide in guides if guide.source == source), None)
