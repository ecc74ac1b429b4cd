"""Hips and spine of a walking body: they are carried by the feet, and turn with the steps.

The hips translate and rotate as the feet move (Hecker 2008 §4.2): they sway over the feet that carry the body, drop to
the flying side, and turn so that a leg that reaches forward takes its hip along. Where front legs hang on the other end
of the spine, that end does the same with them; where none do, shoulders turn against the hips. The hips are lowered,
softly, as far as any leg needs to reach its foot.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ... import quat
from ...arrays import Array, Indices
from ...character.character import Character
from ...solve import detached
from ..moving import UP
from .feet import Feet
from .legs import FORWARD, Leg
from .reaching import LONGEST
from .sizes import Sizes

ROCKS = 0.5
"""How far the whole trunk pitches to the feet that carry it, as a share of how far it bends."""
COUNTER = -0.7
"""How far shoulders without legs turn, as a share of what the hips turn."""
SOFT = 0.01
"""How softly hips are lowered for a leg that would be stretched further [leg lengths]."""
SPARE = 12.0
"""Legs that have more than this to spare, in the unit of `SOFT`, and flying ones, do not lower the hips at all."""
LOWEST = 0.5
"""Hips are never lowered by more than this [leg lengths]."""
APART = 0.3
"""Feet that are further apart than this from front to back, in leg lengths, tilt the body with the ground."""
BENDS = 3
"""A trunk that carries legs at so many bodies or more bends over what its feet stand on …"""
NEAR = 1.0
"""… as they feel it within about this distance [leg lengths]."""
LIES = 0.5
"""A body whose next one is further to the front than this share of the way there lies along the ground."""
BARELY = 0.15
"""Load below which nothing carries the body."""


@dataclass(frozen=True, eq=False)
class Trunk:
    """What of a character is turned with the steps: root, spine, neck and head."""

    bodies: tuple[int, ...]
    """Root first; each after what carries it."""
    carriers: Indices
    """For each its carrier by its place among ``bodies``; the root's own is itself."""
    offsets: Array
    """From the carrier's joint at rest [m], shape (body, 3); of the root from the ground under the body."""
    along: Array
    """Where each is along the spine: 0 at the root, 1 at its other end, shape (body,)."""
    steady: Array
    """1 for what moves with the spine, to 0 for a head that is kept level, shape (body,)."""
    hips: Indices
    """For each leg what carries it, by its place among ``bodies``, shape (leg,)."""
    hip_offsets: Array
    """From the joint of that [m], shape (leg, 3)."""
    tilts: Array
    """Takes the heights of floors under all feet to the height under the body and its slopes, shape (3, leg)."""
    bends: Array | None
    """Takes them to the heights under the bodies of the trunk, shape (body, leg), where it bends with the ground."""


def find(character: Character, rest: Array, root: int, legs: Sequence[Leg], sizes: Sizes) -> Trunk:
    """Return the trunk of a character.

    Args:
        character: What the rig is.
        rest: Places of all bodies at rest [m], ground frame, shape (body, 3).
        root: The body that carries all others.
        legs: Of the character.
        sizes: Of its feet.
    """
    tree = detached.carried(character, root)
    neck = [*character.neck, *([] if character.head is None else [character.head])]
    line = [b for b in dict.fromkeys([*character.spine, *neck]) if b != root and tree.is_below(root, b)]
    bodies = [root, *sorted(line, key=lambda b: len(tree.ancestors[b]))]
    carriers = [0, *(_carrier(b, bodies, tree.ancestors) for b in bodies[1:])]
    offsets = rest[bodies] - rest[[bodies[i] for i in carriers]]
    offsets[0] = rest[root]
    ways = np.zeros(len(bodies))
    for i, carrier in enumerate(carriers[1:], 1):
        ways[i] = ways[carrier] + np.linalg.norm(offsets[i])
    spine = [i for i, body in enumerate(bodies) if body not in neck]
    along = np.clip(ways / max(ways[spine].max(), 1e-9), 0.0, 1.0)
    steady = np.ones(len(bodies))
    above = [i for i, body in enumerate(bodies) if body in neck]
    steady[above] = 1.0 - (np.arange(len(above)) + 1.0) / max(len(above), 1)
    hips = np.array([_carrier(leg.path[0], bodies, tree.ancestors) for leg in legs], dtype=np.intp)
    hip_offsets = np.array([leg.hip for leg in legs]) - rest[[bodies[i] for i in hips]]
    tilts, bends = _tilts(sizes), None
    if len({*hips.tolist()}) >= BENDS:
        bends = _bends(sizes, rest[bodies])
    return Trunk(tuple(bodies), np.array(carriers), offsets, along, steady, hips, hip_offsets, tilts, bends)


