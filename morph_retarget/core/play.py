"""Playing a generalized action on a character: prepared once, evaluated for a batch of frames.

generalized values -> specialize and blend -> goals -> pose -> basis rotations of bones

Channels whose targets are bodies of the same character are specialized last, when the others have moved the targets.
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from . import layering, quat, rotation
from .arrays import Array, Indices
from .character.character import Character
from .character.frame import Placement
from .character.morphology import Capability
from .layering import Layer, Wanted
from .morph import specialize
from .morph.bind import Binding
from .morph.bodies import Bodies
from .morph.channels import Values
from .morph.specialize import Deforms
from .solve import ground_phase, posing
from .solve.footing import Footing
from .solve.goals import Goals
from .solve.ground_phase import Lifting
from .solve.hierarchy import Hierarchy
from .solve.limits import JointLimits
from .solve.posing import BodyPose
from .solve.settings import DEFAULT, SolverSettings


@dataclass(frozen=True, eq=False)
class Part:
    """A binding to play on a character, ready to be evaluated."""

    character: Character
    binding: Binding
    pose: posing.Plan
    first: "Part | None" = None
    """The channels that have to be played before this one's targets are known, None when none have to."""
    lifting: Lifting | None = None
    """What is turned up where it would be below the ground, None when nothing is."""
    footing: Footing | None = None
    """What keeps the root as low as feet need it, None when nothing does: a gait sees to that itself."""

    @property
    def bodies(self) -> Bodies:
        """Of the character."""
        return self.binding.bodies

    @cached_property
    def bones(self) -> Indices:
        """Bones that are turned, shape (n,)."""
        return np.array(self.pose.driven, dtype=np.intp)

    @cached_property
    def stretching(self) -> Indices:
        """Bones whose heads move off where their parents hold them, shape (n,)."""
        return np.array(self.pose.stretched, dtype=np.intp)

    @cached_property
    def leaders(self) -> Indices:
        """What turns these, by its place in the plan's order, shape (n,)."""
        return self.pose.led_by[self.bones]

    @cached_property
    def carriers(self) -> tuple[Indices, Indices]:
        """What turns their parents, shape (n,), and the places of those that do not take that over."""
        skeleton, bones = self.character.skeleton, self.bones
        parents = skeleton.parents[bones]
        alone = parents < 0
        if skeleton.inherits is not None:
            alone |= ~skeleton.inherits[bones]
        return self.pose.led_by[np.where(alone, 0, parents)], np.flatnonzero(alone)

    @cached_property
    def rest_frames(self) -> Array:
        """Rest frames of the turned bones in the character frame (mirrored if the armature is), shape (n, 3, 3)."""
        rest = self.character.skeleton.rest_rotations[self.bones]
        return self.character.local_to_character.rotation @ quat.to_matrix(rest)

    @cached_property
    def to_local(self) -> Placement:
        """From the character frame to armature space."""
        return self.character.local_to_character.inverse()

    def carried(self, pose: BodyPose) -> Array:
        """Return how the parents of the turned bones are turned, as far as these take it over, (frame, n, 3, 3)."""
        carriers, alone = self.carriers
        out = pose.rotations.take(carriers, axis=1)
        out[:, alone] = rotation.IDENTITY
        return out


@dataclass(frozen=True, eq=False)
class Stretched:
    """Bones that are moved off where their parents hold them, where others have got longer or shorter.

    Feet and hands that do not hang on their limbs are always among them.
    """

    bones: Indices
    """Shape (n,)."""
    shifts: Array
    """How far their heads move, in the rest frames of their parents, armature space, shape (frame, n, 3)."""


@dataclass(frozen=True, eq=False)
class Played:
    """A character over a clip, ready to be keyed or shown."""

    bones: Indices
    """Bones that are turned, shape (n,)."""
    basis: Array
    """Their rotations in their own rest frames, shape (frame, n, 4)."""
    root: int
    """The bone that is moved."""
    shift: Array
    """How far it moves from where its parents hold it, in their rest frame, armature space, shape (frame, 3)."""
    goals: Goals
    """What was asked for, character frame."""
    pose: BodyPose
    """What came out, character frame."""
    deforms: Deforms
    followed: Array | None
    """Positions of all bodies that targets were taken from [m], character frame, shape (frame, body, 3)."""
    stretched: Stretched | None = None
    """What moves as bones stretch, or hangs elsewhere than on its limb, None where nothing does."""


