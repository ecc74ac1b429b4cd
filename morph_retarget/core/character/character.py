"""What a rig is: the result of the analysis, read by everything else."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

from ..skeleton import Skeleton
from .frame import CharacterFrame, Placement
from .joints import JointMatch
from .morphology import Capability, Limb, LimbKind


@dataclass(frozen=True, eq=False)
class Character:
    """A rig's joints with confidence, capabilities, limbs and character frame."""

    skeleton: Skeleton
    placement: Placement
    frame: CharacterFrame
    joints: Mapping[str, JointMatch]
    """VRM 1.0 humanoid bone name to match, in the order of `joints.PARENTS`."""
    capabilities: Mapping[str, tuple[Capability, ...]]
    """Bone name to what it can do."""
    limbs: tuple[Limb, ...]
    spine: tuple[int, ...]
    neck: tuple[int, ...]
    head: int | None
    tails: tuple[tuple[int, ...], ...]
    humanoid: bool
    """Whether it stands upright on one pair of legs and has arms."""
    floor: float
    """Height over the character frame's ground of the floor it plays on [m]: 0, or for a skeleton that is rooted at its
    hips (BVH) the height of the armature's origin, since its clips play above that and not below."""
    rest_is_pose: bool
    """False when the rest pose is no pose of a body (BVH files whose bones all lie along one axis)."""
    plausibility: float
    """How much the judged pose looks like a standing body, log-odds; compares poses of one rig."""
    warnings: tuple[str, ...] = ()

    def bone(self, joint: str) -> int | None:
        """Return the index of the bone of ``joint``, None when the rig has none."""
        match = self.joints.get(joint)
        return None if match is None else self.skeleton.index[match.bone]

    @property
    def unmapped(self) -> list[str]:
        """Bones that are no joint and have no capability."""
        known = {m.bone for m in self.joints.values()} | set(self.capabilities)
        return [name for name in self.skeleton.names if name not in known]

    @property
    def legs(self) -> list[Limb]:
        """The legs, front row first, left before right."""
        return sorted((m for m in self.limbs if m.kind is LimbKind.LEG), key=lambda m: (m.row, -m.side))

    def carrier(self, root: int) -> int:
        """Return the nearest body, from a root upward, that carries most of limbs, spine and neck.

        Where a pelvis has the legs alone, this is what it hangs on, with the upper body.
        """
        ancestors = self.skeleton.tree.ancestors
        tops = {*(limb.bones[0] for limb in self.limbs), *self.spine, *self.neck}
        line = (root, *ancestors[root])
        carried = [sum(top == own or own in ancestors[top] for top in tops) for own in line]
        return line[carried.index(max(carried))]

    @property
    def world_to_character(self) -> Placement:
        """The way from world space to the character frame."""
        return self.frame.world_to_character

    @cached_property
    def local_to_character(self) -> Placement:
        """The way from armature space to the character frame."""
        return self.placement.then(self.frame.world_to_character)
