"""What is prepared once for a pair of bodies and a choice of settings."""

from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

from .. import quat
from ..arrays import Array
from ..character.character import Character
from ..contacts import ContactSettings
from ..errors import RigError
from ..skeleton import Pose
from ..solve.jacobian_ik import JacobianSettings
from ..tree import Tree
from . import alignment, kinematics, transfer
from .feet import FeetSettings
from .links import NONE, Links, link
from .root_motion import RootMotion
from .transfer import Transfer


class Matching(StrEnum):
    """How two reference poses are taken to correspond."""

    AUTO = "auto"
    """Directions between two humanoids, as they stand otherwise."""
    DIRECTIONS = "directions"
    """Segments of the target are turned onto the directions of the source's (Feng 2013 §4.1)."""
    AS_THEY_STAND = "as-they-stand"
    """The two poses mean the same, whatever they look like."""


@dataclass(frozen=True)
class RetargetSettings:
    """Everything that can be chosen about one transfer."""

    matching: Matching = Matching.AUTO
    plant_feet: bool = True
    reach_hands: bool = False
    root_motion: RootMotion = RootMotion.HIPS
    scale: float = 0.0
    """Target's travel over the source's; 0 takes the ratio of leg lengths."""
    mirror: bool = False
    """Change left and right over."""
    also: tuple[tuple[str, str], ...] = ()
    """Canonical joints of the source, each with a further bone of the target that turns as it does."""
    contacts: ContactSettings = field(default_factory=ContactSettings)
    feet: FeetSettings = field(default_factory=FeetSettings)
    solver: JacobianSettings = field(default_factory=JacobianSettings)


@dataclass(frozen=True, eq=False)
class ReferencePose:
    """A pose of a rig that stands for its rest."""

    label: str
    """For people: "rest pose", "frame 12", "current pose"."""
    rotations: Array
    """Bone orientations, armature space, shape (bone, 4)."""
    positions: Array
    """Bone heads, armature space, shape (bone, 3)."""
    is_rest: bool = False

    @classmethod
    def rest(cls, character: Character) -> "ReferencePose":
        """Return the rest pose of ``character``."""
        skeleton = character.skeleton
        return cls("rest pose", skeleton.rest_rotations, skeleton.rest_positions, is_rest=True)


@dataclass(frozen=True, eq=False)
class Plan:
    """What is prepared once for a pair of bodies and a choice of settings."""

    source: Character
    target: Character
    settings: RetargetSettings
    links: Links
    transfer: Transfer
    target_rest: Array
    """Place of each link at rest, target's character frame [m], shape (link, 3)."""
    tree: Tree
    """Which link carries each link's place: in the target's tree, or in the body where the tree is broken."""
    scale: float
    source_leg: float
    """Leg length of the source [m]; its height where it has no legs."""
    directions: bool
    """Whether segments were turned onto the source's directions."""
    reference: str
    """The source pose that stands for the target's rest, for people."""

    @property
    def plants(self) -> bool:
        """Whether feet are planted: asked for, and both have legs."""
        return self.settings.plant_feet and bool(self.links.legs)


def prepare(
    source: Character,
    target: Character,
    settings: RetargetSettings | None = None,
    source_reference: ReferencePose | None = None,
    target_reference: ReferencePose | None = None,
) -> Plan:
    """Return everything about a pair of bodies that does not change from frame to frame.

    Args:
        source: The body that moves.
        target: The body that shall move likewise.
        settings: Choices.
        source_reference: The pose of the source that stands for the target's; its rest when None.
        target_reference: The pose of the target that corresponds to it; its rest when None.

    Raises:
        RigError: Just one of the two has legs.
        MappingError: They share no joints.
    """
    settings = settings or RetargetSettings()
    source_reference = source_reference or ReferencePose.rest(source)
    target_reference = target_reference or ReferencePose.rest(target)
    _check_legs(source, target)
    links = link(source, target, settings.also)
    ours = target.local_to_character
    target_rest = ours.points(target.skeleton.rest_positions[links.target])
    people = source.humanoid and target.humanoid
    directions = settings.matching is Matching.DIRECTIONS or (settings.matching is Matching.AUTO and people)
    aligned = _align(source, target, links, directions, source_reference, target_reference)
    prepared = transfer.prepare(links, aligned, target.skeleton, ours)
    above = np.where(prepared.carrier == NONE, links.above, prepared.carrier)
    theirs = kinematics.source_points(links, source.skeleton.rest_positions[None], source.local_to_character)[0]
    source_leg, target_leg = _leg_length(links, theirs), _leg_length(links, target_rest)
    if not links.legs:
        source_leg, target_leg = source.frame.height, target.frame.height
    return Plan(
        source,
        target,
        settings,
        links,
        prepared,
        target_rest,
        Tree(above),
        settings.scale or target_leg / source_leg,
        source_leg,
        directions,
        source_reference.label,
    )


def _check_legs(source: Character, target: Character) -> None:
    for body, role, other in ((target, "target", source), (source, "source", target)):
        if other.legs and not body.legs:
            raise RigError(
                f"the {role} armature has no legs that could be found: map its legs by hand, or choose another rig"
            )


def _leg_length(links: Links, points: Array) -> float:
    lengths = [np.linalg.norm(np.diff(points[list(leg.chain)], axis=0), axis=-1).sum() for leg in links.legs]
    return max(float(np.mean(lengths)), 1e-9) if lengths else 1.0


def _align(
    source: Character,
    target: Character,
    links: Links,
    directions: bool,
    source_reference: ReferencePose,
    target_reference: ReferencePose,
) -> alignment.Alignment:
    theirs, ours = source.local_to_character, target.local_to_character
    posed = Pose(source_reference.rotations[None], source_reference.positions[None])
    source_points = kinematics.source_points(links, posed.positions, theirs)[0]
    source_turns = kinematics.source_turns(links, source.skeleton, posed, theirs)[0]
    target_points = ours.points(target_reference.positions[links.target])
    rest = target.skeleton.rest_rotations[links.target]
    target_turns = ours.turns(quat.multiply(target_reference.rotations[links.target], quat.conjugate(rest)))
    heading = quat.IDENTITY
    if not (source_reference.is_rest and target_reference.is_rest):
        heading = quat.multiply(
            alignment.facing(links, source_points), quat.conjugate(alignment.facing(links, target_points))
        )
    if directions:
        return alignment.align(links, source_points, source_turns, target_points, target_turns, heading)
    return alignment.stand_alike(source_turns, target_turns, heading)
