"""Random goals for whole characters: what the pose step is measured by (see `pose_measures`).

A set of goals is taken from a pose that forward kinematics makes of random turns of joints, so all goals of a set can
be met together. The pose itself is one of many that meet them: only the goals count.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path

import numpy as np

from morph_retarget.core import quat
from morph_retarget.core.arrays import Array, Indices
from morph_retarget.core.character import girdles
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.character.character import Character
from morph_retarget.core.character.morphology import Capability, Limb, LimbKind
from morph_retarget.core.morph.bodies import Bodies
from morph_retarget.core.solve import detached, posing
from morph_retarget.core.solve.goals import Goals
from morph_retarget.core.solve.posing import Plan
from morph_retarget.core.solve.settings import SolverSettings
from morph_retarget.core.tree import Tree
from tests import truth
from tests.skeletons import skeleton_of
from tools.creatures import CREATURES

HUMAN = 1.75
"""Lengths are judged as if every character were as large [m]."""
STRETCH = 0.97
"""No limb is stretched further than this share of its length: there it slows down toward goals that it cannot reach."""
BEND, BEND_IN_ALL = np.radians(25.0), np.radians(90.0)
"""Most that one joint of a trunk or tail bends, and all of its joints together [rad]."""
FOLD, FOLD_OF_SEVERAL = np.radians(125.0), np.radians(85.0)
"""Most that the one hinge of a limb bends, and each one of several [rad]."""
STRAIGHT = np.radians(3.0)
"""A hinge that bends less than this at rest bends to the side to which limbs of its kind do."""
SWING = {LimbKind.LEG: np.radians(50.0), LimbKind.ARM: np.radians(70.0)}
"""Most that the first joint of a limb turns [rad]."""
WRIST = np.radians(40.0)
"""Most that hands, feet and heads turn by themselves [rad]."""
LEAN, WANDER = np.radians(40.0), 0.15
"""Most that the root turns [rad] and moves along each axis, as a share of the character's size."""

SETTINGS = SolverSettings(bends_spine=True)
"""All that the solver can do for a goal."""

_SIDES = {LimbKind.LEG: np.array([0.0, -1.0, 0.2]), LimbKind.ARM: np.array([0.0, 1.0, -0.3])}
_SIDE = np.array([0.0, 1.0, 0.3])
"""Where the middle of a limb that is straight at rest moves when it bends: knees forward, elbows back."""
_POSED = (Capability.GRASPER, Capability.FOOT, Capability.HEAD)


@dataclass(frozen=True, eq=False)
class Hinged:
    """A limb that brings its end to places: a first joint that turns any way, hinges, and what is held still."""

    limb: Limb
    first: int
    hinges: tuple[int, ...]
    axes: Array
    """Axis about which each hinge bends, at rest, shape (hinge, 3)."""
    angles: Array
    """By how much each bends at rest [rad], shape (hinge,)."""
    most: Array
    """By how much each bends at most [rad], shape (hinge,)."""
    least: float
    """Share of ``most`` at which the limb is stretched by `STRETCH`."""


