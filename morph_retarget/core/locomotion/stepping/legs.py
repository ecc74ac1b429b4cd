"""What a character walks on: its legs, their feet on the ground, and the groups in which they go.

A leg is a path of limb bones from the trunk to a foot; legs that branch share their upper bones (Hecker 2008 §4.2,
"Leg Groups"). All places are those at rest in the character frame [m]: +X left, -Y forward, +Z up, ground at z = 0.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np

from ... import quat
from ...arrays import Array
from ...character.character import Character
from ...character.morphology import Limb

FORWARD: Array = np.array([0.0, -1.0, 0.0])
LEVEL: Array = np.array([1.0, 1.0, 0.0])
"""Takes a point down to the ground."""
NONE = -1
"""No bone."""
GIRDLE_LENGTH, GIRDLE_DROP = 0.35, 0.5
"""A first bone that is shorter than this share of its leg, and goes down by less than this share of its own length,
lies in the trunk: a pelvis or a coxa; the leg swings about where it ends."""
TOO_HIGH = 0.25
"""A foot whose joint is higher than this share of the hip's height stands on what hangs on it, as a spider's does."""
LOW = 0.1
"""What is no higher than this share of the leg's length lies on the ground."""
OFF_GROUND = 0.12
"""A foot that ends further than this share of the leg's length from z = 0 rests on no ground, but where it ends."""
HEEL = 0.4
"""A heel lies as far behind the ankle as this share of the way from there to the ball."""
BALL = 0.17
"""How far before the ankle a human foot rolls off where no bone says it [leg lengths]."""
SAME_END = 0.2
"""Toes that end this near to the foremost, as a share of the sole, are an end of the sole together."""
SHORTEST_END, LONGEST_END = 0.02, 0.4
"""A last bone's end is believed between these lengths [leg lengths]: importers guess it."""
ALIKE = 1.5
"""Legs up to so many times as high as the next lower ones go in one group with them."""
LEAST_HEIGHT = 0.5
"""Legs that sprawl step as if their hips stood at least this high [leg lengths]."""
SIMPLE = 3
"""Greatest denominator of the ratio of two groups."""


@dataclass(frozen=True, eq=False)
class Leg:
    """One leg at rest."""

    path: tuple[int, ...]
    """Bones from the one that swings about the hip to the foot; bones of the trunk's own (girdles) are left out."""
    foot: int
    """The bone that is placed on the ground."""
    ball: int
    """The bone of the toes, that bends about the ball of the foot; `NONE` where nothing does."""
    hip: Array
    """Joint of the first bone, shape (3,)."""
    home: Array
    """Joint of the foot, shape (3,)."""
    heel: Array
    """From the foot's joint to the rearmost point of the sole, shape (3,)."""
    tip: Array
    """From the foot's joint to the point of the sole over which it rolls off, shape (3,); the heel for feet that stand
    on a point."""
    length: float
    """Of the stretched leg from hip to foot joint [m]."""
    side: int
    """+1 left, -1 right, 0 in the middle."""
    row: int
    """Counted from the front, 0 first."""
    carrier: int
    """The bone of the trunk that carries the leg, `NONE` for a leg that hangs on nothing."""
    loose: bool
    """Whether a bone of the path does not hang on the one before it, as in rigs whose inverse kinematics was baked: the
    leg's own turns do not move the foot."""
    turn: float = 0.0
    """Of the foot about the vertical, from how it rests to how it stands to walk [rad]; see `posture`."""

    @property
    def sole(self) -> float:
        """Height of the ground under the foot."""
        return float(self.home[2] + self.tip[2])

    @property
    def height(self) -> float:
        """Of the hip over the ground under the foot [m]."""
        return float(self.hip[2]) - self.sole


@dataclass(frozen=True, eq=False)
class LegGroup:
    """Legs of about the same length, as far as it counts for strides; they go in one pattern."""

    legs: tuple[int, ...]
    """Their places among all legs: rear row first, in a row from left to right."""
    length: float
    """Mean of the legs [m]."""
    height: float
    """Mean height of the hips over the ground [m], of each leg at least `LEAST_HEIGHT` of its length; speeds and
    strides are measured by it (Alexander & Jayes 1983)."""
    ratio: Fraction
    """Frequency of its cycle relative to the first group's, whose hips are highest."""


