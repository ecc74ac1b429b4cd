"""When the feet of a motion touch down, found from the motion alone (what Grünvogel 2003 §5.4 wishes for).

A foot stands while some point of its sole is low and about as slow as the ground under it. What counts as slow grows
with the speed of the body, since a foot that rolls over its heel is not still. Clips of games often go on the spot:
there the ground is a belt that runs under the body. Animators let feet slide on that, but keep them on the floor, so
on a belt a foot that is on the floor counts as standing even if it is not as fast as the belt.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ... import contacts
from ...arrays import Array, Flags
from ...runs import runs
from ..travel import Travel
from .seen import Seen, gradient


@dataclass(frozen=True)
class FootfallSettings:
    """When a foot counts as standing. Lengths are in leg lengths, speeds in leg lengths a second."""

    slow: float = 0.2
    """A low foot slower than this starts to stand …"""
    slow_share: float = 0.4
    """… and as much slower than the body as this share of the body's speed."""
    ends: float = 1.6
    """It has left when it is faster than that by this factor."""
    very: float = 0.5
    """A foot that is slower than this share of that stands at any height, if it has come down to it …"""
    above_time: float = 0.15
    """… within this time [s] …"""
    shortest_above: float = 0.2
    """… and stays for longer than this [s]."""
    low: float = 0.06
    """How far above its floor a foot is still low."""
    floor: float = 0.02
    """How far above its floor a foot is still on it."""
    against: float = 0.7
    """On a belt a foot that goes against it faster than this share of its speed does not stand."""
    along: float = 0.15
    """How fast a belt is, is told by feet faster than this share of the fastest."""
    common: float = 0.4
    """The feet on the floor go with a belt at this share of its speed, or faster: most of them do not stand still."""
    belt: float = 0.25
    """A belt is faster than this …"""
    still: float = 0.3
    """… and the body slower than this share of its speed …"""
    steps: float = 0.03
    """… and every foot is lifted higher than this."""
    shortest: float = 0.06
    """Shorter contacts are dropped [s]."""
    shortest_flight: float = 0.05
    """Shorter flights between two contacts are closed [s]."""
    lifted: float = 0.012
    """A foot that was not lifted higher than this since it last stood has not left the ground."""


DEFAULT = FootfallSettings()