@dataclass(frozen=True, eq=False)
class Subject:
    """A character and all goals that an action may set for it."""

    character: Character

    @cached_property
    def bodies(self) -> Bodies:
        """Its bodies at rest."""
        return Bodies.of(self.character)

    @cached_property
    def root(self) -> int:
        """The body that carries all others."""
        return (self.bodies.with_capability(Capability.ROOT) or self.bodies.tree.roots)[0]

    @cached_property
    def tree(self) -> Tree:
        """What carries which body in a pose: limbs carry their feet and hands, wherever these hang."""
        return detached.carried(self.character, self.root)

    @cached_property
    def goals(self) -> Indices:
        """Bodies that have goals for their places and rotations: the root first, then hands, feet, head, tails."""
        found = [b for capability in _POSED for b in self.bodies.with_capability(capability)]
        tips = [tail[-1] for tail in self.character.tails]
        return np.array(list(dict.fromkeys([self.root, *found, *tips])), dtype=np.intp)

    @cached_property
    def plan(self) -> Plan:
        """How the pose step meets all of them."""
        return self.plan_for(self.goals)

    def plan_for(self, goals: Sequence[int] | Indices) -> Plan:
        """Return how the pose step meets goals for some bodies."""
        wanted = [(int(body), True, True) for body in goals]
        return posing.prepare(self.character, self.bodies.positions, self.root, wanted, SETTINGS)

    @cached_property
    def scale(self) -> float:
        """The character's greatest extent over that of a human. (Height says nothing about a snake.)"""
        return float((self.bodies.high - self.bodies.low).max()) / HUMAN

    @cached_property
    def of_root(self) -> Indices:
        """The root and all that it carries; other bodies cannot follow it."""
        return np.array([self.root, *self.tree.below(self.root)], dtype=np.intp)

    @cached_property
    def joints(self) -> Indices:
        """Bodies that lead from the root to goals and have none themselves: what the pose step turns as it likes."""
        above = {b for goal in self.goals for b in self.tree.ancestors[goal]}
        carries_root = {self.root, *self.tree.ancestors[self.root]}
        return np.array(sorted(above - carries_root - {int(b) for b in self.goals}), dtype=np.intp)

    @cached_property
    def limbs(self) -> tuple[Hinged, ...]:
        """Limbs that bring a goal's body to its place and whose bones hang on each other."""
        whole = [m for m in self.character.limbs if m.end in self.goals and len(m.bones) > 1]
        parents = self.tree.parents
        return tuple(self._hinged(m) for m in whole if list(parents[list(m.bones[1:])]) == list(m.bones[:-1]))

    def _hinged(self, limb: Limb) -> Hinged:
        shoulders = girdles.find(self.character, self.bodies.positions)
        line = [bone for bone in limb.bones if bone not in shoulders]
        # Whatever else stands between the shoulder girdle and an arm that is known belongs to the girdle.
        arms = {self.character.bone(f"{side}UpperArm") for side in ("left", "right")}
        line = line[next((i for i, bone in enumerate(line) if bone in arms), 0) :]
        mapped = {self.character.bone(f"{s}{j}") for s in ("left", "right") for j in ("LowerArm", "LowerLeg")}
        # Between the joints of a limb that is known there are twist bones, which do not bend.
        hinges = [bone for bone in line[1:-1] if bone in mapped] or line[1:-1]
        rest = self.bodies.positions
        axes, angles = np.zeros((len(hinges), 3)), np.zeros(len(hinges))
        along = quat.unit(rest[line[-1]] - rest[line[0]])
        side = _SIDES.get(limb.kind, _SIDE)
        usual = quat.unit(quat.cross(side - (side @ along) * along, along))
        for i, hinge in enumerate(hinges):
            place = line.index(hinge)
            turn = quat.between(rest[hinge] - rest[line[place - 1]], rest[line[place + 1]] - rest[hinge])
            vector = quat.to_rotation_vector(turn)
            bent = float(np.linalg.norm(vector)) > STRAIGHT
            axes[i], angles[i] = (quat.unit(vector), np.linalg.norm(vector)) if bent else (usual, 0.0)
        most = np.maximum(FOLD if len(hinges) == 1 else FOLD_OF_SEVERAL, angles)
        found = Hinged(limb, line[0], tuple(hinges), axes, angles, most, 0.0)
        if not hinges:
            return found
        shares = np.linspace(0.0, 1.0, 101)
        turns = quat.identity(len(shares), len(rest))
        turns[:, hinges] = quat.from_axis_angle(axes, shares[:, None] * most - angles)
        ends = posed(self, turns, np.zeros((len(shares), 3)))[0][:, line]
        stretched = quat.length(ends[:, -1] - ends[:, 0]) / quat.length(np.diff(rest[line], axis=0)).sum()
        least = float(shares[min(int((stretched > STRETCH).sum()), len(shares) - 1)])
        return Hinged(limb, line[0], tuple(hinges), axes, angles, most, least)