def _carrier(body: int, bodies: Sequence[int], ancestors: Sequence[Sequence[int]]) -> int:
    return next((bodies.index(above) for above in ancestors[body] if above in bodies), 0)


def _tilts(sizes: Sizes) -> Array:
    """Return what fits a plane to heights under the homes of feet, level where they stand in one row."""
    homes, length = sizes.homes, float(sizes.lengths.max())
    wide = np.ptp(homes[:, 1]) > APART * length
    columns = np.stack([np.ones(len(homes)), homes[:, 0] * wide, homes[:, 1] * wide], axis=-1)
    fit: Array = np.linalg.pinv(columns, rcond=1e-6).astype(np.float64)
    return fit


def _bends(sizes: Sizes, joints: Array) -> Array:
    """Return what takes heights under the homes of feet to those under joints [m], shape (joint, 3) to (joint, leg).

    At each joint a line is fitted along the body, to which feet count the less the further they are away.
    """
    out = np.empty((len(joints), len(sizes.homes)))
    for row, joint in zip(out, joints, strict=True):
        away = (sizes.homes[:, 1] - joint[1]) / (NEAR * float(sizes.lengths.max()))
        nearest = float(np.abs(away).min())
        weights = np.exp(-0.25 * (away**2 - nearest**2))
        columns = weights[:, None] * np.stack([np.ones_like(away), away], axis=-1)
        row[:] = np.linalg.pinv(columns, rcond=1e-6)[0] * weights
    return out


@dataclass(frozen=True, eq=False)
class Ways:
    """How the body moves over some frames, as its style wants it; shapes (frame,)."""

    bob: Array
    """Height [m]."""
    crouch: Array
    """How far the hips are lowered [m]."""
    sway: Array
    """0 … 1."""
    yaw: Array
    """[rad at a stride of one leg length]."""
    roll: Array
    """[rad]."""
    pitch: Array
    """[rad]."""
    lean: Array
    """[rad]."""


@dataclass(frozen=True, eq=False)
class Carriage:
    """The trunk over some frames, ground frame."""

    root: Array
    """Place of the root's joint [m], shape (frame, 3)."""
    turns: Array
    """Of all bodies of the trunk from rest, shape (frame, body, 4)."""
    hips: Array
    """Where the legs begin [m], shape (frame, leg, 3)."""
    reach: Array
    """How far each foot is ahead of its home [leg lengths], shape (frame, leg)."""


