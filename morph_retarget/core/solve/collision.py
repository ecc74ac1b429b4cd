"""The collision phase: limbs swivel out of the trunk, the head and each other, as far as that can help.

A limb of two joints or more may turn as a whole about the line from where it starts to where it ends: bones keep their
lengths and the end its place. So there is one unknown for each limb. What is known is what the limb phase has found for
the very frame, so a pose depends on the goals of its frame alone. It has to follow them without jumps, too, where to
choose the best of several angles would be to jump from one to another. So a limb looks around first, at a fan of
angles, and sets out from their mean, in which each counts the more the better it is. From there it goes a fixed number
of steps down a penalty that is smooth in the pose.

The penalty is that of beads on the bones, by how deep each lies in each capsule: how near a whole bone is to a capsule
has a kink where the two are parallel. Steps are those of Gauss and Newton, damped by how much the penalty is bent, so
that a limb in the middle of a trunk, with two ways out, does not rush to either.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .. import quat, rotation
from ..arrays import Array, Flags, Indices
from . import capsules as thickness
from .capsules import Capsules
from .constraints import TINY, smooth_step
from .settings import SolverSettings

BEADS = 4
"""On each bone; one at its end, none where it starts."""
FAN = 4
"""Angles to either side that a limb looks at."""
COST = 2.0
"""Of a swivel, a radian squared, in beads that lie on the axis of a capsule."""
EVEN = 0.3
"""Angles whose costs differ by this share of what can be gained still count one against the other."""
LITTLE = 0.5
"""What can be gained, in beads, while a limb sets out half of the way to what it has found."""
STEPS = 7
HASTE = 0.3
"""Most by which a step leads away from a ridge of the penalty, as a share of how far it is from there."""
EFFORT = 0.3
"""Damping of all steps, so that a limb does not swivel far for next to nothing …"""
STIFFNESS = 2.0
"""… and that by each bead, the more the deeper it lies: some lie there however their limb swivels."""
SOFT = 0.2
"""Depth up to which beads count less, the less the less: limbs that only just touch do not start with a jerk."""
STRIDE = 0.12
"""Most that a limb swivels in a step [rad]."""
SHORT, LONG = 0.02, 0.15
"""A limb whose end comes as near to its start as these shares of its length swivels not at all, and less."""
BLOCK = 1 << 15
"""Beads are compared with capsules in blocks of frames, about so many at a time."""


@dataclass(frozen=True, eq=False)
class Obstacles:
    """What limbs that are solved together keep out of. Bones are counted through all of the limbs."""

    segments: Array
    """From each joint to the next, the last one to the end, at rest [m], shape (limb, joint, 3)."""
    around: Capsules
    """What the limbs do not move."""
    bones: Indices
    """Bone of each pair, shape (pair,); in order."""
    others: Indices
    """Which capsule it keeps out of: one of those around, after which the limbs' own bones are counted."""
    clear: Array
    """How near the bone's beads may come to its axis [m], shape (pair, bead); at least a little."""
    most: float
    """Largest swivel [rad]."""

    @classmethod
    def of(
        cls,
        joints: Sequence[Sequence[int]],
        segments: Array,
        rest: Array,
        around: Capsules,
        radii: Sequence[Sequence[float]],
        settings: SolverSettings,
    ) -> "Obstacles | None":
        """Return what the limbs of a wave keep out of, None when there is nothing.

        Args:
            joints: Of each limb, from what carries it outward.
            segments: As `Limbs` has them, shape (limb, joint, 3); shorter limbs start with joints of no length.
            rest: Rest positions of all bodies [m], character frame, shape (body, 3).
            around: What is not moved by the limbs.
            radii: Of the limbs' bones [m], 0 where there is no capsule.
            settings: Of the solver.
        """
        count, most = segments.shape[:2]
        starts, thick = np.zeros((count, most, 3)), np.zeros((count, most))
        swivels, rooted = np.zeros((2, count, most), dtype=bool)
        for i, (own, own_radii) in enumerate(zip(joints, radii, strict=True)):
            place = slice(most - len(own), None)
            starts[i, place], thick[i, place] = rest[list(own)], own_radii
            swivels[i] = len(own) > 1 and max(own_radii) > 0.0
            rooted[i, place.start] = True
        starts, along, thick = starts.reshape(-1, 3), segments.reshape(-1, 3), thick.ravel()
        points = starts[:, None] + np.linspace(0.0, 1.0, BEADS + 1)[:, None] * along[:, None]
        everything = around.and_(Capsules(np.arange(count * most, dtype=np.intp), starts, starts + along, thick))
        clear = thickness.clearances(points, thick, rooted.ravel(), everything, settings.margin)[..., 1:]
        clear[~swivels.ravel()] = 0.0
        limb = np.repeat(np.arange(count, dtype=np.intp), most)
        clear[:, len(around.bodies) :][limb[:, None] == limb] = 0.0
        bones, others = np.nonzero((clear > TINY).any(axis=-1))
        if not len(bones):
            return None
        clear = np.maximum(clear[bones, others], TINY)
        return cls(segments, around, bones, others, clear, float(np.radians(settings.most_swivel)))

    @cached_property
    def full(self) -> Array:
        """Length of the stretched limbs [m], shape (limb,)."""
        return np.maximum(quat.length(self.segments).sum(axis=-1), TINY)

    @cached_property
    def limb(self) -> Indices:
        """Limb of each pair, shape (pair,)."""
        return self.bones // self.segments.shape[1]

    @cached_property
    def limbs(self) -> tuple[Indices, Indices]:
        """Limbs that have pairs, and where the pairs of each begin."""
        found, begin = np.unique(self.limb, return_index=True)
        return found, begin.astype(np.intp)

    @cached_property
    def shared(self) -> Array:
        """2 for pairs of which both may give way, else 1, shape (pair,)."""
        movable = np.isin(self.others - len(self.around.bodies), self.bones)
        return np.where(movable, 2.0, 1.0)


