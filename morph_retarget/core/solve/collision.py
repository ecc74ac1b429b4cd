"""The collision phase: limbs swivel out of the trunk, the head and each other, as far as that can help.

A limb of two joints or more may turn as a whole about the line from where it starts to where it ends: bones keep their
lengths and the end its place. So there is one unknown for each limb. It sets out from what the limb phase has found for
the very frame and goes a fixed number of steps down a penalty that is smooth in the pose, so a pose depends on the goals
of its frame alone, and on these without jumps. To choose the best of several angles instead would be to jump from one to
another.

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
STEPS = 8
HASTE = 0.3
"""Most by which a step leads away from a ridge of the penalty, as a share of how far it is from there."""
EFFORT = 0.3
"""Damping of all steps, so that limbs do not swivel far for next to nothing, such as those that are stretched."""
SOFT = 0.2
"""Depth up to which beads count less, the less the less: limbs that only just touch do not start with a jerk."""
SHORT, LONG = 0.02, 0.15
"""A limb whose end comes as near to its start as these shares of its length swivels less, and not at all."""
BLOCK = 1 << 16
"""Beads are compared with capsules in blocks of frames, about so many at a time."""


@dataclass(frozen=True, eq=False)
class Swivels:
    """Limbs that are solved together, and what they keep out of. Bones are counted through all of the limbs."""

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
    ) -> "Swivels | None":
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
        everything = around.and_(Capsules(np.arange(count * most), starts, starts + along, thick))
        clear = thickness.clearances(points, thick, rooted.ravel(), everything, settings.margin)[..., 1:]
        clear[~swivels.ravel()] = 0.0
        limb = np.repeat(np.arange(count), most)
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
    def shared(self) -> Array:
        """2 for pairs of which both may give way, else 1, shape (pair,)."""
        movable = np.isin(self.others - len(self.around.bodies), self.bones)
        return np.where(movable, 2.0, 1.0)

    @cached_property
    def limbs(self) -> tuple[Indices, Indices]:
        """Limbs that have pairs, and where the pairs of each begin."""
        found, begin = np.unique(self.bones // self.segments.shape[1], return_index=True)
        return found.astype(np.intp), begin.astype(np.intp)


def free(swivels: Swivels, starts: Array, turned: Array, around: tuple[Array, Array]) -> Array:
    """Return how the joints of limbs are turned out of what they keep out of, their ends where they were.

    Frames without collisions stay as they are to the bit.

    Args:
        swivels: The limbs.
        starts: Where they start [m], shape (frame, limb, 3).
        turned: How their joints are turned, shape (frame, limb, joint, 3, 3).
        around: Starts and ends of the axes around [m], shapes (frame, capsule, 3).
    """
    size = max(BLOCK // (BEADS * len(swivels.bones)), 1)
    out = turned
    for first in range(0, len(turned), size):
        rows = slice(first, first + size)
        here = _Frames.of(swivels, starts[rows], turned[rows], (around[0][rows], around[1][rows]))
        hit = here.collides(swivels)
        if not hit.any():
            continue
        here = here.take(hit)
        turns = _rotations(here.axes, _angles(swivels, here))
        out = turned.copy() if out is turned else out
        out[rows][hit] = np.where(
            (turns != rotation.IDENTITY).any(axis=(-2, -1))[:, :, None, None, None],
            turns[:, :, None] @ turned[rows][hit],
            turned[rows][hit],
        )
    return out


@dataclass(frozen=True, eq=False)
class _Frames:
    """Limbs before they swivel: points on them along the axis of the swivel, square to it, and square to both [m]."""

    starts: Array
    """Shape (frame, limb, 3)."""
    axes: Array
    """Unit vectors from start to end, shape (frame, limb, 3)."""
    gains: Array
    """How much limbs swivel: 1, less where start and end all but coincide, shape (frame, limb)."""
    parts: tuple[Array, Array, Array]
    """Of the joints and the end, shapes (frame, limb, joint + 1, 3)."""
    around: tuple[Array, Array]
    """Starts and ends of the axes around [m], shapes (frame, capsule, 3)."""

    @classmethod
    def of(cls, swivels: Swivels, starts: Array, turned: Array, around: tuple[Array, Array]) -> "_Frames":
        points = np.zeros((*turned.shape[:2], turned.shape[2] + 1, 3))
        points[:, :, 1:] = np.cumsum(rotation.apply(turned, swivels.segments), axis=2)
        away = points[:, :, -1]
        axes = quat.unit(away)
        along = quat.dot(points, axes[:, :, None])[..., None] * axes[:, :, None]
        aside = points - along
        gains = smooth_step(quat.length(away) / swivels.full, SHORT, LONG)
        return cls(starts, axes, gains, (along, aside, quat.cross(axes[:, :, None], aside)), around)

    def take(self, chosen: Flags) -> "_Frames":
        along, aside, square = (part[chosen] for part in self.parts)
        return _Frames(
            self.starts[chosen],
            self.axes[chosen],
            self.gains[chosen],
            (along, aside, square),
            (self.around[0][chosen], self.around[1][chosen]),
        )

    def swivelled(self, angles: Array) -> tuple[Array, Array, Array]:
        """Return where joints and ends are, and where they go as the angles grow, (frame, limb, joint + 1, 3)."""
        along, aside, square = self.parts
        cosine, sine = np.cos(angles)[..., None, None], np.sin(angles)[..., None, None]
        now = cosine * aside + sine * square
        return self.starts[:, :, None] + along + now, cosine * square - sine * aside, now

    def depths(self, swivels: Swivels, angles: Array) -> tuple[Array, Array, Array]:
        """Return how deep beads lie in capsules, how that grows as they swivel, and how far these move (squared).

        0 at the surface and 1 on the axis, smooth in between; shapes (frame, pair, bead). What moves and how fast is
        told in clearances of the pair.
        """
        places, moves, aside = self.swivelled(angles)
        beads, ways, turn = (_beads(v)[:, swivels.bones] for v in (places, moves, aside))
        starts, ends = (
            np.concatenate([fixed, _by_bone(own)], axis=1)
            for fixed, own in zip(self.around, (places[:, :, :-1], places[:, :, 1:]), strict=True)
        )
        from_ = starts[:, swivels.others, None]
        along = ends[:, swivels.others, None] - from_
        away = beads - from_
        share = np.clip(quat.dot(away, along) / np.maximum(quat.dot(along, along), TINY), 0.0, 1.0)
        away = (away - share[..., None] * along) / swivels.clear[..., None]
        ways, turn = ways / swivels.clear[..., None], turn / swivels.clear[..., None]
        depth = np.maximum(1.0 - quat.dot(away, away), 0.0)
        bent = 2.0 * (quat.dot(ways, ways) - quat.dot(away, turn))
        return depth, -2.0 * quat.dot(away, ways) * (depth > 0.0), bent

    def collides(self, swivels: Swivels) -> Flags:
        """Return in which frames anything collides, shape (frame,)."""
        depth, _, _ = self.depths(swivels, np.zeros(self.gains.shape))
        return depth.any(axis=(1, 2))


def _angles(swivels: Swivels, frames: _Frames) -> Array:
    """Return by how much limbs swivel [rad], shape (frame, limb)."""
    angles = np.zeros(frames.gains.shape)
    found, begin = swivels.limbs
    for _ in range(STEPS):
        depth, slope, bent = frames.depths(swivels, angles)
        bent = depth * np.maximum(bent / HASTE, -bent)
        counts = depth / (depth + SOFT)
        pull = (counts * slope * depth).sum(axis=-1)
        hold = swivels.shared * (counts * (slope * slope + bent)).sum(axis=-1)
        pull, hold = (np.add.reduceat(v, begin, axis=1) for v in (pull, hold))
        angles[:, found] -= frames.gains[:, found] * pull / (hold + EFFORT)
        angles = np.clip(angles, -swivels.most, swivels.most)
    return angles


def _rotations(axes: Array, angles: Array) -> Array:
    """Return rotations about unit vectors, shape (..., 3, 3); the identity to the bit for no angle."""
    return quat.to_matrix(quat.from_axis_angle(axes, angles))


def _by_bone(points: Array) -> Array:
    """Return what limbs have for each joint, for the bones of all limbs, shape (frame, bone, 3)."""
    return points.reshape(len(points), -1, 3)


def _beads(points: Array) -> Array:
    """Return what belongs to the beads between joints, shape (frame, bone, bead, 3)."""
    starts, ends = _by_bone(points[:, :, :-1])[:, :, None], _by_bone(points[:, :, 1:])[:, :, None]
    return starts + np.arange(1, BEADS + 1)[:, None] / BEADS * (ends - starts)
