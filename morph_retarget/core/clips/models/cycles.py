"""Cycles of going: loops of one kind, mixed for any speed, turn and direction (Grünvogel 2003 §5.5).

Loops are mixed at the same phase, which strikes of feet tell. What the mix misses of a wanted speed is left to how fast
it is played (eqs 15–17).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ...arrays import Array
from ..character_model import RATE
from ..clip import Clip
from ..motions.base_motion import BaseMotion
from ..operators.loop import Loop
from ..operators.mix import Mix
from ..travel import turned
from .blend_space import BlendSpace

SLOWER, FASTER = 0.35, 1.7
"""A cycle may be played by these factors slower and faster than it was made."""
SAME_WAY = np.radians(10.0)
"""Loops whose directions differ by less are blended by speed and turn alone."""
TRIES, CLOSE = 6, 1e-3
"""A turn is met so closely [rad/s], if it is within so many tries."""
NEAR = 0.02
"""Speeds that differ by less are left to the pace, as a share."""
LIKE = 1e-3
"""Cycles whose speeds and lengths differ by less are the same, as a share."""
STILL = 0.05
"""What goes slower [body heights/s] or turns slower [rad/s] stays where it is."""


@dataclass(frozen=True)
class Way:
    """How to go."""

    speed: float
    """[m/s]"""
    turn: float = 0.0
    """To the left [rad/s]."""
    direction: float = 0.0
    """Beside the heading, to the left [rad]."""


@dataclass(frozen=True, eq=False)
class Cycle:
    """A cycle of going."""

    clip: Clip
    """Without end."""
    period: float
    """Frames of the clip in a cycle."""
    zero: float
    """Frame at which its phase is 0: as the first foot strikes."""
    rate: float
    """How fast it is to be played [cycles per frame]."""
    strikes: tuple[float, ...]
    """Phases at which feet strike, the first at 0; (0,) where none do."""
    velocity: tuple[float, float]
    """As it is played, as seen from the heading: to the left and back [m/s]."""
    turn: float
    """As it is played [rad/s]."""

    def is_like(self, other: "Cycle") -> bool:
        """Return whether another cycle is the same motion, however fast it is played."""
        alike = [np.allclose(a, b, rtol=LIKE, atol=1e-9) for a, b in zip(self.made(), other.made(), strict=True)]
        return all(alike)

    def made(self) -> tuple[float, float, float, float]:
        """Return how it was made to go, before it is played faster or slower."""
        factor = 1.0 / (self.rate * self.period)
        return self.velocity[0] * factor, self.velocity[1] * factor, self.turn * factor, self.period

    @property
    def on_the_spot(self) -> bool:
        """Whether it leads nowhere."""
        return bool(np.hypot(*self.velocity) < 1e-3 * self.clip.model.character.frame.height)


@dataclass(frozen=True, eq=False)
class Cycles:
    """The loops of one kind and style."""

    motions: tuple[BaseMotion, ...]
    """At least one."""

    @cached_property
    def directions(self) -> tuple[tuple[float, tuple[BaseMotion, ...]], ...]:
        """Directions in which there are loops [rad], rising, and those loops."""
        groups: list[tuple[float, list[BaseMotion]]] = []
        for motion in self.motions:
            own = motion.annotations.direction if motion.annotations.speed > 0.0 else 0.0
            for direction, members in groups:
                if abs(_wrapped(own - direction)) < SAME_WAY:
                    members.append(motion)
                    break
            else:
                groups.append((_wrapped(own), [motion]))
        return tuple((direction, tuple(members)) for direction, members in sorted(groups, key=lambda group: group[0]))

    @property
    def usual(self) -> Way:
        """The way to go when nothing is said: straight ahead at the middle speed."""
        ahead = self._toward(0.0)[0][0]
        straight = sorted(ahead, key=lambda motion: (abs(motion.annotations.turn_rate), motion.annotations.speed))
        least = abs(straight[0].annotations.turn_rate)
        alike = [motion for motion in straight if abs(motion.annotations.turn_rate) <= least + STILL]
        own = alike[(len(alike) - 1) // 2].annotations
        return Way(own.speed, own.turn_rate if least > STILL else 0.0, 0.0)

    def at(self, way: Way) -> tuple[Cycle, str]:
        """Return the cycle that goes a way, as nearly as there are loops for it, and what it cannot do in words."""
        asked = way
        cycle, problem = self._played(*self._mixed(asked), way)
        for _ in range(TRIES):
            missed = way.turn - cycle.turn
            if abs(missed) < CLOSE * max(abs(way.turn), 1.0) or way.speed <= 0.0:
                break
            # The mean of cycles of several lengths is not quite where the mean of their turns is.
            asked = replace(asked, turn=asked.turn + missed)
            cycle, problem = self._played(*self._mixed(asked), way)
        return cycle, problem

    def _mixed(self, way: Way) -> tuple[Mix, bool]:
        """Return loops mixed for a way to go, and whether strikes tell how they go in step."""
        shares: dict[str, float] = {}
        for members, share in self._toward(way.direction):
            for motion, weight in zip(members, _weights(members, way), strict=True):
                if share * weight > 0.0:
                    shares[motion.name] = shares.get(motion.name, 0.0) + share * weight
        return _in_step([motion for motion in self.motions if motion.name in shares], shares)

    def _toward(self, direction: float) -> list[tuple[tuple[BaseMotion, ...], float]]:
        """Return the loops of the directions on either side of one, with their shares."""
        found = self.directions
        after = [(_wrapped(own - direction) % (2.0 * np.pi), members) for own, members in found]
        left = min(after, key=lambda entry: entry[0])
        right = min(after, key=lambda entry: (-entry[0]) % (2.0 * np.pi))
        gap, rest = left[0], (-right[0]) % (2.0 * np.pi)
        if left is right or gap < 1e-9 or rest < 1e-9 or gap + rest > np.pi + 1e-9:
            return [(min(left, right, key=lambda entry: min(entry[0], -entry[0] % (2.0 * np.pi)))[1], 1.0)]
        return [(left[1], rest / (gap + rest)), (right[1], gap / (gap + rest))]

    def _played(self, mix: Mix, marks: bool, way: Way) -> tuple[Cycle, str]:
        """Return a mixed cycle as fast as it is to be."""
        whole = mix.travel(np.array([mix.start + mix.cycle]))
        arc = self._arc(whole.places[0], float(whole.headings[0])) * RATE / mix.cycle
        speed = float(np.hypot(*arc))
        turn = float(whole.headings[0]) * RATE / mix.cycle
        height = mix.model.character.frame.height
        moves = speed > STILL * height
        had, wanted = (speed, way.speed) if moves else (abs(turn), abs(way.turn))
        asked = wanted / had if had > 1e-9 else 1.0
        factor = float(np.clip(asked, SLOWER, FASTER))
        problem = ""
        if abs(factor - asked) > 1e-6:
            what = "goes" if moves else "turns"
            unit = "m/s" if moves else "rad/s"
            problem = f"it {what} at {factor * had:.3g} {unit} instead of {wanted:.3g}, as near as its motions allow"
        elif moves and abs(factor * turn - way.turn) > 0.02 + 0.05 * abs(way.turn):
            problem = f"it turns at {factor * turn:.3g} rad/s instead of {way.turn:.3g}, as near as its motions allow"
        zero = float(mix.met[0]) if marks else mix.start
        strikes = tuple(float(mark - zero) / mix.cycle % 1.0 for mark in mix.met) if marks else (0.0,)
        velocity = float(factor * arc[0]), float(factor * arc[1])
        return Cycle(mix, mix.cycle, zero, factor / mix.cycle, strikes, velocity, factor * turn), problem

    @staticmethod
    def _arc(chord: Array, angle: float) -> Array:
        """Return the way along an arc, as seen from its beginning, of one that ends there having turned by an angle."""
        half = 0.5 * angle
        return turned(chord, np.array(-half)) * (half / np.sin(half) if 1e-9 < abs(half) < 3.0 else 1.0)


def _weights(members: Sequence[BaseMotion], way: Way) -> Array:
    """Return how much loops of one direction count."""
    known = [motion.annotations for motion in members]
    speeds = [own.speed for own in known]
    nearest = float(np.clip(way.speed, min(speeds), max(speeds)))
    # Played faster it also turns faster.
    factor = way.speed / nearest if nearest > 0.0 and way.speed > 0.0 else 1.0
    places = np.array([[own.speed, own.turn_rate] for own in known])
    turns = places[:, 1]
    turn = way.turn / factor
    if max(speeds) <= 0.0 and turns.min() < 0.0 < turns.max():
        # On the spot: each side by itself, as fast as is wanted.
        return np.where(np.sign(turns) == (np.sign(turn) or 1.0), 1.0, 0.0) / max(
            (np.sign(turns) == (np.sign(turn) or 1.0)).sum(), 1
        )
    space = BlendSpace(places)
    out = space.weights(np.array([nearest, turn]))
    if abs(space.place_of(out)[0] - nearest) <= NEAR * nearest:
        return out
    # It cannot turn so sharply at this speed: as sharply as it can.
    low, high = 0.0, 1.0
    for _ in range(20):
        middle = 0.5 * (low + high)
        tried = space.weights(np.array([nearest, middle * turn]))
        if abs(space.place_of(tried)[0] - nearest) <= NEAR * nearest:
            low, out = middle, tried
        else:
            high = middle
    return out


def _in_step(motions: Sequence[BaseMotion], shares: Mapping[str, float]) -> tuple[Mix, bool]:
    """Return loops in step, and whether strikes tell how."""
    marks = [_marks(motion) for motion in motions]
    orders = {tuple(foot for foot, _ in own) for own in marks}
    if len(orders) > 1:
        # They step in other orders: one foot leads.
        shared = sorted(foot for foot in next(iter(orders)) if all(foot in order for order in orders))
        marks = [[next(entry for entry in own if entry[0] == shared[0])] if shared else [] for own in marks]
    weights = [shares[motion.name] for motion in motions]
    used = tuple(tuple(frame for _, frame in own) for own in marks) if marks[0] else ()
    return Mix([Loop(0, motion.clip) for motion in motions], weights, True, used), bool(used)


def _marks(motion: BaseMotion) -> list[tuple[int, float]]:
    """Return feet and the frames at which they strike, in the order of one cycle that the first of them begins."""
    strikes = motion.annotations.strikes
    if not strikes:
        return []
    period = motion.clip.length
    first = min(strike.foot for strike in strikes)
    start = next(strike.frame for strike in strikes if strike.foot == first)
    after = sorted(((strike.frame - start) % period, strike.foot) for strike in strikes)
    out: list[tuple[int, float]] = []
    for since, foot in after:
        if not out or since > out[-1][1] - start + 1e-6 * period:
            out.append((foot, start + since))
    return out


def _wrapped(angle: float) -> float:
    return float((angle + np.pi) % (2.0 * np.pi) - np.pi)