@dataclass(frozen=True, eq=False)
class Legs:
    """All legs of a character."""

    legs: tuple[Leg, ...]
    """Front row first, in a row from left to right."""
    groups: tuple[LegGroup, ...]
    """The highest legs first; every leg is in one of them."""

    def sides(self, group: LegGroup) -> tuple[int, ...]:
        """Return the side of each foot of a group, in its order, as `patterns.pattern` asks for it."""
        return tuple(self.legs[leg].side for leg in group.legs)


def find(character: Character) -> Legs:
    """Return the legs of a character and their groups; none of both for one without feet."""
    rig = _Rig(character)
    legs = tuple(_leg(rig, limb) for limb in character.legs)
    return Legs(legs, grouped(legs))


# --- legs ---


@dataclass(frozen=True, eq=False)
class _Rig:
    """A character as legs are read from it."""

    character: Character

    @cached_property
    def heads(self) -> Array:
        """Of all bones, shape (bone, 3)."""
        return self.character.local_to_character.points(self.character.skeleton.rest_positions)

    @cached_property
    def tails(self) -> Array:
        """Of all bones, shape (bone, 3)."""
        return self.character.local_to_character.points(self.character.skeleton.rest_tails)

    @cached_property
    def trunk(self) -> frozenset[int]:
        """Bones of the middle, and those that carry them."""
        own, ancestors = self.character, self.character.skeleton.tree.ancestors
        middle = (*own.spine, *own.neck, *(() if own.head is None else (own.head,)))
        return frozenset(b for bone in middle for b in (bone, *ancestors[bone]))

    @cached_property
    def toes(self) -> frozenset[int]:
        """Bones that are known as toes."""
        return self._known("Toes")

    @cached_property
    def thighs(self) -> frozenset[int]:
        """Bones that are known as thighs."""
        return self._known("UpperLeg")

    def _known(self, joint: str) -> frozenset[int]:
        found = (self.character.bone(side + joint) for side in ("left", "right"))
        return frozenset(bone for bone in found if bone is not None)

    def length(self, path: Sequence[int]) -> float:
        """Return the length of the way over the joints of some bones [m]."""
        return float(quat.length(np.diff(self.heads[list(path)], axis=0)).sum())


def _leg(rig: _Rig, limb: Limb) -> Leg:
    line, carrier = _line(rig, limb)
    path = _without_girdle(rig, line)
    foot = path[-1]
    length = max(rig.length(path), 1e-9 * rig.character.frame.height)
    beyond = [bone for bone in rig.character.skeleton.tree.below(foot) if bone in limb.digits]
    ball = next((bone for bone in beyond if bone in rig.toes), NONE)
    if rig.character.humanoid:
        heel, tip = _plantigrade(rig, foot, ball, beyond, length)
    else:
        ball, (heel, tip) = NONE, _digitigrade(rig, foot, beyond, length)
    hip, home = rig.heads[path[0]], rig.heads[foot]
    parents = rig.character.skeleton.parents[list(path[1:])]
    loose = parents.tolist() != list(path[:-1])
    return Leg(path, foot, ball, hip, home, heel, tip, length, limb.side, limb.row, carrier, loose)


def _line(rig: _Rig, limb: Limb) -> tuple[tuple[int, ...], int]:
    """Return the bones from below the trunk to the one that stands on the ground, and what carries them."""
    tree, above = rig.character.skeleton.tree, list[int]()
    for bone in tree.ancestors[limb.bones[0]]:
        if bone in rig.trunk:
            carrier = bone
            break
        above.append(bone)
    else:
        # Nothing of the trunk carries it: bones above it are the rig's own controls.
        above, carrier = [], NONE
    line = (*reversed(above), *limb.bones)
    while not rig.character.humanoid and rig.heads[line[-1], 2] > TOO_HIGH * rig.heads[line[0], 2]:
        below = [b for b in tree.children[line[-1]] if b in limb.digits and rig.heads[b, 2] < rig.heads[line[-1], 2]]
        if not below:
            break
        line = (*line, min(below, key=lambda b: float(rig.heads[b, 2])))
    return line, carrier


def _without_girdle(rig: _Rig, line: tuple[int, ...]) -> tuple[int, ...]:
    """Return a leg from its thigh on, as far as three bones are left."""
    thigh = next((i for i, bone in enumerate(line) if bone in rig.thighs), None)
    if thigh is not None:
        return line[thigh:]
    while len(line) > 3:
        step = rig.heads[line[1]] - rig.heads[line[0]]
        own = float(np.linalg.norm(step))
        if own > GIRDLE_LENGTH * rig.length(line) or abs(step[2]) > GIRDLE_DROP * own:
            break
        line = line[1:]
    return line


