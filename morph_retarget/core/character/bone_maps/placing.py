"""Bone maps on a rig: which of its bones are meant, and what of the map can be used.

A map of ours names bones to the letter. Others were written for rigs of which this may be another export, and pair
bones of two rigs: what is known of one of them tells what the other's are.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from ...errors import MappingError, listed
from .. import families
from ..bone_names import BoneNames
from ..character import Character
from ..control_given import Reaching
from ..families import Family
from . import names_alone
from .bone_map import BoneMap, Pair


@dataclass(frozen=True)
class Placed:
    """What a bone map says of one rig."""

    joints: Mapping[str, str]
    """Joint to bone, empty where the rig has no such joint."""
    controls: Mapping[str, str]
    """Joint to control."""
    reaches: Mapping[str, Reaching] = field(default_factory=dict[str, Reaching])
    """Joint to how it is brought to places."""
    left_out: tuple[str, ...] = ()
    """What could not be used, each as a phrase that names the bone."""

    def told(self, most: int = 4) -> str:
        """Return in one line what was left out, empty where nothing was."""
        count = len(self.left_out)
        return f"{count} of its entries left out: {listed(self.left_out, most)}" if count else ""


@dataclass
class _Writer:
    """Collects joints: the first bone for each counts, and no bone comes twice."""

    character: Character
    joints: dict[str, str] = field(default_factory=dict[str, str])
    controls: dict[str, str] = field(default_factory=dict[str, str])
    left_out: list[str] = field(default_factory=list[str])

    def give(self, joint: str, bone: str) -> None:
        """Take a bone for a joint, as its control where it only moves the bone that the mesh follows."""
        table = self.controls if _is_control(self.character, joint, bone) else self.joints
        if bone in table.values():
            self.left_out.append(f"{bone!r} for {joint} too")
        elif joint in table:
            self.left_out.append(f"{bone!r} for {joint}, which is {table[joint]!r}")
        else:
            table[joint] = bone


def place(given: BoneMap | Family, character: Character, other: Character | None = None) -> Placed:
    """Return what a bone map says of a rig.

    Args:
        given: A map as it was read, or one of those that come with the extension.
        character: The rig.
        other: The rig at the other end of pairs, where it is at hand.

    Raises:
        MappingError: None of the map's bones is in the rig, or it says nothing at all.
    """
    if isinstance(given, Family):
        return _place_family(given, character)
    if given.exact:
        return to_the_letter(given)
    own, out = BoneNames(character.skeleton.names), _Writer(character, left_out=list(given.left_out))
    for joint, names in given.joints.items():
        bone = own.first(names)
        if bone is None:
            out.left_out.append(f"{names[0]!r} for {joint} is not in the rig")
        else:
            out.give(joint, bone)
    _pairs(out, given.pairs, own, other)
    if not out.joints and not out.controls:
        raise _misfit(given.origin, out.left_out)
    return Placed(out.joints, out.controls, left_out=tuple(out.left_out))


def to_the_letter(given: BoneMap) -> Placed:
    """Return what one of our own maps says, whatever the rig: bones that it has not are told by those who use them."""
    joints = {joint: names[0] if names else "" for joint, names in given.joints.items()}
    return Placed(joints, given.controls, given.reaches)


def _place_family(family: Family, character: Character) -> Placed:
    joints = families.placed(family, character.skeleton.names)
    missing = [joint for joint in families.BODY if joint not in joints]
    left_out = tuple(f"{family.joints[joint]!r} for {joint} is not in the rig" for joint in missing)
    if not joints:
        raise _misfit(f"preset {family.name!r}", left_out)
    return Placed(joints, {}, left_out=left_out)


def _misfit(origin: str, left_out: Sequence[str]) -> MappingError:
    why = f" ({listed(left_out, 2)})" if left_out else ""
    return MappingError(f"{origin}: fits no bone of this rig{why}: choose a map that was made for it")


def _pairs(out: _Writer, pairs: Sequence[Pair], own: BoneNames, other: Character | None) -> None:
    ends = [(pair.target, pair.source) for pair in pairs]
    if own.count(pair.source for pair in pairs) > own.count(pair.target for pair in pairs):
        ends = [(source, target) for target, source in ends]  # this rig is the one that moves
    joints = _joints_of(dict.fromkeys(theirs for _, theirs in ends), other)
    for ours, theirs in ends:
        bone, joint = own.find(ours), joints.get(theirs)
        if bone is None:
            out.left_out.append(f"{ours!r} is not in the rig")
        elif joint is None:
            out.left_out.append(f"{ours!r}: {theirs!r} is no joint")
        else:
            out.give(joint, bone)


def _joints_of(names: Iterable[str], other: Character | None) -> Mapping[str, str]:
    """Return the joints of the other rig's bones: from what it is, or else from names alone."""
    names = list(names)
    if other is not None:
        theirs = BoneNames(other.skeleton.names)
        if 2 * theirs.count(names) >= len(names):
            joints = {match.bone: joint for joint, match in other.joints.items()}
            found = {name: theirs.find(name) for name in names}
            return {name: joints[bone] for name, bone in found.items() if bone is not None and bone in joints}
    return names_alone.joints_of(names)


def _is_control(character: Character, joint: str, bone: str) -> bool:
    """Return whether a bone moves no mesh while what was found for the joint does."""
    deform, found = character.skeleton.deform, character.joints.get(joint)
    if deform is None or found is None or found.bone == bone:
        return False
    index = character.skeleton.index
    return bool(deform[index[found.bone]]) and not deform[index[bone]]
