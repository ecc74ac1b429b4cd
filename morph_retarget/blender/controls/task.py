"""What is to be carried onto controls, where to, and what comes of it."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum

from ...core.arrays import Array
from ...core.character.character import Character
from ...core.character.control_given import Reaching
from ...core.character.control_limbs import LimbControls
from ...core.character.controls import Controls
from ...core.mocap.motion import Motion
from ...core.mocap.plan import Plan
from ..channels import Channel
from ..rig import Rig


class Onto(StrEnum):
    """What a motion is written on."""

    AUTO = "auto"
    """Controls that turn parts where a rig has controls, else its bones."""
    FK = "fk"
    """Controls that turn parts."""
    IK = "ik"
    """Controls that bring hands and feet to places; those that turn parts for all else."""
    NONE = "none"
    """The bones that were mapped."""


@dataclass(frozen=True, eq=False)
class Carried:
    """A motion on controls."""

    channels: Sequence[Channel]
    body: Sequence[str]
    """Bones that it owns."""
    motion: Motion
    """What the deform bones do, as Blender evaluates them."""
    described: dict[str, object]
    """For reports."""
    warnings: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Task:
    """What is to be carried, and where to."""

    target: Rig
    """With all its bones; the plan and the character may know only the deform bones among them."""
    character: Character
    plan: Plan
    given: Mapping[str, str] = field(default_factory=dict[str, str])
    """The user's own controls, by joint."""
    reaches: Mapping[str, Reaching] = field(default_factory=dict[str, Reaching])
    """What the user says of how hands and feet are brought to places, by joint."""
    only: Collection[str] = ()
    """Bones or controls that are to be moved; all when empty."""


@dataclass(frozen=True, eq=False)
class Times:
    """When a motion is keyed and shown."""

    keyed: Array
    """Frames of the scene, shape (n,)."""
    places: Array | None
    """Frames of the motion that these are, shape (n,); its own ones when None."""
    shown: Array
    """When the frames of the motion are shown [frames of the scene], shape (frame,)."""


@dataclass(frozen=True, eq=False)
class Work:
    """A task with the controls that were found for it."""

    task: Task
    controls: Controls
    onto: Onto
    rest: Sequence[Channel]
    """Switches, one frame each."""

    @property
    def reached(self) -> Sequence[LimbControls]:
        """Limbs that are brought to places: as asked for, or because nothing else moves them."""
        return [limb for limb in self.controls.limbs if self.onto is Onto.IK or not limb.turned]

    @property
    def target(self) -> Rig:
        """The rig."""
        return self.task.target

    @property
    def plan(self) -> Plan:
        """Of the pair."""
        return self.task.plan
