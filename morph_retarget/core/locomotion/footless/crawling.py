"""Getting about without feet: which way suits a character, and preparing it.

Hecker 2008 §4.2: "a heuristic is used to determine if a character with no feet should float above the ground or crawl
along the ground". What crawls is a snake, or an inch-worm with pseudo-feet.
"""

from collections.abc import Iterator
from dataclasses import replace
from enum import StrEnum

import numpy as np

from ...arrays import Array
from ...character.character import Character
from ...character.morphology import LimbKind
from ...errors import RigError
from ...ground import Ground
from ..course import Course
from ..settings import GaitSettings
from . import floating, hopping, inchworm, line, serpentine
from .floating import Floating
from .hopping import Hopping
from .inchworm import Inchworm
from .line import Line
from .serpentine import Serpentine


class Movement(StrEnum):
    """How a character without feet gets about."""

    SERPENTINE = "serpentine"
    INCHWORM = "inchworm"
    FLOAT = "float"


Footless = Serpentine | Inchworm | Hopping | Floating

LONG = 8
"""A line of so many bodies winds like a snake; a shorter one arches like an inch-worm."""
CRAWLS = 3
"""So many bodies are needed to crawl at all."""
LOW = 0.25
"""What crawls lies: the middle of its line is no higher over the ground than this share of its length …"""
LEVEL = 0.5
"""… and it goes up and down by less than this share of how far it goes over the ground."""
FLAT = 0.8
"""A body without a line stands on the ground and hops if it is no taller than this share of its width."""
PLACE = 1e-3
"""Joints that are no further apart than this share of all joints are in one place."""
TOUCHES = 0.15
"""It stands if its lowest joint is no higher than this share of its size."""


def choose(character: Character, root: int) -> Movement:
    """Return how a character without feet gets about.

    Wings and fins carry; a body that lies on the ground crawls, as a snake if it has many bodies; all else floats.
    """
    if any(limb.kind in (LimbKind.WING, LimbKind.FIN) for limb in character.limbs):
        return Movement.FLOAT
    points = _points(character)
    found = line.find(character, root)
    if found is not None and len(found) >= CRAWLS:
        if not _lies(found):
            return Movement.FLOAT
        return Movement.SERPENTINE if len(found) >= LONG else Movement.INCHWORM
    extents = np.ptp(points, axis=0)
    stands = float(points[:, 2].min()) < TOUCHES * float(extents.max())
    flat = float(extents[2]) < FLAT * float(extents[:2].max())
    return Movement.INCHWORM if stands and flat else Movement.FLOAT


def prepare(
    character: Character,
    root: int,
    course: Course,
    settings: GaitSettings,
    ground: Ground | None = None,
    movement: Movement | None = None,
) -> Footless:
    """Return how a character without feet goes along a course.

    Args:
        character: What the rig is.
        root: The body that carries all others.
        course: Where it goes.
        settings: Factors; of them count stride, width (of a snake's waves), step height, body and tilt.
        ground: What it is on, in the ground frame; None for a ground as high as the course.
        movement: None for what suits it best.

    Raises:
        RigError: A snake is asked for and it has no spine.
        MotionError: The settings' stride leads nowhere.
    """
    settings.check()
    kind = choose(character, root) if movement is None else movement
    rest = character.local_to_character.points(character.skeleton.rest_positions[root])
    found = line.find(character, root)
    out: Footless
    if kind is Movement.FLOAT:
        out = floating.prepare(root, _points(character), rest, course, settings, ground)
    elif kind is Movement.SERPENTINE:
        if found is None or len(found) < CRAWLS:
            raise RigError(f"it has no spine of {CRAWLS} bodies to wind: map its spine, or choose another movement")
        out = serpentine.prepare(found, course, settings, ground)
    elif found is not None and len(found) >= CRAWLS:
        out = inchworm.prepare(found, course, settings, ground)
    else:
        out = hopping.prepare(root, _points(character), rest, course, settings, ground)
    return replace(out, warnings=(*out.warnings, *_left_behind(character, root)))


def _lies(found: Line) -> bool:
    heights = found.points[:, 2]
    over = float(np.hypot(*found.steps[:, :2].T).sum())
    low = float(np.median(heights)) < LOW * found.length
    return low and float(np.abs(found.steps[:, 2]).sum()) < LEVEL * over


def _points(character: Character) -> Array:
    """Return the joints of all bodies that do something, ground frame, shape (n, 3).

    Where these are all in one place, the joints and ends of all bodies, since a place has no size.
    """
    skeleton, place = character.skeleton, character.local_to_character
    bones = [skeleton.index[name] for name in character.capabilities] or list(range(len(skeleton)))
    heads, tails = place.points(skeleton.rest_positions), place.points(skeleton.rest_tails)
    everything = np.concatenate([heads, tails])
    own = heads[bones]
    return own if np.ptp(own, axis=0).max() > PLACE * np.ptp(everything, axis=0).max() else everything


def _left_behind(character: Character, root: int) -> Iterator[str]:
    """Yield what the user should know about bodies that do not hang on the root."""
    skeleton, tree = character.skeleton, character.skeleton.tree
    moved = {root, *tree.ancestors[root], *tree.below(root)}
    loose = [top for top in tree.roots if top not in moved]
    for top in loose:
        if any(skeleton.names[bone] in character.capabilities for bone in (top, *tree.below(top))):
            yield f"bone {skeleton.names[top]!r} does not hang on {skeleton.names[root]!r} and stays behind: parent it"
