"""Allotting joints to goals: which joints bring which body to its place.

A joint serves one goal, but for stems, which goals share (Hecker 2008 §4.3.3). Goals of the spine are for the spine
phase; a body that the spine carries, such as a mouth, gives its goal to what carries it (§4.3.1), and several of them
give theirs together. All else that leads from the trunk to a goal is a limb.
"""

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise, takewhile

from .hierarchy import Hierarchy
from .plan import NONE, Limb


@dataclass(frozen=True)
class Place:
    """A goal for the place of a body."""

    goal: int
    """Its place among the goals."""
    body: int


@dataclass(frozen=True)
class Tip:
    """A goal that the spine is bent for."""

    goal: int
    owner: int
    """The body whose goal it is."""
    body: int
    """The body of the line that has it: the owner, or what it is delegated to."""


@dataclass(frozen=True)
class Shared:
    """Joints of a limb that goals share."""

    path: tuple[int, ...]
    """All of the shared part, from what carries it outward …"""
    joints: tuple[int, ...]
    """… and what of it bends."""
    bodies: tuple[int, ...]
    """Those that have the goals."""


@dataclass(frozen=True, eq=False)
class Asked:
    """What goals ask of a character."""

    hierarchy: Hierarchy
    places: tuple[Place, ...]
    """From the trunk outward; that of the root is none of the solver's."""
    turned: Mapping[int, int]
    """Bodies with a turn of their own, and the goals that say it."""
    bends_spine: bool
    """Whether it bends for them in a phase of its own."""

    @classmethod
    def of(cls, hierarchy: Hierarchy, wanted: Sequence[tuple[int, bool, bool]], bends_spine: bool) -> "Asked":
        """Return what is asked; ``wanted`` is for each goal its body, and whether it has a place and a rotation."""
        places = [Place(i, body) for i, (body, place, _) in enumerate(wanted) if place and body != hierarchy.root]
        places.sort(key=lambda place: (len(hierarchy.ancestors[place.body]), place.body))
        turned = {body: i for i, (body, _, rotation) in enumerate(wanted) if rotation}
        return cls(hierarchy, tuple(places), turned, bends_spine)

    @cached_property
    def posed(self) -> frozenset[int]:
        """Bodies with a goal for their place."""
        return frozenset(place.body for place in self.places)

    @cached_property
    def line(self) -> tuple[int, ...]:
        """The bodies of the trunk that can turn: where legs stand that nobody poses, it stands with them."""
        way, rest = self.hierarchy.way, self.hierarchy.rest
        standing = {self._carrier(limb.bones[0]) for limb in self.hierarchy.character.legs if self._stands(limb.bones)}
        way = way[max((i + 1 for i, body in enumerate(way) if body in standing), default=0) :]
        if len(way) < 3:
            return way
        # A bone that leads back (rigs have them to hang things on) only carries the next one.
        ahead = rest[way[-1]] - rest[way[0]]
        return tuple(b for b, after in pairwise(way) if (rest[after] - rest[b]) @ ahead > 0.0) + way[-1:]

    def _stands(self, leg: Iterable[int]) -> bool:
        """Return whether a leg does not follow the trunk."""
        return not (self.bends_spine and any(bone in self.posed for bone in leg))

    def _carrier(self, body: int) -> int:
        return next((a for a in self.hierarchy.ancestors[body] if a in self.hierarchy.trunk), NONE)


@dataclass(frozen=True, eq=False)
class Allotment:
    """Which joints bring which body to its place."""

    asked: Asked
    stems: tuple[Shared, ...]
    """What goals share, from the trunk outward."""
    limbs: tuple[Limb, ...]
    tips: tuple[Tip, ...]
    unreachable: tuple[int, ...]
    """Bodies that nothing is left for."""
    heads: tuple[Shared, ...] = ()
    """Joints of a trunk that does not bend by itself, and several bodies beyond that hang on the last of them alone."""

    @property
    def hierarchy(self) -> Hierarchy:
        """The character."""
        return self.asked.hierarchy

    @cached_property
    def turned(self) -> dict[int, tuple[int, ...]]:
        """Bodies with a turn, and the goals that say it; who is given goals for places is given their turns as well."""
        own = self.asked.turned
        out: dict[int, tuple[int, ...]] = {body: (goal,) for body, goal in own.items()}
        for tip in self.tips:
            if tip.owner in own and tip.body not in own:
                out[tip.body] = (*out.get(tip.body, ()), own[tip.owner])
        return out

    @cached_property
    def joints(self) -> frozenset[int]:
        """All joints of limbs."""
        of_heads = (joint for head in self.heads for joint in head.joints)
        return frozenset((*(joint for limb in self.limbs for joint in limb.path), *of_heads))

    def carrier(self, limb: Limb) -> int:
        """Return the body that carries a limb, NONE when none does: of the trunk, one that can turn or the root."""
        trunk, above = self.hierarchy.trunk, iter(self.hierarchy.ancestors[limb.path[0]])
        first = next((a for a in above if a in trunk or a in self._of_limbs), NONE)
        if first not in trunk or first in self.turned:
            return first
        # A bone of no length, as rigs have them between neck and shoulders, goes with the one before it.
        return next((a for a in (first, *above) if a in self.asked.line or a == self.hierarchy.root), first)

    @cached_property
    def _of_limbs(self) -> frozenset[int]:
        return self.joints | {limb.body for limb in self.limbs}


