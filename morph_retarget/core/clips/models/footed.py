"""Blends in which what stands keeps standing.

Where two motions that step differently are blended, a foot that stands in both is at two places as the travel sees it,
and on its way from the one to the other it would slide. But a body goes where its standing feet carry it: so it is the
way over the ground that gives. Where one of the motions stands all the time, feet whose distances differ take a step
each. What little slides then is taken out by planting (Feng 2013 §5.2).
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ... import quat
from ...arrays import Array, Flags
from ..character_model import RATE
from ..frames import Frames
from ..operators import ways
from ..operators.blend import Blend
from ..operators.envelope import risen
from ..operators.rows import copied
from ..operators.ways import Way
from ..spots import in_travel, in_world
from ..travel import Travel, turned

SOME = 0.05
"""Feet carry the body in full when their contacts add up to this."""
SURE = 25.0
"""A foot whose contact lacks the inverse of this to 1 does not stand at all."""
SLIDES = 0.0015
"""Feet that would slide further than this in a blend take a step [body heights] …"""
STILL = 0.01
"""Who goes less far [body heights] and turns less [rad] stays where it is."""
STEP = 0.2
"""… which takes so long [s for a body of 1 m; longer ones swing as pendulums] …"""
LIFT, HIGHEST = 0.25, 0.06
"""… and is as high as so much of its length, at most so many body heights."""


@dataclass(frozen=True, eq=False)
class Footed(Blend):
    """A blend whose way over the ground follows from the feet that stand."""

    @cached_property
    def steps(self) -> Mapping[int, tuple[float, float]]:
        """Feet that take a step of their own, and from which frame to which; none in most blends."""
        nodes, count = self._nodes, len(self.model.feet)
        a, b = self._both(nodes)
        still = [frames for frames, way in ((a, self._first_way), (b, self._second_way)) if self._stays(way(nodes))]
        if not count or len(nodes) < 3 or not still:
            return {}
        _, slid, stands = self._carried(a, b)
        away = (stands * quat.length(slid - _shared(slid, stands)[:, None])).sum(axis=0)
        if away.max() < SLIDES * self.model.character.frame.height:
            return {}
        # Feet of a row swing in turns, and those behind each other too; first those that one of the motions lifts.
        turns = np.array([(foot // 2 + foot) % 2 for foot in range(count)])
        early = (b if still[0] is a else a).contacts[: len(nodes) // 2].mean(axis=0)
        if count > 1 and early[turns == 0].mean() > early[turns == 1].mean():
            turns = 1 - turns
        middle = 0.5 * (self.begin + self.finish)
        halves = (self.begin, middle), (middle, self.finish)
        return {foot: halves[int(turn)] for foot, turn in enumerate(turns)}

    def _stays(self, way: Travel) -> bool:
        """Return whether a travel leads nowhere."""
        steps = way.steps()
        gone = float(np.hypot(steps.places[:, 0], steps.places[:, 1]).sum()) / self.model.character.frame.height
        return gone < STILL and float(np.abs(steps.headings).sum()) < STILL

    @property
    def least(self) -> float:
        """Frames that it has to last at the least, so that feet have the time for their steps."""
        return 2.0 * STEP * float(np.sqrt(self.model.character.frame.height)) * RATE if self.steps else 0.0

    def frame(self, times: Array) -> Frames:
        """Return frames at times, shape (n,)."""
        out = super().frame(times)
        rows = np.flatnonzero((times > self.begin) & (times < self.finish))
        if not len(rows) or not self.steps:
            return out
        own, (a, b) = times[rows], self._both(times[rows])
        out = copied(out)
        out.feet[rows], out.contacts[rows] = self._stepped(a, b, own)
        for foot, (first, last) in self.steps.items():
            leg = np.flatnonzero(self.legs[foot])
            turns = quat.slerp(a.rotations[:, leg], b.rotations[:, leg], risen(own, first, last)[:, None])
            out.rotations[np.ix_(rows, leg)] = turns
        return out

    @cached_property
    def legs(self) -> tuple[Flags, ...]:
        """Joints of the leg of each foot, shape (joint,)."""
        own, out = self.model.character, list[Flags]()
        for leg in own.legs:
            joints = np.zeros(len(self.model), dtype=np.bool_)
            joints[[leg.bones[0], *own.skeleton.tree.below(leg.bones[0])]] = True
            out.append(joints)
        return tuple(out)

    @property
    def _nodes(self) -> Array:
        return ways.between(self.begin, self.finish)

    @cached_property
    def _window(self) -> Way:
        steps, slid, stands = self._carried(*self._both(self._nodes))
        if not self.steps:
            full = np.minimum(stands.sum(axis=1) / SOME, 1.0)
            steps = Travel(steps.places - full[:, None] * _shared(slid, stands), steps.headings)
        return Way(self._nodes, steps.summed())

    def _both(self, times: Array) -> tuple[Frames, Frames]:
        return self.first.frame(times - self._first_time), self.second.frame(times - self._second_time)

    def _carried(self, a: Frames, b: Frames) -> tuple[Travel, Array, Array]:
        """Return steps of the travel as they are mixed, how far feet would slide with these, and which stand.

        Args:
            a: The first clip at the nodes.
            b: The second.

        Returns:
            For what lies between the n nodes, shapes (n - 1), (n - 1, foot, 2) [m] and (n - 1, foot).
        """
        nodes = self._nodes
        own, other = self._first_way(nodes).steps(), self._second_way(nodes).steps()
        middle, share = self.share(0.5 * (nodes[1:] + nodes[:-1])), self.share(nodes)[:, None]
        steps, part = own.mixed(other, middle), middle[:, None, None]
        # What slides in the two motions themselves, as a heel that rolls off does, is meant.
        meant = (1.0 - part) * _slips(a.feet, own) + part * _slips(b.feet, other)
        slid = _slips(a.feet + share[..., None] * (b.feet - a.feet), steps) - meant
        stands = standing(a.contacts + share * (b.contacts - a.contacts))
        return steps, slid, np.minimum(stands[1:], stands[:-1])

    def _stepped(self, a: Frames, b: Frames, times: Array) -> tuple[Array, Array]:
        """Return the places of feet that take steps, as seen from the travel [m], shape (n, foot, 3), and contacts.

        Up to its step each foot is where the first motion has it in the world, and from then on where the second has.
        """
        travel = self._at_begin.then(self._window.at(times))
        old = in_travel(in_world(a.feet, self._first_way(times)), travel)
        new = in_travel(in_world(b.feet, self._from_finish.then(self._second_way(times))), travel)
        feet, contacts = old.copy(), a.contacts.copy()
        highest = HIGHEST * self.model.character.frame.height
        for foot, (first, last) in self.steps.items():
            rise = risen(times, first, last)
            way = new[:, foot] - old[:, foot]
            feet[:, foot] += rise[:, None] * way
            feet[:, foot, 2] += 4.0 * rise * (1.0 - rise) * np.minimum(LIFT * quat.length(way), highest)
            contacts[:, foot] = np.where(times <= first, a.contacts[:, foot], b.contacts[:, foot] * (times >= last))
        return feet, contacts


def standing(contacts: Array) -> Array:
    """Return how far feet stand, 0 … 1, of any shape, whose contacts were blended.

    Only those do that stand in all that counts. A foot that swings in one motion is carried along by it, however
    little that counts.
    """
    return np.maximum(1.0 - SURE * (1.0 - contacts), 0.0)


def _shared(slid: Array, stands: Array) -> Array:
    """Return how far feet that stand slide together, shapes (n, foot, 2) and (n, foot) to (n, 2)."""
    total = np.maximum(stands.sum(axis=1), 1e-12)
    return (stands[..., None] * slid).sum(axis=1) / total[:, None]


def _slips(feet: Array, steps: Travel) -> Array:
    """Return how far feet move over the ground from node to node [m], as seen from each, shape (n - 1, foot, 2)."""
    after = turned(feet[1:, :, :2], steps.headings[:, None]) + steps.places[:, None]
    return after - feet[:-1, :, :2]