# --- soles ---


def _plantigrade(rig: _Rig, foot: int, ball: int, beyond: Sequence[int], size: float) -> tuple[Array, Array]:
    """Return heel and tip, from the foot's joint, of a foot that rolls from its heel over its ball.

    Args:
        rig: The character.
        foot: Its foot.
        ball: The bone of its toes.
        beyond: All bones beyond the foot.
        size: Length of the leg [m].
    """
    points = _points(rig, foot, beyond, size)
    if ball != NONE:
        ahead = (rig.heads[ball] - rig.heads[foot]) * LEVEL
    else:
        farthest = points[int(np.argmin(points[:, 1]))] * LEVEL
        long_enough = -farthest[1] > 0.5 * BALL * size
        ahead = BALL * size * (quat.unit(farthest) if long_enough else FORWARD)
    ground = _ground(rig, foot, points, size)
    return -HEEL * ahead + ground, ahead + ground


def _digitigrade(rig: _Rig, foot: int, beyond: Sequence[int], size: float) -> tuple[Array, Array]:
    """Return heel and tip of a foot that stands on what of it is low: a paw, toes, a point."""
    points = _points(rig, foot, beyond, size)
    ground = _ground(rig, foot, points, size)
    low = points[points[:, 2] - ground[2] < LOW * size]
    if not len(low):
        low = points[[int(np.argmin(points[:, 2]))]]
    aside, ahead, _ = np.abs(low.mean(axis=0))
    if aside >= ahead:  # it points to the side, as those of insects do, or nowhere: it stands on its end
        end = low[int(np.argmax(quat.length(low)))]
        return end * LEVEL + ground, end * LEVEL + ground
    near = SAME_END * np.ptp(low[:, 1])
    rear, front = (low[np.abs(low[:, 1] - y) <= near].mean(axis=0) for y in (low[:, 1].max(), low[:, 1].min()))
    return rear * LEVEL + ground, front * LEVEL + ground


def _points(rig: _Rig, foot: int, beyond: Sequence[int], size: float) -> Array:
    """Return the joints of a foot, and its end if nothing hangs on it, from the foot's joint, shape (point, 3)."""
    points = [rig.heads[foot], *rig.heads[list(beyond)]]
    step = rig.tails[foot] - rig.heads[foot]
    reach = float(np.linalg.norm(step))
    stands = rig.heads[foot, 2] < SHORTEST_END * size  # on its joint, and so not on its end
    if not beyond and not stands and SHORTEST_END * size < reach < LONGEST_END * size and step[2] < 0.3 * reach:
        points.append(rig.tails[foot])
    return np.array(points) - rig.heads[foot]


def _ground(rig: _Rig, foot: int, points: Array, size: float) -> Array:
    """Return the way from the foot's joint down to the ground: z = 0 unless the foot is known to end elsewhere."""
    down = -float(rig.heads[foot, 2])
    lowest = float(points[:, 2].min())
    ends_elsewhere = len(points) > 1 and abs(lowest - down) > OFF_GROUND * size
    return np.array([0.0, 0.0, lowest if ends_elsewhere else down])


# --- groups ---


def grouped(legs: Sequence[Leg]) -> tuple[LegGroup, ...]:
    """Return rows of legs, gathered by their heights; the legs of a row are never parted."""

    def height_of(rows: Sequence[int]) -> float:
        return float(np.mean([max(m.height, LEAST_HEIGHT * m.length) for m in legs if m.row in rows]))

    gathered: list[list[int]] = []
    for row in sorted({leg.row for leg in legs}, key=lambda row: -height_of([row])):
        if gathered and height_of(gathered[-1][-1:]) < ALIKE * height_of([row]):
            gathered[-1].append(row)
        else:
            gathered.append([row])
    highest = height_of(gathered[0]) if gathered else 0.0
    out: list[LegGroup] = []
    for rows in gathered:
        own = [i for i, leg in enumerate(legs) if leg.row in rows]
        order = tuple(sorted(own, key=lambda i: (-legs[i].row, -legs[i].side)))
        length, height = float(np.mean([legs[i].length for i in own])), height_of(rows)
        out.append(LegGroup(order, length, height, harmonized(highest / height)))
    return tuple(out)


def harmonized(ratio: float) -> Fraction:
    """Return the small rational number that is next to a ratio of at least 1 (Hecker 2008 §4.2, "harmonized")."""
    return Fraction(ratio).limit_denominator(SIMPLE if ratio < SIMPLE else 1)
