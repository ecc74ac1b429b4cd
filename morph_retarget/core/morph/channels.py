"""Channels: what an animator keys, for bodies described by a context (Hecker 2008 §3)."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

from ..arrays import Array
from .context import Context
from .movement import Movement


class TargetKind(StrEnum):
    """What a channel moves relative to or looks at."""

    NONE = "none"
    CONTEXT = "context"
    EXTERNAL = "external"


class SideConstraint(StrEnum):
    """Where a varying channel plays, relative to the first one."""

    ANY = "any"
    SAME = "same"
    OPPOSITE = "opposite"


class MirrorRule(StrEnum):
    """Which bodies are specialized as mirror images (m of Hecker 2008 §3.2.1)."""

    NEVER = "never"
    LEFT = "left"
    RIGHT = "right"
    VARIANT = "variant"


@dataclass(frozen=True)
class Channel:
    """One channel of a generalized action."""

    name: str
    context: Context
    """The primary context: the bodies that the channel poses."""
    movement: Movement = field(default_factory=Movement)
    target: TargetKind = TargetKind.NONE
    secondary: Context | None = None
    """Bodies that are the target, with `TargetKind.CONTEXT`; each selected body takes the nearest at rest."""
    poses_position: bool = True
    """Whether it has a position curve, and so wants to own the positions of its bodies."""
    poses_rotation: bool = True
    """Whether it has a rotation curve."""
    position_weight: float = 1.0
    rotation_weight: float = 1.0
    priority: int = 0
    """Channels of higher priority select first; of equal ones the first in the list."""
    blend_group: str = ""
    """Channels of one group share the bodies that they select; an empty name is shared with no other channel."""
    varies: bool = False
    """Whether it plays on one of its bodies at a time, a different one in each variant."""
    variant_group: str = ""
    """Varying channels of one group vary together; an empty name varies alone."""
    side: SideConstraint = SideConstraint.ANY
    mirror: MirrorRule = MirrorRule.NEVER
    """`LEFT`: it was authored on the left, so bodies on the right are mirrored; `RIGHT` the other way round;
    `VARIANT`: mirrored where the first varying channel is."""

    @property
    def has_target(self) -> bool:
        """Whether targets take part in where its bodies go."""
        return self.target is not TargetKind.NONE and self.movement.has_target


@dataclass(frozen=True, eq=False)
class Values:
    """The generalized values of all channels of an action over a clip."""

    positions: Array
    """Shape (frame, channel, 3)."""
    rotations: Array
    """Unit quaternions, shape (frame, channel, 4)."""
    weights: Array
    """Keyed weights, 0 … 1, shape (frame, channel)."""
    deforms: Mapping[tuple[int, str], Array] = field(default_factory=dict[tuple[int, str], Array])
    """Scalar curves by channel and name of the deform ("open"), each of shape (frame,)."""

    def __len__(self) -> int:
        return len(self.positions)

    def at(self, frames: slice) -> "Values":
        """Return the values at some frames of the clip."""
        deforms = {key: curve[frames] for key, curve in self.deforms.items()}
        return Values(self.positions[frames], self.rotations[frames], self.weights[frames], deforms)