@dataclass(frozen=True, eq=False)
class Sets:
    """Sets of goals, each met by a pose of its character."""

    subject: Subject
    own: Array
    """Turn of each body against its parent, from rest, character frame at rest, shape (set, body, 4)."""
    shift: Array
    """Of the root [m], shape (set, 3)."""

    def __len__(self) -> int:
        return len(self.own)

    @cached_property
    def pose(self) -> tuple[Array, Array]:
        """Places [m] and turns from rest of all bodies in a pose that meets the goals, (set, body, 3 and 4)."""
        return posed(self.subject, self.own, self.shift)

    @cached_property
    def goals(self) -> Goals:
        """Places and turns of all bodies that have goals."""
        places, turns = self.pose
        return goals_of(self.subject.goals, places[:, self.subject.goals], turns[:, self.subject.goals])

    def first(self, count: int) -> "Sets":
        """Return the first few of the sets."""
        return Sets(self.subject, self.own[:count], self.shift[:count])

    def toward(self, start: int, end: int, steps: int) -> "Sets":
        """Return the way from one set to another over turns of joints: goals can be met all along."""
        return self.ways([start], [end], steps)

    def ways(self, starts: Sequence[int], ends: Sequence[int], steps: int) -> "Sets":
        """Return such ways one after the other, as one batch; see `toward`."""
        share = np.linspace(0.0, 1.0, steps + 1)[:, None]
        own = quat.slerp(self.own[starts][:, None], self.own[ends][:, None], share)
        shift = self.shift[starts][:, None] + share * (self.shift[ends] - self.shift[starts])[:, None]
        return Sets(self.subject, own.reshape(-1, *own.shape[2:]), shift.reshape(-1, 3))

    def straight(self, start: int, end: int, steps: int) -> Goals:
        """Return the straight way of all goals from one set to another: not all of it can be met."""
        share, goals = np.linspace(0.0, 1.0, steps + 1)[:, None], self.goals
        places = goals.positions[[start]] + share[..., None] * (goals.positions[end] - goals.positions[start])
        return goals_of(goals.bodies, places, quat.slerp(goals.turns[[start]], goals.turns[[end]], share))


def goals_of(bodies: Indices, positions: Array, turns: Array) -> Goals:
    """Return goals that count in full."""
    ones = np.ones(positions.shape[:2])
    return Goals(bodies, positions, turns, ones, ones)


def rows(goals: Goals, chosen: Indices | slice) -> Goals:
    """Return some frames of goals."""
    return Goals(
        goals.bodies,
        goals.positions[chosen],
        goals.turns[chosen],
        goals.position_influence[chosen],
        goals.rotation_influence[chosen],
    )


def posed(subject: Subject, own: Array, shift: Array) -> tuple[Array, Array]:
    """Return places and turns of all bodies, by forward kinematics, shapes (set, body, 3) and (set, body, 4)."""
    bodies = subject.bodies
    turns = own.copy()
    for level in subject.tree.levels[1:]:
        turns[:, level] = quat.multiply(turns[:, subject.tree.parents[level]], own[:, level])
    moved = bodies.positions[subject.root] + shift
    return placed(subject, turns, moved), turns


def placed(subject: Subject, turns: Array, root: Array, moved: Array | None = None) -> Array:
    """Return the places to which turned bodies lead, shape (set, body, 3).

    Args:
        subject: The character.
        turns: Of all bodies, shape (set, body, 4).
        root: Where the root is [m], shape (set, 3).
        moved: How far joints are moved off what carries them, in the frame of that [m], shape (set, body, 3).
    """
    bodies = subject.bodies
    places = np.broadcast_to(bodies.positions, (len(turns), len(bodies), 3)).copy()
    for level in subject.tree.levels:
        parents = subject.tree.parents[level]
        if parents[0] >= 0:
            step = bodies.positions[level] - bodies.positions[parents]
            if moved is not None:
                step = step + moved[:, level]
            places[:, level] = places[:, parents] + quat.rotate(turns[:, parents], step)
        if subject.root in level:
            places[:, subject.root] = root
    return places


# --- sets ---


def random_sets(subject: Subject, rng: np.random.Generator, count: int) -> Sets:
    """Return goals that a body could meet: bent trunks and tails, limbs from nearly straight to folded."""
    character, bodies = subject.character, subject.bodies
    own = quat.identity(count, len(bodies))
    trunk = [*character.spine, *character.neck, *([] if character.head is None else [character.head])]
    carried = set(subject.of_root.tolist()) - {subject.root}
    for line in (trunk, *character.tails):
        free = list(dict.fromkeys(b for b in line if b in carried))
        own[:, free] = _bends(rng, count, len(free))
    for hinged in subject.limbs:
        own[:, hinged.first] = _any_way(rng, count, SWING.get(hinged.limb.kind, BEND))
        share = rng.uniform(hinged.least, 1.0, (count, len(hinged.hinges)))
        own[:, hinged.hinges] = quat.from_axis_angle(hinged.axes, share * hinged.most - hinged.angles)
        own[:, hinged.limb.end] = _any_way(rng, count, WRIST)
    own[:, subject.root] = _any_way(rng, count, LEAN)
    reach = WANDER * HUMAN * subject.scale
    return Sets(subject, own, rng.uniform(-reach, reach, (count, 3)))


