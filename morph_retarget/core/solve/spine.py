"""A spine as the solver sees it, Hecker 2008 §4.3.2: branch points, the bones between them, and limbs that pull.

All is in the frame of what carries the spine, with the first joint as origin; so its rest is mostly the same for all
frames. Pieces of different numbers of bones are one batch; the shorter ones start with bones of no length.
"""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from .. import quat, rotation
from ..arrays import Array, Flags, Indices
from .constraints import TINY, smooth_step
from .limb_phase import BENT, STRAIGHT, Limbs
from .settings import SolverSettings
from .spine_lines import angles, steps, tangents
from .spine_pulls import Pull, PulledNode
from .spline import Splines

BACK = np.array([0.0, 1.0, 0.3])
"""Where a straight spine bends when it is pushed together, character frame: back, and one that lies, up."""
STRETCHED = 0.999
"""Share of its length to which a piece of the spine is stretched."""
LEVEL = 1e-3
"""Angle by which a spine that is taken for straight may bend the other way [rad]."""
FOLD = np.radians(100.0)
"""Up to here a piece turns against the one before it as it is wanted; beyond, the less, and by half a turn not."""
FAINT = 1e-9
"""Share of the spine's length below which a bone has no direction."""


@dataclass(frozen=True, eq=False)
class Spine:
    """The bones of a spine that can bend, from the first joint that can turn to the last branch point."""

    points: Array
    """Joints, and where the last bone ends, at rest, character frame [m], shape (joint + 1, 3)."""
    nodes: tuple[int, ...]
    """Points that are branch points; the first is point 0, which stays, the last is the last point."""
    pulls: tuple[Pull, ...]
    settings: SolverSettings
    free: Flags | None = None
    """Whether bones may stretch, shape (joint,), None when none may."""

    @cached_property
    def pulled(self) -> "dict[int, PulledNode]":
        """Branch points that limbs pull at."""
        shrink = self.settings.shrink
        return {node: PulledNode.of(self.pulls, node, shrink) for node in {pull.node for pull in self.pulls}}

    @cached_property
    def counts(self) -> Array:
        """How much each limb counts that pulls, shape (pull,)."""
        return np.array([pull.settings.pull for pull in self.pulls])

    @cached_property
    def pull_joints(self) -> Indices:
        """The joints whose bones carry the limbs that pull, shape (pull,)."""
        return np.array([pull.joint for pull in self.pulls], dtype=np.intp)

    @cached_property
    def pull_points(self) -> Indices:
        """The points that they pull at, shape (pull,)."""
        return np.array([self.nodes[pull.node] for pull in self.pulls], dtype=np.intp)

    @cached_property
    def pull_starts(self) -> Array:
        """Where they start, from the joints that carry them at rest [m], shape (pull, 3)."""
        return np.array([pull.start for pull in self.pulls]).reshape(-1, 3)

    @cached_property
    def twist_shares(self) -> Array:
        """Share of the twist of its branch point that the bone which carries each limb takes, shape (pull,)."""
        joints, nodes = self.pull_joints, [pull.node for pull in self.pulls]
        share = self.middles[joints]
        return np.where(self.bone_of[0][joints] < nodes, share, 1.0 - share)

    @cached_property
    def held(self) -> int:
        """The outermost branch point that feet hold, 0 without one."""
        return max((pull.node for pull in self.pulls if pull.holds), default=0)

    @cached_property
    def reach(self) -> Array:
        """Up to where limbs reach their goals without slowing down [m], shape (pull,)."""
        return np.array([pull.reach for pull in self.pulls])

    @cached_property
    def folded(self) -> Array:
        """Nearest that limbs come [m], shape (pull,)."""
        return np.array([pull.least for pull in self.pulls])

    @cached_property
    def segments(self) -> Array:
        """From each joint to the next point at rest [m], shape (joint, 3)."""
        return np.diff(self.points, axis=0)

    @cached_property
    def size(self) -> float:
        """Length of all bones [m]."""
        return float(quat.length(self.segments).sum())

    @cached_property
    def rows(self) -> Indices:
        """Points of each piece, the first one again and again where it has fewer, shape (piece, bone + 1)."""
        spans = np.diff(self.nodes)
        places: Indices = np.arange(int(spans.max()) + 1) - (spans.max() - spans)[:, None]
        return np.maximum(places, 0) + np.array(self.nodes[:-1])[:, None]

    @cached_property
    def pieces(self) -> Limbs:
        """The bones between neighbouring branch points."""
        chains = [self.points[a : b + 1] for a, b in zip(self.nodes, self.nodes[1:], strict=False)]
        return Limbs.of(chains, [BACK] * len(chains))

    @cached_property
    def leans(self) -> Array:
        """How bones that stand in line lean when they are pushed together, as tangents, shape (piece, bone, 3).

        Those that are bent a little lean to where they are.
        """
        own = self.pieces.leans / np.maximum(self.pieces.lengths, TINY)[..., None]
        bows = self.pieces.directions - self.pieces.lines[:, None]
        along = (self.pieces.lengths * quat.dot(own, bows)).sum(axis=-1)
        return np.where(along < -LEVEL * self.pieces.full, -1.0, 1.0)[:, None, None] * own

    @cached_property
    def most(self) -> Array:
        """Farthest that the ends of each piece come from each other [m], shape (piece,).

        Straight ones bend by the square root of what they are shorter; so no piece gets straighter than nearly, unless
        it is at rest.
        """
        pieces = self.pieces
        alone = (pieces.lengths > TINY).sum(axis=-1) == 1
        longest = np.where(alone, pieces.full, np.maximum(STRETCHED * pieces.full, pieces.chords))
        return np.minimum(longest, np.where(alone, pieces.full, self.settings.stretch * pieces.chords))

    @cached_property
    def elastic(self) -> Array:
        """Lengths of the bones that may stretch [m], 0 of others, shape (piece, bone)."""
        out = np.zeros_like(self.pieces.lengths)
        if self.free is not None:
            out[self.bone_of] = np.where(self.free, self.pieces.lengths[self.bone_of], 0.0)
        return out

    @cached_property
    def room(self) -> Array:
        """How much farther than `most` the ends of each piece come when its bones stretch [m], shape (piece,)."""
        longer = (self.settings.stretch - 1.0) * self.elastic.sum(axis=-1)
        return np.where(longer > 0.0, self.pieces.full + longer - self.most, 0.0)

    @cached_property
    def least(self) -> Array:
        """Nearest that they come [m], shape (piece,)."""
        pieces = self.pieces
        longest = 2.0 * pieces.lengths.max(axis=-1) - pieces.full
        return np.minimum(np.maximum(longest, self.settings.spine_shrink * pieces.chords), self.most)

    @cached_property
    def splines(self) -> Splines:
        """Through the points of the pieces."""
        return Splines.through(self.pieces.lengths)

    @cached_property
    def bone_of(self) -> tuple[Indices, Indices]:
        """For each joint its piece and its place there."""
        own = np.searchsorted(self.nodes, np.arange(len(self.segments)), side="right") - 1
        spans = np.diff(self.nodes)
        return own, np.arange(len(self.segments)) - np.array(self.nodes)[own] + (spans.max() - spans)[own]

    @cached_property
    def leading(self) -> Indices:
        """For each joint the one whose bone tells its direction, shape (joint,): its own, unless that has no length.

        Then it goes with the one before it, or with the first one that has some.
        """
        some = np.flatnonzero(quat.length(self.segments) > FAINT * self.size)
        joints: Indices = np.arange(len(self.segments))
        return some[np.maximum(np.searchsorted(some, joints, side="right") - 1, 0)] if len(some) else joints

    @cached_property
    def leading_bones(self) -> Indices:
        """The same, by its place among the bones of all pieces."""
        piece, place = self.bone_of
        return (piece * self.rows[:, 1:].shape[1] + place)[self.leading]

    def of_bones(self, directions: Array) -> Array:
        """Return directions of the joints from those of the bones of pieces, (frame, piece, bone, 3)."""
        return directions.reshape(len(directions), -1, 3).take(self.leading_bones, axis=1)

    @cached_property
    def middles(self) -> Array:
        """How far along their pieces the middles of bones are, 0 to 1, shape (joint,)."""
        return self.splines.middles[self.bone_of]

    @cached_property
    def still(self) -> "Rest":
        """The rest of a spine none of whose bones has a turn of its own."""
        return Rest(self, np.broadcast_to(np.eye(3), (1, len(self.segments), 3, 3)))


