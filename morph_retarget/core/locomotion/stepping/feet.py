"""The feet of a body at any time: standing on their plants, rolling over heel and ball, flying to the next.

What touches the ground stays where it is: first the heel, then the whole sole, then the point in front about which the
foot rolls off. In flight it is that point whose way is drawn, so that a foot leaves the ground as it rolled.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ... import quat
from ...arrays import Array, Flags, Indices
from ..foot_path import FootPath
from ..moving import LEFT, UP, eased
from .contacts import Contacts
from .plants import Plants
from .sizes import Sizes

LANDED = 0.2
"""Share of the stance after which a foot that landed on its heel lies flat."""
HEEL_OFF = 0.5
"""Share of the stance after which the heel leaves the ground."""
TRAILING = 0.65
"""Share of the flight after which toes are no longer bent."""
RAMP = 1.0 / 3.0
"""Share of a stance over which a foot takes over its load, and over which it gives it away."""
TRAILS, TURNS = 0.3, 0.4
"""Share of the flight in which a foot trails, and share in which it changes to going ahead."""
GIVES = 0.02
"""How softly flying feet are held in reach [leg lengths]."""
STRETCH = 0.015
"""Legs of feet that just left the ground may be longer by this share."""
NARROW = 0.15
"""They are not drawn nearer than this to under their hips [leg lengths]."""
LEVELLED = 0.7
"""Share of the flight after which a foot that rolled off is level again …"""
RAISES = 0.35
"""… and from which on it raises its toes to land on the heel."""
HANG = 1.2
"""How much paws hang in flight beyond their roll, as a share of that."""
FREE = 0.25
"""Share of the flight after which, and before which, the body goes its way whether its leg reaches the foot or not."""
MOST_SWING = 1.5
"""A foot that swings on as it leaves the ground turns no further than this, in shares of the roll."""


@dataclass(frozen=True, eq=False)
class Rolls:
    """How far feet are turned over their toes and heels, by cycle."""

    off: Array
    """As they leave [rad], shape (leg, cycle)."""
    strike: Array
    """Toes up as they land [rad], shape (leg, cycle)."""
    lift: Array
    """Height of the flight that follows [m], shape (leg, cycle)."""


@dataclass(frozen=True, eq=False)
class Steps:
    """Everything about the feet of a body over a course; from it they are read at any time."""

    contacts: Contacts
    plants: Plants
    rolls: Rolls
    sizes: Sizes
    usual: Array
    """How long a stance usually lasts as each begins [s], shape (leg, cycle)."""
    outward: Array
    """+1 for legs on the left, -1 on the right, 0 in the middle, shape (leg,)."""
    path: FootPath

    @cached_property
    def table(self) -> Array:
        """All that is known of each cycle and of the landing after it, side by side, shape (leg * cycle, column).

        One look into one table is several times faster than one into each of many.
        """
        contacts, plants, rolls = self.contacts, self.plants, self.rolls
        heels = plants.places + quat.rotate(plants.turns, _of_all(self.sizes.heels, plants.places))
        tips = plants.places + quat.rotate(plants.turns, _of_all(self.sizes.tips, plants.places))
        up = quat.multiply(plants.turns, quat.from_axis_angle(LEFT, -rolls.strike))
        landings = heels + quat.rotate(up, _of_all(self.sizes.tips - self.sizes.heels, heels))
        own = [
            contacts.touch,
            contacts.lift,
            rolls.off,
            rolls.strike,
            rolls.lift,
            plants.floors,
            plants.headings,
            self.usual,
            plants.clearance.early,
            plants.clearance.late,
        ]
        now = np.concatenate([np.stack(own, axis=-1), plants.turns, tips, heels], axis=-1)
        later = np.stack([contacts.touch, rolls.strike, plants.floors, plants.headings], axis=-1)
        later = _next(np.concatenate([later, plants.turns, landings], axis=-1))
        # The last cycle of a foot has no end.
        number: Indices = np.arange(len(contacts.touch[0]))
        last = number >= contacts.counts[:, None] - 1
        later[last, 0], now[last, 1] = np.inf, np.inf
        later[last, 1:8] = now[last][:, [3, 5, 6, 10, 11, 12, 13]]
        later[last, 8:] = tips[last]
        return np.concatenate([now, later], axis=-1).reshape(-1, now.shape[-1] + later.shape[-1])


def _of_all(offsets: Array, places: Array) -> Array:
    return np.broadcast_to(offsets[:, None], places.shape)


def _next(values: Array) -> Array:
    """Return values of the cycle after each one, shape (leg, cycle, n)."""
    return np.concatenate([values[:, 1:], values[:, -1:]], axis=1)


@dataclass(frozen=True, eq=False)
class Feet:
    """Where feet are over some frames, ground frame."""

    places: Array
    """Of their joints [m], shape (frame, leg, 3)."""
    turns: Array
    """From rest, shape (frame, leg, 4)."""
    flat: Array
    """The same without their roll: toes that stay on the ground, shape (frame, leg, 4)."""
    pitch: Array
    """Roll: toes down above 0 [rad], shape (frame, leg)."""
    toes: Array
    """The same of toes: they lie on the ground while the heel rises, and trail in the air, shape (frame, leg)."""
    standing: Flags
    """Whether each is on the ground, shape (frame, leg)."""
    glides: Array
    """How much each keeps its height, from 0 where it trails to 1 where it comes in to land, shape (frame, leg)."""
    steep: Array
    """How much each goes straight up from what is before it, or down behind it, 0 … 1, shape (frame, leg)."""
    held: Array
    """How much the body has to keep each in reach: 1 on the ground, falling to 0 in flight, shape (frame, leg)."""
    load: Array
    """How much each carries, from 0 in flight to 1, without jumps, shape (frame, leg)."""
    floors: Array
    """Height of the ground that each stands on or flies toward [m], shape (frame, leg)."""
    headings: Array
    """Of the body that the plants were made for [rad], shape (frame, leg)."""


def at(steps: Steps, times: Array) -> Feet:
    """Return the feet at some times [s], shape (frame,)."""
    sizes, most = steps.sizes, steps.contacts.touch.shape[1]
    at_leg: Indices = most * np.arange(len(sizes.lengths))
    row = steps.table.take(steps.contacts.cycles(times) + at_leg, axis=0)
    touch, lift, off, strike, high, floor, heading, usual, early, late = (row[..., i] for i in range(10))
    turn, tip, heel = row[..., 10:14], row[..., 14:17], row[..., 17:20]
    landing, next_strike, next_floor, next_heading = (row[..., i] for i in range(20, 24))
    next_turn, next_tip = row[..., 24:28], row[..., 28:31]
    time = times[:, None]
    standing = time <= lift
    endless = np.isinf(lift)
    lasts = np.where(endless, np.inf, np.maximum(lift - touch, 1e-9))
    span = np.where(endless, 1.0, np.maximum(landing - np.where(endless, 0.0, lift), 1e-9))
    stance = np.clip((time - touch) / lasts, 0.0, 1.0)
    flight = np.where(standing, 0.0, np.clip((time - np.where(standing, time, lift)) / span, 0.0, 1.0))
    step = next_tip - tip
    way = steps.path.over(flight, early, late)
    along = way[..., 0]
    rolled = _rolled(off, strike, stance)
    hung = HANG * sizes.hanging * off * 16.0 * ((1.0 - flight) * flight) ** 2
    pitch = np.where(standing, rolled, _swung(off, next_strike, flight, span / lasts) + way[..., 3] + hung)
    near = np.where((turn * next_turn).sum(axis=-1, keepdims=True) < 0.0, -next_turn, next_turn)
    flat = quat.normalize(turn + along[..., None] * (near - turn))
    turns = quat.multiply(flat, quat.from_axis_angle(LEFT, pitch))
    front = tip + along[..., None] * step
    front[..., 2] = (
        tip[..., 2] + np.where(step[..., 2] > 0.0, way[..., 4], way[..., 5]) * step[..., 2] + way[..., 1] * high
    )
    if steps.path.swerves:
        front += quat.rotate(flat, LEFT) * (way[..., 2] * steps.outward * sizes.lengths)[..., None]
    # While the toes are up it is the heel that stays.
    on_heel = (standing & (pitch < 0.0))[..., None]
    held, pivot = np.where(on_heel, heel, front), np.where(on_heel, sizes.heels, sizes.tips)
    places = held - quat.rotate(turns, pivot)
    toes = np.where(standing, np.minimum(pitch, 0.0), pitch * eased(flight / TRAILING))
    floors, headings = floor + along * (next_floor - floor), heading + along * (next_heading - heading)
    turned = eased((flight - TRAILS) / TURNS)
    glides, steep = turned * (1.0 - late), early + turned * (late - early)
    held = 1.0 - eased(np.minimum(flight, 1.0 - flight) / FREE)
    return Feet(
        places,
        turns,
        flat,
        pitch,
        toes,
        standing,
        glides,
        steep,
        held,
        _load(time, touch, lift, usual, standing),
        floors,
        headings,
    )


def trailing(steps: Steps, shares: Array, legs: Indices, cycles: Indices) -> Array:
    """Return the joints of feet late in their stances, rolled over their tips [m], shape (n, 3).

    Args:
        steps: Of all feet.
        shares: How much of each stance is over, 0.5 … 1, shape (n,).
        legs: Whose stances, shape (n,).
        cycles: Which of theirs, shape (n,).
    """
    places, flat = steps.plants.places[legs, cycles], steps.plants.turns[legs, cycles]
    rolled = _rolled(steps.rolls.off[legs, cycles], np.zeros(len(legs)), shares)
    tips = steps.sizes.tips[legs]
    turns = quat.multiply(flat, quat.from_axis_angle(LEFT, rolled))
    return places + quat.rotate(flat, tips) - quat.rotate(turns, tips)


def leaned(feet: Feet, sizes: Sizes, places: Array, headings: Array) -> Feet:
    """Return feet of which the long ones lean with their legs, what stands on the ground where it is.

    A last bone that is a large part of its leg would stand upright like a pole under the knee.

    Args:
        feet: From `at`.
        sizes: Of the feet.
        places: Of the body on the ground [m], shape (frame, 3).
        headings: Of the body [rad], shape (frame,).
    """
    long = np.flatnonzero(sizes.long)
    if not len(long):
        return feet
    heading = np.broadcast_to(quat.from_axis_angle(UP, headings)[:, None], (len(headings), len(long), 4))
    turns, tips = feet.turns[:, long], sizes.tips[long]
    ends = feet.places[:, long] + quat.rotate(turns, np.broadcast_to(tips, (*turns.shape[:2], 3)))
    rest = sizes.hips[long] - sizes.homes[long] - tips
    hips = quat.rotate(heading, np.broadcast_to(sizes.hips[long], ends.shape)) + places[:, None]
    lean = quat.between(quat.rotate(heading, np.broadcast_to(rest, ends.shape)), hips - ends)
    out = replace(feet, places=feet.places.copy(), turns=feet.turns.copy())
    out.turns[:, long] = quat.multiply(lean, turns)
    out.places[:, long] = ends - quat.rotate(out.turns[:, long], np.broadcast_to(tips, ends.shape))
    return out


def pulled(feet: Feet, hips: Array, longest: Array) -> Feet:
    """Return feet of which the flying ones stay in reach of their hips.

    Args:
        feet: From `at`.
        hips: Where their legs begin [m], shape (frame, leg, 3).
        longest: How far they may be from there [m], shape (leg,).
    """
    away = feet.places - hips
    near, free = away.copy(), (1.0 - feet.held)[..., None]
    near[..., 2] = np.maximum(away[..., 2], -longest)
    # First up with the leg that it trails behind, then back, so that it glides in to land and does not hang high.
    far = np.sqrt(np.maximum(longest**2 - near[..., 2] ** 2, (NARROW * longest) ** 2))
    near[..., :2] *= _held(quat.length(away[..., :2]), far, longest)[..., None]
    up = _held(quat.length(away), longest, longest)[..., None] * away
    near = up + feet.glides[..., None] * (near - up)
    straight = np.where(feet.standing, 0.0, feet.steep)
    near = away + (1.0 - straight)[..., None] * free * (near - away)
    # What is still too far is where the body rises as a foot leaves for a higher step: it hurries up the step's face.
    far = (longest * (1.0 + STRETCH * feet.held)) ** 2 - near[..., 0] ** 2 - near[..., 1] ** 2
    raised = np.maximum(-np.sqrt(np.maximum(far, (NARROW * longest) ** 2)) - near[..., 2], 0.0)
    near[..., 2] += straight * raised
    return replace(feet, places=hips + near)


def _held(distance: Array, most: Array, longest: Array) -> Array:
    """Return by what factors distances are shortened to be less than others, softly, shape (frame, leg)."""
    soft = GIVES * longest
    room = np.clip((most - distance) / soft, -700.0, 40.0)
    kept = np.where(room < 40.0, most - soft * np.log1p(np.exp(room)), distance)
    return np.clip(kept, 0.0, None) / np.maximum(distance, 1e-9)


def _rolled(off: Array, strike: Array, stance: Array) -> Array:
    """Return the roll of standing feet: down onto the sole, then over the ball [rad], shape (frame, leg)."""
    rising = np.maximum(stance - HEEL_OFF, 0.0) / (1.0 - HEEL_OFF)
    return off * rising**2 - strike * (1.0 - eased(stance / LANDED))


def _swung(off: Array, strike: Array, flight: Array, ratio: Array) -> Array:
    """Return the roll of flying feet, which goes on as it began and ends as they land [rad], shape (frame, leg).

    Args:
        off: Roll as they left.
        strike: Roll, upward, as they will land.
        flight: Share of the flight.
        ratio: How long they fly for each second that they stood.
    """
    slope = np.minimum(2.0 / (1.0 - HEEL_OFF) * ratio, 4.0 * (MOST_SWING - 1.0) / LEVELLED) * off
    first = np.minimum(flight / LEVELLED, 1.0)
    falling = (off * (1.0 + 2.0 * first) + slope * LEVELLED * first) * (1.0 - first) ** 2
    return falling - strike * eased((flight - RAISES) / (1.0 - RAISES))


def _load(time: Array, touch: Array, lift: Array, usual: Array, standing: Flags) -> Array:
    """Return how much feet carry: more over the first and less over the last part of a stance, shape (frame, leg)."""
    ramp = np.maximum(np.minimum(np.where(np.isinf(lift), np.inf, lift - touch), usual) * RAMP, 1e-9)
    return np.where(standing, eased((time - touch) / ramp) * eased((lift - time) / ramp), 0.0)
