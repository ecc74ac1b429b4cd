"""What jiggles on a character while something else poses the rest of it, chosen by flexibility, placement and type.

Hecker 2008 §4.4: sub-trees that nothing poses get passive secondary motion. Which ones is found anew for each action:
a tail that an action keys is left to the action. Limbs that walk or grasp, the trunk, the head, faces and fingers never
jiggle, and neither do bones that only help others or carry things.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from .. import quat
from ..arrays import Array, Indices
from ..character.character import Character
from ..character.joint_names import is_extra
from ..character.joints import FINGER_JOINTS
from ..character.morphology import Capability, LimbKind
from ..character.names import Reading, read_names
from ..character.words import Sense
from .jiggle_kinds import MANNERS, JiggleKind, JiggleSettings, Override

NONE = -1


STUB = 0.04
"""An ear that stands out less far than this share of the character's size is stiff, as ours are."""
REACH = 0.12
"""A chain whose bones say nothing about themselves stands out at least as far: it is no finger, tongue or nose."""
FOOTING = 0.06
"""One that ends nearer to the ground than this share of the height in which it begins is a leg."""
SEGMENTS = 3
"""A line of fewer bones than this is less flexible, in proportion."""


@dataclass(frozen=True, eq=False)
class Chains:
    """The jiggling bones of a character; those that carry others stand before them."""

    bones: Indices
    """Shape (n,)."""
    above: Indices
    """For each its nearest jiggling ancestor, by its place among them, `NONE` where a sub-tree begins, shape (n,)."""
    top: Indices
    """For each the bone with which its sub-tree begins, by its place among them, shape (n,)."""
    rest: Array
    """Their rest rotations, armature space, shape (n, 4)."""
    tips: Array
    """From each bone's head to where it leads, in its own rest frame [armature units], shape (n, 3)."""
    share: Array
    """Way from the sub-tree's start to each tip, over that of its farthest tip, shape (n,)."""
    length: Array
    """That whole way [armature units], shape (n,)."""
    kinds: tuple[JiggleKind, ...]
    half_life: Array
    """[s], at the tip of the sub-tree, shape (n,)."""
    stiffness: Array
    """Shape (n,)."""
    amount: Array
    """Shape (n,)."""
    limit: Array
    """How far each bone may turn from where it is carried [rad], shape (n,)."""

    def __len__(self) -> int:
        return len(self.bones)


def find(
    character: Character, posed: Collection[int], settings: JiggleSettings, among: Collection[int] | None = None
) -> Chains:
    """Return what jiggles on a character.

    Args:
        character: What the rig is.
        posed: Bones that the action poses or whose movement something else owns.
        settings: How it jiggles.
        among: Bones that may jiggle; all when None.
    """
    skeleton, tree = character.skeleton, character.skeleton.tree
    readings = read_names(skeleton.names)
    kinds = _kinds(character, posed, readings)
    if among is not None:
        kinds = {bone: kind for bone, kind in kinds.items() if bone in among}
    tips = _tips(character, kinds)
    size = float(np.ptp(skeleton.rest_positions, axis=0).max())
    bones: list[int] = []
    above: list[int] = []
    for tree_bones in _sub_trees(character, kinds):
        # A bone without length has no direction to lag in; it is carried along.
        line = [b for b in tree_bones if quat.length(tips[b]) > 1e-7 * size]
        if line and _hangs(character, kinds[tree_bones[0]], line, tips[line], size):
            place = {bone: len(bones) + i for i, bone in enumerate(line)}
            above += [next((place[a] for a in tree.ancestors[b] if a in place), NONE) for b in line]
            bones += line
    share, length, count, top = _shares(tips[bones], above)
    own = [_settled(settings, kinds[b], skeleton.names[b]) for b in bones]
    flexible = np.minimum(count / SEGMENTS, 1.0)
    limit = np.radians([MANNERS[kinds[b]].limit for b in bones])
    return Chains(
        np.array(bones, dtype=np.intp),
        np.array(above, dtype=np.intp),
        top,
        skeleton.rest_rotations[bones],
        quat.rotate(quat.conjugate(skeleton.rest_rotations[bones]), tips[bones]),
        share,
        length,
        tuple(kinds[b] for b in bones),
        np.array([o.half_life for o in own]),
        np.array([o.stiffness for o in own]),
        np.array([o.amount for o in own]) * flexible,
        # The first bones bend least: what grows on a body leaves it the way it has grown.
        limit * (0.3 + 0.7 * share),
    )