def _bends(rng: np.random.Generator, count: int, joints: int) -> Array:
    """Return turns of joints in line that for the most part bend the same way, shape (count, joint, 4)."""
    common = quat.unit(rng.normal(size=(count, 1, 3))) * rng.uniform(0.0, 1.0, (count, 1, 1))
    vectors = common + 0.5 * rng.normal(size=(count, joints, 3))
    sizes = quat.length(vectors)
    angles = np.minimum(sizes, 1.0) * BEND
    angles *= np.minimum(BEND_IN_ALL / np.maximum(angles.sum(axis=1, keepdims=True), 1e-9), 1.0)
    return quat.from_rotation_vector(quat.unit(vectors) * angles[..., None])


def _any_way(rng: np.random.Generator, count: int, most: float) -> Array:
    """Return turns by up to an angle [rad] about any axis, shape (count, 4)."""
    return quat.from_axis_angle(quat.unit(rng.normal(size=(count, 3))), rng.uniform(0.0, most, count))


def at_rest(subject: Subject, count: int = 1) -> Goals:
    """Return goals that want all bodies where they are at rest."""
    places = np.broadcast_to(subject.bodies.positions[subject.goals], (count, len(subject.goals), 3)).copy()
    return goals_of(subject.goals, places, quat.identity(*places.shape[:2]))


def beyond(sets: Sets, factor: float) -> Goals:
    """Return the goals of sets carried away from the root, ``factor`` times as far; the root's stay."""
    goals = sets.goals
    root = goals.positions[:, :1]
    return goals_of(goals.bodies, root + factor * (goals.positions - root), goals.turns)


def at_infinity(subject: Subject, rng: np.random.Generator, count: int, away: float = 1e6) -> Goals:
    """Return goals ``away`` [m] in any direction, the root's among them in every second set."""
    goals = at_rest(subject, count)
    far = away * quat.unit(rng.normal(size=goals.positions.shape))
    far[::2, 0] = 0.0
    return goals_of(goals.bodies, goals.positions + far, goals.turns)


def coincident(sets: Sets) -> Goals:
    """Return the goals of sets, all but the root's in one place: where the last of them was."""
    goals = sets.goals
    places = np.repeat(goals.positions[:, -1:], len(goals.bodies), axis=1)
    places[:, 0] = goals.positions[:, 0]
    return goals_of(goals.bodies, places, goals.turns)


def at_the_joint(subject: Subject) -> Goals:
    """Return goals at the joints that lead to them: first each at its own joint, then at those above, to the root."""
    ancestors, rest = subject.tree.ancestors, subject.bodies.positions
    depths = max(len(ancestors[goal]) for goal in subject.goals)
    goals = at_rest(subject, depths + 1)
    for i, goal in enumerate(subject.goals):
        if goal != subject.root:
            line = [int(goal), *ancestors[goal]]
            line = line[: line.index(subject.root) + 1] if subject.root in line else line
            goals.positions[:, i] = rest[[line[min(depth, len(line) - 1)] for depth in range(depths + 1)]]
    return goals


# --- characters ---


@cache
def creatures() -> Mapping[str, Character]:
    """Return the sample characters, with axes that mean nothing."""
    return {name: analyze(skeleton_of(make(), np.random.default_rng(7))) for name, make in CREATURES.items()}


def real(data: Path, names: Sequence[str]) -> Mapping[str, Character]:
    """Return some of the real rigs."""
    return {str(t["id"]): _real(data, i) for i, t in enumerate(_tables(data)) if t["id"] in names}


@cache
def _tables(data: Path) -> tuple[truth.Table, ...]:
    return tuple(truth.tables(data))


@cache
def _real(data: Path, place: int) -> Character:
    return truth.find(truth.rig(data, _tables(data)[place]))


def hard(subject: Subject, count: int) -> dict[str, Goals]:
    """Return goals that nobody can meet, or only in strange poses; ``count`` sets of most kinds."""
    sets, rng = random_sets(subject, np.random.default_rng(2), count), np.random.default_rng(3)
    return {
        "just out of reach": beyond(sets, 1.1),
        "out of reach": beyond(sets, 3.0),
        "close to the root": beyond(sets, 0.1),
        "at the root": beyond(sets, 0.0),
        "at infinity": at_infinity(subject, rng, 20),
        "in one place": coincident(sets),
        "at the joints": at_the_joint(subject),
    }