@dataclass(frozen=True, eq=False)
class Rest:
    """The root-relative rest pose of a spine; the first axis of all is that of frames, or 1."""

    spine: Spine
    turns: Array
    """How its bones are turned, shape (frame, joint, 3, 3)."""
    points: Array = field(init=False)
    """[m], shape (frame, joint + 1, 3)."""

    def __post_init__(self) -> None:
        bones = rotation.apply(self.turns, self.spine.segments)
        start = np.zeros((len(bones), 1, 3))
        object.__setattr__(self, "points", np.concatenate([start, np.cumsum(bones, axis=1)], axis=1))

    def at(self, rows: Flags) -> "Rest":
        """Return the rest of some frames."""
        return self if len(self.turns) == 1 else Rest(self.spine, self.turns[rows])

    @cached_property
    def nodes(self) -> Array:
        """Branch points [m], shape (frame, node, 3)."""
        return self.points.take(self.spine.nodes, axis=1)

    @cached_property
    def constraints(self) -> Array:
        """From each branch point to the next, shape (frame, piece, 3)."""
        return steps(self.nodes)

    @cached_property
    def chords(self) -> Array:
        """Their lengths [m], shape (frame, piece)."""
        return quat.length(self.constraints)

    @cached_property
    def starts(self) -> Array:
        """Where the limbs that pull start, from their branch points [m], shape (frame, pull, 3)."""
        joints, nodes, own = self.spine.pull_joints, self.spine.pull_points, self.spine.pull_starts
        return self.points[:, joints] + rotation.apply(self.turns[:, joints], own) - self.points[:, nodes]

    def drawn_in(self, goals: Array, weights: Array) -> Array:
        """Return where limbs are to end that pull: nearer than their goals where these only count in part.

        Of the way by which a goal is too far for its limb, as much is left. Iterations alone would make up for most of
        what a small share leaves out of each of them.

        Args:
            goals: Of the limbs [m], shape (frame, pull, 3).
            weights: How much they count, shape (frame, pull).
        """
        if (weights == 1.0).all():
            return goals
        spine = self.spine
        away = goals - self.starts - self.nodes[:, [pull.node for pull in spine.pulls]]
        distance = quat.length(away)
        over = np.maximum(distance - np.array([pull.begin for pull in spine.pulls]), 0.0)
        return goals - ((1.0 - weights) * over / np.maximum(distance, TINY))[..., None] * away

    def drawn_near(self, pins: Array, pinned: Array) -> Array:
        """Return where branch points are to be: nearer to where they rest than their goals where these count in part.

        Args:
            pins: Goals of the branch points [m], shape (frame, node, 3).
            pinned: How much they count, shape (frame, node).
        """
        part = np.sqrt(pinned[..., None])  # it counts again by the share that branch points go there
        return np.where(part == 1.0, pins, self.nodes + part * (pins - self.nodes))

    @cached_property
    def piece_turns(self) -> Array:
        """Turns of the bones of the pieces, shape (frame, piece, bone, 3, 3)."""
        return self.turns.take(self.spine.rows[:, :-1], axis=1)

    @cached_property
    def directions(self) -> Array:
        """Of the bones, unit vectors, shape (frame, joint, 3)."""
        own = self.spine.leading
        piece, place = self.spine.bone_of
        return rotation.apply(self.turns.take(own, axis=1), self.spine.pieces.directions[piece[own], place[own]])

    @cached_property
    def splined(self) -> Array:
        """The splines, shape (frame, piece, 6, 3)."""
        return np.matmul(self.spine.splines.fit, self.points.take(self.spine.rows, axis=1))

    @cached_property
    def offsets(self) -> Array:
        """The points from the splines [m], shape (frame, piece, bone + 1, 3)."""
        return self.points.take(self.spine.rows, axis=1) - np.matmul(self.spine.splines.places, self.splined)

    @cached_property
    def strays(self) -> bool:
        """Whether some points are off the splines."""
        return bool(np.abs(self.offsets).max() > 1e-9 * self.spine.size)

    @cached_property
    def least(self) -> Array:
        """Nearest that the ends of each piece come [m], shape (frame, piece)."""
        return np.minimum(self.spine.least, self.chords)

    @cached_property
    def axes(self) -> Array:
        """Directions of the constraints, unit vectors, shape (frame, piece, 3)."""
        return quat.unit(self.constraints)

    @cached_property
    def backs(self) -> Array:
        """Half turns about them, shape (frame, piece, 3, 3)."""
        return rotation.half_turn(self.axes)

    @cached_property
    def bows(self) -> Array:
        """How bones lead off the constraints of their pieces, square to these, shape (frame, piece, bone, 3)."""
        bones = rotation.apply(self.piece_turns, self.spine.pieces.directions)
        own = bones - quat.dot(bones, self.axes[:, :, None])[..., None] * self.axes[:, :, None]
        return np.where((self.spine.pieces.lengths > 0.0)[..., None], own, 0.0)

    @cached_property
    def straight(self) -> Array:
        """How straight the pieces are: 0 where their own bends tell how they bow, shape (frame, piece)."""
        return smooth_step(self.chords / self.spine.pieces.full, np.cos(0.5 * BENT), np.cos(0.5 * STRAIGHT))

    @cached_property
    def leans(self) -> Array:
        """How bones of straight pieces lead off their constraints when these get shorter, shape as of `bows`."""
        own = rotation.apply(self.piece_turns[:, :, :1], self.spine.leans)
        own = own - quat.dot(own, self.axes[:, :, None])[..., None] * self.axes[:, :, None]
        return self.straight[..., None, None] * own

    @cached_property
    def folds(self) -> Array:
        """Angles between neighbouring constraints [rad], 0 for the first, shape (frame, piece)."""
        own = self.constraints
        before = np.concatenate([own[:, :1], own[:, :-1]], axis=1)
        return angles(before, own)

    @cached_property
    def levels(self) -> Array:
        """Cosines of the angles from which on pieces fold over against those before them, shape (frame, piece)."""
        return np.cos(np.maximum(FOLD - self.folds, 0.0))

    @property
    def is_turned(self) -> bool:
        """Whether bones have turns of their own."""
        return self is not self.spine.still

    @cached_property
    def tangents(self) -> Array:
        """At the branch points, unit vectors, shape (frame, node, 3)."""
        return tangents(self.nodes, self.constraints[:, 0])
