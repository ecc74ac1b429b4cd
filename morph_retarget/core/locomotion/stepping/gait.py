"""The gait system, Hecker 2008 §4.2: from the way of a body to goals for its feet, hips, spine and arms.

    legs, course, styles ─► pace (phase) ─► contacts (when) ─► plants (where)        prepare, once a clip
    times ─► feet ─► trunk ─► arms ─► goals                                          evaluate, any frames in one batch

The phase is the integral of the frequency over the way and plants are functions of the phase, so any frame can be asked
for alone and is the same.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import reduce

import numpy as np

from ... import quat
from ...arrays import Array, Flags
from ...character.character import Character
from ...errors import MotionError, RigError
from ...ground import Ground
from ...solve import detached
from ...solve.goals import Goals
from ..course import Course
from ..moving import LEFT, UP, carried_by, eased
from ..patterns import styles
from ..patterns.pattern import pattern
from ..settings import GaitSettings
from . import arms, contacts, feet, legs, pace, plants, posture, releasing, trunk
from .arms import Arm
from .contacts import Contacts
from .feet import Rolls, Steps
from .legs import NONE, Legs
from .pace import IDLE, Drive, Pace
from .plants import Plants
from .reaching import LONGEST, Reach
from .sizes import Sizes
from .trunk import Trunk, Ways

NARROWEST = 0.08
"""Left and right feet count as apart at least so far [leg lengths]."""
HURRIED = 1.02
"""Strides that have to be shortened by more than this factor are told of."""
STRAIGHTENS = 0.7
"""How much less the hips are lowered for long strides where the body is highest."""
GOING = 0.1
"""Dimensionless speed from which on the body moves as the style wants it; one that stands is still."""
LONGEST_STANCE = 1.5
"""A step is made for a stance of this many times the usual one at most, however long the foot then stands."""
MOST_CYCLES = 1e5
"""A foot steps no more often than this in a clip: that is walking for a day, or a speed that nobody can mean."""


@dataclass(frozen=True, eq=False)
class Gait:
    """A character's gait over a course, ready to be evaluated."""

    character: Character
    course: Course
    legs: Legs
    trunk: Trunk
    arms: tuple[Arm, ...]
    paces: tuple[Pace, ...]
    """Of all groups of legs."""
    steps: Steps
    settings: GaitSettings
    wanted: tuple[tuple[int, bool, bool], ...]
    """For each goal its body, and whether it has a place and a turn."""
    warnings: tuple[str, ...]
    """What the user should know."""

    def contacts(self, times: Array) -> Flags:
        """Return which feet are on the ground at times [s], shape (frame,) to (frame, leg)."""
        return self.steps.contacts.standing(times)

    def phases(self, times: Array) -> Array:
        """Return the phase of each group's cycle at times [s], shape (frame,) to (frame, group)."""
        return np.stack([np.interp(times, own.times, own.phase) % 1.0 for own in self.paces], axis=-1)

    def evaluate(self, times: Array, carried: Array | None = None) -> Goals:
        """Return goals for a batch of frames.

        Args:
            times: [s], shape (frame,).
            carried: From the ground frame to the character's own frame, where its object moves, shape (frame, 4, 4).
        """
        return evaluate(self, times, carried)

    def floors(self, times: Array) -> Array:
        """Return how high the ground is that carries the body [m], shape (frame,); see `Moving`."""
        return trunk.floors(self.trunk, feet.at(self.steps, times))


def prepare(
    character: Character, root: int, course: Course, settings: GaitSettings, ground: Ground | None = None
) -> Gait:
    """Return how a character walks along a course.

    Args:
        character: What the rig is.
        root: The body that carries the others; where legs hang on what carries this, that is moved instead.
        course: Where it goes.
        settings: Styles and factors.
        ground: What it walks on, in the ground frame; None for a ground as high as the course.

    Raises:
        RigError: It has no legs.
        MotionError: The settings' stride leads nowhere, or its legs would step too often to be told.
    """
    settings.check()
    found, raised = posture.upright(character, legs.find(character))
    if not found.legs:
        raise RigError("it has no legs to walk on: map its feet, or choose a movement without feet")
    rest = character.local_to_character.points(character.skeleton.rest_positions) + raised * UP
    root = carrier_of(character, root, found)
    sizes = Sizes.of(found.legs, settings.width)
    drive = Drive.of(course, found.groups[0].height)
    paces = _paces(drive, found, sizes, settings)
    cycles = max(float(own.phase[-1] - own.phase[0]) for own in paces)
    if not cycles <= MOST_CYCLES:
        raise MotionError(f"each of its feet would step {cycles:.1e} times: lower its speed, or lengthen its strides")
    own = _contacts(found, paces, course.times[list(course.cuts)])
    usual = _by_cycle(found, paces, own, _usual_stance)
    cycle = _by_cycle(found, paces, own, lambda given, _: 1.0 / np.maximum(given.frequency, given.idle))
    stood = plants.find(course, own, LONGEST_STANCE * usual, cycle, sizes, ground, settings.tilt, settings.path)
    steps = Steps(
        own,
        stood,
        _rolls(found, paces, own, stood, sizes, settings),
        sizes,
        usual,
        np.sign(sizes.homes[:, 0]),
        settings.path,
    )
    body = trunk.find(character, rest, root, found.legs, sizes)
    steps = releasing.released(course, steps, body, settings.tilt, level=ground is None)
    swinging = tuple(arms.find(character, rest, body, found.legs)) if settings.arms > 0.0 else ()
    warnings = tuple(_told(found, paces, stood, sizes))
    return Gait(
        character,
        course,
        found,
        body,
        swinging,
        paces,
        steps,
        settings,
        tuple(_wanted(found, body, swinging)),
        warnings,
    )