@dataclass(frozen=True, eq=False)
class Footfalls:
    """When the feet of a motion stand."""

    seen: Seen
    settings: FootfallSettings
    cycle: int = 0
    """Frames after which the motion is the same again, at most all it has; 0 for one that is no cycle."""

    @cached_property
    def belt(self) -> Array:
        """Velocity of the ground under a body that goes on the spot [m/s], shape (2,); 0 where the ground is still."""
        seen, own = self.seen, self.settings
        moving: list[Array] = []
        low: list[Flags] = []
        lifts: list[float] = []
        for points in seen.soles:
            height = (points[..., 2] - points[..., 2].min(axis=0)) / seen.size
            near = np.pad(height < own.low, [(1, 1), (0, 0)])
            # A foot that touches the floor for a moment only has swung through it.
            low.append((height < own.floor) & (near[:-2] | near[2:]))
            moving.append(gradient(points, seen.step)[..., :2])
            lifts.append(float(height.min(axis=1).max()))
        velocities = np.concatenate([own[stays] for own, stays in zip(moving, low, strict=True)] or [np.zeros((0, 2))])
        if not len(velocities):
            return np.zeros(2)
        # Some feet are on the floor while they swing or turn: the middle one tells whereto the belt runs …
        along = np.median(velocities, axis=0)
        speeds = velocities @ along / max(float(np.hypot(*along)), 1e-9)
        # … and those that go with it, how fast it is: animators let them start and stop softly.
        found = velocities[speeds >= own.along * np.percentile(speeds, 90.0)].mean(axis=0)
        speed = float(np.hypot(*found))
        drift = float(np.hypot(*(seen.way[-1, :2] - seen.way[0, :2]))) / max((len(seen) - 1) * seen.step, 1e-9)
        runs_on = speed > own.belt * seen.size and float(np.hypot(*along)) > own.common * speed
        return found if runs_on and drift < own.still * speed and min(lifts) > own.steps else np.zeros(2)

    @property
    def is_on_the_spot(self) -> bool:
        """Whether the ground runs under a body that stays where it is."""
        return bool(self.belt.any())

    @cached_property
    def gone(self) -> Array:
        """How far the ground has run under the body since the first frame [m], shape (frame, 2)."""
        return self.seen.step * np.arange(len(self.seen))[:, None] * self.belt

    @cached_property
    def way(self) -> Travel:
        """The slow way of the body over the ground, shape (frame,); what goes on the spot looks where its rig does."""
        own = self.seen.way
        headings = np.zeros(len(own)) if self.is_on_the_spot else own[:, 2]
        return Travel(own[:, :2] - self.gone, headings)

    @cached_property
    def velocity(self) -> Array:
        """Of the body over the ground [m/s], shape (frame, 2)."""
        return self.seen.velocity - self.belt

    @cached_property
    def stands(self) -> Flags:
        """Whether each foot stands, shape (frame, foot)."""
        out = np.zeros((len(self.seen), len(self.seen.soles)), dtype=np.bool_)
        for foot, found in enumerate(self._contacts):
            for contact in found:
                rows = np.arange(contact.first, contact.last + 1)
                out[rows[rows < len(out)] if not self.cycle else rows % self.cycle, foot] = True
            if self.cycle:
                out[self.cycle :, foot] = out[: len(out) - self.cycle, foot]
        return out

    @cached_property
    def heights(self) -> Array:
        """How high each foot is over where it stands [leg lengths], shape (frame, foot)."""
        if len(self.seen) < 2 or not self.seen.soles:
            return np.zeros((len(self.seen), len(self.seen.soles)))
        return np.stack([self._watched(foot)[1] for foot in range(len(self.seen.soles))], axis=1)

    @cached_property
    def strikes(self) -> tuple[tuple[int, float], ...]:
        """Foot and row, between two frames, of each touch-down, in order of time."""
        found = [
            (foot, contact.strike % self.cycle if self.cycle else contact.strike)
            for foot, own in enumerate(self._contacts)
            for contact in own
            if contact.strike is not None
        ]
        return tuple(sorted(found, key=lambda strike: strike[1]))

    @cached_property
    def _contacts(self) -> tuple[tuple["_Contact", ...], ...]:
        """Contacts of each foot; in a cycle those that begin within one round."""
        if len(self.seen) < 2:
            return tuple(() for _ in self.seen.soles)
        return tuple(self._contacts_of(foot) for foot in range(len(self.seen.soles)))

    def _contacts_of(self, foot: int) -> tuple["_Contact", ...]:
        own, step = self.settings, self.seen.step
        margin, height = (self._rounds(values) for values in self._watched(foot))
        stands = contacts.hysteresis(margin < 1.0, margin < own.ends)
        if stands.all():
            return (_Contact(0, len(self.seen) - 1, None),)
        contacts.drop_short(stands, False, own.shortest_flight / step)
        contacts.drop_short(stands, True, own.shortest / step)
        out: list[_Contact] = []
        before = -1
        for first, last in runs(stands):
            reach = max(round(own.above_time / step), 1)
            above = first == 0 or height[max(first - reach, 0) : first].max() > height[first] + own.lifted
            lasts = (last - first) * step > own.shortest_above
            if height[first : last + 1].min() > own.low and not (above and lasts):
                continue  # still in the air: it has come from below, or is about to go on
            flight = height[before + 1 : first]
            level = height[first : last + 1].min()
            lands = first + int(np.argmax(margin[first : last + 1] < 1.0))
            falls = height[first] if not len(flight) else flight.max()
            struck = lands > 0 and bool(falls > level + own.lifted)
            out.append(_Contact(first, last, _crossing(margin, lands) if struck else None))
            before = last
        if not self.cycle:
            return tuple(out)
        return tuple(contact for contact in out if self.cycle <= contact.first < 2 * self.cycle)

    def _rounds(self, values: Array) -> Array:
        """Return values of three rounds of a cycle, or those of the motion."""
        return np.tile(values[: self.cycle], 3) if self.cycle else values

    def _watched(self, foot: int) -> tuple[Array, Array]:
        """Return how far a foot is from standing, where it stands below 1, and how high it is, shapes (frame,)."""
        seen, own = self.seen, self.settings
        points = seen.soles[foot] / seen.size
        still = points.copy()
        still[..., :2] -= self.gone[:, None] / seen.size
        limit = own.slow + own.slow_share * np.hypot(*self.velocity.T) / seen.size
        ratio = contacts.speeds(still, seen.step) / limit[:, None]
        height = points[..., 2] - _levels(points[..., 2], ratio)
        margin = np.minimum(np.maximum(ratio, height / own.low), ratio / own.very)
        if self.is_on_the_spot:
            speed = float(np.hypot(*self.belt))
            against = -(gradient(points[..., :2], seen.step) * seen.size) @ self.belt / speed**2
            margin = np.minimum(margin, np.maximum(height / own.floor, against / own.against))
        return margin.min(axis=1), height.min(axis=1)


@dataclass(frozen=True)
class _Contact:
    """One time for which a foot stands."""

    first: int
    last: int
    """Rows, both included; in a cycle they may go on into the next round."""
    strike: float | None
    """When it touched down, None where it was never lifted or stood from the beginning."""


def _levels(heights: Array, ratio: Array) -> Array:
    """Return how high the points of a sole are where they stand on the lowest ground, shape (point,).

    Args:
        heights: Of the points, shape (frame, point).
        ratio: Their speeds over what is slow, shape (frame, point).
    """
    out = heights.min(axis=0)
    for i in range(len(out)):
        slow = ratio[:, i] < 1.0
        if slow.any():
            out[i] = np.quantile(heights[slow, i], 0.1)
    return out


def _crossing(margin: Array, first: int) -> float:
    """Return when a foot came to stand that does so in row ``first`` and did not in the row before."""
    before, after = float(margin[first - 1]), float(margin[first])
    return first - 1 + float(np.clip((before - 1.0) / max(before - after, 1e-9), 0.0, 1.0))
