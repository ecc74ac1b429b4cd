"""How the goals of some bodies are met on a character: what `planning` finds once and `posing` reads for each clip."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise

import numpy as np

from ..arrays import Array, Indices
from .branching import Stem
from .collision import Obstacles
from .limb_phase import Limbs
from .limit_phase import Limited, LimitedLimbs
from .settings import DEFAULT, SolverSettings
from .spine import Spine
from .stretching import Elastic

NONE = -1


@dataclass(frozen=True)
class Limb:
    """Joints that bring a body to its place."""

    goal: int
    """Its place among the goals."""
    body: int
    joints: tuple[int, ...]
    """From what carries the limb outward."""
    stem: tuple[int, ...] = ()
    """Joints before these that it shares with others."""

    @property
    def path(self) -> tuple[int, ...]:
        """All joints, from the trunk outward."""
        return (*self.stem, *self.joints)


@dataclass(frozen=True, eq=False)
class Wave:
    """Limbs that are solved at the same time."""

    limbs: tuple[Limb, ...]
    chains: Limbs
    goals: Indices
    """Their places among the goals, shape (limb,); those of all that branches off a stem, shape (goal,)."""
    stem: Stem | None = None
    """What the only one of the limbs is, if several goals share it."""
    rigid: tuple[int, ...] = ()
    """Bodies of these goals that the stem alone brings to their places."""
    limited: LimitedLimbs | None = None
    """Limits of their joints, None when there are none."""
    obstacles: Obstacles | None = None
    """What they keep out of, None when there is nothing."""
    elastic: Elastic | None = None
    """What of them may stretch, None when nothing may."""

    @cached_property
    def ends(self) -> list[int]:
        """The bodies at the ends of the limbs; none for a stem, whose last bone leads to no single one."""
        return [limb.body for limb in self.limbs] if self.stem is None else []

    @cached_property
    def joints(self) -> list[tuple[int, int, int]]:
        """All joints, with the limb and the place in it that each has among the chains."""
        most = self.chains.segments.shape[1]
        return [
            (joint, i, place)
            for i, limb in enumerate(self.limbs)
            for place, joint in enumerate(limb.joints, most - len(limb.joints))
        ]


@dataclass(frozen=True)
class Pin:
    """A branch point of the spine that has a goal of its own."""

    node: int
    goal: int
    owner: int
    """The body whose goal it is."""
    body: int
    """The body of the trunk that has it: the owner, or what it is delegated to."""
    offset: Array = field(default_factory=lambda: np.zeros(3))
    """From the branch point to the body whose goal it is, at rest [m], shape (3,)."""


@dataclass(frozen=True, eq=False)
class Trunk:
    """The spine that bends, and what bends it."""

    spine: Spine
    joints: tuple[int, ...]
    pins: tuple[Pin, ...]
    pulls: tuple[int, ...]
    """Goals of the limbs that pull, in the order of the spine's pulls."""
    last: int
    """The body at the last branch point, NONE when it is where a bone ends."""

    @property
    def ends(self) -> tuple[int, ...]:
        """The bodies at the ends of its bones, NONE where there is none."""
        return (*self.joints[1:], self.last)

    @cached_property
    def pinned(self) -> dict[int, list[Pin]]:
        """The pins of each branch point that has any: several where goals are delegated to the same body."""
        return {pin.node: [own for own in self.pins if own.node == pin.node] for pin in self.pins}

    @property
    def shares(self) -> bool:
        """Whether several goals are delegated to one body."""
        return len(self.pinned) < len(self.pins)

    def joints_to(self, node: int) -> tuple[int, ...]:
        """Return the joints that bring a branch point to its goal: those beyond what has a goal of its own before it.

        Nor do they turn what limbs hold, as feet that stand do.
        """
        nodes = self.spine.nodes
        own = (*self.pinned, *(pull.node for pull in self.spine.pulls if pull.holds))
        return self.joints[nodes[max((before for before in own if before < node), default=0)] : nodes[node]]

    @cached_property
    def drawn(self) -> dict[int, int]:
        """Bodies whose joints move when bones of the spine stretch, and the places of these bones among its joints."""
        if self.spine.free is None:
            return {}
        return {body: i for i, body in enumerate(self.ends) if self.spine.free[i] and body != NONE}


@dataclass(frozen=True, eq=False)
class Nudge:
    """Limbs that hang on the root and may move it."""

    goals: Indices
    """Their places among the goals, shape (limb,)."""
    starts: Array
    """Where they start, from the root at rest [m], shape (limb, 3)."""
    reach: Array
    """Up to where they reach their goals without slowing down [m], shape (limb,)."""
    least: Array
    """Length when they are folded up [m], shape (limb,)."""
    most: float
    """Most that they move the root [m]."""