# --- preparing ---


def carrier_of(character: Character, root: int, found: Legs) -> int:
    """Return the nearest body, from the root upward, that carries all legs, and the trunk if one does."""
    ancestors = detached.carried(character, root).ancestors
    firsts = [leg.path[0] for leg in found.legs]
    most = character.carrier(root)
    above = (most, *ancestors[most])
    return next((body for body in above if all(body in ancestors[first] for first in firsts)), above[-1])


def _paces(drive: Drive, found: Legs, sizes: Sizes, settings: GaitSettings) -> tuple[Pace, ...]:
    out: list[Pace] = []
    for i, group in enumerate(found.groups):
        layers = styles.named(settings.of_group.get(i, settings.styles))
        speeds = pace.own_speeds(drive, group, sizes.homes)
        own = pattern(layers, found.sides(group), speeds)
        if out:
            out.append(pace.other_pace(out[0], group, speeds, own))
        else:
            idle = pattern(layers, found.sides(group), np.array([IDLE]))
            reach, width = Reach.of(sizes, list(group.legs)), _width(sizes, group.legs)
            out.append(pace.first_pace(drive, group, speeds, own, idle, settings, reach, width))
    return tuple(out)


def _width(sizes: Sizes, own: Sequence[int]) -> float:
    """Return how far the feet of a group are apart from left to right [m]."""
    aside = np.abs(sizes.homes[list(own), 0]).max()
    return max(2.0 * float(aside), NARROWEST * float(sizes.lengths.max()))


def _contacts(found: Legs, paces: tuple[Pace, ...], jumps: Array) -> Contacts:
    cycles: list[tuple[Array, Array]] = [(np.empty(0), np.empty(0))] * len(found.legs)
    for group, own in zip(found.groups, paces, strict=True):
        for leg, made in zip(group.legs, contacts.of_feet(own), strict=True):
            cycles[leg] = reduce(contacts.cut, jumps.tolist(), made)
    return contacts.together(cycles)


def _by_cycle(found: Legs, paces: tuple[Pace, ...], own: Contacts, curve: Callable[[Pace, int], Array]) -> Array:
    """Return a value of each foot as it touches down, shape (leg, cycle).

    Args:
        found: The legs.
        paces: Of their groups.
        own: When feet touch down.
        curve: Returns the value over the grid of a group's foot, by its place in the group, shape (sample,).
    """
    out = np.zeros(own.touch.shape)
    for group, given in zip(found.groups, paces, strict=True):
        for place, leg in enumerate(group.legs):
            out[leg] = np.interp(own.touch[leg], given.times, curve(given, place))
    return out


def _usual_stance(own: Pace, place: int) -> Array:
    return own.pattern.duty[:, place] / np.maximum(own.frequency, own.idle)


def _rolls(
    found: Legs, paces: tuple[Pace, ...], own: Contacts, stood: Plants, sizes: Sizes, settings: GaitSettings
) -> Rolls:
    """Return how feet roll and how high they fly; feet that stand on a point do not roll."""
    share = settings.foot_roll * stood.rolls * (sizes.soles > 0.0)[:, None]
    off = share * _by_cycle(found, paces, own, lambda given, _: given.pattern.toe_off)
    strike = share * _by_cycle(found, paces, own, lambda given, _: given.pattern.heel_strike)
    lift = settings.step_height * _by_cycle(found, paces, own, lambda given, _: given.pattern.lift)
    return Rolls(off, strike, np.maximum(lift * sizes.lengths[:, None], stood.clearance.lift))