def prepare(
    character: Character,
    binding: Binding,
    settings: SolverSettings = DEFAULT,
    limits: JointLimits | None = None,
    fixed: Collection[int] = (),
    lower: Wanted = (),
) -> Part:
    """Return how a binding plays on its character.

    Args:
        character: What the rig is.
        binding: How its bodies are posed.
        settings: How the solver is tuned for it.
        limits: What limits its joints.
        fixed: Bones whose heads cannot move off where their parents hold them.
        lower: Goals of a layer that the action is laid over, first that of the body which then carries all others.
    """
    first = None
    if binding.plan.follows_bodies:
        first = prepare(character, binding.without_followers(), settings, limits, fixed)
    bodies = binding.bodies
    wanted: dict[int, tuple[bool, bool]] = {}
    for entry in binding.entries:
        channel, (position, rotation) = binding.action.channels[entry.channel], wanted.get(entry.body, (False, False))
        # Channels without weight only keep others from posing what they own.
        position |= entry.position and channel.position_weight > 0.0
        rotation |= entry.rotation and channel.rotation_weight > 0.0
        wanted[entry.body] = (position, rotation)
    goals = [(int(body), *wanted[int(body)]) for body in binding.plan.goals]
    both = tuple(layering.wanted(goals, lower))
    root = lower[0][0] if lower else root_of(bodies)
    pose = _planned(character, bodies.positions.tobytes(), root, both, settings, limits, frozenset(fixed))
    hierarchy, lifting = Hierarchy(character, bodies.positions, root, frozenset(fixed)), None
    if settings.keeps_above_ground and not lower:
        lifting = Lifting.of(hierarchy, pose)
    footing = None if lower else Footing.of(hierarchy, both, settings)
    return Part(character, binding, pose, first, lifting, footing)


@lru_cache(maxsize=32)
def _planned(
    character: Character,
    positions: bytes,
    root: int,
    wanted: tuple[tuple[int, bool, bool], ...],
    settings: SolverSettings,
    limits: JointLimits | None,
    fixed: frozenset[int],
) -> posing.Plan:
    """Return how goals are met: planned once for all bindings that want the same, and again by undo.

    Tables of limbs, which a plan makes when it is first used, take longer than all else that is prepared.
    """
    rest = np.frombuffer(positions, dtype=np.float64).reshape(-1, 3)
    return posing.prepare(character, rest, root, wanted, settings, limits, fixed)


def root_of(bodies: Bodies) -> int:
    """Return the body that carries all others."""
    return (bodies.with_capability(Capability.ROOT) or bodies.tree.roots)[0]


def evaluate(part: Part, values: Values, external: Mapping[int, Array], lower: Layer | None = None) -> Played:
    """Return a batch of frames.

    Args:
        part: From `prepare`.
        values: Of the action's channels.
        external: Target of each channel that has an external one [m], character frame, shapes (frame or 1, 3).
        lower: What the action is laid over, as the part was prepared for.
    """
    seen = external if lower is None else lower.seen(external)
    followed = _followed(part, values, seen)
    goals = _goals(part, values, seen, followed, lower)
    if part.footing is not None:
        goals = part.footing.kept(goals)
    pose = posing.solve(part.pose, goals)
    if part.lifting is not None:
        pose = ground_phase.lifted(part.lifting, pose)
    turns, above = pose.rotations.take(part.leaders, axis=1), part.carried(pose)
    # A basis rotation is what a bone turns beyond its parent, seen in its own rest frame.
    basis = quat.from_matrix(rotation.transposed(above @ part.rest_frames) @ turns @ part.rest_frames)
    shift = pose.shift @ part.to_local.rotation.T * part.to_local.scale
    stretched = None
    if pose.shifts is not None:
        stretched = Stretched(part.stretching, pose.shifts @ part.to_local.rotation.T * part.to_local.scale)
    deforms = specialize.deforms_of(part.binding, values)
    if lower is not None and lower.deforms:
        deforms = {**lower.deforms, **deforms}
    return Played(part.bones, basis, part.pose.root, shift, goals, pose, deforms, followed, stretched)


def goals_at(part: Part, values: Values, external: Mapping[int, Array], lower: Layer | None = None) -> Goals:
    """Return where bodies shall be, without the pose that gets them there; arguments as for `evaluate`."""
    seen = external if lower is None else lower.seen(external)
    return _goals(part, values, seen, _followed(part, values, seen), lower)


def _goals(
    part: Part, values: Values, external: Mapping[int, Array], followed: Array | None, lower: Layer | None
) -> Goals:
    own = specialize.goals_of(part.binding, values, specialize.frames_of(part.binding, external, followed))
    return own if lower is None else layering.together(lower.carries(own), lower.goals)


def _followed(part: Part, values: Values, external: Mapping[int, Array]) -> Array | None:
    """Return where bodies that are targets are: where the channels that follow none of them bring them."""
    if part.first is None:
        return None
    return posing.solve(part.first.pose, goals_at(part.first, values, external)).positions