def allot(asked: Asked) -> Allotment:
    """Return which joints bring which body to its place; those nearer to the trunk choose first."""
    stems, heads = tuple(_stems(asked)), tuple(_heads(asked))
    # What only twists in a stem is no joint of the limbs beyond either.
    taken = {bone for shared in (*stems, *heads) for bone in shared.path}
    together = {body for head in heads for body in head.bodies}
    limbs: list[Limb] = []
    tips: list[Tip] = []
    unreachable: list[int] = []
    for place in asked.places:
        body = place.body
        if body in together:
            continue
        if joints := _joints(asked, body, taken):
            shared = tuple(joint for stem in stems if body in stem.bodies for joint in stem.joints)
            limbs.append(Limb(place.goal, body, joints, shared))
            taken.update(joints)
        elif (bent := _bent_for(asked, body, tips)) is not None:
            tips.append(Tip(place.goal, body, bent))
        else:
            unreachable.append(body)
    return Allotment(asked, stems, tuple(limbs), tuple(tips), tuple(unreachable), heads)


# --- stems ---


def _stems(asked: Asked) -> Iterator[Shared]:
    """Yield what goals share of limbs that branch, from the trunk outward; each goal keeps joints of its own."""
    groups = [{body: path for body in (place.body for place in asked.places) if (path := _shareable(asked, body))}]
    while groups:
        by_first: dict[int, dict[int, tuple[int, ...]]] = {}
        for body, path in groups.pop(0).items():
            alike = by_first.setdefault(path[0], {})
            if path not in alike.values():  # of two bodies that the same joints move, the first one has them
                alike[body] = path
        for own in by_first.values():
            least = min(len(path) for path in own.values()) - 1
            shared = tuple(row[0] for row in zip(*own.values(), strict=False) if len(set(row)) == 1)[:least]
            if len(own) > 1 and shared:
                yield Shared(shared, asked.hierarchy.hinged(shared), tuple(own))
                groups.append({body: path[len(shared) :] for body, path in own.items()})


def _shareable(asked: Asked, body: int) -> tuple[int, ...]:
    """Return the bodies between the trunk, or the next body with a goal, and a body at the end of a limb."""
    hierarchy = asked.hierarchy
    if body in asked.line or not hierarchy.is_on_limb(body):
        return ()
    above = hierarchy.ancestors[body]
    stops = {a for other in above if other in asked.posed for a in hierarchy.ancestors[other]}
    stops |= hierarchy.trunk | hierarchy.above_root | {*hierarchy.midline}
    return _up_to(stops, above)


def _heads(asked: Asked) -> Iterator[Shared]:
    """Yield necks, with their heads, that bring several bodies to places: all those that the same joints move."""
    moved_by: dict[tuple[int, ...], list[int]] = {}
    for body in () if asked.bends_spine else (place.body for place in asked.places):
        path = () if body in asked.line else _joints_of_trunk(asked, body, frozenset())
        moved_by.setdefault(path, []).append(body)
    for path, bodies in moved_by.items():
        if path and len(bodies) > 1:
            yield Shared(path, path, tuple(bodies))


# --- limbs ---


def _joints(asked: Asked, body: int, taken: Set[int]) -> tuple[int, ...]:
    """Return the joints that bring a body to a place as a limb, from the trunk outward; none when it is no limb."""
    if asked.bends_spine and body in asked.line:
        return ()
    if not asked.bends_spine and (neck := _joints_of_trunk(asked, body, taken)):
        return neck
    hierarchy = asked.hierarchy
    # What carries the root carries the whole body: feet that hang on it (IK bones) have no limb that could reach.
    joints = hierarchy.hinged(_up_to(taken | hierarchy.trunk | hierarchy.above_root, hierarchy.ancestors[body]))
    return () if joints and _is_delegated(asked, body, joints[0]) else joints


def _joints_of_trunk(asked: Asked, body: int, taken: Set[int]) -> tuple[int, ...]:
    """Return the joints of the trunk that bring a body of it, or a mouth, to a place as those of a limb do."""
    hierarchy = asked.hierarchy
    above = hierarchy.ancestors[body]
    if hierarchy.is_on_limb(body) or not any(bone in asked.line for bone in (body, *above)):
        return ()
    # What has a turn of its own keeps it: the rest of the trunk has to do.
    return _up_to({*taken, *asked.posed, *asked.turned, *(hierarchy.trunk - {*asked.line})}, above)


def _is_delegated(asked: Asked, body: int, first: int) -> bool:
    """Return whether a body that the spine carries gives its goal to it; ``first`` joint of what would be its limb."""
    return not asked.hierarchy.is_on_limb(body) and any(a in asked.line for a in asked.hierarchy.ancestors[first][:1])


def _up_to(stops: Collection[int], above: Iterable[int]) -> tuple[int, ...]:
    """Return ancestors up to the first one that stops, from there outward."""
    return tuple(reversed(list(takewhile(lambda bone: bone not in stops, above))))


# --- the spine ---


def _bent_for(asked: Asked, body: int, tips: Iterable[Tip]) -> int | None:
    """Return the body of the line that has a goal, or gets it if it has none; None when the spine cannot help."""
    if not asked.bends_spine:
        return None
    if body in asked.line:
        return body
    carrier = next((a for a in asked.hierarchy.ancestors[body] if a in asked.line), None)
    is_free = not asked.hierarchy.is_on_limb(body) and not any(tip.owner == carrier for tip in tips)
    return carrier if is_free else None