def _told(found: Legs, paces: tuple[Pace, ...], stood: Plants, sizes: Sizes) -> Iterator[str]:
    """Yield what the user should know."""
    hurried = max(own.hurried for own in paces)
    if hurried > HURRIED:
        yield f"the legs are too short for these strides: they are {100.0 * (1.0 - 1.0 / hurried):.0f} % shorter"
    if stood.over_nothing:
        yield f"there is no ground under {stood.over_nothing} steps: they are as high as the way of the body"
    stiff = sum(len(leg.path) < 3 for leg in found.legs)
    if stiff:
        yield f"{stiff} of its {len(found.legs)} legs have no knee: their feet slide"
    lying = int(sizes.lying.sum())
    if lying:
        told = f"{lying} of its {len(found.legs)} legs do not stand in its rest pose, so their feet slide"
        yield f"{told}: pose it standing and apply that as its rest pose"
    if len(found.legs) == 1:
        yield "it has one leg: it hops"


def _wanted(found: Legs, body: Trunk, swinging: Sequence[Arm]) -> Iterator[tuple[int, bool, bool]]:
    """Yield the goals that a gait has, in their order."""
    yield body.bodies[0], True, True
    yield from ((other, False, True) for other in body.bodies[1:])
    yield from ((leg.foot, True, True) for leg in found.legs)
    yield from ((leg.ball, False, True) for leg in found.legs if leg.ball != NONE)
    yield from ((other, False, True) for arm in swinging for other in arm.bodies)


# --- evaluating ---


def evaluate(gait: Gait, times: Array, carried: Array | None = None) -> Goals:
    """Return goals for a batch of frames; see `Gait.evaluate`."""
    places, headings = gait.course.at(times)
    moved = feet.leaned(feet.at(gait.steps, times), gait.steps.sizes, places, headings)
    ways, swing = _ways(gait, times)
    speed = np.interp(times, gait.paces[0].times, gait.paces[0].speeds)
    body = trunk.carried(gait.trunk, gait.steps.sizes, places, headings, moved, ways, gait.settings.tilt)
    moved = feet.pulled(moved, body.hips, LONGEST * gait.steps.sizes.lengths)
    positions = np.zeros((len(times), len(gait.wanted), 3))
    turns = np.empty((len(times), len(gait.wanted), 4))
    count, first = len(gait.legs.legs), len(gait.trunk.bodies)
    positions[:, 0], positions[:, first : first + count] = body.root, moved.places
    to_walk = quat.from_axis_angle(UP, np.array([leg.turn for leg in gait.legs.legs]))
    turns[:, :first], turns[:, first : first + count] = body.turns, quat.multiply(moved.turns, to_walk)
    row = first + count
    for i, leg in enumerate(gait.legs.legs):
        if leg.ball != NONE:
            toes = quat.multiply(moved.flat[:, i], quat.from_axis_angle(LEFT, moved.toes[:, i]))
            turns[:, row] = quat.multiply(toes, to_walk[i])
            row += 1
    for arm in gait.arms:
        made = arms.swung(arm, body.turns[:, arm.carrier], body.reach, swing, speed)
        for turned in made:
            turns[:, row] = turned
            row += 1
    if carried is not None:
        positions, turns = carried_by(carried, positions, turns)
    influence = np.ones((len(times), len(gait.wanted)))
    placed = np.array([place for _, place, _ in gait.wanted], dtype=np.float64)
    limbs = [body for arm in gait.arms for body in arm.bodies]
    given = np.array([gait.settings.arms if body in limbs else 1.0 for body, _, _ in gait.wanted])
    bodies = np.array([body for body, _, _ in gait.wanted], dtype=np.intp)
    return Goals(bodies, positions, turns, influence * placed, influence * given)


def _ways(gait: Gait, times: Array) -> tuple[Ways, Array]:
    """Return how the style moves the body, and how far its arms swing [rad]."""
    own, settings = gait.paces[0], gait.settings
    place = np.interp(times, own.times, np.arange(len(own.times), dtype=np.float64))
    now = own.pattern.between(place)
    length = float(gait.steps.sizes.lengths.max())
    going = eased(np.interp(place, np.arange(len(own.times)), own.speeds) / GOING) * settings.body
    rise = now.bob(np.interp(times, own.times, own.phase))
    wave = rise / np.maximum(np.sqrt((now.waves**2).sum(axis=(-1, -2))), 1e-9)
    bob = going * length * rise
    low = np.interp(times, own.times, own.low)
    # Between the steps, not over the legs that carry it.
    low *= 1.0 - STRAIGHTENS * 0.5 * (1.0 + np.clip(wave, -1.0, 1.0))
    crouch = length * settings.crouch + np.maximum(length * now.crouch, low)
    sway, yaw = settings.body * now.sway, settings.body * now.yaw
    ways = Ways(bob, crouch, sway, yaw, going * now.roll, going * now.pitch, going * now.lean)
    return ways, now.swing
