"""Where feet stand: one place for each stance, found from where the body will be in the middle of it.

A foot is put down where its home is below the body half a stance later, as far as the course knows, so the body passes
over it evenly; a foot whose body stops before that lands beside the others. Over uneven ground it stands at the
ground's height, tilts with it, is moved off edges that it would bridge, and clears what lies between its plants.
"""

from dataclasses import dataclass

import numpy as np

from ... import quat
from ...arrays import Array, Flags
from ...ground import Ground
from ..course import Course
from ..foot_path import FootPath
from ..moving import LEFT, UP, eased
from . import clearing
from .clearing import Clearance
from .contacts import Contacts
from .legs import FORWARD
from .reaching import ROLLS, spread
from .sizes import Sizes
from .spacing import apart

STEEPEST = np.radians(40.0)
"""Feet do not tilt further, however steep the ground."""
EDGE = 0.35
"""A sole that bridges more than this, as a share of its length, stands on an edge …"""
BENT = 0.1
"""… if the ground under its middle is off the line between its ends by more than this."""
WALL = 0.07
"""Soles stand no nearer to steps before and behind them, which rise by more than this, too [leg lengths]."""
WIDE = 0.2
"""Where the ground is looked at on both sides of a sole [sole lengths]."""
SHIFTS = (0.35, -0.35, 0.7, -0.7, 1.05, -1.05)
"""Ways by which a foot is moved forward off an edge, the first that helps [sole lengths]."""
HANGS = 0.1
"""A foot of which one end is this far above the ground, as a share of the sole, does not roll over its ends."""
PASSES = 2
"""How often the tilt of a foot is found."""


@dataclass(frozen=True, eq=False)
class Plants:
    """How each foot stands in each of its cycles."""

    places: Array
    """Of the foot's joint when the foot lies flat [m], ground frame, shape (leg, cycle, 3)."""
    turns: Array
    """Of the flat foot from its rest, shape (leg, cycle, 4)."""
    floors: Array
    """Height of the ground there [m], shape (leg, cycle)."""
    headings: Array
    """Of the body, for which the foot was put there [rad], shape (leg, cycle)."""
    rolls: Array
    """How far the feet roll as the body goes forward over them, 0 … 1, shape (leg, cycle)."""
    clearance: Clearance
    """How feet clear what lies between this plant and the next."""
    over_nothing: int
    """Feet that were put where no ground is."""


def find(
    course: Course,
    contacts: Contacts,
    longest: Array,
    cycle: Array,
    sizes: Sizes,
    ground: Ground | None,
    tilt: float,
    path: FootPath,
) -> Plants:
    """Return where the feet stand.

    Args:
        course: The body's way.
        contacts: When they stand.
        longest: Stance that each foot's step is made for, as it touches down [s], shape (leg, cycle).
        cycle: How long a whole cycle lasts then [s], shape (leg, cycle).
        sizes: Of the feet.
        ground: None for one that is as high as the course.
        tilt: How much feet tilt with the ground, 0 … 1.
        path: Of their flight.
    """
    touch = np.where(np.isfinite(contacts.touch), contacts.touch, course.times[-1])
    middle = touch + 0.5 * np.minimum(contacts.lift - touch, longest)
    for jump in course.times[list(course.cuts)].tolist():
        middle = np.where((touch < jump) & (middle >= jump), np.nextafter(jump, -np.inf), middle)
    shape, flat = middle.shape, middle.ravel()
    bodies, headings = course.at(flat)
    velocity = course.velocity(flat)[0].reshape(*shape, 3)
    turned = quat.from_axis_angle(UP, headings).reshape(*shape, 4)
    sideways = np.abs((quat.rotate(turned, LEFT) * velocity).sum(axis=-1))
    forward = (quat.rotate(turned, FORWARD) * velocity).sum(axis=-1)
    rolls = np.clip(forward / np.maximum(quat.length(velocity), 1e-9), 0.0, 1.0)
    homes = _spread(sizes, sideways * cycle)
    # Rolling over its ball a foot stands for longer behind the hip than in front of it.
    back = sizes.centring[:, None] + ROLLS * sizes.soles[:, None] * rolls
    homes[..., 1] += back * eased(quat.length(velocity) * cycle / sizes.lengths[:, None])
    places = quat.rotate(turned, homes) + bodies.reshape(*shape, 3)
    places = apart(places, turned, contacts, sizes)
    floors, bare = bodies[:, 2].reshape(shape), 0
    if ground is not None:
        seen = _seen(course, contacts)
        places, turned, floors, touching, bare = _on(ground, places, turned, floors, sizes, tilt, seen)
        # Who hangs over an edge cannot roll there.
        rolls = rolls * touching
    clear = Clearance.none(shape) if ground is None else clearing.find(ground, places, turned, sizes, path)
    rolls = rolls * (1.0 - _stepping(clear))
    return Plants(places, turned, floors, headings.reshape(shape), rolls, clear, bare)


def _seen(course: Course, contacts: Contacts) -> Flags:
    """Return the plants on which feet stand during the course, shape (leg, cycle)."""
    return (contacts.touch <= course.times[-1]) & (contacts.lift >= course.times[0])


def _stepping(clear: Clearance) -> Array:
    """Return how much feet step up or down onto plants or off them: there they land on the ball, (leg, cycle)."""
    most = np.maximum(clear.early, clear.late)
    return np.maximum(most, np.concatenate([most[:, :1], most[:, :-1]], axis=1))


def _spread(sizes: Sizes, strides: Array) -> Array:
    """Return homes that are far enough apart for strides to the side [m], shape (leg, cycle) to (leg, cycle, 3)."""
    aside = sizes.homes[:, :1]
    wider = 0.5 * spread(strides, 2.0 * np.abs(aside), sizes.lengths[:, None])
    homes = np.broadcast_to(sizes.homes[:, None], (*strides.shape, 3)).copy()
    homes[..., 0] += np.sign(aside) * wider
    return homes