def _settled(settings: JiggleSettings, kind: JiggleKind, bone: str) -> Override:
    """Return what holds for a bone: its own settings, else its kind's, else the kind's share of the character's."""
    manner = MANNERS[kind]
    common = Override(
        settings.half_life * manner.half_life, settings.stiffness * manner.stiffness, settings.amount * manner.amount
    )
    return settings.bones.get(bone) or settings.kinds.get(kind) or common


# --- which bones ---

_SENSES: Mapping[JiggleKind, tuple[Sense, ...]] = {
    JiggleKind.EAR: (Sense.EAR,),
    JiggleKind.ANTENNA: (Sense.ANTENNA,),
    JiggleKind.TENTACLE: (Sense.TENTACLE,),
    JiggleKind.WING: (Sense.WING, Sense.FEATHER),
    JiggleKind.FIN: (Sense.FIN,),
    JiggleKind.HAIR: (Sense.HAIR,),
    JiggleKind.CLOTH: (Sense.CLOTH,),
    JiggleKind.FLESH: (Sense.FLESH,),
    JiggleKind.TAIL: (Sense.TAIL,),
}
_CAPABILITIES: Mapping[Capability, JiggleKind] = {
    Capability.TAIL: JiggleKind.TAIL,
    Capability.EAR: JiggleKind.EAR,
    Capability.WING: JiggleKind.WING,
    Capability.FIN: JiggleKind.FIN,
}
_HARD = frozenset(("horn", "horns", "antler", "antlers", "muscle", "hat", "helmet", "glove", "boot", "belt", "pants"))
"""Words for parts of such kinds that do not hang loose."""
_QUALIFIERS = frozenset((Sense.NOISE, Sense.CENTER, Sense.BIG, Sense.UPPER, Sense.LOWER, Sense.FRONT, Sense.REAR))


def _kinds(character: Character, posed: Collection[int], readings: Sequence[Reading]) -> dict[int, JiggleKind]:
    """Return each bone that may jiggle, and as what; parents come first."""
    tree = character.skeleton.tree
    own = _own_kinds(character, readings)
    held = {*posed, *tree.roots, *_body(character)}
    held |= {a for bone in held for a in tree.ancestors[bone]}
    inherits = character.skeleton.inherits
    out: dict[int, JiggleKind] = {}
    for bone in tree.order:
        if bone in held or _only_helps(readings[bone]) or (inherits is not None and not inherits[bone]):
            continue
        above = next((out[a] for a in tree.ancestors[bone] if a in out), None)
        kind = above if above and readings[bone].has(Sense.FEATHER) else own.get(bone, above)
        if kind is None and readings[bone].senses <= _QUALIFIERS:
            kind = JiggleKind.CHAIN
        if kind is not None and not _HARD.intersection(readings[bone].words):
            out[bone] = kind
    return out


def _own_kinds(character: Character, readings: Sequence[Reading]) -> dict[int, JiggleKind]:
    """Return what bones are by their names and, before these, by what they can do."""
    out: dict[int, JiggleKind] = {}
    for bone, reading in enumerate(readings):
        for kind, senses in _SENSES.items():
            if reading.has(*senses):
                out[bone] = kind
                break
        for capability in character.capabilities.get(character.skeleton.names[bone], ()):
            out[bone] = _CAPABILITIES.get(capability, out.get(bone, JiggleKind.CHAIN))
    for limb in character.limbs:
        if limb.kind is LimbKind.TENTACLE:
            out |= dict.fromkeys((*limb.bones, *limb.digits), JiggleKind.TENTACLE)
    return out


_FLAPS = (LimbKind.WING, LimbKind.FIN, LimbKind.TENTACLE)
_KEPT = (Capability.FOOT, Capability.FINGER, Capability.EYE, Capability.MOUTH, Capability.NECK, Capability.HEAD)