@dataclass(frozen=True, eq=False)
class Plan:
    """How the goals of some bodies are met on a character."""

    parents: Indices
    """What carries each body, -1 for roots, shape (body,)."""
    rest: Array
    """Rest positions of all bodies [m], character frame, shape (body, 3)."""
    root: int
    trunk: Trunk | None
    waves: tuple[Wave, ...]
    turned: dict[int, int]
    """Bodies with a turn of their own, and the goals that say it; mouths on the spine delegate theirs. From the number
    of goals on, one of `means`."""
    level: dict[int, int]
    """Bodies that keep their rest orientation as far as they have a place but no turn, and the goals: feet do."""
    leaders: Indices
    """For each body the nearest one upward (itself included) that turns by itself, or a root; shape (body,)."""
    order: tuple[int, ...]
    """The leaders, from the roots outward."""
    driven: tuple[int, ...]
    """Bodies that the goals turn, from the root outward; the others are carried along."""
    unreachable: tuple[int, ...]
    """Bodies whose place cannot be changed: they are fixed to what carries them, or another goal has its joints."""
    settings: SolverSettings = field(default=DEFAULT)
    nudge: Nudge | None = None
    """What may move the root, None when nothing may."""
    limited: Limited | None = None
    """Limits of the leaders' turns, None when there are none."""
    stretched: tuple[int, ...] = ()
    """Leaders whose joints move off where their parents hold them: as bones stretch, or since these hang elsewhere."""
    stiff: tuple[int, ...] = ()
    """Bodies that cannot, so that limbs and pieces of the spine keep their lengths."""
    detached: Mapping[int, int] = field(default_factory=dict[int, int])
    """Feet and hands that do not hang on what carries them, and what each hangs on, NONE when it hangs on nothing."""
    means: tuple[tuple[int, tuple[int, ...]], ...] = ()
    """Bodies that several goals give their turns to, and these goals."""

    @cached_property
    def led_by(self) -> Indices:
        """For each body the place of its leader in `order`, shape (body,)."""
        place = np.empty(len(self.rest), dtype=np.intp)
        place[list(self.order)] = np.arange(len(self.order))
        return place[self.leaders]

    def joints_of(self, body: int) -> tuple[int, ...]:
        """Return the joints that bring a body to its place, none where nothing does."""
        if self.trunk is not None:
            for pin in self.trunk.pins:
                if pin.owner == body:
                    return self.trunk.joints_to(pin.node)
        own = ((wave, limb) for wave in self.waves for limb in wave.limbs)
        return next((limb.path for wave, limb in own if body in (wave.rigid or (limb.body,))), ())

    @cached_property
    def ends(self) -> tuple[int, ...]:
        """Bodies that limbs end with, which is what their settings are called by; from the trunk outward."""
        found = [wave.limbs[0].joints[-1:] if wave.stem else [limb.body for limb in wave.limbs] for wave in self.waves]
        return tuple(dict.fromkeys(body for own in found for body in own))

    @cached_property
    def astray(self) -> set[int]:
        """Joints of limbs that hang on what turns by itself and is no joint, as twist bones may, and those beyond."""
        out: set[int] = set()
        for limb in (limb for wave in self.waves for limb in wave.limbs):
            out.update(j for before, j in pairwise(limb.joints) if before in out or self.above[j] != before)
        return out

    @cached_property
    def posed(self) -> Mapping[Wave, list[list[int]]]:
        """For each wave its limbs whose joints all have turns of their own, those of as many joints together."""
        out: dict[Wave, list[list[int]]] = {}
        for wave in self.waves:
            alike: dict[int, list[int]] = {}
            for i, limb in enumerate(wave.limbs):
                if all(joint in self.turned for joint in limb.joints):
                    alike.setdefault(len(limb.joints), []).append(i)
            out[wave] = list(alike.values())
        return out

    @cached_property
    def riders(self) -> Mapping[int, int]:
        """Bodies with turns of their own that hang on joints of limbs, as twist bones do, and on which."""
        moved = {body for wave in self.waves for limb in wave.limbs for body in (*limb.joints, limb.body)}
        joints = {joint for wave in self.waves for limb in wave.limbs for joint in limb.joints}
        on: dict[int, int] = {}
        for leader in self.order:
            above = self.above[leader]
            on[leader] = leader if leader in moved else on.get(above, NONE)
        return {b: on[b] for b in self.order if b in self.turned and b not in moved and on[b] in joints}

    @cached_property
    def anchors(self) -> Indices:
        """Leaders that are not placed by what carries them, by their places in `order`: the root, and roots above."""
        return np.flatnonzero([leader == self.root or self.above[leader] == NONE for leader in self.order])

    @cached_property
    def carriers(self) -> Indices:
        """For each leader the place in `order` of the one that carries it, its own for anchors, shape (leader,)."""
        place = {leader: i for i, leader in enumerate(self.order)}
        return np.array([i if i in self.anchors else place[self.above[b]] for i, b in enumerate(self.order)])

    @cached_property
    def offsets(self) -> Array:
        """From what carries each leader to it at rest [m], shape (leader, 3)."""
        order = np.array(self.order)
        return self.rest[order] - self.rest[order[self.carriers]]

    @cached_property
    def anchored(self) -> Array:
        """Where the anchors rest [m], shape (anchor, 3)."""
        return self.rest[[self.order[i] for i in self.anchors]]

    @cached_property
    def ways(self) -> dict[int, Array]:
        """From what carries each leader to it at rest [m], shapes (3,); none to roots."""
        return {leader: self.rest[leader] - self.rest[above] for leader, above in self.above.items() if above != NONE}

    @cached_property
    def away(self) -> Array:
        """From the leader of each body to it at rest [m], shape (body, 3)."""
        return self.rest - self.rest[self.leaders]

    @cached_property
    def lines(self) -> Array:
        """1 for each leader and those between it and its anchor, that one included, shape (leader, leader)."""
        out = np.eye(len(self.order))
        for i, carrier in enumerate(self.carriers.tolist()):
            if carrier != i:
                out[i] += out[carrier]
        return out

    @cached_property
    def above(self) -> dict[int, int]:
        """For each leader the one that carries it, NONE for roots."""
        return self._leading({leader: int(self.parents[leader]) for leader in self.order})

    @cached_property
    def holders(self) -> dict[int, int]:
        """For each leader the one whose turn it really takes over, NONE for roots: what its limits count from."""
        return {**self.above, **self._leading(self.detached)}

    def _leading(self, parents: Mapping[int, int]) -> dict[int, int]:
        return {leader: int(self.leaders[parent]) if parent >= 0 else NONE for leader, parent in parents.items()}