def free(obstacles: Obstacles, starts: Array, turned: Array, around: tuple[Array, Array]) -> Array:
    """Return how the joints of limbs are turned out of what they keep out of, their ends where they were.

    Limbs that do not collide stay as they are to the bit.

    Args:
        obstacles: What they keep out of.
        starts: Where they start [m], shape (frame, limb, 3).
        turned: How their joints are turned, shape (frame, limb, joint, 3, 3).
        around: Starts and ends of the axes around [m], shapes (frame, capsule, 3).
    """
    size, out = max(BLOCK // (BEADS * len(obstacles.bones)), 1), turned
    for first in range(0, len(turned), size):
        rows = np.arange(first, min(first + size, len(turned)))
        hit = rows[_Frames.of(obstacles, starts[rows], turned[rows], around[0][rows], around[1][rows]).collide()]
        if not len(hit):
            continue
        frames = _Frames.of(obstacles, starts[hit], turned[hit], around[0][hit], around[1][hit])
        angles = frames.angles()
        turns = rotation.about(frames.axes, angles)
        own = turns[:, :, None] @ turned[hit]
        out = turned.copy() if out is turned else out
        out[hit] = np.where((angles != 0.0)[..., None, None, None], own, turned[hit])
    return out


@dataclass(frozen=True, eq=False)
class _Frames:
    """Limbs before they swivel."""

    obstacles: Obstacles
    starts: Array
    """[m], shape (frame, limb, 3)."""
    points: Array
    """Joints and end, from the start [m], shape (frame, limb, joint + 1, 3)."""
    first: Array
    """Starts of the axes around [m], shape (frame, capsule, 3) …"""
    last: Array
    """… and their ends."""

    @classmethod
    def of(cls, obstacles: Obstacles, starts: Array, turned: Array, first: Array, last: Array) -> "_Frames":
        points = np.zeros((*turned.shape[:2], turned.shape[2] + 1, 3))
        points[:, :, 1:] = np.cumsum(rotation.apply(turned, obstacles.segments), axis=2)
        return cls(obstacles, starts, points, first, last)

    @cached_property
    def axes(self) -> Array:
        """Unit vectors from start to end, shape (frame, limb, 3)."""
        return quat.unit(self.points[:, :, -1])

    @cached_property
    def gains(self) -> Array:
        """How much limbs swivel: 1, less where start and end all but coincide, shape (frame, limb)."""
        return smooth_step(quat.length(self.points[:, :, -1]) / self.obstacles.full, SHORT, LONG)

    @cached_property
    def parts(self) -> tuple[Array, Array, Array]:
        """The points along the axis of the swivel, square to it and square to both, (3, frame, limb, joint + 1)."""
        axes = self.axes[:, :, None]
        along = quat.dot(self.points, np.broadcast_to(axes, self.points.shape))[..., None] * axes
        aside = self.points - along
        found = (self.starts[:, :, None] + along, aside, quat.cross(axes, aside))
        along, aside, square = (_apart(part) for part in found)
        return along, aside, square

    @cached_property
    def around(self) -> tuple[Array, Array]:
        """Starts and ends of the axes around, shapes (3, frame, capsule)."""
        return _apart(self.first), _apart(self.last)

    @cached_property
    def beads(self) -> tuple[Array, Array, Array]:
        """The same of the beads of each pair, shapes (3, bead, frame, pair)."""
        along, aside, square = (_strung(part).take(self.obstacles.bones, axis=-1) for part in self.parts)
        return along, aside, square

    def angles(self) -> Array:
        """Return by how much limbs swivel [rad], shape (frame, limb)."""
        own = self.obstacles
        angles, (found, begin) = self.outlook(), own.limbs
        for _ in range(STEPS):
            depth, slope, bend = self.depths(angles)
            counts = depth / (depth + SOFT)
            # Where the penalty bends away from a ridge it is damped more than where it bends into a valley.
            stiff = depth * (np.maximum(-bend / HASTE, bend) + STIFFNESS)
            pull = (counts * slope * depth).sum(axis=0)
            hold = own.shared * (counts * (slope * slope + stiff)).sum(axis=0)
            pull, hold = (np.add.reduceat(v, begin, axis=1) for v in (pull, hold))
            step = np.clip(pull / (hold + EFFORT), -STRIDE, STRIDE)
            angles[:, found] = np.clip(angles[:, found] - self.gains[:, found] * step, -own.most, own.most)
        return angles

    def outlook(self) -> Array:
        """Return by how much limbs swivel to where they set out from [rad], shape (frame, limb)."""
        own = self.obstacles
        still, (found, begin) = np.zeros(self.gains.shape), own.limbs
        fan = own.most * np.linspace(-1.0, 1.0, 2 * FAN + 1)
        costs = np.empty((len(fan), len(still), len(found)))
        for i, angle in enumerate(fan):
            depth, _, _ = self.depths(still + angle, still)
            costs[i] = np.add.reduceat((depth * depth).sum(axis=0), begin, axis=1) + COST * angle * angle
        least = costs.min(axis=0)
        gain = costs[FAN] - least
        weights = np.exp((least - costs) / np.maximum(EVEN * gain, TINY))
        mean = (fan[:, None, None] * weights).sum(axis=0) / weights.sum(axis=0)
        still[:, found] = self.gains[:, found] * gain / (gain + LITTLE) * mean
        return still

    def collide(self) -> Flags:
        """Return in which frames anything does, shape (frame,)."""
        depth, _, _ = self.depths(np.zeros(self.gains.shape))
        return np.any(depth > 0.0, axis=(0, 2))

    def depths(self, angles: Array, others: Array | None = None) -> tuple[Array, Array, Array]:
        """Return how deep beads lie in capsules and how that changes as limbs swivel, shapes (bead, frame, pair).

        From 0 at the surface to 1 on the axis; its first derivative by the angle; and its second, as it is where a
        capsule goes on for ever, lest it jumps where one ends. ``others`` are the angles of the limbs that are in the
        way, if not the same.
        """
        own = self.obstacles
        first, last = self._axes_at(angles if others is None else others)
        start = first.take(own.others, axis=-1)[:, None]
        axis = last.take(own.others, axis=-1)[:, None] - start
        along, aside, square = self.beads
        turns = angles.take(own.limb, axis=-1)
        cosine, sine = np.cos(turns), np.sin(turns)
        lever, move = cosine * aside + sine * square, cosine * square - sine * aside
        away = along + lever
        away -= start
        share = _dot(away, axis) / np.maximum(_dot(axis, axis), TINY)
        away -= np.minimum(np.maximum(share, 0.0), 1.0) * axis
        scale = (own.clear**-2).T[:, None]
        depth = np.maximum(1.0 - scale * _dot(away, away), 0.0)
        slope = np.where(depth > 0.0, -2.0 * scale * _dot(away, move), 0.0)
        return depth, slope, 2.0 * scale * (_dot(away, lever) - _dot(move, move))

    def _axes_at(self, angles: Array) -> tuple[Array, Array]:
        """Return starts and ends of the axes of all capsules when limbs have swivelled [m], (3, frame, capsule)."""
        along, aside, square = self.parts
        turns = angles[..., None]
        places = along + np.cos(turns) * aside + np.sin(turns) * square
        bones = (3, len(angles), -1)
        first, last = self.around
        return (
            np.concatenate([first, places[..., :-1].reshape(bones)], axis=2),
            np.concatenate([last, places[..., 1:].reshape(bones)], axis=2),
        )


def _apart(vectors: Array) -> Array:
    """Return vectors as one array for each of their coordinates, shape (..., 3) to (3, ...).

    All that is done with them is done again and again; so each pass goes through memory in a line.
    """
    return np.ascontiguousarray(np.moveaxis(vectors, -1, 0))


def _dot(a: Array, b: Array) -> Array:
    """Return the inner product over the first axis, which is dropped."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _strung(points: Array) -> Array:
    """Return what beads have between joints, (3, frame, limb, joint + 1) to (3, bead, frame, bone)."""
    starts, steps = points[:, None, :, :, :-1], np.diff(points, axis=-1)[:, None]
    beads = starts + np.linspace(1.0 / BEADS, 1.0, BEADS)[:, None, None, None] * steps
    return beads.reshape(3, BEADS, points.shape[1], -1)