def _body(character: Character) -> set[int]:
    """Return the bones that only an action moves: the trunk, the limbs that walk and grasp, the face."""
    index, joints = character.skeleton.index, character.joints
    hangs = {b for tail in character.tails for b in tail}
    hangs |= {b for limb in character.limbs if limb.kind in _FLAPS for b in (*limb.bones, *limb.digits)}
    out = {*character.spine, *character.neck, *([] if character.head is None else [character.head])}
    out |= {index[match.bone] for match in joints.values()}
    out |= {index[name] for name, own in character.capabilities.items() if set(own) & set(_KEPT)}
    out -= hangs
    out |= {index[match.bone] for joint, match in joints.items() if joint in FINGER_JOINTS}
    return out | {b for limb in character.limbs if limb.kind not in _FLAPS for b in (*limb.bones, *limb.digits)}


def _sub_trees(character: Character, kinds: Mapping[int, JiggleKind]) -> list[list[int]]:
    """Return the bones of each sub-tree that may jiggle, parents first.

    Bones in between that only help are passed over; one that does not take over rotations parts what is below it.
    """
    skeleton, out = character.skeleton, dict[int, list[int]]()
    tops: dict[int, int] = {}
    for bone in kinds:
        above = int(skeleton.parents[bone])
        while above >= 0 and above not in kinds and (skeleton.inherits is None or skeleton.inherits[above]):
            above = int(skeleton.parents[above])
        tops[bone] = tops.get(above, bone)
        out.setdefault(tops[bone], []).append(bone)
    return list(out.values())


def _only_helps(reading: Reading) -> bool:
    """Return whether a name says that a bone serves others, carries things or belongs to a face."""
    return is_extra(reading) or reading.has(
        Sense.CONTROL, Sense.MECHANISM, Sense.PROP, Sense.FACE, Sense.JAW, Sense.MOUTH, Sense.EYE
    )


# --- their shape ---


def _tips(character: Character, kinds: Collection[int]) -> Array:
    """Return the way from each bone's head to where it leads, armature space, shape (bone, 3)."""
    skeleton = character.skeleton
    out = skeleton.rest_tails - skeleton.rest_positions
    for bone in kinds:
        children = skeleton.tree.children[bone]
        onward = [c for c in children if c in kinds] or children
        if onward:
            way = skeleton.rest_positions[onward].mean(axis=0) - skeleton.rest_positions[bone]
            # Children that all sit at the bone's own head say nothing.
            out[bone] = way if quat.length(way) > 1e-9 else out[bone]
    return np.where(np.isfinite(out), out, 0.0)


def _hangs(character: Character, kind: JiggleKind, line: Sequence[int], tips: Array, size: float) -> bool:
    """Return whether the bones of one sub-tree are enough, and stand out far enough, to hang loose."""
    rest, most = character.skeleton.rest_positions, _most_in_line(character, line)
    reach = float(quat.length(rest[line] + tips - rest[line[0]]).max())
    if kind is JiggleKind.EAR and reach < STUB * size:
        return False
    if kind is JiggleKind.CHAIN:
        heights = character.local_to_character.points(np.stack([rest[line[0]], rest[line[-1]] + tips[-1]]))[:, 2]
        if most < len(line) or reach < REACH * size or heights[1] < FOOTING * heights[0]:
            return False
    return most >= MANNERS[kind].least


def _most_in_line(character: Character, bones: Sequence[int]) -> int:
    """Return the number of bones in the longest line among some bones of one sub-tree."""
    own = set(bones)
    return max(1 + len(own.intersection(character.skeleton.tree.ancestors[b])) for b in bones)


def _shares(tips: Array, above: Sequence[int]) -> tuple[Array, Array, Array, Indices]:
    """Return how far out each tip is, its sub-tree's length, most bones in line and first bone, shapes (n,)."""
    count = len(above)
    way, steps, top = quat.length(tips), np.ones(count), np.arange(count, dtype=np.intp)
    for i, parent in enumerate(above):
        if parent != NONE:
            way[i] += way[parent]
            steps[i] += steps[parent]
            top[i] = top[parent]
    length, most = np.zeros(count), np.zeros(count)
    np.maximum.at(length, top, way)
    np.maximum.at(most, top, steps)
    return way / length[top], length[top], most[top], top