def _on(
    ground: Ground, places: Array, turned: Array, floors: Array, sizes: Sizes, tilt: float, counts: Flags
) -> tuple[Array, Array, Array, Array, int]:
    """Put feet on the ground.

    Returns their joints' places, their turns, the floors, how far both ends of each touch the ground, 0 … 1, and how
    many found none.
    """
    ahead = quat.rotate(turned, np.broadcast_to(FORWARD, places.shape)) * sizes.soles[:, None, None]
    best, heights, level = _under(ground, places, turned, sizes)
    bare = np.isnan(heights).any(axis=-1)
    heights = np.where(np.isnan(heights), floors[..., None], heights)
    level |= bare
    for shift in SHIFTS:
        if level.all():
            break
        tried, found, good = _under(ground, places + shift * ahead, turned, sizes)
        good &= ~level
        best = np.where(good[..., None], tried, best)
        heights = np.where(good[..., None], found, heights)
        level |= good
    tried, found, good = _under(ground, best + _off_walls(ground, best, turned, sizes), turned, sizes)
    best = np.where((good & level)[..., None], tried, best)
    heights = np.where((good & level)[..., None], found, heights)
    return *_settled(ground, best, turned, heights, sizes, tilt, level), int((bare & counts).sum())


def _off_walls(ground: Ground, places: Array, turned: Array, sizes: Sizes) -> Array:
    """Return ways by which feet are moved back from what rises before their tips or behind their heels [m]."""
    margin = np.where(sizes.soles > 0.0, WALL * sizes.lengths, 0.0)[:, None]
    ahead = margin[..., None] * quat.rotate(turned, np.broadcast_to(FORWARD, places.shape))
    ends = [places + quat.rotate(turned, np.broadcast_to(o[:, None], places.shape)) for o in (sizes.tips, sizes.heels)]
    points = np.stack([ends[0], ends[0] + ahead, ends[1], ends[1] - ahead], axis=2)
    found = ground(points.reshape(-1, 3)).reshape(points.shape[:-1])
    tip, heel = (found[..., end + 1] - found[..., end] > margin for end in (0, 2))
    return (heel.astype(np.float64) - tip)[..., None] * ahead


def _under(ground: Ground, places: Array, turned: Array, sizes: Sizes) -> tuple[Array, Array, Flags]:
    """Return places of feet, heights of the ground under heel, tip, left and right, and where these are no edge."""
    heel = places + quat.rotate(turned, np.broadcast_to(sizes.heels[:, None], places.shape))
    tip = places + quat.rotate(turned, np.broadcast_to(sizes.tips[:, None], places.shape))
    wide = WIDE * sizes.soles[:, None, None] * quat.rotate(turned, np.broadcast_to(LEFT, places.shape))
    middle = 0.5 * (heel + tip)
    points = np.stack([heel, tip, middle + wide, middle - wide], axis=2)
    found = ground(points.reshape(-1, 3)).reshape(points.shape[:-1])
    # A slope is no edge: its middle is as high as the mean of its ends.
    bent = np.abs(found[..., :2].mean(axis=-1) - found[..., 2:].mean(axis=-1)) > BENT * sizes.soles[:, None]
    steep = np.abs(found[..., 0] - found[..., 1]) > EDGE * sizes.soles[:, None]
    return places, found, ~(bent & steep) & np.isfinite(found).all(axis=-1)


def _settled(
    ground: Ground, places: Array, turned: Array, heights: Array, sizes: Sizes, tilt: float, level: Flags
) -> tuple[Array, Array, Array, Array]:
    """Tilt feet with the ground under heel, tip and both sides, and put them down on it; see `_on`."""
    soles = np.maximum(sizes.soles, 1e-9)[:, None]
    flat = (sizes.soles > 0.0)[:, None] & level
    passes = PASSES if flat.any() else 0
    turns, found, pitch = turned, heights, np.zeros(flat.shape)
    # Where heel and tip are depends on the tilt, and the tilt on what is under them.
    for number in range(passes):
        heel, tip = _joint_over(turns, found, sizes)
        pitch = np.clip(pitch + np.where(flat, np.arctan2(heel - tip, soles), 0.0), -STEEPEST, STEEPEST)
        roll = np.where(flat, np.arctan2(found[..., 3] - found[..., 2], 2.0 * WIDE * soles), 0.0)
        share = tilt if number == passes - 1 else 1.0
        sideways = quat.from_axis_angle(-FORWARD, share * np.clip(roll, -STEEPEST, STEEPEST))
        turns = quat.multiply(turned, quat.multiply(quat.from_axis_angle(LEFT, share * pitch), sideways))
        _, found, _ = _under(ground, places, turns, sizes)
        found = np.where(np.isfinite(found), found, heights)
    # What of the sole would be deepest stands on the ground.
    own, (heel, tip) = places.copy(), _joint_over(turns, found, sizes)
    own[..., 2] = np.maximum(heel, tip)
    return own, turns, found.mean(axis=-1), 1.0 - eased(np.abs(heel - tip) / (HANGS * soles))


def _joint_over(turns: Array, found: Array, sizes: Sizes) -> tuple[Array, Array]:
    """Return how high the feet's joints are when their heels touch the ground, and when their tips do [m]."""
    heel, tip = (
        found[..., i] - quat.rotate(turns, np.broadcast_to(offset[:, None], (*turns.shape[:2], 3)))[..., 2]
        for i, offset in enumerate((sizes.heels, sizes.tips))
    )
    return heel, tip
