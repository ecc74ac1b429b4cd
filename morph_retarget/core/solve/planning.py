"""Finding which joints each goal moves.

The trunk (spine, neck and head) is the business of the spine phase; all else that leads from the trunk to a goal is a
limb, solved after it, those that hang on other limbs last. A sub-tree without goals is carried along.
"""

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import pairwise, takewhile

import numpy as np

from .. import quat
from ..arrays import Array, Flags
from ..character import morphology
from ..character.character import Character
from ..character.morphology import Capability, LimbKind
from ..errors import RigError, listed
from .branching import Stem
from .capsules import Capsules
from .collision import Obstacles
from .limb_phase import Limbs
from .limb_settings import LimbSettings
from .limit_phase import Limited, LimitedLimbs
from .limits import JointLimits
from .plan import NONE, Limb, Nudge, Pin, Plan, Trunk, Wave
from .settings import DEFAULT, SolverSettings
from .spine import Pull, Spine
from .stretching import Elastic


def prepare(
    character: Character,
    rest: Array,
    root: int,
    wanted: Sequence[tuple[int, bool, bool]],
    settings: SolverSettings = DEFAULT,
    limits: JointLimits | None = None,
    fixed: Collection[int] = (),
) -> Plan:
    """Return how goals for some bodies are met.

    Args:
        character: What the rig is.
        rest: Rest positions of all bodies [m], character frame, shape (body, 3).
        root: The body that carries all others.
        wanted: For each goal its body, and whether it has a place and a rotation.
        settings: Of the solver.
        limits: Of all bodies, shapes (body, 3); None when nothing limits them.
        fixed: Bodies whose joints cannot move off where their parents hold them, whatever may stretch.

    Raises:
        RigError: A limb has settings that is none of the character.
    """
    names, tree = character.skeleton.names, character.skeleton.tree
    unknown = [name for name in settings.limbs if name not in character.skeleton.index]
    if unknown:
        ends = listed(names[body] for body, position, _ in wanted if position)
        raise RigError(f"solver settings are for {unknown[0]!r}, which is no bone: choose the end of a limb, as {ends}")
    return _Planning(character, rest, root, wanted, settings, limits, fixed).plan(tree.order)