def carried(
    trunk: Trunk, sizes: Sizes, places: Array, headings: Array, feet: Feet, ways: Ways, tilt: float
) -> Carriage:
    """Return how the trunk is carried.

    Args:
        trunk: From `find`.
        sizes: Of the feet.
        places: Of the body on the ground [m], shape (frame, 3).
        headings: Of the body [rad], shape (frame,).
        feet: Where they are.
        ways: How the style moves the body.
        tilt: How much it tilts with the ground, 0 … 1.
    """
    heading = quat.from_axis_angle(UP, headings)
    away = feet.places[..., :2] - places[:, None, :2]
    sin, cos = np.sin(headings)[:, None], np.cos(headings)[:, None]
    reach = (sizes.homes[:, 1] - (cos * away[..., 1] - sin * away[..., 0])) / sizes.lengths
    floor, aslope, bslope = np.moveaxis(_fitted(trunk.tilts, feet.floors), -1, 0)
    slope = np.zeros((len(places), len(trunk.bodies), 3))
    slope[..., 0] = (tilt * np.arctan(bslope) + ways.lean)[:, None]
    slope[..., 1] = -tilt * np.arctan(aslope)[:, None]
    if trunk.bends is not None:
        heights = _fitted(trunk.bends, feet.floors)
        floor = floor + tilt * (heights[:, 0] - floor)
        slope[..., 0] = tilt * _bent(trunk, heights) + ways.lean[:, None]
    turns = _turns(trunk, sizes, heading, slope, feet, reach, ways)
    total = feet.load.sum(axis=1)
    aside = ways.sway * (feet.load * sizes.homes[:, 0]).sum(axis=1) / (total + BARELY)
    away = np.stack([aside, np.zeros_like(aside), ways.bob - ways.crouch], axis=-1) + trunk.offsets[0]
    root = quat.rotate(heading, away)
    root += np.stack([places[:, 0], places[:, 1], floor], axis=-1)
    hips = _hips(trunk, root, turns)
    if trunk.bends is not None:
        shift = _centred(sizes, hips, heading, places)
        root, hips = root + shift, hips + shift[:, None]
    down = _dropped(sizes, hips, feet)
    root[:, 2] -= down
    hips[..., 2] -= down[:, None]
    return Carriage(root, turns, hips, reach)


def _bent(trunk: Trunk, heights: Array) -> Array:
    """Return by what angle each body of a bending trunk goes up to the rear [rad], shape (frame, body).

    Args:
        trunk: From `find`.
        heights: Of the ground under its joints [m], shape (frame, body).
    """
    out, carriers = np.zeros_like(heights), trunk.carriers.tolist()
    for i, carrier in enumerate(carriers):
        above = [other for other, own in enumerate(carriers) if own == i and other != i]
        lies = [b for b in above if abs(trunk.offsets[b, 1]) > LIES * float(np.linalg.norm(trunk.offsets[b]))]
        if lies:  # it points to the next one
            rise = (heights[:, lies[0]] - heights[:, i]) * np.sign(trunk.offsets[lies[0], 1])
            out[:, i] = np.arctan2(rise, abs(trunk.offsets[lies[0], 1]))
        else:
            out[:, i] = out[:, carrier]
    return out


def _centred(sizes: Sizes, hips: Array, heading: Array, places: Array) -> Array:
    """Return what brings a bent trunk, which is shorter over the ground, over its feet again [m], shape (frame, 3)."""
    at_rest = np.broadcast_to(sizes.hips.mean(axis=0), places.shape)
    ahead = quat.rotate(heading, np.broadcast_to(FORWARD, places.shape))
    missing = ((quat.rotate(heading, at_rest) + places - hips.mean(axis=1)) * ahead).sum(axis=-1, keepdims=True)
    return missing * ahead


def floors(trunk: Trunk, feet: Feet) -> Array:
    """Return the height of the ground under the body [m], shape (frame,): it is fitted to that under its feet."""
    return _fitted((trunk.tilts if trunk.bends is None else trunk.bends)[:1], feet.floors)[:, 0]


def under_hips(trunk: Trunk, floors: Array, sizes: Sizes, tilt: float) -> Array:
    """Return the height of the ground that carries each hip as the body tilts [m], shape (frame, leg).

    Args:
        trunk: From `find`.
        floors: Heights under the feet [m], shape (frame, leg).
        sizes: Of the feet.
        tilt: How much the body tilts with the ground, 0 … 1.
    """
    floor, aslope, bslope = np.moveaxis(_fitted(trunk.tilts, floors)[..., None], 1, 0)
    if trunk.bends is not None:
        return floor + tilt * (_fitted(trunk.bends, floors)[:, trunk.hips] - floor)
    return floor + tilt * (aslope * sizes.hips[:, 0] + bslope * sizes.hips[:, 1])


def _fitted(tilts: Array, floors: Array) -> Array:
    """Return what rows of a trunk's ``tilts`` tell of floors, shape (frame, row), alike in any batch to the bit."""
    return (floors[:, None] * tilts).sum(axis=-1)


