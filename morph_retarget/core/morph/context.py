"""Contexts: describing bodies of a character that is not known yet, and finding them (Hecker 2008 §3.1.1).

A context is a pure query. It starts from a capability, narrows by zones and an extent, and may walk up the limbs.
"""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from ..arrays import Array, Flags, Indices
from ..character.morphology import Capability
from .bodies import Bodies

CENTER = 0.1
"""Half the width of the center zone, as a share of the bounds that it divides."""
TIE = 1e-3
"""Bodies that differ by less than this share of the character's size are equally far out, or side by side."""


class Depth(StrEnum):
    """Zones from front to back."""

    ANY = "any"
    FRONT = "front"
    CENTER = "center"
    BACK = "back"


class Side(StrEnum):
    """Zones from left to right, the character's own."""

    ANY = "any"
    LEFT = "left"
    CENTER = "center"
    RIGHT = "right"


class Height(StrEnum):
    """Zones from top to bottom."""

    ANY = "any"
    TOP = "top"
    CENTER = "center"
    BOTTOM = "bottom"


class Space(StrEnum):
    """What a zone divides."""

    BOUNDS = "bounds"
    SETSPACE = "setspace"


class Extent(StrEnum):
    """The one body that lies farthest in a direction."""

    NONE = "none"
    FRONT_MOST = "front_most"
    BACK_MOST = "back_most"
    LEFT_MOST = "left_most"
    RIGHT_MOST = "right_most"
    TOP_MOST = "top_most"
    BOTTOM_MOST = "bottom_most"


class LimbModifier(StrEnum):
    """What a selection is exchanged for in the end."""

    NONE = "none"
    SPINE_SEGMENT = "spine_segment"


_AXES = {"front": (1, -1.0), "back": (1, 1.0), "left": (0, 1.0), "right": (0, -1.0), "top": (2, 1.0), "bottom": (2, -1)}
"""Axis of the character frame and the way along it."""


@dataclass(frozen=True)
class Context:
    """Which bodies are meant; the constraints intersect."""

    capability: Capability
    """The type of the query."""
    depth: Depth = Depth.ANY
    side: Side = Side.ANY
    height: Height = Height.ANY
    depth_space: Space = Space.BOUNDS
    """What front and back divide: the character's bounds, or those of the bodies with the capability."""
    side_space: Space = Space.BOUNDS
    height_space: Space = Space.BOUNDS
    extent: Extent = Extent.NONE
    """Applied to what the zones leave over."""
    modifier: LimbModifier = LimbModifier.NONE
    """Applied to what all of them leave over."""


def select(context: Context, bodies: Bodies) -> tuple[int, ...]:
    """Return the bodies that a context selects on a character, each once, in the order of their limbs."""
    return tuple(dict.fromkeys(body for _, body in select_each(context, bodies)))


def select_each(context: Context, bodies: Bodies) -> tuple[tuple[int, int], ...]:
    """Return each body that a context finds, and the one that its limb modifier exchanges it for."""
    found = np.array(bodies.with_capability(context.capability), dtype=np.intp)
    keep = np.ones(len(found), dtype=bool)
    places = bodies.positions[found]
    zones = (
        (context.depth, context.depth_space),
        (context.side, context.side_space),
        (context.height, context.height_space),
    )
    for axis, (zone, space) in zip((1, 0, 2), zones, strict=True):
        low, high = _bounds(space, bodies, places)
        keep &= _in_zone(zone.value, axis, places, low, high, 0.5 * TIE * bodies.size)
    found = found[keep]
    if context.extent is not Extent.NONE and len(found):
        found = found[[_farthest(context.extent, bodies, found)]]
    segments = bodies.spine_segments
    walk_up = context.modifier is LimbModifier.SPINE_SEGMENT
    return tuple((int(body), int(segments[body]) if walk_up else int(body)) for body in found)


def _bounds(space: Space, bodies: Bodies, places: Array) -> tuple[Array, Array]:
    if space is Space.BOUNDS or not len(places):
        return bodies.low, bodies.high
    return places.min(axis=0), places.max(axis=0)


def _in_zone(zone: str, axis: int, places: Array, low: Array, high: Array, least: float) -> Flags:
    """Return whether each place lies in a zone; halves include the center zone, whose half width is ``least``."""
    if zone == "any":
        return np.ones(len(places), dtype=bool)
    from_middle = places[:, axis] - 0.5 * (low[axis] + high[axis])
    half_width = max(CENTER * (high[axis] - low[axis]), least)
    if zone == "center":
        return np.abs(from_middle) <= half_width
    _, way = _AXES[zone]
    return way * from_middle >= -half_width


def _farthest(extent: Extent, bodies: Bodies, found: Indices) -> int:
    """Return which of some bodies lies farthest out; of equal ones the foremost, leftmost, topmost, first by name."""
    axis, way = _AXES[extent.value.removesuffix("_most")]
    places = bodies.positions[found]
    out = way * places[:, axis]
    steps: list[list[float]] = np.round(places / (TIE * bodies.size)).tolist()

    def order(i: int) -> tuple[float, float, float, str]:
        left, back, up = steps[i]
        return back, -left, -up, bodies.names[int(found[i])]

    return min(np.flatnonzero(out >= out.max() - TIE * bodies.size).tolist(), key=order)