class _Planning:
    def __init__(
        self,
        character: Character,
        rest: Array,
        root: int,
        wanted: Sequence[tuple[int, bool, bool]],
        settings: SolverSettings,
        limits: JointLimits | None,
        fixed: Collection[int],
    ) -> None:
        self.character, self.rest, self.root, self.settings = character, rest, root, settings
        self.limits, self.fixed = limits, fixed
        self.stiff: list[int] = []
        """Fixed bodies that keep something from stretching."""
        self.ancestors = character.skeleton.tree.ancestors
        self.turned = {body: i for i, (body, _, rotation) in enumerate(wanted) if rotation}
        places = [(i, body) for i, (body, position, _) in enumerate(wanted) if position and body != root]
        self.places = sorted(places, key=lambda goal: (len(self.ancestors[goal[1]]), goal[1]))
        self.posed = {body for _, body in self.places}
        self.line = self._line()
        self.stems: list[tuple[tuple[int, ...], tuple[int, ...]]] = []
        """Joints that goals share, and the bodies that have these goals; from the trunk outward."""
        self.limbs: list[Limb] = []
        self.tips: list[tuple[int, int, int]] = []
        """Goals of the line: the goal, its body, and the body of the line that has it or that it is delegated to."""
        self.unreachable: list[int] = []

    def _way(self) -> tuple[int, ...]:
        """Return the bodies of the trunk from the root to the head, or to where the spine ends."""
        own = self.character
        trunk = [b for b in (*own.spine, *own.neck, *([] if own.head is None else [own.head])) if self._is_carried(b)]
        if not trunk:
            return ()
        last = own.head if own.head in trunk else max(trunk, key=lambda b: len(self.ancestors[b]))
        above = self.ancestors[last]
        return (*reversed(above[: above.index(self.root)]), last)

    def _line(self) -> tuple[int, ...]:
        """Return the bodies of the trunk that can turn: where legs stand that nobody poses, it stands with them."""
        way = self._way()
        for i in range(len(way) - 1, -1, -1):
            if any(self._stands_on(limb.bones, way[i]) for limb in self.character.legs):
                way = way[i + 1 :]
                break
        if len(way) < 3:
            return way
        # A bone that leads back (rigs have them to hang things on) only carries the next one.
        ahead = self.rest[way[-1]] - self.rest[way[0]]
        return tuple(b for b, after in pairwise(way) if (self.rest[after] - self.rest[b]) @ ahead > 0.0) + way[-1:]

    def _is_carried(self, body: int) -> bool:
        return self.root in self.ancestors[body]

    def _stands_on(self, bones: Sequence[int], body: int) -> bool:
        """Return whether a leg hangs on a body that does not follow it."""
        carrier = next((a for a in self.ancestors[bones[0]] if a in self._trunk), NONE)
        return carrier == body and not (self.settings.bends_spine and any(bone in self.posed for bone in bones))

    @cached_property
    def _trunk(self) -> set[int]:
        return {self.root, *self._way()}

    def plan(self, outward: Iterable[int]) -> Plan:
        """Return the plan."""
        taken = self._branch()
        for goal, body in self.places:
            if not self.settings.bends_spine and (chain := self._as_limb(body, taken)):
                self.limbs.append(Limb(goal, body, chain))
                taken.update(chain)
                continue
            if body in self.line and self.settings.bends_spine:
                self.tips.append((goal, body, body))
                continue
            joints = self._joints(body, taken)
            if joints and not self._is_delegated(body, joints):
                stem = tuple(j for shared, bodies in self.stems if body in bodies for j in shared)
                self.limbs.append(Limb(goal, body, joints, stem))
                taken.update(joints)
                continue
            carrier = next((a for a in self.ancestors[body] if a in self.line), None)
            if (
                not self.settings.bends_spine
                or carrier is None
                or self._on_limb(body)
                or any(own == carrier for _, _, own in self.tips)
            ):
                self.unreachable.append(body)
                continue
            self.tips.append((goal, body, carrier))
            if body in self.turned:
                self.turned.setdefault(carrier, self.turned[body])
        trunk = self._trunk_plan()
        joints_ = {j for limb in self.limbs for j in limb.path} | set(trunk.joints if trunk else ())
        level = {limb.body: limb.goal for limb in self.limbs if self._is_foot(limb.body)}
        waves = tuple(self._waves())
        pulled = _pulled(trunk, waves)
        driven = {self.root, *self.turned, *level, *joints_, *(limb.body for limb in self.limbs), *pulled}
        loose = _loose(self.character)
        moving = driven | set(self.character.skeleton.tree.roots) | loose
        order = tuple(outward)
        leaders = np.empty(len(self.rest), dtype=np.intp)
        for body in order:
            leaders[body] = body if body in moving else leaders[self.character.skeleton.parents[body]]
        leading = tuple(b for b in order if b in moving)
        return Plan(
            self.character.skeleton.parents,
            self.rest,
            self.root,
            trunk,
            waves,
            self.turned,
            level,
            leaders,
            leading,
            tuple(b for b in order if b in driven or b in loose),
            tuple(self.unreachable),
            self.settings,
            self._nudge(),
            None if self.limits is None else Limited.of(self.limits, self._axes, leading),
            pulled,
            tuple(dict.fromkeys(self.stiff)),
        )

    def _branch(self) -> set[int]:
        """Find what goals share of limbs that branch, and return these joints; each goal keeps joints of its own."""
        taken: set[int] = set()
        groups = [{body: path for _, body in self.places if (path := self._shareable(body))}]
        while groups:
            by_first: dict[int, dict[int, tuple[int, ...]]] = {}
            for body, path in groups.pop(0).items():
                by_first.setdefault(path[0], {})[body] = path
            for own in by_first.values():
                least = min(len(path) for path in own.values()) - 1
                shared = tuple(row[0] for row in zip(*own.values(), strict=False) if len(set(row)) == 1)[:least]
                if len(own) > 1 and shared:
                    self.stems.append((self._hinged(shared), tuple(own)))
                    taken.update(shared)
                    groups.append({body: path[len(shared) :] for body, path in own.items()})
        return taken

    def _shareable(self, body: int) -> tuple[int, ...]:
        """Return the bodies between the trunk, or the next body with a goal, and a body at the end of a limb."""
        above, own = self.ancestors[body], self.character
        if body in self.line or not self._on_limb(body):
            return ()
        stops = {a for other in above if other in self.posed for a in self.ancestors[other]}
        stops |= self._trunk | {*self.ancestors[self.root], *own.spine, *own.neck, own.head}
        return tuple(reversed(list(takewhile(lambda bone: bone not in stops, above))))

    @cached_property
    def _axes(self) -> Array:
        """Rest axes of all bodies in the character frame, mirrored if the armature is, shape (body, 3, 3)."""
        rest = quat.to_matrix(self.character.skeleton.rest_rotations)
        return self.character.local_to_character.rotation @ rest

    def _joints(self, body: int, taken: set[int]) -> tuple[int, ...]:
        """Return the joints of the limb that brings a body to a place, from the trunk outward."""
        # What carries the root carries the whole body: feet that hang on it (IK bones) have no limb that could reach.
        stops = taken | self._trunk | {*self.ancestors[self.root]}
        out: list[int] = []
        for bone in self.ancestors[body]:
            if bone in stops:
                break
            out.append(bone)
        return self._hinged(tuple(reversed(out)))

    def _hinged(self, path: tuple[int, ...]) -> tuple[int, ...]:
        """Return the joints of a limb that bend: not girdles, and of humanoid limbs not what only twists."""
        for upper, lower, end in self._humanoid_limbs:
            if upper in path and lower in path:
                there = path.index(end) if end in path else len(path)
                return (upper, lower, *path[there:])
        shoulders = {self.character.bone("leftShoulder"), self.character.bone("rightShoulder")}
        return path[1:] if len(path) > 2 and path[0] in shoulders else path

    @cached_property
    def _humanoid_limbs(self) -> list[tuple[int, ...]]:
        """Upper and lower bone and end of the arms and legs of a humanoid; between these are bones that twist."""
        if not self.character.humanoid:
            return []
        parts = (("UpperArm", "LowerArm", "Hand"), ("UpperLeg", "LowerLeg", "Foot"))
        found = [[self.character.bone(side + part) for part in row] for side in ("left", "right") for row in parts]
        return [tuple(bone for bone in row if bone is not None) for row in found if None not in row]

    def _as_limb(self, body: int, taken: set[int]) -> tuple[int, ...]:
        """Return the joints of the trunk that bring a body of it, or a mouth, to a place as those of a limb do."""
        if self._on_limb(body) or not (body in self.line or any(a in self.line for a in self.ancestors[body])):
            return ()
        # What has a turn of its own keeps it: the rest of the trunk has to do.
        stops = {*taken, *self.posed, *self.turned, *(self._trunk - {*self.line})}
        joints: list[int] = []
        for bone in self.ancestors[body]:
            if bone in stops:
                break
            joints.append(bone)
        return tuple(reversed(joints))

    def _is_delegated(self, body: int, joints: tuple[int, ...]) -> bool:
        """Return whether a body of the spine, such as a mouth, gives its goal to what carries it (§4.3.1)."""
        return not self._on_limb(body) and any(a in self.line for a in self.ancestors[joints[0]][:1])

    def _on_limb(self, body: int) -> bool:
        return any(bone in self._outer for bone in (body, *self.ancestors[body]))

    @cached_property
    def _outer(self) -> set[int]:
        """Bodies of limbs and tails."""
        own = self.character
        return {b for part in (*own.tails, *((*limb.bones, *limb.digits) for limb in own.limbs)) for b in part}

    def _is_foot(self, body: int) -> bool:
        return Capability.FOOT in self.character.capabilities.get(self.character.skeleton.names[body], ())

    def _trunk_plan(self) -> Trunk | None:
        line, rest = self.line, self.rest
        if not line or not self.settings.bends_spine:
            return None
        where = {body: i for i, body in enumerate(line)}
        pulled = [(limb, where[carrier]) for limb in self.limbs if (carrier := self._carrier(limb)) in where]
        tip = [body for _, body, own in self.tips if own == line[-1] and own != body and body not in self.turned]
        beyond = tip or [limb.path[0] for limb, joint in pulled if joint == len(line) - 1]
        points = [rest[body] for body in line]
        if beyond:
            points.append(np.mean(rest[beyond], axis=0))
        pins = [Pin(self._point(own, body, tip, where), goal, body, own) for goal, body, own in self.tips]
        spots = [self._nearest(rest[limb.path[0]], joint, points) for limb, joint in pulled]
        nodes = (0, *sorted({n for n in (*spots, *(pin.node for pin in pins)) if n > 0}))
        if len(nodes) < 2:
            return None
        points = points[: nodes[-1] + 1]
        place = {point: i for i, point in enumerate(nodes)}
        pulls = [
            Pull(
                place[spot],
                joint,
                rest[limb.path[0]] - rest[line[joint]],
                float(np.linalg.norm(rest[limb.body] - rest[limb.path[0]])),
                *self._lengths(limb.path, limb.body),
                self._is_foot(limb.body),
                self._settings_of(limb.body),
            )
            for (limb, joint), spot in zip(pulled, spots, strict=True)
            if spot > 0 and joint < len(points) - 1
        ]
        return Trunk(
            Spine(np.array(points), nodes, tuple(pulls), self.settings, self._free(nodes)),
            line[: len(points) - 1],
            tuple(
                replace(pin, node=place[pin.node], offset=rest[pin.owner] - points[pin.node])
                for pin in pins
                if pin.node > 0
            ),
            tuple(
                limb.goal
                for (limb, joint), spot in zip(pulled, spots, strict=True)
                if spot > 0 and joint < len(points) - 1
            ),
            line[nodes[-1]] if nodes[-1] < len(line) else NONE,
        )

    def _free(self, nodes: Sequence[int]) -> Flags | None:
        """Return which bones of the line may stretch, shape (joint,), None when none may.

        What hangs on the last body of the line is not moved off it, so that this one keeps its length.
        """
        if not self.settings.allows_stretch:
            return None
        free = np.zeros(nodes[-1], dtype=np.bool_)
        for first, last in pairwise(nodes):
            ends = self.line[first + 1 : last + 1]
            stiff = [body for body in ends if body in self.fixed]
            self.stiff += stiff
            free[first : first + len(ends)] = not stiff
        return free

    def _point(self, own: int, body: int, tip: Sequence[int], where: Mapping[int, int]) -> int:
        """Return the point of the line that is brought to a goal: a tip, or the joint of the body that has the goal."""
        return len(self.line) if body in tip else where[own]

    def _nearest(self, start: Array, joint: int, points: Sequence[Array]) -> int:
        """Return the point that a limb pulls: the nearer end of the bone that carries it."""
        ends = [p for p in (joint, joint + 1) if 0 < p < len(points)]
        return min(ends, key=lambda p: float(np.linalg.norm(points[p] - start)), default=0)

    def _carrier(self, limb: Limb) -> int:
        """Return the body that carries a limb, NONE when none does: of the trunk, one that can turn or the root."""
        above = iter(self.ancestors[limb.path[0]])
        first = next((a for a in above if a in self._trunk or a in self._joints_of_limbs), NONE)
        if first not in self._trunk or first in self.turned:
            return first
        # A bone of no length, as rigs have them between neck and shoulders, goes with the one before it.
        return next((a for a in (first, *above) if a in self.line or a == self.root), first)

    @cached_property
    def _joints_of_limbs(self) -> set[int]:
        return {j for limb in self.limbs for j in limb.path} | {limb.body for limb in self.limbs}

    def _lengths(self, joints: Sequence[int], body: int) -> tuple[float, float]:
        """Return the length of a limb when it is stretched, and when it is folded up [m]."""
        bones = np.linalg.norm(np.diff(self.rest[[*joints, body]], axis=0), axis=-1)
        full = float(bones.sum())
        return full, max(2.0 * float(bones.max()) - full, 0.0)

    def _waves(self) -> Iterable[Wave]:
        """Yield the limbs in the order in which they are solved: those that hang on others after these."""
        limbs, stems = list(self.limbs), list(self.stems)
        while limbs or stems:
            blocked = {b for limb in limbs for b in (*limb.joints, limb.body)} | {b for own, _ in stems for b in own}
            ready = [limb for limb in limbs if not any(a in blocked for a in self.ancestors[limb.joints[0]])]
            if ready:
                chains = Limbs.of(
                    [self.rest[[*limb.joints, limb.body]] for limb in ready],
                    [self._hint(limb.body) for limb in ready],
                    [self._settings_of(limb.body) for limb in ready],
                    [self._side(limb.body) for limb in ready],
                )
                wave = self._wave(ready, chains, [limb.goal for limb in ready])
                yield replace(wave, obstacles=self._obstacles(ready, chains, blocked))
            free = [stem for stem in stems if not any(a in blocked for a in self.ancestors[stem[0][0]])]
            yield from (self._stem(*stem) for stem in free)
            limbs = [limb for limb in limbs if limb not in ready]
            stems = [stem for stem in stems if stem not in free]

    def _stem(self, joints: tuple[int, ...], bodies: Sequence[int]) -> Wave:
        """Return what some goals share of a limb."""
        paths = {limb.body: limb.path for limb in self.limbs}
        beyond = [paths[body][paths[body].index(joints[-1]) + 1 :] for body in bodies]
        points, tips = self.rest[list(joints)], self.rest[list(bodies)]
        # What has a goal of its own, such as a hand, has its settings for the limb that leads to it.
        own = self.settings if joints[-1] in self.posed else self._settings_of(joints[-1])
        line, side = np.vstack([points, tips.mean(axis=0)]), self._side(joints[-1])
        chain = Limbs.of([line], [self._hint(bodies[0])], [own], [side])
        lengths = [self._lengths(own, body) for own, body in zip(beyond, bodies, strict=True)]
        slow_down = [self._settings_of(body).slow_down for body in bodies]
        stem = Stem.of(points, self.rest[[own[0] for own in beyond]], tips, lengths, slow_down, chain)
        goals = [goal for body in bodies for goal, own in self.places if own == body]
        return self._wave([Limb(goals[0], beyond[0][0], joints)], chain, goals, stem)

    def _wave(self, limbs: Sequence[Limb], chains: Limbs, goals: Sequence[int], stem: Stem | None = None) -> Wave:
        limited = None
        if self.limits is not None:
            limited = LimitedLimbs.of(self.limits, self._axes, [limb.joints for limb in limbs], chains.segments)
        joints, elastic = [limb.joints for limb in limbs], None
        if self.settings.allows_stretch:
            ends = [limb.body for limb in limbs] if stem is None else []
            self.stiff += [b for i, own in enumerate(joints) for b in (*own[1:], *ends[i : i + 1]) if b in self.fixed]
            elastic = Elastic.of(chains, joints, ends, self.fixed, self.settings)
        return Wave(tuple(limbs), chains, np.array(goals, dtype=np.intp), stem, limited, elastic=elastic)

    def _obstacles(self, limbs: Sequence[Limb], chains: Limbs, left: Collection[int]) -> Obstacles | None:
        """Return what limbs keep out of; ``left`` are the bodies of these, and of those that are solved after them."""
        if not self.settings.avoids_collisions:
            return None
        capsules, moved = self._capsules, {*left} - self._trunk
        fixed = [i for i, b in enumerate(capsules.carriers) if moved.isdisjoint((b, *self.ancestors[b]))]
        joints, own = [limb.joints for limb in limbs], {b for limb in self.character.limbs for b in limb.bones}
        radii = [[capsules.radius_of.get(j, 0.0) if j in own else 0.0 for j in line] for line in joints]
        return Obstacles.of(joints, chains.segments, self.rest, capsules.take(fixed), radii, self.settings)

    @cached_property
    def _capsules(self) -> Capsules:
        return Capsules.of(self.character, self.rest, self.settings.radii)

    def _nudge(self) -> Nudge | None:
        """Return the limbs that hang on the root, if they may move it."""
        own = [limb for limb in self.limbs if self._carrier(limb) == self.root]
        if not own or self.settings.nudge <= 0.0:
            return None
        lengths = np.array([self._lengths(limb.path, limb.body) for limb in own])
        starts = self.rest[[limb.path[0] for limb in own]]
        chords = quat.length(self.rest[[limb.body for limb in own]] - starts)
        return Nudge(
            np.array([limb.goal for limb in own], dtype=np.intp),
            starts - self.rest[self.root],
            np.maximum([self._settings_of(limb.body).slow_down for limb in own] * lengths[:, 0], chords),
            lengths[:, 1],
            self.settings.nudge * float(lengths[:, 0].mean()),
        )

    def _settings_of(self, body: int) -> LimbSettings:
        """Return the settings of the limb that ends with a body."""
        return self.settings.of_limb(self.character.skeleton.names[body])

    def _hint(self, body: int) -> Array:
        """Return where the middle of a straight limb moves when it bends."""
        limb = self._limb_of(body)
        return np.array([0.0, 1.0, 0.3]) if limb is None else _HINTS[limb.kind]

    def _side(self, body: int) -> int:
        """Return +1 for what ends a limb on the left, -1 on the right, and 0 in the middle."""
        limb = self._limb_of(body)
        return 0 if limb is None else limb.side

    def _limb_of(self, body: int) -> morphology.Limb | None:
        """Return the limb of the character that a body is part of."""
        return next((limb for limb in self.character.limbs if body in limb.bones or body in limb.digits), None)


_HINTS = {
    LimbKind.LEG: np.array([0.0, -1.0, 0.2]),
    LimbKind.ARM: np.array([0.0, 1.0, -0.3]),
    LimbKind.WING: np.array([0.0, 1.0, 0.3]),
    LimbKind.FIN: np.array([0.0, 1.0, 0.0]),
    LimbKind.TENTACLE: np.array([0.0, 0.0, 1.0]),
}
"""Knees bend forward, elbows back, the rest up."""


def _pulled(trunk: Trunk | None, waves: Iterable[Wave]) -> tuple[int, ...]:
    """Return the bodies whose joints move off where they are held when bones stretch."""
    links = [link.end for wave in waves if wave.elastic is not None for link in wave.elastic.links]
    return tuple(dict.fromkeys((*links, *(trunk.drawn if trunk is not None else ()))))


def _loose(character: Character) -> set[int]:
    """Return the bones that do not take over their parents' rotation, and so must be turned to be carried along."""
    inherits = character.skeleton.inherits
    return set() if inherits is None else {int(bone) for bone in np.flatnonzero(~inherits)}
