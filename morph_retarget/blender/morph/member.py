"""One armature as it plays one action: how the action binds to it, and what poses it by that."""

from dataclasses import dataclass
from functools import cached_property

import bpy

from ...core import play
from ...core.character.character import Character
from ...core.locomotion import getting_about
from ...core.locomotion.moving import Moving
from ...core.morph.bind import Binding, GeneralizedAction
from ...core.morph.bodies import Bodies
from ...core.morph.channels import TargetKind
from ...core.play import Part
from ...core.solve.limits import JointLimits
from ...core.solve.settings import DEFAULT, SolverSettings
from ..properties import of_rig
from ..rig import Rig
from . import stretching


@dataclass(frozen=True, eq=False)
class Member:
    """One armature as it plays one action."""

    rig: Rig
    action: bpy.types.Action
    definition: GeneralizedAction
    character: Character
    """What the armature is."""
    binding: Binding
    """How its bodies are posed."""
    solver: SolverSettings = DEFAULT
    limits: JointLimits | None = None
    """Of its joints."""
    fixed: frozenset[int] = frozenset()
    """Bones that cannot move off their parents when others stretch."""
    gait: Moving | None = None
    """How it stands, if it goes over the ground: its gait has the same goals wherever it goes. None if it does not."""

    @property
    def bodies(self) -> Bodies:
        """Its bodies."""
        return self.binding.bodies

    @cached_property
    def names(self) -> dict[str, int]:
        """Names of the channels, and which ones they are."""
        return {channel.name: i for i, channel in enumerate(self.definition.channels)}

    @cached_property
    def external(self) -> dict[int, str]:
        """Channels that have external targets, and their names."""
        channels = self.definition.channels
        return {i: c.name for i, c in enumerate(channels) if c.has_target and c.target is TargetKind.EXTERNAL}

    @cached_property
    def aims(self) -> tuple[tuple[str, tuple[int, ...]], ...]:
        """Channels that have the same external target: the name of one of them, and which they are.

        Another target makes another member.
        """
        items = of_rig(self.rig.object).channels
        found: dict[tuple[bpy.types.Object | None, str], list[int]] = {}
        for i, name in self.external.items():
            found.setdefault((items[name].target, items[name].target_bone), []).append(i)
        return tuple((self.external[own[0]], tuple(own)) for own in found.values())

    @cached_property
    def part(self) -> Part:
        """What plays."""
        return self._part(self.binding)

    @cached_property
    def free(self) -> Part:
        """The same without what has targets, for others that follow this one's bodies."""
        return self._part(self.binding.untargeted())

    def _part(self, binding: Binding) -> Part:
        lower = () if self.gait is None else self.gait.wanted
        solver = self.solver if self.gait is None else getting_about.tuned(self.solver, self.gait)
        return play.prepare(self.character, binding, solver, self.limits, self.fixed, lower)

    @cached_property
    def follows_controls(self) -> bool:
        """Whether controls pose its bones, which are not among these."""
        return len(self.rig.skeleton) < len(self.rig.armature.bones)

    @property
    def root(self) -> int:
        """The body that carries all others."""
        return play.root_of(self.bodies)

    @property
    def plays(self) -> bool:
        """Whether anything poses it."""
        return self.gait is not None or len(self.binding.entries) > 0

    @property
    def warnings(self) -> tuple[str, ...]:
        """What the user should know of the armature itself."""
        return (*self.rig.warnings, *stretching.told(self.rig, self.part.pose.stiff))