def _turns(trunk: Trunk, sizes: Sizes, heading: Array, slope: Array, feet: Feet, reach: Array, ways: Ways) -> Array:
    """Return how root, spine, neck and head are turned, shape (frame, body, 4)."""
    along = trunk.along[trunk.hips]
    sides = np.sign(np.where(np.abs(sizes.homes[:, 0]) < 0.02 * sizes.lengths, 0.0, sizes.homes[:, 0]))
    ends = [_twisted(reach, feet.load, sides, np.flatnonzero(own)) for own in (along < 0.5, along >= 0.5)]
    rear = ends[0] if ends[0] is not None else np.zeros((len(heading), 2))
    front = ends[1] if ends[1] is not None else COUNTER * rear
    share = trunk.along[:, None]
    both = rear[:, None] + share * (front - rear)[:, None]
    rocks = ROCKS * ways.pitch * _pitched(feet.load, sizes)
    bends = ways.pitch * _gathered(reach, sizes)
    own = np.stack(
        [
            rocks[:, None] + bends[:, None] * (2.0 * trunk.along - 1.0),
            ways.roll[:, None] * both[..., 1],
            ways.yaw[:, None] * both[..., 0],
        ],
        axis=-1,
    )
    tilted = quat.from_rotation_vector(slope * trunk.steady[:, None])
    turned = quat.multiply(tilted, quat.from_rotation_vector(own * trunk.steady[:, None]))
    return quat.multiply(np.broadcast_to(heading[:, None], turned.shape), turned)


def _twisted(reach: Array, load: Array, sides: Array, legs: Indices) -> Array | None:
    """Return how far one end of the spine turns with its legs, to the front and down, (frame, 2); None without legs."""
    if not len(legs):
        return None
    own = sides[legs] / len(legs)
    return np.stack([-(reach[:, legs] * own).sum(axis=1), -(load[:, legs] * own).sum(axis=1)], axis=-1)


def _pitched(load: Array, sizes: Sizes) -> Array:
    """Return how much more the front feet carry than the rear ones, -1 … 1, shape (frame,)."""
    return (load * _ends(sizes)).sum(axis=1)


def _gathered(reach: Array, sizes: Sizes) -> Array:
    """Return how far front and rear feet are gathered under the body: below 0 when it is stretched, shape (frame,)."""
    return -np.tanh(2.0 * (reach * _ends(sizes)).sum(axis=1))


def _ends(sizes: Sizes) -> Array:
    """Return what takes values of all feet to the mean of the front ones less that of the rear ones, shape (leg,)."""
    away = sizes.homes[:, 1].mean() - sizes.homes[:, 1]
    ends = np.where(np.abs(away) > 0.5 * APART * sizes.lengths, np.sign(away), 0.0)
    return ends / max(float(np.abs(ends).sum()) / 2.0, 1.0)


def _hips(trunk: Trunk, root: Array, turns: Array) -> Array:
    """Return where the legs begin [m], shape (frame, leg, 3)."""
    joints: list[Array] = [root]
    for i in range(1, len(trunk.bodies)):
        carrier = int(trunk.carriers[i])
        joints.append(joints[carrier] + quat.rotate(turns[:, carrier], trunk.offsets[i]))
    carriers: list[int] = trunk.hips.tolist()
    out = np.stack([joints[i] for i in carriers], axis=1)
    return out + quat.rotate(turns[:, trunk.hips], np.broadcast_to(trunk.hip_offsets, out.shape))


def _dropped(sizes: Sizes, hips: Array, feet: Feet) -> Array:
    """Return how far the hips have to be lowered for all feet to be reached [m], shape (frame,)."""
    away = feet.places - hips
    longest = LONGEST * sizes.lengths
    aside = away[..., 0] ** 2 + away[..., 1] ** 2
    deep = np.sqrt(np.maximum(longest**2 - aside, (0.2 * longest) ** 2))
    soft = SOFT * float(sizes.lengths.max())
    excess = np.clip((-away[..., 2] - deep) / soft, -SPARE, LOWEST / SOFT)
    return soft * np.log1p(np.exp(feet.held * (excess + SPARE) - SPARE).sum(axis=1))
